"""Closed forms of rolling: Carter, Bentall and Johnson, creep forces, full slip with spin.

The creep-force curves are functions of the creep parameter of eq. (40) and give Q / (mu P). They
are continued as odd functions to negative parameters. Source of the numbering: Juliá & Rodríguez-
Tembleque, Int. J. Mech. Sci. 294 (2025) 110195.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

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
