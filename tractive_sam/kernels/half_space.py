"""Point kernels of the half-space and the half-plane, integrated over a rectangle or a strip.

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

The strip is centred at the origin with the width ``dx``; ``x`` is observer minus centre. Integrated
over y, the kernels of :mod:`tractive_sam.kernels.half_space` become

========  ====================  ==========
from      integrand             in x
========  ====================  ==========
1/r       -2 ln(abs(x)/d)       even
y²/r³     -2 ln(abs(x)/d)       even
x/r²      pi sign(x)            odd
========  ====================  ==========

and x²/r³, x y/r³ and y/r² contribute nothing. An infinitely long load moves the half-plane
infinitely far, so that only displacements relative to some other point have a meaning: here the
mean of the points of the surface at the distance d from each load.

Source: Johnson, Contact Mechanics (1985), sections 2.2, 2.3 and 2.5, which take derivatives in x
instead of a datum.

The solutions of Boussinesq and Cerruti for a point load (Johnson 1985, Contact Mechanics, section
3.2 and 3.6) are integrated over the rectangle in closed form. With m = 1 - 2 nu and R² = x² + y² +
z² the displacement of the half-space z >= 0 by a unit force, times 4 pi G, is

    u_x by p_x   1/R + x²/R³ + m (1/(R + z) - x²/(R (R + z)²))
    u_x by p_y   x y/R³ - m x y/(R (R + z)²)
    u_x by p_z   x z/R³ - m x/(R (R + z))
    u_z by p_x   x z/R³ + m x/(R (R + z))
    u_z by p_z   z²/R³ + 2 (1 - nu)/R

and the others follow by exchange of x and y.
"""

import numpy as np


def point(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return the six surface kernels 1/r, x²/r³, y²/r³, x y/r³, x/r², y/r² at (x, y) != (0, 0)."""
    xx, yy = x * x, y * y
    over_r2 = 1.0 / (xx + yy)
    over_r = np.sqrt(over_r2)
    over_r3 = over_r * over_r2
    return over_r, xx * over_r3, yy * over_r3, x * y * over_r3, x * over_r2, y * over_r2


def integrals(x: np.ndarray, y: np.ndarray, dx: float, dy: float) -> np.ndarray:
    """Return the integrals of the six surface kernels over a rectangle, seen from points (x, y).

    Parameters
    ----------
    x, y : ndarray or float
        Observer minus centre of the rectangle, mm; broadcast against each other.
    dx, dy : float
        Sides of the rectangle, mm.

    Returns
    -------
    ndarray, shape (6, ...)
        Integrals r1, xx, yy, xy, x2, y2 of 1/r, x²/r³, y²/r³, x y/r³, x/r² and y/r², mm.
    """
    # Distance, in longest sides of the rectangle, beyond which quadrature is the more accurate.
    distant = 12.0
    x, y = np.broadcast_arrays(x, y)
    shape, x, y = x.shape, x.ravel(), y.ravel()
    is_far = np.hypot(x, y) > distant * max(dx, dy)
    values = np.empty((6, x.size))
    x1, x2 = x[~is_far] - 0.5 * dx, x[~is_far] + 0.5 * dx
    y1, y2 = y[~is_far] - 0.5 * dy, y[~is_far] + 0.5 * dy
    values[:, ~is_far] = _corner(x2, y2) + _corner(x1, y1) - _corner(x2, y1) - _corner(x1, y2)
    values[:, is_far] = _far(x[is_far], y[is_far], dx, dy)
    return values.reshape(6, *shape)


def quadrant(nx: int, ny: int, dx: float, dy: float) -> np.ndarray:
    """Return the six kernel integrals at offsets (i dx, j dy) >= 0, shape (6, nx, ny), mm.

    The other three quadrants follow from the parities listed above.
    """
    return integrals(dx * np.arange(nx)[:, None], dy * np.arange(ny), dx, dy)


def _corner(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the antiderivatives of the six surface kernels at one corner of a rectangle."""
    r = np.hypot(x, y)
    along_x, along_y = _x_log(y, x, r), _x_log(x, y, r)
    both, angle = np.log(_nonzero(r)), np.arctan2(np.abs(y), np.abs(x))
    in_x = y * both + x * np.copysign(angle, x * y)
    in_y = x * both + y * np.copysign(0.5 * np.pi - angle, x * y)
    return np.stack((along_x + along_y, along_x, along_y, -r, in_x, in_y))


def _x_log(x: np.ndarray, y: np.ndarray, r: np.ndarray) -> np.ndarray:
    """Return x ln(y + r), the antiderivative of y²/r³; zero in the limit x = 0.

    For y < 0 the sum y + r cancels and is replaced by its equal x²/(r - y).
    """
    logarithm = np.log(_nonzero(np.abs(y) + r))
    # 2 ln|x|, not ln x²: the square of a tiny x would be zero.
    return x * np.where(y >= 0.0, logarithm, 2.0 * np.log(_nonzero(np.abs(x))) - logarithm)


def _nonzero(values: np.ndarray) -> np.ndarray:
    """Return the values, with 1 where they are 0: there, a factor 0 multiplies the logarithm."""
    return np.where(values == 0.0, 1.0, values)


def _far(x: np.ndarray, y: np.ndarray, dx: float, dy: float) -> np.ndarray:
    """Return the six kernel integrals over a distant rectangle by Gauss-Legendre quadrature."""
    nodes, weights = np.polynomial.legendre.leggauss(4)  # on [-1, 1]
    total = np.zeros((6, x.size))
    for node_x, weight_x in zip(0.5 * nodes, 0.5 * weights, strict=True):
        for node_y, weight_y in zip(0.5 * nodes, 0.5 * weights, strict=True):
            share = weight_x * weight_y * dx * dy
            for k, kernel in enumerate(point(x - dx * node_x, y - dy * node_y)):
                total[k] += share * kernel
    return total


def integrate_logarithm(x: np.ndarray, dx: float, datum: float) -> np.ndarray:
    """Return the integral of -2 ln(|x|/datum) over a strip, at distances x of its centre, mm.

    With h = dx/2 it is 4 h - 2 (x + h) ln(|x + h|/d) + 2 (x - h) ln(|x - h|/d); the terms that
    cancel far from the strip are taken together.

    Parameters
    ----------
    x : ndarray
        Observer minus centre of the strip, mm.
    dx : float
        Width of the strip, mm.
    datum : float
        Distance d at which the displacement by a load is taken to be zero, mm.
    """
    h, x = 0.5 * dx, np.abs(x)
    apart = np.abs(x - h)  # and x + h - apart is 2 x or dx, whichever is less
    # On an edge of the strip, apart = 0, the product with the infinite logarithm is zero.
    inner = np.where(apart > 0.0, apart, 1.0)
    outward = 2.0 * (x - h) * np.log1p(np.minimum(2.0 * x, dx) / inner)
    return 2.0 * dx - outward - 2.0 * dx * np.log((x + h) / datum)


def integrate_sign(x: np.ndarray, dx: float) -> np.ndarray:
    """Return the integral of pi sign(x) over a strip, at distances x of its centre, mm."""
    return np.pi * np.clip(2.0 * x, -dx, dx)


PARITY = {
    "xx": (1, 1), "xy": (-1, -1), "yy": (1, 1), "xz": (-1, 1), "yz": (1, -1),
    "zx": (-1, 1), "zy": (1, -1), "zz": (1, 1),
}  # fmt: skip
"""Parity in x and in y of each component; "xz" is u_x by p_z."""


def displacement_quadrant(
    offsets: tuple[int, int], dx: float, dy: float, depth: float, poisson: float
) -> dict[str, np.ndarray]:
    """Return the displacements at a depth, times shear modulus, by unit tractions on a rectangle.

    Parameters
    ----------
    offsets : tuple of int
        Number of offsets (i dx, j dy) from the centre of the rectangle, from 0 on.
    dx, dy : float
        Sides of the rectangle, mm.
    depth : float
        Depth z below the surface, mm.
    poisson : float
        Poisson's ratio.

    Returns
    -------
    dict of str to ndarray of shape `offsets`
        Components of `PARITY`, mm.
    """
    x = dx * (np.arange(offsets[0] + 1) - 0.5)[:, None]
    y = dy * (np.arange(offsets[1] + 1) - 0.5)[None, :]
    corners = _antiderivatives(x, y, depth, poisson)
    return {
        name: np.diff(np.diff(values, axis=0), axis=1) / (4.0 * np.pi)
        for name, values in corners.items()
    }


def _antiderivatives(
    x: np.ndarray, y: np.ndarray, z: float, poisson: float
) -> dict[str, np.ndarray]:
    """Return the antiderivative of each displacement component by name, at corners x, y != 0."""
    m, R = 1.0 - 2.0 * poisson, np.sqrt(x**2 + y**2 + z**2)
    log_x, log_y = _log_sum(x, R, y, z), _log_sum(y, R, x, z)  # ln(R + x), ln(R + y)
    solid_angle = np.arctan2(x * y, z * R)
    inverse, fall_x, fall_y, _, over_x, over_y = raised_antiderivatives(x, y, z)
    return {
        "xx": inverse + y * log_x - z * solid_angle + m * fall_x,
        "xy": -R + m * (R - z * np.log(R + z)),
        "yy": inverse + x * log_y - z * solid_angle + m * fall_y,
        "xz": -z * log_y - m * over_x,
        "yz": -z * log_x - m * over_y,
        "zx": -z * log_y + m * over_x,
        "zy": -z * log_x + m * over_y,
        "zz": z * solid_angle + 2.0 * (1.0 - poisson) * inverse,
    }


def raised_antiderivatives(
    x: np.ndarray, y: np.ndarray, z: np.ndarray | float
) -> tuple[np.ndarray, ...]:
    """Return the antiderivatives in x and y of six kernels at a height z, at corners x, y != 0.

    They belong to 1/R, 1/(R + z) - x²/(R (R + z)²), the same with y, x y/(R (R + z)²),
    x/(R (R + z)) and y/(R (R + z)), mm. Their transforms are exp(-k z)/k times 1, k_x²/k²,
    k_y²/k², -k_x k_y/k², -i k_x/k and -i k_y/k, times 2 pi.
    """
    R = np.sqrt(x**2 + y**2 + z**2)
    log_x, log_y = _log_sum(x, R, y, z), _log_sum(y, R, x, z)  # ln(R + x), ln(R + y)
    solid_angle = np.arctan2(x * y, z * R)
    # atan(y z/(x R)) - atan(y/x), and with x and y exchanged.
    turn_x = np.arctan2(x * y * (z - R), x**2 * R + y**2 * z)
    turn_y = np.arctan2(x * y * (z - R), y**2 * R + x**2 * z)
    return (
        x * log_y + y * log_x - z * solid_angle,
        x * log_y + z * turn_x,
        y * log_x + z * turn_y,
        z * np.log(R + z) - R,
        y * np.log(R + z) + z * log_y - x * turn_x,
        x * np.log(R + z) + z * log_x - y * turn_y,
    )


def _log_sum(a: np.ndarray, R: np.ndarray, b: np.ndarray, c: np.ndarray | float) -> np.ndarray:
    """Return ln(R + a) without cancellation for a < 0; R² = a² + b² + c²."""
    return np.where(a >= 0.0, np.log(R + np.abs(a)), np.log(b**2 + c**2) - np.log(R + np.abs(a)))
