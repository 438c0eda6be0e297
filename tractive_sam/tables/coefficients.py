"""From values and gradients at nodes to what Hermite's cubics need: mixed derivatives as well."""

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import CubicSpline

from tractive_sam.lookup import MIRROR, REVERSED

HEADING, TILT = 0, 1
"""Of the last three axes: heading, tilt, u."""


def coefficients(
    axes: Sequence[np.ndarray],
    values: np.ndarray,
    slopes: np.ndarray,
    whole: bool = False,
    apart: Sequence[int] = (),
) -> np.ndarray:
    """The derivatives of `Hermite` at the nodes of a table.

    Along axes beside those of creepages nothing but values is known: slopes are those of the cubic
    spline through them. A mixed derivative is the mean of the differences of lower ones along each
    of its axes; beyond the ends of heading and tilt the symmetries of the table tell the values. At
    rest forces are linear in creepages, and of spin alone in those added: the course of their
    derivatives over heading and tilt is known there.

    Parameters
    ----------
    axes : sequence of ndarray
        Nodes along the axes of a table, the last of which are heading, tilt and u.
    values : ndarray, shape (n_1, ..., n_N, 3)
        Forces.
    slopes : ndarray, shape (n_1, ..., n_N, 3, 3)
        Their derivatives (force, coordinate) by heading, tilt and u.
    whole : bool
        Whether the table has all headings and tilts.
    apart : sequence of int
        Axes between whose nodes nothing is known.

    Returns
    -------
    ndarray, shape (n_1, ..., n_N, 2**N, 3)
    """
    count = len(axes)
    flat = {k for k in range(count) if len(axes[k]) == 1 or k in apart}
    found: dict[frozenset[int], np.ndarray] = {frozenset(): values}
    for size in range(1, count + 1):
        for some in _subsets(count, size):
            if some & flat:
                found[some] = np.zeros_like(values)
            elif size == 1 and min(some) >= count - 3:
                found[some] = slopes[..., min(some) - (count - 3)]
            else:
                parts = {
                    k: _slope(axes, found[some - {k}], k, some - {k}, whole) for k in sorted(some)
                }
                found[some] = np.mean(list(parts.values()), axis=0)
                _keep_known(found[some], parts, count - 3, whole)
                _keep_at_rest(found[some], parts, count)
    places = [
        frozenset(k for k in range(count) if d >> (count - 1 - k) & 1) for d in range(2**count)
    ]
    return np.stack([found[some] for some in places], axis=-2)


def _keep_known(values: np.ndarray, parts: dict, heading: int, whole: bool) -> None:
    """Where the course over heading or tilt is known, take the derivative by it alone."""
    for axis in (heading + HEADING, heading + TILT):
        if axis in parts:
            for place in _known(values.ndim, axis, heading, whole):
                values[place] = parts[axis][place]
            return


def _keep_at_rest(values: np.ndarray, parts: dict, count: int) -> None:
    """At rest, take mixed derivatives by u of the slopes by u, which are known there.

    Derivatives by other axes are zero at rest: their differences along u say less of it.
    """
    others = [part for axis, part in parts.items() if axis < count - 3]
    if count - 1 in parts and others and not {count - 3, count - 2} & parts.keys():
        values[..., 0, :] = np.mean([part[..., 0, :] for part in others], axis=0)


def _known(dims: int, axis: int, heading: int, whole: bool) -> list[tuple]:
    """Where values are 1, cos and sin of heading or tilt: at rest, and over heading at a pole."""
    every = [slice(None)] * dims
    places = []
    for other, end in ((heading + 2, 0), (heading + TILT, -1), (heading + TILT, 0)):
        if other == axis or (axis != heading and other != heading + 2):
            continue
        if other == heading + TILT and end == 0 and not whole:
            continue  # where there is no spin
        places.append((*every[:other], end, *every[other + 1 :]))
    return places


def _subsets(count: int, size: int) -> list[frozenset[int]]:
    every = (frozenset(k for k in range(count) if d >> k & 1) for d in range(2**count))
    return [some for some in every if len(some) == size]


def _slope(
    axes: Sequence[np.ndarray], values: np.ndarray, axis: int, taken: frozenset[int], whole: bool
) -> np.ndarray:
    """Derivative along an axis of values that are derivatives by `taken` already."""
    nodes, count = axes[axis], len(axes)
    kind = axis - (count - 3)
    if kind < 0:
        if len(nodes) == 2:
            step = np.diff(values, axis=axis) / np.diff(nodes)
            return np.repeat(step, 2, axis=axis)
        return CubicSpline(nodes, values, axis=axis)(nodes, 1)
    if kind not in (HEADING, TILT):
        return np.gradient(values, nodes, axis=axis, edge_order=2 if len(nodes) > 2 else 1)
    beyond = _beyond_whole if whole else _beyond_quarter
    first, last = beyond(values, kind, count - 3, taken)
    padded = np.concatenate([first, values, last], axis=axis)
    around = np.concatenate([[2.0 * nodes[0] - nodes[1]], nodes, [2.0 * nodes[-1] - nodes[-2]]])
    inner = np.take(np.gradient(padded, around, axis=axis), range(1, len(nodes) + 1), axis=axis)
    basis = np.stack([np.ones_like(nodes), np.cos(nodes), np.sin(nodes)], axis=1)
    slopes = np.stack([np.zeros_like(nodes), -np.sin(nodes), np.cos(nodes)], axis=1)
    exact = np.moveaxis(
        np.tensordot(slopes @ np.linalg.pinv(basis), values, axes=(1, axis)), 0, axis
    )
    for place in _known(values.ndim, axis, count - 3, whole):
        inner[place] = exact[place]
    return inner


Pair = tuple[np.ndarray, np.ndarray]


def _beyond_quarter(values: np.ndarray, kind: int, heading: int, taken: frozenset[int]) -> Pair:
    """Values before the first and after the last node of a table of both symmetries."""
    first, last = _ends(values, heading + kind)
    turned = -1.0 if heading in taken else 1.0
    if kind == HEADING:  # f(pi - heading) = REVERSED f(heading)
        return REVERSED * turned * first, REVERSED * turned * last
    # f(heading, -tilt) = MIRROR f(-heading, tilt), and so on at the pole
    sign = turned * (-1.0 if heading + TILT in taken else 1.0)
    return MIRROR * sign * np.flip(first, heading), REVERSED * sign * np.flip(last, heading)


def _beyond_whole(values: np.ndarray, kind: int, heading: int, taken: frozenset[int]) -> Pair:
    """The same of all headings, which are a circle, and tilts: f(heading + pi) beyond a pole."""
    first, last = _ends(values, heading + kind)
    if kind == HEADING:
        return last, first
    sign, count = -1.0 if heading + TILT in taken else 1.0, values.shape[heading]
    across = (np.arange(count) + (count - 1) // 2) % (count - 1)
    return sign * np.take(first, across, heading), sign * np.take(last, across, heading)


def _ends(values: np.ndarray, axis: int) -> Pair:
    """Values at the second and at the last but one node."""
    return np.take(values, [1], axis), np.take(values, [values.shape[axis] - 2], axis)
