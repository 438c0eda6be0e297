"""Depths at which stress is computed, and the semi-axes that are their unit."""

import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.results import State
from tractive_sam.scene import Plane, Subsurface


def depths(subsurface: Subsurface, a: float) -> np.ndarray:
    """Return the depths of [subsurface], mm, graded towards the surface.

    z_i = depth a (i / (n - 1))^(3/2): friction causes a second maximum at the surface, with steeper
    gradients. With the default 64 points to 1.5 a the spacing is 0.003 a at the
    surface and 0.036 a at the bottom.

    Parameters
    ----------
    subsurface : Subsurface
        [subsurface] of the scene.
    a : float
        Semi-axis of the unworn contact in the rolling direction, mm.

    Returns
    -------
    ndarray, shape (subsurface.elements,)
        Ascending, from exactly 0, mm.

    Examples
    --------
    >>> depths(ts.Subsurface(planes=("y=0",), depth=1.0, elements=3), a=2.0)
    array([0.        , 0.70710678, 2.        ])
    """
    return subsurface.depth * a * np.linspace(0.0, 1.0, subsurface.elements) ** 1.5


def semi_axes(contact: State) -> tuple[float, float]:
    """Return the semi-axes a, b of the unworn Hertz contact, or the half widths without it, mm.

    Examples
    --------
    >>> semi_axes(contact)[0] == contact.scene.hertz.a
    True
    """
    hertz = contact.scene.hertz
    if hertz is None:
        return contact.half_width_x, contact.half_width_y
    return hertz.a, hertz.b


def default_depths(contact: State) -> np.ndarray:
    """Return the depths of the scene's [subsurface], or default ones, mm."""
    subsurface = contact.scene.subsurface or Subsurface(planes=(Plane("y", 0.0),))
    return depths(subsurface, semi_axes(contact)[0])


def check_depths(values: ArrayLike) -> np.ndarray:
    """Return depths as an array; raise a ValueError if one is negative or not finite.

    Raises
    ------
    ValueError
        If a depth is negative or not finite, or if `values` is no sequence.

    Examples
    --------
    >>> from tractive_sam.subsurface import check_depths
    >>> check_depths([0, 0.5])
    array([0. , 0.5])
    """
    values = np.asarray(values, dtype=float)
    if values.ndim != 1:
        raise ValueError("depths must be a sequence of numbers")
    if not (np.isfinite(values) & (values >= 0.0)).all():
        raise ValueError("depths must be finite and at least 0, the surface")
    return values
