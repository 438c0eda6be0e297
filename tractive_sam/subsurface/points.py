"""Stress at arbitrary points, and along the way of one."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.contact import Laws
from tractive_sam.results import COMPONENTS, State
from tractive_sam.subsurface.depth import semi_axes
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
        Laws of the bodies; by default those that the contact was solved with.

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


WAY = 4.0
"""How far before and behind the contact the way of a material point begins and ends, over a."""

POINTS = 401
"""Points along it."""


def stress_path(
    contact: State,
    y: float,
    depth: float,
    body: str = "A",
    x: ArrayLike | None = None,
    laws: Laws | None = None,
) -> dict[str, np.ndarray]:
    """What a point of the material lives through as it rolls through the contact: its stress cycle.

    Exact for the constant tractions of the elements, as `stress_at`. At the surface take an x
    within each element: between two of different tangential traction the stress is infinite.

    Parameters
    ----------
    contact : State
        The solved contact.
    y, depth : float
        Where the point rolls, mm.
    body : "A" or "B"
        The body concerned.
    x : array_like, shape (n,), optional
        Where it is looked at, mm; by default `POINTS` times, from `WAY` semi-axes a before the
        contact, on the leading side x > 0, to as many behind it.
    laws : Laws, optional
        Laws of the bodies; by default those that the contact was solved with.

    Returns
    -------
    dict of str to ndarray, shape (n,)
        x in mm, and xx, yy, zz, xy, xz, yz in MPa, in this order.

    Raises
    ------
    ValueError
        If there is no such body, x is no sequence, or a place is not finite or above the surface.

    Examples
    --------
    >>> cycle = ts.stress_path(contact, y=0.0, depth=0.35 * scene.hertz.a)
    >>> list(cycle)
    ['x', 'xx', 'yy', 'zz', 'xy', 'xz', 'yz']
    >>> round(float(np.ptp(cycle["xz"]) / scene.hertz.p0), 1)  # range of the orthogonal shear
    0.4
    """
    if x is None:
        far = WAY * semi_axes(contact)[0]
        x = np.linspace(far, -far, POINTS)
    x = np.asarray(x, dtype=float)
    if x.ndim != 1:
        raise ValueError("x must be a sequence of numbers")
    points = np.stack(np.broadcast_arrays(x, y, depth), axis=-1)
    return {"x": x} | dict(zip(COMPONENTS, stress_at(contact, points, body, laws).T, strict=True))
