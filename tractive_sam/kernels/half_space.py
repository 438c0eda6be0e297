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
relative error is 4e-9 for a square and 7e-8 for sides 20:1), so beyond 12 sides the integrand is
expanded about the centre of the rectangle. The integrals of x^2a y^2b over the rectangle are known,
and the derivatives of the integrands are sums of x^i y^j / r^m. With derivatives up to the eighth,
the relative error is below 2e-14.

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

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from math import comb, factorial

import numpy as np


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
    x, y = np.broadcast_arrays(x, y)
    shape, x, y = x.shape, x.ravel(), y.ravel()
    is_far = np.hypot(x, y) > _reach(dx, dy)
    values = np.empty((6, x.size))
    x1, x2 = x[~is_far] - 0.5 * dx, x[~is_far] + 0.5 * dx
    y1, y2 = y[~is_far] - 0.5 * dy, y[~is_far] + 0.5 * dy
    values[:, ~is_far] = _corner(x2, y2) + _corner(x1, y1) - _corner(x2, y1) - _corner(x1, y2)
    values[:, is_far] = _expand(x[is_far], y[is_far], dx, dy)
    return values.reshape(6, *shape)


def quadrant(nx: int, ny: int, dx: float, dy: float) -> np.ndarray:
    """Return the six kernel integrals at offsets (i dx, j dy) >= 0, shape (6, nx, ny), mm.

    The other three quadrants follow from the parities listed above. Elements share their corners.
    """
    values, rows = np.empty((6, nx, ny)), max(1, 8192 // ny)  # as many as the cache holds
    for first in range(0, nx, rows):
        x = dx * np.arange(first, min(first + rows, nx))[:, None]
        values[:, first : first + rows] = _expand(x, dy * np.arange(ny), dx, dy)
    reach = _reach(dx, dy)
    near_x, near_y = min(nx, int(reach / dx) + 1), min(ny, int(reach / dy) + 1)
    x, y = (side * (np.arange(n + 1) - 0.5) for side, n in ((dx, near_x), (dy, near_y)))
    near = np.diff(np.diff(_corner(*np.meshgrid(x, y, indexing="ij")), axis=1), axis=2)
    is_near = np.hypot(x[:-1, None] + 0.5 * dx, y[:-1] + 0.5 * dy) <= reach
    values[:, :near_x, :near_y][:, is_near] = near[:, is_near]
    return values


def _reach(dx: float, dy: float) -> float:
    """Return the distance beyond which the expansion is more accurate than corners, mm."""
    return 12.0 * max(dx, dy)


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


def _expand(x: np.ndarray, y: np.ndarray, dx: float, dy: float) -> np.ndarray:
    """Return the six kernel integrals over a distant rectangle by their expansion.

    With u = x²/r² they are x^i y^j / r^m times a polynomial in u and 1/r².
    """
    unit = max(dx, dy)
    x, y = np.broadcast_arrays(x / unit, y / unit)
    square = x * x + y * y
    inverse = 1.0 / np.where(square > 0.0, square, 1.0)
    u, root = x * x * inverse, np.sqrt(inverse)
    factors, a, b = _derivatives()
    moments = unit * (dx / unit) ** (2 * a + 1) * (dy / unit) ** (2 * b + 1)
    rows, power, k = np.empty((factors.shape[2], *x.shape)), inverse, 2
    rows[0], rows[1] = 1.0, u
    for n in range(1, a.max() + 1):
        rows[k] = power
        for i in range(k, k + n + 1):
            np.multiply(rows[i], u, out=rows[i + 1])
        k, power = k + n + 2, power * inverse
    values = np.empty((6, *x.shape))
    # Not by BLAS, which rounds the last columns otherwise: they depended on the size of the table.
    r1, xx, xy, x2, y2 = np.einsum("kt,t...->k...", moments @ factors, rows)
    values[0], values[1] = r1 * root, xx * root
    values[2] = values[0] - values[1]
    values[3] = x * y * root * inverse * xy
    values[4], values[5] = x * inverse * x2, y * inverse * y2
    return values


@cache
def _derivatives(order: int = 4) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the derivatives of the five kernels but y²/r³ that `_expand` adds.

    Those in x and y, 2 a and 2 b times, are factors of u^k / r^2n, k <= n + 1, n = a + b, times
    1/r, 1/r, x y/r³, x/r² and y/r².

    Parameters
    ----------
    order : int
        The largest n.

    Returns
    -------
    factors : ndarray, shape (5, pairs, terms)
        Over the factorials of the integral of x^2a y^2b.
    a, b : ndarray of int, shape (pairs,)
    """
    a, b = np.array([(n - b, b) for n in range(order + 1) for b in range(n + 1)]).T
    factors = np.zeros((5, a.size, order + 1, order + 2))
    for kernel, table in zip(
        ((0, 0, 1), (2, 0, 3), (1, 1, 3), (1, 0, 2), (0, 1, 2)), factors, strict=True
    ):
        for pair, (in_x, in_y) in enumerate(zip(a, b, strict=True)):
            terms = {kernel: 0.25 ** (in_x + in_y)}
            for axis, count in enumerate((2 * in_x, 2 * in_y)):
                for _ in range(count):
                    terms = _differentiate(terms, axis)
                terms = {key: factor / factorial(count + 1) for key, factor in terms.items()}
            for (i, j, _), factor in terms.items():
                for k in range(j // 2 + 1):  # y²/r² = 1 - u
                    place = in_x + in_y, i // 2 + k
                    table[pair][place] += factor * comb(j // 2, k) * (-1.0) ** k
    used = np.arange(order + 2) <= np.arange(order + 1)[:, None] + 1
    return factors[:, :, used], a, b


def _differentiate(
    terms: dict[tuple[int, int, int], float], axis: int
) -> dict[tuple[int, int, int], float]:
    """Return the derivative in x (axis 0) or y of a sum of x^i y^j / r^m, factors by (i, j, m)."""
    total: dict[tuple[int, int, int], float] = {}
    x, y = 1 - axis, axis
    for (i, j, m), factor in terms.items():
        for key, more in (((i + x, j + y, m + 2), -m), ((i - x, j - y, m), (i, j)[axis])):
            if more:
                total[key] = total.get(key, 0.0) + more * factor
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


def raised_stress(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Return the antiderivatives in x and y of seven kernels at a height z > 0, at (x, y).

    Their transforms are exp(-k z) times 1, c_x², c_x c_y, i c_x, i c_y, i c_x c_y² and i c_x² c_y,
    times 2 pi, with (c_x, c_y) = (k_x, k_y)/k. They are derivatives of 1/R, ln(R + z) and
    z ln(R + z) - R.

    Parameters
    ----------
    x, y : ndarray
        Place, broadcast against each other and z, mm.
    z : ndarray
        Height, mm.

    Returns
    -------
    ndarray, shape (7, ...)
    """
    R = np.sqrt(x**2 + y**2 + z**2)
    return np.stack(
        (
            np.arctan2(x * y, z * R),
            np.arctan2(x * y * (R - z), x**2 * R + y**2 * z),
            np.log(R + z),
            _log_sum(y, R, x, z),
            _log_sum(x, R, y, z),
            y / (R + z),
            x / (R + z),
        )
    )


def _log_sum(a: np.ndarray, R: np.ndarray, b: np.ndarray, c: np.ndarray | float) -> np.ndarray:
    """Return ln(R + a) without cancellation for a < 0; R² = a² + b² + c²."""
    return np.where(a >= 0.0, np.log(R + np.abs(a)), np.log(b**2 + c**2) - np.log(R + np.abs(a)))


def load_rectangles(
    components: tuple[str, ...],
    offsets: tuple[int, int],
    sides: tuple[float, float],
    heights: np.ndarray,
    amplitudes: np.ndarray,
    near: float = 12.0,
) -> np.ndarray:
    """Return the displacement of surfaces at heights by a unit traction on an element, mm/MPa.

    Near the element, closed forms are added over the heights. Far from it the kernels are functions
    of the distance, which are added once and interpolated.

    Parameters
    ----------
    components : tuple of str
        "zz"; "xz" and "yz"; or "xx", "xy" and "yy", which share their functions.
    offsets, sides
        See `Elasticity.coefficients`.
    heights : ndarray, shape (m,)
        mm.
    amplitudes : ndarray, shape (4, m)
        See `SurfaceResponse.images`.
    near : float
        Distance from an element, in its longest side, beyond which Gauss points integrate over it.

    Returns
    -------
    ndarray, shape (components, n_x, n_y)
    """
    x, y = (side * np.arange(n) for side, n in zip(sides, offsets, strict=True))
    distance, longest = np.hypot(x[:, None], y), max(sides)
    table = _average_over_elements(_Radial(components, heights, amplitudes), offsets, sides, 30.0)
    close = distance <= near * longest
    ring = ~close & (distance <= 40.0 * longest)
    i, j = np.nonzero(ring)
    table[:, ring] = load_distant(components, x[i], y[j], sides, heights, amplitudes, near)
    i, j = np.nonzero(close)
    columns, rows, low = i.max() + 1, j.max() + 1, heights <= near * longest
    corners = _add_corners(components, (columns, rows), sides, heights[low], amplitudes[:, low])
    high = _Radial(components, heights[~low], amplitudes[:, ~low])
    values = corners[:, i, j] + _integrate(high.at, x[i], y[j], sides, 3)
    table[:, close] = values / (2.0 * np.pi)
    return table


def load_distant(
    components: tuple[str, ...],
    x: np.ndarray,
    y: np.ndarray,
    sides: tuple[float, float],
    heights: np.ndarray,
    amplitudes: np.ndarray,
    near: float = 12.0,
) -> np.ndarray:
    """Return the displacement of surfaces at heights at places (n,) far from a loaded element.

    They are at least `near` longest sides away. Other parameters as in `load_rectangles`.

    Returns
    -------
    ndarray, shape (components, n)
    """
    longest, distance = max(sides), np.hypot(x, y)
    radial = _Radial(components, heights, amplitudes)
    radial.interpolated((near - 1.0) * longest, distance.max(initial=longest) + longest)
    values = np.empty((len(components), x.size))
    for part, points in ((distance <= 40.0 * longest, 3), (distance > 40.0 * longest, 2)):
        values[:, part] = _integrate(radial.interpolate, x[part], y[part], sides, points)
    return values / (2.0 * np.pi)


def _average_over_elements(
    radial: "_Radial", offsets: tuple[int, int], sides: tuple[float, float], nearest: float
) -> np.ndarray:
    """Return the displacement at elements by a unit traction on an element, (components, n_x, n_y).

    Along each side the integral is that of differences of values at centres of elements, 1 + d²/24
    - 17 d⁴/5760; beyond 40 longest sides its relative error is 1e-10.

    Parameters
    ----------
    radial : _Radial
        Displacement by a force.
    offsets, sides
        See `Elasticity.coefficients`.
    nearest : float
        Distance, in longest sides, up to which results are not used.
    """
    x, y = (side * np.arange(-2, n + 2) for side, n in zip(sides, offsets, strict=True))
    nearest *= max(sides)
    radial.interpolated(nearest, max(nearest, float(np.hypot(x[-1], y[-1]))))
    values = radial.interpolate(x[:, None], y)
    fourth, second = -17.0 / 5760.0, 1.0 / 24.0
    weights = fourth, second - 4.0 * fourth, 1.0 - 2.0 * second + 6.0 * fourth
    for (nx, ny), side in zip(((offsets[0], y.size), offsets), sides, strict=True):
        a, b, c = (side * weight for weight in weights)
        first, before, at, behind, last = (
            values[:, k : k + nx] if ny == y.size else values[..., k : k + ny] for k in range(5)
        )
        values = a * (first + last) + b * (before + behind) + c * at
    return values / (2.0 * np.pi)


def _add_corners(
    components: tuple[str, ...],
    offsets: tuple[int, int],
    sides: tuple[float, float],
    heights: np.ndarray,
    amplitudes: np.ndarray,
) -> np.ndarray:
    """Return sums of closed forms over heights, times 2 pi; see `load_rectangles`."""
    x, y = (side * (np.arange(n + 1) - 0.5) for side, n in zip(sides, offsets, strict=True))
    kernels = raised_antiderivatives(x[:, None, None], y[:, None], heights)
    inverse, fall_x, fall_y, fall_xy, over_x, over_y = kernels
    zz, LL, TT, Lz = amplitudes
    match components[0]:
        case "zz":
            values = [inverse @ zz]
        case "xz":
            values = [-over_x @ Lz, -over_y @ Lz]
        case _:
            first, bend = inverse @ TT, LL - TT
            values = [first + fall_x @ bend, -fall_xy @ bend, first + fall_y @ bend]
    return np.diff(np.diff(values, axis=1), axis=2)


def _integrate(
    kernel: Callable[[np.ndarray, np.ndarray], np.ndarray],
    x: np.ndarray,
    y: np.ndarray,
    sides: tuple[float, float],
    points: int,
) -> np.ndarray:
    """Return the integrals of a kernel over elements with centres x, y (n,) by Gauss points."""
    nodes, weights = np.polynomial.legendre.leggauss(points)
    dx, dy = sides
    return sum(
        0.25 * dx * dy * weights[i] * weights[j]
        * kernel(x + 0.5 * dx * nodes[i], y + 0.5 * dy * nodes[j])
        for i, j in np.ndindex(points, points)
    )  # fmt: skip


@dataclass(eq=False)
class _Radial:
    """Displacement of surfaces at heights by a unit force, times 2 pi, by functions of distance.

    Parameters
    ----------
    components : tuple of str
        See `load_rectangles`.
    heights : ndarray, shape (m,)
        mm.
    amplitudes : ndarray, shape (4, m)
        See `SurfaceResponse.images`.
    """

    components: tuple[str, ...]
    heights: np.ndarray
    amplitudes: np.ndarray

    def at(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the displacements at (x, y), (components, ...)."""
        r = np.maximum(np.hypot(x, y), 1e-60)  # the values at 0 are limits
        return self._combine(x, y, r, self._functions(r))

    def _functions(self, r: np.ndarray) -> list[np.ndarray]:
        """Return the one or two functions of the distance, of order 1, times its powers."""
        zz, LL, TT, Lz = self.amplitudes
        r = r[:, None]
        R = np.sqrt(r**2 + self.heights**2)
        reach = R + self.heights
        match self.components[0]:
            case "zz":
                return [(r / R) @ zz]
            case "xz":
                return [(r**2 / (R * reach)) @ Lz]
        return [(r / R) @ TT + (r / reach) @ (LL - TT), (r**3 / (R * reach**2)) @ (LL - TT)]

    def _combine(
        self, x: np.ndarray, y: np.ndarray, r: np.ndarray, functions: list[np.ndarray]
    ) -> np.ndarray:
        """Return the displacements from the functions of the distance r."""
        x, y, first = x / r, y / r, functions[0]
        match self.components[0]:
            case "zz":
                rows = [first]
            case "xz":
                rows = [-first * x, -first * y]
            case _:
                bend = functions[1]
                rows = [first - x * x * bend, -x * y * bend, first - y * y * bend]
        return np.stack(rows) / r

    def interpolated(self, nearest: float, farthest: float, step: float = 0.01) -> "_Radial":
        """Tabulate the functions between two distances, in equal steps of their logarithm."""
        self._start, self._step = np.log(nearest) - step, step
        count = int((np.log(farthest) - self._start) / step) + 4
        nodes = np.exp(self._start + step * np.arange(count))
        to_cubic = np.array([[0, 6, 0, 0], [-2, -3, 6, -1], [3, -6, 3, 0], [-1, 3, -3, 1]]) / 6.0
        self._cubics = [
            to_cubic @ np.stack([values[k : count - 3 + k] for k in range(4)])
            for values in self._functions(nodes)
        ]
        return self

    def interpolate(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the displacements at (x, y) by cubic interpolation (error 1e-10).

        Nearer places have the functions of the nearest distance of the table.
        """
        square = np.maximum(x * x + y * y, np.exp(2.0 * (self._start + self._step)))
        place = (0.5 * np.log(square) - self._start) / self._step
        node = place.astype(int)
        t = place - node
        node = np.maximum(node - 1, 0)
        values = []
        for cubic in self._cubics:
            a, b, c, d = (row[node] for row in cubic)
            values.append(a + t * (b + t * (c + t * d)))
        return self._combine(x, y, np.sqrt(square), values)


def load_strips(
    component: str,
    x: np.ndarray,
    dx: float,
    heights: np.ndarray,
    amplitudes: np.ndarray,
    datum: float,
    near: float = 12.0,
) -> np.ndarray:
    """Return the displacement of strips at heights by a unit traction on a strip, mm/MPa, (n,).

    As in `Strips`, displacements are zero on average at the distance `datum` from each load. The
    first height is 0.

    Parameters as in `Elasticity.coefficients` and `load_rectangles`; `x` (n,) are distances from
    the load, mm.
    """
    rows = {"zz": amplitudes[0], "xx": amplitudes[1], "yy": amplitudes[2], "xz": -amplitudes[3]}
    if component not in rows:
        return np.zeros(x.size)
    (first, *_), d = rows[component], heights[1:]
    odd = component == "xz"
    surface = integrate_sign(x, dx) if odd else integrate_logarithm(x, dx, datum)

    def kernel(x: np.ndarray) -> np.ndarray:
        """Return the displacement by a force at the distances x, (n, m)."""
        if odd:
            return 2.0 * np.arctan(x[:, None] / d)
        return -np.log1p((x[:, None] ** 2 - datum**2) / (d**2 + datum**2))

    def antiderivative(x: np.ndarray) -> np.ndarray:
        """Return the antiderivative of the kernel."""
        x = x[:, None]
        if odd:
            return 2.0 * x * np.arctan(x / d) - d * np.log((x**2 + d**2) / (d**2 + datum**2))
        return x * (kernel(x[:, 0]) + 2.0) - 2.0 * d * np.arctan(x / d)

    nodes, weights = np.polynomial.legendre.leggauss(3)
    raised = sum(
        0.5 * dx * w * kernel(x + 0.5 * dx * t) for t, w in zip(nodes, weights, strict=True)
    )
    close = (x <= near * dx)[:, None] & (d <= near * dx)
    exact = antiderivative(x + 0.5 * dx) - antiderivative(x - 0.5 * dx)
    raised = np.where(close, exact, raised)
    return (first * surface + raised @ rows[component][1:]) / (2.0 * np.pi)
