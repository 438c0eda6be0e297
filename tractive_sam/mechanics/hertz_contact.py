"""Contact of radii: its patch, the Hertz contact of an ellipse, and of two parallel cylinders."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray


class ContactPatch(ABC):
    """Base class of contact patches: geometry and motion of the undeformed bodies.

    The defaults are those of a patch in the tangent plane. Positions x and y are broadcast.
    """

    is_flat: ClassVar[bool] = True
    """Whether the normal is the same everywhere, and bodies without creepage roll without slip."""

    @abstractmethod
    def gap(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the separation of the undeformed bodies along the normal, mm."""

    def normal(self, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the lateral and normal component of the normal into A, in the frame of the middle.

        Returns
        -------
        lateral, normal : ndarray
            Of the shape of x + y.
        """
        zero = 0.0 * (x + y)
        return zero, zero + 1.0

    def slip(
        self, x: np.ndarray, y: np.ndarray, longitudinal: float, lateral: float, spin: float
    ) -> np.ndarray:
        """Return the slip s/V by creepages, without `rolling_slip`, shape (2, n_x, n_y).

        Parameters
        ----------
        x, y : ndarray
            Positions, mm.
        longitudinal, lateral, spin : float
            Creepages at the middle of the patch; spin in 1/mm.
        """
        return np.stack(np.broadcast_arrays(longitudinal - spin * y, lateral + spin * x))

    def rolling_slip(self, x: np.ndarray, y: np.ndarray) -> np.ndarray | float:
        """Return the slip s/V of bodies that roll without creepage, (2, n_x, n_y) or 0."""
        return 0.0

    def force(
        self, x: np.ndarray, y: np.ndarray, pressure: np.ndarray, traction: np.ndarray
    ) -> tuple[float, float]:
        """Return the sums of lateral and normal components of pressure and traction on A."""
        (lateral, normal), across = self.normal(x, y), traction[1]
        return (
            float((pressure * lateral + across * normal).sum()),
            float((pressure * normal - across * lateral).sum()),
        )


@dataclass(frozen=True)
class FlatPatch(ContactPatch):
    """ContactPatch of bodies with combined radii R_x and R_y, mm, in their tangent plane.

    Examples
    --------
    >>> FlatPatch(10.0, math.inf).gap(np.ones(1), np.ones(1))
    array([0.05])
    """

    radius_x: float
    radius_y: float

    def gap(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the separation of paraboloids with these radii, mm."""
        return np.asarray(0.5 * (x**2 / self.radius_x + y**2 / self.radius_y))


@dataclass(frozen=True)
class HertzContact:
    """Result of a frictionless Hertz contact of two smooth, non-conforming bodies.

    Parameters
    ----------
    a, b : float
        Semi-axes of the contact ellipse in x and in y, mm; a may be the shorter one.
    p0 : float
        Peak contact pressure, MPa.
    approach : float
        Approach of distant points of the two bodies, mm.
    load : float
        Normal load P, N.

    Examples
    --------
    >>> ball = hertz(e_star=114e3, radius_x=10.0, radius_y=10.0, load=50.0)
    >>> round(ball.mean_pressure / ball.p0, 4)
    0.6667
    """

    a: float
    b: float
    p0: float
    approach: float
    load: float

    @property
    def mean_semi_axis(self) -> float:
        """Geometric mean of the semi-axes, sqrt(a b), mm."""
        return math.sqrt(self.a * self.b)

    @property
    def area(self) -> float:
        """Contact area pi a b, mm²."""
        return math.pi * self.a * self.b

    @property
    def mean_pressure(self) -> float:
        """Load over contact area, MPa; two thirds of p0."""
        return self.load / self.area

    def describe(self) -> str:
        """Return a line of text: the semi-axes, the largest pressure and the approach."""
        return (
            f"a = {self.a:.5g} mm, b = {self.b:.5g} mm, p0 = {self.p0:.6g} MPa, approach = "
            f"{self.approach:.4g} mm"
        )

    def pressure(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Return the contact pressure at (x, y) in mm, MPa; zero outside; x and y broadcast."""
        distance2 = np.square(np.divide(x, self.a)) + np.square(np.divide(y, self.b))
        return self.p0 * np.sqrt(np.maximum(0.0, 1.0 - distance2))


def combined_radius(radius_A: float, radius_B: float) -> float:
    """Return R with 1/R = 1/R_A + 1/R_B, mm; radii are negative if concave, inf if flat.

    The separation of the bodies is then x²/(2 R_x) + y²/(2 R_y).

    Examples
    --------
    >>> combined_radius(32.5, float("inf"))
    32.5
    """
    curvature = 1 / radius_A + 1 / radius_B
    return 1 / curvature if curvature else math.inf


def hertz(
    e_star: float,
    radius_x: float,
    radius_y: float,
    *,
    load: float | None = None,
    approach: float | None = None,
    pressure: float | None = None,
) -> HertzContact:
    """Solve the elliptic Hertz contact for a given load, approach or peak pressure.

    An ellipse of semi-axes a, b under p0 sqrt(1 - x²/a² - y²/b²) is displaced by
    delta - x²/(2 R_x) - y²/(2 R_y) with

        delta     = p0 a b R_F(0, a², b²) / E*
        1/(2 R_x) = p0 a b R_D(0, b², a²) / (3 E*)
        1/(2 R_y) = p0 a b R_D(0, a², b²) / (3 E*)

    Source: Johnson, Contact Mechanics (1985), sections 3.5 and 4.2. His complete elliptic
    integrals are written in Carlson's symmetric forms (DLMF 19.16.1 and 19.16.5), which need no
    case for the longer axis and lose no digits near the circle or the line.

    Parameters
    ----------
    e_star : float
        Plane strain modulus E*, MPa.
    radius_x, radius_y : float
        Combined radii of curvature in x and in y, mm; positive and finite.
    load : float, optional
        Normal load P, N. Give one of this and the next two.
    approach : float, optional
        Approach of the bodies, mm.
    pressure : float, optional
        Peak pressure p0, MPa.

    Raises
    ------
    ValueError
        If an argument is not positive and finite, or unless exactly one of `load`, `approach` and
        `pressure` is given.

    Examples
    --------
    >>> contact = hertz(e_star=114285.7, radius_x=16.2, radius_y=32.5, load=300.0)
    >>> round(contact.a, 4), round(contact.b, 4), round(contact.p0, 1)
    (0.2807, 0.446, 1144.4)
    """
    if (load, approach, pressure).count(None) != 2:
        raise ValueError("give exactly one of load, approach and pressure")
    _require_positive(e_star=e_star, radius_x=radius_x, radius_y=radius_y)
    ratio = _axis_ratio(radius_x, radius_y)
    # Everything below for a similar ellipse with a b = 1; it scales with c = sqrt(a b).
    (depth, across), (_, along) = (
        _carlson(ratio, 1 / ratio),
        _carlson(1 / ratio, ratio),
    )
    bend = (along + across) / 3
    curvature = (1 / radius_x + 1 / radius_y) / 2
    if pressure is not None:
        _require_positive(pressure=pressure)
        c, p0 = pressure * bend / (e_star * curvature), pressure
        load, approach = 2 * math.pi * c * c * p0 / 3, p0 * c * depth / e_star
    elif load is not None:
        _require_positive(load=load)
        c = math.cbrt(3 * load * bend / (2 * math.pi * e_star * curvature))
        p0 = 3 * load / (2 * math.pi * c * c)
        approach = p0 * c * depth / e_star
    else:
        assert approach is not None  # as one of the three is given
        _require_positive(approach=approach)
        c = math.sqrt(approach * bend / (curvature * depth))
        p0 = approach * e_star / (c * depth)
        load = 2 * math.pi * c * c * p0 / 3
    stretch = math.sqrt(ratio)
    return HertzContact(*map(float, (c * stretch, c / stretch, p0, approach, load)))


def _axis_ratio(radius_x: float, radius_y: float) -> float:
    """Return the ratio a/b of the semi-axes of the contact ellipse of two combined radii."""
    root_tolerance = 4 * np.finfo(float).eps
    target = math.log(radius_x / radius_y)

    def excess(log_ratio: float) -> float:
        ratio = math.exp(log_ratio)
        (_, in_x), (_, in_y) = (
            _carlson(1 / ratio, ratio),
            _carlson(ratio, 1 / ratio),
        )
        return math.log(in_x / in_y) + target

    # By secants, as it is nearly a straight line: near a circle a/b is the 2/3 power of R_x/R_y,
    # near a line the 1/2.
    before, missed = 0.0, target
    at = 2.0 / 3.0 * target
    while abs(at - before) > root_tolerance * abs(at):
        here = excess(at)
        if here in (0.0, missed):
            break
        before, missed, at = at, here, at - here * (at - before) / (here - missed)
    return math.exp(at)


def _carlson(y: float, z: float) -> tuple[float, float]:
    """Return Carlson's integrals R_F(0, y, z) and R_D(0, y, z).

    R_F(0, y, z) = pi/(2 M), M the arithmetic-geometric mean of the roots of y and z (DLMF 19.22.1),
    and R_D = -6 dR_F/dz (DLMF 19.18.1): M is differentiated along with its iteration.
    """
    a, b = math.sqrt(y), math.sqrt(z)
    a_z, b_z = 0.0, 0.5 / b
    # What is missed is squared in each step, to 1e-16 after the last one.
    while abs(a - b) > 1e-8 * a or abs(a_z - b_z) > 1e-8 * b_z:
        root = math.sqrt(a * b)
        a, b, a_z, b_z = 0.5 * (a + b), root, 0.5 * (a_z + b_z), 0.5 * (a_z * b + a * b_z) / root
    mean, mean_z = 0.5 * (a + b), 0.5 * (a_z + b_z)
    return 0.5 * math.pi / mean, 3.0 * math.pi * mean_z / mean**2


def _require_positive(**values: float) -> None:
    """Raise a ValueError unless all values are positive and finite; keywords give their names."""
    for name, value in values.items():
        if not 0 < value < math.inf:
            raise ValueError(f"{name} must be positive and finite, not {value}")


@dataclass(frozen=True)
class HertzLine:
    """Frictionless contact of two cylinders with parallel axes, per unit length.

    Parameters
    ----------
    a : float
        Half-width of the contact in x, mm.
    p0 : float
        Largest pressure, MPa.
    radius : float
        Combined radius R, 1/R = 1/R_A + 1/R_B, mm.
    load_per_length : float
        Normal load per unit length, N/mm.

    Examples
    --------
    >>> line = hertz_line(e_star=114e3, radius=25.0, load_per_length=500.0)
    >>> line.pressure([0.0, line.a]) / line.p0
    array([1., 0.])
    """

    a: float
    p0: float
    radius: float
    load_per_length: float

    @property
    def load(self) -> float:
        """Load per length, N/mm, under the name that `HertzContact` has for its load."""
        return self.load_per_length

    @property
    def b(self) -> float:
        """Half-width of the contact in y: inf, as a line contact is infinitely long."""
        return math.inf

    @property
    def mean_semi_axis(self) -> float:
        """Half-width a, mm, the only finite one."""
        return self.a

    @property
    def approach(self) -> float:
        """Approach of the bodies relative to surface points one combined radius R away, mm.

        a²/(2 R) (ln(2 R / a) + 1/2). Relative to distant points it would be infinite: Johnson,
        section 2.2 and (4.57).
        """
        return self.a**2 / (2 * self.radius) * (math.log(2 * self.radius / self.a) + 0.5)

    def describe(self) -> str:
        """Return a line of text: size, pressure, approach, and what plane strain means."""
        return (
            f"a = {self.a:.5g} mm, p0 = {self.p0:.6g} MPa, approach = {self.approach:.4g} mm "
            "relative to the surface one R_x away; plane strain: both bodies are straight and "
            "infinitely long in y (radius_y = inf), so nothing changes along it, and forces are "
            "per length, N/mm"
        )

    def pressure(self, x: ArrayLike) -> NDArray[np.float64]:
        """Return the contact pressure at positions x, MPa; zero outside the contact."""
        return self.p0 * np.sqrt(np.maximum(0.0, 1.0 - np.square(np.divide(x, self.a))))


def hertz_line(
    e_star: float,
    radius: float,
    load_per_length: float | None = None,
    *,
    pressure: float | None = None,
) -> HertzLine:
    """Solve the Hertz contact of parallel cylinders: a² = 4 P' R / (pi E*), p0 = E* a / (2 R).

    Source: Johnson, Contact Mechanics (1985), section 4.2(c).

    Parameters
    ----------
    e_star : float
        Plane strain modulus E*, MPa.
    radius : float
        Combined radius R, mm.
    load_per_length : float, optional
        Normal load per unit length P', N/mm. Give this or `pressure`.
    pressure : float, optional
        Peak pressure p0, MPa.

    Raises
    ------
    ValueError
        If an argument is not positive and finite, or unless exactly one of the last two is given.

    Examples
    --------
    >>> round(hertz_line(e_star=114e3, radius=25.0, load_per_length=500.0).p0)
    852
    """
    if (load_per_length is None) == (pressure is None):
        raise ValueError("give exactly one of load_per_length and pressure")
    prescribed = [value for value in (load_per_length, pressure) if value is not None]
    for value in (e_star, radius, *prescribed):
        if not 0 < value < math.inf:
            what = "modulus, radius and load or pressure"
            raise ValueError(f"{what} must be positive and finite, not {value}")
    if pressure is not None:
        a = 2 * radius * pressure / e_star
        return HertzLine(a, pressure, radius, 0.5 * math.pi * a * pressure)
    (load,) = prescribed
    a = math.sqrt(4 * load * radius / (math.pi * e_star))
    return HertzLine(a, e_star * a / (2 * radius), radius, load)
