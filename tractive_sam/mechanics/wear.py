"""Orthotropic Holm-Archard wear, as the paper has it and by the work that friction does."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from tractive_sam.kernels import wear
from tractive_sam.mechanics.falling import FallingCoulomb
from tractive_sam.mechanics.frame import Frame
from tractive_sam.mechanics.friction import FrictionLaw
from tractive_sam.mechanics.law import Law


@dataclass(frozen=True, eq=False)
class WearConditions:
    """What a contact has gone through before a pass, for laws of wear that depend on it.

    Attributes
    ----------
    depth : ndarray, shape (n_y,) or (n_x, n_y)
        Depth worn off both bodies together before the pass, mm: of the material that enters the
        contact; in a transient of the material in every element.
    revolution : float
        Number of the revolution, see `wear.revolutions`; nan in a transient.
    temperature : ndarray, shape (n_x, n_y), or None
        Temperature of the surfaces in contact, degrees C; None without [heat].

    Examples
    --------
    >>> ts.WearConditions(depth=np.zeros(3), revolution=1.0).temperature is None
    True
    """

    depth: np.ndarray
    revolution: float
    temperature: np.ndarray | None = None


class WearLaw(Law, ABC):
    """How deep the contact wears in one pass.

    Examples
    --------
    >>> class ByWork(ts.WearLaw):
    ...     def rate(self, pressure, traction, slip):
    ...         return 5e-6 * np.abs((traction * slip).sum(axis=0))
    >>> history = ts.roll(discs, laws=ts.Laws.of(discs).replace(wear=ByWork()))
    >>> bool(history["wear_max"][-1] > 0.0)
    True
    """

    @abstractmethod
    def rate(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Depth worn per distance rolled off both bodies together, dimensionless.

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
        """How `rate` grows with the pressure, 1/MPa, traction in proportion; arguments as there.

        By default that of a law in proportion to them.
        """
        touching = pressure > 0.0
        share = traction / np.where(touching, pressure, 1.0)
        return self.rate(np.where(touching, 1.0, 0.0), share, slip)

    def shares(
        self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray
    ) -> np.ndarray | None:
        """Shares of A and B in the depth of a pass, shape (2, n_y); arguments as of `rate`.

        By default None: as the scene says, by hardness or coefficients, the same everywhere.
        """
        return None

    def rates(
        self,
        share: Mapping[str, float],
        pressure: np.ndarray,
        traction: np.ndarray,
        slip: np.ndarray,
    ) -> np.ndarray:
        """`rate` of A and of B, shape (2, n_x, n_y); other arguments as there.

        Parameters
        ----------
        share : mapping of str to float
            Part of each body in the depth, where the law has no `shares`.
        """
        own = self.shares(pressure, traction, slip)
        parts = np.array([[share[body]] for body in "AB"]) if own is None else own
        return parts[:, None, :] * self.rate(pressure, traction, slip)

    def on(self, element_area: float) -> "WearLaw":
        """The law on a mesh of elements of this area, mm²; by default no other one."""
        return self

    def weakened(self, factor: float) -> "WearLaw":
        """The law where friction is so many times what it was; by default no other one."""
        return self

    def with_friction(self, friction: FrictionLaw) -> "WearLaw":
        """Return the law where friction follows another law; by default no other one."""
        return self

    def under(self, conditions: WearConditions) -> "WearLaw":
        """Return the law under conditions, such as after running-in; by default the same law.

        The law is to depend on the conditions smoothly: adaptive stepping extrapolates its rate.
        """
        return self

    def beyond_tests(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> str:
        """What of a contact its coefficients were not measured for; empty where nothing is."""
        return ""

    def depth(
        self,
        entering: np.ndarray,
        pressure: np.ndarray,
        traction: np.ndarray,
        slip: np.ndarray,
        dx: float,
    ) -> np.ndarray:
        """Depth below every element during one pass (paper, eq. 32), mm.

        Parameters
        ----------
        entering : ndarray, shape (n_y,)
            Depth left by the previous revolution, mm.
        pressure, traction, slip : ndarray
            As for `rate`.
        dx : float
            Side of an element in the rolling direction, mm.
        """
        return wear.sweep(entering, self.rate(pressure, traction, slip), dx)


@dataclass(frozen=True)
class Archard(WearLaw):
    """Depth worn per sliding distance, p_n |s|_i (paper, eq. 16), to the letter.

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
        """See `WearLaw.rate`; the traction does not matter."""
        return pressure * Frame(self.intensity, self.angle).dual_norm(slip)


@dataclass(frozen=True, eq=False)
class Warmed(WearLaw):
    """A law of wear on surfaces at some temperature: its depth counts by a factor.

    Parameters
    ----------
    law : WearLaw
        The law as it is without.
    factor : ndarray, shape (n_x, n_y)
        What the temperature makes of its rate.
    """

    law: WearLaw
    factor: np.ndarray

    def rate(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """See `WearLaw.rate`."""
        return self.factor * self.law.rate(pressure, traction, slip)

    def per_load(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """See `WearLaw.per_load`."""
        return self.factor * self.law.per_load(pressure, traction, slip)

    def shares(
        self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray
    ) -> np.ndarray | None:
        """See `WearLaw.shares`."""
        return self.law.shares(pressure, traction, slip)


def work_along(
    traction: np.ndarray, slip: np.ndarray, angle: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Frictional work per distance rolled and area along either tribological axis, MPa."""
    axes = Frame(angle=angle).matrix
    along, across = -np.tensordot(axes, traction, axes=1) * np.tensordot(axes, slip, axes=1)
    return along, across


def work_of(traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
    """All of it, MPa; zero where it is negative, as it is in a few elements."""
    along, across = work_along(traction, slip)
    return np.maximum(along + across, 0.0)


@dataclass(frozen=True)
class Energy(WearLaw):
    """Depth by the frictional work w_k = -p_k s_k along either tribological axis.

    The depth is k1 w_1 + k2 w_2: it depends on the work alone and is additive, so that work done
    along one axis after the other wears as much as both at once, and what a contact wears follows
    from its total work along each axis. With k1 = k2 the axes do not matter. `ArchardByWork` has a
    norm of the slip instead: with i_j = k_j mu_j it wears as much where slip is along an axis or
    k1 = k2, and more elsewhere.

    Parameters
    ----------
    per_work : tuple of float
        Depth worn over work per area, (k1, k2) along the tribological axes, 1/MPa: 1e-3 times the
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
        """See `WearLaw.rate`; zero where the work is negative, as it is in a few elements."""
        along, across = work_along(traction, slip, self.angle)
        work = np.maximum(along + across, 0.0)
        first, second = self.per_work
        # Negative work along one axis must not leave the bounds of positive work along both.
        least, most = sorted(self.per_work)
        return np.clip(first * along + second * across, least * work, most * work)


@dataclass(frozen=True)
class ArchardByWork(WearLaw):
    """Archard's law by the frictional work w_k = -p_k s_k along either tribological axis.

    Where an element slips, p_k = -p_n mu_k^2 s_k/||s||*_mu, and with it p_n |s|_i is

        sqrt((w_1 + w_2) ((i1/mu1)^2 w_1 + (i2/mu2)^2 w_2)).

    Where it sticks beside one that slips, it shows slip of that one (`State.slip`) but carries
    less than the bound: by its pressure it would wear many times too much where only a narrow edge
    slips, by its work it does not. With i1/mu1 = i2/mu2 the contact wears that times its
    frictional work, on any mesh; otherwise between the smaller and the larger of them.

    Parameters
    ----------
    intensity, mu : tuple of float
        Wear intensities (i1, i2), 1/MPa, and friction coefficients (mu1, mu2) along the
        tribological axes.
    angle : float
        Angle beta of the first axis, counter-clockwise from x, radians.
    friction : FallingCoulomb, optional
        Friction that falls: where less is left of it, the same work takes a longer way.
    length : float
        Of an element along x, mm, over which a memory of that friction fades; 0: without memory.
    """

    intensity: tuple[float, float]
    mu: tuple[float, float]
    angle: float
    friction: FallingCoulomb | None = None
    length: float = 0.0

    def rate(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """See `WearLaw.rate`; zero where the work is negative, as it is in a few elements."""
        along, across = work_along(traction, slip, self.angle)
        work = np.maximum(along + across, 0.0)
        first, second = (i / mu for i, mu in zip(self.intensity, self.mu, strict=True))
        squared = work * (first**2 * along + second**2 * across)
        # Negative work along one axis must not leave the bounds of positive work along both.
        least, most = sorted((first, second))
        rate = np.sqrt(np.clip(squared, (least * work) ** 2, (most * work) ** 2))
        if self.friction is None:
            return rate
        return rate / self.friction.left(pressure, slip, self.length)

    def weakened(self, factor: float) -> "ArchardByWork":
        """See `WearLaw.weakened`: the same work takes a longer way."""
        if self.friction is not None:
            return replace(self, friction=self.friction.weakened(factor))
        return replace(self, mu=(factor * self.mu[0], factor * self.mu[1]))

    def with_friction(self, friction: FrictionLaw) -> "ArchardByWork":
        """See `WearLaw.with_friction`."""
        falls = self.friction is not None and isinstance(friction, FallingCoulomb)
        return replace(self, friction=friction) if falls else self
