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
"""

from dataclasses import dataclass

import numpy as np

MIRROR = np.array([1.0, -1.0, -1.0])
"""Signs of creepages and of forces when y is mirrored."""

REVERSED = np.array([-1.0, 1.0, 1.0])
"""The same when y is mirrored and all creepages are reversed."""

NAMES = ("heading", "tilt", "u")

SPIN = 0.5
"""Weight of scaled spin beside scaled creepages."""

LEAST, POLE = 1e-9, 1e-6
"""Least r over r_0 and least cosine of the tilt for slopes, which are limits there."""


def unit_radius(ratio: np.ndarray | float) -> np.ndarray | float:
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
    heading, tilt, u : ndarray, shape (P,)
        Of the creepages that are the given ones but for `signs`.
    signs : ndarray, shape (3, P)
        Of (w_1, w_2, w_3) and of (Q_x, Q_y, M_z).
    by_creepages : ndarray, shape (3, 3, P)
        Derivatives of (heading, tilt, u) by the given w; zero in full slip.
    """

    heading: np.ndarray
    tilt: np.ndarray
    u: np.ndarray
    signs: np.ndarray
    by_creepages: np.ndarray

    @classmethod
    def of(cls, w: np.ndarray, ratio: np.ndarray) -> "Coordinates":
        """The coordinates of scaled creepages, shape (3, P); one of each may be infinite.

        Raises
        ------
        ValueError
            If a creepage is no number, or several are infinite.
        """
        endless = np.isinf(w)
        if np.isnan(w).any():
            raise ValueError("creepages: numbers are needed, not nan")
        if (endless.sum(axis=0) > 1).any():
            raise ValueError("creepages: one of them may be infinite, several have no direction")
        full = endless.any(axis=0)
        w = np.where(full, np.where(endless, np.sign(w), 0.0), w)
        signs = np.where(w[2] < 0.0, MIRROR[:, None], 1.0)
        signs = signs * np.where(w[0] < 0.0, REVERSED[:, None], 1.0)
        x, y, kappa = signs * w * np.array([1.0, 1.0, SPIN])[:, None]
        r0 = unit_radius(ratio)
        # Of huge creepages the squares would overflow: hypot does not.
        t = np.hypot(x, y)
        r = np.hypot(t, kappa)
        u = np.where(full, 1.0, r / (r + r0))
        heading, tilt = np.arctan2(y, x), np.arctan2(kappa, t)
        t, rest = np.maximum(t, POLE * r), r <= LEAST * r0
        r, t = np.where(rest, LEAST * r0, r), np.where(rest, LEAST * r0, t)
        ch, sh = np.cos(heading), np.sin(heading)
        ct, st = np.cos(tilt), np.sin(tilt)
        none = np.zeros_like(r)
        stretch = np.where(full, 0.0, r0 / (r + r0) / (r + r0))
        by = np.array(
            [
                [-sh / t, ch / t, none],
                [-st * ch / r, -st * sh / r, SPIN * ct / r],
                [stretch * ct * ch, stretch * ct * sh, SPIN * stretch * st],
            ]
        )
        return cls(heading, tilt, u, signs, np.where(full, 0.0, by) * signs)
