"""What a cycle of stress does to the point that lives through it.

A path is the stress of one point along the cycle, (n, 6) with the components xx, yy, zz, xy, xz,
yz. Deviators s are points of a space of five dimensions, in which the distance is
sqrt(s:s/2), so that sqrt(J2) is the distance from its origin and a torsion of the amplitude tau is
tau away:

    ((s_xx - s_yy)/2, (s_xx + s_yy - 2 s_zz)/(2 sqrt 3), s_xy, s_xz, s_yz).

Sources: Dang Van, Griveau & Message, in Biaxial and Multiaxial Fatigue (1989) 479; Crossland, Proc.
Int. Conf. Fatigue of Metals (1956) 138; Findley, J. Eng. Ind. 81 (1959) 301; Fatemi & Socie,
Fatigue Fract. Eng. Mater. Struct. 11 (1988) 149; Papadopoulos, Fatigue Fract. Eng. Mater. Struct.
21 (1998) 269 for the smallest ball; Melan (1938) and Koiter (1960) by Johnson, Contact Mechanics
(1985), section 9.2, for shakedown.
"""

import math

import numpy as np

from tractive_sam.kernels.compiled import compiled

MOST = 200
"""Most steps of a search that ends after some ten."""

ROOT3 = math.sqrt(3.0)


@compiled
def deviators(out, path):
    """Set the deviators (5, n) of a path, in the coordinates above."""
    for i in range(path.shape[1]):
        xx, yy, zz = path[0, i], path[1, i], path[2, i]
        out[0, i] = 0.5 * (xx - yy)
        out[1, i] = (xx + yy - 2.0 * zz) / (2.0 * ROOT3)
        for k in range(3):
            out[2 + k, i] = path[3 + k, i]


@compiled
def enclosing_ball(centre, support, weights, points, squares, begun=0):
    """Find the smallest ball that encloses points.

    Minimises over c the largest |p_i - c|². In the dual c is the mean of some of the points with
    positive weights and equal distances: an active set of these grows by the farthest
    point and loses those whose weight falls to zero, until no point is farther. So it ends after
    few steps with the exact ball (Gärtner, ESA 1999, 325; Fischer, Gärtner & Kutz, ESA 2003, 630).

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
        How many of the given support to begin with: points that held a ball like this one.

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
        support[0] = _index_of_farthest(squares, points[:, 0], points)
        support[1] = _index_of_farthest(squares, points[:, support[0]], points)
    weights[0], weights[1] = 0.5, 0.5
    for j in range(2, begun):
        count = _add_support(support, weights, count, support[j], points, target, matrix, right)
    for _ in range(MOST):
        first, radius2 = support[0], 0.0
        for k in range(m):
            centre[k] = 0.0
            for j in range(count):
                centre[k] += weights[j] * points[k, support[j]]
            radius2 += (points[k, first] - centre[k]) ** 2
        far = _index_of_farthest(squares, centre, points)
        largest = squares[far]
        if not largest > radius2 * (1.0 + 1e-14):  # nor where it is nan
            break
        count = _add_support(support, weights, count, far, points, target, matrix, right)
    return count, largest


@compiled(inner=True)
def _squared_distance(points, i, j):
    """Return the squared distance of two points."""
    square = 0.0
    for k in range(len(points)):
        square += (points[k, i] - points[k, j]) ** 2
    return square


@compiled(inner=True)
def _add_support(support, weights, count, far, points, target, matrix, right):
    """Add a point to the support of a ball, and drop points no longer needed; return its size."""
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
def _index_of_farthest(squares, centre, points):
    """Set the squared distances from the centre, and return the index of the farthest point."""
    # One coordinate after another, so that several points go at once.
    for k in range(len(points)):
        own, c = points[k], centre[k]
        if k == 0:
            for i in range(squares.size):
                squares[i] = (own[i] - c) ** 2
        else:
            for i in range(squares.size):
                squares[i] += (own[i] - c) ** 2
    return _index_of_largest(squares)


@compiled(inner=True)
def _index_of_largest(values):
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
    """Move weights towards a target while all are positive; return the first that reaches zero.

    Of dependent points the target is a direction, along which they keep their mean and the radius
    grows.
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
    """Set the weights of the point with equal distances from all support points of a ball.

    True where the last of them lies in the space of the others: then the change of all weights
    that leaves the mean where it is, with that of the last one 1.
    """
    last = count - 2
    first = support[0]
    # Cholesky factors of 2 (p_i - p_0).(p_j - p_0), and the right side.
    for i in range(count - 1):
        a = support[i + 1]
        own = 0.0
        for k in range(len(points)):
            own += (points[k, a] - points[k, first]) ** 2
        value = own
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
            elif i == last and entry <= 1e-13 * own:
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
def enclosing_radii(out, paths):
    """Compute the radius of the smallest ball around each deviatoric path.

    The largest sqrt(J2) that is left when the best constant deviator is added to the cycle: the
    amplitude of Crossland, and the yield stress in shear below which nothing lets the cycle become
    elastic.

    Parameters
    ----------
    out : ndarray, shape (paths,)
        In the unit of the stress.
    paths : ndarray, shape (paths, 6, n)
        Stresses.
    """
    n = paths.shape[2]
    points, squares, centre = np.empty((5, n)), np.empty(n), np.empty(5)
    support, weights, count = np.empty(7, np.int64), np.empty(7), 0
    for k in range(len(paths)):
        deviators(points, paths[k])
        count, square = enclosing_ball(centre, support, weights, points, squares, count)
        out[k] = math.sqrt(square)


@compiled
def tresca(e):
    """Return the largest shear stress of a deviator, from its five coordinates.

    With J2 and J3: sqrt(J2) sin(theta + pi/3), cos(3 theta) = 3 sqrt 3 J3 / (2 J2^(3/2)).
    """
    j2 = e[0] ** 2 + e[1] ** 2 + e[2] ** 2 + e[3] ** 2 + e[4] ** 2
    if j2 <= 0.0:
        return 0.0
    third = e[1] / ROOT3
    xx, yy, zz = e[0] + third, third - e[0], -2.0 * third
    xy, xz, yz = e[2], e[3], e[4]
    j3 = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    cosine = 1.5 * ROOT3 * j3 / (j2 * math.sqrt(j2))
    theta = math.acos(min(max(cosine, -1.0), 1.0)) / 3.0
    return math.sqrt(j2) * math.sin(theta + math.pi / 3.0)


@compiled
def dang_van(out, radius, paths, a):
    """Compute the largest tau(x) + a sigma_h(x) of each path, and the radius of `enclosing_radii`.

    tau is the largest shear stress of s minus the centre of the smallest ball around its path,
    sigma_h the hydrostatic stress; arguments as in `enclosing_radii`.
    """
    n = paths.shape[2]
    points, squares, centre = np.empty((5, n)), np.empty(n), np.empty(5)
    support, weights, count = np.empty(7, np.int64), np.empty(7), 0
    most, pulled, own = np.empty(n), np.empty(n), np.empty(5)
    for k in range(len(paths)):
        path = paths[k]
        deviators(points, path)
        count, square = enclosing_ball(centre, support, weights, points, squares, count)
        radius[k] = math.sqrt(square)
        for i in range(n):
            pulled[i] = a * (path[0, i] + path[1, i] + path[2, i]) / 3.0
            most[i] = math.sqrt(squares[i]) + pulled[i]  # tau is at most sqrt(J2)
        worst, i = -math.inf, _index_of_largest(most)
        while most[i] > worst:
            for c in range(5):
                own[c] = points[c, i] - centre[c]
            worst = max(worst, tresca(own) + pulled[i])
            most[i] = -math.inf
            i = _index_of_largest(most)
        out[k] = worst


@compiled
def shakedown_layer(out, paths):
    """Compute the sqrt(J2) that remains of cycles at one depth with the best residual stress.

    Residual stresses that rolling leaves do not change along x: rho_xx(y, z) of any form and
    rho_yy(z) of depth alone are in equilibrium and leave the surface free (Melan: a load below the
    yield stress over this is certain to become elastic). In the plane of the first two coordinates
    of a deviator rho_xx acts along (sqrt 3, 1)/2, and moves the point by some c there; across it,
    rho_yy moves all points of the depth by r = rho_yy/2. With p and q the coordinates along and
    across, J2 of the sum is

        J2 - 2 c p + 2 r q + c² + r²,

    with c the value that minimises the largest one along each path, and then r the value that
    minimises the largest of all paths. The worst point of a path bounds this from below at every c,
    the worst points of a depth at every r, each by A + 2 B c + c²: the next c or r is where two
    such bounds, the last from either side, are smallest together.

    Parameters
    ----------
    out : ndarray, shape (paths,)
        In the unit of the stress.
    paths : ndarray, shape (paths, 6, n)
        Stresses at one depth.

    Returns
    -------
    float
        rho_yy.
    """
    count, _, n = paths.shape
    p, q, j2 = np.empty((count, n)), np.empty((count, n)), np.empty((count, n))
    e = np.empty((5, n))
    for k in range(count):
        deviators(e, paths[k])
        for i in range(n):
            p[k, i] = 0.5 * (ROOT3 * e[0, i] + e[1, i])
            q[k, i] = 0.5 * (ROOT3 * e[1, i] - e[0, i])
            j2[k, i] = e[0, i] ** 2 + e[1, i] ** 2 + e[2, i] ** 2 + e[3, i] ** 2 + e[4, i] ** 2
    # With rho_xx = 0 no path has more left.
    fits, at = np.empty(count), np.zeros(count)
    known = np.zeros(count, np.bool_)
    for k in range(count):
        fits[k] = j2[k, _index_of_largest(j2[k])]
    room = np.empty(n), np.empty(n), np.empty((2, 2)), np.empty(2)
    r, best, best_r, bound = 0.0, math.inf, 0.0, 0.0
    # A and B of the last bounds whose minimum is to the right, and to the left.
    cuts = np.full((2, 2), math.nan)
    for _ in range(MOST):
        likely = int(np.argmax(np.sqrt(fits) + np.abs(r - at)))
        worst, b = _remaining_shear(p[likely], q[likely], j2[likely], r, room)
        fits[likely], at[likely], known[likely] = worst, r, True
        for k in range(count):
            # The root of what is left changes by no more than r: this one is not the largest.
            if k == likely or math.sqrt(fits[k]) + abs(r - at[k]) < math.sqrt(max(bound, worst)):
                continue
            fits[k], mean = _remaining_shear(p[k], q[k], j2[k], r, room)
            at[k], known[k] = r, True
            if fits[k] > worst:
                worst, b = fits[k], mean
        if worst < best:
            best, best_r = worst, r
        side = 0 if b + r < 0.0 else 1
        cuts[side, 0], cuts[side, 1] = worst - 2.0 * b * r - r * r, b
        before = r
        r, bound = _lowest_upper_bound(cuts[side], cuts[1 - side])
        bound = max(bound, 0.0)
        if best - bound <= 1e-12 * best or r == before:
            break
    for k in range(count):
        if at[k] != best_r or not known[k]:
            fits[k], _ = _remaining_shear(p[k], q[k], j2[k], best_r, room)
        out[k] = math.sqrt(fits[k])
    return 2.0 * best_r


@compiled(inner=True)
def _remaining_shear(p, q, j2, r, room):
    """Return the remaining J2 of a path at r with its best c, and the mean q of its support."""
    fixed, values, cuts, means = room
    for i in range(p.size):
        fixed[i] = j2[i] + 2.0 * r * q[i]
    cuts[:] = math.nan
    c, best, bound, side = 0.0, math.inf, -math.inf, 0
    for _ in range(MOST):
        for i in range(p.size):
            values[i] = fixed[i] - 2.0 * c * p[i]
        i = _index_of_largest(values)
        best = min(best, values[i] + c * c)
        side = 0 if c < p[i] else 1
        cuts[side, 0], cuts[side, 1], means[side] = fixed[i], -p[i], q[i]
        before = c
        c, bound = _lowest_upper_bound(cuts[side], cuts[1 - side])
        if best - bound <= 1e-14 * abs(best) or c == before:
            break
    mean, one, other = means[side], -cuts[side, 1], -cuts[1 - side, 1]
    if one not in (c, other) and not math.isnan(other):
        share = (c - one) / (other - one)  # by which c is the mean p, too
        mean = (1.0 - share) * mean + share * means[1 - side]
    return max(best + r * r, 0.0), mean  # rounding may leave less than none


@compiled(inner=True)
def _lowest_upper_bound(one, other):
    """Return the place and value of the minimum of the larger of two parabolas A + 2 B r + r².

    It is at the minimum of either, or where they meet.
    """
    a, b = one
    if math.isnan(other[1]) or other[1] == b:
        return -b, a - b * b
    c, d = other
    if a - b * b >= c - 2.0 * d * b + b * b:
        return -b, a - b * b
    if c - d * d >= a - 2.0 * b * d + d * d:
        return -d, c - d * d
    r = 0.5 * (c - a) / (b - d)
    return r, a + 2.0 * b * r + r * r


@compiled
def enclosing_circle(support, weights, points, squares, enough=0.0):
    """Find the smallest circle around points in a plane; arguments as in `enclosing_ball`.

    Two points hold it, or three that make an acute triangle: the farthest point outside takes the
    place of one of them (Elzinga & Hearn, Transp. Sci. 6 (1972) 379). It begins with the first two
    of the given support: those of a circle nearby, or any. Once the square is no larger than
    `enough` it may be too large.
    """
    count, largest = 2, 0.0
    weights[0], weights[1] = 0.5, 0.5
    for _ in range(MOST):
        x = y = 0.0
        for j in range(count):
            x += weights[j] * points[0, support[j]]
            y += weights[j] * points[1, support[j]]
        centre = x, y
        square = (points[0, support[0]] - x) ** 2 + (points[1, support[0]] - y) ** 2
        far = _index_of_farthest(squares, centre, points)
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
    """Return which of three support points of a circle is replaced by one outside.

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
    """Set the weights of the centre of the circle of three points; return how many support it."""
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


@compiled
def evaluate_plane(path, normal, sum_k, product_k, room, enough=-math.inf):
    """Evaluate the criterion on a plane: shear amplitude and largest normal stress.

    Return tau_a + sum_k sigma_n,max or tau_a (1 + product_k sigma_n,max), depending on the factors;
    the number of support points of the circle of the shear; and the index of the point with the
    largest normal stress. A value up to `enough` may be too large.
    """
    on_plane, squares, support, weights, look, _ = room
    _stress_factors(look, normal)
    xx, yy, zz, xy, xz, yz = path[0], path[1], path[2], path[3], path[4], path[5]
    for k in range(3):
        out, a, b, c = on_plane[k], look[k, 0], look[k, 1], look[k, 2]
        d, e, f = look[k, 3], look[k, 4], look[k, 5]
        for i in range(out.size):
            out[i] = a * xx[i] + b * yy[i] + c * zz[i] + d * xy[i] + e * xz[i] + f * yz[i]
    at = _index_of_largest(on_plane[0])
    high = on_plane[0, at]
    factor = max(1.0 + product_k * high, 0.0)
    radius = max(enough - sum_k * high, 0.0) / max(factor, 1e-300)
    count, square = enclosing_circle(support, weights, on_plane[1:], squares, radius * radius)
    return math.sqrt(square) * factor + sum_k * high, count, at


@compiled(inner=True)
def _stress_factors(look, normal):
    """Compute the factors of stress components for the normal and shear stresses on a plane."""
    n = normal[0], normal[1], normal[2]
    e, f = _perpendicular_axes(n)
    for k, (u, v) in enumerate(((n, n), (e, n), (f, n), (e, e), (e, f), (f, f))):
        look[k, 0], look[k, 1], look[k, 2] = u[0] * v[0], u[1] * v[1], u[2] * v[2]
        look[k, 3] = u[0] * v[1] + u[1] * v[0]
        look[k, 4] = u[0] * v[2] + u[2] * v[0]
        look[k, 5] = u[1] * v[2] + u[2] * v[1]


SIDE = 7
"""Cells along each side of a face of a cube in the first search; three faces are half a sphere."""

ENOUGH = 1e-4
"""What a critical plane may miss, over its value: where a cell can hold no more, it is left."""

LIKELY = 0.5
"""Share of the most by which a value may fall towards the corner of a cell: with all of it nothing
can be missed, at twice the time. Of 11,000 paths, of lines and discs, out of phase and random, none
missed `ENOUGH` with half of it, and 26 of them, up to 0.2 %, with less than a third."""

DIVIDED = 12
"""How often a cell is divided at most: its normals are then within a hundredth of a degree."""

STEPS, LONGEST, SHORTENED, SETTLED = 20, 0.15, 6, 1e-8
"""Newton steps towards a maximum, the longest of them, radians, how often one that does not lead up
is made shorter, and the gain, over the value, from which on none is worth its work."""


@compiled
def critical_plane(out, paths, sum_k, product_k):
    """Compute the largest value over all planes of a shear amplitude with normal stress.

    tau_a + sum_k sigma_n,max (Findley) or tau_a (1 + product_k sigma_n,max) (Fatemi-Socie); tau_a
    is the radius of the smallest circle around the path of the shear stress on the plane. Both are
    the largest of smooth functions of the normal, one for each set of support points of the circle,
    and a path of many points has many maxima close together. So normals are searched in cells of a
    cube around the sphere, and a cell is divided in four until it cannot hold a value above the
    largest one so far (see `_bound_curvature`). From each larger value Newton steps lead to the
    nearest maximum; the search begins with the critical plane of the previous path.

    Parameters
    ----------
    out : ndarray, shape (paths,)
        In the unit of the stress; up to `ENOUGH` too small.
    paths : ndarray, shape (paths, 6, n)
        Stresses.
    sum_k, product_k : float
        Sensitivities; one of them is zero, the second is per unit of the stress.
    """
    n, cells = paths.shape[2], _first_cells()
    half, count = cells[0, 3], len(cells)
    normals, reach = np.empty((count, 3)), np.empty(count)
    for c in range(count):
        reach[c] = _cell_normal(normals[c], cells[c])
    looks, box, values = _stress_factors_of_planes(normals), np.empty((6, count)), np.empty(count)
    support, weights = np.zeros(3, np.int64), np.empty(3)
    room = np.empty((3, n)), np.empty(n), support, weights, np.empty((6, 6)), np.empty((4, 6))
    ball = np.empty((5, n)), np.empty(n), np.empty(5), np.empty(7, np.int64), np.empty(7)
    # Each cell that is divided leaves three more than there were.
    stack, normal, last = np.empty((count + 3 * DIVIDED, 4)), np.empty(3), normals[0].copy()
    smallest = half * 0.5**DIVIDED
    for k in range(len(paths)):
        path = paths[k]
        bend = LIKELY * _bound_curvature(path, sum_k, product_k, ball)
        _stress_ranges(box, path, looks)
        for c in range(count):  # with the rectangle's diagonal: it is never too small
            amplitude = 0.5 * math.hypot(box[3, c] - box[2, c], box[5, c] - box[4, c])
            factor = max(1.0 + product_k * box[1, c], 0.0)
            values[c] = amplitude * factor + sum_k * box[1, c]
        best = max(_local_maximum(last, path, sum_k, product_k, room), 0.0)
        _copy(normal, normals[_index_of_largest(values)])
        improved = _local_maximum(normal, path, sum_k, product_k, room)
        if improved > best:
            best = improved
            _copy(last, normal)
        left = 0
        for c in range(count):
            if values[c] + bend * reach[c] > best * (1.0 + ENOUGH):
                stack[left] = cells[c]
                left += 1
        while left > 0:
            left -= 1
            face, u, v, side = stack[left]
            far = _cell_normal(normal, stack[left])
            enough = best * (1.0 + ENOUGH) - bend * far
            value = evaluate_plane(path, normal, sum_k, product_k, room, enough)[0]
            if value <= enough or side <= smallest:
                continue
            if value > best:
                improved = _local_maximum(normal, path, sum_k, product_k, room)
                if improved > best:
                    best = improved
                    _copy(last, normal)
            side *= 0.5
            for j in range(4):
                stack[left, 0], stack[left, 3] = face, side
                stack[left, 1] = u + side if j % 2 else u - side
                stack[left, 2] = v + side if j // 2 else v - side
                left += 1
        out[k] = best


@compiled(inner=True)
def _first_cells():
    """Return the cells of the first search (m, 4): face, angles u, v of the middle, half side."""
    cells, half = np.empty((3 * SIDE * SIDE, 4)), math.pi / 4 / SIDE
    for k in range(len(cells)):
        cells[k, 0], cells[k, 3] = k // (SIDE * SIDE), half
        cells[k, 1] = half * (1 + 2 * (k // SIDE % SIDE)) - math.pi / 4
        cells[k, 2] = half * (1 + 2 * (k % SIDE)) - math.pi / 4
    return cells


@compiled(inner=True)
def _cell_normal(normal, cell):
    """Set the normal in the middle of a cell; return the squared angle of its farthest corner.

    Across a face of the cube normals are (1, tan u, tan v): the sides of a cell are great circles,
    so no point is farther than a corner, and of these it is one on the longer diagonal.
    """
    face, a, b, t = int(cell[0]), math.tan(cell[1]), math.tan(cell[2]), math.tan(cell[3])
    square = 1.0 + a * a + b * b
    normal[face] = 1.0 / math.sqrt(square)
    normal[(face + 1) % 3], normal[(face + 2) % 3] = a * normal[face], b * normal[face]
    farthest = 0.0
    for side in (-t, t):
        other = -side if a * b > 0.0 else side
        x, y = (a + side) / (1.0 - a * side), (b + other) / (1.0 - b * other)
        along = 1.0 + a * x + b * y
        # The square of the angle is less than that of its tangent.
        farthest = max(farthest, square * (1.0 + x * x + y * y) / (along * along) - 1.0)
    return farthest


@compiled(inner=True)
def _bound_curvature(path, sum_k, product_k, ball):
    """Bound the curvature of the criterion around a maximum, over the squared angle, radians.

    Take the points i that hold the circle of the critical plane, with their weights w. For each
    plane, the circle is no smaller than sqrt(sum of w |t_i - t|²), t the mean, and that no smaller
    than its share in the direction that it has in the critical plane. As the normal turns by an
    angle, shear stresses go with its sine and the sine of twice it, so the second derivative of
    that is up to 4 sqrt(sum of w R_i²), with R_i the largest shear stress of the difference of
    point i from the mean: up to 4 times the radius r of the smallest ball around the deviators. The
    normal stress of a point has one up to 4 sqrt(J2), and a first derivative up to 2 sqrt(J2); both
    together have none at the maximum.
    """
    points, squares, centre, support, weights = ball
    deviators(points, path)
    radius = math.sqrt(enclosing_ball(centre, support, weights, points, squares)[1])
    shear, highest = 0.0, -math.inf
    for i in range(path.shape[1]):
        j2 = 0.0
        for c in range(5):
            j2 += points[c, i] ** 2
        root = math.sqrt(j2)
        # No normal stress is farther than 2/sqrt(3) sqrt(J2) from the mean of all.
        mean = (path[0, i] + path[1, i] + path[2, i]) / 3.0
        shear, highest = max(shear, root), max(highest, mean + 2.0 / ROOT3 * root)
    factor = max(1.0 + product_k * highest, 0.0) + 3.0 * product_k * shear
    return 2.0 * (radius * factor + sum_k * shear)


@compiled(inner=True)
def _copy(out, values):
    """Copy an array of one dimension.

    In place of an assignment to a slice, whose check of shapes takes seconds to compile.
    """
    for i in range(out.size):
        out[i] = values[i]


@compiled(inner=True)
def _stress_factors_of_planes(normals):
    """Return the factors for normal and both shear stresses on planes (3, 6, m)."""
    looks, look = np.empty((3, 6, len(normals))), np.empty((6, 6))
    for c in range(len(normals)):
        _stress_factors(look, normals[c])
        for k in range(3):
            _copy(looks[k, :, c], look[k])
    return looks


@compiled(inner=True)
def _stress_ranges(box, path, looks):
    """Compute the range (6, m) of the normal and both shear stresses along a path."""
    box[0::2], box[1::2] = math.inf, -math.inf
    for i in range(path.shape[1]):
        xx, yy, zz = path[0, i], path[1, i], path[2, i]
        xy, xz, yz = path[3, i], path[4, i], path[5, i]
        for k in range(3):
            a, low, high = looks[k], box[2 * k], box[2 * k + 1]
            for c in range(low.size):
                t = a[0, c] * xx + a[1, c] * yy + a[2, c] * zz
                t += a[3, c] * xy + a[4, c] * xz + a[5, c] * yz
                # Written out: so it is done for several planes at once.
                low[c] = t if t < low[c] else low[c]
                high[c] = t if t > high[c] else high[c]


@compiled
def _local_maximum(normal, path, sum_k, product_k, room):
    """Return the local maximum that Newton steps reach from a normal."""
    trial = np.empty(3)
    here, count, at = evaluate_plane(path, normal, sum_k, product_k, room)
    for _ in range(STEPS):
        a, b = newton_step(path, here, count, at, sum_k, product_k, room)
        gain = 0.0
        for _ in range(SHORTENED):
            turn_normal(trial, normal, a, b)
            there, count, at = evaluate_plane(path, trial, sum_k, product_k, room)
            gain = there - here
            if gain > 0.0:
                here = there
                _copy(normal, trial)
                break
            a, b = 0.4 * a, 0.4 * b
        if gain <= SETTLED * here:  # the next gain would be the square of this one
            break
    return here


@compiled
def newton_step(path, here, count, at, sum_k, product_k, room):
    """Return the Newton step (a, b) along the axes of the plane evaluated last.

    The squared radius is the largest, over weights w of the points that hold the circle, of the
    weighted mean of their |t_i - t|², t the weighted mean of their shear: at fixed weights its
    derivatives are those of the shear of stresses, and that the weights follow adds C^T M^-1 C,
    with M and C the second derivatives by weights, and by weights and axes.
    """
    _, _, support, weights, look, seen = room
    for k in range(6):
        seen[3, k] = 0.0
        for j in range(count):
            seen[j, k] = 0.0
            for c in range(6):
                seen[j, k] += look[k, c] * path[c, support[j]]
            seen[3, k] += weights[j] * seen[j, k]
    ga = gb = haa = hab = hbb = square = 0.0
    for j in range(count):
        for k in range(6):
            seen[j, k] -= seen[3, k]
        n, en, fn, ee, ef, ff = seen[j]
        # Derivatives of the square of the shear stress, en² + fn², as the normal turns.
        a, b = 2.0 * ((ee - n) * en + ef * fn), 2.0 * (ef * en + (ff - n) * fn)
        w = weights[j]
        square += w * (en * en + fn * fn)
        ga, gb = ga + w * a, gb + w * b
        haa += w * (2.0 * ((ee - n) ** 2 + ef * ef - fn * fn) - 8.0 * en * en)
        hbb += w * (2.0 * ((ff - n) ** 2 + ef * ef - en * en) - 8.0 * fn * fn)
        hab += w * (2.0 * ef * (ee + ff - 2.0 * n) - 6.0 * en * fn)
        seen[j, 3], seen[j, 4] = a, b
    if count == 3:
        x0, y0, x1, y1 = _column_differences(seen, 1)
        a0, b0, a1, b1 = _column_differences(seen, 3)
        m00, m01, m11 = x0 * x0 + y0 * y0, x0 * x1 + y0 * y1, x1 * x1 + y1 * y1
        det = 2.0 * (m00 * m11 - m01 * m01)
        if det > 1e-12 * m00 * m11:
            haa += (m11 * a0 * a0 - 2.0 * m01 * a0 * a1 + m00 * a1 * a1) / det
            hbb += (m11 * b0 * b0 - 2.0 * m01 * b0 * b1 + m00 * b1 * b1) / det
            hab += (m11 * a0 * b0 - m01 * (a0 * b1 + a1 * b0) + m00 * a1 * b1) / det
    radius = math.sqrt(square)
    if radius > 0.0:
        ga, gb = 0.5 * ga / radius, 0.5 * gb / radius
        haa, hbb = (0.5 * haa - ga * ga) / radius, (0.5 * hbb - gb * gb) / radius
        hab = (0.5 * hab - ga * gb) / radius
    # With the normal stress, with the derivatives 2 en, 2 fn; 2 (ee - n), 2 ef, 2 (ff - n).
    for k in range(6):
        seen[3, k] = 0.0
        for c in range(6):
            seen[3, k] += look[k, c] * path[c, at]
    n, en, fn, ee, ef, ff = seen[3]
    factor, twice = 1.0 + product_k * n, 2.0 * (product_k * radius + sum_k)
    haa = factor * haa + 4.0 * product_k * ga * en + twice * (ee - n)
    hbb = factor * hbb + 4.0 * product_k * gb * fn + twice * (ff - n)
    hab = factor * hab + 2.0 * product_k * (ga * fn + gb * en) + twice * ef
    return solve_newton_step(
        here, factor * ga + twice * en, factor * gb + twice * fn, haa, hab, hbb
    )


@compiled(inner=True)
def _column_differences(seen, k):
    """Return the differences of two columns from the first point."""
    x, y = seen[0, k], seen[0, k + 1]
    return seen[1, k] - x, seen[1, k + 1] - y, seen[2, k] - x, seen[2, k + 1] - y


@compiled
def solve_newton_step(here, ga, gb, haa, hab, hbb):
    """Return the step from gradient and second derivatives, uphill if the curvature is positive."""
    largest = 0.5 * (haa + hbb) + math.hypot(0.5 * (haa - hbb), hab)
    shift = max(0.0, largest + 0.1 * here)
    haa, hbb = haa - shift, hbb - shift
    det = haa * hbb - hab * hab
    if det <= 0.0:
        return 0.0, 0.0
    a, b = -(hbb * ga - hab * gb) / det, -(haa * gb - hab * ga) / det
    shorter = min(1.0, LONGEST / max(math.hypot(a, b), 1e-300))
    return a * shorter, b * shorter


@compiled(inner=True)
def _perpendicular_axes(normal):
    """Return two axes perpendicular to a normal."""
    nx, ny, nz = normal
    if abs(nz) < 0.9:
        h = math.hypot(nx, ny)
        e = -ny / h, nx / h, 0.0
    else:
        h = math.hypot(ny, nz)
        e = 0.0, nz / h, -ny / h
    return e, (ny * e[2] - nz * e[1], nz * e[0] - nx * e[2], nx * e[1] - ny * e[0])


@compiled
def turn_normal(out, normal, a, b):
    """Set the normal turned by (a, b) towards its two perpendicular axes."""
    e, f = _perpendicular_axes((normal[0], normal[1], normal[2]))
    total = 0.0
    for k in range(3):
        out[k] = normal[k] + a * e[k] + b * f[k]
        total += out[k] ** 2
    for k in range(3):
        out[k] /= math.sqrt(total)


@compiled
def monotone(out, x, values, at):
    """Interpolate values by cubics that are monotone wherever the values are.

    Source: Fritsch & Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300, with the three-point formula
    at the ends.

    Parameters
    ----------
    out : ndarray, shape (rows, m)
        Of the values.
    x : ndarray, shape (n,)
        Ascending, at least three.
    values : ndarray, shape (rows, n)
        There.
    at : ndarray, shape (rows, m)
        Places, ascending in each row; beyond the ends the last cubic continues.
    """
    n = x.size
    h, rise, slope = np.diff(x), np.empty(n - 1), np.empty(n)
    for row in range(values.shape[0]):
        for k in range(n - 1):
            rise[k] = (values[row, k + 1] - values[row, k]) / h[k]
        for k in range(1, n - 1):
            slope[k] = 0.0
            if rise[k - 1] * rise[k] > 0.0:
                one, other = 2.0 * h[k] + h[k - 1], h[k] + 2.0 * h[k - 1]
                slope[k] = (one + other) / (one / rise[k - 1] + other / rise[k])
        slope[0] = _end_slope(h[0], h[1], rise[0], rise[1])
        slope[n - 1] = _end_slope(h[n - 2], h[n - 3], rise[n - 2], rise[n - 3])
        k = 0
        for j in range(at.shape[1]):
            while k < n - 2 and at[row, j] >= x[k + 1]:
                k += 1
            t = at[row, j] - x[k]
            c = (3.0 * rise[k] - 2.0 * slope[k] - slope[k + 1]) / h[k]
            d = (slope[k] + slope[k + 1] - 2.0 * rise[k]) / h[k] ** 2
            out[row, j] = values[row, k] + t * (slope[k] + t * (c + t * d))


@compiled(inner=True)
def _end_slope(h, further, rise, next_rise):
    """Return the slope at an end, by the parabola through three points, limited to be monotone."""
    slope = ((2.0 * h + further) * rise - h * next_rise) / (h + further)
    if slope * rise <= 0.0:
        return 0.0
    if rise * next_rise <= 0.0 and abs(slope) > 3.0 * abs(rise):
        return 3.0 * rise
    return slope
