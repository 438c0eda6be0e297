"""Hertz contact of two parallel cylinders."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


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
