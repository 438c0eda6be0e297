"""Local maxima: of fields in layers that lie one below the other, and by Newton steps."""

import math

import numpy as np

from tractive_sam.kernels.compiled import compiled

STEP = 0.1
"""Step of the differences over the depth: their error is a hundredth."""

LOST, ENDED, GOES_ON = range(3)
"""State of a search path: abandoned, converged, or running."""

_AXES = np.eye(3)
# 0, x_i, -x_i, x_j + x_k and -(x_j + x_k), for i = 1 to 3.
_STENCIL = np.concatenate((np.zeros((1, 3)), _AXES, -_AXES, 1.0 - _AXES, _AXES - 1.0))


@compiled
def find_tops(values, above, below):
    """Return local maxima of fields, (n, 5): field, value, i, j and position between layers.

    Layers cover one rectangle, each by equal steps in x and in y.

    Parameters
    ----------
    values : ndarray, shape (m, n_x, n_y)
        Values of the fields; only values above 0 count.
    above, below : ndarray, shape (m, k_x, k_y)
        Values of the layers next to it; empty if there is none.

    Returns
    -------
    ndarray, shape (n, 5)
        For each maximum its field, its value, its place (i, j) in steps from the first point and
        the place between the layers, 0 in this one and 1 in the one below: the tops of parabolas
        through the neighbouring values.
    """
    fields, nx, ny = values.shape
    # No two of them are neighbours.
    tops = np.empty((fields * ((nx + 1) // 2) * ((ny + 1) // 2), 5))
    count = 0
    for m in range(fields):
        for i in range(nx):
            for j in range(ny):
                here = values[m, i, j]
                if here <= 0.0 or not _largest_around(values[m], i, j):
                    continue
                higher, lower = _next_to(above[m], i, j, nx, ny), _next_to(below[m], i, j, nx, ny)
                if higher > here or lower > here:
                    continue
                top = tops[count]
                top[0], top[1], top[2], top[3], top[4] = m, here, i, j, 0.0
                if 0 < i < nx - 1:
                    top[2] += _vertex(values[m, i - 1, j], here, values[m, i + 1, j])
                if 0 < j < ny - 1:
                    top[3] += _vertex(values[m, i, j - 1], here, values[m, i, j + 1])
                if higher >= 0.0 and lower >= 0.0:
                    top[4] = _vertex(higher, here, lower)
                count += 1
    return tops[:count]


@compiled(inner=True)
def _largest_around(values, i, j):
    """Return whether no value within two points is larger; of equal values, the first counts."""
    # Steps in x and y to the farthest values of its layer that a local maximum is compared with.
    around = 2
    nx, ny = values.shape
    for k in range(max(0, i - around), min(nx, i + around + 1)):
        for h in range(max(0, j - around), min(ny, j + around + 1)):
            before = k < i or (k == i and h < j)
            if values[k, h] > values[i, j] or (before and values[k, h] == values[i, j]):
                return False
    return True


@compiled(inner=True)
def _next_to(values, i, j, nx, ny):
    """Return the value of another layer nearest to point (i, j) of nx x ny; -1 if it is empty."""
    if values.size == 0:
        return -1.0
    kx, ky = values.shape
    return values[(2 * i + 1) * kx // (2 * nx), (2 * j + 1) * ky // (2 * ny)]


@compiled(inner=True)
def _vertex(before, here, behind):
    """Return the offset of a parabola's maximum from the middle of three values, in steps."""
    bend = 2.0 * here - before - behind
    return 0.5 * (behind - before) / bend if bend > 0.0 else 0.0


def stencil(at):
    """Return the points (m, 13, 3) around each of m points at which `climb` needs values."""
    return at[:, None] + STEP * at[:, None, 2:] * _STENCIL


@compiled
def climb(at, barred, best, values, of, highest, threshold, floor, first):
    """Move the points of search paths by a Newton step towards maxima; return each path's state.

    The step leads to the top of the parabola through the values; uphill if the function curves
    upwards; along the floor if the floor bars the path.

    Parameters
    ----------
    at : ndarray, shape (m, 3)
        Places of the paths, before and after; the last coordinate is the depth.
    barred : ndarray of bool, shape (m,)
        Paths that are low but barred by the floor, in the step before; set to the paths of this
        step.
    best : ndarray, shape (k,)
        The highest value of each function at which a path ended.
    values : ndarray, shape (m, 13)
        Values at the points of `stencil`. The gain of the step is added to the first one.
    of : ndarray of int, shape (m,)
        Index of the function of each path.
    highest : ndarray, shape (m,)
        Bound of the value that a path can reach: it is abandoned if another one has reached more.
    threshold : ndarray, shape (m,)
        A path is low if its value is below this.
    floor : float
        Least depth.
    first : bool
        Whether these are the first steps.

    Returns
    -------
    ndarray of int, shape (m,)
        The state of each path.
    """
    # Relative fall of a value at the floor, over a fifth of the depth, away from the surface: if it
    # falls by more, no maximum lies below. In 114 contacts of the twin discs the fall was at most a
    # third of this whenever a maximum was found from there.
    steep = 1e-2
    # A step that gains less than this part of the value is the last but one.
    settled_step = 3e-4
    count = len(at)
    fates = np.empty(count, dtype=np.uint8)
    for m in range(count):
        here, on_floor = values[m, 0], at[m, 2] <= floor
        gain = _step(at[m], values[m], floor)
        low, settled = on_floor and here < threshold[m], gain < settled_step * here
        stays = low and at[m, 2] <= floor  # beside the start the path down may be free
        falls = first and values[m, 6] - values[m, 3] > steep * here
        if (low and falls) or (stays and (barred[m] or settled)):
            fates[m] = LOST
        elif settled:
            fates[m] = ENDED
            best[of[m]] = max(best[of[m]], here)
        else:
            fates[m] = GOES_ON
        barred[m] = stays
        values[m, 0] += gain
    for m in range(count):
        if fates[m] == GOES_ON and (highest[m] < best[of[m]] or _follows(at, values, of, fates, m)):
            fates[m] = LOST
    return fates


@compiled
def last_steps(at, values, floor):
    """Move the points by the last Newton step of `climb`; return the values reached, (m,)."""
    reached = np.empty(len(at))
    for m in range(len(at)):
        reached[m] = values[m, 0] + _step(at[m], values[m], floor)
    return reached


@compiled(inner=True)
def _follows(at, values, of, fates, m):
    """Return whether a running path with a higher value of the same function is near path m."""
    # Paths nearer to each other than this share of the depth lead to one maximum.
    same = 0.3
    for k in range(len(at)):
        if fates[k] == GOES_ON and of[k] == of[m] and values[k, 0] > values[m, 0]:
            x, y, z = at[k, 0] - at[m, 0], at[k, 1] - at[m, 1], at[k, 2] - at[m, 2]
            if x * x + y * y + z * z < (same * at[m, 2]) ** 2:
                return True
    return False


@compiled(inner=True)
def _step(at, v, floor):
    """Move a point by a limited Newton step uphill, not above depth `floor`; return its gain."""
    # Longest step of a path over the depth.
    longest = 0.5
    step, gradient, hessian = np.empty(3), np.empty(3), np.empty((3, 3))
    for i in range(3):
        gradient[i] = 0.5 * (v[1 + i] - v[4 + i])
        hessian[i, i] = v[1 + i] + v[4 + i] - 2.0 * v[0]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        mixed = v[7 + i] + v[10 + i] - 2.0 * v[0]
        hessian[j, k] = hessian[k, j] = 0.5 * (mixed - hessian[j, j] - hessian[k, k])
    _uphill(step, gradient, hessian)
    if at[2] <= floor and step[2] < 0.0:
        gradient[2] = hessian[0, 2] = hessian[1, 2] = hessian[2, 0] = hessian[2, 1] = 0.0
        _uphill(step, gradient, hessian)
    length = math.sqrt(step[0] ** 2 + step[1] ** 2 + step[2] ** 2)
    if length > longest / STEP:
        for i in range(3):
            step[i] *= longest / STEP / length
    scale = STEP * at[2]
    for i in range(3):
        at[i] += scale * step[i]
    at[2] = max(at[2], floor)
    return 0.5 * (gradient[0] * step[0] + gradient[1] * step[1] + gradient[2] * step[2])


@compiled(inner=True)
def _uphill(step, gradient, hessian):
    """Set the Newton step with a Hessian that is shifted until it is negative definite."""
    # Least curvature over the largest one.
    flattest = 1e-3
    a, d, f = hessian[0, 0], hessian[1, 1], hessian[2, 2]
    b, c, e = hessian[0, 1], hessian[0, 2], hessian[1, 2]
    size = max(abs(a), abs(b), abs(c), abs(d), abs(e), abs(f))
    step[:] = 0.0
    if size == 0.0:
        return
    lower = 0.0
    while True:
        a, d, f = hessian[0, 0] - lower, hessian[1, 1] - lower, hessian[2, 2] - lower
        minor = a * d - b * b
        determinant = f * minor - a * e * e + 2.0 * b * c * e - d * c * c
        # All leading minors alternate, and no curvature is next to nothing.
        if a < 0.0 < minor and determinant < -flattest * size**3:
            break
        lower = max(2.0 * lower, 0.1 * size)
    u, v, w = gradient
    # By the adjoint of the Hessian.
    step[0] = -((d * f - e * e) * u + (c * e - b * f) * v + (b * e - c * d) * w) / determinant
    step[1] = -((c * e - b * f) * u + (a * f - c * c) * v + (b * c - a * e) * w) / determinant
    step[2] = -((b * e - c * d) * u + (b * c - a * e) * v + (a * d - b * b) * w) / determinant
