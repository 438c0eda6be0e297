"""From values and gradients at nodes to what Hermite's cubics need: mixed derivatives as well."""

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import CubicSpline

from tractive_sam.lookup import MIRROR, REVERSED

HEADING, TILT = 0, 1
"""Of the last three axes: heading, tilt, u."""


def coefficients(axes: Sequence[np.ndarray], values: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """The derivatives of `Hermite` at the nodes of a table.

    Along a/b and Poisson's ratio nothing but values is known: slopes are those of the cubic spline
    through them. A mixed derivative is the mean of the differences of lower ones along each of its
    axes; beyond the ends of heading and tilt the symmetries of the table tell the values.

    Parameters
    ----------
    axes : sequence of ndarray
        Nodes along ln(a/b), Poisson's ratio, heading, tilt and u.
    values : ndarray, shape (n_1, ..., n_5, 3)
        Forces.
    slopes : ndarray, shape (n_1, ..., n_5, 3, 3)
        Their derivatives (force, coordinate) by heading, tilt and u.

    Returns
    -------
    ndarray, shape (n_1, ..., n_5, 32, 3)
    """
    count = len(axes)
    found: dict[frozenset[int], np.ndarray] = {frozenset(): values}
    for size in range(1, count + 1):
        for some in _subsets(count, size):
            if any(len(axes[k]) == 1 for k in some):
                found[some] = np.zeros_like(values)
            elif size == 1 and min(some) >= count - 3:
                found[some] = slopes[..., min(some) - (count - 3)]
            else:
                lower = [(k, found[some - {k}], some - {k}) for k in some]
                parts = [_slope(axes, one, k, rest, count) for k, one, rest in lower]
                found[some] = np.mean(parts, axis=0)
    places = [
        frozenset(k for k in range(count) if d >> (count - 1 - k) & 1) for d in range(2**count)
    ]
    return np.stack([found[some] for some in places], axis=-2)


def _subsets(count: int, size: int) -> list[frozenset[int]]:
    every = (frozenset(k for k in range(count) if d >> k & 1) for d in range(2**count))
    return [some for some in every if len(some) == size]


def _slope(axes, values: np.ndarray, axis: int, taken: frozenset[int], count: int) -> np.ndarray:
    """Derivative along an axis of values that are derivatives by `taken` already."""
    nodes, kind = axes[axis], axis - (count - 3)
    if kind < 0:
        if len(nodes) == 2:
            step = np.diff(values, axis=axis) / np.diff(nodes)
            return np.repeat(step, 2, axis=axis)
        return CubicSpline(nodes, values, axis=axis)(nodes, 1)
    if kind not in (HEADING, TILT):
        return np.gradient(values, nodes, axis=axis, edge_order=2 if len(nodes) > 2 else 1)
    heading, tilt = count - 3 + HEADING, count - 3 + TILT
    first = np.take(values, [1], axis=axis)
    last = np.take(values, [len(nodes) - 2], axis=axis)
    turned = -1.0 if heading in taken else 1.0
    if kind == HEADING:  # f(pi - heading) = REVERSED f(heading)
        first, last = (REVERSED * turned * one for one in (first, last))
    else:  # f(heading, -tilt) = MIRROR f(-heading, tilt), and so on at the pole
        sign = turned * (-1.0 if tilt in taken else 1.0)
        first = MIRROR * sign * np.flip(first, axis=heading)
        last = REVERSED * sign * np.flip(last, axis=heading)
    padded = np.concatenate([first, values, last], axis=axis)
    around = np.concatenate([[2.0 * nodes[0] - nodes[1]], nodes, [2.0 * nodes[-1] - nodes[-2]]])
    inner = np.gradient(padded, around, axis=axis)
    return np.take(inner, range(1, len(nodes) + 1), axis=axis)
