"""What the cycles of stress do to one body, over its section (y, depth)."""

import math
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from tractive_sam.mechanics import CycleCriterion
from tractive_sam.results.maximum import Maximum


def _none() -> np.ndarray:
    return np.zeros(0)


@dataclass(frozen=True, eq=False)
class BodyFatigue:
    """A pass of the contact as the material of one body lives through it.

    Fields have the shape (n_y, n); the first depth is the surface. There they are of displacements
    between the elements, as the largest stress at the surface is; the next depth is one element.

    Attributes
    ----------
    body : str
        "A" or "B".
    y, depth : ndarray
        Lateral place, shape (n_y,), and depth below the present surface, shape (n,), mm.
    utilisation : ndarray
        Equivalent stress of the criterion over its limit, at least 0; nan without a limit.
    residual_shear : ndarray
        sqrt(J2) that is left of the cycle when rolling has left its best residual stress, rho_xx
        of every point and rho_yy of every depth, MPa (Melan).
    path_radius : ndarray
        sqrt(J2) that is left by the best constant deviator at all, MPa: no residual stress leaves
        less.
    criterion : CycleCriterion or None
        What the utilisation is by.
    shear_yield : float
        k, MPa; nan without.
    zeta : ndarray, shape (m,)
        Places of the material: depth below the *unworn* surface, mm; of a roll with a limit.
    damage : ndarray, shape (n_y, m)
        What it has suffered so far by Miner's rule: at 1 a crack starts. Material with zeta < worn
        is gone; its number is the last one it had.
    worn : ndarray, shape (n_y,)
        Depth worn off this body, mm.

    Examples
    --------
    >>> asked = {"shear_yield": 300.0, "sensitivity": 0.333, "limit": 250.0}
    >>> cycled = ts.fatigue(ts.solve(scene.replace(fatigue=asked)))["A"]
    >>> cycled.shakedown_lower <= cycled.shakedown_upper
    True
    """

    body: str
    y: np.ndarray
    depth: np.ndarray
    utilisation: np.ndarray
    residual_shear: np.ndarray
    path_radius: np.ndarray
    criterion: CycleCriterion | None
    shear_yield: float
    zeta: np.ndarray = field(default_factory=_none)
    damage: np.ndarray = field(default_factory=_none)
    worn: np.ndarray = field(default_factory=_none)

    def with_damage(self, zeta: np.ndarray, damage: np.ndarray, worn: np.ndarray) -> Self:
        """The same with what the material has suffered."""
        return replace(self, zeta=zeta, damage=damage, worn=worn)

    @property
    def damage_max(self) -> tuple[float, tuple[float, float, float]]:
        """The largest damage of what is left of the material, and where, (nan, y, zeta), mm.

        At the surface it is taken on to it from the two places below, as an exponential; inside it
        is refined by a parabola.
        """
        if not self.damage.size:
            return math.nan, (math.nan,) * 3
        left = self.zeta >= self.worn[:, None]
        inside = np.where(left, self.damage, 0.0)
        if not inside.any():
            return 0.0, (math.nan,) * 3
        j, k = np.unravel_index(np.argmax(inside), inside.shape)
        value, at = float(inside[j, k]), (math.nan, float(self.y[j]), float(self.zeta[k]))
        if k and left[j, k - 1]:
            depth, more = _top(self.zeta, inside[j], int(k))
            value, at = value + more, (math.nan, at[1], depth)
        first = np.minimum(np.argmax(left, axis=1), self.zeta.size - 2)
        row = np.arange(self.y.size)
        here, below = self.damage[row, first], self.damage[row, first + 1]
        step = (self.worn - self.zeta[first]) / (self.zeta[first + 1] - self.zeta[first])
        log = np.log(np.maximum((here, below), 1e-300))
        reached = left.any(axis=1) & (here > 0.0)
        surface = np.where(reached, np.exp(log[0] + step * (log[1] - log[0])), 0.0)
        j = int(np.argmax(surface))
        if surface[j] > value:
            return float(surface[j]), (math.nan, float(self.y[j]), float(self.worn[j]))
        return value, at

    def largest(self, name: str = "utilisation") -> Maximum:
        """The largest value of a field by its name; places are (nan, y, depth), mm.

        Below the surface it is refined by parabolas through the points around it.
        """
        values = getattr(self, name)
        if np.isnan(values).all():
            nowhere = (math.nan,) * 3
            return Maximum(self.criterion, *(math.nan, nowhere) * 3)
        row = int(np.argmax(values[:, 0]))
        surface, surface_at = float(values[row, 0]), (math.nan, float(self.y[row]), 0.0)
        interior, interior_at = self._interior(values)
        higher = interior > surface
        value, at = (interior, interior_at) if higher else (surface, surface_at)
        return Maximum(self.criterion, value, at, interior, interior_at, surface, surface_at)

    def _interior(self, values: np.ndarray) -> tuple[float, tuple[float, float, float]]:
        below = values[:, 1:]
        j, k = np.unravel_index(np.argmax(below), below.shape)
        value = float(below[j, k])
        y, gain_y = _top(self.y, below[:, k], j)
        depth, gain_z = _top(self.depth[1:], below[j], k)
        return value + gain_y + gain_z, (math.nan, y, depth)

    @property
    def utilisation_max(self) -> float:
        """Largest utilisation, inside or at the surface."""
        return self.largest().value

    @property
    def shakedown_lower(self) -> float:
        """Load factor up to which elastic shakedown is certain; nan without a yield stress."""
        return self.load_factor(self.largest("residual_shear").value)

    @property
    def shakedown_upper(self) -> float:
        """Load factor from which elastic shakedown is impossible; nan without a yield stress."""
        return self.load_factor(self.largest("path_radius").value)

    def load_factor(self, shear: float) -> float:
        """The factor on the load at which a shear stress reaches k; inf where it is none."""
        return math.inf if shear == 0.0 else self.shear_yield / shear


def _top(x: np.ndarray, values: np.ndarray, k: int) -> tuple[float, float]:
    """Where the parabola through the largest of values and those beside it has its top.

    And how much higher it is there; the largest itself at an end.
    """
    if not 0 < k < x.size - 1:
        return float(x[k]), 0.0
    left, right = x[k] - x[k - 1], x[k + 1] - x[k]
    down, up = (values[k] - values[k - 1]) / left, (values[k + 1] - values[k]) / right
    curvature = (down - up) / (0.5 * (left + right))
    slope = (down * right + up * left) / (left + right)
    if curvature <= 0.0:
        return float(x[k]), 0.0
    step = slope / curvature
    return float(x[k] + step), float(0.5 * slope * step)
