"""The residual stress that leaves the least shear stress of cycles at one depth.

Sources: Melan (1938) and Koiter (1960) by Johnson, Contact Mechanics (1985), section 9.2.
"""

import math

import numpy as np

from tractive_sam.kernels.compiled import compiled
from tractive_sam.kernels.enclosing import MAX_STEPS, index_of_largest
from tractive_sam.kernels.fatigue import ROOT3, deviators


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
