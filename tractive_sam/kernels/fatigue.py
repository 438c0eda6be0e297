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
    """Set the deviators (n, 5) of a path, in the coordinates above."""
    for i in range(path.shape[0]):
        xx, yy, zz = path[i, 0], path[i, 1], path[i, 2]
        out[i, 0] = 0.5 * (xx - yy)
        out[i, 1] = (xx + yy - 2.0 * zz) / (2.0 * ROOT3)
        for k in range(3):
            out[i, 2 + k] = path[i, 3 + k]


@compiled
def enclosing(centre, support, weights, points, offsets):
    """The smallest ball around points that are some way out of its space.

    Minimises over c the largest |p_i - c|² + w_i. In the dual c is the mean of some of the points
    with positive weights, all of which are equally far: an active set of these grows by the
    farthest point and loses those whose weight falls to zero, until no point is farther. So it ends
    after few steps with the exact ball (Gärtner, ESA 1999, 325; Fischer, Gärtner & Kutz, ESA 2003,
    630).

    Parameters
    ----------
    centre : ndarray, shape (m,)
        Set to c; m at most 5.
    support : ndarray of int, shape (m + 2,)
        Its first entries are set to the points that hold the ball.
    weights : ndarray, shape (m + 2,)
        Set to their weights, which add up to 1.
    points : ndarray, shape (n, m)
        The points p_i.
    offsets : ndarray, shape (n,)
        w_i >= 0.

    Returns
    -------
    (int, float)
        How many points hold the ball, and its squared radius: the largest |p_i - c|² + w_i.
    """
    m = points.shape[1]
    matrix, right = np.empty((m + 1, m + 1)), np.empty(m + 1)
    target = np.empty(m + 2)
    support[0], weights[0], count = 0, 1.0, 1
    centre[:] = points[0]
    radius2, largest = offsets[0], 0.0
    for _ in range(MOST):
        far, largest = _farthest(centre, points, offsets)
        if largest <= radius2 * (1.0 + 1e-14):
            break
        support[count], weights[count] = far, 0.0
        count += 1
        leaving = 0
        while leaving >= 0:
            dependent = _equally_far(target, support, count, points, offsets, matrix, right)
            leaving = _moved(weights, target, count, dependent)
            if leaving >= 0:
                for j in range(leaving, count - 1):
                    support[j], weights[j] = support[j + 1], weights[j + 1]
                count -= 1
        first = support[0]
        radius2 = offsets[first]
        for k in range(m):
            centre[k] = 0.0
            for j in range(count):
                centre[k] += weights[j] * points[support[j], k]
            radius2 += (points[first, k] - centre[k]) ** 2
    return count, largest


@compiled
def _farthest(centre, points, offsets):
    """The point that is farthest, and its squared distance."""
    far, largest = 0, -1.0
    for i in range(points.shape[0]):
        d = offsets[i]
        for k in range(points.shape[1]):
            d += (points[i, k] - centre[k]) ** 2
        if d > largest:
            far, largest = i, d
    return far, largest


@compiled
def _moved(weights, target, count, dependent):
    """Move weights towards their target as far as all stay positive; which falls to zero, or -1.

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


@compiled
def _equally_far(target, support, count, points, offsets, matrix, right):
    """Set the weights of the point that is equally far from all that hold a ball.

    True where the last of them lies in the space of the others: then the change of all weights
    that leaves the mean where it is, with that of the last one 1.
    """
    m, last = points.shape[1], count - 2
    first = support[0]
    # Cholesky factors of 2 (p_i - p_0).(p_j - p_0), and the right side.
    for i in range(count - 1):
        a = support[i + 1]
        own = 0.0
        for k in range(m):
            own += (points[a, k] - points[first, k]) ** 2
        value = own + offsets[a] - offsets[first]
        for j in range(i + 1):
            b = support[j + 1]
            dot = 0.0
            for k in range(m):
                dot += (points[a, k] - points[first, k]) * (points[b, k] - points[first, k])
            entry = 2.0 * dot
            for k in range(j):
                entry -= matrix[i, k] * matrix[j, k]
            if j < i:
                matrix[i, j] = entry / matrix[j, j]
                value -= matrix[i, j] * right[j]
            elif i == last and entry <= 1e-13 * own:
                target[count - 1] = 1.0
                _solved_back(target, matrix, -matrix[last], last)
                target[0] = -target[1:count].sum()
                return True
            else:
                matrix[i, i] = math.sqrt(entry)
                right[i] = value / matrix[i, i]
    _solved_back(target, matrix, right, last + 1)
    target[0] = 1.0 - target[1:count].sum()
    return False


@compiled
def _solved_back(out, matrix, right, count):
    """Set out[1:] to the solution of L^T x = right, L the lower part of a matrix."""
    for row in range(count - 1, -1, -1):
        back = right[row]
        for k in range(row + 1, count):
            back -= matrix[k, row] * out[k + 1]
        out[row + 1] = back / matrix[row, row]


@compiled
def balls(out, paths):
    """Set the radius of the smallest ball around each deviatoric path.

    The largest sqrt(J2) that is left when the best constant deviator is added to the cycle: the
    amplitude of Crossland, and the yield stress in shear below which nothing lets the cycle become
    elastic.

    Parameters
    ----------
    out : ndarray, shape (paths,)
        In the unit of the stress.
    paths : ndarray, shape (paths, n, 6)
        Stresses.
    """
    n = paths.shape[1]
    points, offsets, centre = np.empty((n, 5)), np.zeros(n), np.empty(5)
    support, weights = np.empty(7, np.int64), np.empty(7)
    for k in range(paths.shape[0]):
        deviators(points, paths[k])
        out[k] = math.sqrt(enclosing(centre, support, weights, points, offsets)[1])


@compiled
def tresca(e):
    """Largest shear stress of a deviator, from its five coordinates.

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
    """Set the largest tau(x) + a sigma_h(x) of each path, and the radius of `balls`.

    tau is the largest shear stress of s minus the centre of the smallest ball around its path,
    sigma_h the hydrostatic stress; arguments as of `balls`.
    """
    n = paths.shape[1]
    points, offsets, centre = np.empty((n, 5)), np.zeros(n), np.empty(5)
    support, weights = np.empty(7, np.int64), np.empty(7)
    norm, pulled = np.empty(n), np.empty(n)
    for k in range(paths.shape[0]):
        deviators(points, paths[k])
        radius[k] = math.sqrt(enclosing(centre, support, weights, points, offsets)[1])
        worst, first = -math.inf, 0
        for i in range(n):
            square = 0.0
            for c in range(5):
                points[i, c] -= centre[c]
                square += points[i, c] ** 2
            norm[i] = math.sqrt(square)
            pulled[i] = a * (paths[k, i, 0] + paths[k, i, 1] + paths[k, i, 2]) / 3.0
            if norm[i] + pulled[i] > worst:
                worst, first = norm[i] + pulled[i], i
        worst = tresca(points[first]) + pulled[first]
        for i in range(n):
            if norm[i] + pulled[i] > worst:  # tau is at most sqrt(J2)
                worst = max(worst, tresca(points[i]) + pulled[i])
        out[k] = worst


@compiled
def shakedown_layer(out, paths):
    """Set what is left of sqrt(J2) of the cycles at one depth when the best residual is added.

    Residual stresses that rolling leaves do not change along x: rho_xx(y, z) of any form and
    rho_yy(z) of depth alone are in equilibrium and leave the surface free (Melan: a load below the
    yield stress over this is certain to become elastic). In the plane of the first two coordinates
    of a deviator rho_xx acts along (sqrt 3, 1)/2, and moves the point across it not at all; there
    rho_yy moves it by r = rho_yy/2, all points of the depth alike. So each path has to fit, along
    one line, a ball with the offsets (q + r)² + s_xy² + s_xz² + s_yz²; and r is sought for which
    the largest of these balls is smallest. The points that hold one bound its squared radius from
    below by A + 2 B r + r² at every r: the next r is where two such bounds, the last from either
    side, are smallest together.

    Parameters
    ----------
    out : ndarray, shape (paths,)
        In the unit of the stress.
    paths : ndarray, shape (paths, n, 6)
        Stresses at one depth.

    Returns
    -------
    float
        rho_yy.
    """
    count, n = paths.shape[:2]
    p, q, w = np.empty((count, n, 1)), np.empty((count, n)), np.empty((count, n))
    deviator = np.empty((n, 5))
    for k in range(count):
        deviators(deviator, paths[k])
        for i in range(n):
            e = deviator[i]
            p[k, i, 0] = 0.5 * (ROOT3 * e[0] + e[1])
            q[k, i] = 0.5 * (ROOT3 * e[1] - e[0])
            w[k, i] = e[2] ** 2 + e[3] ** 2 + e[4] ** 2
    # With rho_xx = 0 no ball is larger than that around the origin.
    fits, at = np.zeros(count), np.zeros(count)
    known = np.zeros(count, np.bool_)
    for k in range(count):
        for i in range(n):
            fits[k] = max(fits[k], p[k, i, 0] ** 2 + q[k, i] ** 2 + w[k, i])
    offsets, centre = np.empty(n), np.empty(1)
    support, weights = np.empty(3, np.int64), np.empty(3)
    room = offsets, centre, support, weights
    r, best, best_r, bound = 0.0, math.inf, 0.0, 0.0
    # A and B of the last bounds whose minimum is to the right, and to the left.
    cuts = np.full((2, 2), math.nan)
    for _ in range(MOST):
        likely = int(np.argmax(np.sqrt(fits) + np.abs(r - at)))
        worst, b = _fitted(p[likely], q[likely], w[likely], r, room)
        fits[likely], at[likely], known[likely] = worst, r, True
        for k in range(count):
            # A radius changes by no more than r: this one is not the largest.
            if k == likely or math.sqrt(fits[k]) + abs(r - at[k]) < math.sqrt(max(bound, worst)):
                continue
            fits[k], mean = _fitted(p[k], q[k], w[k], r, room)
            at[k], known[k] = r, True
            if fits[k] > worst:
                worst, b = fits[k], mean
        if worst < best:
            best, best_r = worst, r
        side = 0 if b + r < 0.0 else 1
        cuts[side, 0], cuts[side, 1] = worst - 2.0 * b * r - r * r, b
        before = r
        r, bound = _lowest(cuts[side], cuts[1 - side])
        bound = max(bound, 0.0)
        if best - bound <= 1e-12 * best or r == before:
            break
    for k in range(count):
        if at[k] != best_r or not known[k]:
            fits[k], _ = _fitted(p[k], q[k], w[k], best_r, room)
        out[k] = math.sqrt(fits[k])
    return 2.0 * best_r


@compiled
def _fitted(p, q, w, r, room):
    """Squared radius of the ball of one path at r, and the mean q of the points that hold it."""
    offsets, centre, support, weights = room
    for i in range(offsets.size):
        offsets[i] = (q[i] + r) ** 2 + w[i]
    held, radius2 = enclosing(centre, support, weights, p, offsets)
    mean = 0.0
    for j in range(held):
        mean += weights[j] * q[support[j]]
    return radius2, mean


@compiled
def _lowest(one, other):
    """Where the larger one of two bounds A + 2 B r + r² is smallest, and that; of one if no other.

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
def _plane(path, normal, sum_k, product_k, room, enough):
    """Value of a critical plane: amplitude of the shear, and the largest normal stress.

    tau_a + sum_k sigma_n,max or tau_a (1 + product_k sigma_n,max), whichever is asked for; less
    exactly, but never too small, where it is not above `enough`.
    """
    shear, offsets, circle, support, weights = room
    nx, ny, nz = normal[0], normal[1], normal[2]
    (ex, ey, ez), (fx, fy, fz) = _axes(nx, ny, nz)
    high = -math.inf
    low_e = low_f = math.inf
    high_e = high_f = -math.inf
    for i in range(path.shape[0]):
        xx, yy, zz, xy, xz, yz = path[i]
        tx = xx * nx + xy * ny + xz * nz
        ty = xy * nx + yy * ny + yz * nz
        tz = xz * nx + yz * ny + zz * nz
        high = max(high, tx * nx + ty * ny + tz * nz)
        e, f = tx * ex + ty * ey + tz * ez, tx * fx + ty * fy + tz * fz
        low_e, high_e = min(low_e, e), max(high_e, e)
        low_f, high_f = min(low_f, f), max(high_f, f)
        shear[i, 0], shear[i, 1] = e, f
    amplitude = 0.5 * math.hypot(high_e - low_e, high_f - low_f)
    factor = max(1.0 + product_k * high, 0.0)
    if amplitude * factor + sum_k * high > enough:
        amplitude = math.sqrt(enclosing(circle, support, weights, shear, offsets)[1])
    return amplitude * factor + sum_k * high


CANDIDATES = 4
"""Planes of the first look that are followed to a maximum of their own."""

NEAR = 0.88
"""Value of a plane of the first look, over the best one, from which it is followed: half their
distance beside the maximum of a shear stress its value is .96 of it."""

APART = 0.95
"""Cosine between candidates: nearer ones lead to the same maximum."""

STEPS, DIFFERENCE, LONGEST, SHORTENED = 12, 1e-3, 0.15, 6
"""Newton steps towards a maximum, the step of their differences and the longest of them, radians,
and how often one that does not lead up is made shorter."""


@compiled
def critical_plane(out, paths, sum_k, product_k, normals):
    """Set the largest value over all planes of a shear amplitude and the largest normal stress.

    tau_a + sum_k sigma_n,max (Findley) or tau_a (1 + product_k sigma_n,max) (Fatemi-Socie); tau_a
    is the radius of the smallest circle around the path of the shear stress on the plane. Both are
    the largest of smooth functions of the normal: at its top so is the value, and from the best of
    the given planes Newton's steps lead there.

    Parameters
    ----------
    out : ndarray, shape (paths,)
        In the unit of the stress.
    paths : ndarray, shape (paths, n, 6)
        Stresses.
    sum_k, product_k : float
        Sensitivities; one of them is zero, the second is per unit of the stress.
    normals : ndarray, shape (m, 3)
        Planes of the first look: unit vectors, spread over half a sphere.
    """
    n = paths.shape[1]
    room = np.empty((n, 2)), np.zeros(n), np.empty(2), np.empty(4, np.int64), np.empty(4)
    chosen = np.empty((CANDIDATES, 3))
    for k in range(paths.shape[0]):
        out[k], count = _looked_around(chosen, paths[k], sum_k, product_k, normals, room)
        for c in range(count):
            out[k] = max(out[k], _maximised(chosen[c], paths[k], sum_k, product_k, room))


@compiled
def _looked_around(chosen, path, sum_k, product_k, normals, room):
    """Set the best normals that are apart; the value of the best one, and how many they are."""
    values, best = np.empty(len(normals)), 0.0
    for c in range(len(normals)):
        values[c] = _plane(path, normals[c], sum_k, product_k, room, NEAR * best)
        best = max(best, values[c])
    count = 0
    while count < CANDIDATES:
        c = int(np.argmax(values))
        if values[c] < NEAR * best or values[c] <= 0.0:
            break
        values[c] = -math.inf
        apart = True
        for j in range(count):
            apart = apart and abs(np.dot(chosen[j], normals[c])) < APART
        if apart:
            chosen[count] = normals[c]
            count += 1
    return best, count


@compiled
def _maximised(normal, path, sum_k, product_k, room):
    """The local maximum that Newton's steps lead to from a normal."""
    trial, e, f, v = np.empty(3), np.empty(3), np.empty(3), np.empty(8)
    here = _plane(path, normal, sum_k, product_k, room, -1.0)
    for _ in range(STEPS):
        _across(e, f, normal)
        for j in range(8):
            # Around: towards e, e + f, f, f - e, ...
            length = DIFFERENCE * (1.0 if j % 2 == 0 else math.sqrt(2.0))
            a, b = math.cos(0.25 * math.pi * j), math.sin(0.25 * math.pi * j)
            _turned(trial, normal, e, f, length * a, length * b)
            v[j] = _plane(path, trial, sum_k, product_k, room, -1.0)
        a, b = _newton(here, v)
        there = here
        for _ in range(SHORTENED):
            _turned(trial, normal, e, f, a, b)
            there = _plane(path, trial, sum_k, product_k, room, -1.0)
            if there > here:
                break
            a, b = 0.4 * a, 0.4 * b
        gain = there - here
        if gain > 0.0:
            here = there
            normal[:] = trial
        if gain <= 1e-13 * here:
            break
    return here


@compiled
def _newton(here, v):
    """The step uphill by values around, a difference away: of Newton where it curves downwards."""
    ge, gf = (v[0] - v[4]) / (2.0 * DIFFERENCE), (v[2] - v[6]) / (2.0 * DIFFERENCE)
    hee = (v[0] + v[4] - 2.0 * here) / DIFFERENCE**2
    hff = (v[2] + v[6] - 2.0 * here) / DIFFERENCE**2
    hef = (v[1] + v[5] - v[3] - v[7]) / (4.0 * DIFFERENCE**2)
    largest = 0.5 * (hee + hff) + math.hypot(0.5 * (hee - hff), hef)
    shift = max(0.0, largest + 0.1 * here)
    hee, hff = hee - shift, hff - shift
    det = hee * hff - hef * hef
    if det <= 0.0:
        return 0.0, 0.0
    a, b = -(hff * ge - hef * gf) / det, -(hee * gf - hef * ge) / det
    shorter = min(1.0, LONGEST / max(math.hypot(a, b), 1e-300))
    return a * shorter, b * shorter


@compiled
def _axes(nx, ny, nz):
    """Two axes across a normal."""
    if abs(nz) < 0.9:
        h = math.hypot(nx, ny)
        ex, ey, ez = -ny / h, nx / h, 0.0
    else:
        h = math.hypot(ny, nz)
        ex, ey, ez = 0.0, nz / h, -ny / h
    return (ex, ey, ez), (ny * ez - nz * ey, nz * ex - nx * ez, nx * ey - ny * ex)


@compiled
def _across(e, f, normal):
    """Set two axes across a normal."""
    (e[0], e[1], e[2]), (f[0], f[1], f[2]) = _axes(normal[0], normal[1], normal[2])


@compiled
def _turned(out, normal, e, f, a, b):
    """Set the normal turned by (a, b) towards two axes across it."""
    total = 0.0
    for k in range(3):
        out[k] = normal[k] + a * e[k] + b * f[k]
        total += out[k] ** 2
    for k in range(3):
        out[k] /= math.sqrt(total)


@compiled
def monotone(out, x, values, at):
    """Set values at other places, by cubics that are monotone wherever the values are.

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
        Places, ascending in each row; beyond the ends the last cubic goes on.
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
        slope[0] = _end(h[0], h[1], rise[0], rise[1])
        slope[n - 1] = _end(h[n - 2], h[n - 3], rise[n - 2], rise[n - 3])
        k = 0
        for j in range(at.shape[1]):
            while k < n - 2 and at[row, j] >= x[k + 1]:
                k += 1
            t = at[row, j] - x[k]
            c = (3.0 * rise[k] - 2.0 * slope[k] - slope[k + 1]) / h[k]
            d = (slope[k] + slope[k + 1] - 2.0 * rise[k]) / h[k] ** 2
            out[row, j] = values[row, k] + t * (slope[k] + t * (c + t * d))


@compiled
def _end(h, further, rise, next_rise):
    """Slope at an end, by the parabola through three points, kept monotone."""
    slope = ((2.0 * h + further) * rise - h * next_rise) / (h + further)
    if slope * rise <= 0.0:
        return 0.0
    if rise * next_rise <= 0.0 and abs(slope) > 3.0 * abs(rise):
        return 3.0 * rise
    return slope
