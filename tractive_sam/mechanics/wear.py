"""Wear laws: orthotropic Archard wear (the paper), frictional work, and measured regimes.

The measured laws use published coefficients, each set with its source, the published units, which
`per_mass` and `per_section` convert, and the range of the tests. Scenes name these sets.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from tractive_sam.description import ShortArrays
from tractive_sam.mechanics.frame import Frame
from tractive_sam.mechanics.friction import Coulomb, FrictionLaw
from tractive_sam.mechanics.law import Law
from tractive_sam.mechanics.wear_sets import Regimes


def sweep_wear(entering, rate, dx):
    """Return the depth (n_x, n_y), mm: entering depth plus rate summed from the leading edge.

    Paper, eq. (32): w_I = w_entering + sum of rate_J dx over J from I up to the leading edge.

    Parameters
    ----------
    entering : ndarray, shape (n_y,)
        Depth with which the material enters, mm.
    rate : ndarray, shape (n_x, n_y)
        Wear per distance rolled, dimensionless.
    dx : float
        Side of an element in the rolling direction, mm.

    Returns
    -------
    ndarray, shape (n_x, n_y)
        Depth, mm; its row 0 is what leaves the contact.
    """
    return np.concatenate((entering[None], dx * rate[::-1])).cumsum(0)[:0:-1].copy()


def chart(speed, pressure, borders, limit, coefficients):
    """Return Archard's coefficient from a chart of sliding speed and pressure over hardness.

    Jendel (2002), Wear 253, 89-99: one regime below the first speed, one between both, one above;
    a fourth at any speed if the pressure exceeds a limit.

    Parameters
    ----------
    speed, pressure : ndarray
        Sliding speed, and pressure over hardness.
    borders : tuple of float
        The two speeds.
    limit : float
        Pressure over hardness.
    coefficients : tuple of float
        Coefficients of the four regimes.

    Returns
    -------
    ndarray
        k, dimensionless: worn volume times hardness over load and sliding distance.
    """
    regimes = pressure > limit, speed < borders[0], speed <= borders[1]
    return np.select(regimes, (coefficients[3], *coefficients[:2]), coefficients[2])


@dataclass(frozen=True, eq=False, repr=False)
class WearConditions(ShortArrays):
    """Wear depth, revolution and temperature before a pass, for wear laws that depend on them.

    Attributes
    ----------
    depth : ndarray, shape (n_y,) or (n_x, n_y)
        Wear depth of both bodies together before the pass, mm: of the material that enters the
        contact, or in a transient of the material in every element.
    revolution : float
        Number of the revolution as in `revolutions`; nan in a transient.
    temperature : ndarray, shape (n_x, n_y), or None
        Temperature of the surfaces in contact, degrees C; None without [heat] and in a transient.

    Examples
    --------
    >>> ts.WearConditions(depth=np.zeros(3), revolution=1.0).temperature is None
    True
    """

    depth: np.ndarray
    revolution: float
    temperature: np.ndarray | None = None


class WearLaw(Law, ABC):
    """Base class of wear laws: a subclass defines `rate`, the worn depth per rolling distance.

    Examples
    --------
    >>> class WorkLaw(ts.WearLaw):
    ...     def rate(self, pressure, traction, slip):
    ...         return 5e-6 * np.abs((traction * slip).sum(axis=0))
    >>> history = ts.roll(discs, laws=ts.Laws.of(discs).replace(wear=WorkLaw()))
    >>> bool(history["wear_max"][-1] > 0.0)
    True
    """

    @abstractmethod
    def rate(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Return the wear depth per rolling distance of both bodies together, dimensionless.

        Parameters
        ----------
        pressure : ndarray, shape (n_x, n_y)
            p_n, MPa.
        traction : ndarray, shape (2, n_x, n_y)
            (p_x, p_y) on body A, MPa.
        slip : ndarray, shape (2, n_x, n_y)
            s/V, dimensionless.
        """

    def per_load(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Return the derivative of the rate by pressure, 1/MPa; default: of a proportional law.

        Parameters as in `rate`. The default holds for a law proportional to both.
        """
        touching = pressure > 0.0
        share = traction / np.where(touching, pressure, 1.0)
        return self.rate(np.where(touching, 1.0, 0.0), share, slip)

    def shares(
        self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray
    ) -> np.ndarray | None:
        """Return shares of A and B in the wear of each row (2, n_y); default None: the scene's.

        Parameters as in `rate`. None, the default: the shares of the scene, from hardness or
        coefficients, hold everywhere.
        """
        return None

    def rates(
        self,
        share: Mapping[str, float],
        pressure: np.ndarray,
        traction: np.ndarray,
        slip: np.ndarray,
    ) -> np.ndarray:
        """Return the depth of each body per rolling distance, by `shares` or else `share`.

        Parameters
        ----------
        share : mapping of str to float
            Share of each body in the depth, if the law has no `shares`.
        pressure, traction, slip : ndarray
            See `rate`.
        """
        shares = self.shares(pressure, traction, slip)
        parts = np.array([[share[body]] for body in "AB"]) if shares is None else shares
        return parts[:, None, :] * self.rate(pressure, traction, slip)

    def on(self, element_area: float) -> "WearLaw":
        """Return the law for a mesh whose elements have this area, mm²; by default this law."""
        return self

    def weakened(self, factor: float) -> "WearLaw":
        """Return the law for friction multiplied by a factor; by default this law."""
        return self

    def with_friction(self, friction: FrictionLaw, x: np.ndarray, y: np.ndarray) -> "WearLaw":
        """Return the law for a contact with this friction; by default this law.

        Parameters
        ----------
        friction : FrictionLaw
            The law on the rows of the mesh.
        x, y : ndarray, shapes (n_x, 1) and (1, n_y)
            Centres of the elements, mm.
        """
        return self

    def under(self, conditions: WearConditions) -> "WearLaw":
        """Return the law at a wear depth, a revolution and a temperature; by default this law.

        Running-in is an example. The dependence must be smooth: adaptive stepping extrapolates the
        rate.
        """
        return self

    def beyond_tests(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> str:
        """Return a text if conditions exceed those of the experiments; by default always ""."""
        return ""

    def depth(
        self,
        entering: np.ndarray,
        pressure: np.ndarray,
        traction: np.ndarray,
        slip: np.ndarray,
        dx: float,
    ) -> np.ndarray:
        """Return the wear depth below every element during one pass (paper, eq. 32), mm.

        Parameters
        ----------
        entering : ndarray, shape (n_y,)
            Depth after the previous revolution, mm.
        pressure, traction, slip : ndarray
            See `rate`.
        dx : float
            Side of an element in the rolling direction, mm.
        """
        return sweep_wear(entering, self.rate(pressure, traction, slip), dx)


@dataclass(frozen=True)
class Archard(WearLaw):
    """Archard's law: depth per rolling distance is pressure times slip weighted by intensities.

    Parameters
    ----------
    intensity : tuple of float
        Wear intensities (i1, i2) along the tribological axes, 1/MPa.
    angle : float
        Angle beta of the first axis, counter-clockwise from x, radians.
    """

    intensity: tuple[float, float]
    angle: float

    def rate(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Return the depth per rolling distance of both bodies, from pressure and slip only.

        Parameters as in `WearLaw.rate`.
        """
        return pressure * Frame(self.intensity, self.angle).dual_norm(slip)


@dataclass(frozen=True, eq=False)
class TemperatureScaledWear(WearLaw):
    """A wear law times a factor that depends on the surface temperature.

    Parameters
    ----------
    law : WearLaw
        The law without the factor.
    factor : ndarray, shape (n_x, n_y)
        Factor on its rate.
    """

    law: WearLaw
    factor: np.ndarray

    def rate(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Return the law's wear depth per rolling distance times the factor, dimensionless.

        Parameters as in `WearLaw.rate`.
        """
        return self.factor * self.law.rate(pressure, traction, slip)

    def per_load(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Return the factor times the law's derivative of the wear rate by the pressure, 1/MPa.

        Parameters as in `WearLaw.per_load`.
        """
        return self.factor * self.law.per_load(pressure, traction, slip)

    def shares(
        self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray
    ) -> np.ndarray | None:
        """Return the shares of A and B in wear (2, n_y), or None, of the law without factor.

        Parameters as in `WearLaw.shares`.
        """
        return self.law.shares(pressure, traction, slip)


def work_along_axes(
    traction: np.ndarray, slip: np.ndarray, angle: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Return frictional work per rolling distance and area along each tribological axis, MPa."""
    axes = Frame(angle=angle).matrix
    along, across = -np.tensordot(axes, traction, axes=1) * np.tensordot(axes, slip, axes=1)
    return along, across


def frictional_work(traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
    """Return the frictional work per rolling distance and area, MPa; negative work is set to 0."""
    along, across = work_along_axes(traction, slip)
    return np.maximum(along + across, 0.0)


@dataclass(frozen=True)
class Energy(WearLaw):
    """Wear law: depth k1 w_1 + k2 w_2 by the frictional work w_k = -p_k s_k along each axis.

    The depth depends on the work only and is additive: the wear of a contact
    follows from its total work along each tribological axis. With k1 = k2 the axes have no
    influence. `ArchardByWork` has a norm of the slip instead: with i_j = k_j mu_j its depth is
    equal for slip along an axis and for k1 = k2, and larger otherwise.

    Parameters
    ----------
    per_work : tuple of float
        Depth over work per area, (k1, k2) along the tribological axes, 1/MPa: 1e-3 times the
        coefficients in mm3/J.
    angle : float
        Angle beta of the first axis, counter-clockwise from x, radians.

    Examples
    --------
    >>> law = ts.Energy((5e-6, 5e-6))
    >>> worn = ts.roll(discs, laws=ts.Laws.of(discs).replace(wear=law))
    >>> worn.finished
    True
    """

    per_work: tuple[float, float]
    angle: float = 0.0

    def rate(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Return the wear depth per rolling distance of both bodies; negative work counts as 0."""
        along, across = work_along_axes(traction, slip, self.angle)
        work = np.maximum(along + across, 0.0)
        first, second = self.per_work
        # Negative work along one axis must not leave the bounds of positive work along both.
        lower, upper = sorted(self.per_work)
        return np.clip(first * along + second * across, lower * work, upper * work)


@dataclass(frozen=True, eq=False)
class ArchardByWork(WearLaw):
    """Archard's wear law from the frictional work w_k = -p_k s_k along each tribological axis.

    In a slip element p_k = -p_n mu_k^2 s_k/||s||*_mu, and p_n |s|_i becomes

        sqrt((w_1 + w_2) ((i1/mu1)^2 w_1 + (i2/mu2)^2 w_2)).

    A stick element next to a slip element has some slip (`State.slip`), but its traction is below
    the bound: if only a narrow edge slips, its pressure would give many times too much wear, its
    work does not. With i1/mu1 = i2/mu2 the wear of the contact is this ratio times its frictional
    work, on any mesh; otherwise it is between the smaller and the larger ratio.

    Parameters
    ----------
    intensity, mu : tuple of float
        Wear intensities (i1, i2), 1/MPa, and friction coefficients (mu1, mu2) along the
        tribological axes.
    angle : float
        Angle beta of the first axis, counter-clockwise from x, radians.
    friction : FrictionLaw, optional
        Law whose `friction_factor` multiplies mu: with lower friction an equal work needs a longer
        sliding distance. Constant friction by default.
    x, y : ndarray, optional
        Centres of the elements, mm; see `with_friction`.
    """

    intensity: tuple[float, float]
    mu: tuple[float, float]
    angle: float
    friction: FrictionLaw | None = None
    x: np.ndarray | None = None
    y: np.ndarray | None = None

    def rate(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Return the wear depth per rolling distance of both bodies; negative work counts as 0."""
        along, across = work_along_axes(traction, slip, self.angle)
        work = np.maximum(along + across, 0.0)
        first, second = (i / mu for i, mu in zip(self.intensity, self.mu, strict=True))
        squared = work * (first**2 * along + second**2 * across)
        # Negative work along one axis must not leave the bounds of positive work along both.
        lower, upper = sorted((first, second))
        rate = np.sqrt(np.clip(squared, (lower * work) ** 2, (upper * work) ** 2))
        if self.friction is None or self.x is None or self.y is None:
            return rate
        return rate / self.friction.friction_factor(pressure, slip, self.x, self.y)

    def weakened(self, factor: float) -> "ArchardByWork":
        """Return the law for friction times a factor: less friction, longer sliding per work."""
        if self.friction is not None:
            return replace(self, friction=self.friction.weakened(factor))
        return replace(self, mu=(factor * self.mu[0], factor * self.mu[1]))

    def with_friction(self, friction: FrictionLaw, x: np.ndarray, y: np.ndarray) -> "ArchardByWork":
        """Return the law with the coefficients of this friction (`WearLaw.with_friction`)."""
        frame, varies = friction.frame, type(friction) is not Coulomb
        law = replace(self, mu=frame.mu, angle=frame.angle)
        return replace(law, friction=friction, x=x, y=y) if varies else law


JENDEL_BORDERS, JENDEL_LIMIT = (200.0, 700.0), 0.8
"""Sliding speeds between the regimes, mm/s, and the pressure over hardness above which the last
regime holds."""


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
    recorded_name = "tractive_sam.mechanics.wear_maps.ByWork"

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
    recorded_name = "tractive_sam.mechanics.wear_maps.ByTotal"

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
    unit : ArchardByWork, optional
        Law with k = 1; by default with constant friction.
    """

    coefficients: tuple[float, float, float, float]
    hardness: float
    speed: float
    mu: tuple[float, float] = (1.0, 1.0)
    angle: float = 0.0
    unit: ArchardByWork | None = field(default=None, metadata={"added": True})
    recorded_name = "tractive_sam.mechanics.wear_maps.ByChart"

    def rate(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Return the depth per rolling distance, by the chart's coefficient at each element.

        Parameters as in `WearLaw.rate`.
        """
        sliding = self.speed * np.hypot(*slip)
        k = chart(
            sliding, pressure / self.hardness, JENDEL_BORDERS, JENDEL_LIMIT, self.coefficients
        )
        return k * self._unit.rate(pressure, traction, slip)

    @property
    def _unit(self) -> ArchardByWork:
        """Law with k = 1."""
        return self.unit or ArchardByWork((1.0 / self.hardness,) * 2, self.mu, self.angle)

    def per_load(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Return rate/pressure, the derivative in unchanged regimes, 1/MPa; 0 outside contact.

        The regime of each element is assumed not to change.

        Parameters as in `WearLaw.per_load`.
        """
        rate = self.rate(pressure, traction, slip)
        return np.divide(rate, pressure, out=np.zeros_like(rate), where=pressure > 0.0)

    def weakened(self, factor: float) -> "WearMap":
        """Return the law for friction multiplied by a factor (`WearLaw.weakened`)."""
        return replace(self, unit=self._unit.weakened(factor))

    def with_friction(self, friction: FrictionLaw, x: np.ndarray, y: np.ndarray) -> "WearMap":
        """Return the law with the coefficients of this friction (`WearLaw.with_friction`)."""
        return replace(self, unit=self._unit.with_friction(friction, x, y))


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
    recorded_name = "tractive_sam.mechanics.wear_maps.EachBody"

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

    def with_friction(self, friction: FrictionLaw, x: np.ndarray, y: np.ndarray) -> "PerBody":
        """Return the laws of both bodies for this friction (`WearLaw.with_friction`)."""
        return self.map_laws(lambda law: law.with_friction(friction, x, y))

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
