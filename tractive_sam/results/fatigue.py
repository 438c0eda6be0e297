"""What the cycles of stress do to one body, over its section (y, depth)."""

import math
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from tractive_sam.description import ShortArrays
from tractive_sam.mechanics import CycleCriterion
from tractive_sam.results.maximum import Maximum


def _none() -> np.ndarray:
    return np.zeros(0)


@dataclass(frozen=True, eq=False, repr=False)
class BodyFatigue(ShortArrays):
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
            depth, more = _tops(self.zeta, inside[j])
            value, at = value + float(more[k]), (math.nan, at[1], float(depth[k]))
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
        """The largest value below the surface by parabolas through all points, and its place.

        Not through the largest one alone: the best residual stress of a depth leaves two rows the
        same, so that rounding would choose between their parabolas.
        """
        below = values[:, 1:]
        y, gain_y = _tops(self.y, below)
        depth, gain_z = (found.T for found in _tops(self.depth[1:], below.T))
        total = below + gain_y + gain_z
        at = np.unravel_index(np.argmax(total), total.shape)
        return float(total[at]), (math.nan, float(y[at]), float(depth[at]))

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


def _tops(x: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Tops of the parabolas through each value and those before and after it.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Ascending places.
    values : ndarray, shape (n, ...)
        Values there.

    Returns
    -------
    place, gain : ndarray, shape (n, ...)
        Where each top is, and how much higher than the value. At an end, and where the top is
        farther away than the neighbours, the place itself and 0.
    """
    own = x.reshape(-1, *(1,) * (values.ndim - 1))
    place, gain = np.broadcast_to(own, values.shape).copy(), np.zeros(values.shape)
    left, right = own[1:-1] - own[:-2], own[2:] - own[1:-1]
    down, up = (values[1:-1] - values[:-2]) / left, (values[2:] - values[1:-1]) / right
    curvature = (down - up) / (0.5 * (left + right))
    slope = (down * right + up * left) / (left + right)
    step = np.divide(slope, curvature, out=np.full_like(slope, np.inf), where=curvature > 0.0)
    near = (-left <= step) & (step <= right)
    place[1:-1] += np.where(near, step, 0.0)
    gain[1:-1] = 0.5 * slope * np.where(near, step, 0.0)
    return place, gain
