"""Closed forms and simplified theories of rolling contact, and a global model of its wear.

The creep-force curves are functions of the creep parameter of eq. (40) and give Q / (mu P). They
are continued as odd functions to negative parameters. Source of the numbering: Juliá & Rodríguez-
Tembleque, Int. J. Mech. Sci. 294 (2025) 110195.

Kalker's linear theory: a is the semi-axis in the rolling direction x, c² = a b, forces act on A:

    F_x = -G c² C11 xi_x
    F_y = -G (c² C22 xi_y + c³ C23 phi)
    M_z = -G (-c³ C23 xi_y + c⁴ C33 phi)

Source: Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990).
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline

from tractive_sam.description import ShortArrays
from tractive_sam.mechanics import CombinedMaterial, HertzLine


@dataclass(frozen=True)
class Carter:
    """Carter's solution: rolling cylinders of equal material under longitudinal creepage.

    The contact sticks over a strip of half-width c that touches the leading edge x = a and slips
    behind it. Sources: Carter, Proc. R. Soc. A 112 (1926) 151; Johnson, Contact Mechanics
    (1985), section 8.3. With R the combined radius, as in `HertzLine`:

        |xi_x| = mu (a - c) / R,    |Q| / (mu P) = 1 - (c/a)²

    Parameters
    ----------
    hertz : HertzLine
        The normal contact.
    mu : float
        Friction coefficient.
    creepage : float
        xi_x; negative drives body A, Q > 0.

    Examples
    --------
    >>> hertz = hertz_line(e_star=114e3, radius=25.0, load_per_length=500.0)
    >>> carter = Carter.from_force_ratio(hertz, mu=0.3, ratio=0.64)
    >>> round(carter.stick_half_width / hertz.a, 3)
    0.6
    """

    hertz: HertzLine
    mu: float
    creepage: float

    @classmethod
    def from_force_ratio(cls, hertz: HertzLine, mu: float, ratio: float) -> Carter:
        """Return the solution with force `ratio` = Q/(mu P); ValueError outside [-1, 1].

        Raises
        ------
        ValueError
            If the ratio lies outside [-1, 1]: friction cannot carry it.
        """
        if not abs(ratio) <= 1:
            raise ValueError(f"Q/(mu P) must lie between -1 and 1, not {ratio}")
        # 1 - sqrt(1 - q), without the cancellation at small forces
        slip_share = ratio / (1 + math.sqrt(1 - abs(ratio)))
        return cls(hertz, mu, -slip_share * mu * hertz.a / hertz.radius)

    @property
    def stick_half_width(self) -> float:
        """Half-width c of the stick area, mm; 0 in full slip."""
        return max(0.0, self.hertz.a - self.hertz.radius * abs(self.creepage) / self.mu)

    @property
    def force_ratio(self) -> float:
        """Q/(mu P), from -1 to 1."""
        return self._drive * (1 - (self.stick_half_width / self.hertz.a) ** 2)

    def traction(self, x: ArrayLike) -> NDArray[np.float64]:
        """Return the traction p_x on body A at x in mm, MPa; zero outside the contact."""
        c = self.stick_half_width
        scale = self.mu * self.hertz.p0 / self.hertz.a
        full = np.sqrt(np.maximum(0.0, self.hertz.a**2 - np.square(x)))
        relief = np.sqrt(np.maximum(0.0, c**2 - np.square(self._from_stick_centre(x))))
        return self._drive * scale * (full - relief)

    def slip(self, x: ArrayLike) -> NDArray[np.float64]:
        """Return the slip s_x/V of A over B at x in mm; zero in the stick area and outside."""
        c, behind = self.stick_half_width, -self._from_stick_centre(x)
        if c > 0:
            size = np.sqrt(np.maximum(0.0, np.square(behind) - c**2)) * (behind > 0)
        else:
            # full slip: creepage above the smallest one for full slip adds a constant
            size = self.hertz.radius * abs(self.creepage) / self.mu - np.asarray(x)
        inside = np.abs(x) <= self.hertz.a
        return np.where(inside, -self._drive * self.mu / self.hertz.radius * size, 0.0)

    @property
    def _drive(self) -> float:
        """Sign of the tangential force on body A, opposite to the slip."""
        return -math.copysign(1.0, self.creepage)

    def _from_stick_centre(self, x: ArrayLike) -> NDArray[np.float64]:
        """Return positions relative to the middle of the stick zone, mm."""
        return np.asarray(x, float) - (self.hertz.a - self.stick_half_width)


# Slip changes sign at the pressure p0 cos t; half of the load lies between these two points if 2t +
# sin 2t = pi/2. This is cos(t) / 2 at its root, 0.457 in the literature.
def bentall_johnson_creepage(material: CombinedMaterial, a: float, radius: float) -> float:
    """Return the creepage of free rolling dissimilar cylinders, mu -> 0: -0.457 kappa a / R.

    With kappa = 2 K / (1 - nu). Source: Bentall & Johnson, Int. J. Mech. Sci. 9 (1967) 389, in
    the closed form that the limit allows: with vanishing tractions the slip is
    s_x/V = xi_x + (2 K / G) p_n, and the friction forces of the forward- and backward-slipping
    parts cancel. Negative if the upper body A is the more compliant one, K > 0.

    Parameters
    ----------
    material : CombinedMaterial
        The pair of bodies.
    a : float
        Half-width of the contact, mm.
    radius : float
        Combined radius R, 1/R = 1/R_A + 1/R_B, mm.

    Examples
    --------
    >>> steel, aluminium = Material(82e3, 0.28), Material(23e3, 0.31)
    >>> round(bentall_johnson_creepage(combine(aluminium, steel), a=0.1, radius=25.0), 7)
    -0.0005263
    """
    share = 0.45738550878651788
    kappa = 2 * material.coupling / (1 - material.poisson)
    return -share * kappa * a / radius


def creep_parameter(
    xi_x: ArrayLike, *, shear: float, a: float, mu: float, load: float, poisson: float
) -> NDArray[np.float64]:
    """Normalise a longitudinal creepage, -xi_x 16 G a² / (3 mu P (4 - 3 nu)), eq. (40).

    Parameters
    ----------
    xi_x : array_like
        Longitudinal creepage; negative drives body A, which makes the parameter positive.
    shear, poisson : float
        Combined shear modulus, MPa, and Poisson's ratio.
    a : float
        Radius of the contact, mm.
    mu : float
        Friction coefficient.
    load : float
        Normal load P, N.

    Examples
    --------
    >>> parameter = creep_parameter(-0.0031, shear=1.0, a=3.5, mu=0.4013, load=0.4705, poisson=0.28)
    >>> round(float(parameter), 3)
    0.339
    """
    return -np.multiply(xi_x, 16 * shear * a**2 / (3 * mu * load * (4 - 3 * poisson)))


def vermeulen_johnson(xi: ArrayLike) -> NDArray[np.float64]:
    """Return Q/(mu P) = 1 - (1 - xi)³, ±1 beyond |xi| = 1, odd; Vermeulen & Johnson (1964).

    Eq. (41) of the paper.

    Examples
    --------
    >>> vermeulen_johnson([0.0, 0.5, 1.0])
    array([0.   , 0.875, 1.   ])
    """
    size = np.minimum(np.abs(xi), 1.0)
    return np.copysign(size * (3.0 - size * (3.0 - size)), xi)


def vermeulen_johnson_inverse(ratio: ArrayLike) -> NDArray[np.float64]:
    """Return the creep parameter that transmits `ratio` = Q/(mu P), by the inverse of eq. (41).

    Raises
    ------
    ValueError
        If a ratio lies outside [-1, 1]: friction cannot carry it.

    Examples
    --------
    >>> float(vermeulen_johnson_inverse(0.875))
    0.5
    """
    size = np.abs(ratio)
    if not np.all(size <= 1):
        raise ValueError("Q/(mu P) must lie between -1 and 1")
    root = np.cbrt(1.0 - size)
    # 1 - root, without the cancellation at small forces
    return np.copysign(size / (1.0 + root + root**2), ratio)


def kalker_simplified(xi: ArrayLike) -> NDArray[np.float64]:
    """Return Q/(mu P) of Kalker's simplified theory (1967), eq. (42); odd, ±1 from |xi| = 1.

    Q/(mu P) = 3/2 xi arccos(xi) + 1 - (1 + xi²/2) sqrt(1 - xi²) for 0 <= xi <= 1.

    A simplified theory, 5-6 % below the half-space solution at small creepage; the two meet at
    full slip, xi = 1.

    Examples
    --------
    >>> kalker_simplified([0.0, 0.5, 1.0]).round(4)
    array([0.    , 0.8111, 1.    ])
    """
    size = np.minimum(np.abs(xi), 1.0)
    root = (1.0 + size**2 / 2) * np.sqrt(1.0 - size**2)
    # 1 - root = (1 - root²) / (1 + root), without the cancellation at small creepage
    rest = size**4 * (3.0 + size**2) / 4 / (1.0 + root)
    return np.copysign(1.5 * size * np.arccos(size) + rest, xi)


def full_slip_with_spin(
    a_over_b: float, slip: tuple[float, float], spin: float, points: int = 128, most: int = 20_000
) -> tuple[float, float, float]:
    """Return (Q_x, Q_y, M_z / c) / (mu P) of full slip, c = sqrt(a b), isotropic friction.

    The traction -mu p s/|s| against the slip s = (xi_x - phi y, xi_y + phi x) of rigid bodies,
    integrated over the ellipse of Hertz in polar coordinates around the pole at which the slip
    vanishes. There its direction depends on the angle alone, and the integral along the radius is
    elementary. It is the limit of rolling for increasing creepages.

    Parameters
    ----------
    a_over_b : float
        Semi-axis in the rolling direction over the lateral one.
    slip : tuple of float
        (xi_x, xi_y), in any unit.
    spin : float
        c phi, in the unit of `slip`.
    points : int
        Integration points over the angle if the pole of the slip is outside the contact; if it is
        inside, their number increases towards the edge.
    most : int
        Largest number of integration points.

    Examples
    --------
    >>> full_slip_with_spin(1.0, (1.0, 0.0), 0.0)
    (-1.0, 0.0, 0.0)
    >>> round(full_slip_with_spin(1.0, (0.0, 0.0), 1.0)[2] / (-3 * np.pi / 16), 6)
    1.0
    """
    size = math.hypot(*slip)
    if spin == 0.0:
        return 0.0 - slip[0] / size, 0.0 - slip[1] / size, 0.0
    stretch = math.sqrt(a_over_b)
    # Coordinates in which the ellipse is the unit circle; the pole is at distance d.
    pole = np.array([-slip[1] / spin / stretch, slip[0] / spin * stretch])
    d = math.hypot(*pole)
    angle, weight = _angles_around(pole, d, points, most)
    n = np.stack([np.cos(angle), np.sin(angle)])
    m = -(pole @ n)
    h2 = np.maximum(1.0 - (pole[0] * n[1] - pole[1] * n[0]) ** 2, 0.0)
    # Integrals of rho p and rho² p over rho, p = sqrt(h² - (rho - m)²).
    if d < 1.0:
        g, h = math.sqrt(1.0 - d * d), np.sqrt(h2)
        arc = 0.5 * math.pi + np.arcsin(np.clip(m / h, -1.0, 1.0))
        zeroth = 0.5 * (h2 * arc + m * g)
        first = g**3 / 3.0
        second = h2**2 / 8.0 * arc + m * (2.0 * m * m - h2) * g / 8.0
    else:
        zeroth, first, second = 0.5 * math.pi * h2, 0.0, math.pi / 8.0 * h2**2
    radial = first + m * zeroth
    moment = second + 2.0 * m * first + m * m * zeroth
    v = n * np.array([[stretch], [1.0 / stretch]])
    length = np.hypot(*v)
    factor = -math.copysign(3.0 / (2.0 * math.pi), spin)
    Qx = factor * (weight * radial * -v[1] / length).sum()
    Qy = factor * (weight * radial * v[0] / length).sum()
    about_pole = factor * (weight * moment * length).sum()
    x, y = pole[0] * stretch, pole[1] / stretch
    return float(Qx), float(Qy), float(about_pole + x * Qy - y * Qx)


def _angles_around(
    pole: np.ndarray, distance: float, points: int, max_points: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return the angles of rays from a pole that meet the unit disc, and their weights."""
    if distance < 1.0:
        # Near the edge the integrand has a peak as wide as the distance of the pole from it.
        count = int(min(max_points, points * (1.0 + 0.3 / (1.0 - distance))))
        return np.arange(count) * (2.0 * math.pi / count), np.full(count, 2.0 * math.pi / count)
    nodes, weights = np.polynomial.legendre.leggauss(points)
    half = math.asin(min(1.0, 1.0 / distance))
    return math.atan2(-pole[1], -pole[0]) + half * nodes, half * weights


POISSON_RATIOS = (0.0, 0.25, 0.5)
"""Combined Poisson's ratios of the three columns of every coefficient."""

CREEP_COEFFICIENTS = (
    # a/b,       C11,               C22,               C23,                C33
    (0.1, (2.51, 3.31, 4.85), (2.51, 2.52, 2.53), (0.334, 0.473, 0.731), (6.42, 8.28, 11.7)),
    (0.2, (2.59, 3.37, 4.81), (2.59, 2.63, 2.66), (0.483, 0.603, 0.809), (3.46, 4.27, 5.66)),
    (0.3, (2.68, 3.44, 4.8), (2.68, 2.75, 2.81), (0.607, 0.715, 0.889), (2.49, 2.96, 3.72)),
    (0.4, (2.78, 3.53, 4.82), (2.78, 2.88, 2.98), (0.72, 0.823, 0.977), (2.02, 2.32, 2.77)),
    (0.5, (2.88, 3.62, 4.83), (2.88, 3.01, 3.14), (0.827, 0.929, 1.07), (1.74, 1.93, 2.22)),
    (0.6, (2.98, 3.72, 4.91), (2.98, 3.14, 3.31), (0.93, 1.03, 1.18), (1.56, 1.68, 1.86)),
    (0.7, (3.09, 3.81, 4.97), (3.09, 3.28, 3.48), (1.03, 1.14, 1.29), (1.43, 1.5, 1.6)),
    (0.8, (3.19, 3.91, 5.05), (3.19, 3.41, 3.65), (1.13, 1.25, 1.4), (1.34, 1.37, 1.42)),
    (0.9, (3.29, 4.01, 5.12), (3.29, 3.54, 3.82), (1.23, 1.36, 1.51), (1.27, 1.27, 1.27)),
    (1.0, (3.4, 4.12, 5.2), (3.4, 3.67, 3.98), (1.33, 1.47, 1.63), (1.21, 1.19, 1.16)),
    (1 / 0.9, (3.51, 4.22, 5.3), (3.51, 3.81, 4.16), (1.44, 1.59, 1.77), (1.16, 1.11, 1.06)),
    (1 / 0.8, (3.65, 4.36, 5.42), (3.65, 3.99, 4.39), (1.58, 1.75, 1.94), (1.1, 1.04, 0.954)),
    (1 / 0.7, (3.82, 4.54, 5.58), (3.82, 4.21, 4.67), (1.76, 1.95, 2.18), (1.05, 0.965, 0.852)),
    (1 / 0.6, (4.06, 4.78, 5.8), (4.06, 4.5, 5.04), (2.01, 2.23, 2.5), (1.01, 0.892, 0.751)),
    (1 / 0.5, (4.37, 5.1, 6.11), (4.37, 4.9, 5.56), (2.35, 2.62, 2.96), (0.958, 0.819, 0.65)),
    (1 / 0.4, (4.84, 5.57, 6.57), (4.84, 5.48, 6.31), (2.88, 3.24, 3.7), (0.912, 0.747, 0.549)),
    (1 / 0.3, (5.57, 6.34, 7.34), (5.57, 6.4, 7.51), (3.79, 4.32, 5.01), (0.868, 0.674, 0.446)),
    (1 / 0.2, (6.96, 7.78, 8.82), (6.96, 8.14, 9.79), (5.72, 6.63, 7.89), (0.828, 0.601, 0.341)),
    (1 / 0.1, (10.7, 11.7, 12.9), (10.7, 12.8, 16.0), (12.2, 14.6, 18.0), (0.795, 0.526, 0.228)),
)
"""Rows (a/b, C11, C22, C23, C33), each coefficient for the three `POISSON_RATIOS`.

Source: Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990), Table E.3.
"""


class CreepCoefficients(NamedTuple):
    """Kalker's creep coefficients C11, C22, C23 and C33.

    Examples
    --------
    >>> creep_coefficients(1.0, 0.25).C11
    4.12
    """

    C11: float
    C22: float
    C23: float
    C33: float


class CreepForces(NamedTuple):
    """Resultant tractions on body A: F_x, F_y in N and the moment M_z in N mm.

    Examples
    --------
    >>> linear_creep_forces(1.0, 1.0, 80e3, 0.25, xi_x=-1e-4).Fx
    32.96
    """

    Fx: float
    Fy: float
    Mz: float


def creep_coefficients(a_over_b: float, poisson: float) -> CreepCoefficients:
    """Return Kalker's creep coefficients, interpolated from his table.

    Cubic splines of the logarithms over log(a/b), then the parabola through the three tabulated
    Poisson's ratios: exact at every entry of the table.

    Parameters
    ----------
    a_over_b : float
        Semi-axis in the rolling direction over the lateral one, 0.1 to 10.
    poisson : float
        Combined Poisson's ratio, 0 to 0.5.

    Raises
    ------
    ValueError
        If an argument lies outside the table.

    Examples
    --------
    >>> round(creep_coefficients(a_over_b=1.0, poisson=0.28).C11, 2)
    4.23
    """
    if not 0.1 <= a_over_b <= 10:
        raise ValueError(f"Kalker's table covers a/b from 0.1 to 10, not {a_over_b}")
    if not 0 <= poisson <= 0.5:
        raise ValueError(f"Kalker's table covers Poisson's ratios from 0 to 0.5, not {poisson}")
    columns = np.exp(_log_coefficients()(math.log(a_over_b)))
    # A parabola through the coefficients at the tabulated Poisson's ratios.
    weights = [
        math.prod((poisson - ratio) / (node - ratio) for ratio in POISSON_RATIOS if ratio != node)
        for node in POISSON_RATIOS
    ]
    return CreepCoefficients(*map(float, columns @ weights))


def linear_creep_forces(
    a: float,
    b: float,
    shear: float,
    poisson: float,
    *,
    xi_x: float = 0.0,
    xi_y: float = 0.0,
    spin: float = 0.0,
) -> CreepForces:
    """Return force (N) and moment (N mm) on body A by Kalker's linear theory, without sliding.

    Parameters
    ----------
    a, b : float
        Semi-axes of the contact in x and y, mm.
    shear, poisson : float
        Combined shear modulus G, MPa, and Poisson's ratio.
    xi_x, xi_y : float
        Longitudinal and lateral creepage.
    spin : float
        Spin creepage phi, 1/mm.

    Raises
    ------
    ValueError
        If a/b or the Poisson's ratio lies outside Kalker's table.

    Examples
    --------
    >>> forces = linear_creep_forces(1.0, 1.0, 80e3, 0.25, spin=1e-5)
    >>> round(forces.Fy, 3), round(forces.Mz, 3)
    (-1.176, -0.952)
    """
    C11, C22, C23, C33 = creep_coefficients(a / b, poisson)
    c = math.sqrt(a * b)
    return CreepForces(
        Fx=-shear * c**2 * C11 * xi_x,
        Fy=-shear * (c**2 * C22 * xi_y + c**3 * C23 * spin),
        Mz=-shear * (-(c**3) * C23 * xi_y + c**4 * C33 * spin),
    )


@functools.cache
def _log_coefficients() -> CubicSpline:
    """Spline of the logarithms of the creep coefficients, (4, 3), over log(a/b)."""
    ratios, *coefficients = zip(*CREEP_COEFFICIENTS, strict=True)
    return CubicSpline(np.log(ratios), np.log(np.moveaxis(np.array(coefficients), 0, 1)))


def fastsim(
    a: float,
    b: float,
    shear: float,
    poisson: float,
    *,
    load: float,
    mu: float,
    xi_x: float = 0.0,
    xi_y: float = 0.0,
    spin: float = 0.0,
    elements: tuple[int, int] = (50, 50),
) -> CreepForces:
    """Return the creep forces by FASTSIM, Kalker's theory with an independent spring per point.

    The flexibilities L_1 = 8 a / (3 G C11), L_2 = 8 a / (3 G C22) and
    L_3 = pi a sqrt(a/b) / (4 G C23) give the forces of the linear theory without slip. In every
    strip along x the traction increases from the leading edge by the rigid slip over the
    flexibility, and is limited to mu p, with the paraboloid p =
    2 P / (pi a b) (1 - x²/a² - y²/b²) of equal load. As the flexibilities differ, the direction of
    full slip is (xi_x / L_1, xi_y / L_2), which differs slightly from the direction of the bodies.

    Source: Kalker, A Fast Algorithm for the Simplified Theory of Rolling Contact, Vehicle System
    Dynamics 11 (1982) 1-13.

    Parameters
    ----------
    a, b : float
        Semi-axes of the contact in x and y, mm.
    shear, poisson : float
        Combined shear modulus G, MPa, and Poisson's ratio.
    load : float
        Normal load P, N.
    mu : float
        Friction coefficient.
    xi_x, xi_y : float
        Longitudinal and lateral creepage.
    spin : float
        Spin creepage phi, 1/mm.
    elements : tuple of int
        Number of elements along x, and of strips.

    Raises
    ------
    ValueError
        If a/b or the Poisson's ratio lies outside Kalker's table.

    Examples
    --------
    >>> contact = dict(a=1.0, b=1.0, shear=80e3, poisson=0.25, load=1e3, mu=0.3)
    >>> linear = linear_creep_forces(1.0, 1.0, 80e3, 0.25, xi_x=-1e-6).Fx
    >>> round(fastsim(**contact, xi_x=-1e-6).Fx / linear, 2)
    1.0
    >>> round(fastsim(**contact, xi_x=-1.0).Fx)
    300
    """
    C11, C22, C23, _ = creep_coefficients(a / b, poisson)
    L1, L2 = (8.0 * a / (3.0 * shear * coefficient) for coefficient in (C11, C22))
    L3 = math.pi * a * math.sqrt(a / b) / (4.0 * shear * C23)
    along, strips = elements
    y = b * ((2.0 * np.arange(strips) + 1.0) / strips - 1.0)
    half = a * np.sqrt(1.0 - (y / b) ** 2)
    step, area = 2.0 * half / along, 2.0 * half / along * (2.0 * b / strips)
    # So that the pressures at the centres of all elements carry the load.
    middles = half * ((2.0 * np.arange(along)[:, None] + 1.0) / along - 1.0)
    shape = 1.0 - (middles / a) ** 2 - (y / b) ** 2
    bound = mu * load * shape / (shape * area).sum()
    traction, Q, moment = np.zeros((2, strips)), np.zeros(2), 0.0
    for k in range(along - 1, -1, -1):
        x = middles[k]
        # From the face ahead to the centre of the first one, from centre to centre of others.
        dx = 0.5 * step if k == along - 1 else step
        at = x + 0.5 * dx
        rigid = np.stack([xi_x / L1 - spin * y / L3, xi_y / L2 + spin * at / L3])
        traction = traction - rigid * dx
        size = np.hypot(*traction)
        traction = traction * np.where(size > bound[k], bound[k] / np.maximum(size, 1e-300), 1.0)
        Q += (traction * area).sum(axis=1)
        moment += float(((x * traction[1] - y * traction[0]) * area).sum())
    return CreepForces(float(Q[0]), float(Q[1]), moment)


@dataclass(frozen=True, eq=False, repr=False)
class GlobalWear(ShortArrays):
    """Wear depth, half widths and pressure at revolutions 0 to n: global incremental wear model.

    Attributes
    ----------
    depth : ndarray, shape (n + 1,)
        Largest wear depth, mm.
    a, b : ndarray, shape (n + 1,)
        Half widths of the contact in x and y, mm.
    pressure : ndarray, shape (n + 1,)
        Mean pressure, MPa.

    Examples
    --------
    >>> course = giwm(300.0, 114e3, (32.5, 32.3), 125.0, (0.217, 0.827), -0.005, 2e-6, 100)
    >>> course.depth.shape, bool(course.b[-1] > course.b[0])
    ((101,), True)
    """

    depth: np.ndarray
    a: np.ndarray
    b: np.ndarray
    pressure: np.ndarray


def giwm(
    load: float,
    e_star: float,
    radii_x: tuple[float, float],
    radius_y: float,
    semi_axes: tuple[float, float],
    creepage: float,
    intensity: float,
    revolutions: int,
) -> GlobalWear:
    """Return the wear of twin discs by the global incremental wear model; only disc A wears.

    Juliá & Rodríguez-Tembleque (2025), Table 1, after Hegadekatte, Kurzenhäuser, Huber & Kraft,
    Tribol. Int. 41 (2008) 1020-1031. Disc A wears; its radius shrinks with the depth.

    Parameters
    ----------
    load : float
        P, N.
    e_star : float
        E*, MPa.
    radii_x : tuple of float
        Radii of discs A and B in the rolling direction, mm.
    radius_y : float
        Combined radius in the lateral direction, mm.
    semi_axes : tuple of float
        Half widths (a, b) of the unworn contact, mm.
    creepage : float
        xi_x.
    intensity : float
        Wear intensity, 1/MPa.
    revolutions : int
        Revolutions to compute.

    Raises
    ------
    ValueError
        If a size is not above zero, or the number of revolutions below zero.

    Examples
    --------
    >>> course = giwm(300.0, 114e3, (32.5, 32.3), 125.0, (0.217, 0.827), -0.005, 2e-6, 100)
    >>> float(course.depth[100].round(6))
    0.000123
    """
    sizes = (load, e_star, *radii_x, radius_y, *semi_axes, intensity)
    if not all(size > 0.0 for size in sizes) or revolutions < 0:
        raise ValueError("load, modulus, radii, half widths and intensity must be above 0")
    course = np.empty((4, revolutions + 1))
    radius, (a, b), depth = radii_x[0], semi_axes, 0.0
    pressure = load / (np.pi * a * b)
    pressed = load / (2.0 * e_star * np.sqrt(a * b))
    course[:, 0] = depth, a, b, pressure
    sliding = abs(creepage) / (1.0 + 0.5 * creepage)  # over the mean speed of the discs
    for revolution in range(1, revolutions + 1):
        total = depth + pressed
        worn = intensity * pressure * 2.0 * a * sliding
        depth += worn
        radius -= worn
        b = np.sqrt(2.0 * radius_y * total - total**2)
        radius_x = 1.0 / (1.0 / radius + 1.0 / radii_x[1])
        a = 0.25 * np.pi * np.sqrt(4.0 * load * radius_x / (2.0 * np.pi * b * e_star))
        pressure = 0.25 * np.pi * np.sqrt(load * e_star / (2.0 * np.pi * b * radius_x))
        pressed = load / (2.0 * e_star * np.sqrt(a * b))
        course[:, revolution] = depth, a, b, pressure
    return GlobalWear(*course)
