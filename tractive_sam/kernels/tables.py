"""Tables of the rectangle integrals over a regular mesh."""

import numpy as np

from tractive_sam.kernels.compiled import compiled
from tractive_sam.kernels.rectangle import integrals


@compiled
def quadrant(nx, ny, dx, dy):
    """Rectangle integrals at the offsets ``(i dx, j dy)``, 0 <= i < nx, 0 <= j < ny.

    The other three quadrants follow from the parities listed in
    :mod:`tractive_sam.kernels.rectangle`.

    Parameters
    ----------
    nx, ny : int
        Number of offsets in x and y.
    dx, dy : float
        Sides of the rectangle and steps of the offsets, mm.

    Returns
    -------
    ndarray, shape (6, nx, ny)
        Integrals r1, xx, yy, xy, x2, y2, mm.
    """
    table = np.empty((6, nx, ny))
    for i in range(nx):
        for j in range(ny):
            values = integrals(i * dx, j * dy, dx, dy)
            for k in range(6):
                table[k, i, j] = values[k]
    return table
