"""The smallest ball, or circle, around points."""

import math

import numpy as np

from tractive_sam.kernels.compiled import compiled

MAX_STEPS = 200
"""Most steps of a search that ends after some ten."""


@compiled
def enclosing_ball(centre, support, weights, points, squares, begun=0):
    """Find the smallest ball around points; return its number of support points and squared radius.

    Minimises over c the largest |p_i - c|². In the dual c is the mean of some of the points with
    positive weights and equal distances: an active set of these grows by the farthest
    point and loses each one with a weight that falls to zero, until no point is farther. It ends
    after a few steps with the exact ball (Gärtner, ESA 1999, 325; Fischer, Gärtner & Kutz, ESA
    2003, 630).

    Parameters
    ----------
    centre : ndarray, shape (m,)
        Set to c; m at most 5.
    support : ndarray of int, shape (m + 2,)
        Its first entries are set to the points that hold the ball.
    weights : ndarray, shape (m + 2,)
        Set to their weights, which add up to 1.
    points : ndarray, shape (m, n)
        The points p_i.
    squares : ndarray, shape (n,)
        Set to |p_i - c|².
    begun : int
        Number of entries of `support` to begin with: points that held a similar ball.

    Returns
    -------
    (int, float)
        How many points hold the ball, and its squared radius: the largest |p_i - c|².
    """
    m = len(points)
    matrix, right = np.empty((m + 1, m + 1)), np.empty(m + 1)
    target = np.empty(m + 2)
    count, largest = 2, 0.0
    if begun < 2 or _squared_distance(points, support[0], support[1]) == 0.0:
        begun = 2
        support[0] = index_of_farthest(squares, points[:, 0], points)
        support[1] = index_of_farthest(squares, points[:, support[0]], points)
    weights[0], weights[1] = 0.5, 0.5
    for j in range(2, begun):
        count = _add_support(support, weights, count, support[j], points, target, matrix, right)
    for _ in range(MAX_STEPS):
        first, radius2 = support[0], 0.0
        for k in range(m):
            centre[k] = 0.0
            for j in range(count):
                centre[k] += weights[j] * points[k, support[j]]
            radius2 += (points[k, first] - centre[k]) ** 2
        far = index_of_farthest(squares, centre, points)
        largest = squares[far]
        if not largest > radius2 * (1.0 + 1e-14):  # nor if it is nan
            break
        count = _add_support(support, weights, count, far, points, target, matrix, right)
    return count, largest


@compiled(inner=True)
def _squared_distance(points, i, j):
    """Return the squared distance between the points in columns i and j of `points`."""
    square = 0.0
    for k in range(len(points)):
        square += (points[k, i] - points[k, j]) ** 2
    return square


@compiled(inner=True)
def _add_support(support, weights, count, far, points, target, matrix, right):
    """Add a point to the support of a ball, drop points no longer needed; return their number."""
    support[count], weights[count] = far, 0.0
    count += 1
    leaving = 0
    while leaving >= 0:
        dependent = _equidistant_weights(target, support, count, points, matrix, right)
        leaving = _move_weights(weights, target, count, dependent)
        if leaving >= 0:
            for j in range(leaving, count - 1):
                support[j], weights[j] = support[j + 1], weights[j + 1]
            count -= 1
    return count


@compiled(inner=True)
def index_of_farthest(squares, centre, points):
    """Set the squared distances of points from a centre; return the index of the farthest."""
    # One coordinate after another, so that several points go at once.
    for k in range(len(points)):
        component, c = points[k], centre[k]
        if k == 0:
            for i in range(squares.size):
                squares[i] = (component[i] - c) ** 2
        else:
            for i in range(squares.size):
                squares[i] += (component[i] - c) ** 2
    return index_of_largest(squares)


@compiled(inner=True)
def index_of_largest(values):
    """Return the index of the largest value."""
    # Four at once: one after another each would wait for the one before.
    a = b = c = d = values[0]
    fours = values.size // 4 * 4
    for i in range(0, fours, 4):
        a, b = max(a, values[i]), max(b, values[i + 1])
        c, d = max(c, values[i + 2]), max(d, values[i + 3])
    for i in range(fours, values.size):
        a = max(a, values[i])
    largest = max(a, b, c, d)
    for i in range(values.size):
        if values[i] == largest:
            return i
    return 0


@compiled(inner=True)
def _move_weights(weights, target, count, dependent):
    """Move weights towards a target until one reaches zero; return its index, or -1 if none does.

    For dependent points the target is a direction along which the radius grows and the mean does
    not change.
    """
    step, leaving = math.inf if dependent else 1.0, -1
    for j in range(count):
        if target[j] < 0.0:
            share = weights[j] / (-target[j] if dependent else weights[j] - target[j])
            if share < step:
                step, leaving = share, j
    for j in range(count):
        weights[j] += step * (target[j] if dependent else target[j] - weights[j])
    return leaving


@compiled(inner=True)
def _equidistant_weights(target, support, count, points, matrix, right):
    """Set `target` to weights of the circumcentre; if dependent, to a change, and return True.

    Return True if the last point lies in the space of the others. The weights are then set to the
    change of all weights that leaves the mean unchanged, with 1 for the last point.
    """
    last = count - 2
    first = support[0]
    # Cholesky factors of 2 (p_i - p_0).(p_j - p_0), and the right side.
    for i in range(count - 1):
        a = support[i + 1]
        square = 0.0
        for k in range(len(points)):
            square += (points[k, a] - points[k, first]) ** 2
        value = square
        for j in range(i + 1):
            b = support[j + 1]
            dot = 0.0
            for k in range(len(points)):
                dot += (points[k, a] - points[k, first]) * (points[k, b] - points[k, first])
            entry = 2.0 * dot
            for k in range(j):
                entry -= matrix[i, k] * matrix[j, k]
            if j < i:
                matrix[i, j] = entry / matrix[j, j]
                value -= matrix[i, j] * right[j]
            elif i == last and entry <= 1e-13 * square:
                target[count - 1] = 1.0
                _back_substitute(target, matrix, -matrix[last], last)
                target[0] = -target[1:count].sum()
                return True
            else:
                matrix[i, i] = math.sqrt(entry)
                right[i] = value / matrix[i, i]
    _back_substitute(target, matrix, right, last + 1)
    target[0] = 1.0 - target[1:count].sum()
    return False


@compiled(inner=True)
def _back_substitute(out, matrix, right, count):
    """Set out[1:] to the solution of L^T x = right, with L the lower part of a matrix."""
    for row in range(count - 1, -1, -1):
        back = right[row]
        for k in range(row + 1, count):
            back -= matrix[k, row] * out[k + 1]
        out[row + 1] = back / matrix[row, row]


@compiled
def enclosing_circle(support, weights, points, squares, enough=0.0):
    """Find the smallest circle, or one not above `enough`; return support size and squared radius.

    Two points hold it, or three that make an acute triangle: the farthest point outside replaces
    one of them (Elzinga & Hearn, Transp. Sci. 6 (1972) 379). The search begins with the first two
    entries of `support`: points of a nearby circle, or any. It ends early once the squared radius
    is at most `enough`; the circle may then be too large.
    """
    count, largest = 2, 0.0
    weights[0], weights[1] = 0.5, 0.5
    for _ in range(MAX_STEPS):
        x = y = 0.0
        for j in range(count):
            x += weights[j] * points[0, support[j]]
            y += weights[j] * points[1, support[j]]
        centre = x, y
        square = (points[0, support[0]] - x) ** 2 + (points[1, support[0]] - y) ** 2
        far = index_of_farthest(squares, centre, points)
        largest = squares[far]
        if largest <= max(square * (1.0 + 1e-14), enough):
            break
        if count == 3:
            support[_replaced_point(support, points, centre, far)] = far
        else:
            support[2] = far
        count = _centre_of_three(support, weights, points)
    return count, largest


@compiled(inner=True)
def _replaced_point(support, points, centre, far):
    """Return the index of the support point of a circle that a point outside replaces.

    Not the farthest from it; of the others the one on its side of the line from there through the
    centre.
    """
    x, y = points[0, far], points[1, far]
    away, largest = 0, -1.0
    for j in range(3):
        d = (points[0, support[j]] - x) ** 2 + (points[1, support[j]] - y) ** 2
        if d > largest:
            away, largest = j, d
    ox, oy = centre[0], centre[1]
    lx, ly = ox - points[0, support[away]], oy - points[1, support[away]]
    side = lx * (y - oy) - ly * (x - ox)
    for j in range(3):
        px, py = points[0, support[j]], points[1, support[j]]
        if j != away and side * (lx * (py - oy) - ly * (px - ox)) > 0.0:
            return j
    return (away + 1) % 3


@compiled(inner=True)
def _centre_of_three(support, weights, points):
    """Set weights and support of the smallest circle of three points; return 2 or 3 points."""
    for j in range(3):
        a, b, c = support[j], support[(j + 1) % 3], support[(j + 2) % 3]
        bx, by = points[0, b] - points[0, a], points[1, b] - points[1, a]
        cx, cy = points[0, c] - points[0, a], points[1, c] - points[1, a]
        across = bx * cx + by * cy
        if across <= 0.0:  # an obtuse angle: the other two are enough
            support[0], support[1] = b, c
            weights[0], weights[1] = 0.5, 0.5
            return 2
        weights[j] = across * ((bx - cx) ** 2 + (by - cy) ** 2)
    total = weights[0] + weights[1] + weights[2]
    for j in range(3):
        weights[j] /= total
    return 3
