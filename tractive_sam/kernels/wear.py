"""The upwind sweep of wear: material gathers depth from the leading edge to the trailing one."""

import numpy as np

from tractive_sam.kernels.compiled import compiled


@compiled
def sweep(entering, rate, dx):
    """Depth of wear below every element after the material has passed it.

    Paper, eq. (32): w_I = w_entering + sum of rate_J dx over J from I up to the leading edge.

    Parameters
    ----------
    entering : ndarray, shape (n_y,)
        Depth with which the material enters, mm.
    rate : ndarray, shape (n_x, n_y)
        Wear per distance rolled, dimensionless.
    dx : float
        Side of an element in the rolling direction, mm.

    Returns
    -------
    ndarray, shape (n_x, n_y)
        Depth, mm; its row 0 is what leaves the contact.
    """
    nx, ny = rate.shape
    depth = np.empty((nx, ny))
    for j in range(ny):
        total = entering[j]
        for i in range(nx - 1, -1, -1):
            total += rate[i, j] * dx
            depth[i, j] = total
    return depth
