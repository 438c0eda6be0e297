"""Wear laws that were measured: regimes by frictional work, by sliding speed and pressure.

The coefficients are in `mechanics.wear_sets`; what is converted is converted here, in `PER_MASS`
and `PER_SECTION`.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from tractive_sam.kernels import wear
from tractive_sam.mechanics.friction import FrictionLaw
from tractive_sam.mechanics.wear import ArchardByWork, WearConditions, WearLaw, work_of
from tractive_sam.mechanics.wear_sets import JENDEL_BORDERS, JENDEL_LIMIT, Regimes

PER_MASS = 1e-3
"""Depth per distance rolled of 1 µg/(m mm²) of a body of 1 kg/m³: 1e-9 kg/(1e3 mm mm²) over
1e-9 kg/mm³."""

PER_SECTION = np.pi * 1e-6
"""Cross section worn in a turn of a wheel of diameter D, mm², of 1/D mm²/km: pi D are 1e-6 km."""


@dataclass(frozen=True)
class ByWork(WearLaw):
    """Mass worn per distance rolled and area by the frictional work over the area, T-gamma/A.

    Parameters
    ----------
    regimes : Regimes
        µg/(m mm²) over N/mm².
    density : float
        Of the body that wears, kg/m³.
    total : bool
        Whether T-gamma/A is that of the whole contact, the wear of which is then shared out by the
        work of each element; else each element wears by its own.
    """

    regimes: Regimes
    density: float
    total: bool = False

    def rate(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """See `WearLaw.rate`."""
        work = work_of(traction, slip)
        per_mass = PER_MASS / self.density
        if not self.total:
            return per_mass * self.regimes(work)[0]
        mean = _mean(work, pressure)
        return per_mass * self.regimes.at(mean) / mean * work if mean else work

    def per_load(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """See `WearLaw.per_load`; at a constant load T-gamma of the whole hardly changes."""
        touching = pressure > 0.0
        each = np.where(touching, pressure, 1.0)
        if self.total:
            return np.where(touching, self.rate(pressure, traction, slip) / each, 0.0)
        work = work_of(traction, slip)
        slope = PER_MASS / self.density * self.regimes(work)[1]
        return np.where(touching, slope * work / each, 0.0)

    def beyond_tests(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> str:
        """See `WearLaw.beyond_tests`."""
        work = work_of(traction, slip)
        most = _mean(work, pressure) if self.total else float(work.max())
        if most <= self.regimes.tested:
            return ""
        return f"T-gamma/A = {most:.3g} N/mm², tests went to {self.regimes.tested:g}"


@dataclass(frozen=True)
class ByTotal(WearLaw):
    """Cross section worn off a wheel in a turn by T-gamma of the contact.

    Shared out by the work of each element; wants to know how large one is (`WearLaw.on`).

    Parameters
    ----------
    regimes : Regimes
        mm²/km times the diameter in mm, over N.
    element_area : float
        mm².
    """

    regimes: Regimes
    element_area: float = np.nan

    def on(self, element_area: float) -> "ByTotal":
        """See `WearLaw.on`."""
        return replace(self, element_area=element_area)

    def rate(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """See `WearLaw.rate`."""
        work = work_of(traction, slip)
        total = float(work.sum()) * self.element_area
        return PER_SECTION * self.regimes.at(total) / total * work if total else work

    def per_load(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """See `WearLaw.per_load`; at a constant load T-gamma of the whole hardly changes."""
        rate = self.rate(pressure, traction, slip)
        return np.divide(rate, pressure, out=np.zeros_like(rate), where=pressure > 0.0)


@dataclass(frozen=True)
class ByChart(WearLaw):
    """Archard's law with a coefficient that depends on sliding speed and pressure.

    Where an element sticks beside one that slips it carries less than the bound, and wears in that
    proportion, as in `ArchardByWork`.

    Parameters
    ----------
    coefficients : tuple of float
        k of the four regimes, as `JENDEL`.
    hardness : float
        Of the body that wears, MPa.
    speed : float
        Rolling speed, mm/s.
    mu, angle : tuple of float and float
        As of `ArchardByWork`.
    """

    coefficients: tuple[float, float, float, float]
    hardness: float
    speed: float
    mu: tuple[float, float] = (1.0, 1.0)
    angle: float = 0.0

    def rate(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """See `WearLaw.rate`."""
        unit = ArchardByWork((1.0 / self.hardness,) * 2, self.mu, self.angle)
        sliding = self.speed * np.hypot(*slip)
        k = wear.chart(
            sliding, pressure / self.hardness, JENDEL_BORDERS, JENDEL_LIMIT, self.coefficients
        )
        return k * unit.rate(pressure, traction, slip)

    def per_load(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """See `WearLaw.per_load`, within the regime of each element."""
        rate = self.rate(pressure, traction, slip)
        return np.divide(rate, pressure, out=np.zeros_like(rate), where=pressure > 0.0)

    def weakened(self, factor: float) -> "ByChart":
        """See `WearLaw.weakened`."""
        return replace(self, mu=(factor * self.mu[0], factor * self.mu[1]))


@dataclass(frozen=True)
class EachBody(WearLaw):
    """Each body by its own law.

    Parameters
    ----------
    A, B : WearLaw, optional
        Their laws; a body without one does not wear.

    Examples
    --------
    >>> laws = ts.Laws.of(discs)
    >>> only_A = laws.replace(wear=ts.EachBody(A=laws.wear))
    >>> history = ts.roll(discs, laws=only_A)
    >>> bool(history["wear_profile_B"].any())
    False
    """

    A: WearLaw | None = None
    B: WearLaw | None = None

    def mapped(self, of: Callable[[WearLaw], WearLaw]) -> "EachBody":
        """What a function makes of each law that there is."""
        return EachBody(*(None if law is None else of(law) for law in (self.A, self.B)))

    def _of_bodies(self, quantity: str, *fields: np.ndarray) -> np.ndarray:
        """A quantity of each body, shape (2, n_x, n_y); zero of one without a law."""
        none = np.zeros_like(fields[0])
        return np.stack(
            [none if law is None else getattr(law, quantity)(*fields) for law in (self.A, self.B)]
        )

    def rate(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """See `WearLaw.rate`."""
        return self._of_bodies("rate", pressure, traction, slip).sum(axis=0)

    def per_load(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """See `WearLaw.per_load`."""
        return self._of_bodies("per_load", pressure, traction, slip).sum(axis=0)

    def shares(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """See `WearLaw.shares`; of rows that do not wear those of the whole contact."""
        each = self._of_bodies("rate", pressure, traction, slip).sum(axis=1)
        whole = each.sum(axis=1)
        share = whole / whole.sum() if whole.sum() > 0.0 else np.full(2, 0.5)
        depth = each.sum(axis=0)
        wears = depth > 0.0
        return np.where(wears, each / np.where(wears, depth, 1.0), share[:, None])

    def rates(
        self,
        share: Mapping[str, float],
        pressure: np.ndarray,
        traction: np.ndarray,
        slip: np.ndarray,
    ) -> np.ndarray:
        """See `WearLaw.rates`: each by its own law, whatever the share."""
        return self._of_bodies("rate", pressure, traction, slip)

    def on(self, element_area: float) -> "EachBody":
        """See `WearLaw.on`."""
        return self.mapped(lambda law: law.on(element_area))

    def weakened(self, factor: float) -> "EachBody":
        """See `WearLaw.weakened`."""
        return self.mapped(lambda law: law.weakened(factor))

    def with_friction(self, friction: FrictionLaw) -> "EachBody":
        """See `WearLaw.with_friction`."""
        return self.mapped(lambda law: law.with_friction(friction))

    def under(self, conditions: WearConditions) -> "EachBody":
        """See `WearLaw.under`."""
        return self.mapped(lambda law: law.under(conditions))

    def beyond_tests(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> str:
        """See `WearLaw.beyond_tests`."""
        told = {
            name: law.beyond_tests(pressure, traction, slip)
            for name, law in (("A", self.A), ("B", self.B))
            if law is not None
        }
        return "; ".join(f"body {name}: {text}" for name, text in told.items() if text)


def _mean(work: np.ndarray, pressure: np.ndarray) -> float:
    """Frictional work over the area in contact, N/mm²."""
    count = np.count_nonzero(pressure > 0.0)
    return float(work.sum() / count) if count else 0.0
