"""Carter's tractive rolling of two equal-material cylinders."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tractive_sam.mechanics import HertzLine


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
