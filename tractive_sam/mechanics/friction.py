"""Friction laws: how much traction an element can bear, and the law linearised for Newton's method.

In the scaled frame (`mechanics.frame`) the traction lies in a disc and opposes the slip where it
has reached the rim. What makes one law differ from another is the **bound**, the radius of the
disc: Coulomb's is the pressure. A law of one's own is a subclass of `FrictionLaw` with another
`bound`, and one whose bound answers to the slip one with `bound_sliding` as well.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from tractive_sam.kernels import friction
from tractive_sam.mechanics.frame import Frame
from tractive_sam.mechanics.law import Law

Pair = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Bound:
    """Largest size of the scaled traction, element by element.

    Attributes
    ----------
    radius : ndarray, shape (n_x, n_y)
        Radius of the disc, in the unit of the pressure: ||p_t||_mu <= radius (`Frame.norm`).
        Zero where the pressure is.
    by_pressure : ndarray or float
        Its derivative by the pressure.
    slope : Slope, optional
        How it answers to the slip, if it does.

    Examples
    --------
    >>> pressure = np.array([[100.0, 300.0]])
    >>> ts.Bound(radius=0.5 * pressure, by_pressure=0.5).radius
    array([[ 50., 150.]])
    """

    radius: np.ndarray
    by_pressure: np.ndarray | float
    slope: "Slope | None" = None


@dataclass(frozen=True, eq=False)
class Slope:
    """How a bound answers to the slip at the centres of the elements.

    The bound is a number, the share, times what it is at rest. The share may have a memory: then
    each element keeps a part of that of the element ahead, from which the material comes.

    Attributes
    ----------
    by_share : ndarray, shape (n_x, n_y)
        Derivative of the radius by the share.
    by_slip : ndarray, shape (2, n_x, n_y)
        That of the share by the slip of the element itself.
    kept : ndarray, shape (n_x, n_y)
        That of the share by the share of the element ahead; zero without memory.

    Examples
    --------
    >>> none = np.zeros((1, 1))
    >>> slope = ts.Slope(by_share=none + 300.0, by_slip=np.full((2, 1, 1), -2.0), kept=none)
    >>> slope.change(np.full((2, 1, 1), 1e-3))  # MPa, where the slip grows by 1e-3 along x and y
    array([[-1.2]])
    """

    by_share: np.ndarray
    by_slip: np.ndarray
    kept: np.ndarray

    def change(self, slip: np.ndarray) -> np.ndarray:
        """Change of the radius by a change of the slip at the centres, shape (n_x, n_y)."""
        out = np.empty_like(self.by_share)
        friction.carried(self.by_share, self.by_slip, self.kept, slip, out)
        return out

    @property
    def steepness(self) -> np.ndarray:
        """Size of the derivative of the radius by the slip of the element itself."""
        return self.by_share * np.hypot(*self.by_slip)


@dataclass(frozen=True, eq=False)
class PreviousShare:
    """What particles bring to a step of a transient, on the elements at which they end.

    Attributes
    ----------
    x, y : ndarray, shapes (n_x,) and (n_y,)
        Centres of the elements, mm.
    share : ndarray, shape (n_x, n_y)
        Bound before the step over that of rest, of the same pressure; 1 of what was not in contact.
    distance : float
        Rolled in the step, mm.
    """

    x: np.ndarray
    y: np.ndarray
    share: np.ndarray
    distance: float


class FrictionLaw(Law, ABC):
    """What friction does in every element; a subclass gives `frame` and `bound`.

    Examples
    --------
    >>> import dataclasses
    >>> @dataclasses.dataclass(frozen=True)
    ... class Capped(ts.Coulomb):
    ...     strength: float = 100.0  # MPa
    ...
    ...     def bound(self, pressure, x, y):
    ...         most = self.strength / max(self.mu)
    ...         return ts.Bound(np.minimum(pressure, most), np.where(pressure < most, 1.0, 0.0))
    >>> bound = Capped(mu=(0.5, 0.5)).bound(np.array([[100.0, 300.0]]), 0.0, 0.0)
    >>> bound.radius
    array([[100., 200.]])
    """

    @property
    @abstractmethod
    def frame(self) -> Frame:
        """The frame in which the law is isotropic."""

    @abstractmethod
    def bound(self, pressure: np.ndarray, x: np.ndarray, y: np.ndarray) -> Bound:
        """Radius of the disc in which the scaled traction lies.

        Parameters
        ----------
        pressure : ndarray, shape (n_x, n_y)
            p_n >= 0, MPa.
        x, y : ndarray, shapes (n_x, 1) and (1, n_y)
            Centres of the elements, mm.
        """

    @property
    def falls(self) -> bool:
        """Whether the bound answers to the slip; then `bound` is the largest, that at rest."""
        return False

    def bound_sliding(
        self, pressure: np.ndarray, slip: np.ndarray, x: np.ndarray, y: np.ndarray, second: bool
    ) -> Bound:
        """The same as `bound` under a slip, with its `Slope`, of a law that `falls`.

        Parameters
        ----------
        pressure, x, y : ndarray
            As for `bound`.
        slip : ndarray, shape (2, n_x, n_y)
            s/V at the centres of the elements.
        second : bool
            Whether the slip is taken to second order.
        """
        return self.bound(pressure, x, y)

    def eased(self, speed: float) -> "FrictionLaw":
        """The same at another speed of rolling, over its own: 0 is the law at rest."""
        return self

    def weakened(self, factor: float) -> "FrictionLaw":
        """Return the law where friction is `factor` times what it was; by default its bound is."""
        return self if factor == 1.0 else Weakened(self, factor)

    def with_previous(self, past: "PreviousShare") -> "FrictionLaw":
        """Return the law in a step whose particles have a past; by default it does not matter."""
        return self

    def project(self, traction: np.ndarray, radius: np.ndarray, physical=False) -> np.ndarray:
        """The nearest scaled traction that the bound allows.

        Parameters
        ----------
        traction : ndarray, shape (2, n_x, n_y)
            Scaled tractions.
        radius : ndarray, shape (n_x, n_y)
            Bound.
        physical : bool
            Whether distances are those of unscaled tractions. The scaled ones stretch the weaker
            axis: a step along them is too bold where mu1 and mu2 are far apart.
        """
        out = np.empty_like(traction)
        friction.project(traction, radius, out, *(self.frame.weights if physical else (1.0, 1.0)))
        return out

    @staticmethod
    def opposed(slip: np.ndarray, contact: np.ndarray, staggered: float) -> np.ndarray:
        """The slip that the tractions oppose, from that of the leading faces.

        Parameters
        ----------
        slip : ndarray, shape (2, n_x, n_y)
            Slip of the leading faces.
        contact : ndarray, shape (n_x, n_y)
            Positive in contact.
        staggered : float
            How far it is turned back, to where the slip at the centre points; 0: not at all
            (`kernels.friction.turn`).
        """
        if not staggered:
            return slip
        out = np.empty_like(slip)
        friction.turn(slip, contact, out, float(staggered))
        return out

    @staticmethod
    def centred(slip: np.ndarray, contact: np.ndarray, staggered: float) -> np.ndarray:
        """The slip at the centres, of which the bound is a function; parameters as `opposed`."""
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
    ) -> "Linearisation":
        """What the law says of a state, and its derivative there.

        Parameters
        ----------
        traction, slip : ndarray, shape (2, n_x, n_y)
            Scaled tractions, and slip of the leading faces (`operators.stencil`).
        bound : Bound
            The bound, under that slip.
        contact : ndarray, shape (n_x, n_y)
            What is positive in contact.
        staggered : float
            As for `opposed`.
        active : ndarray of bool, optional
            Elements that remain in contact after the step to come; those that leave it take their
            traction along, whatever their slip.
        weight : float
            How much slip counts beside tractions on the way; the solution is the same for any.
        """
        radius, shape = bound.radius, bound.radius.shape
        state, kappa = np.empty(shape, np.int8), np.empty(shape)
        direction, across = np.empty((2, *shape)), np.empty((2, 2, *shape))
        defect = np.empty((2, *shape))
        squares, merit = friction.linearise(
            traction,
            slip,
            radius,
            contact,
            float(staggered),
            *(weight * one for one in self.frame.weights),
            state,
            direction,
            kappa,
            across,
            defect,
        )
        if active is not None:
            state[~active] = friction.OPEN
            direction[:, ~active] = 0.0
        slope = None if bound.slope is None else Falling(bound.slope, float(staggered))
        return Linearisation(
            state,
            direction,
            kappa,
            across,
            defect,
            contact,
            squares,
            merit,
            slope,
            float(staggered),
        )


@dataclass(frozen=True)
class Weakened(FrictionLaw):
    """A friction law whose bound counts by a factor.

    Parameters
    ----------
    law : FrictionLaw
        The law as it is without.
    factor : float
        Factor on its bound.
    """

    law: FrictionLaw
    factor: float

    @property
    def frame(self) -> Frame:
        """That of the law without the factor."""
        return self.law.frame

    @property
    def falls(self) -> bool:
        """See `FrictionLaw.falls`."""
        return self.law.falls

    def bound(self, pressure: np.ndarray, x: np.ndarray, y: np.ndarray) -> Bound:
        """See `FrictionLaw.bound`."""
        return self._scaled(self.law.bound(pressure, x, y))

    def bound_sliding(
        self, pressure: np.ndarray, slip: np.ndarray, x: np.ndarray, y: np.ndarray, second: bool
    ) -> Bound:
        """See `FrictionLaw.bound_sliding`."""
        return self._scaled(self.law.bound_sliding(pressure, slip, x, y, second))

    def eased(self, speed: float) -> "Weakened":
        """See `FrictionLaw.eased`."""
        return replace(self, law=self.law.eased(speed))

    def _scaled(self, bound: Bound) -> Bound:
        slope, factor = bound.slope, self.factor
        if slope is not None:
            slope = replace(slope, by_share=factor * slope.by_share)
        return Bound(factor * bound.radius, factor * bound.by_pressure, slope)


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

    @property
    def frame(self) -> Frame:
        """The frame in which the law is isotropic."""
        return Frame(self.mu, self.angle)

    def bound(self, pressure: np.ndarray, x: np.ndarray, y: np.ndarray) -> Bound:
        """The pressure itself."""
        return Bound(pressure, 1.0)


@dataclass(frozen=True, eq=False)
class Friction:
    """A friction law on the elements of a mesh, in units of the pressure: what a solver sees of it.

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
        """Radius of the disc and its derivative by the pressure, dimensionless."""
        bound = self.law.bound(self.unit * pressure, self.x, self.y)
        radius = np.broadcast_to(bound.radius, pressure.shape) / self.unit
        return replace(bound, radius=radius)

    def bound_sliding(
        self, pressure: np.ndarray, slip: np.ndarray, contact: np.ndarray, staggered: float
    ) -> Bound:
        """The same of a law that falls, under the scaled slip of the leading faces."""
        frame = self.law.frame
        centred = self.law.centred(slip, contact, staggered)
        bound = self.law.bound_sliding(
            self.unit * pressure,
            self.slip * frame.slip_to_physical(centred),
            self.x,
            self.y,
            bool(staggered),
        )
        slope = bound.slope
        if slope is not None:
            # ds = F^-1 ds~ of the slip, so that its cofactors are those of tractions.
            by_slip = self.slip * frame.to_scaled(slope.by_slip)
            slope = replace(slope, by_share=slope.by_share / self.unit, by_slip=by_slip)
        return replace(bound, radius=bound.radius / self.unit, slope=slope)

    def eased(self, speed: float) -> "Friction":
        """The same at another speed of rolling, over its own."""
        return replace(self, law=self.law.eased(speed))

    def on(self, x: np.ndarray, y: np.ndarray) -> "Friction":
        """The same on other elements."""
        return replace(self, x=x, y=y)


@dataclass(frozen=True, eq=False)
class Linearisation:
    """A friction law linearised at a state, element by element; vectors in the scaled frame.

    An element is open, sticks or slips. Newton's rows ask of one that sticks that its slip vanish,
    of an open one that its traction does. One that slips goes to the rim of the disc along n, the
    direction of its traction; what is asked along the tangent t is kappa t.s + (1 - kappa) t.p,
    between slip (just at the bound) and traction (far beyond it, where only the direction is left
    to find).

    Attributes
    ----------
    state : ndarray of int8, shape (n_x, n_y)
        `kernels.friction.OPEN`, `STICK` or `SLIP`.
    direction : ndarray, shape (2, n_x, n_y)
        n, the unit vector of disc(p - s) where the element slips, else zero.
    kappa : ndarray, shape (n_x, n_y)
        Share of the slip in the row, above.
    across : ndarray, shape (2, 2, n_x, n_y)
        What t.s answers to the slip at the leading face (first index 0) and at the centre (1).
    defect : ndarray, shape (2, n_x, n_y)
        disc(p - s) - p, along t scaled like the row; where it sticks, minus the slip.
    contact : ndarray, shape (n_x, n_y)
        What is positive in contact.
    squares : float
        Sum of squares of disc(p - s) - p.
    merit : float
        The same with the weights of the frame, which Newton's steps lessen.
    falling : Falling, optional
        Of a bound that answers to the slip: the row along n is n.p less the change of the bound.
    staggered : float
        As for `FrictionLaw.opposed`.
    """

    state: np.ndarray
    direction: np.ndarray
    kappa: np.ndarray
    across: np.ndarray
    defect: np.ndarray
    contact: np.ndarray
    squares: float
    merit: float
    falling: "Falling | None" = None
    staggered: float = 1.0

    def rows(self, step: np.ndarray, slip: np.ndarray, out: np.ndarray) -> None:
        """Set `out` to the rows of a change of traction and the change of slip it causes.

        Parameters
        ----------
        step, slip, out : ndarray, shape (2, n_x, n_y)
            The slip is that of the leading faces, as for `FrictionLaw.linearise`; the step is one
            without what follows the pressure.
        """
        friction.tangent_row(
            self.state,
            self.direction,
            self.kappa,
            self.across,
            self.contact,
            step,
            slip,
            out,
            self.staggered,
        )
        if self.falling is not None:
            out -= self.falling.change(slip, self.contact) * self.direction

    def approximate_inverse(
        self,
        rows: np.ndarray,
        inverse: Callable[[np.ndarray], np.ndarray],
        own: tuple[float, float, float],
        stiffness: np.ndarray,
    ) -> np.ndarray:
        """Step whose rows are nearly those given: the upwind sweep.

        D = -dA/dx, so that with the circulant inverse of A the elastic slip is inverted by a sum
        from the leading edge, where the traction is zero. That is all where the element sticks.
        Where it slips, its row has a local term gamma = 1/kappa - 1 of the traction as well, which
        may be far the larger one: the row is divided between both in proportion, and the sum
        includes gamma, implicitly.

        Parameters
        ----------
        rows : ndarray, shape (2, n_x, n_y)
            As of `rows`.
        inverse : callable
            Circulant inverse of the displacement A per length of an element.
        own : tuple of float
            Entries (11, 12, 22) of the slip of an element by its own traction.
        stiffness : ndarray, shape (n_x, n_y)
            Local term of leading elements that stick (`FrictionSlip.stiffness`).
        """
        here = self.state, self.direction, self.kappa, stiffness, own
        smooth, rough = np.empty_like(rows), np.empty(self.kappa.shape)
        friction.split(*here, rows, smooth, rough)
        out = np.empty_like(rows)
        friction.sweep(*here, rows, inverse(smooth), rough, out)
        return out

    def approximate_inverse_of_step(
        self,
        rows: np.ndarray,
        inverse: Callable[[np.ndarray], np.ndarray],
        own: tuple[float, float, float],
        stiffness: np.ndarray,
    ) -> np.ndarray:
        """The same where the rows are in the displacement A itself, not in its difference.

        Parameters as of `approximate_inverse`; `own` is the displacement of an element by its own
        traction.
        """
        here, share = (self.state, self.direction), np.empty(self.kappa.shape)
        smooth, rough, out = (np.empty_like(rows) for _ in range(3))
        local = self.kappa, self.across, self.contact, stiffness, own, float(self.staggered)
        friction.share_out(*here, *local, rows, share, smooth, rough)
        friction.gather(*here, share, rows, inverse(smooth), rough, out)
        return out


@dataclass(frozen=True, eq=False)
class Falling:
    """What a bound that answers to the slip adds to the rows of a `Linearisation`.

    Attributes
    ----------
    slope : Slope
        How it answers.
    staggered : float
        As of `FrictionLaw.opposed`.
    """

    slope: Slope
    staggered: float

    def change(self, slip: np.ndarray, contact: np.ndarray) -> np.ndarray:
        """Change of the radius by a change of the slip of the leading faces, shape (n_x, n_y)."""
        return self.slope.change(FrictionLaw.centred(slip, contact, self.staggered))
