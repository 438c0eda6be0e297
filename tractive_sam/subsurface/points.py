"""Stress at points, and along the path of a material point."""

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
    """Return the stress (n, 6) of a body at points (n, 3), an exact sum over the elements.

    The cost is about 0.1 microseconds per point and loaded element. At the surface, on the edge
    between elements with different tangential traction, the stress is infinite; the infinite part
    is omitted there (see `kernels.stress`).

    Parameters
    ----------
    contact : State
        The solved contact.
    points : array_like, shape (n, 3)
        x, y and depth, mm.
    body : "A" or "B"
        The body.
    laws : Laws, optional
        Laws of the bodies; by default the laws of the solution.

    Returns
    -------
    ndarray, shape (n, 6)
        xx, yy, zz, xy, xz, yz in the axes of the contact, MPa.

    Raises
    ------
    ValueError
        If the body is not "A" or "B", or if points have another shape, are not finite or above the
        surface.

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
    load = LoadedBodies.from_contact(contact, (body,), laws)
    return load.in_contact_axes(load.source.at(points))[0].T


def stress_path(
    contact: State,
    y: float,
    depth: float,
    body: str = "A",
    x: ArrayLike | None = None,
    laws: Laws | None = None,
    number: int = 401,
    reach: float = 4.0,
) -> dict[str, np.ndarray]:
    """Return x and six stresses, by name, of a material point on its path through the contact.

    It is exact for the constant tractions of the elements, as `stress_at`. At the surface give x
    within the elements: between elements with different tangential traction the stress is
    infinite.

    Parameters
    ----------
    contact : State
        The solved contact.
    y, depth : float
        Position of the point, mm.
    body : "A" or "B"
        The body.
    x : array_like, shape (n,), optional
        Positions in x, mm; by default `number` points from `reach` semi-axes a before the contact,
        on the leading side x > 0, to `reach` behind it.
    laws : Laws, optional
        Laws of the bodies; by default the laws of the solution.
    number : int
        Number of points without `x`.
    reach : float
        Largest distance without `x`, over the semi-axis a.

    Returns
    -------
    dict of str to ndarray, shape (n,)
        x in mm, and xx, yy, zz, xy, xz, yz in MPa, in this order.

    Raises
    ------
    ValueError
        If the body is not "A" or "B", x is not a sequence, or a point is not finite or above
        the surface.

    Examples
    --------
    >>> cycle = ts.stress_path(contact, y=0.0, depth=0.35 * scene.hertz.a)
    >>> list(cycle)
    ['x', 'xx', 'yy', 'zz', 'xy', 'xz', 'yz']
    >>> round(float(np.ptp(cycle["xz"]) / scene.hertz.p0), 1)  # range of the orthogonal shear
    0.4
    """
    if x is None:
        distance = reach * semi_axes(contact)[0]
        x = np.linspace(distance, -distance, number)
    x = np.asarray(x, dtype=float)
    if x.ndim != 1:
        raise ValueError("x must be a sequence of numbers")
    points = np.stack(np.broadcast_arrays(x, y, depth), axis=-1)
    return {"x": x} | dict(zip(COMPONENTS, stress_at(contact, points, body, laws).T, strict=True))
