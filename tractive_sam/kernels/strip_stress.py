"""Stress inside a half-space under uniform traction on strips of its surface, infinitely long in y.

The half-space is z >= 0, z points into the body; loads and signs are as in
:mod:`tractive_sam.kernels.stress`. The stress of a strip is the difference, between its two edges,
of the stress under a uniform traction from an edge to +infinity. With x from the edge, r² = x² +
z², t = atan(x/z), and up to constants, which fall out of the difference,

=====  =======================  =============  ===============
load   sigma_xx                 sigma_zz       sigma_xz
=====  =======================  =============  ===============
p_x    -(2 ln r + z²/r²)        z²/r²          -(t - x z/r²)
p_n    -(t - x z/r²)            -(t + x z/r²)  z²/r²
=====  =======================  =============  ===============

and sigma_xy = -ln r, sigma_yz = -t for p_y, all over pi. The strain in y is zero:
sigma_yy = nu (sigma_xx + sigma_zz). Neighbours share an edge, so that a sum over strips is one over
edges, with the jump of the traction across each.

Source: Johnson, Contact Mechanics (1985), sections 2.2, 2.3 and 2.5, in terms of one edge. The
shear along y is the antiplane problem, sigma_xy and sigma_yz of a line load -x/r² and -z/r².
"""

import math

from tractive_sam.kernels.compiled import compiled


@compiled(inner=True)
def _of_edge(x, z, width):
    """Return ln r, atan(x/z), x z/r² and z²/r² of a point seen from an edge; finite at r = 0."""
    rr = x * x + z * z
    if rr == 0.0:
        return math.log(width), 0.0, 0.0, 0.0
    return 0.5 * math.log(rr), math.atan2(x, z), x * z / rr, z * z / rr


@compiled
def edge_factors(out, z, width):
    """Set `out` to the stress factors at one depth of a strip's edge, for all centres of strips.

    Parameters
    ----------
    out : ndarray, shape (4, p)
        ln r, t, x z/r² and z²/r² at x = (k + 1/2) width, k = 0, 1, ... and from the end -1, -2 ...
    z : float
        Depth.
    width : float
        Width of the strips.
    """
    count = out.shape[1]
    for m in range(count):
        k = m if 2 * m < count else m - count
        out[0, m], out[1, m], out[2, m], out[3, m] = _of_edge((k + 0.5) * width, z, width)


@compiled
def sum_strip_stress(out, points, edges, jumps, width, nu):
    """Set `out` to the stresses at points of a half-space under tractions constant on strips.

    At the surface, on an edge across which p_x or p_y jumps, the stress is infinite; what is
    infinite is left out, as in `stress.log_argument`, and the rest is the mean of both sides.

    Parameters
    ----------
    out : ndarray, shape (n, 6)
        Stresses in the order of `stress.COMPONENTS`, in the unit of the tractions.
    points : ndarray, shape (n, 2)
        (x, z) with the depth z >= 0.
    edges : ndarray, shape (m,)
        x of the edges, in the unit of the points.
    jumps : ndarray, shape (m, 3)
        Increase of (p_x, p_y, p_n) across each edge, in the direction of x.
    width : float
        Width of the strips.
    nu : float
        Poisson's ratio.
    """
    f = 1.0 / math.pi
    for n in range(points.shape[0]):
        xx = zz = xy = xz = yz = 0.0
        z = points[n, 1]
        for m in range(edges.shape[0]):
            x = points[n, 0] - edges[m]
            p_x, p_y, p_n = jumps[m, 0], jumps[m, 1], jumps[m, 2]
            ln, t, xz_rr, zz_rr = _of_edge(x, z, width)
            xx -= p_x * (2.0 * ln + zz_rr) + p_n * (t - xz_rr)
            zz += p_x * zz_rr - p_n * (t + xz_rr)
            xz += p_n * zz_rr - p_x * (t - xz_rr)
            xy -= p_y * ln
            yz -= p_y * t
        out[n, 0], out[n, 1], out[n, 2] = f * xx, f * nu * (xx + zz), f * zz
        out[n, 3], out[n, 4], out[n, 5] = f * xy, f * xz, f * yz
