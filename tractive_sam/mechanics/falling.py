"""Friction that answers to sliding speed, temperature and strength.

The coefficients are those at rest times a share, the same along both tribological axes, and the
traction is never above a strength:

    ||p_t||_mu <= min(share(V |s|) factor(T) p_n, strength / max(mu1, mu2)).

The speed of sliding is taken where the traction is, at the centre of an element. The share may have
a memory: as a particle slides, it tends to that of the speed over a distance slid (Vollebregt &
Schuttelaars 2012, J. Sound Vib. 331, 2141-2155),

    d(share)/dt = -(max(V |s|, s0) / d_c) (share - share(V |s|)),

which along the way through the contact is a sweep from the leading edge, where it is one.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace

import numpy as np

from tractive_sam.kernels import friction
from tractive_sam.mechanics.friction import Bound, Coulomb, PreviousShare, Slope

BACKGROUND = 1.0
"""s0, mm/s: speed at which a memory fades where nothing slides."""


class SlidingShare(ABC):
    """How friction falls with the speed of sliding: its share of that at rest, one at zero speed.

    Examples
    --------
    >>> class Lost(ts.SlidingShare):
    ...     def at(self, speed):
    ...         return 1.0 / (1.0 + speed / 500.0) ** 2, -2.0 / 500.0 / (1.0 + speed / 500.0) ** 3
    ...
    ...     @property
    ...     def least(self):
    ...         return 0.0
    >>> fast = scene.replace(**{"creepage.speed": 2000.0})
    >>> law = ts.FallingCoulomb(mu=(0.4, 0.4), sliding=Lost(), speed=2000.0)
    >>> ts.solve(fast, laws=ts.Laws.of(fast).replace(friction=law)).Qx < contact.Qx
    True
    """

    @abstractmethod
    def at(self, speed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Share and its derivative, s/mm.

        Parameters
        ----------
        speed : ndarray
            Of sliding, mm/s, not negative.
        """

    @property
    @abstractmethod
    def least(self) -> float:
        """Its limit at great speed."""


@dataclass(frozen=True)
class Exponential(SlidingShare):
    """kinetic + (1 - kinetic) exp(-ln 2 speed / half_speed).

    With kinetic = A and half_speed = ln 2 / B it is Polach's law, mu_0 ((1 - A) exp(-B w) + A)
    (2005, Wear 258, 992-1000), here of the local speed.

    Parameters
    ----------
    kinetic : float
        Share that is left at great speed.
    half_speed : float
        Speed at which half of the way is gone, mm/s.
    """

    kinetic: float
    half_speed: float

    def at(self, speed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """See `SlidingShare.at`."""
        rate = np.log(2.0) / self.half_speed
        fall = (1.0 - self.kinetic) * np.exp(-rate * speed)
        return self.kinetic + fall, -rate * fall

    @property
    def least(self) -> float:
        """See `SlidingShare.least`."""
        return self.kinetic


@dataclass(frozen=True)
class Rational(SlidingShare):
    """kinetic + (1 - kinetic) / (1 + speed / half_speed); parameters as of `Exponential`."""

    kinetic: float
    half_speed: float

    def at(self, speed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """See `SlidingShare.at`."""
        whole = 1.0 + speed / self.half_speed
        fall = (1.0 - self.kinetic) / whole
        return self.kinetic + fall, -fall / (whole * self.half_speed)

    @property
    def least(self) -> float:
        """See `SlidingShare.least`."""
        return self.kinetic


@dataclass(frozen=True, eq=False)
class Warmth:
    """Factor on the coefficients by the temperature, on the elements of a mesh.

    Attributes
    ----------
    x, y : ndarray, shapes (n_x,) and (n_y,)
        Centres of the elements, mm.
    factor : ndarray, shape (n_x, n_y)
        Factor in them.
    """

    x: np.ndarray
    y: np.ndarray
    factor: np.ndarray

    def at(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Factor on a part of the mesh, or on elements made of several; linear between centres.

        Parameters
        ----------
        x, y : ndarray, shapes (m, 1) and (1, n)
            Centres of the elements, mm.
        """
        return _interpolated(self.factor, (self.x, self.y), (x, y))


def _interpolated(
    values: np.ndarray, known: tuple[np.ndarray, ...], wanted: tuple[np.ndarray, ...]
) -> np.ndarray:
    """Interpolate a field of elements at others, bilinear between centres."""
    along, across = (_weights(a, b.ravel()) for a, b in zip(known, wanted, strict=True))
    return along @ values @ across.T


def _weights(known: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Linear interpolation between ascending points, constant beyond, as a matrix."""
    if len(known) == 1:
        return np.ones((len(wanted), 1))
    place = np.interp(wanted, known, np.arange(len(known)))
    first = np.minimum(place.astype(int), len(known) - 2)
    rows, part = np.arange(len(wanted)), place - first
    matrix = np.zeros((len(wanted), len(known)))
    matrix[rows, first], matrix[rows, first + 1] = 1.0 - part, part
    return matrix


@dataclass(frozen=True)
class FallingCoulomb(Coulomb):
    """Coulomb friction with coefficients that fall with sliding speed, and a strength.

    Parameters
    ----------
    mu, angle
        As of `Coulomb`, at rest.
    sliding : SlidingShare, optional
        How it falls with the speed of sliding.
    speed : float
        Of rolling, V, mm/s.
    memory : float
        Distance d_c slid over which the coefficients follow the speed, mm.
    strength : float
        Largest traction, MPa.
    warmth : Warmth, optional
        Factor by the temperature.

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
    warmth: Warmth | None = None

    @property
    def falls(self) -> bool:
        """See `FrictionLaw.falls`."""
        return self.sliding is not None and 0.0 < self.speed < np.inf

    def eased(self, speed: float) -> "FallingCoulomb":
        """See `FrictionLaw.eased`; of infinite speed it is constant, what is left there."""
        return replace(self, speed=speed * self.speed)

    def weakened(self, factor: float) -> "FallingCoulomb":
        """See `FrictionLaw.weakened`: the coefficients fall, the strength does not."""
        return self if factor == 1.0 else FallingInStep(**vars(self), factor=factor)

    def with_previous(self, past: PreviousShare) -> "FallingCoulomb":
        """See `FrictionLaw.with_previous`.

        Raises
        ------
        ValueError
            If a strength hides what is left of the coefficients.
        """
        if self.memory > 0.0 and self.strength < np.inf:
            raise ValueError("FallingCoulomb: a memory goes without a strength in a transient")
        return FallingInStep(**vars(self), past=past) if self.memory > 0.0 else self

    def bound(self, pressure: np.ndarray, x: np.ndarray, y: np.ndarray) -> Bound:
        """See `FrictionLaw.bound`."""
        lost = self.sliding is not None and np.isinf(self.speed)
        share = self.sliding.least if lost else 1.0
        return self._capped(pressure, np.full_like(pressure, share), self._factor(x, y))[0]

    def bound_sliding(
        self, pressure: np.ndarray, slip: np.ndarray, x: np.ndarray, y: np.ndarray, second: bool
    ) -> Bound:
        """See `FrictionLaw.bound_sliding`."""
        size = np.hypot(*slip)
        share, by_speed = self.sliding.at(self.speed * size)
        if not (share >= 0.0).all():
            wrong = ~(share >= 0.0)
            raise ValueError(
                f"{type(self.sliding).__name__}.at: a share of {share[wrong][0]:g} of friction at "
                f"{(self.speed * size)[wrong][0]:g} mm/s; it must be a number of at least 0"
            )
        kept = np.zeros_like(share)
        if self.memory > 0.0:
            share, by_speed, kept = self._remembered(pressure, size, share, by_speed, x, y, second)
        bound, by_share = self._capped(pressure, share, self._factor(x, y))
        along = slip / np.where(size > 0.0, size, 1.0)
        return replace(bound, slope=Slope(by_share, self.speed * by_speed * along, kept))

    def by_mu(self, bound: Bound, axis: int) -> np.ndarray:
        """Derivative of a bound by a coefficient at rest, under the same pressure and slip.

        Only the strength is over a coefficient, the larger one (`Frame.largest_by`).

        Parameters
        ----------
        bound : Bound
            That of `bound` or `bound_sliding`.
        axis : int
            0 or 1.
        """
        capped = (bound.radius > 0.0) & (bound.by_pressure == 0.0)
        return np.where(capped, -self.frame.largest_by(axis) * bound.radius, 0.0)

    def left(self, pressure: np.ndarray, slip: np.ndarray, length: float) -> np.ndarray:
        """What is left of the coefficients under a slip, shape (n_x, n_y).

        Parameters
        ----------
        pressure, slip : ndarray
            As for `bound_sliding`.
        length : float
            Of an element along x, mm, over which a memory fades; 0: as if there were none.
        """
        share = np.ones_like(pressure)
        if self.sliding is not None:
            size = np.hypot(*slip)
            share, by_speed = self.sliding.at(self.speed * size)
            if self.memory > 0.0 and length > 0.0:
                x, y = np.array([[0.0], [length]]), np.zeros((1, 1))
                share = self._remembered(pressure, size, share, by_speed, x, y, second=True)[0]
        factor = 1.0 if self.warmth is None else self.warmth.factor
        radius = self._capped(pressure, share, factor)[0].radius
        return np.divide(radius, pressure, out=share, where=pressure > 0.0)

    def _remembered(self, pressure, size, target, by_speed, x, y, second):
        """Share with memory, its derivative by the speed, and what is kept of that ahead.

        To second order the share kept while an element is crossed is that of a constant speed,
        exp(-slid/d_c); to first order, that of an implicit step.
        """
        kept, by_kept = self._kept(size, float(x[1, 0] - x[0, 0]) if len(x) > 1 else 0.0, second)
        share, ahead = np.empty_like(target), np.empty_like(target)
        friction.remember(target, kept, pressure, ahead, share)
        by_speed = (1.0 - kept) * by_speed + (ahead - target) * by_kept
        # What enters the contact has the share of rest, whatever happens.
        enters = np.ones(pressure.shape, bool)
        enters[:-1] = pressure[1:] <= 0.0
        return share, by_speed, np.where(enters, 0.0, kept)

    def _kept(
        self, size: np.ndarray, distance: float, second: bool
    ) -> tuple[np.ndarray, np.ndarray]:
        """Part of a share kept over a distance rolled, mm, and its derivative by the speed."""
        time = distance / self.speed
        slides = self.speed * size > BACKGROUND
        slid = time * np.maximum(self.speed * size, BACKGROUND) / self.memory
        kept = np.exp(-slid) if second else 1.0 / (1.0 + slid)
        by_slid = -kept if second else -(kept**2)
        return kept, np.where(slides, by_slid * time / self.memory, 0.0)

    def _factor(self, x: np.ndarray, y: np.ndarray) -> np.ndarray | float:
        return 1.0 if self.warmth is None else self.warmth.at(x, y)

    def _capped(
        self, pressure: np.ndarray, share: np.ndarray, factor: np.ndarray | float
    ) -> tuple[Bound, np.ndarray]:
        """The bound of a share and a factor, and its derivative by the share."""
        most, share = self.strength / max(self.mu), factor * share
        radius = share * pressure
        weak = radius < most
        bound = Bound(np.minimum(radius, most), np.where(weak, share, 0.0))
        return bound, np.where(weak, factor * pressure, 0.0)


@dataclass(frozen=True)
class FallingInStep(FallingCoulomb):
    """The law in a step of a transient.

    Parameters
    ----------
    factor : float
        Factor on the coefficients; the strength remains.
    past : PreviousShare, optional
        What particles have kept of the shares before the step.
    """

    factor: float = 1.0
    past: PreviousShare | None = None

    def weakened(self, factor: float) -> "FallingInStep":
        """See `FallingCoulomb.weakened`."""
        return replace(self, factor=factor * self.factor)

    def with_previous(self, past: PreviousShare) -> "FallingInStep":
        """See `FallingCoulomb.with_previous`."""
        return replace(self, past=past)

    def left(self, pressure: np.ndarray, slip: np.ndarray, length: float) -> np.ndarray:
        """See `FallingCoulomb.left`; over the way of the step, if particles have a past."""
        return super().left(pressure, slip, length if self.past is None else self.past.distance)

    def _remembered(self, pressure, size, target, by_speed, x, y, second):
        """See `FallingCoulomb`; each particle has a past, whatever is ahead of it."""
        past = self.past
        if past is None:
            return super()._remembered(pressure, size, target, by_speed, x, y, second)
        kept, by_kept = self._kept(size, past.distance, second)
        before = past.share
        if before.shape != pressure.shape:
            before = _interpolated(before, (past.x, past.y), (x, y))
        by_speed = (1.0 - kept) * by_speed + (before - target) * by_kept
        share = kept * before + (1.0 - kept) * target
        return share, by_speed, np.zeros_like(share)

    def _capped(
        self, pressure: np.ndarray, share: np.ndarray, factor: np.ndarray | float
    ) -> tuple[Bound, np.ndarray]:
        """See `FallingCoulomb`."""
        return super()._capped(pressure, share, self.factor * factor)
