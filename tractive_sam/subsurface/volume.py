"""Stress in a volume, one layer after another."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.operators import Mesh, StressLayers
from tractive_sam.subsurface.depth import checked
from tractive_sam.subsurface.loaded import LoadedBodies, Loading
from tractive_sam.subsurface.strips import stress_on


def stress_volume(
    contact: Loading, depths: ArrayLike, body: str = "A", threads: int = 1
) -> Iterator[tuple[float, np.ndarray]]:
    """Stress at the centres of the contact's mesh, layer by layer; nothing is kept of a layer.

    Parameters
    ----------
    contact : Contact or Loading
        The solved contact, or its scene, grid and tractions.
    depths : array_like, shape (n,)
        Depths, in any order, mm.
    body : "A" or "B"
        The body concerned.
    threads : int
        Threads to use.

    Yields
    ------
    (float, ndarray of shape (6, n_x, n_y))
        Depth, and xx, yy, zz, xy, xz, yz in the axes of the contact, MPa.

    Raises
    ------
    ValueError
        If there is no such body, or depths are negative or not finite.

    Examples
    --------
    >>> for depth, stress in ts.stress_volume(contact, [0.5, 1.0]):
    ...     print(depth, stress.shape)
    0.5 (6, 91, 91)
    1.0 (6, 91, 91)
    """
    # Checked at the call, not at the first layer.
    return _layers(LoadedBodies.of(contact, (body,)), contact, checked(depths), threads)


def _layers(load: LoadedBodies, contact: Loading, depths: np.ndarray, threads: int):
    grid = contact.grid
    if grid.line:
        for depth in depths:
            at = np.array([depth])
            stress = stress_on(grid, load.tractions, load.poisson, grid.x, at)
            yield float(depth), load.in_contact_axes(stress)[0]
        return
    mesh = Mesh(grid.elements, grid.dx, grid.dy)
    layers = StressLayers(mesh, load.tractions, load.poisson, threads)
    for depth in depths:
        yield float(depth), load.in_contact_axes(layers.at(depth))[0]
