"""Fatigue of a material point by a cycle of stress: enclosing balls, shakedown, interpolation.

A path is the stress of one point along the cycle, (n, 6) with the components xx, yy, zz, xy, xz,
yz. Deviators s are points of a space of five dimensions, in which the distance is
sqrt(s:s/2), so that sqrt(J2) is the distance from its origin and a torsion of the amplitude tau is
tau away:

    ((s_xx - s_yy)/2, (s_xx + s_yy - 2 s_zz)/(2 sqrt 3), s_xy, s_xz, s_yz).

Sources: Dang Van, Griveau & Message, in Biaxial and Multiaxial Fatigue (1989) 479; Crossland, Proc.
Int. Conf. Fatigue of Metals (1956) 138; Papadopoulos, Fatigue Fract. Eng. Mater. Struct. 21 (1998)
269 for the smallest ball.

Sources: Melan (1938) and Koiter (1960) by Johnson, Contact Mechanics (1985), section 9.2.
"""

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


ROOT3 = math.sqrt(3.0)


@compiled
def deviators(out, path):
    """Set `out` (5, n) to the deviatoric coordinates of a stress path (6, n)."""
    for i in range(path.shape[1]):
        xx, yy, zz = path[0, i], path[1, i], path[2, i]
        out[0, i] = 0.5 * (xx - yy)
        out[1, i] = (xx + yy - 2.0 * zz) / (2.0 * ROOT3)
        for k in range(3):
            out[2 + k, i] = path[3 + k, i]


@compiled
def enclosing_radii(out, paths):
    """Set `out` to the radius of the smallest ball around the deviatoric path of each stress path.

    The largest sqrt(J2) that is left when the best constant deviator is added to the cycle: the
    amplitude of Crossland, and the yield stress in shear below which nothing lets the cycle become
    elastic.

    Parameters
    ----------
    out : ndarray, shape (paths,)
        Set to the values of the criterion, in the unit of the stress.
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
    """Return the largest shear stress of a deviator from its five coordinates.

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
    """Set `out` to the largest tau + a sigma_h of each path, and `radius` to its enclosing radius.

    tau is the largest shear stress of s minus the centre of the smallest ball around its path,
    sigma_h the hydrostatic stress; arguments as in `enclosing_radii`.
    """
    n = paths.shape[2]
    points, squares, centre = np.empty((5, n)), np.empty(n), np.empty(5)
    support, weights, count = np.empty(7, np.int64), np.empty(7), 0
    bounds, pulled, deviator = np.empty(n), np.empty(n), np.empty(5)
    for k in range(len(paths)):
        path = paths[k]
        deviators(points, path)
        count, square = enclosing_ball(centre, support, weights, points, squares, count)
        radius[k] = math.sqrt(square)
        for i in range(n):
            pulled[i] = a * (path[0, i] + path[1, i] + path[2, i]) / 3.0
            bounds[i] = math.sqrt(squares[i]) + pulled[i]  # tau is at most sqrt(J2)
        worst, i = -math.inf, index_of_largest(bounds)
        while bounds[i] > worst:
            for c in range(5):
                deviator[c] = points[c, i] - centre[c]
            worst = max(worst, tresca(deviator) + pulled[i])
            bounds[i] = -math.inf
            i = index_of_largest(bounds)
        out[k] = worst


@compiled
def shakedown_layer(out, paths):
    """Set `out` to the sqrt(J2) of cycles at one depth under the best residual stress.

    Residual stresses that rolling leaves do not change along x: rho_xx(y, z) of any form and
    rho_yy(z) of depth alone are in equilibrium and leave the surface free (Melan: a load below the
    yield stress over this is certain to become elastic). In the plane of the first two coordinates
    of a deviator rho_xx acts along (sqrt 3, 1)/2, and moves the point by some c there; across it,
    rho_yy moves all points of the depth by r = rho_yy/2. With p and q the coordinates along and
    across, J2 of the sum is

        J2 - 2 c p + 2 r q + c² + r²,

    with c the value that minimises the largest one along each path, and then r the value that
    minimises the largest of all paths. The worst point of a path bounds this from below at every c,
    the worst points of a depth at every r, each by A + 2 B c + c². The next c or r minimises the
    larger of two bounds, the last one from each side.

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
    computed = np.zeros(count, np.bool_)
    for k in range(count):
        fits[k] = j2[k, index_of_largest(j2[k])]
    room = np.empty(n), np.empty(n), np.empty((2, 2)), np.empty(2)
    r, best, best_r, bound = 0.0, math.inf, 0.0, 0.0
    # A and B of the last bounds with their minimum to the right, and to the left.
    cuts = np.full((2, 2), math.nan)
    for _ in range(MAX_STEPS):
        likely = int(np.argmax(np.sqrt(fits) + np.abs(r - at)))
        worst, b = _remaining_shear(p[likely], q[likely], j2[likely], r, room)
        fits[likely], at[likely], computed[likely] = worst, r, True
        for k in range(count):
            # The root of what is left changes by no more than r: this one is not the largest.
            if k == likely or math.sqrt(fits[k]) + abs(r - at[k]) < math.sqrt(max(bound, worst)):
                continue
            fits[k], mean = _remaining_shear(p[k], q[k], j2[k], r, room)
            at[k], computed[k] = r, True
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
        if at[k] != best_r or not computed[k]:
            fits[k], _ = _remaining_shear(p[k], q[k], j2[k], best_r, room)
        out[k] = math.sqrt(fits[k])
    return 2.0 * best_r


@compiled(inner=True)
def _remaining_shear(p, q, j2, r, room):
    """Return the J2 that remains of a path at r with the best c, and the mean q of its support."""
    fixed, values, cuts, means = room
    for i in range(p.size):
        fixed[i] = j2[i] + 2.0 * r * q[i]
    cuts[:] = math.nan
    c, best, bound, side = 0.0, math.inf, -math.inf, 0
    for _ in range(MAX_STEPS):
        for i in range(p.size):
            values[i] = fixed[i] - 2.0 * c * p[i]
        i = index_of_largest(values)
        best = min(best, values[i] + c * c)
        side = 0 if c < p[i] else 1
        cuts[side, 0], cuts[side, 1], means[side] = fixed[i], -p[i], q[i]
        before = c
        c, bound = _lowest_upper_bound(cuts[side], cuts[1 - side])
        if best - bound <= 1e-14 * abs(best) or c == before:
            break
    mean, place, place_beyond = means[side], -cuts[side, 1], -cuts[1 - side, 1]
    if place not in (c, place_beyond) and not math.isnan(place_beyond):
        share = (c - place) / (place_beyond - place)  # by which c is the mean p, too
        mean = (1.0 - share) * mean + share * means[1 - side]
    return max(best + r * r, 0.0), mean  # rounding may leave less than none


@compiled(inner=True)
def _lowest_upper_bound(first, second):
    """Return argument and value of the minimum of the larger of two parabolas A + 2 B r + r².

    It lies at the minimum of one of them, or at their intersection.
    """
    a, b = first
    if math.isnan(second[1]) or second[1] == b:
        return -b, a - b * b
    c, d = second
    if a - b * b >= c - 2.0 * d * b + b * b:
        return -b, a - b * b
    if c - d * d >= a - 2.0 * b * d + d * d:
        return -d, c - d * d
    r = 0.5 * (c - a) / (b - d)
    return r, a + 2.0 * b * r + r * r


@compiled
def monotone(out, x, values, at):
    """Set `out` to values interpolated by cubics that are monotone wherever the values are.

    Source: Fritsch & Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300, with the three-point formula
    at the ends.

    Parameters
    ----------
    out : ndarray, shape (rows, m)
        Set to the interpolated values.
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
                back, front = 2.0 * h[k] + h[k - 1], h[k] + 2.0 * h[k - 1]
                slope[k] = (back + front) / (back / rise[k - 1] + front / rise[k])
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
    """Return the slope at an end from a parabola through three points, limited to be monotone."""
    slope = ((2.0 * h + further) * rise - h * next_rise) / (h + further)
    if slope * rise <= 0.0:
        return 0.0
    if rise * next_rise <= 0.0 and abs(slope) > 3.0 * abs(rise):
        return 3.0 * rise
    return slope


@compiled
def rolling_residual(out, paths, shear_yield, poisson, settled=1e-7, most=40):
    """Set `out` to the residual stress xx, yy that elastic-perfectly-plastic rolling leaves.

    The strains xx and yy of a layer parallel to the surface are those of the elastic path, and its
    stresses on planes parallel to the surface as well: plastic strains change xx and yy only, by
    (1 - nu²) d(rho_xx) = -E (d(eps_xx) + nu d(eps_yy)), and by the same with x and y exchanged.
    This holds for thin plastic zones (Merwin & Johnson, Proc. IMechE 177 (1963) 676). The plastic
    strain of a step is along the deviator of the end of the step (von Mises). Passes are repeated
    until the residual stress changes by no more than `settled` times the yield stress.

    Parameters
    ----------
    out : ndarray, shape (paths, 2)
        Set to rho_xx, rho_yy, in the unit of the stress.
    paths : ndarray, shape (paths, 6, n)
        Elastic stresses in the order in which the material meets them.
    shear_yield : ndarray, shape (paths,)
        Yield stress in shear k, in the unit of the stress.
    poisson : float
        Poisson's ratio.
    settled : float
        Relative change at which the passes end.
    most : int
        Largest number of passes: above the shakedown limit plastic strain never ends.
    """
    for k in range(len(paths)):
        path, x, y, bound = paths[k], 0.0, 0.0, shear_yield[k] ** 2
        for _ in range(most):
            before_x, before_y = x, y
            for i in range(path.shape[1]):
                shear = path[3, i] ** 2 + path[4, i] ** 2 + path[5, i] ** 2 - bound
                for _ in range(MAX_STEPS):
                    xx, yy, zz = path[0, i] + x, path[1, i] + y, path[2, i]
                    excess = ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 6.0 + shear
                    if excess <= 1e-12 * bound:
                        break
                    mean = (xx + yy + zz) / 3.0
                    along_x, along_y = xx - mean, yy - mean
                    fall_x, fall_y = along_x + poisson * along_y, along_y + poisson * along_x
                    slope = along_x * fall_x + along_y * fall_y
                    if slope <= 0.0:  # no residual stress lowers it: the shear alone yields
                        break
                    x -= excess / slope * fall_x
                    y -= excess / slope * fall_y
            if abs(x - before_x) + abs(y - before_y) <= settled * shear_yield[k]:
                break
        out[k, 0], out[k, 1] = x, y
