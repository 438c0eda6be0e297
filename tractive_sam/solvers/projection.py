"""The paper's projected iterations: project(fields - step * residual), by Uzawa or accelerated.

The smooth modes of the slip operator have almost imaginary eigenvalues A(k) (1 - exp(i k_x dx))/dx,
for which |1 - r lambda| < 1 holds up to r = dx/A(k): the usable step of the slip shrinks with the
mesh. The bound with the largest A(k) of the contact is safe, but no mode that long fits into it;
what works best is a fixed multiple.
"""

from abc import ABC, abstractmethod
from collections.abc import Generator, Sequence
from dataclasses import dataclass, replace
from itertools import count
from math import sqrt
from typing import ClassVar

import numpy as np

from tractive_sam.compute import backend_of
from tractive_sam.operators import Lattice, Operators
from tractive_sam.results import Cost, Status
from tractive_sam.solvers.krylov import ConjugateGradients
from tractive_sam.solvers.nested import Nested
from tractive_sam.solvers.problem import (
    FixedPressure,
    NormalProblem,
    Note,
    Outcome,
    Problem,
    Start,
    closed,
    needed,
    relative,
)

Array = np.ndarray


def slip_step(operators: Operators, contact: Array) -> float:
    """Return the largest stable step length of the slip iteration on a contact area."""
    xp = backend_of(contact).xp
    ones = xp.where(contact, xp.ones(contact.shape), 0.0)
    zero = xp.zeros_like(ones)
    responses = (operators.tangential(xp.stack(unit)) for unit in ((ones, zero), (zero, ones)))
    return 1.0 / max(float(xp.max(xp.sum(xp.abs(each), axis=0))) for each in responses)


def gap_step(operators: Operators, contact: Array) -> float:
    """Return the step of the gap iteration: an inverse bound of the eigenvalues of A_nn."""
    xp = backend_of(contact).xp
    ones = xp.where(contact, xp.ones(contact.shape), 0.0)
    return 1.0 / float(xp.max(operators.normal(ones[None, ...])))


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Result of one evaluation of the projected map: image, residual, gap and slip.

    Attributes
    ----------
    image : ndarray
        The projected state.
    residual : float
        Natural residual of the state, relative.
    gap, slip : ndarray, shapes (n_x, n_y) and (2, n_x, n_y)
        Gap and slip of the state.
    """

    image: Array
    residual: float
    gap: Array
    slip: Array


@dataclass(frozen=True, eq=False)
class ProjectedMap:
    """Projected fixed-point map of pressure and tractions (paper, eq. 13; section 7.5).

    States are fields of the problem; the approach is fixed.

    Parameters
    ----------
    problem : Problem
        The problem.
    steps : ndarray, shape of the fields (..., 1, 1)
        Steps of gap and slip.
    """

    problem: Problem
    steps: Array

    @classmethod
    def from_problem(cls, problem: Problem, contact: Array, step_factor: float) -> "ProjectedMap":
        """Return the map of a problem, with step lengths that are stable on a contact area."""
        slip = step_factor * slip_step(problem.operators, contact)
        gap = [] if problem.is_pressure_fixed else [gap_step(problem.operators, contact)]
        steps = backend_of(contact).xp.asarray([*gap, slip, slip])
        return cls(problem, steps[:, None, None])

    def shortened(self, factor: float) -> "ProjectedMap":
        """Return the map with step lengths multiplied by a factor below one."""
        return replace(self, steps=factor * self.steps)

    def _pressure(self, state: Array) -> Array:
        """Return the pressure of a state, or the fixed pressure of the problem."""
        fixed = self.problem.normal
        return fixed.pressure if isinstance(fixed, FixedPressure) else state[0, ...]

    def admissible(self, state: Array) -> Array:
        """Return a state projected to pressure >= 0 and tractions within their bound."""
        problem = self.problem
        if problem.is_pressure_fixed:
            radius = problem.bound(problem.fixed_pressure.pressure).radius
            return problem.project(state, radius, physical=False)
        backend = backend_of(state)
        pressure = backend.xp.maximum(state[:1, ...], 0.0)
        radius = problem.bound(pressure[0, ...]).radius
        return backend.concat((pressure, problem.project(state[1:, ...], radius, physical=False)))

    def __call__(self, state: Array) -> Evaluation:
        """Evaluate the map once, at the cost of one application."""
        problem, normal, pressure = self.problem, self.problem.normal, self._pressure(state)
        backend, response, traction = backend_of(state), problem.response(state), state[-2:, ...]
        slip = problem.rigid + response[-2:, ...]
        gap = normal.gap
        if isinstance(normal, NormalProblem):
            gap = gap + response[0, ...] - normal.approach
        if problem.wear is not None:
            gap = gap + problem.wear(pressure, traction, slip)
        seen = problem.friction_slip(
            pressure if problem.is_pressure_fixed else closed(pressure, gap), gap
        )
        opposed = problem.opposed(traction, slip, seen)
        bound = problem.bound(pressure)
        radius = problem.bound_sliding(bound, pressure, traction, slip, seen).radius
        target = problem.project(traction - opposed, radius, physical=False)
        lattice = problem.operators.lattice
        residual, misses = missed(target, traction, lattice), opposed
        if not problem.is_pressure_fixed:
            pressed = backend.xp.maximum(pressure - gap, 0.0)
            residual = max(missed(pressed, pressure, lattice), residual)
            misses = backend.concat((gap[None, ...], opposed))
        return Evaluation(self.admissible(state - self.steps * misses), residual, gap, slip)

    def without_open(self, state: Array, evaluation: Evaluation) -> tuple[Array, Evaluation]:
        """Return a state without pressure on open gaps, and its evaluation."""
        if self.problem.is_pressure_fixed:
            return state, evaluation
        backend, pressure = backend_of(state), closed(state[0, ...], evaluation.gap)
        if backend.xp.all(pressure == state[0, ...]):
            return state, evaluation
        state = self.admissible(backend.concat((pressure[None, ...], state[1:, ...])))
        return state, self(state)


def missed(target: Array, state: Array, lattice: Lattice) -> float:
    """Return the distance of a state from its projection `target`, over the size of `target`."""
    short = target - state
    size, distance = sqrt(lattice.dot(target, target)), sqrt(lattice.dot(short, short))
    return relative(distance, size)


States = Generator[tuple[ProjectedMap, Array], Evaluation, None]


@dataclass(frozen=True)
class Projection(ABC):
    """Base class of projected iterations with load control; a subclass adds the iteration.

    Attributes
    ----------
    corrections : int
        Most corrections of the approach.
    beginning : float
        Residual of the pressure without tractions from which they start.
    """

    corrections: int = 60
    beginning: float = 1e-3

    name: ClassVar[str] = ""
    step_factor = 1.0
    iterations = 0

    @abstractmethod
    def _states(self, mapping: ProjectedMap, state: Array) -> States:
        """Yield (map, state) to evaluate; end if the iteration diverges."""

    def iterate(
        self, mapping: ProjectedMap, tolerance: float, state: Array
    ) -> tuple[Outcome, ProjectedMap]:
        """Iterate at a fixed approach; return the outcome and the map, with its last steps."""
        states = self._states(mapping, mapping.admissible(state))
        mapping, state = next(states)
        again = 0
        for taken in range(self.iterations + 1):
            evaluation, status = mapping(state), Status.OUT_OF_ITERATIONS
            if evaluation.residual <= tolerance:
                last = mapping.without_open(state, evaluation)
                again += last[1] is not evaluation
                if last[1].residual <= tolerance:
                    status, (state, evaluation) = Status.CONVERGED, last
            if status is Status.CONVERGED or taken == self.iterations:
                break
            try:
                mapping, state = states.send(evaluation)
            except StopIteration:
                status = Status.DIVERGED
                break
        return self._outcome(status, mapping, state, evaluation, taken, again), mapping

    def solve(
        self, problem: Problem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Solve a problem with prescribed creepages; raise a ValueError if it prescribes forces.

        Parameters
        ----------
        problem : Problem
            The problem, without prescribed tangential forces.
        tolerance : float
            Natural residual, and relative error of the load, at which to stop.
        start : Start or Outcome, optional
            First guess; by default of the pressure that without tractions, roughly, and zero of the
            rest.

        Raises
        ------
        ValueError
            If the problem prescribes tangential forces.
        """
        if len(problem.forces):
            raise ValueError(
                "problem.forces: projected iterations need given creepages; use solvers.Newton"
            )
        cost = Cost()
        start = start or Start()
        traction, backend = start.traction, backend_of(problem.rigid)
        if traction is None or not backend.xp.all(backend.xp.isfinite(traction)):
            traction = backend.xp.zeros_like(problem.rigid)
        if problem.is_pressure_fixed:
            mapping = ProjectedMap.from_problem(
                problem, problem.fixed_pressure.pressure > 0.0, self.step_factor
            )
            outcome, _ = self.iterate(mapping, tolerance, traction)
        else:
            pressure, approach = start.pressure, start.approach
            if pressure is None:
                normal = Nested(ConjugateGradients()).solve(problem.free_pressure, self.beginning)
                approach, cost = normal.approach, normal.cost
                pressure = needed(normal.pressure, "outcome.pressure")
            mapping = ProjectedMap.from_problem(problem, pressure > 0.0, self.step_factor)
            state = backend.concat((pressure[None, ...], traction))
            if problem.load is None:
                outcome, _ = self.iterate(mapping, tolerance, state)
            else:
                approach = needed(approach, "start.approach")
                outcome = self._under_load(mapping, tolerance, state, approach, problem.load)
        trace = (Note(self.name, outcome.status),)
        return replace(outcome, cost=outcome.cost + cost, trace=trace)

    def _under_load(
        self, mapping: ProjectedMap, tolerance: float, state: Array, approach: float, load: float
    ) -> Outcome:
        """Iterate at corrected approaches until the load is met (paper, section 7.5)."""
        problem, cost = mapping.problem, Cost()
        last: tuple[float, float] | None = None
        for _ in range(self.corrections):
            normal = replace(problem.free_pressure, approach=approach)
            mapping = replace(mapping, problem=replace(problem, normal=normal))
            missed = np.inf if last is None else abs(last[1])
            # The load can be no better than the contact from which it is summed.
            inner = max(0.1 * tolerance, min(1e-3, 0.1 * missed))
            iterated, mapping = self.iterate(mapping, inner, state)
            cost = iterated.cost + cost
            outcome = replace(iterated, cost=cost)
            if not iterated.converged:
                return outcome
            fields = iterated.fields
            backend = backend_of(fields.pressure)
            state = backend.concat((fields.pressure[None, ...], fields.traction))
            error = problem.operators.lattice.sum(fields.pressure) / load - 1.0
            if abs(error) <= tolerance and iterated.residual <= tolerance:
                return outcome
            # Secants, within reason of Hertz's load ~ approach^3/2: a load from a contact that is
            # not solved sharply does not bear an extrapolation.
            slope = hertz = 1.5 / approach
            if last is not None and approach != last[0]:
                slope = (error - last[1]) / (approach - last[0])
                slope = min(max(slope, 0.3 * hertz), 3.0 * hertz)
            last = (approach, error)
            approach -= error / slope
        return replace(outcome, status=Status.OUT_OF_ITERATIONS)

    @staticmethod
    def _outcome(
        status: Status,
        mapping: ProjectedMap,
        state: Array,
        evaluation: Evaluation,
        taken: int,
        again: int,
    ) -> Outcome:
        """Return the outcome of an iteration, with its cost."""
        normal = mapping.problem.normal
        return Outcome(
            status,
            evaluation.residual,
            taken,
            Cost(taken + 1.0 + again),
            pressure=normal.pressure if isinstance(normal, FixedPressure) else state[0, ...],
            gap=evaluation.gap,
            traction=state[-2:, ...],
            slip=evaluation.slip,
            approach=normal.approach if isinstance(normal, NormalProblem) else None,
            creepage=np.zeros(0),
        )


@dataclass(frozen=True)
class Anderson(Projection):
    """Anderson acceleration of the projected iteration: the last images are combined.

    Anderson (1965), J. ACM 12, 547-560; Walker & Ni (2011), SIAM J. Numer. Anal. 49, 1715-1735.

    A state that makes the residual ten times the best one so far restarts the memory from the
    best state.

    Attributes
    ----------
    step_factor : float
        Step of the slip over its bound; acceleration tolerates and profits from longer ones than
        Uzawa's method.
    memory : int
        Images that are combined with the last one.
    iterations : int
        Most iterations.
    """

    step_factor: float = 16.0
    memory: int = 12
    iterations: int = 5_000

    name: ClassVar[str] = "anderson"

    def _states(self, mapping: ProjectedMap, state: np.ndarray) -> States:
        """Yield (map, state) to evaluate, each state combined from the last images."""
        images: list[np.ndarray] = []
        changes: list[np.ndarray] = []
        best, smallest = state, np.inf
        while True:
            evaluation = yield mapping, state
            if not np.isfinite(evaluation.residual) or evaluation.residual > 10.0 * smallest:
                if not images:
                    return
                images, changes = [], []
                state, smallest = best, np.inf
                continue
            if evaluation.residual < smallest:
                best, smallest = state, evaluation.residual
            images.append(evaluation.image)
            changes.append(evaluation.image - state)
            del images[: -self.memory - 1], changes[: -self.memory - 1]
            state = mapping.admissible(combine_images(images, changes))


def combine_images(images: Sequence[np.ndarray], changes: Sequence[np.ndarray]) -> np.ndarray:
    """Return the affine combination of images for which the combined change is smallest."""
    if len(images) == 1:
        return images[0]
    differences = np.stack([(changes[-1] - c).ravel() for c in changes[:-1]])
    gram = differences @ differences.T
    weights = np.linalg.lstsq(gram, differences @ changes[-1].ravel(), rcond=1e-14)[0]
    return images[-1] - sum(
        w * (images[-1] - image) for w, image in zip(weights, images[:-1], strict=True)
    )


@dataclass(frozen=True)
class Uzawa(Projection):
    """Solver by Uzawa's iteration: repeated projected steps (paper, section 7.5).

    Departures from the paper: the paper stops on the change of the iterate, which is small also
    after a short step; here the residual of the contact conditions has to fall. The paper leaves
    the choice of the steps to the user; here they follow from a bound and are shortened if the
    residual does not fall.

    Attributes
    ----------
    step_factor : float
        Step of the slip over its bound: fastest at 31 x 31 and at 91 x 91 on the scene `spheres`; 8
        and 10 times the bound diverge there.
    iterations : int
        Most iterations.
    patience : int
        Iterations without a smaller residual after which the step counts as too long.
    shorter : float
        Factor by which the step is shortened then.
    """

    step_factor: float = 5.5
    iterations: int = 100_000
    patience: int = 400
    shorter: float = 0.7

    name: ClassVar[str] = "uzawa"

    def _states(self, mapping: ProjectedMap, state: np.ndarray) -> States:
        """Yield (map, state) to evaluate; shorten the steps if the residual stagnates."""
        best, smallest, since = state, np.inf, 0
        for taken in count():
            evaluation = yield mapping, state
            if evaluation.residual < smallest:
                best, smallest, since = state, evaluation.residual, taken
            elif not np.isfinite(evaluation.residual) or taken - since > self.patience:
                mapping = mapping.shortened(self.shorter)
                state, since = best, taken
                continue
            state = evaluation.image
