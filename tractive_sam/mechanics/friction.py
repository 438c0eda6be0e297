"""Friction laws: the traction bound of an element, and its linearisation for Newton's method.

In the scaled frame (`mechanics.frame`) the traction lies in a disc, and opposes the slip if it is
on the edge of the disc. Laws differ in the **bound**, the radius of the disc: for Coulomb's law it
is the pressure. A user-defined law is a subclass of `FrictionLaw` with another `bound`; if the
bound depends on the slip, the subclass defines `bound_sliding` as well.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from tractive_sam.compute import backend_of
from tractive_sam.description import ShortArrays
from tractive_sam.kernels import friction
from tractive_sam.lazy_names import accept_renamed_methods, renamed_attributes
from tractive_sam.mechanics.frame import Frame
from tractive_sam.mechanics.law import Law

Pair = tuple[float, float]


@dataclass(frozen=True, eq=False, repr=False)
class Bound(ShortArrays):
    """Traction bound: largest size of the scaled traction of each element.

    Attributes
    ----------
    radius : ndarray, shape (n_x, n_y)
        Radius of the disc, in the unit of the pressure: ||p_t||_mu <= radius (`Frame.norm`).
        Zero without pressure.
    by_pressure : ndarray or float
        Derivative of the radius by the pressure.
    slope : Slope, optional
        Derivative of the radius by the slip, if it depends on the slip.

    Examples
    --------
    >>> pressure = np.array([[100.0, 300.0]])
    >>> ts.Bound(radius=0.5 * pressure, by_pressure=0.5).radius
    array([[ 50., 150.]])
    """

    radius: np.ndarray
    by_pressure: np.ndarray | float
    slope: "Slope | None" = None


@dataclass(frozen=True, eq=False, repr=False)
class Slope(ShortArrays):
    """Derivative of a traction bound by the slip at the centres of the elements.

    The bound is a factor, the share, times the bound at rest. With a memory the share of an element
    also depends on the share of the element ahead, from which the material comes.

    Attributes
    ----------
    by_share : ndarray, shape (n_x, n_y)
        Derivative of the radius by the share.
    by_slip : ndarray, shape (2, n_x, n_y)
        Derivative of the share by the slip of the element.
    kept : ndarray, shape (n_x, n_y)
        Derivative of the share by the share of the element ahead; zero without memory.
    by_temperature_factor : ndarray, shape (n_x, n_y), optional
        Derivative of the share by a relative change of the temperature factor, to which a memory
        adapts; None if the share does not depend on it.

    Examples
    --------
    >>> none = np.zeros((1, 1))
    >>> slope = ts.Slope(by_share=none + 300.0, by_slip=np.full((2, 1, 1), -2.0), kept=none)
    >>> slope.change(np.full((2, 1, 1), 1e-3))  # MPa, for a slip larger by 1e-3 in x and y
    array([[-1.2]])
    """

    by_share: np.ndarray
    by_slip: np.ndarray
    kept: np.ndarray
    by_temperature_factor: np.ndarray | None = None

    def change(self, slip: np.ndarray) -> np.ndarray:
        """Return the change of the bound by that of slip at centres, with memory along x."""
        out = np.empty_like(self.by_share)
        friction.change_of_bound(self.by_share, self.by_slip, self.kept, slip, out)
        return out

    @property
    def steepness(self) -> np.ndarray:
        """Magnitude of the derivative of the bound by the slip of the same element, (n_x, n_y)."""
        return self.by_share * np.hypot(*self.by_slip)


@dataclass(frozen=True, eq=False)
class PreviousShare:
    """Ratios mu/mu(0) of surface particles before a step of a transient, at the elements after it.

    Attributes
    ----------
    x, y : ndarray, shapes (n_x,) and (n_y,)
        Centres of the elements, mm.
    share : ndarray, shape (n_x, n_y)
        Bound before the step over the bound at rest, at equal pressure; 1 for new contact.
    distance : float
        Rolling distance of the step, mm.
    """

    x: np.ndarray
    y: np.ndarray
    share: np.ndarray
    distance: float


@renamed_attributes(eased="at_speed_ratio", opposed="opposed_slip", centred="slip_at_centres")
class FrictionLaw(Law, ABC):
    """Base class of friction laws; a subclass defines the `frame` and the traction `bound`.

    Examples
    --------
    >>> import dataclasses
    >>> @dataclasses.dataclass(frozen=True)
    ... class Capped(ts.Coulomb):
    ...     strength: float = 100.0  # MPa
    ...
    ...     def bound(self, pressure, x, y):
    ...         limit = self.strength / max(self.mu)
    ...         return ts.Bound(np.minimum(pressure, limit), np.where(pressure < limit, 1.0, 0.0))
    >>> bound = Capped(mu=(0.5, 0.5)).bound(np.array([[100.0, 300.0]]), 0.0, 0.0)
    >>> bound.radius
    array([[100., 200.]])
    """

    def __init_subclass__(cls, **kwargs: Any) -> None:
        """Accept methods of a subclass under their former names, with a warning."""
        super().__init_subclass__(**kwargs)
        accept_renamed_methods(cls, {"eased": "at_speed_ratio"})

    @property
    @abstractmethod
    def frame(self) -> Frame:
        """Frame in which the friction law is isotropic."""

    @abstractmethod
    def bound(self, pressure: np.ndarray, x: np.ndarray, y: np.ndarray) -> Bound:
        """Return the bound of the scaled traction, the radius of a disc, and its slope by pressure.

        Parameters
        ----------
        pressure : ndarray, shape (n_x, n_y)
            p_n >= 0, MPa.
        x, y : ndarray, shapes (n_x, 1) and (1, n_y)
            Centres of the elements, mm.
        """

    @property
    def falls(self) -> bool:
        """Whether the bound depends on the slip; then `bound` gives the largest one, at rest."""
        return False

    def bound_sliding(
        self, pressure: np.ndarray, slip: np.ndarray, x: np.ndarray, y: np.ndarray, second: bool
    ) -> Bound:
        """Return the bound under a slip, with its `Slope`; by default the bound at rest.

        Parameters
        ----------
        pressure, x, y : ndarray
            See `bound`.
        slip : ndarray, shape (2, n_x, n_y)
            s/V at the centres of the elements.
        second : bool
            Whether the discretisation of the slip is of second order.
        """
        return self.bound(pressure, x, y)

    def at_speed_ratio(self, ratio: float) -> "FrictionLaw":
        """Return the law at `ratio` times the rolling speed, 0: static; default: this law."""
        return self

    def on_rows(self, y: np.ndarray, place: np.ndarray) -> "FrictionLaw":
        """Return the law for a mesh; by default this law.

        Parameters
        ----------
        y : ndarray, shape (n_y,)
            Rows of the mesh, mm, as `bound` has them.
        place : ndarray, shape (n_y,)
            Their lateral positions, mm, where friction is described: on a rail those in the track.
        """
        return self

    def weakened(self, factor: float) -> "FrictionLaw":
        """Return the law with friction times a factor; by default its bound is multiplied."""
        return self if factor == 1.0 else ScaledFriction(self, factor)

    def with_previous(self, past: "PreviousShare") -> "FrictionLaw":
        """Return the law for a step of a transient, with its past friction; default: this law."""
        return self

    def friction_factor(
        self, pressure: np.ndarray, slip: np.ndarray, x: np.ndarray, y: np.ndarray
    ) -> np.ndarray:
        """Return friction under a slip over that by the coefficients of the frame, (n_x, n_y).

        Wear laws by the work of friction need it: with less friction, an equal work is a longer
        distance of sliding.

        Parameters
        ----------
        pressure, slip, x, y : ndarray
            See `bound_sliding`.
        """
        if self.falls:
            radius = self.bound_sliding(pressure, slip, x, y, second=True).radius
        else:
            radius = self.bound(pressure, x, y).radius
        factor = np.ones_like(pressure)
        return np.divide(radius, pressure, out=factor, where=(pressure > 0.0) & (radius > 0.0))

    def project(
        self, traction: np.ndarray, radius: np.ndarray, physical: bool = False
    ) -> np.ndarray:
        """Return the scaled traction within the bound that is nearest to the given traction.

        Parameters
        ----------
        traction : ndarray, shape (2, n_x, n_y)
            Scaled tractions.
        radius : ndarray, shape (n_x, n_y)
            Bound.
        physical : bool
            Whether distances belong to unscaled tractions. Scaling stretches the weaker axis:
            scaled steps are too long if mu1 and mu2 differ much.
        """
        if not physical:
            return backend_of(traction).project(traction, radius)
        out = np.empty_like(traction)
        friction.project(traction, radius, out, *self.frame.weights)
        return out

    @staticmethod
    def opposed_slip(slip: np.ndarray, contact: np.ndarray, staggered: float) -> np.ndarray:
        """Return the slip of leading faces turned towards that at centres; tractions oppose it.

        Parameters
        ----------
        slip : ndarray, shape (2, n_x, n_y)
            Slip of the leading faces.
        contact : ndarray, shape (n_x, n_y)
            Positive in contact.
        staggered : float
            Part of the rotation towards the slip at the centre; 0: no rotation
            (`kernels.friction.turn`).
        """
        return backend_of(slip).turn(slip, contact, float(staggered)) if staggered else slip

    @staticmethod
    def slip_at_centres(slip: np.ndarray, contact: np.ndarray, staggered: float) -> np.ndarray:
        """Return slip at element centres from leading faces; unchanged if `staggered` is 0."""
        if not staggered:
            return slip
        out = np.empty_like(slip)
        friction.centre(slip, contact, out, float(staggered))
        return out

    def linearise(
        self,
        traction: np.ndarray,
        slip: np.ndarray,
        bound: Bound,
        contact: np.ndarray,
        staggered: float,
        active: np.ndarray | None = None,
        weight: float = 1.0,
        first: float = 1.0,
    ) -> "Linearisation":
        """Return the residual of the friction law at tractions and slips, and its derivative.

        Parameters
        ----------
        traction, slip : ndarray, shape (2, n_x, n_y)
            Scaled tractions, and slip of the leading faces (`operators.stencil`).
        bound : Bound
            The bound under this slip.
        contact : ndarray, shape (n_x, n_y)
            Positive in contact.
        staggered : float
            See `opposed_slip`.
        active : ndarray of bool, optional
            Elements that remain in contact after the next step; the traction of other elements is
            not changed by the slip.
        weight : float
            Relative weight of slip and traction residuals; the solution does not depend on it.
        first : float
            Weight of the first column in sums: 1/2 if an axis of symmetry halves it.
        """
        shape, staggered = bound.radius.shape, float(staggered)
        state, kappa = np.empty(shape, np.int8), np.empty(shape)
        direction, defect, across = (np.empty((*size, *shape)) for size in ((2,), (2,), (2, 2)))
        w0, w1 = self.frame.weights
        sums: tuple[float, float, float] = friction.linearise(
            *(traction, slip, bound.radius, contact, staggered, (weight * w0, weight * w1, first)),
            *(state, direction, kappa, across, defect),
        )
        if active is not None:
            state[~active] = friction.OPEN
            direction[:, ~active] = 0.0
        slope = None if bound.slope is None else SlipDependence(bound.slope, staggered)
        return Linearisation(
            state, direction, kappa, across, defect, contact, *sums, slope, staggered
        )


@dataclass(frozen=True, eq=False)
class ScaledFriction(FrictionLaw):
    """A friction law with its traction bound multiplied by a factor.

    A subclass may define `factors`, for a factor that depends on the pressure.

    Parameters
    ----------
    law : FrictionLaw
        The law without the factor.
    factor : float or ndarray, shape (n_x, n_y)
        Factor on its bound.

    Examples
    --------
    >>> law = ts.ScaledFriction(ts.Coulomb(mu=(0.5, 0.5)), 0.8)
    >>> law.bound(np.array([[100.0, 300.0]]), 0.0, 0.0).radius
    array([[ 80., 240.]])
    """

    law: FrictionLaw
    factor: float | np.ndarray = 1.0

    @property
    def frame(self) -> Frame:
        """Frame of the law that is multiplied."""
        return self.law.frame

    @property
    def falls(self) -> bool:
        """Whether the bound depends on the slip; then `bound` gives the largest one, at rest."""
        return self.law.falls

    def bound(self, pressure: np.ndarray, x: np.ndarray, y: np.ndarray) -> Bound:
        """Return the traction bound of the law at rest, times the factor (`FrictionLaw.bound`)."""
        return self._scaled(self.law.bound(pressure, x, y), pressure)

    def bound_sliding(
        self, pressure: np.ndarray, slip: np.ndarray, x: np.ndarray, y: np.ndarray, second: bool
    ) -> Bound:
        """Return the bound of the law under a slip, with its `Slope`, times the factor.

        Parameters as in `FrictionLaw.bound_sliding`.
        """
        return self._scaled(self.law.bound_sliding(pressure, slip, x, y, second), pressure)

    def on_rows(self, y: np.ndarray, place: np.ndarray) -> "ScaledFriction":
        """Return the law on a mesh, with its factor (`FrictionLaw.on_rows`)."""
        return replace(self, law=self.law.on_rows(y, place))

    def at_speed_ratio(self, ratio: float) -> "ScaledFriction":
        """Return the law with the rolling speed multiplied by `ratio`; 0 gives the static law."""
        return replace(self, law=self.law.at_speed_ratio(ratio))

    def factors(self, pressure: np.ndarray) -> tuple[float | np.ndarray, float | np.ndarray]:
        """Return the factor and its derivative by the pressure; by default `factor` and 0.

        Parameters
        ----------
        pressure : ndarray, shape (n_x, n_y)
            Contact pressure, MPa.
        """
        return self.factor, 0.0

    def _scaled(self, bound: Bound, pressure: np.ndarray) -> Bound:
        """Return a bound and its derivatives, multiplied by the factor at a pressure."""
        slope, (factor, change) = bound.slope, self.factors(pressure)
        if slope is not None:
            slope = replace(slope, by_share=factor * slope.by_share)
        by_pressure = factor * bound.by_pressure + change * bound.radius
        return Bound(factor * bound.radius, by_pressure, slope)


@dataclass(frozen=True)
class Coulomb(FrictionLaw):
    """Orthotropic Coulomb friction: ||p_t||_mu <= p_n (paper, eqs. 8-10).

    Parameters
    ----------
    mu : tuple of float
        Friction coefficients (mu1, mu2) along the tribological axes.
    angle : float
        Angle beta of the first axis, counter-clockwise from x, radians.

    Examples
    --------
    >>> float(ts.Coulomb(mu=(0.6, 0.3)).frame.norm(np.array([60.0, 0.0])))
    100.0
    """

    mu: Pair = (1.0, 1.0)
    angle: float = 0.0

    @cached_property
    def frame(self) -> Frame:
        """Axes rotated by `angle` and scaled by mu1 and mu2, in which the bound is a disc."""
        return Frame(self.mu, self.angle)

    def bound(self, pressure: np.ndarray, x: np.ndarray, y: np.ndarray) -> Bound:
        """Return the bound of the scaled traction: the pressure itself (`FrictionLaw.bound`)."""
        return Bound(pressure, 1.0)


Map = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True, eq=False)
class Linearisation:
    """A friction law linearised at a state, element by element; vectors in the scaled frame.

    An element is open, sticks or slips. The equations of Newton's method are: the slip of a stick
    element is zero; the traction of an open element is zero. A slip element moves to the edge of
    the disc along n, the direction of its traction; along the tangent t its equation is
    kappa t.s + (1 - kappa) t.p, between slip (just at the bound) and traction (far beyond it, with
    only the direction unknown).

    Attributes
    ----------
    state : ndarray of int8, shape (n_x, n_y)
        `kernels.friction.OPEN`, `STICK` or `SLIP`.
    direction : ndarray, shape (2, n_x, n_y)
        n, the unit vector of disc(p - s) in slip elements, else zero.
    kappa : ndarray, shape (n_x, n_y)
        Share of the slip in the equation above.
    across : ndarray, shape (2, 2, n_x, n_y)
        Derivative of t.s by the slip at the leading face (first index 0) and at the centre (1).
    defect : ndarray, shape (2, n_x, n_y)
        disc(p - s) - p, along t scaled as the equation; in stick elements minus the slip.
    contact : ndarray, shape (n_x, n_y)
        Positive in contact.
    squares : float
        Sum of squares of disc(p - s) - p.
    merit : float
        Sum of squares with the weights of the frame, which Newton's steps reduce.
    reached : float
        Sum of squares of the tractions plus `defect`.
    falling : SlipDependence, optional
        For a bound that depends on the slip: the equation along n is n.p minus the change of the
        bound.
    staggered : float
        See `FrictionLaw.opposed_slip`.
    """

    state: np.ndarray
    direction: np.ndarray
    kappa: np.ndarray
    across: np.ndarray
    defect: np.ndarray
    contact: np.ndarray
    squares: float
    merit: float
    reached: float
    falling: "SlipDependence | None" = None
    staggered: float = 1.0

    def rows(self, step: np.ndarray, slip: np.ndarray, out: np.ndarray) -> None:
        """Set `out` to the linearised friction equations for a change of traction and of slip.

        Parameters
        ----------
        step, slip, out : ndarray, shape (2, n_x, n_y)
            The slip is taken at the leading faces, see `FrictionLaw.linearise`; the step does not
            include the change by the pressure.
        """
        law = self.state, self.direction, self.kappa, self.across, self.contact
        friction.tangent_row(*law, step, slip, out, self.staggered)
        if self.falling is not None:
            out -= self.falling.change(slip, self.contact) * self.direction

    def upwind_inverse(
        self, D: tuple[float, float, float], inverse: Map, stiffness: np.ndarray
    ) -> Map:
        """Return the approximate inverse of the equations of steady rolling, by an upwind sweep.

        D = -dA/dx, so that with the circulant inverse of A the elastic slip is inverted by a sum
        from the leading edge, at which the traction is zero. This is sufficient in stick elements.
        The equation of a slip element also has a local term gamma = 1/kappa - 1 of the traction,
        which may be much larger: the right-hand side is divided between both in proportion, and the
        sum includes gamma implicitly.

        Parameters
        ----------
        D : tuple of float
            Entries (11, 12, 22) of the slip of an element by a unit traction on it.
        inverse : callable
            Circulant inverse of the displacement A per length of an element.
        stiffness : ndarray, shape (n_x, n_y)
            Local term of leading stick elements (`FrictionSlip.stiffness`).

        Returns
        -------
        callable
            From right-hand sides (2, n_x, n_y), see `rows`, to a step that nearly solves them.
        """
        here = self.state, self.direction
        share, summed, local = np.empty((3, *self.kappa.shape))
        friction.prepare_sweep(*here, self.kappa, stiffness, D, share, summed, local)

        def solve(rows: np.ndarray) -> np.ndarray:
            smooth, out = np.empty_like(rows), np.empty_like(rows)
            friction.divide_rows(*here, share, D, rows, smooth)
            friction.sweep_upwind(*here, summed, local, D, rows, inverse(smooth), out)
            return out

        return solve

    def inverse_of_step(
        self, D: tuple[float, float, float], inverse: Map, stiffness: np.ndarray
    ) -> Map:
        """Return the approximate inverse of the equations of a time step (slip by displacement).

        Parameters as in `upwind_inverse`, but `D` is the displacement of an element by a unit
        traction on it. For the factors see `kernels.friction.prepare_step`.
        """
        here = self.state, self.direction
        rough, share, behind, front, along = np.empty((5, *self.kappa.shape))
        up = np.empty((2, *self.kappa.shape))
        law = *here, self.kappa, self.across, self.contact, stiffness, D, float(self.staggered)
        friction.prepare_step(*law, rough, share, behind, front, up)

        def solve(rows: np.ndarray) -> np.ndarray:
            smooth, out = np.empty_like(rows), np.empty_like(rows)
            factors = self.kappa, stiffness, share, behind, front, up
            friction.share_out(*here, *factors, rows, along, smooth)
            friction.gather(*here, share, rough, rows, inverse(smooth), out)
            return out

        return solve


@dataclass(frozen=True, eq=False)
class SlipDependence:
    """Change of a slip-dependent bound, as a term in the equations of a `Linearisation`.

    Attributes
    ----------
    slope : Slope
        Derivative of the bound by the slip.
    staggered : float
        See `FrictionLaw.opposed_slip`.
    """

    slope: Slope
    staggered: float

    def change(self, slip: np.ndarray, contact: np.ndarray) -> np.ndarray:
        """Return the change of the bound by that of slip at leading faces, with memory along x."""
        return self.slope.change(FrictionLaw.slip_at_centres(slip, contact, self.staggered))


@dataclass(frozen=True, eq=False)
class FrictionOnMesh:
    """A friction law on the elements of a mesh, dimensionless, for the solvers.

    Parameters
    ----------
    law : FrictionLaw
        The law.
    x, y : ndarray, shapes (n_x, 1) and (1, n_y)
        Centres of the elements, mm.
    unit : float
        Unit of the pressure, MPa.
    slip : float
        Unit of the slip s/V.
    """

    law: FrictionLaw = field(default_factory=Coulomb)
    x: np.ndarray = field(default_factory=lambda: np.zeros((1, 1)))
    y: np.ndarray = field(default_factory=lambda: np.zeros((1, 1)))
    unit: float = 1.0
    slip: float = 1.0

    def bound(self, pressure: np.ndarray) -> Bound:
        """Return the traction bound at rest and its derivative by the pressure, dimensionless."""
        bound = self.law.bound(self.unit * pressure, self.x, self.y)
        radius = bound.radius / self.unit
        if radius.shape != pressure.shape:
            radius = np.broadcast_to(radius, pressure.shape)
        # Not `replace`, which takes longer than the bound on small meshes.
        return Bound(radius, bound.by_pressure, bound.slope)

    def bound_sliding(
        self, pressure: np.ndarray, slip: np.ndarray, contact: np.ndarray, staggered: float
    ) -> Bound:
        """Return the bound and slope under scaled slip of leading faces, dimensionless."""
        frame = self.law.frame
        centred = self.law.slip_at_centres(slip, contact, staggered)
        bound = self.law.bound_sliding(
            self.unit * pressure,
            self.slip * frame.slip_to_physical(centred),
            self.x,
            self.y,
            bool(staggered),
        )
        slope = bound.slope
        if slope is not None:
            # ds = F^-1 ds~: derivatives by the slip transform as tractions.
            by_slip = self.slip * frame.to_scaled(slope.by_slip)
            slope = replace(slope, by_share=slope.by_share / self.unit, by_slip=by_slip)
        return replace(bound, radius=bound.radius / self.unit, slope=slope)

    def at_speed_ratio(self, ratio: float) -> "FrictionOnMesh":
        """Return the law with the rolling speed multiplied by `ratio`; 0 gives static friction."""
        return replace(self, law=self.law.at_speed_ratio(ratio))

    def on_elements(self, x: np.ndarray, y: np.ndarray) -> "FrictionOnMesh":
        """Return the law on the elements with centres (x, y), mm."""
        return FrictionOnMesh(self.law, x, y, self.unit, self.slip)
