"""Fatigue of a material point by a cycle of stress.

A path is the stress of one point along the cycle, (n, 6) with the components xx, yy, zz, xy, xz,
yz. Deviators s are points of a space of five dimensions, in which the distance is
sqrt(s:s/2), so that sqrt(J2) is the distance from its origin and a torsion of the amplitude tau is
tau away:

    ((s_xx - s_yy)/2, (s_xx + s_yy - 2 s_zz)/(2 sqrt 3), s_xy, s_xz, s_yz).

Sources: Dang Van, Griveau & Message, in Biaxial and Multiaxial Fatigue (1989) 479; Crossland, Proc.
Int. Conf. Fatigue of Metals (1956) 138; Papadopoulos, Fatigue Fract. Eng. Mater. Struct. 21 (1998)
269 for the smallest ball.
"""

import math

import numpy as np

from tractive_sam.kernels.compiled import compiled
from tractive_sam.kernels.enclosing import enclosing_ball, index_of_largest

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
