"""Dimensionless contact problems and their solutions: input, output and progress of solvers.

The pressure is an unknown of a `Problem`, or it is **fixed**: of bodies of equal material it does
not depend on the tractions and is solved for beforehand. Problems are never changed, other ones are
made.
"""

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple, Protocol, Self, TypeVar

import numpy as np

from tractive_sam.compute import Mirror, backend_of
from tractive_sam.kernels.linear_algebra import asymmetry
from tractive_sam.lazy_names import renamed_attributes
from tractive_sam.mechanics import Bound, FrictionOnMesh, Linearisation
from tractive_sam.operators import (
    Box,
    FrictionSlip,
    Kinematics,
    Operators,
    SteadyRolling,
)
from tractive_sam.results import Cost, Status

WearInPass = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
"""(pi_n, pi_t, sigma) -> depth worn within the pass, in units of gap, shape (n_x, n_y)."""


@dataclass(frozen=True, eq=False)
class NormalProblem:
    """Normal contact problem: find pi_n >= 0, eta = gap + A_nn pi_n - delta >= 0, pi_n eta = 0.

    Parameters
    ----------
    operators : Operators
        The elastic operators.
    gap : ndarray, shape (n_x, n_y)
        Separation of the undeformed surfaces.
    load : float or None
        Sum of pi_n over the elements; None if the approach is given.
    approach : float
        delta; not used if the load is given.
    """

    operators: Operators
    gap: np.ndarray
    load: float | None
    approach: float = 0.0

    def is_the_same_as(self, problem: "NormalProblem") -> bool:
        """Return whether two problems have equal operators, gap, load and approach."""
        prescribed = self.load == problem.load and self.approach == problem.approach
        same = prescribed and self.operators is problem.operators
        return same and np.array_equal(self.gap, problem.gap)

    def within(self, box: Box) -> "NormalProblem":
        """Return the problem restricted to a rectangle (box) of elements."""
        gap = np.ascontiguousarray(self.gap[box])
        operators = self.operators.part(gap.shape, first=box[1].start)
        return replace(self, operators=operators, gap=gap)

    def coarsened(self) -> "NormalProblem":
        """Return the problem on a mesh of elements of twice the size."""
        lattice = self.operators.lattice
        return replace(
            self,
            operators=self.operators.coarsened,
            gap=lattice.merge(self.gap),
            load=None if self.load is None else self.load / math.prod(lattice.coarsening),
        )


@dataclass(frozen=True, eq=False)
class PrescribedForces:
    """Prescribed tangential forces; their creepages are unknowns of the problem.

    A unit of the unknown zeta_k adds the constant slip v_k to every element, and the force k is the
    sum of v_k . pi_t over the elements: work per revolution is force times creepage.

    Parameters
    ----------
    vectors : ndarray, shape (m, 2)
        v_k, in the scaled frame.
    target : ndarray, shape (m,)
        The forces.
    """

    vectors: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    target: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def __len__(self) -> int:
        return len(self.target)

    @property
    def minimum(self) -> float:
        """Least sum of traction magnitudes that gives the forces; 0 if none is prescribed.

        No more than the sum of the bound can be had, in any direction.
        """
        if not len(self):
            return 0.0
        return float(np.linalg.norm(np.linalg.pinv(self.vectors) @ self.target))

    def elastic_slip(self, slip: np.ndarray, creepage: np.ndarray) -> float:
        """Return the largest slip without the unknown creepages; 0 if no force is prescribed."""
        if not len(self):
            return 0.0
        return float(np.abs(slip - self.slip(creepage)).max())

    def trust_fraction(self, creepage: np.ndarray, change: np.ndarray, elastic: float) -> float:
        """Return the fraction (at most 1) of a change of creepages that a step may take.

        If nearly everything slips the forces hardly depend on the creepages, and a Newton step
        would diverge. Full slip begins at a slip of order one, or of the `elastic` slip.
        """
        if not len(self):
            return 1.0
        size = np.abs(change).max()
        trusted = 3.0 + np.abs(creepage).max() + elastic
        return float(min(1.0, trusted / size)) if size > 0.0 else 1.0

    def diverged(self, creepage: np.ndarray, elastic: float) -> bool:
        """Return whether creepages are so large that friction cannot carry the forces."""
        return len(self) > 0 and bool(np.abs(creepage).max() > 1e4 * (1.0 + elastic))

    def slip(self, creepage: np.ndarray) -> np.ndarray:
        """Return the constant slip that the unknown creepages cause, shape (2, 1, 1)."""
        return (creepage @ self.vectors)[:, None, None]

    def force(self, traction: np.ndarray) -> np.ndarray:
        """Return the tangential forces of a field of tractions, shape (m,)."""
        return self.vectors @ traction.sum(axis=(1, 2))

    def coarsened(self, block: tuple[int, int]) -> "PrescribedForces":
        """Return the forces for a mesh with elements that combine `block` of this one."""
        return replace(self, target=self.target / math.prod(block))


@dataclass(frozen=True, eq=False)
class FixedPressure:
    """Fixed pressure and gap, under which only the tractions are unknown.

    Parameters
    ----------
    operators : Operators
        The elastic operators.
    pressure, gap : ndarray, shape (n_x, n_y)
        pi_n and eta; the gap determines the positions of edges within their elements.
    """

    operators: Operators
    pressure: np.ndarray
    gap: np.ndarray

    def coarsened(self) -> "FixedPressure":
        """Return pressure and gap on a mesh of elements of twice the size."""
        merge = self.operators.lattice.merge
        pressure, gap = merge(self.pressure, "constant"), merge(self.gap)
        return FixedPressure(self.operators.coarsened, pressure, gap)


@renamed_attributes(held="is_pressure_fixed", holding="with_pressure", eased="at_speed_ratio")
@dataclass(frozen=True, eq=False)
class Problem:
    """Contact problem: find pressure, tractions and slip that meet the contact conditions.

    The normal conditions are those of `NormalProblem`, with the lift by tractions; in slip
    pi_t = -radius sigma/|sigma|, sigma = rigid + creepages + D_tn pi_n + D_tt pi_t. The kinematics
    define D and the sigma in the friction law of an element.

    Unknowns and the response to them are **fields** of shape (3, n_x, n_y): pressure and tractions,
    gap and slip. Under a fixed pressure their shape is (2, n_x, n_y): tractions, and slip. So
    `fields[-2:]` are always the tangential ones.

    Parameters
    ----------
    normal : NormalProblem or FixedPressure
        The normal block, free or fixed; it has the operators.
    rigid : ndarray, shape (2, n_x, n_y)
        Slip that does not depend on the unknowns: the slip of the undeformed bodies, in a step less
        the former displacements of the particles, under a fixed pressure plus the slip that it
        causes.
    friction : FrictionOnMesh
        The friction law on the mesh.
    forces : PrescribedForces
        Forces prescribed in place of creepages.
    wear : callable, optional
        Wear within the pass, added to the gap. Only iterations that evaluate the gap itself support
        it (`Uzawa`).
    kinematics : Kinematics
        How slip follows from displacement.
    most : float
        Applications of the operators after which Newton's method gives up.
    """

    normal: NormalProblem | FixedPressure
    rigid: np.ndarray
    friction: FrictionOnMesh = field(default_factory=FrictionOnMesh)
    forces: PrescribedForces = field(default_factory=PrescribedForces)
    wear: WearInPass | None = None
    kinematics: Kinematics = field(default_factory=SteadyRolling)
    most: float = math.inf

    @property
    def operators(self) -> Operators:
        """Elastic operators of the problem."""
        return self.normal.operators

    @property
    def coupled(self) -> bool:
        """Whether pressure causes slip and tractions change the gap."""
        return self.operators.elasticity.coupled

    @property
    def has_tangential_cause(self) -> bool:
        """Whether creepages, forces or coupling cause slip; otherwise tractions are zero."""
        return self.coupled or len(self.forces) > 0 or bool(self.rigid.any())

    @property
    def is_pressure_fixed(self) -> bool:
        """Whether the pressure is fixed, and only the tractions are unknown."""
        return isinstance(self.normal, FixedPressure)

    @property
    def fixed_pressure(self) -> FixedPressure:
        """Fixed pressure and its gap; raises a TypeError if the pressure is unknown."""
        if isinstance(self.normal, NormalProblem):
            raise TypeError("problem.normal: must be a FixedPressure here")
        return self.normal

    @property
    def free_pressure(self) -> NormalProblem:
        """Normal problem; raises a TypeError if the pressure is fixed."""
        if isinstance(self.normal, FixedPressure):
            raise TypeError("problem.normal: must be a NormalProblem here")
        return self.normal

    @property
    def load(self) -> float | None:
        """Prescribed sum of the pressure; None for a prescribed approach or pressure."""
        return None if isinstance(self.normal, FixedPressure) else self.normal.load

    @property
    def shape(self) -> tuple[int, int, int]:
        """Shape of the unknown fields: (3, n_x, n_y), or (2, n_x, n_y) under a fixed pressure."""
        return (2 if self.is_pressure_fixed else 3, *self.rigid.shape[1:])

    def with_pressure(self, pressure: np.ndarray, gap: np.ndarray) -> "Problem":
        """Return the tangential problem under a fixed pressure, including the slip by pressure."""
        rigid = self.rigid
        if self.coupled:
            rigid = rigid + self.kinematics.by_pressure(self.operators, pressure)
        return replace(
            self, normal=FixedPressure(self.operators, pressure, gap), rigid=rigid, wear=None
        )

    def within(self, box: Box) -> Self:
        """Return the problem (its pressure must be fixed) on a rectangle (box) of elements."""
        normal = self.fixed_pressure
        # Contiguous, for the vector instructions of the kernels.
        pressure, gap = (
            np.ascontiguousarray(field[box]) for field in (normal.pressure, normal.gap)
        )
        operators = self.operators.part(pressure.shape, first=box[1].start)
        return self._on(box, FixedPressure(operators, pressure, gap))

    def _on(self, box: Box, normal: NormalProblem | FixedPressure) -> Self:
        """Return the problem on a box of elements, with the normal block there."""
        friction = self.friction
        x = friction.x[box[0]] if len(friction.x) > 1 else friction.x
        y = friction.y[:, box[1]] if friction.y.shape[1] > 1 else friction.y
        return replace(
            self,
            normal=normal,
            rigid=np.ascontiguousarray(self.rigid[:, *box]),
            friction=friction.on_elements(x, y),
            kinematics=self.kinematics.within(box),
        )

    @property
    def mirror(self) -> Mirror | None:
        """Symmetry about the middle of the mesh along y, of gap, friction and slip, or None.

        Prescribed forces, friction that falls with the slip, wear within a pass and bodies of
        different material are not considered. Rounding of what is prescribed is ignored.
        """
        normal = self.normal
        if len(self.forces) or self.friction.law.falls or self.wear:
            return None
        known = isinstance(normal, NormalProblem) and isinstance(normal.gap, np.ndarray)
        if not known or not self.operators.keep_symmetry:
            return None
        rounding = 1e-11  # displacements before a step are rounded as transforms are
        pressed = self.friction.bound(normal.gap.max() - normal.gap).radius
        for even in (normal.gap, pressed, *self.kinematics.gaps):
            apart, size = asymmetry(even, 1.0)
            if not apart <= rounding * size:
                return None
        return Mirror.of(self.rigid, rounding)

    def upper_half(self, mirror: Mirror) -> Self:
        """Return the problem (its pressure must be free) on the upper half of a symmetric mesh."""
        normal = self.free_pressure
        nx, ny = normal.gap.shape
        box = slice(None), slice(ny // 2, None)
        half = NormalProblem(
            self.operators.part((nx, ny - ny // 2), mirror, ny // 2),
            np.ascontiguousarray(normal.gap[box]),
            None if normal.load is None else 0.5 * normal.load,
            normal.approach,
        )
        problem = self._on(box, half)
        half.operators.lattice.clear_axis(problem.rigid)
        return problem

    def coarsened(self) -> Self:
        """Return the problem on a mesh of elements of twice the size."""
        lattice = self.operators.lattice
        block, merge = lattice.coarsening, lattice.merge
        friction, scale = self.friction, self.kinematics.slip_scale(block[0])
        friction = friction.on_elements(merge(friction.x), merge(friction.y))
        return replace(
            self,
            normal=self.normal.coarsened(),
            rigid=scale * merge(self.rigid),
            friction=replace(friction, slip=friction.slip / scale),
            forces=self.forces.coarsened(block),
            kinematics=self.kinematics.coarsened(lattice),
        )

    def response(self, fields: np.ndarray) -> np.ndarray:
        """Return the elastic gap and slip due to fields (pressure, tractions)."""
        if self.coupled and not self.is_pressure_fixed:
            return self.kinematics.coupled(self.operators)(fields)
        slip = self.kinematics.tangential(self.operators)(fields[-2:, ...])
        if self.is_pressure_fixed:
            return slip
        return backend_of(fields).concat((self.operators.normal(fields[:1, ...]), slip))

    @cached_property
    def approximate(self) -> Self:
        """Problem with the approximate operators; only its response is used."""
        return replace(self, normal=replace(self.normal, operators=self.operators.approximate))

    def bound(self, pressure: np.ndarray) -> Bound:
        """Return the traction bound of the friction law under a pressure, at zero slip."""
        return self._fixed_bound if self.is_pressure_fixed else self.friction.bound(pressure)

    def bound_sliding(
        self,
        bound: Bound,
        pressure: np.ndarray,
        traction: np.ndarray,
        slip: np.ndarray,
        seen: FrictionSlip,
    ) -> Bound:
        """Return the traction bound under the slip; the given bound unless friction falls."""
        if not self.friction.law.falls:
            return bound
        sticking = seen.sticking(slip, traction)
        return self.friction.bound_sliding(pressure, sticking, seen.bound, seen.staggered)

    def friction_slip(self, pressure: np.ndarray, gap: np.ndarray) -> FrictionSlip:
        """Return the `FrictionSlip` (slip corrected at edges) under a pressure and a gap."""
        if self.is_pressure_fixed:
            return self._fixed_slip
        return self.kinematics.friction_slip(self.operators, pressure, gap)

    @cached_property
    def touching(self) -> np.ndarray:
        """Mask of the elements in contact under the fixed pressure, shape (n_x, n_y)."""
        return self.fixed_pressure.pressure > 0.0

    @cached_property
    def _fixed_bound(self) -> Bound:
        """Traction bound of the friction law under the fixed pressure, at zero slip."""
        return self.friction.bound(self.fixed_pressure.pressure)

    @cached_property
    def _fixed_weight(self) -> float:
        """Weight of slip relative to tractions under the fixed pressure."""
        return self.kinematics.slip_weight(self.operators, self._fixed_bound.radius)

    @cached_property
    def _fixed_slip(self) -> FrictionSlip:
        """`FrictionSlip` (slip corrected at edges) under the fixed pressure."""
        normal = self.fixed_pressure
        return self.kinematics.friction_slip(self.operators, normal.pressure, normal.gap)

    def project(self, traction: np.ndarray, radius: np.ndarray, physical: bool) -> np.ndarray:
        """Return the scaled tractions within the bound nearest to these (`physical`: unscaled)."""
        return self.friction.law.project(traction, radius, physical)

    def opposed(self, traction: np.ndarray, slip: np.ndarray, seen: FrictionSlip) -> np.ndarray:
        """Return the slip that tractions oppose in each element, from the slip of leading faces."""
        sticking = seen.sticking(slip, traction)
        return self.friction.law.opposed_slip(sticking, seen.bound, seen.staggered)

    def linearise(
        self,
        traction: np.ndarray,
        slip: np.ndarray,
        bound: Bound,
        seen: FrictionSlip,
        active: np.ndarray | None,
    ) -> Linearisation:
        """Return the friction law linearised at tractions and slip."""
        sticking = seen.sticking(slip, traction)
        if self.is_pressure_fixed:
            weight = self._fixed_weight
        else:
            weight = self.kinematics.slip_weight(self.operators, bound.radius)
        return self.friction.law.linearise(
            *(traction, sticking, bound, seen.bound, seen.staggered, active, weight),
            self.operators.lattice.first_share,
        )

    def sliding(
        self, pressure: np.ndarray, gap: np.ndarray, traction: np.ndarray, slip: np.ndarray
    ) -> tuple[np.ndarray, Bound]:
        """Return a mask of the elements that slide in a solution, and the traction bound.

        Returns
        -------
        sliding : ndarray of bool, shape (n_x, n_y)
            Elements in contact with a traction that is at its bound and opposes the slip.
        bound : Bound
            Bound under this slip.
        """
        seen = self.friction_slip(pressure, gap)
        opposed = self.opposed(traction, slip, seen)
        bound = self.bound_sliding(self.bound(pressure), pressure, traction, slip, seen)
        beyond = ((traction - opposed) ** 2).sum(axis=0) > bound.radius**2
        return (pressure > 0.0) & beyond, bound

    def at_speed_ratio(self, ratio: float) -> "Problem":
        """Return the problem at `ratio` times the rolling speed; 0 gives static friction."""
        return replace(self, friction=self.friction.at_speed_ratio(ratio))


Part = TypeVar("Part")


def needed(part: Part | None, name: str) -> Part:
    """Return an optional value unchanged; raise a TypeError that names it if it is None.

    Raises
    ------
    TypeError
        If it is missing, as in the outcome of a user-defined solver.
    """
    if part is None:
        raise TypeError(f"{name}: must be given here, and is None")
    return part


class ContactFields(NamedTuple):
    """Dimensionless fields of a solution: pressure, gap, traction, slip."""

    pressure: np.ndarray
    gap: np.ndarray
    traction: np.ndarray
    slip: np.ndarray


def relative(distance: float, size: float) -> float:
    """Return a distance divided by a size; the distance itself if the size is zero."""
    return float(distance / size) if size > 0.0 else float(distance)


def closed(pressure: np.ndarray, gap: np.ndarray) -> np.ndarray:
    """Return the pressure of elements in contact (pressure > gap), and zero elsewhere.

    An element is in contact if its pressure exceeds its gap, both dimensionless, so that the
    projection of the pressure, max(0, pressure - gap), is positive. Elsewhere an iteration leaves
    pressures of the size of its residual.

    Parameters
    ----------
    pressure, gap : ndarray, shape (n_x, n_y)
        pi_n and eta.
    """
    return backend_of(pressure).xp.where(pressure > gap, pressure, 0.0)


@dataclass(frozen=True)
class Note:
    """Entry of a solver's trace: method and mesh, how it ended, and further text.

    Attributes
    ----------
    what : str
        The method, and on what.
    status : Status
        How it ended.
    more : str
        How far it came.
    """

    what: str
    status: Status
    more: str = ""

    def __str__(self) -> str:
        return f"{self.what}: {self.status}{self.more}"


@dataclass(frozen=True, eq=False)
class Start:
    """Initial guess of a solver: any of pressure, traction, approach, creepages.

    An `Outcome` will do as well. The gap may be known, if pressure, gap and approach already solve
    the normal problem without tractions.
    """

    pressure: np.ndarray | None = None
    traction: np.ndarray | None = None
    approach: float = 0.0
    creepage: np.ndarray | None = None
    gap: np.ndarray | None = None


@dataclass(frozen=True, eq=False)
class Outcome:
    """Result of a solver, dimensionless: fields, status, residual, cost and trace.

    Attributes
    ----------
    status : Status
        State at the end; only CONVERGED is a solution.
    residual : float
        Natural residual of the contact conditions, relative: the distance of the pressure from its
        projection, |p - project(p - r)| / |p| with r the gap, and the distance of the tractions,
        with r the slip, each over its size. If both are unknown, the larger one.
    iterations : int
        Outer iterations on the finest mesh.
    cost : Cost
        Work done, coarser meshes included.
    pressure, gap : ndarray, shape (n_x, n_y), optional
        pi_n and eta.
    traction, slip : ndarray, shape (2, n_x, n_y), optional
        pi_t and sigma.
    approach : float, optional
        delta.
    creepage : ndarray, shape (m,), optional
        The creepages found for prescribed forces.
    trace : tuple of Note
        Methods tried and fallbacks, step by step.
    top : (float, float), optional
        The largest force and its creepage, if no creepage has the first of the prescribed forces
        because friction falls with sliding.
    steepness : float, optional
        `solvers.falling_friction.steepness` of the solution, if the method has needed it.
    sliding, radius : ndarray, shape (n_x, n_y), optional
        Elements that slide, and the radius of the bound (`Problem.sliding`), if the method knows
        them.
    """

    status: Status
    residual: float
    iterations: int
    cost: Cost
    pressure: np.ndarray | None = None
    gap: np.ndarray | None = None
    traction: np.ndarray | None = None
    slip: np.ndarray | None = None
    approach: float | None = None
    creepage: np.ndarray | None = None
    trace: tuple[Note, ...] = ()
    top: tuple[float, float] | None = None
    steepness: float | None = None
    sliding: np.ndarray | None = None
    radius: np.ndarray | None = None

    @property
    def converged(self) -> bool:
        """Whether the contact conditions hold to the tolerance."""
        return self.status is Status.CONVERGED

    @property
    def fields(self) -> ContactFields:
        """Fields of the contact; raises a TypeError if one of them was not solved for."""
        return ContactFields(
            *(needed(getattr(self, name), f"outcome.{name}") for name in ContactFields._fields)
        )

    def costing(self, earlier: "Outcome", share: float = 1.0) -> "Outcome":
        """Return the outcome with the cost of an earlier one added (times `share`)."""
        return replace(self, cost=self.cost + earlier.cost.scaled(share))

    def after(self, earlier: "Outcome") -> "Outcome":
        """Return the outcome with the cost and the trace of an earlier one added."""
        return replace(self.costing(earlier), trace=earlier.trace + self.trace)


class ProblemSolver(Protocol):
    """Protocol of solvers of contact problems: objects with a method `solve`."""

    def solve(self, problem: Any, tolerance: float, start: Any = None) -> Outcome:
        """Solve a problem, from a start if there is one; return the outcome, converged or not.

        Parameters
        ----------
        problem : Problem or NormalProblem
            The problem.
        tolerance : float
            Natural residual, relative, at which to stop.
        start : Start or Outcome, optional
            First guess.
        """
        ...


Reporter = Callable[[tuple[int, int], float], None]
"""Takes the mesh that is solved on, and the residual there."""

_reporter: ContextVar[Reporter | None] = ContextVar("reporter", default=None)


@contextmanager
def report_to(reporter: Reporter) -> Iterator[None]:
    """Within the block, call a function with the mesh and residual of every iteration."""
    before = _reporter.set(reporter)
    try:
        yield
    finally:
        _reporter.reset(before)


def report_progress(mesh: tuple[int, int], residual: float) -> None:
    """Call the function of `report_to`, if there is one, with a mesh and a residual."""
    if (reporter := _reporter.get()) is not None:
        reporter(mesh, residual)
