"""Bounded coordinates of creepages, and the symmetries that reduce their range to a quarter.

With c = sqrt(a b) the forces over mu P of a Hertz contact of equal materials depend only on a/b,
Poisson's ratio and the scaled creepages

    w = G c² / (mu P) (xi_x, xi_y, c phi).

With kappa = w_3/2 the coordinates are

    r       = sqrt(w_1² + w_2² + kappa²)
    u       = r / (r + r_0),  r_0 = 2 / (3.2 + 0.9 a/b)     0 at rest, 1 in full slip: r infinite
    heading = atan2(w_2, w_1)                               -pi/2 to pi/2, as w_1 >= 0
    tilt    = atan2(kappa, sqrt(w_1² + w_2²))               0 to pi/2, as w_3 >= 0

3.2 + 0.9 a/b is near Kalker's C11: full slip begins at u of about 0.6 for any a/b. Mirrored at the
plane y = 0, (w_1, -w_2, -w_3) gives (Q_x, -Q_y, -M_z). Reversed creepages reverse all forces, and
(-w_1, w_2, w_3) gives (-Q_x, Q_y, M_z).

The table of a contact without a symmetry is a full one, with headings from -pi to pi and tilts from
-pi/2 to pi/2. Dissimilar bodies have no symmetry for reversed creepages, oblique axes of friction
or a gap have none for the mirror image.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

MIRROR = np.array([1.0, -1.0, -1.0])
"""Signs of creepages and of forces if y is mirrored."""

REVERSED = np.array([-1.0, 1.0, 1.0])
"""Signs if y is mirrored and all creepages are reversed."""

NAMES = ("heading", "tilt", "u")

RATIO = "log_ratio"
"""Name of the axis ln(a/b), in tables of any Hertz contact."""

CONTACT = ("a", "b", "load", "mu", "shear")
"""Properties of a contact that scale its forces."""

SPIN = 0.5
"""Weight of scaled spin relative to scaled creepages."""

MIN_RADIUS, POLE = 1e-9, 1e-6
"""Smallest r over r_0 and smallest cosine of the tilt at which slopes are evaluated."""


def unit_radius(ratio: Any) -> Any:
    """Return r_0, the length of scaled creepages at u = 1/2, for the ratio a/b of the semi-axes."""
    return 2.0 / (3.2 + 0.9 * ratio)


def creepages_at(ratio: float, heading: float, tilt: float, u: float) -> np.ndarray:
    """Return the scaled creepages w at given coordinates; for u = 1 only their direction."""
    r = 1.0 if u == 1.0 else unit_radius(ratio) * u / (1.0 - u)
    t = r * np.cos(tilt)
    return np.array([t * np.cos(heading), t * np.sin(heading), r * np.sin(tilt) / SPIN])


def creepages_by_coordinates(ratio: float, heading: float, tilt: float, u: float) -> np.ndarray:
    """Return the derivatives of the scaled creepages w (rows) by heading, tilt and u (columns).

    For the ratio a/b of the semi-axes and u < 1; shape (3, 3). The module defines the coordinates.
    """
    r0 = unit_radius(ratio)
    r, stretch = r0 * u / (1.0 - u), r0 / (1.0 - u) ** 2
    ch, sh, ct, st = np.cos(heading), np.sin(heading), np.cos(tilt), np.sin(tilt)
    return np.array(
        [
            [-r * ct * sh, -r * st * ch, stretch * ct * ch],
            [r * ct * ch, -r * st * sh, stretch * ct * sh],
            [0.0, r * ct / SPIN, stretch * st / SPIN],
        ]
    )


@dataclass(frozen=True, eq=False)
class Coordinates:
    """Scaled creepages times the signs that bring them into a table, with (heading, tilt, u).

    Attributes
    ----------
    w : ndarray, shape (3, P)
        Scaled creepages times `signs`; for full slip their direction.
    signs : ndarray, shape (3, P)
        Signs of (w_1, w_2, w_3) and of (Q_x, Q_y, M_z).
    r0 : ndarray, shape (P,)
        `unit_radius`.
    full : ndarray of bool, shape (P,)
        Whether a creepage is infinite.
    """

    w: np.ndarray
    signs: np.ndarray
    r0: np.ndarray
    full: np.ndarray

    @classmethod
    def of(cls, w: np.ndarray, ratio: np.ndarray, full_range: bool = False) -> "Coordinates":
        """Return the coordinates of scaled creepages (3, P); one of the three may be infinite.

        Parameters
        ----------
        w : ndarray, shape (3, P)
            Scaled creepages.
        ratio : ndarray, shape (P,)
            a/b.
        full_range : bool
            Whether the table has all headings and tilts, without symmetries.

        Raises
        ------
        ValueError
            If a creepage is nan, or several are infinite.
        """
        full = np.zeros(w.shape[1], bool)
        if not np.isfinite(w).all():
            w, full = _directions(w)
        signs = np.ones_like(w)
        if not full_range:
            signs = np.where(w[2] < 0.0, MIRROR[:, None], signs)
            signs = np.where(w[0] < 0.0, REVERSED[:, None] * signs, signs)
        # + 0 removes -0, for which atan2 would give a heading of pi.
        return cls(signs * w + 0.0, signs, unit_radius(ratio), full)

    @cached_property
    def _polar(self) -> tuple[np.ndarray, ...]:
        """(w_1, w_2), kappa, the size of (w_1, w_2), and r."""
        x, y, kappa = self.w[0], self.w[1], SPIN * self.w[2]
        # Squares of huge creepages would overflow: hypot does not.
        t = np.hypot(x, y)
        return x, y, kappa, t, np.hypot(t, kappa)

    @cached_property
    def points(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Heading, tilt and u, each of shape (P,)."""
        x, y, kappa, t, r = self._polar
        u = np.where(self.full, 1.0, r / (r + self.r0))
        return np.arctan2(y, x), np.arctan2(kappa, t), u

    @property
    def points_of_slopes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Heading, tilt and u, shifted from rest and pure spin, at which slopes are undefined."""
        heading, tilt, u = self.points
        limit = 0.5 * np.pi - POLE
        return heading, np.minimum(np.maximum(tilt, -limit), limit), np.maximum(u, MIN_RADIUS)

    @property
    def by_creepages(self) -> np.ndarray:
        """Derivatives of (heading, tilt, u) by the given w, shape (3, 3, P); zero in full slip."""
        (heading, tilt, _), r0 = self.points, self.r0
        *_, t, r = self._polar
        t, rest = np.maximum(t, POLE * r), r <= MIN_RADIUS * r0
        r, t = np.where(rest, MIN_RADIUS * r0, r), np.where(rest, MIN_RADIUS * r0, t)
        ch, sh = np.cos(heading), np.sin(heading)
        ct, st = np.cos(tilt), np.sin(tilt)
        none = np.zeros_like(r)
        stretch = r0 / (r + r0) / (r + r0)
        by = np.array(
            [
                [-sh / t, ch / t, none],
                [-st * ch / r, -st * sh / r, SPIN * ct / r],
                [stretch * ct * ch, stretch * ct * sh, SPIN * stretch * st],
            ]
        )
        return np.where(self.full, 0.0, by) * self.signs


def _directions(w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return creepages with infinite ones replaced by their direction, and their places."""
    if np.isnan(w).any():
        raise ValueError("creepages: nan; allowed: numbers")
    is_infinite = np.isinf(w)
    if (is_infinite.sum(axis=0) > 1).any():
        raise ValueError("creepages: several are infinite; allowed: at most one")
    full = is_infinite.any(axis=0)
    return np.where(full, np.where(is_infinite, np.sign(w), 0.0), w), full
