"""Stress at arbitrary points."""

import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.contact import Laws
from tractive_sam.results import State
from tractive_sam.subsurface.loaded import LoadedBodies


def stress_at(
    contact: State, points: ArrayLike, body: str = "A", laws: Laws | None = None
) -> np.ndarray:
    """Stress at points, summed over the loaded elements; exact for their constant tractions.

    Some 0.1 microseconds a point and loaded element. At the surface, on the edge between two
    elements of different tangential traction, the stress is infinite; what is infinite is left out
    there (see `kernels.stress`).

    Parameters
    ----------
    contact : State
        The solved contact.
    points : array_like, shape (n, 3)
        x, y and depth, mm.
    body : "A" or "B"
        The body concerned.
    laws : Laws, optional
        Laws that the contact was solved with, where they are not those of its scene.

    Returns
    -------
    ndarray, shape (n, 6)
        xx, yy, zz, xy, xz, yz in the axes of the contact, MPa.

    Raises
    ------
    ValueError
        If there is no such body, or points are not of that shape, finite and below the surface.

    Examples
    --------
    >>> sigma = ts.stress_at(contact, [(0.0, 0.0, 0.5 * scene.hertz.a)])
    >>> sigma.shape
    (1, 6)
    """
    points = np.ascontiguousarray(points, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"points must have the shape (n, 3), not {points.shape}")
    if not np.isfinite(points).all() or (points[:, 2] < 0.0).any():
        raise ValueError("points must be finite, with a depth of at least 0")
    load = LoadedBodies.of(contact, (body,), laws)
    return load.in_contact_axes(load.source.at(points))[0].T
