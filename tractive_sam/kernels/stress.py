"""Stress inside a half-space under uniform traction on a rectangle or a strip of its surface.

The half-space is z >= 0, z points into the body; (x, y, z) is measured from the centre of the
rectangle [-dx/2, dx/2] x [-dy/2, dy/2]. Loads are tractions acting on the body: the shears p_x, p_y
and the pressure p_n (which pushes along +z), so that under the patch sigma_xz = -p_x,
sigma_yz = -p_y, sigma_zz = -p_n. A coefficient is a stress per unit traction; it has no unit.

With r = (x, y, z) from a point of the patch to the observer and R = |r|, every coefficient combines
ten moments and four potentials, integrals over the patch that do not depend on nu:

    S_ijk = integral of 3 r_i r_j r_k / R^5
    psi_xx, psi_xy = integrals of d2/dx2, d2/dxdy of ln(R + z)
    chi_xxy, chi_xyy = integrals of d3/dx2dy, d3/dxdy2 of z ln(R + z) - R

    2 pi sigma_ij = -S_ijk + (1 - 2 nu) (a few of psi, chi)      load k = x, y or z

`patch_integrals` returns them in the order xxx, xxy, xyy, yyy, xxz, xyz, yyz, xzz, yzz, zzz,
psi_xx, psi_xy, chi_xxy, chi_xyy.

Sources: Love, Phil. Trans. R. Soc. A 228 (1929) 377, for the pressure; Cerruti's potentials as in
Johnson, Contact Mechanics (1985), sections 3.2 and 3.6, for the shears.

Notes
-----
**Corner forms.** Every term of a point force is a second or third derivative of 1/R, ln(R + z),
z ln(R + z) - R or R, so that integrating over x and y only takes derivatives away. Summed over the
corners with the signs +, -, -, +, with X, Y from a corner, R its distance, p = X^2 + z^2 and
q = Y^2 + z^2:

=========  =========================  =========  =====================================
integral   corner form                integral   corner form
=========  =========================  =========  =====================================
A          atan(XY / zR)              S_xxx      -2 ln(Y+R) - Y/R + z^2 Y / Rp
psi_xx     atan(XY / (p + zR))        S_xyy      Y/R - ln(Y+R)
psi_xy     ln(R + z)                  S_xxz      A - z XY / Rp
chi_xxy    -X / (R+z)                 S_xyz      z / R
chi_xyy    -Y / (R+z)                 S_xzz      -z^2 Y / Rp
                                      S_zzz      A + z XY / R (1/p + 1/q)
=========  =========================  =========  =====================================

The others follow by exchange of x and y. A, the solid angle of the patch, is
(S_xxz + S_yyz + S_zzz) / 3.

**Cancellation.** Corner sums cancel as written. So corners are first paired along an edge, their
difference is taken algebraically, and the logarithms and arctangents of all four merge into one
call each. The remaining difference between opposite edges loses digits with the cube of distance
over side; far from the patch Gauss-Legendre sums take over (`near_radius`, `nodes_needed`).

**Accuracy.** Largest error of the stress of one load, relative to its norm, against corner sums of
90 digits; 20,000 points each on axes, on and beside edges, up to 1e4 sides away, z from 0 to
1e4 sides, nu from 0 to 1/2:

=======  =====  =====  =====  ======  ======
dx : dy  1 : 1  2 : 1  5 : 1  10 : 1  20 : 1
error    1e-11  1e-11  3e-11  8e-11   2e-10
=======  =====  =====  =====  ======  ======

**Strips, infinitely long in y.** Loads and signs are the same. The stress of a strip is the
difference, between its two edges, of the stress under a uniform traction from an edge to +infinity.
With x from the edge, r² = x² +
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

import numpy as np

from tractive_sam.kernels.compiled import ANY_ORDER, compiled

COMPONENTS = ("xx", "yy", "zz", "xy", "xz", "yz")
"""Order of the components in every result."""

MAX_NODES = 10
"""Largest number of Gauss-Legendre nodes along one side."""

NODES = np.zeros((MAX_NODES + 1, MAX_NODES))
WEIGHTS = np.zeros((MAX_NODES + 1, MAX_NODES))
for _n in range(1, MAX_NODES + 1):
    _node, _weight = np.polynomial.legendre.leggauss(_n)
    NODES[_n, :_n], WEIGHTS[_n, :_n] = _node / 2, _weight / 2

REACH = (0.0, 0.0, 1e-6, 1 / 300, 1 / 25, 1 / 9, 1 / 4.5, 1 / 2.8, 1 / 2.2, 1 / 1.8)
"""REACH[n]: n nodes along a side suffice while side / distance is below it (measured)."""


@compiled
def safe_divide(numerator, denominator):
    """Return the quotient, or 0 if the denominator is 0: the mean of the one-sided limits."""
    return numerator / denominator if denominator != 0.0 else 0.0


@compiled
def positive_or(value, substitute):
    """Return `value` if above 0, else `substitute`, to omit the infinite part of a logarithm."""
    return value if value > 0.0 else substitute


@compiled
def angle_difference(s1, c1, s2, c2, straddles):
    """Return the angle difference atan2(s1, c1) - atan2(s2, c2) by one arctangent.

    An edge that passes through the point (s = c = 0) counts as angle 0, the mean of its two sides.
    `straddles`: the point lies between the edges, the first angle is >= 0 and the second <= 0.
    """
    if s1 == 0.0 and c1 == 0.0:
        c1 = 1.0
    if s2 == 0.0 and c2 == 0.0:
        c2 = 1.0
    angle = math.atan2(s1 * c2 - c1 * s2, c1 * c2 + s1 * s2)
    # The difference is then in [0, 2 pi]; atan2 returns its upper half less 2 pi.
    return angle + 2.0 * math.pi if straddles and angle < 0.0 else angle


@compiled
def cross(y1, y2, r1, r2, q, width):
    """Return y1 r2 - y2 r1 for an edge, with r_j^2 = q + y_j^2 and width = y1 - y2.

    If y1 and y2 have one sign it is width (y1 + y2) q / (y1 r2 + y2 r1), free of cancellation.
    """
    if y1 * y2 > 0.0:
        return width * (y1 + y2) * q / (y1 * r2 + y2 * r1)
    return y1 * r2 - y2 * r1


@compiled
def log_argument(y1, y2, r1, r2, q, width):
    """Return (y1 + r1) / (y2 + r2) for an edge, with r_j^2 = q + y_j^2 and width = y1 - y2.

    ln(y + r) cancels for y < 0; there y + r = q / (r - y). On the edge itself (q = 0) and at its
    ends the logarithm is infinite; the vanishing length is then replaced by the edge's length.
    """
    if y2 >= 0.0:
        return (y1 + r1) / positive_or(y2 + r2, width)
    if y1 <= 0.0:
        return (r2 - y2) / positive_or(r1 - y1, width)
    return (y1 + r1) * (r2 - y2) / positive_or(q, width * width)


@compiled
def edge(x, y1, y2, r1, r2, z, width):
    """Return differences of y/r, y/(q r), y/(r + z) between ends of an edge, and a log argument.

    They are the differences of y / R, y / (R (x^2 + z^2)) and y / (R + z), and the ratio of y + R;
    r1 and r2 are the values of R.
    """
    q = x * x + z * z
    m = cross(y1, y2, r1, r2, q, width)
    # Over common denominators: the numerators m and y1 (r2 + z) - y2 (r1 + z) = m + z width are
    # sums of positive terms. They are 0/0 only at an end of the edge.
    d = safe_divide(m, r1 * r2)
    h = safe_divide(m + z * width, (r1 + z) * (r2 + z))
    return d, safe_divide(d, q), h, log_argument(y1, y2, r1, r2, q, width)


@compiled
def edge_psi(x, y1, y2, r1, r2, z, width):
    """Return (to a factor) sine and cosine of the angle that an edge adds to psi_xx.

    That is the difference of atan(x y / (x^2 + z^2 + z R)) between its ends.
    """
    q = x * x + z * z
    sine = x * (q * width + z * cross(y1, y2, r1, r2, q, width))
    return sine, (q + z * r1) * (q + z * r2) + x * x * y1 * y2


@compiled
def surface_angle(x1, x2, y1, y2):
    """Return the solid angle of a patch at z = 0: 2 pi inside, pi on an edge, pi/2 at a corner."""
    return 0.5 * math.pi * (np.sign(x1) - np.sign(x2)) * (np.sign(y1) - np.sign(y2))


@compiled
def solid_angle(x1, x2, z, t1, t2, d1, d2):
    """Return the solid angle of a patch seen from depth z > 0: corner sum of atan(x y / (z R)).

    t_i and d_i: product and difference of y / R at the ends of the edge x_i.
    """
    zz = z * z
    return angle_difference(
        x1 * z * d1, zz + x1 * x1 * t1, x2 * z * d2, zz + x2 * x2 * t2, x1 * x2 <= 0.0
    )


@compiled
def near_integrals(x, y, z, dx, dy):
    """Return the 14 stress integrals by corner sums; accurate within a few patch sizes.

    Parameters: observer (x, y, z), z >= 0, from the patch's centre, and its sides; one length unit.

    With X, Y from a corner, R its distance, and corners summed with the signs +, -, -, +:

        A = atan(XY / zR),  psi_xx = atan(XY / (X^2 + z^2 + zR)),  psi_xy = ln(R + z)
        chi_xxy = -X / (R + z),  chi_xyy = -Y / (R + z)
        S_xxx = -2 ln(Y+R) - Y/R + z^2 Y / R(X^2+z^2),  S_xyy = Y/R - ln(Y+R)
        S_xxz = A - z XY / R(X^2+z^2),  S_xzz = -z^2 Y / R(X^2+z^2),  S_xyz = z / R
        S_zzz = A + z XY / R (1/(X^2+z^2) + 1/(Y^2+z^2)), the others by exchange of x and y.

    At z = 0 they are the limit from inside the body. On an edge that depends on the direction, and
    they are the mean of the surface values on both sides. The logarithms that are infinite there (x
    loads on the edges x = +-dx/2, y loads on y = +-dy/2, all loads at the corners) lose their
    infinite part, see `log_argument`.
    """
    x1, x2, y1, y2 = x + 0.5 * dx, x - 0.5 * dx, y + 0.5 * dy, y - 0.5 * dy
    zz = z * z
    r11, r12 = math.sqrt(x1 * x1 + y1 * y1 + zz), math.sqrt(x1 * x1 + y2 * y2 + zz)
    r21, r22 = math.sqrt(x2 * x2 + y1 * y1 + zz), math.sqrt(x2 * x2 + y2 * y2 + zz)
    a1, b1, h1, g1 = edge(x1, y1, y2, r11, r12, z, dy)
    a2, b2, h2, g2 = edge(x2, y1, y2, r21, r22, z, dy)
    c1, d1, k1, l1 = edge(y1, x1, x2, r11, r21, z, dx)
    c2, d2, k2, l2 = edge(y2, x1, x2, r12, r22, z, dx)

    # One logarithm of a ratio near 1: four of large numbers would cancel.
    ln_x, ln_y = math.log(l1 / l2), math.log(g1 / g2)
    psi_xy = math.log(
        positive_or(r11 + z, dx)
        * positive_or(r22 + z, dx)
        / (positive_or(r12 + z, dx) * positive_or(r21 + z, dx))
    )
    psi_s1, psi_c1 = edge_psi(x1, y1, y2, r11, r12, z, dy)
    psi_s2, psi_c2 = edge_psi(x2, y1, y2, r21, r22, z, dy)
    psi_xx = angle_difference(psi_s1, psi_c1, psi_s2, psi_c2, x1 * x2 <= 0.0)
    if z == 0.0:  # atan(XY / zR) jumps here
        angle = surface_angle(x1, x2, y1, y2)
    elif abs(x) - 0.5 * dx > abs(y) - 0.5 * dy:  # pair the corners along the nearer edges
        xx = x1 * x2
        angle = solid_angle(y1, y2, z, xx / (r11 * r21), xx / (r12 * r22), c1, c2)
    else:
        yy = y1 * y2
        angle = solid_angle(x1, x2, z, yy / (r11 * r12), yy / (r21 * r22), a1, a2)

    xzz, yzz = zz * (b2 - b1), zz * (d2 - d1)
    zxy_p, zxy_q = z * (x1 * b1 - x2 * b2), z * (y1 * d1 - y2 * d2)
    # z/r11 - z/r12 = z (r12 - r11) / (r11 r12), and r12^2 - r11^2 = -2 y dy.
    f1 = safe_divide(z, r11 * r12 * (r11 + r12))
    f2 = safe_divide(z, r21 * r22 * (r21 + r22))
    xyz = 2.0 * y * dy * (f2 - f1)
    return (
        -2.0 * ln_y - (a1 - a2) - xzz,
        (c1 - c2) - ln_x,
        (a1 - a2) - ln_y,
        -2.0 * ln_x - (c1 - c2) - yzz,
        angle - zxy_p,
        xyz,
        angle - zxy_q,
        xzz,
        yzz,
        angle + zxy_p + zxy_q,
        psi_xx,
        psi_xy,
        k2 - k1,
        h2 - h1,
    )


@compiled
def nodes_needed(ratio):
    """Return the number of Gauss-Legendre nodes for a side with `ratio` of side to distance."""
    for n in range(1, MAX_NODES):
        if ratio < REACH[n]:
            return n
    return MAX_NODES


@compiled(fastmath=ANY_ORDER)  # the nodes of the quadrature
def far_integrals(x, y, z, dx, dy, nx, ny):
    """Return the 14 stress integrals by nx x ny Gauss-Legendre nodes, far from the patch.

    Parameters as in `near_integrals`; the integrands are given in the module's docstring, with

        psi_xx = 1 / (R T) - x^2 (R + T) / (R^3 T^2),  psi_xy = -x y (R + T) / (R^3 T^2)
        chi_xxy = y / (R T^2) - x^2 y (2 R + T) / (R^3 T^3),  T = R + z.
    """
    xxx = xxy = xyy = yyy = xxz = xyz = yyz = xz = yz = total = 0.0
    psi_xx = psi_xy = chi_xxy = chi_xyy = 0.0
    zz = z * z
    for i in range(nx):
        u = x - dx * NODES[nx, i]
        uu = u * u
        for j in range(ny):
            v = y - dy * NODES[ny, j]
            vv = v * v
            rr = uu + vv + zz
            r = math.sqrt(rr)
            t = r + z
            rt = 1.0 / (r * t)
            over_r, over_t = t * rt, r * rt
            w = WEIGHTS[nx, i] * WEIGHTS[ny, j]
            # One division and one root a node; R^-5 by products, as a power would take far longer.
            s = 3.0 * w * over_r * (over_r * over_r) * (over_r * over_r)
            xxx += s * uu * u
            xxy += s * uu * v
            xyy += s * u * vv
            yyy += s * vv * v
            xxz += s * uu
            xyz += s * u * v
            yyz += s * vv
            xz += s * u
            yz += s * v
            total += s
            p = w * rt
            g = (r + t) * over_r * over_r * over_t
            psi_xx += p * (1.0 - uu * g)
            psi_xy -= p * u * v * g
            c = p * over_t
            h = (r + r + t) * over_r * over_r * over_t
            chi_xxy += c * v * (1.0 - uu * h)
            chi_xyy += c * u * (1.0 - vv * h)
    area = dx * dy
    za, zza = z * area, zz * area
    return (
        xxx * area,
        xxy * area,
        xyy * area,
        yyy * area,
        xxz * za,
        xyz * za,
        yyz * za,
        xz * zza,
        yz * zza,
        total * zza * z,
        psi_xx * area,
        psi_xy * area,
        chi_xxy * area,
        chi_xyy * area,
    )


@compiled
def near_radius(dx, dy):
    """Return the distance from the centre of a patch below which corner sums are used (measured).

    Corner sums lose digits with the cube of distance / side, quadrature gains them.
    """
    longer, shorter = max(dx, dy), min(dx, dy)
    return max(1.5 * longer, min(7.0 * longer, 12.0 * shorter))


@compiled
def patch_integrals(x, y, z, dx, dy):
    """Return the 14 stress integrals of a patch at a point, by corner sums or quadrature.

    Parameters: observer (x, y, z), z >= 0, from the patch's centre, and its sides; one length unit.
    Error of the stress they give, relative to its norm, from the surface to 1e4 sides away and for
    every nu: below 1e-10 for sides up to 1 : 10, 3e-10 for 1 : 20 (measured).
    """
    distance = math.sqrt(x * x + y * y + z * z)
    if distance < near_radius(dx, dy):
        return near_integrals(x, y, z, dx, dy)
    nx, ny = nodes_needed(dx / distance), nodes_needed(dy / distance)
    return far_integrals(x, y, z, dx, dy, nx, ny)


@compiled
def assemble_normal(integrals, nu):
    """Return 2 pi times the six stresses for unit pressure, from the 14 integrals.

    Love: sigma_ij = -S_ijz + (1 - 2 nu) (A - psi_xx, psi_xx, 0, -psi_xy, 0, 0) for ij in the order
    of COMPONENTS; A = (S_xxz + S_yyz + S_zzz) / 3 is the solid angle of the patch.
    """
    _, _, _, _, xxz, xyz, yyz, xzz, yzz, zzz, psi_xx, psi_xy, _, _ = integrals
    k = 1.0 - 2.0 * nu
    angle = (xxz + yyz + zzz) / 3.0
    return (
        -xxz + k * (angle - psi_xx),
        -yyz + k * psi_xx,
        -zzz,
        -xyz - k * psi_xy,
        -xzz,
        -yzz,
    )


@compiled
def assemble_shear_x(integrals, nu):
    """Return 2 pi times the six stresses for unit shear along x, from the 14 integrals.

    Cerruti: sigma_ij = -S_ijx + (1 - 2 nu) (chi_xyy, P - chi_xyy, 0, -chi_xxy, 0, 0);
    P = (S_xxx + S_xyy + S_xzz) / 3 is the integral of x / R^3.
    """
    xxx, xxy, xyy, _, xxz, xyz, _, xzz, _, _, _, _, chi_xxy, chi_xyy = integrals
    k = 1.0 - 2.0 * nu
    pull = (xxx + xyy + xzz) / 3.0
    return (
        -xxx + k * chi_xyy,
        -xyy + k * (pull - chi_xyy),
        -xzz,
        -xxy - k * chi_xxy,
        -xxz,
        -xyz,
    )


@compiled
def assemble_shear_y(integrals, nu):
    """Return 2 pi times the six stresses for unit shear along y, from the 14 integrals."""
    _, xxy, xyy, yyy, _, xyz, yyz, _, yzz, _, _, _, chi_xxy, chi_xyy = integrals
    k = 1.0 - 2.0 * nu
    pull = (xxy + yyy + yzz) / 3.0
    return (
        -xxy + k * (pull - chi_xxy),
        -yyy + k * chi_xxy,
        -yzz,
        -xyy - k * chi_xyy,
        -xyz,
        -yyz,
    )


def stress_patch(x, y, z, dx, dy, nu):
    """Return stresses at a point by unit loads p_x, p_y and p_n on a patch, shape (3, 6).

    Parameters: observer (x, y, z), z >= 0, from the patch's centre, and its sides, in one length
    unit; Poisson's ratio nu. Limits at z = 0: see `near_integrals`.
    """
    integrals = patch_integrals(x, y, z, dx, dy)
    loads = assemble_shear_x, assemble_shear_y, assemble_normal
    return np.array([assemble(integrals, nu) for assemble in loads]) / (2.0 * math.pi)


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


@compiled(fastmath=ANY_ORDER)
def compute_von_mises(out, stress):
    """Set `out` (n,) to the von Mises stresses of stresses (6, n): xx, yy, zz, xy, xz, yz."""
    for k in range(out.size):
        xx, yy, zz = stress[0, k], stress[1, k], stress[2, k]
        xy, xz, yz = stress[3, k], stress[4, k], stress[5, k]
        normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
        out[k] = math.sqrt(0.5 * normal + 3.0 * (xy**2 + xz**2 + yz**2))
