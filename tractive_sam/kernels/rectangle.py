"""Point kernels of the half-space surface integrated over a rectangle, as scalar formulas.

The rectangle is centred at the origin with sides ``dx`` and ``dy``; ``(x, y)`` is observer minus
centre. Six integrals describe every surface influence coefficient of any pair of materials
(Kalker 1990, section 4.2; Juliá & Rodríguez-Tembleque 2025, appendix A). By their parities one
quadrant gives the plane:

========  ==================  ==========  ==========
name      integrand           in x        in y
========  ==================  ==========  ==========
``r1``    1/r                 even        even
``xx``    x²/r³               even        even
``yy``    y²/r³               even        even
``xy``    x y/r³              odd         odd
``x2``    x/r²                odd         even
``y2``    y/r²                even        odd
========  ==================  ==========  ==========

Near the rectangle the integrals are differences of antiderivatives at its four corners. Far away
that difference cancels (its terms grow like r ln r, the result falls like 1/r: at 1,000 sides its
relative error is 4e-9 for a square and 7e-8 for sides 20:1), so beyond ``distant`` sides a 4 x 4
Gauss-Legendre rule takes over, with a relative error below 2e-13 from there on.
"""

from math import atan2, hypot, log, sqrt

import numpy as np

from tractive_sam.kernels.compiled import compiled


# Gauss-Legendre rule of four points on [-1/2, 1/2].
@compiled
def x_log(x, y):
    """Return x ln(y + r), the antiderivative of y²/r³; zero in the limit x = 0.

    For y < 0 the sum y + r cancels and is replaced by its equal x²/(r - y).
    """
    if x == 0.0:
        return 0.0
    r = hypot(x, y)
    # 2 ln|x|, not ln x²: the square of a tiny x would be zero.
    return x * (log(y + r) if y >= 0.0 else 2.0 * log(abs(x)) - log(r - y))


@compiled
def log_arctan(x, y):
    """Return y ln r + x atan(y/x), the antiderivative of x/r², with its limits at x = 0."""
    if x == 0.0:
        return y * log(abs(y)) if y != 0.0 else 0.0
    # atan(y/x) and atan2(y, |x|) differ only in the sign of x, which the factor x carries.
    return y * log(hypot(x, y)) + abs(x) * atan2(y, abs(x))


@compiled
def corner(x, y):
    """Return the antiderivatives of the six surface kernels at one corner of a rectangle."""
    along_x = x_log(y, x)
    along_y = x_log(x, y)
    return (
        along_x + along_y,
        along_x,
        along_y,
        -hypot(x, y),
        log_arctan(x, y),
        log_arctan(y, x),
    )


@compiled
def point(x, y):
    """Return the six surface kernels 1/r, x²/r³, y²/r³, x y/r³, x/r², y/r² at (x, y) != (0, 0)."""
    r2 = x * x + y * y
    r = sqrt(r2)
    r3 = r * r2
    return 1.0 / r, x * x / r3, y * y / r3, x * y / r3, x / r2, y / r2


@compiled
def near(x, y, dx, dy):
    """Return the six kernel integrals over a rectangle by corner differences, if it is near."""
    x1, x2 = x - 0.5 * dx, x + 0.5 * dx
    y1, y2 = y - 0.5 * dy, y + 0.5 * dy
    pp, mm = corner(x2, y2), corner(x1, y1)
    pm, mp = corner(x2, y1), corner(x1, y2)
    return (
        pp[0] + mm[0] - pm[0] - mp[0],
        pp[1] + mm[1] - pm[1] - mp[1],
        pp[2] + mm[2] - pm[2] - mp[2],
        pp[3] + mm[3] - pm[3] - mp[3],
        pp[4] + mm[4] - pm[4] - mp[4],
        pp[5] + mm[5] - pm[5] - mp[5],
    )


@compiled
def far(x, y, dx, dy):
    """Return the six kernel integrals over a distant rectangle by Gauss-Legendre quadrature."""
    weights = (0.17392742256872693, 0.32607257743127307, 0.32607257743127307, 0.17392742256872693)
    nodes = (-0.43056815579702629, -0.16999052179242813, 0.16999052179242813, 0.43056815579702629)
    # Scalars instead of an array: the compiler keeps them in registers.
    r1 = xx = yy = xy = x2 = y2 = 0.0
    for i in range(4):
        xi = x - dx * nodes[i]
        for j in range(4):
            w = weights[i] * weights[j] * dx * dy
            a, b, c, d, e, f = point(xi, y - dy * nodes[j])
            r1 += w * a
            xx += w * b
            yy += w * c
            xy += w * d
            x2 += w * e
            y2 += w * f
    return r1, xx, yy, xy, x2, y2


@compiled
def integrals(x, y, dx, dy):
    """Return the integrals of the six surface kernels over a rectangle, seen from (x, y).

    Parameters
    ----------
    x, y : float
        Observer minus centre of the rectangle, mm.
    dx, dy : float
        Sides of the rectangle, mm.

    Returns
    -------
    r1, xx, yy, xy, x2, y2 : float
        Integrals of 1/r, x²/r³, y²/r³, x y/r³, x/r² and y/r², mm.
    """
    # Distance, in longest sides of the rectangle, beyond which quadrature is the more accurate.
    distant = 12.0
    if hypot(x, y) > distant * max(dx, dy):
        return far(x, y, dx, dy)
    return near(x, y, dx, dy)


@compiled
def quadrant(nx, ny, dx, dy):
    """Return the six kernel integrals at offsets (i dx, j dy) >= 0, shape (6, nx, ny).

    The other three quadrants follow from the parities listed above.

    Parameters
    ----------
    nx, ny : int
        Number of offsets in x and y.
    dx, dy : float
        Sides of the rectangle and steps of the offsets, mm.

    Returns
    -------
    ndarray, shape (6, nx, ny)
        Integrals r1, xx, yy, xy, x2, y2, mm.
    """
    table = np.empty((6, nx, ny))
    for i in range(nx):
        for j in range(ny):
            values = integrals(i * dx, j * dy, dx, dy)
            for k in range(6):
                table[k, i, j] = values[k]
    return table
