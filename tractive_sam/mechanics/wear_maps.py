"""Wear laws that were measured: regimes by frictional work, by sliding speed and pressure.

Each set of coefficients has its source, the units in which it was published, and how far the tests
went. What is converted is converted here, in `PER_MASS` and `PER_SECTION`.
"""

from dataclasses import dataclass, replace

import numpy as np

from tractive_sam.kernels import wear
from tractive_sam.mechanics.wear import ArchardByWork, WearLaw, work_of

PER_MASS = 1e-3
"""Depth per distance rolled of 1 µg/(m mm²) of a body of 1 kg/m³: 1e-9 kg/(1e3 mm mm²) over
1e-9 kg/mm³."""

PER_SECTION = np.pi * 1e-6
"""Cross section worn in a turn of a wheel of diameter D, mm², of 1/D mm²/km: pi D are 1e-6 km."""


@dataclass(frozen=True)
class Regimes:
    """A rate of wear that is straight between borders.

    Attributes
    ----------
    starts, values, slopes : tuple of float
        Where each regime begins, ascending from 0; the rate there, and its slope.
    tested : float
        As far as tests went; inf where that is not known.
    source : str
        Where the numbers are from.

    Examples
    --------
    >>> ts.USFD["r8t-uic60"].at(50.0)
    55.0
    """

    starts: tuple[float, ...]
    values: tuple[float, ...]
    slopes: tuple[float, ...]
    tested: float = np.inf
    source: str = ""

    @classmethod
    def through(cls, points: tuple[tuple[float, float], ...]) -> "Regimes":
        """Straight from the origin through points (W, rate), and on beyond the last."""
        work, rate = np.array(points, float).T
        if work[0] > 0.0:
            work, rate = np.append(0.0, work), np.append(0.0, rate)
        slopes = np.diff(rate) / np.diff(work)
        starts, values = work[:-1], rate[:-1]
        return cls(
            tuple(starts.tolist()), tuple(values.tolist()), tuple(slopes.tolist()), float(work[-1])
        )

    def at(self, work: float) -> float:
        """The rate at one place."""
        return float(self(np.array([float(work)]))[0][0])

    def __call__(self, work: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Rate and slope."""
        return wear.regimes(work, *map(np.array, (self.starts, self.values, self.slopes)))


USFD = {
    "r8t-uic60": Regimes(
        (0.0, 10.4, 77.2),
        (0.0, 55.0, 55.0),
        (5.3, 0.0, 61.9),
        120.0,
        "Braghin, Lewis, Dwyer-Joyce & Bruni 2006, Wear 261, 1253-1264: wheel R8T on rail UIC60 "
        "900A, twin discs",
    )
}
"""Mass worn off a wheel per distance rolled and area, µg/(m mm²), over T-gamma/A, N/mm². The tests
(Lewis & Dwyer-Joyce 2004, Proc. IMechE J 218, 467-478) went to 20 % slip at 1500 MPa; there the
728 W of heat that they print are 120 N/mm²."""

BRR = {
    "pearce-sherratt": Regimes(
        (0.0, 100.0, 200.0),
        (0.0, 25.0, 84.0),
        (0.25, 0.0, 1.19),
        np.inf,
        "Pearce & Sherratt 1991, Wear 144, 343-351: wheel on rail, British Rail Research",
    )
}
"""Cross section worn off a wheel per distance rolled, times its diameter D, mm² mm/km, over
T-gamma, N: 0.25 T-gamma below 100 N, 25 to 200 N, 1.19 T-gamma - 154 above, where it jumps from 25
to 84. As they are commonly quoted; not compared with the paper itself."""

JENDEL = {
    name: (k, "Jendel 2002, Wear 253, 89-99: wheel on rail, dry; the range of each regime " + told)
    for name, k, told in (
        ("middle", (5.5e-4, 35e-4, 5.5e-4, 350e-4), "in its middle"),
        ("low", (1e-4, 30e-4, 1e-4, 300e-4), "at its lower end"),
        ("high", (10e-4, 40e-4, 10e-4, 400e-4), "at its upper end"),
    )
}
"""Coefficients k of Archard's law, V = k P s/H: slow, between both speeds, fast, under pressure.
Published as ranges: 1-10, 30-40, 1-10 and 300-400, times 1e-4. As they are commonly quoted; not
compared with the paper itself."""

JENDEL_BORDERS, JENDEL_LIMIT = (200.0, 700.0), 0.8
"""Sliding speeds between the regimes, mm/s, and the pressure over hardness from which on the last
one holds."""


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

    Where an element sticks beside one that slips it bears less than the bound, and wears in that
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

    def on(self, element_area: float) -> "EachBody":
        """See `WearLaw.on`."""
        A, B = (None if law is None else law.on(element_area) for law in (self.A, self.B))
        return EachBody(A, B)

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
