"""Bounded coordinates of creepages, and the symmetries that halve them twice.

With c = sqrt(a b) the forces of a Hertzian contact of alike bodies, over mu P, depend on a/b,
Poisson's ratio and the scaled creepages

    w = G c² / (mu P) (xi_x, xi_y, c phi)

alone. Of these, with kappa = w_3/2,

    r       = sqrt(w_1² + w_2² + kappa²)
    u       = r / (r + r_0),  r_0 = 2 / (3.2 + 0.9 a/b)     0 at rest, 1 in full slip: r infinite
    heading = atan2(w_2, w_1)                               -pi/2 to pi/2, as w_1 >= 0
    tilt    = atan2(kappa, sqrt(w_1² + w_2²))               0 to pi/2, as w_3 >= 0

are the coordinates. 3.2 + 0.9 a/b is near Kalker's C11, so that friction is used up at u of about
0.6 whatever a/b. Mirrored at the plane y = 0, (w_1, -w_2, -w_3) gives (Q_x, -Q_y, -M_z); with all
creepages reversed, all forces are, so that (-w_1, w_2, w_3) gives (-Q_x, Q_y, M_z).

Where a contact lacks a symmetry, its table is a whole one, over headings from -pi to pi and tilts
from -pi/2 to pi/2: dissimilar bodies are not alike when reversed; oblique axes of friction, or a
gap, when mirrored.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

MIRROR = np.array([1.0, -1.0, -1.0])
"""Signs of creepages and of forces when y is mirrored."""

REVERSED = np.array([-1.0, 1.0, 1.0])
"""The same when y is mirrored and all creepages are reversed."""

NAMES = ("heading", "tilt", "u")

RATIO = "log_ratio"
"""Name of the axis ln(a/b), of tables of any contact of Hertz."""

CONTACT = ("a", "b", "load", "mu", "shear")
"""What scales the forces of a contact."""

SPIN = 0.5
"""Weight of scaled spin beside scaled creepages."""

LEAST, POLE = 1e-9, 1e-6
"""Least r over r_0 and least cosine of the tilt for slopes, which are limits there."""


def unit_radius(ratio):
    """r_0 of a/b."""
    return 2.0 / (3.2 + 0.9 * ratio)


def creepages_at(ratio: float, heading: float, tilt: float, u: float) -> np.ndarray:
    """Scaled creepages w of coordinates; of u = 1 their direction."""
    r = 1.0 if u == 1.0 else unit_radius(ratio) * u / (1.0 - u)
    t = r * np.cos(tilt)
    return np.array([t * np.cos(heading), t * np.sin(heading), r * np.sin(tilt) / SPIN])


def by_coordinates(ratio: float, heading: float, tilt: float, u: float) -> np.ndarray:
    """Derivatives of w by heading, tilt and u, shape (3 creepages, 3 coordinates), for u < 1."""
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
    """Where scaled creepages are in a table.

    Attributes
    ----------
    w : ndarray, shape (3, P)
        Scaled creepages that are the given ones but for `signs`; of full slip their direction.
    signs : ndarray, shape (3, P)
        Of (w_1, w_2, w_3) and of (Q_x, Q_y, M_z).
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
    def of(cls, w: np.ndarray, ratio: np.ndarray, whole: bool = False) -> "Coordinates":
        """The coordinates of scaled creepages, shape (3, P); one of each may be infinite.

        Parameters
        ----------
        w : ndarray, shape (3, P)
            Scaled creepages.
        ratio : ndarray, shape (P,)
            a/b.
        whole : bool
            Whether the table has all headings and tilts, for want of symmetries.

        Raises
        ------
        ValueError
            If a creepage is no number, or several are infinite.
        """
        full = np.zeros(w.shape[1], bool)
        if not np.isfinite(w).all():
            w, full = _directions(w)
        signs = np.ones_like(w)
        if not whole:
            signs = np.where(w[2] < 0.0, MIRROR[:, None], signs)
            signs = np.where(w[0] < 0.0, REVERSED[:, None] * signs, signs)
        # Of -0, which + 0 takes away, atan2 would make a heading of pi.
        return cls(signs * w + 0.0, signs, unit_radius(ratio), full)

    @cached_property
    def _polar(self) -> tuple[np.ndarray, ...]:
        """(w_1, w_2), kappa, and the sizes of both without and with kappa."""
        x, y, kappa = self.w[0], self.w[1], SPIN * self.w[2]
        # Of huge creepages the squares would overflow: hypot does not.
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
        """The same, so far from rest and from spin alone that slopes by heading and tilt count."""
        heading, tilt, u = self.points
        most = 0.5 * np.pi - POLE
        return heading, np.minimum(np.maximum(tilt, -most), most), np.maximum(u, LEAST)

    @property
    def by_creepages(self) -> np.ndarray:
        """Derivatives of (heading, tilt, u) by the given w, shape (3, 3, P); zero in full slip."""
        (heading, tilt, _), r0 = self.points, self.r0
        *_, t, r = self._polar
        t, rest = np.maximum(t, POLE * r), r <= LEAST * r0
        r, t = np.where(rest, LEAST * r0, r), np.where(rest, LEAST * r0, t)
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
    """Creepages of which infinite ones are replaced by their direction, and where they are."""
    if np.isnan(w).any():
        raise ValueError("creepages: numbers are needed, not nan")
    endless = np.isinf(w)
    if (endless.sum(axis=0) > 1).any():
        raise ValueError("creepages: one of them may be infinite, several have no direction")
    full = endless.any(axis=0)
    return np.where(full, np.where(endless, np.sign(w), 0.0), w), full
