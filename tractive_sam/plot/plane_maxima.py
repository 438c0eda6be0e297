"""Maxima of the stress on a plane: inside the body, and at its surface."""

from dataclasses import dataclass
from typing import Self

import numpy as np


@dataclass(frozen=True)
class StressMaximum:
    """Maximum of a quantity on a plane: kind, value and position.

    Attributes
    ----------
    kind : str
        "interior", "surface", or "largest".
    value : float
        Value of the maximum, in the unit of the values.
    at : tuple of float
        Coordinates along the axes of the plane, in their unit.

    Examples
    --------
    >>> values, axes = np.array([[1.0, 2.0], [0.0, -3.0]]), (np.arange(2.0), np.arange(2.0))
    >>> plot.StressMaximum.largest("largest", values, axes)
    StressMaximum(kind='largest', value=-3.0, at=(1.0, 1.0))
    """

    kind: str
    value: float
    at: tuple[float, float]

    @classmethod
    def largest(cls, kind: str, values: np.ndarray, axes: tuple[np.ndarray, np.ndarray]) -> Self:
        """Return the maximum of the largest magnitude in values (n, m) over two axes."""
        i, j = np.unravel_index(np.argmax(np.abs(values)), values.shape)
        return cls(kind, float(values[i, j]), (float(axes[0][i]), float(axes[1][j])))


def stress_maxima(values: np.ndarray, axes: tuple[np.ndarray, np.ndarray]) -> list[StressMaximum]:
    """Return the largest local maximum inside and the surface maximum; if neither, the largest.

    As in `subsurface.Maximum`, points closer to the surface than one element are ignored: there
    every edge between elements has a local maximum.

    Parameters
    ----------
    values : ndarray, shape (n, m)
        Positive values on a plane through the depth.
    axes : (ndarray of shape (n,), ndarray of shape (m,))
        Centres of elements along the plane, and ascending depths.

    Returns
    -------
    list of StressMaximum
        Both, if the plane has them; else its largest value.

    Examples
    --------
    >>> stress = ts.stress_on_plane(contact, "y=0", "A")
    >>> maxima = plot.stress_maxima(stress.von_mises, tuple(stress.axes.values()))
    >>> [maximum.kind for maximum in maxima]
    ['interior', 'surface']
    """
    along, depth = axes
    neighbours = np.lib.stride_tricks.sliding_window_view(np.pad(values, 1, "edge"), (3, 3))
    tops = values == neighbours.max(axis=(2, 3))
    # Beyond the edges of the plane the stress is unknown.
    tops[[0, -1]] = tops[:, -1] = False
    inside = np.where(tops & (depth >= along[1] - along[0]), values, 0.0)
    at_surface = np.where(depth == 0.0, values, 0.0)
    maxima = [
        StressMaximum.largest(kind, part, axes)
        for kind, part in (("interior", inside), ("surface", at_surface))
        if part.any()
    ]
    return maxima or [StressMaximum.largest("largest", values, axes)]
