"""Criterion of Dang Van: a ball around a path of stress, and the worst point from its centre.

The centre of the smallest ball is a mean of the few points of the path that hold it. If these are
samples, their places are wrong by up to half a spacing, and so is the centre: its error is
proportional to the spacing, whereas that of the radius is proportional to the square. So the points
that hold the ball are sought between the samples of a smooth path, on its cubic spline. A spline
has a ninth of the error of the cubic through four samples.

Source: Dang Van, Griveau & Message, in Biaxial and Multiaxial Fatigue (1989) 479.
"""

import math

import numpy as np

from tractive_sam.kernels.compiled import compiled
from tractive_sam.kernels.fatigue import (
    deviators,
    enclosing,
    farthest_point,
    index_of_largest,
    tresca,
)


@compiled
def dang_van(out, radius, paths, a, along):
    """Set the largest tau(x) + a sigma_h(x) of each path, and the radius of `fatigue.balls`.

    tau is the largest shear stress of s minus the centre of the smallest ball around its path,
    sigma_h the hydrostatic stress.

    Parameters
    ----------
    out, radius : ndarray, shape (paths,)
        In the unit of the stress. The radius is that of the ball around the samples.
    paths : ndarray, shape (paths, 6, n)
        Stresses.
    a : float
        Sensitivity to the hydrostatic stress.
    along : ndarray, shape (n,) or (0,)
        Ascending parameter of smooth paths, which are interpolated; if empty, paths are their
        samples.
    """
    n = paths.shape[2]
    points, pulled, squares = np.empty((5, n)), np.empty(n), np.empty(n)
    bounds = np.empty(n), np.empty(n)
    support, weights, count = np.empty(7, np.int64), np.empty(7), 0
    centre, room = np.empty(5), (np.empty((5, 48)), np.empty((5, 7)), np.empty(48))
    curve, plan = (np.empty((n, 6)), np.empty((n, 6)), along), _plan_slopes(along)
    for k in range(len(paths)):
        path = paths[k]
        deviators(points, path)
        count, square = enclosing(centre, support, weights, points, squares, count)
        radius[k] = math.sqrt(square)
        for i in range(n):
            pulled[i] = a * (path[0, i] + path[1, i] + path[2, i]) / 3.0
        if along.size > 2:
            _set_curve(curve, points, pulled, plan)
            _enclose_curve(centre, support[:count], points, squares, curve, room)
        out[k] = _worst(points, pulled, squares, centre, curve, bounds)


@compiled
def _worst(points, pulled, squares, centre, curve, bounds, margin=0.01):
    """Return the largest value of the criterion along a path, between samples of a smooth one.

    Parameters
    ----------
    points, pulled, squares : ndarray, shapes (5, n), (n,) and (n,)
        Deviators, a sigma_h, and squared distances from the centre.
    centre : ndarray, shape (5,)
        Centre of the ball.
    curve : (ndarray, ndarray, ndarray)
        See `_enclose_curve`.
    bounds : (ndarray, ndarray)
        Working arrays (n,).
    margin : float
        By how much, over the largest value, a maximum of the samples may be smaller that is the
        largest between them.
    """
    smooth, n = curve[2].size > 2, squares.size
    most, values = bounds
    for i in range(n):
        most[i] = math.sqrt(squares[i]) + pulled[i]  # tau is at most sqrt(J2)
        values[i] = -math.inf
    worst, floor, own = -math.inf, -math.inf, np.empty(6)
    i = index_of_largest(most)
    while most[i] > floor:
        for c in range(5):
            own[c] = points[c, i]
        own[5] = pulled[i]
        values[i] = _value(own, centre)
        worst = max(worst, values[i])
        floor = worst - margin * abs(worst) if smooth else worst
        most[i] = -math.inf
        i = index_of_largest(most)
    if smooth:
        for i in range(1, n - 1):
            if values[i] >= max(floor, values[i - 1]) and values[i] > values[i + 1]:
                worst = max(worst, _worst_between(values[i], i, centre, curve))
    return worst


@compiled
def _value(own, centre):
    """Value of the criterion at a point: its five coordinates and a sigma_h."""
    for k in range(5):
        own[k] -= centre[k]
    return tresca(own) + own[5]


@compiled
def _plan_slopes(along):
    """Return the factors (n, 4) by which slopes of a spline follow from its values.

    A spline has continuous second derivatives: each slope has an equation with those of its
    neighbours, which are solved by elimination (Thomas). It begins and ends with the slope 0, as
    stress does far away.
    """
    plan = np.zeros((along.size, 4))
    for i in range(1, along.size - 1):
        left, right = along[i] - along[i - 1], along[i + 1] - along[i]
        scale = 1.0 / (2.0 * (left + right) - right * plan[i - 1, 3])
        plan[i, 0], plan[i, 1] = 3.0 * right / left * scale, 3.0 * left / right * scale
        plan[i, 2], plan[i, 3] = right * scale, left * scale
    return plan


@compiled
def _set_curve(curve, points, pulled, plan):
    """Set the values and slopes (n, 6) of the splines by the factors of `_plan_slopes`."""
    values, slopes, _ = curve
    n = len(values)
    for i in range(n):
        for k in range(5):
            values[i, k] = points[k, i]
        values[i, 5] = pulled[i]
    slopes[0], slopes[n - 1] = 0.0, 0.0
    for i in range(1, n - 1):
        before, after, lower = plan[i, 0], plan[i, 1], plan[i, 2]
        for k in range(6):
            rise = before * (values[i, k] - values[i - 1, k])
            rise += after * (values[i + 1, k] - values[i, k])
            slopes[i, k] = rise - lower * slopes[i - 1, k]
    for i in range(n - 2, 0, -1):
        upper = plan[i, 3]
        for k in range(6):
            slopes[i, k] -= upper * slopes[i + 1, k]


@compiled
def _enclose_curve(centre, support, points, squares, curve, room):
    """Move the centre to that of the smallest ball around an interpolated curve.

    Twice, points of the curve around each of its maxima of the distance join those that hold the
    ball: first .15 of a spacing apart, then .04. The error of the centre is proportional to the
    second one.

    Parameters
    ----------
    centre : ndarray, shape (5,)
        Centre of the ball around the samples; is changed.
    support : ndarray of int
        Samples that hold this ball.
    points : ndarray, shape (5, n)
        Samples.
    squares : ndarray, shape (n,)
        Squared distances of the samples from the centre; set to those from the new one.
    curve : (ndarray, ndarray, ndarray)
        Values and slopes (n, 6), and the parameter (n,).
    room : (ndarray, ndarray, ndarray)
        Of shapes (5, m), (5, 7) and (m,): m points that hold the ball or join, at most.
    """
    near, held, apart = room
    order, weights, point = np.arange(7), np.empty(7), np.empty(6)
    count, square, most = support.size, squares[support[0]], apart.size
    for j in range(count):
        held[:, j] = points[:, support[j]]
    for spacing, reach in ((0.15, 2), (0.04, 1)):
        near[:, :count] = held[:, :count]
        size = count
        for i in range(squares.size):
            # Between samples the distance grows by less than a tenth: elsewhere it is too small.
            if squares[i] < 0.9 * square or not _is_peak(squares, i) or size + 2 * reach >= most:
                continue
            s, step = _farthest_between(point, i, squares, centre, curve)
            for j in range(-reach, reach + 1):
                _set_between(point, s + j * spacing * step, i, curve)
                near[:, size] = point[:5]
                size += 1
        near[:, size:] = near[:, :1]
        for j in range(count):
            order[j] = j
        count, square = enclosing(centre, order, weights, near, apart, count)
        for j in range(count):
            held[:, j] = near[:, order[j]]
        farthest_point(squares, centre, points)


@compiled
def _is_peak(squares, i, tie=1e-9):
    """Whether a sample is no nearer than its neighbours; of two that tie both are."""
    least = max(squares[max(i - 1, 0)], squares[min(i + 1, squares.size - 1)])
    return squares[i] >= least * (1.0 - tie)


@compiled
def _farthest_between(point, i, squares, centre, curve):
    """Return how far from the sample i the curve is farthest from the centre, and its spacing.

    The slope of the distance gives the interval and a first place: they are the same from either of
    two samples that are equally far. The maximum of a parabola through three points is the second.
    At an end of the curve it is the end, and the spacing is 0.
    """
    if i in (0, squares.size - 1):
        return 0.0, 0.0
    along = curve[2]
    here = _slope(i, centre, curve)
    other = i + 1 if here > 0.0 else i - 1
    there, h = _slope(other, centre, curve), along[other] - along[i]
    s = h * min(max(here / (here - there), 0.0), 1.0) if here * there < 0.0 else 0.0
    step = 0.2 * abs(h)
    middle = _distance(point, s, i, centre, curve)
    before = _distance(point, s - step, i, centre, curve)
    after = _distance(point, s + step, i, centre, curve)
    curved = 2.0 * middle - before - after
    if curved > 0.0:
        s += min(max(0.5 * step * (after - before) / curved, -step), step)
    return min(max(s, min(h, 0.0)), max(h, 0.0)), abs(h)


@compiled
def _slope(i, centre, curve):
    """Return half the slope of the squared distance from the centre at the sample i."""
    values, slopes, _ = curve
    slope = 0.0
    for k in range(5):
        slope += (values[i, k] - centre[k]) * slopes[i, k]
    return slope


@compiled
def _distance(point, s, i, centre, curve):
    """Set the point of the curve at s from the sample i; its squared distance from the centre."""
    _set_between(point, s, i, curve)
    square = 0.0
    for k in range(5):
        square += (point[k] - centre[k]) ** 2
    return square


@compiled
def _set_between(point, s, i, curve):
    """Set the six values of a curve at the distance s from the sample i, at most two spacings."""
    values, slopes, along = curve
    j = i if i == 0 or s > 0.0 else i - 1
    if j + 2 < along.size and along[i] + s > along[j + 1]:
        j += 1
    elif j > 0 and along[i] + s < along[j]:
        j -= 1
    h = along[j + 1] - along[j]
    t = (along[i] - along[j] + s) / h
    rise = t * t * (3.0 - 2.0 * t)
    first, last = t * (1.0 - t) * (1.0 - t) * h, t * t * (t - 1.0) * h
    for k in range(6):
        point[k] = values[j, k] + rise * (values[j + 1, k] - values[j, k])
        point[k] += first * slopes[j, k] + last * slopes[j + 1, k]


@compiled
def _vertex(left, right, below_left, below_right):
    """Return the place of the maximum of a parabola, from its middle point.

    `below_left` is the value in the middle minus that at the distance `left` before; neither that
    nor `below_right` is negative.
    """
    rise, fall = below_left / left, below_right / right
    total = rise + fall
    return 0.5 * (rise * right - fall * left) / total if total > 0.0 else 0.0


@compiled
def _worst_between(worst, i, centre, curve):
    """Return the largest value of the criterion near the sample i, a maximum of the samples."""
    values, _, along = curve
    own = np.empty(6)
    own[:] = values[i - 1]
    before = worst - _value(own, centre)
    own[:] = values[i + 1]
    after = worst - _value(own, centre)
    s = _vertex(along[i] - along[i - 1], along[i + 1] - along[i], before, after)
    _set_between(own, s, i, curve)
    return max(worst, _value(own, centre))
