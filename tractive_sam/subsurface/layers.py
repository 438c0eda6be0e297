"""Stress of bodies in layers of the mesh, one after another."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.contact import Laws
from tractive_sam.subsurface.depth import check_depths
from tractive_sam.subsurface.loaded import LoadedBodies, Loading


def stress_layers(
    contact: Loading,
    depths: ArrayLike,
    bodies: Sequence[str] = ("A",),
    beyond: int = 0,
    threads: int = 1,
    laws: Laws | None = None,
) -> Iterator[tuple[float, np.ndarray]]:
    """Yield (depth, stress (bodies, 6, n_x + 2 beyond, n_y)) at element centres, by depth.

    Along x a layer contains the stress path of the material at (y, depth) through the contact. The
    stress is computed by FFT, exactly for constant tractions on the elements. Two bodies cost
    little more than one. Coefficients that depend on mesh and depth only are cached for the next
    contact on the mesh (`operators.StressLayers`).

    Parameters
    ----------
    contact : State or Loading
        The solved contact, or its scene, grid and tractions.
    depths : array_like, shape (n,)
        Depths, in any order, 0 at the surface, mm.
    bodies : sequence of str
        "A" or "B".
    beyond : int
        Elements by which the layers extend before and behind the mesh in the rolling direction, at
        the x of ``contact.grid.lengthened(beyond)``.
    threads : int
        Number of threads.
    laws : Laws, optional
        Laws of the bodies; by default the laws of the solution.

    Yields
    ------
    (float, ndarray of shape (bodies, 6, n_x + 2 beyond, n_y))
        Depth, and xx, yy, zz, xy, xz, yz of each body in the axes of the contact, MPa.

    Raises
    ------
    ValueError
        If the body is not "A" or "B", or depths are negative or not finite.

    Examples
    --------
    >>> for depth, stress in stress_layers(contact, [0.0, 0.5]):
    ...     print(depth, stress.shape == (1, 6, *contact.grid.elements))
    0.0 True
    0.5 True
    """
    # Checked at the call, not at the first layer.
    return _layers(
        LoadedBodies.from_contact(contact, bodies, laws, beyond), check_depths(depths), threads
    )


def _layers(
    load: LoadedBodies, depths: np.ndarray, threads: int
) -> Iterator[tuple[float, np.ndarray]]:
    """Yield (depth, stress of the bodies) depth by depth, in the axes of the contact."""
    for depth, stress in zip(depths, load.source.layers(depths, threads), strict=True):
        yield float(depth), load.in_contact_axes(stress)
