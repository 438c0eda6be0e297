"""Orthotropic Archard wear, from pressure and slip (the paper) and from frictional work."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from tractive_sam.description import ShortArrays
from tractive_sam.kernels import wear
from tractive_sam.mechanics.falling import FallingCoulomb
from tractive_sam.mechanics.frame import Frame
from tractive_sam.mechanics.friction import FrictionLaw
from tractive_sam.mechanics.law import Law


@dataclass(frozen=True, eq=False, repr=False)
class WearConditions(ShortArrays):
    """Wear depth, revolution and temperature before a pass, for wear laws that depend on them.

    Attributes
    ----------
    depth : ndarray, shape (n_y,) or (n_x, n_y)
        Wear depth of both bodies together before the pass, mm: of the material that enters the
        contact, or in a transient of the material in every element.
    revolution : float
        Number of the revolution as in `wear.revolutions`; nan in a transient.
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

    def with_friction(self, friction: FrictionLaw) -> "WearLaw":
        """Return the law that uses another friction law; by default this law."""
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
        return wear.sweep_wear(entering, self.rate(pressure, traction, slip), dx)


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


@dataclass(frozen=True)
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
    friction : FallingCoulomb, optional
        Falling friction: with lower friction an equal work needs a longer sliding distance.
    length : float
        Length of an element along x, mm, over which a memory of friction fades; 0: without memory.
    """

    intensity: tuple[float, float]
    mu: tuple[float, float]
    angle: float
    friction: FallingCoulomb | None = None
    length: float = 0.0

    def rate(self, pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Return the wear depth per rolling distance of both bodies; negative work counts as 0."""
        along, across = work_along_axes(traction, slip, self.angle)
        work = np.maximum(along + across, 0.0)
        first, second = (i / mu for i, mu in zip(self.intensity, self.mu, strict=True))
        squared = work * (first**2 * along + second**2 * across)
        # Negative work along one axis must not leave the bounds of positive work along both.
        lower, upper = sorted((first, second))
        rate = np.sqrt(np.clip(squared, (lower * work) ** 2, (upper * work) ** 2))
        if self.friction is None:
            return rate
        return rate / self.friction.friction_factor(pressure, slip, self.length)

    def weakened(self, factor: float) -> "ArchardByWork":
        """Return the law for friction times a factor: less friction, longer sliding per work."""
        if self.friction is not None:
            return replace(self, friction=self.friction.weakened(factor))
        return replace(self, mu=(factor * self.mu[0], factor * self.mu[1]))

    def with_friction(self, friction: FrictionLaw) -> "ArchardByWork":
        """Return the law with another falling friction law; this law if it does not use one."""
        if self.friction is None or not isinstance(friction, FallingCoulomb):
            return self
        return replace(self, friction=friction)
