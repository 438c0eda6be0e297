"""Stress in a volume, layer by layer."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.contact import Laws
from tractive_sam.subsurface.layers import stress_layers
from tractive_sam.subsurface.loaded import Loading


def stress_volume(
    contact: Loading, depths: ArrayLike, body: str = "A", threads: int = 1, laws: Laws | None = None
) -> Iterator[tuple[float, np.ndarray]]:
    """Yield (depth, stress (6, n_x, n_y)) at the element centres, one depth after another.

    Parameters
    ----------
    contact : State or Loading
        The solved contact, or its scene, grid and tractions.
    depths : array_like, shape (n,)
        Depths, in any order, mm.
    body : "A" or "B"
        The body.
    threads : int
        Number of threads.
    laws : Laws, optional
        Laws of the bodies; by default the laws of the solution.

    Yields
    ------
    (float, ndarray of shape (6, n_x, n_y))
        Depth, and xx, yy, zz, xy, xz, yz in the axes of the contact, MPa.

    Raises
    ------
    ValueError
        If the body is not "A" or "B", or depths are negative or not finite.

    Examples
    --------
    >>> for depth, stress in ts.stress_volume(contact, [0.5, 1.0]):
    ...     print(depth, stress.shape)
    0.5 (6, 91, 91)
    1.0 (6, 91, 91)
    """
    layers = stress_layers(contact, depths, (body,), threads=threads, laws=laws)
    return ((depth, stress[0]) for depth, stress in layers)
