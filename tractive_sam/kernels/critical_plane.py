"""The plane through a point with the most dangerous shear amplitude and normal stress.

Paths are as in `kernels.fatigue`.

Sources: Findley, J. Eng. Ind. 81 (1959) 301; Fatemi & Socie, Fatigue Fract. Eng. Mater. Struct. 11
(1988) 149.
"""

import math

import numpy as np

from tractive_sam.kernels.compiled import compiled
from tractive_sam.kernels.fatigue import (
    ROOT3,
    deviators,
    enclosing_ball,
    enclosing_circle,
    index_of_largest,
)


@compiled
def evaluate_plane(path, normal, sum_k, product_k, room, enough=-math.inf):
    """Return the criterion on a plane, the number of support points, and the index of sigma_n,max.

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
    at = index_of_largest(on_plane[0])
    high = on_plane[0, at]
    factor = max(1.0 + product_k * high, 0.0)
    radius = max(enough - sum_k * high, 0.0) / max(factor, 1e-300)
    count, square = enclosing_circle(support, weights, on_plane[1:], squares, radius * radius)
    return math.sqrt(square) * factor + sum_k * high, count, at


@compiled(inner=True)
def _stress_factors(look, normal):
    """Set `look` (6, 6) to factors for stresses nn, en, fn, ee, ef, ff on a plane of normal n."""
    n = normal[0], normal[1], normal[2]
    e, f = _perpendicular_axes(n)
    for k, (u, v) in enumerate(((n, n), (e, n), (f, n), (e, e), (e, f), (f, f))):
        look[k, 0], look[k, 1], look[k, 2] = u[0] * v[0], u[1] * v[1], u[2] * v[2]
        look[k, 3] = u[0] * v[1] + u[1] * v[0]
        look[k, 4] = u[0] * v[2] + u[2] * v[0]
        look[k, 5] = u[1] * v[2] + u[2] * v[1]


ENOUGH = 1e-4
"""Relative error of the value at a critical plane: a cell that can gain no more is dropped."""

STEPS, LONGEST, SHORTENED, SETTLED = 20, 0.15, 6, 1e-8
"""Newton steps towards a maximum, the longest of them, radians, how often one that does not lead up
is made shorter, and the gain, over the value, from which on none is worth its work."""


@compiled
def critical_plane(out, paths, sum_k, product_k):
    """Set `out` to the largest value over all planes of a criterion of each stress path.

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
    # How often a cell is divided at most: its normals are then within a hundredth of a degree.
    divided = 12
    # Share of the most by which a value may fall towards the corner of a cell: with all of it
    # nothing can be missed, at twice the time. In 11,000 paths of lines and discs, out of phase and
    # random, none missed `ENOUGH` with half of it; 26 did, by up to 0.2 %, with less than a third.
    likely = 0.5
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
    stack, normal, last = np.empty((count + 3 * divided, 4)), np.empty(3), normals[0].copy()
    smallest = half * 0.5**divided
    for k in range(len(paths)):
        path = paths[k]
        bend = likely * _bound_curvature(path, sum_k, product_k, ball)
        _stress_ranges(box, path, looks)
        for c in range(count):  # with the rectangle's diagonal: it is never too small
            amplitude = 0.5 * math.hypot(box[3, c] - box[2, c], box[5, c] - box[4, c])
            factor = max(1.0 + product_k * box[1, c], 0.0)
            values[c] = amplitude * factor + sum_k * box[1, c]
        best = max(_local_maximum(last, path, sum_k, product_k, room), 0.0)
        _copy(normal, normals[index_of_largest(values)])
        improved = _local_maximum(normal, path, sum_k, product_k, room)
        if improved > best:
            best = improved
            _copy(last, normal)
        waiting = 0
        for c in range(count):
            if values[c] + bend * reach[c] > best * (1.0 + ENOUGH):
                stack[waiting] = cells[c]
                waiting += 1
        while waiting > 0:
            waiting -= 1
            face, u, v, side = stack[waiting]
            far = _cell_normal(normal, stack[waiting])
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
                stack[waiting, 0], stack[waiting, 3] = face, side
                stack[waiting, 1] = u + side if j % 2 else u - side
                stack[waiting, 2] = v + side if j // 2 else v - side
                waiting += 1
        out[k] = best


@compiled(inner=True)
def _first_cells():
    """Return the cells (m, 4) that cover half a sphere: face, angles u, v of middle, half side."""
    # Cells along each side of a face of a cube in the first search; three faces are half a sphere.
    side = 7
    cells, half = np.empty((3 * side * side, 4)), math.pi / 4 / side
    for k in range(len(cells)):
        cells[k, 0], cells[k, 3] = k // (side * side), half
        cells[k, 1] = half * (1 + 2 * (k // side % side)) - math.pi / 4
        cells[k, 2] = half * (1 + 2 * (k % side)) - math.pi / 4
    return cells


@compiled(inner=True)
def _cell_normal(normal, cell):
    """Set the normal at the middle of a cell; return a bound of the squared angle to its corners.

    Across a face of the cube normals are (1, tan u, tan v): the sides of a cell are great circles,
    so no point is farther than a corner, and of these it is one on the longer diagonal.
    """
    face, a, b, t = int(cell[0]), math.tan(cell[1]), math.tan(cell[2]), math.tan(cell[3])
    square = 1.0 + a * a + b * b
    normal[face] = 1.0 / math.sqrt(square)
    normal[(face + 1) % 3], normal[(face + 2) % 3] = a * normal[face], b * normal[face]
    farthest = 0.0
    for side in (-t, t):
        opposite = -side if a * b > 0.0 else side
        x, y = (a + side) / (1.0 - a * side), (b + opposite) / (1.0 - b * opposite)
        along = 1.0 + a * x + b * y
        # The square of the angle is less than the square of its tangent.
        farthest = max(farthest, square * (1.0 + x * x + y * y) / (along * along) - 1.0)
    return farthest


@compiled(inner=True)
def _bound_curvature(path, sum_k, product_k, ball):
    """Return an upper bound of the fall of the criterion around a maximum, per squared angle.

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
    """Copy an array of one dimension into `out`.

    Used instead of an assignment to a slice: its check of shapes takes seconds to compile.
    """
    for i in range(out.size):
        out[i] = values[i]


@compiled(inner=True)
def _stress_factors_of_planes(normals):
    """Return the factors of stress components on planes with normals (m, 3), shape (3, 6, m)."""
    looks, look = np.empty((3, 6, len(normals))), np.empty((6, 6))
    for c in range(len(normals)):
        _stress_factors(look, normals[c])
        for k in range(3):
            _copy(looks[k, :, c], look[k])
    return looks


@compiled(inner=True)
def _stress_ranges(box, path, looks):
    """Set `box` (6, m) to least and largest normal and shear stresses of a path on each plane."""
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
    """Return the local maximum that Newton steps reach from a normal, which is moved there."""
    trial = np.empty(3)
    here, count, at = evaluate_plane(path, normal, sum_k, product_k, room)
    for _ in range(STEPS):
        a, b = newton_step(path, here, count, at, sum_k, product_k, room)
        gain = 0.0
        for _ in range(SHORTENED):
            turn_normal(trial, normal, a, b)
            value, count, at = evaluate_plane(path, trial, sum_k, product_k, room)
            gain = value - here
            if gain > 0.0:
                here = value
                _copy(normal, trial)
                break
            a, b = 0.4 * a, 0.4 * b
        if gain <= SETTLED * here:  # the next gain would be the square of this one
            break
    return here


@compiled
def newton_step(path, here, count, at, sum_k, product_k, room):
    """Return the Newton step (a, b), radians, from the plane evaluated last, along its two axes.

    The squared radius is the largest, over weights w of the points that hold the circle, of the
    weighted mean of their |t_i - t|², with t the weighted mean of their shear. At fixed weights its
    derivatives follow from the shear of the stresses; the change of the weights adds C^T M^-1 C,
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
    """Return the differences of columns k and k + 1 at points 1 and 2 from those at point 0."""
    x, y = seen[0, k], seen[0, k + 1]
    return seen[1, k] - x, seen[1, k + 1] - y, seen[2, k] - x, seen[2, k + 1] - y


@compiled
def solve_newton_step(here, ga, gb, haa, hab, hbb):
    """Return the step (a, b) from gradient and second derivatives, uphill and limited in length."""
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
    """Return two unit vectors perpendicular to a normal and to each other."""
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
    """Set `out` to a normal turned by (a, b), radians, towards its two perpendicular axes."""
    e, f = _perpendicular_axes((normal[0], normal[1], normal[2]))
    total = 0.0
    for k in range(3):
        out[k] = normal[k] + a * e[k] + b * f[k]
        total += out[k] ** 2
    for k in range(3):
        out[k] /= math.sqrt(total)
