"""Where stress on a plane is largest: inside the body, and at its surface."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.ndimage import maximum_filter


@dataclass(frozen=True)
class StressMaximum:
    """A maximum on a plane, at one of the points where the stress was computed.

    Attributes
    ----------
    kind : str
        "interior", "surface", or "largest".
    value : float
        In the unit of the values.
    at : tuple of float
        Coordinates along the axes of the plane, in their unit.
    """

    kind: str
    value: float
    at: tuple[float, float]

    @classmethod
    def of(cls, kind: str, values: np.ndarray, axes: tuple[np.ndarray, np.ndarray]) -> Self:
        """The value of the largest magnitude; shape (n, m), axes (n,) and (m,)."""
        index = np.unravel_index(np.argmax(np.abs(values)), values.shape)
        at = tuple(float(axis[i]) for axis, i in zip(axes, index, strict=True))
        return cls(kind, float(values[index]), at)


def stress_maxima(values: np.ndarray, axes: tuple[np.ndarray, np.ndarray]) -> list[StressMaximum]:
    """The largest local maximum inside a body, and the largest value at its surface.

    As for `subsurface.Maximum`, what is nearer to the surface than one element is not
    looked at: there every edge between elements has a maximum of its own.

    Parameters
    ----------
    values : ndarray, shape (n, m)
        On a plane through the depth, positive.
    axes : (ndarray of shape (n,), ndarray of shape (m,))
        Centres of elements along the plane, and ascending depths.

    Returns
    -------
    list of StressMaximum
        Both, as far as the plane has them; else its largest value.

    Examples
    --------
    >>> stress = ts.stress_on_plane(contact, "y=0", "A")
    >>> [one.kind for one in plot.stress_maxima(stress.von_mises, tuple(stress.axes.values()))]
    ['interior', 'surface']
    """
    along, depth = axes
    tops = values == maximum_filter(values, 3, mode="nearest")
    # At the edge of what was computed nobody knows how it goes on.
    tops[[0, -1]] = tops[:, -1] = False
    inside = np.where(tops & (depth >= along[1] - along[0]), values, 0.0)
    at_surface = np.where(depth == 0.0, values, 0.0)
    found = [
        StressMaximum.of(kind, where, axes)
        for kind, where in (("interior", inside), ("surface", at_surface))
        if where.any()
    ]
    return found or [StressMaximum.of("largest", values, axes)]
