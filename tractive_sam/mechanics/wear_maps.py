"""Measured wear laws: regimes of frictional work, or of sliding speed and pressure.

The coefficients are in `mechanics.wear_sets`, in the published units; `per_mass` and `per_section`
convert them.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from tractive_sam.kernels import wear
from tractive_sam.mechanics.friction import FrictionLaw
from tractive_sam.mechanics.wear import ArchardByWork, WearConditions, WearLaw, frictional_work
from tractive_sam.mechanics.wear_sets import JENDEL_BORDERS, JENDEL_LIMIT, Regimes


@dataclass(frozen=True)
class TGammaPerArea(WearLaw):
    """Wear law: worn mass per rolling distance and area as a function of T-gamma/A.

    Parameters
    ----------
    regimes : Regimes
        µg/(m mm²) over N/mm².
    density : float
        Density of the body that wears, kg/m³.
    total : bool
        Whether T-gamma/A is taken of the contact, and its wear is distributed in proportion to the
        work of each element; otherwise each element has its T-gamma/A.
    """

    per_mass = 1e-3
    """Depth per distance rolled of 1 µg/(m mm²) of a body of 1 kg/m³: 1e-9 kg/(1e3 mm mm²) over
    1e-9 kg/mm³."""

    regimes: Regimes
    density: float
    total: bool = False
    recorded_name = "ByWork"

    def rate(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Return the depth per rolling distance, by T-gamma/A of each element or of the contact.

        Parameters as in `WearLaw.rate`.
        """
        work = frictional_work(traction, slip)
        per_mass = self.per_mass / self.density
        if not self.total:
            return per_mass * self.regimes(work)[0]
        mean = _mean(work, pressure)
        return per_mass * self.regimes.at(mean) / mean * work if mean else work

    def per_load(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Return the derivative of wear rate by pressure, T-gamma of the contact constant, 1/MPa.

        At constant load T-gamma of the contact hardly changes.

        Parameters as in `WearLaw.per_load`.
        """
        touching = pressure > 0.0
        each = np.where(touching, pressure, 1.0)
        if self.total:
            return np.where(touching, self.rate(pressure, traction, slip) / each, 0.0)
        work = frictional_work(traction, slip)
        slope = self.per_mass / self.density * self.regimes(work)[1]
        return np.where(touching, slope * work / each, 0.0)

    def beyond_tests(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> str:
        """Return a text if T-gamma/A exceeds the range of the experiments; "" otherwise."""
        work = frictional_work(traction, slip)
        largest = _mean(work, pressure) if self.total else float(work.max())
        if largest <= self.regimes.tested:
            return ""
        tested = f"{self.regimes.tested:g}"
        return f"T-gamma/A = {largest:.3g} N/mm² is above the range of the tests, {tested}"


@dataclass(frozen=True)
class TGammaTotal(WearLaw):
    """Wear law: worn cross section of a wheel per turn as a function of the total T-gamma, N.

    The wear is distributed in proportion to the work of each element; the law needs the area of an
    element (`WearLaw.on`).

    Parameters
    ----------
    regimes : Regimes
        mm²/km times the diameter in mm, over N.
    element_area : float
        Area of an element, mm².
    """

    per_section = np.pi * 1e-6
    """Worn cross section of a turn of a wheel of diameter D, mm², for 1/D mm²/km: pi D in mm is
    1e-6 pi D km."""

    regimes: Regimes
    element_area: float = np.nan
    recorded_name = "ByTotal"

    def on(self, element_area: float) -> "TGammaTotal":
        """Return the law for a mesh whose elements have this area, mm² (`WearLaw.on`)."""
        return replace(self, element_area=element_area)

    def rate(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Return the depth per rolling distance: that of the total T-gamma, distributed by work.

        Parameters as in `WearLaw.rate`.
        """
        work = frictional_work(traction, slip)
        total = float(work.sum()) * self.element_area
        return self.per_section * self.regimes.at(total) / total * work if total else work

    def per_load(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Return rate/pressure, the derivative at constant T-gamma, 1/MPa; 0 outside contact.

        At constant load T-gamma of the contact hardly changes.

        Parameters as in `WearLaw.per_load`.
        """
        rate = self.rate(pressure, traction, slip)
        return np.divide(rate, pressure, out=np.zeros_like(rate), where=pressure > 0.0)


@dataclass(frozen=True)
class WearMap(WearLaw):
    """Archard's wear law, its coefficient from a chart of sliding speed and pressure (`JENDEL`).

    The wear of a stick element next to a slip element is reduced as its traction, as in
    `ArchardByWork`.

    Parameters
    ----------
    coefficients : tuple of float
        k of the four regimes, see `JENDEL`.
    hardness : float
        Hardness of the body that wears, MPa.
    speed : float
        Rolling speed, mm/s.
    mu, angle : tuple of float and float
        See `ArchardByWork`.
    """

    coefficients: tuple[float, float, float, float]
    hardness: float
    speed: float
    mu: tuple[float, float] = (1.0, 1.0)
    angle: float = 0.0
    recorded_name = "ByChart"

    def rate(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Return the depth per rolling distance, by the chart's coefficient at each element.

        Parameters as in `WearLaw.rate`.
        """
        unit = ArchardByWork((1.0 / self.hardness,) * 2, self.mu, self.angle)
        sliding = self.speed * np.hypot(*slip)
        k = wear.chart(
            sliding, pressure / self.hardness, JENDEL_BORDERS, JENDEL_LIMIT, self.coefficients
        )
        return k * unit.rate(pressure, traction, slip)

    def per_load(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Return rate/pressure, the derivative in unchanged regimes, 1/MPa; 0 outside contact.

        The regime of each element is assumed not to change.

        Parameters as in `WearLaw.per_load`.
        """
        rate = self.rate(pressure, traction, slip)
        return np.divide(rate, pressure, out=np.zeros_like(rate), where=pressure > 0.0)

    def weakened(self, factor: float) -> "WearMap":
        """Return the law for friction multiplied by a factor (`WearLaw.weakened`)."""
        return replace(self, mu=(factor * self.mu[0], factor * self.mu[1]))


@dataclass(frozen=True)
class PerBody(WearLaw):
    """Wear law made of a separate law for each body; a body without a law does not wear.

    Parameters
    ----------
    A, B : WearLaw, optional
        Laws of the bodies; a body without a law does not wear.

    Examples
    --------
    >>> laws = ts.Laws.of(discs)
    >>> only_A = laws.replace(wear=ts.PerBody(A=laws.wear))
    >>> history = ts.roll(discs, laws=only_A)
    >>> bool(history["wear_profile_B"].any())
    False
    """

    A: WearLaw | None = None
    B: WearLaw | None = None
    recorded_name = "EachBody"

    def map_laws(self, function: Callable[[WearLaw], WearLaw]) -> "PerBody":
        """Return the pair with a function applied to each law; a missing law remains None."""
        return PerBody(*(None if law is None else function(law) for law in (self.A, self.B)))

    def _of_bodies(self, quantity: str, *fields: np.ndarray) -> np.ndarray:
        """Return results of a named method of both laws, (2, n_x, n_y); 0 without a law."""
        none = np.zeros_like(fields[0])
        return np.stack(
            [none if law is None else getattr(law, quantity)(*fields) for law in (self.A, self.B)]
        )

    def rate(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Return the depth per rolling distance, dimensionless: the sum of both bodies' laws.

        Parameters as in `WearLaw.rate`.
        """
        return self._of_bodies("rate", pressure, traction, slip).sum(axis=0)

    def per_load(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Return the derivative of the wear rate by the pressure, the sum over both bodies, 1/MPa.

        Parameters as in `WearLaw.per_load`.
        """
        return self._of_bodies("per_load", pressure, traction, slip).sum(axis=0)

    def shares(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Return shares of A and B in the wear of each row (2, n_y); the contact's in unworn rows.

        Rows without wear have the shares of the contact.

        Parameters as in `WearLaw.shares`.
        """
        each = self._of_bodies("rate", pressure, traction, slip).sum(axis=1)
        total = each.sum(axis=1)
        share = total / total.sum() if total.sum() > 0.0 else np.full(2, 0.5)
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
        """Return each body's depth per rolling distance by its law, (2, n_x, n_y); not by `share`.

        Each body has its law; `share` is not used.

        Parameters as in `WearLaw.rates`.
        """
        return self._of_bodies("rate", pressure, traction, slip)

    def on(self, element_area: float) -> "PerBody":
        """Return the laws for a mesh whose elements have this area, mm² (`WearLaw.on`)."""
        return self.map_laws(lambda law: law.on(element_area))

    def weakened(self, factor: float) -> "PerBody":
        """Return the laws for friction multiplied by a factor (`WearLaw.weakened`)."""
        return self.map_laws(lambda law: law.weakened(factor))

    def with_friction(self, friction: FrictionLaw) -> "PerBody":
        """Return the laws of both bodies with another friction law."""
        return self.map_laws(lambda law: law.with_friction(friction))

    def under(self, conditions: WearConditions) -> "PerBody":
        """Return the laws of both bodies at a wear depth, a revolution and a temperature."""
        return self.map_laws(lambda law: law.under(conditions))

    def beyond_tests(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> str:
        """Return a text on each body whose conditions exceed the experiments; "" if none do."""
        texts = {
            name: law.beyond_tests(pressure, traction, slip)
            for name, law in (("A", self.A), ("B", self.B))
            if law is not None
        }
        return "; ".join(f"body {name}: {text}" for name, text in texts.items() if text)


def _mean(work: np.ndarray, pressure: np.ndarray) -> float:
    """Return the mean frictional work over the elements in contact, N/mm²; 0 without contact."""
    count = np.count_nonzero(pressure > 0.0)
    return float(work.sum() / count) if count else 0.0
