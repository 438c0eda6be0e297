"""Friction that depends on sliding speed, temperature, lateral position and a strength.

The coefficients are their values at rest times a share, which is equal for both tribological axes,
and the traction is limited by a strength:

    ||p_t||_mu <= min(share(V |s|) factor(T) factor(y) p_n, strength / max(mu1, mu2)).

The sliding speed is evaluated at the centre of an element, as the traction. The share may have a
memory: the product of share and temperature factor adapts to sliding speed and temperature over a
sliding distance (Vollebregt & Schuttelaars 2012, J. Sound Vib. 331, 2141-2155),

    d(share)/dt = -(max(V |s|, s0) / d_c) (share - share(V |s|) factor(T)),

which is integrated along the contact from the leading edge, where the material is at rest and has
its bulk temperature.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, field, fields, replace
from typing import Any, ClassVar

import numpy as np

from tractive_sam.kernels import friction
from tractive_sam.mechanics.friction import Bound, Coulomb, PreviousShare, Slope


class SlidingShare(ABC):
    """Base class of mu(speed)/mu(0); a subclass adds `at`, with the derivative, and `least`.

    Examples
    --------
    >>> class Decay(ts.SlidingShare):
    ...     def at(self, speed):
    ...         return 1.0 / (1.0 + speed / 500.0) ** 2, -2.0 / 500.0 / (1.0 + speed / 500.0) ** 3
    ...
    ...     @property
    ...     def least(self):
    ...         return 0.0
    >>> fast = scene.replace(**{"creepage.speed": 2000.0})
    >>> law = ts.FallingCoulomb(mu=(0.4, 0.4), sliding=Decay(), speed=2000.0)
    >>> ts.solve(fast, laws=ts.Laws.of(fast).replace(friction=law)).Qx < contact.Qx
    True
    """

    @abstractmethod
    def at(self, speed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the ratio mu(speed)/mu(0) and its derivative by the speed, s/mm.

        Parameters
        ----------
        speed : ndarray
            Sliding speed, mm/s, not negative.

        Returns
        -------
        share, by_speed : ndarray
            Both of the shape of `speed`.
        """

    @property
    @abstractmethod
    def least(self) -> float:
        """Limit of the ratio mu(speed)/mu(0) at high speed."""


@dataclass(frozen=True)
class Exponential(SlidingShare):
    """The ratio mu(speed)/mu(0) = kinetic + (1 - kinetic) exp(-ln 2 speed / half_speed).

    With kinetic = A and half_speed = ln 2 / B it is Polach's law, mu_0 ((1 - A) exp(-B w) + A)
    (2005, Wear 258, 992-1000), applied to the local speed.

    Parameters
    ----------
    kinetic : float
        Share at high speed.
    half_speed : float
        Speed at which the share has fallen by half of 1 - kinetic, mm/s.
    """

    kinetic: float
    half_speed: float

    def at(self, speed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return mu(speed)/mu(0) of the exponential law, and its derivative by speed, s/mm.

        Parameters as in `SlidingShare.at`.
        """
        rate = np.log(2.0) / self.half_speed
        fall = (1.0 - self.kinetic) * np.exp(-rate * speed)
        return self.kinetic + fall, -rate * fall

    @property
    def least(self) -> float:
        """Limit of mu(speed)/mu(0) at high speed: `kinetic` (`SlidingShare.least`)."""
        return self.kinetic


@dataclass(frozen=True)
class Rational(SlidingShare):
    """The ratio mu(speed)/mu(0) = kinetic + (1 - kinetic) / (1 + speed / half_speed)."""

    kinetic: float
    half_speed: float

    def at(self, speed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the ratio mu(speed)/mu(0) and its derivative by the speed, s/mm.

        Parameters as in `SlidingShare.at`.
        """
        denominator = 1.0 + speed / self.half_speed
        fall = (1.0 - self.kinetic) / denominator
        return self.kinetic + fall, -fall / (denominator * self.half_speed)

    @property
    def least(self) -> float:
        """Limit of mu(speed)/mu(0) at high speed: `kinetic` (`SlidingShare.least`)."""
        return self.kinetic


@dataclass(frozen=True)
class ConstantShare(SlidingShare):
    """The ratio mu(speed)/mu(0) = 1: with a memory, friction adapts to the temperature alone."""

    def at(self, speed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return one and zero, both of the shape of the speed (`SlidingShare.at`)."""
        return np.ones_like(speed), np.zeros_like(speed)

    @property
    def least(self) -> float:
        """Limit of mu(speed)/mu(0) at high speed: 1 (`SlidingShare.least`)."""
        return 1.0


@dataclass(frozen=True, eq=False)
class TemperatureFactor:
    """Factor on friction due to the surface temperature, by element, and of entering material.

    Attributes
    ----------
    x, y : ndarray, shapes (n_x,) and (n_y,)
        Centres of the elements, mm.
    factor : ndarray, shape (n_x, n_y)
        Factor in each element.
    entering : float
        Factor of material that enters the contact, at which a memory begins.
    """

    x: np.ndarray
    y: np.ndarray
    factor: np.ndarray
    entering: float = 1.0

    def at(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the factor on the elements of another mesh, by linear interpolation.

        Parameters
        ----------
        x, y : ndarray, shapes (m, 1) and (1, n)
            Centres of the elements, mm.
        """
        return _interpolate(self.factor, (self.x, self.y), (x, y))


@dataclass(frozen=True, eq=False)
class LateralFactor:
    """Factor on the friction coefficients as a function of the lateral position y.

    Attributes
    ----------
    y : ndarray, shape (n,)
        Ascending positions, mm.
    factor : ndarray, shape (n,)
        Factor at each position; linear between them, constant beyond.
    """

    y: np.ndarray
    factor: np.ndarray

    def at(self, y: np.ndarray) -> np.ndarray:
        """Return the factor on friction at lateral positions y, mm."""
        return np.interp(y, self.y, self.factor)

    def on_rows(self, y: np.ndarray, place: np.ndarray) -> "LateralFactor":
        """Return the factor at places as a function of the rows y of a mesh there, mm."""
        return LateralFactor(y, self.at(place))


def _spacing(x: np.ndarray) -> float:
    """Return the distance of the rows of a mesh with centres x, mm; 0 for a single row."""
    return float(x[1, 0] - x[0, 0]) if len(x) > 1 else 0.0


def _interpolate(
    values: np.ndarray, nodes: tuple[np.ndarray, ...], points: tuple[np.ndarray, ...]
) -> np.ndarray:
    """Return a field at the grid of other points, bilinear between its nodes (x and y axes)."""
    along, across = (_weights(a, b.ravel()) for a, b in zip(nodes, points, strict=True))
    return along @ values @ across.T


def _weights(nodes: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return the matrix of linear interpolation from ascending nodes to points, constant beyond."""
    if len(nodes) == 1:
        return np.ones((len(points), 1))
    place = np.interp(points, nodes, np.arange(len(nodes)))
    first = np.minimum(place.astype(int), len(nodes) - 2)
    rows, part = np.arange(len(points)), place - first
    matrix = np.zeros((len(points), len(nodes)))
    matrix[rows, first], matrix[rows, first + 1] = 1.0 - part, part
    return matrix


@dataclass(frozen=True)
class FallingCoulomb(Coulomb):
    """Coulomb friction that falls with the sliding speed, with an upper limit of the traction.

    Parameters
    ----------
    mu, angle
        See `Coulomb`; values at rest.
    sliding : SlidingShare, optional
        Dependence on the sliding speed.
    speed : float
        Rolling speed V, mm/s.
    memory : float
        Sliding distance d_c over which the coefficients adapt to speed and temperature, mm.
    strength : float
        Largest traction, MPa.
    warmth : TemperatureFactor, optional
        Factor of the temperature.
    lateral : LateralFactor, optional
        Factor of the lateral position.

    Examples
    --------
    >>> law = ts.FallingCoulomb(mu=(0.5, 0.5), strength=100.0)
    >>> law.bound(np.array([[100.0, 300.0]]), 0.0, 0.0).radius
    array([[100., 200.]])
    """

    sliding: SlidingShare | None = None
    speed: float = 0.0
    memory: float = 0.0
    strength: float = np.inf
    warmth: TemperatureFactor | None = None
    lateral: LateralFactor | None = field(default=None, metadata={"added": True})
    background: ClassVar[float] = 1.0
    """Speed s0 at which a memory fades without sliding, mm/s."""

    @property
    def falls(self) -> bool:
        """Whether the bound depends on slip: with `sliding`, at a positive, finite speed."""
        return self.sliding is not None and 0.0 < self.speed < np.inf

    def on_rows(self, y: np.ndarray, place: np.ndarray) -> "FallingCoulomb":
        """Return the law with its lateral factor on a mesh.

        Parameters as in `FrictionLaw.on_rows`.
        """
        if self.lateral is None:
            return self
        return replace(self, lateral=self.lateral.on_rows(y, place))

    def at_speed_ratio(self, ratio: float) -> "FallingCoulomb":
        """Return the law with the rolling speed multiplied by `ratio`; 0 gives the static law.

        At infinite speed the law is constant.
        """
        return replace(self, speed=ratio * self.speed)

    def weakened(self, factor: float) -> "FallingCoulomb":
        """Return the law with its friction coefficients, not its strength, times a factor."""
        return self if factor == 1.0 else self._in_step(factor=factor)

    def with_previous(self, past: PreviousShare) -> "FallingCoulomb":
        """Return the law with past friction if it has a memory, else itself; raise with strength.

        Raises
        ------
        ValueError
            If the law has a memory and a strength: the strength hides the share.
        """
        if self.memory > 0.0 and self.strength < np.inf:
            raise ValueError(
                "FallingCoulomb: a transient cannot have both memory and strength; omit one of them"
            )
        return self._in_step(past=past) if self.memory > 0.0 else self

    def _in_step(self, **settings: Any) -> "FallingCoulombInStep":
        """Return the law for a step of a transient with its settings."""
        own = {one.name: getattr(self, one.name) for one in fields(self)}
        return FallingCoulombInStep(**own, **settings)

    def bound(self, pressure: np.ndarray, x: np.ndarray, y: np.ndarray) -> Bound:
        """Return the traction bound at rest, or for infinite sliding if the speed is infinite."""
        share = 1.0
        if self.sliding is not None and np.isinf(self.speed):
            share = self.sliding.least
        factor = self._factor(x, y)
        if self.falls and self.memory > 0.0 and self.warmth is not None:
            # With a memory, the share may lag behind a temperature factor that falls.
            factor = factor * (
                max(self.warmth.entering, self.warmth.factor.max()) / self.warmth.at(x, y)
            )
        return self._capped(pressure, np.full_like(pressure, share), factor)[0]

    def bound_sliding(
        self, pressure: np.ndarray, slip: np.ndarray, x: np.ndarray, y: np.ndarray, second: bool
    ) -> Bound:
        """Return the traction bound under a slip, with its derivative by the slip (`Slope`).

        Parameters as in `FrictionLaw.bound_sliding`.
        """
        assert self.sliding is not None  # as the law falls
        size = np.hypot(*slip)
        share, by_speed = self.sliding.at(self.speed * size)
        if not (share >= 0.0).all():
            wrong = ~(share >= 0.0)
            raise ValueError(
                f"{type(self.sliding).__name__}.at returned the share {share[wrong][0]:g} at "
                f"{(self.speed * size)[wrong][0]:g} mm/s; allowed: at least 0"
            )
        retained, by_factor, factor = np.zeros_like(share), None, self._factor(x, y)
        if self.memory > 0.0:
            if self.warmth is not None:
                remembered = self.warmth.at(x, y) / self.warmth.entering
                share, by_speed = remembered * share, remembered * by_speed
                factor = factor / remembered
                adapted = 1.0 - self._retained_share(size, _spacing(x), second)[0]
                by_factor = adapted * share
            share, by_speed, retained = self._with_memory(
                pressure, size, share, by_speed, x, y, second
            )
        bound, by_share = self._capped(pressure, share, factor)
        along = slip / np.where(size > 0.0, size, 1.0)
        by_slip = self.speed * by_speed * along
        return replace(bound, slope=Slope(by_share, by_slip, retained, by_factor))

    def by_mu(self, bound: Bound, change: np.ndarray) -> np.ndarray:
        """Return the derivative of the scaled bound by a change of mu; 0 unless strength caps it.

        Pressure and slip are constant.

        Only the strength depends on a coefficient, the larger one (`Frame.largest_by`).

        Parameters
        ----------
        bound : Bound
            Result of `bound` or `bound_sliding`.
        change : ndarray, shape (2,)
            Change of both coefficients.
        """
        capped = (bound.radius > 0.0) & (bound.by_pressure == 0.0)
        return np.where(capped, -self.frame.largest_by(change) * bound.radius, 0.0)

    def friction_factor(
        self, pressure: np.ndarray, slip: np.ndarray, x: np.ndarray, y: np.ndarray
    ) -> np.ndarray:
        """Return the friction coefficients under a slip over their values at rest, (n_x, n_y).

        Parameters as in `FrictionLaw.friction_factor`.
        """
        share = np.ones_like(pressure)
        factor = 1.0 if self.warmth is None else self.warmth.factor
        if self.lateral is not None:
            factor = factor * self.lateral.factor  # see `on_rows`
        if self.sliding is not None:
            size = np.hypot(*slip)
            share, by_speed = self.sliding.at(self.speed * size)
            if self.memory > 0.0:
                if self.warmth is not None:
                    remembered = self.warmth.factor / self.warmth.entering
                    share, by_speed = remembered * share, remembered * by_speed
                    factor = factor / remembered
                share = self._with_memory(pressure, size, share, by_speed, x, y, second=True)[0]
        radius = self._capped(pressure, share, factor)[0].radius
        return np.divide(radius, pressure, out=share, where=pressure > 0.0)

    def _with_memory(
        self,
        pressure: np.ndarray,
        size: np.ndarray,
        target: np.ndarray,
        by_speed: np.ndarray,
        x: np.ndarray,
        y: np.ndarray,
        second: bool,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return mu/mu(0) with memory, and its derivatives by the speed and by the ratio ahead.

        To second order the memory over an element follows from a constant speed, exp(-slid/d_c); to
        first order from an implicit step.
        """
        retained, by_retained = self._retained_share(size, _spacing(x), second)
        share, ahead = np.empty_like(target), np.empty_like(target)
        friction.remember(target, retained, pressure, ahead, share)
        by_speed = (1.0 - retained) * by_speed + (ahead - target) * by_retained
        # Material that enters the contact has the share of rest.
        enters = np.ones(pressure.shape, bool)
        enters[:-1] = pressure[1:] <= 0.0
        return share, by_speed, np.where(enters, 0.0, retained)

    def _retained_share(
        self, size: np.ndarray, distance: float, second: bool
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the fraction of mu/mu(0) retained over a distance, mm, and its slip derivative."""
        time = distance / self.speed
        slides = self.speed * size > self.background
        slid = time * np.maximum(self.speed * size, self.background) / self.memory
        retained = np.exp(-slid) if second else 1.0 / (1.0 + slid)
        by_slid = -retained if second else -(retained**2)
        return retained, np.where(slides, by_slid * time / self.memory, 0.0)

    def _factor(self, x: np.ndarray, y: np.ndarray) -> np.ndarray | float:
        """Return the factor on friction due to temperature and lateral position, or 1."""
        factor = 1.0 if self.warmth is None else self.warmth.at(x, y)
        return factor if self.lateral is None else factor * self.lateral.at(y)

    def _capped(
        self, pressure: np.ndarray, share: np.ndarray, factor: np.ndarray | float
    ) -> tuple[Bound, np.ndarray]:
        """Return the bound for a ratio mu/mu(0), limited by the strength, and d(bound)/d(ratio)."""
        limit, share = self.strength / max(self.mu), factor * share
        radius = share * pressure
        weak = radius < limit
        bound = Bound(np.minimum(radius, limit), np.where(weak, share, 0.0))
        return bound, np.where(weak, factor * pressure, 0.0)


@dataclass(frozen=True)
class FallingCoulombInStep(FallingCoulomb):
    """Falling friction law in a step of a transient: with a factor, and a memory of steps before.

    Parameters
    ----------
    factor : float
        Factor on the coefficients, not on the strength.
    past : PreviousShare, optional
        Shares of the particles before the step.
    """

    factor: float = 1.0
    past: PreviousShare | None = None

    def weakened(self, factor: float) -> "FallingCoulombInStep":
        """Return the law with its friction coefficients, not its strength, times a factor."""
        return replace(self, factor=factor * self.factor)

    def with_previous(self, past: PreviousShare) -> "FallingCoulombInStep":
        """Return the law for a step of a transient, with a memory of the friction before it."""
        return replace(self, past=past)

    def _with_memory(
        self,
        pressure: np.ndarray,
        size: np.ndarray,
        target: np.ndarray,
        by_speed: np.ndarray,
        x: np.ndarray,
        y: np.ndarray,
        second: bool,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return mu/mu(0) with a memory of the steps before, and its derivatives.

        Each particle continues from its share before the step.
        """
        past = self.past
        if past is None:
            return super()._with_memory(pressure, size, target, by_speed, x, y, second)
        retained, by_retained = self._retained_share(size, past.distance, second)
        before = past.share
        if before.shape != pressure.shape:
            before = _interpolate(before, (past.x, past.y), (x, y))
        by_speed = (1.0 - retained) * by_speed + (before - target) * by_retained
        share = retained * before + (1.0 - retained) * target
        return share, by_speed, np.zeros_like(share)

    def _capped(
        self, pressure: np.ndarray, share: np.ndarray, factor: np.ndarray | float
    ) -> tuple[Bound, np.ndarray]:
        """Return the bound for mu/mu(0) times the factor of the step, and d(bound)/d(ratio)."""
        return super()._capped(pressure, share, self.factor * factor)
