"""Derivatives at nodes for Hermite interpolation, mixed ones included."""

from collections.abc import Sequence

import numpy as np
import scipy  # its parts are loaded when first used

from tractive_sam.lookup import MIRROR, REVERSED

HEADING, TILT = 0, 1
"""Indices of heading and tilt among the last three axes: heading, tilt, u."""


def coefficients(
    axes: Sequence[np.ndarray],
    values: np.ndarray,
    slopes: np.ndarray,
    full_range: bool = False,
    apart: Sequence[int] = (),
) -> np.ndarray:
    """Return the mixed derivatives at the nodes of a table, for Hermite interpolation.

    Along axes other than creepages only values are known; slopes follow from the cubic spline
    through them. A mixed derivative is the mean of the differences of lower derivatives along each
    of its axes; beyond the ends of heading and tilt, values follow from the symmetries of the
    table. At rest forces are linear in the creepages: the derivatives are known functions of
    heading and tilt.

    Parameters
    ----------
    axes : sequence of ndarray
        Nodes along the axes of a table, the last ones heading, tilt and u.
    values : ndarray, shape (n_1, ..., n_N, 3)
        Forces.
    slopes : ndarray, shape (n_1, ..., n_N, 3, 3)
        Derivatives (force, coordinate) by heading, tilt and u.
    full_range : bool
        Whether the table contains all headings and tilts.
    apart : sequence of int
        Discrete axes, along which values are not interpolated.

    Returns
    -------
    ndarray, shape (n_1, ..., n_N, 2**N, 3)
    """
    count = len(axes)
    flat = {k for k in range(count) if len(axes[k]) == 1 or k in apart}
    derivatives: dict[frozenset[int], np.ndarray] = {frozenset(): values}
    for size in range(1, count + 1):
        for some in _subsets(count, size):
            if some & flat:
                derivatives[some] = np.zeros_like(values)
            elif size == 1 and min(some) >= count - 3:
                derivatives[some] = slopes[..., min(some) - (count - 3)]
            else:
                parts = {
                    k: _slope(axes, derivatives[some - {k}], k, some - {k}, full_range)
                    for k in sorted(some)
                }
                derivatives[some] = np.mean(list(parts.values()), axis=0)
                _use_slopes_at_nodes(derivatives[some], parts, count - 3, full_range)
                _use_slopes_at_rest(derivatives[some], parts, count)
    places = [
        frozenset(k for k in range(count) if d >> (count - 1 - k) & 1) for d in range(2**count)
    ]
    return np.stack([derivatives[some] for some in places], axis=-2)


def _use_slopes_at_nodes(values: np.ndarray, parts: dict, heading: int, full_range: bool) -> None:
    """Replace mixed derivatives, in place, by exact ones at nodes at rest or at a pole."""
    for axis in (heading + HEADING, heading + TILT):
        if axis in parts:
            for place in _smooth_nodes(values.ndim, axis, heading, full_range):
                values[place] = parts[axis][place]
            return


def _use_slopes_at_rest(values: np.ndarray, parts: dict, count: int) -> None:
    """Set mixed derivatives by u and table axes at u = 0, in place, from the exact slopes there.

    Derivatives by other axes are zero at rest: their differences along u are less accurate.
    """
    further = [part for axis, part in parts.items() if axis < count - 3]
    if count - 1 in parts and further and not {count - 3, count - 2} & parts.keys():
        values[..., 0, :] = np.mean([part[..., 0, :] for part in further], axis=0)


def _smooth_nodes(dims: int, axis: int, heading: int, full_range: bool) -> list[tuple]:
    """Return indices of nodes, at rest or at a pole, that follow from 1, cos and sin of `axis`."""
    every = [slice(None)] * dims
    places = []
    for end_axis, end in ((heading + 2, 0), (heading + TILT, -1), (heading + TILT, 0)):
        if end_axis == axis or (axis != heading and end_axis != heading + 2):
            continue
        if end_axis == heading + TILT and end == 0 and not full_range:
            continue  # zero spin
        places.append((*every[:end_axis], end, *every[end_axis + 1 :]))
    return places


def _subsets(count: int, size: int) -> list[frozenset[int]]:
    """Return all subsets of `size` of the first `count` axes."""
    every = (frozenset(k for k in range(count) if d >> k & 1) for d in range(2**count))
    return [some for some in every if len(some) == size]


def _slope(
    axes: Sequence[np.ndarray],
    values: np.ndarray,
    axis: int,
    taken: frozenset[int],
    full_range: bool,
) -> np.ndarray:
    """Return the derivative along an axis of nodal values (derivatives by the axes `taken`)."""
    nodes, count = axes[axis], len(axes)
    kind = axis - (count - 3)
    if kind < 0:
        if len(nodes) == 2:
            step = np.diff(values, axis=axis) / np.diff(nodes)
            return np.repeat(step, 2, axis=axis)
        return scipy.interpolate.CubicSpline(nodes, values, axis=axis)(nodes, 1)
    if kind not in (HEADING, TILT):
        return np.gradient(values, nodes, axis=axis, edge_order=2 if len(nodes) > 2 else 1)
    beyond = _beyond_full_range if full_range else _beyond_quarter
    first, last = beyond(values, kind, count - 3, taken)
    padded = np.concatenate([first, values, last], axis=axis)
    around = np.concatenate([[2.0 * nodes[0] - nodes[1]], nodes, [2.0 * nodes[-1] - nodes[-2]]])
    inner = np.take(np.gradient(padded, around, axis=axis), range(1, len(nodes) + 1), axis=axis)
    basis = np.stack([np.ones_like(nodes), np.cos(nodes), np.sin(nodes)], axis=1)
    slopes = np.stack([np.zeros_like(nodes), -np.sin(nodes), np.cos(nodes)], axis=1)
    exact = np.moveaxis(
        np.tensordot(slopes @ np.linalg.pinv(basis), values, axes=(1, axis)), 0, axis
    )
    for place in _smooth_nodes(values.ndim, axis, count - 3, full_range):
        inner[place] = exact[place]
    return inner


Pair = tuple[np.ndarray, np.ndarray]


def _beyond_quarter(values: np.ndarray, kind: int, heading: int, taken: frozenset[int]) -> Pair:
    """Return values one node before and one behind an axis, by both symmetries of forces."""
    first, last = _ends(values, heading + kind)
    turned = -1.0 if heading in taken else 1.0
    if kind == HEADING:  # f(pi - heading) = REVERSED f(heading)
        return REVERSED * turned * first, REVERSED * turned * last
    # f(heading, -tilt) = MIRROR f(-heading, tilt), and so on at the pole
    sign = turned * (-1.0 if heading + TILT in taken else 1.0)
    return MIRROR * sign * np.flip(first, heading), REVERSED * sign * np.flip(last, heading)


def _beyond_full_range(values: np.ndarray, kind: int, heading: int, taken: frozenset[int]) -> Pair:
    """Return values one node before and one behind an axis that covers all directions."""
    first, last = _ends(values, heading + kind)
    if kind == HEADING:
        return last, first
    sign, count = -1.0 if heading + TILT in taken else 1.0, values.shape[heading]
    across = (np.arange(count) + (count - 1) // 2) % (count - 1)
    return sign * np.take(first, across, heading), sign * np.take(last, across, heading)


def _ends(values: np.ndarray, axis: int) -> Pair:
    """Return values at the second and at the last but one node of an axis."""
    return np.take(values, [1], axis), np.take(values, [values.shape[axis] - 2], axis)
