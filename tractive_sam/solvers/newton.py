"""Preconditioned semismooth Newton-Krylov method, and the linear system of one step.

Vectors of the system are [fields, approach (under load), creepages]; see `Problem` for the fields.
Everything tangential is written once, for fields[-2:], whether or not there is a pressure before.

The friction law is the root of F(p) = p - disc(p - s(p)), unilateral contact the root of p - max(0,
p - gap). In a step the slip of an element that sticks vanishes, and the traction of one that slips
moves along the disc. For bodies of equal material the tractions are the only unknowns, under a
fixed pressure. Pressure makes dissimilar surfaces slip and tractions make them lift, and
alternating between both problems diverges for strong coupling: then pressure and tractions are
unknowns of one iteration.

The linear systems are preconditioned by the circulant inverse for the pressure and by the
kinematics for the tractions (`operators.kinematics`). They are solved by generalised conjugate
residuals, so that no application of the elastic operator is lost: the response to a step is known
unless a traction has to be returned to its bound. Where single precision is sufficient, and pays,
GMRES solves them with an operator of a shorter period; it stores one vector of each iteration.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import hypot, isfinite, prod, sqrt

import numpy as np

from tractive_sam.results import Cost, Status
from tractive_sam.solvers.krylov import Basis, ConjugateGradients, conjugate_residuals, gmres
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
    report_progress,
)


class Iterate:
    """Newton iterate: fields, approach and creepages, with the residual of contact conditions.

    Tractions may be tiny compared with the pressure. They and their slip are weighted by `ratio`,
    the size of the pressure over the size of the tractions, as in the merit.

    Tractions beyond their bound are returned to it, which is safer while stick and slip zones move.
    But if mu1 and mu2 differ much, a step can push an element that is at its bound, and assumed to
    stick, outwards along the weak axis. Returned every time, it never slips. If not `bounded` it
    stays outside, and the next linearisation finds that it slips.

    The response of the operator to the fields may be known (`response`); if it is not, or a
    traction was returned to its bound, `applications` is one.
    """

    rounding = 4.0 * float(np.finfo(float).eps)
    """Relative rounding error of a response of the operator."""

    def __init__(
        self,
        problem: Problem,
        pressure: np.ndarray,
        traction: np.ndarray,
        approach: float,
        creepage: np.ndarray,
        ratio: float = 1.0,
        bounded: bool = True,
        response: np.ndarray | None = None,
    ):
        fixed, normal, forces = problem.is_pressure_fixed, problem.normal, problem.forces
        self.pressure = pressure if fixed else np.maximum(pressure, 0.0)
        self.bound = problem.bound(self.pressure)
        self.traction, self._bounded = traction, bounded
        if bounded:
            self.traction = problem.project(traction, self.bound.radius, physical=True)
        self.approach, self.creepage = approach, creepage
        self.applications = 0
        # Making the fields admissible may have changed them.
        fields = ((self.traction, traction), (self.pressure, pressure))
        changed = any(new is not old and (new != old).any() for new, old in fields)
        if response is None or changed:
            response, self.applications = problem.response(self.fields(fixed)), 1
        self.response = response
        self.slip = problem.rigid + response[-2:]
        if len(forces):
            self.slip += forces.slip(creepage)
        self.gap = normal.gap if fixed else normal.gap + response[0] - approach
        self.active = problem.touching if fixed else self.pressure > self.gap
        # An element with an open gap has left the contact, whatever pressure a step has left on it.
        touching = self.pressure if fixed else closed(self.pressure, self.gap)
        self.seen = problem.friction_slip(touching, self.gap)
        # The tractions lie within the bound at rest, the law needs the bound under the slip.
        self.bound = problem.bound_sliding(
            self.bound, self.pressure, self.traction, self.slip, self.seen
        )
        self.law = problem.linearise(
            self.traction, self.slip, self.bound, self.seen, None if fixed else self.active
        )
        self.elastic_slip = forces.elastic_slip(self.slip, creepage)
        self._set_residual(problem)
        self.merit = self.merit_by(ratio)

    def _set_residual(self, problem: Problem) -> None:
        """Compute and store the residual, the missing load and forces, and their weights."""
        forces = problem.forces
        # Resultants, given and missed, count as if spread evenly over the contact.
        self.elements = elements = max(int(np.count_nonzero(self.active)), 1)
        self.load_missed = 0.0 if problem.load is None else problem.load - self.pressure.sum()
        self.force_missed, missed, wanted = forces.target, 0.0, 0.0
        if len(forces):
            self.force_missed = forces.target - forces.force(self.traction)
            missed = np.sum(self.force_missed**2) / elements
            wanted = float(np.linalg.norm(forces.target) / np.sqrt(elements))
        self.drag = drag = max(sqrt(self.law.reached), wanted)
        self._tangential = self.law.merit + missed
        self._normal = 0.0
        defect = sqrt(self.law.squares + missed)
        # Tractions cannot be known better than the slip, which is rounded as its parts are.
        largest = max(self.response[-2:].max(), -self.response[-2:].min())
        rounded = self.rounding * sqrt(self.pressure.size) * largest
        self.residual = relative(defect, drag) if defect > rounded else 0.0
        self.ratio = 1.0
        if not problem.is_pressure_fixed:
            self._normal = np.sum(np.minimum(self.pressure, self.gap) ** 2)
            self._normal += self.load_missed**2 / elements
            # No less than of a pressure that has the load: to have none is no solution.
            even = (problem.load or 0.0) / np.sqrt(elements)
            size = max(float(np.linalg.norm(self.pressure)), float(even))
            self.residual = max(relative(np.sqrt(self._normal), size), self.residual)
            self.ratio = float(max(size / drag, 1.0)) if drag > 0.0 else 1.0

    @property
    def is_admissible(self) -> bool:
        """Return whether open gaps carry no pressure, and tractions are within their bound."""
        return self._bounded and not (self.pressure[~self.active] > 0.0).any()

    def within_bound(self, problem: Problem) -> "Iterate":
        """Return the iterate without pressure on open gaps, with tractions within their bound."""
        pressure = self.pressure if problem.is_pressure_fixed else closed(self.pressure, self.gap)
        return Iterate(problem, pressure, self.traction, self.approach, self.creepage)

    def fields(self, fixed: bool) -> np.ndarray:
        """Return the unknown fields: tractions, preceded by the pressure unless it is fixed."""
        return self.traction if fixed else np.concatenate((self.pressure[None], self.traction))

    def merit_by(self, ratio: float) -> float:
        """Return the norm of the residual, with its tangential part weighted by `ratio`."""
        # The ratio may be larger than what a square can be.
        return hypot(sqrt(self._normal), ratio * sqrt(self._tangential))


class System:
    """Linear system of a Newton step at an iterate, in the number type `kind`.

    An `approximate` system has the response of `Problem.approximate`.

    An element in contact asks that its gap close, one that has left that its pressure vanish, and
    the friction law for what `Linearisation` says. A slipping traction follows its bound along its
    direction, and with it the pressure.

    Attributes
    ----------
    applications, preconditionings : int
        Work done.
    """

    def __init__(
        self, problem: Problem, at: Iterate, kind: type[np.floating], approximate: bool = False
    ):
        self.problem, self.at, self.kind = problem, at, kind
        self._respond = (problem.approximate if approximate else problem).response
        self.operators, self.vectors = problem.operators, problem.forces.vectors
        self.free, self.under_load = not problem.is_pressure_fixed, problem.load is not None
        self.shape = problem.shape
        self.size = prod(self.shape)
        self.length = self.size + self.under_load + len(self.vectors)
        self.weight = 1.0 / sqrt(at.elements)
        self._inverse = problem.kinematics.approximate_inverse(
            self.operators, at.law, at.seen.stiffness
        )
        self.applications = self.preconditionings = 0
        # The traction of an element that slips, per pressure that its bound rises with.
        self._following = at.law.direction * at.bound.by_pressure if self.free else None
        self._out: np.ndarray = np.empty(self.length, kind)
        self._rows_made = self.fields(self._out)

    def fields(self, vector: np.ndarray) -> np.ndarray:
        """Return pressure and tractions in a vector of unknowns, a view of its first part.

        The shape is (3, n_x, n_y); under a fixed pressure (2, n_x, n_y), the tractions only.
        """
        return vector[: self.size].reshape(self.shape)

    def _rows(self, step: np.ndarray, response: np.ndarray) -> np.ndarray:
        """Return the linearised contact conditions for a step and its elastic response.

        They are the fields of the vector that `operator` returns, and overwritten by the next ones.
        """
        at, rows, tangential = self.at, self._rows_made, step[-2:]
        if self.free:
            rows[0] = np.where(at.active, response[0], step[0])
            slip = at.seen.sticking_change(response[1:], at.traction, step, response[0], at.slip)
            tangential = tangential - self._following * step[0]
        else:
            slip = at.seen.sticking(response, step, pressure=0.0)
        at.law.rows(tangential, slip, rows[-2:])
        if at.ratio != 1.0:
            rows[-2:] *= at.ratio
        return rows

    def _resultants(self, step: np.ndarray) -> np.ndarray:
        """Return load (if prescribed) and tangential forces of a step of the fields."""
        sums = self.at.ratio * self.vectors @ step[-2:].sum(axis=(1, 2))
        return np.concatenate(([step[0].sum()], sums)) if self.under_load else sums

    def _extended(self, response: np.ndarray, extra: np.ndarray) -> np.ndarray:
        """Return a change of gap and slip plus that due to changed approach and creepages."""
        if extra.size:
            response = response.copy()
        if self.under_load:
            response[0] -= extra[0]
        if len(self.vectors):
            response[-2:] += (extra[int(self.under_load) :] @ self.vectors)[:, None, None]
        return response

    def right_hand_side(self) -> np.ndarray:
        """Return the right-hand side: the negative residual of the contact conditions."""
        at = self.at
        rhs: np.ndarray = np.zeros(self.length, self.kind)
        rows = self.fields(rhs)
        if self.free:
            rows[0] = np.where(at.active, -at.gap, -at.pressure)
        rows[-2:] = at.ratio * at.law.defect
        missed = at.ratio * at.force_missed
        if self.under_load:
            missed = np.concatenate(([at.load_missed], missed))
        rhs[self.size :] = self.weight * missed
        return rhs

    def response(self, vector: np.ndarray) -> np.ndarray:
        """Return the elastic gap and slip due to the fields in a vector of unknowns."""
        self.applications += 1
        return self._respond(self.fields(vector))

    def product(self, vector: np.ndarray, response: np.ndarray) -> np.ndarray:
        """Return the matrix times a vector with a known response; the next call overwrites it."""
        step = self.fields(vector)
        self._rows(step, self._extended(response, vector[self.size :]))
        if self.length > self.size:
            self._out[self.size :] = self.weight * self._resultants(step)
        return self._out

    def operator(self, vector: np.ndarray) -> np.ndarray:
        """Return the Newton matrix times a vector; the next call overwrites the result."""
        return self.product(vector, self.response(vector))

    def _approximate_inverse(self, rows: np.ndarray) -> np.ndarray:
        """Return fields that approximately cause these rows: the block preconditioner."""
        at = self.at
        tangential = rows[-2:] if at.ratio == 1.0 else rows[-2:] / at.ratio
        step = self._inverse(tangential)
        self.preconditionings += 1
        if not self.free:
            return step
        normal = np.where(at.active, self.operators.normal_inverse(rows[:1])[0], rows[0])
        return np.concatenate((normal[None], step + self._following * normal))

    @cached_property
    def _border(self) -> tuple[list[np.ndarray], np.ndarray]:
        """Preconditioned columns of approach and creepages, and their Schur complement."""
        count = self.length - self.size
        zero: np.ndarray = np.zeros(self.shape, self.kind)
        responses = [
            self._approximate_inverse(self._rows(zero, self._extended(zero, unit)).copy())
            for unit in np.eye(count)
        ]
        sums = [self._resultants(response) for response in responses]
        return responses, np.array(sums).T.reshape(count, count)

    def preconditioner(self, vector: np.ndarray) -> np.ndarray:
        """Apply the preconditioner: the approximate inverse bordered by load and forces."""
        step = self._approximate_inverse(self.fields(vector))
        if self.length == self.size:
            return step.reshape(-1)
        out: np.ndarray = np.empty(self.length, self.kind)
        responses, schur = self._border
        missed = self._resultants(step) - vector[self.size :] / self.weight
        # Least squares: in full slip the forces do not answer the creepages.
        extra = np.linalg.lstsq(schur, missed, rcond=1e-12)[0]
        for c, response in zip(extra, responses, strict=True):
            step -= c * response
        out[self.size :] = extra
        out[: self.size] = step.ravel()
        return out


@dataclass(frozen=True)
class Newton:
    """Semismooth Newton solver with inexact linear solves and damping.

    Attributes
    ----------
    steps : int
        Most steps.
    krylov : int
        Largest number of iterations of the linear solver in a step.
    halvings : int
        Most lengths of a step that are tried.
    rise : float
        Ratio of the merit to the previous one up to which a length is accepted at once.
    bounded : bool
        Whether tractions are returned to their bound after each step (`Iterate`), which takes an
        application, or may stay outside it between steps.
    patience : int
        Steps without a smaller residual after which `bounded` is reversed, and, once it is, after
        which steps are damped.
    hopeless : int
        Steps without a smaller residual after which the method stops.
    loosest : float
        Loosest relative residual of the linear system of a step.
    sharpest : float
        Smallest relative residual of the linear system, of undamped steps.
    sharp : float
        Relative residual of a damped step: once the residual has stalled, only a sharp step is sure
        to lead down.
    aim : float
        Part of the tolerance that a linear system is to leave.
    rough : float
        Relative residual down to which a linear system may be solved in single precision.
    rounding : float
        Part of the tolerance that the rounding of the response to a step may take; otherwise the
        response is evaluated again, in double precision. If vectors of the Krylov space cancel,
        their rounding is up to 80 times the estimate from their sum.
    single_from : float
        Number of elements from which single precision pays: below, planning its transforms costs as
        much, unless they are used for many problems.
    gmres_from : float
        Number of elements from which systems in single precision are solved by GMRES, which stores
        one vector of an iteration, not three.
    inside : float
        Share of the bound below which an initial guess is assumed to stick.
    """

    golden = 0.5 * (1.0 + 5.0**0.5)

    steps: int = 60
    krylov: int = 150
    halvings: int = 6
    rise: float = 1.5
    bounded: bool = True
    patience: int = 3
    hopeless: int = 20
    loosest: float = 0.3
    sharpest: float = 1e-3
    sharp: float = 1e-5
    aim: float = 0.3
    rough: float = 1e-4
    rounding: float = 0.02
    single_from: float = 1_500
    gmres_from: float = 1_500
    inside: float = 0.999

    def solve(
        self, problem: Problem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Solve a problem with free or fixed pressure; raise a ValueError if it has wear in a pass.

        Parameters
        ----------
        problem : Problem
            The problem.
        tolerance : float
            Natural residual, relative, at which to stop.
        start : Start or Outcome, optional
            First guess; by default of the pressure that without tractions, roughly, and zero of the
            rest.

        Raises
        ------
        ValueError
            If the problem has wear within the pass.
        """
        if problem.wear is not None:
            raise ValueError(
                "problem.wear: Newton's method takes wear only in the gap; use solvers.Uzawa"
            )
        at, cost = self._first(problem, start)
        smallest, since, before, bounded = np.inf, 0, np.inf, self.bounded
        status, taken, memory = Status.OUT_OF_ITERATIONS, 0, Basis()
        for taken in range(self.steps + 1):
            report_progress(problem.operators.lattice.shape, at.residual)
            if at.residual <= tolerance and not (problem.kinematics.joint or at.is_admissible):
                # Only the slip by these tractions dissipates what drives the bodies.
                at, bounded, cost = at.within_bound(problem), True, cost + Cost(1.0)
            if at.residual <= tolerance:
                status = Status.CONVERGED
                break
            if not isfinite(at.residual) or problem.forces.diverged(at.creepage, at.elastic_slip):
                status = Status.DIVERGED
                break
            if at.residual < 0.9 * smallest:
                smallest, since = at.residual, taken
            is_spent = taken == self.steps or cost.applications >= problem.most
            if is_spent or taken - since > self.hopeless:
                break
            stalled = taken - since >= self.patience
            if stalled and bounded is self.bounded:
                bounded, stalled = not bounded, False
                smallest, since = at.residual, taken
            goal = self.sharp if stalled else self.forcing(at.residual, before, tolerance)
            before = at.residual
            at, spent = self._advance(problem, at, goal, tolerance, stalled, bounded, memory)
            cost = cost + spent
        return _outcome(problem, at, status, taken, cost)

    def _first(self, problem: Problem, start: Start | Outcome | None) -> tuple[Iterate, Cost]:
        """Return (first iterate, cost), from a start or a rough normal solution."""
        cost, normal = Cost(), problem.normal
        if start is None and isinstance(normal, NormalProblem):
            outcome = ConjugateGradients().solve(normal, 1e-3)
            start, cost = (
                Start(outcome.pressure, approach=needed(outcome.approach, "approach")),
                cost + outcome.cost,
            )
        start = start or Start()
        traction = np.zeros_like(problem.rigid) if start.traction is None else start.traction
        creepage = start.creepage
        if creepage is None or not len(problem.forces):
            creepage = np.zeros(len(problem.forces))
        pressure, approach = start.pressure, start.approach
        if isinstance(normal, FixedPressure):
            pressure, approach = normal.pressure, 0.0
        elif normal.load is None:
            approach = normal.approach
        guess = needed(pressure, "start.pressure"), traction, needed(approach, "start.approach")
        at = Iterate(problem, *guess, creepage)
        if len(problem.forces) and start.creepage is not None and not self.bounded:
            at = self._with_smallest_slip(problem, at)
        return at, cost + Cost(at.applications)

    def _with_smallest_slip(self, problem: Problem, at: Iterate) -> Iterate:
        """Return an iterate with creepages of least slip where elements stick, if any do."""
        sticks = np.hypot(*at.traction) < self.inside * at.bound.radius
        if not sticks.any():
            return at
        slip = at.slip[:, sticks].mean(axis=1)
        change = np.linalg.lstsq(problem.forces.vectors.T, -slip, rcond=None)[0]
        fields = at.pressure, at.traction, at.approach
        return Iterate(problem, *fields, at.creepage + change, 1.0, False, at.response)

    def _advance(
        self,
        problem: Problem,
        at: Iterate,
        goal: float,
        tolerance: float,
        stalled: bool,
        bounded: bool,
        memory: Basis,
    ) -> tuple[Iterate, Cost]:
        """Return the iterate after one Newton step, and the cost of the step."""
        elements = at.pressure.size
        kind = self.precision(goal, at.residual, tolerance, elements)
        approximate = kind is np.float32 and elements >= self.gmres_from
        system = System(problem, at, kind, approximate)
        response: np.ndarray | None = None
        if not approximate:
            vector, response_to_step = conjugate_residuals(system, goal, self.krylov)
            rounded = float(np.finfo(system.kind).eps * np.linalg.norm(response_to_step[-2:]))
            if rounded <= self.rounding * tolerance * at.drag:
                response = response_to_step.astype(float, copy=False)
        else:
            maps = system.operator, system.preconditioner
            vector, _ = gmres(*maps, system.right_hand_side(), goal, self.krylov, memory)
        vector = vector.astype(float, copy=False)  # iterates are in double precision
        step, extra = system.fields(vector), vector[system.size :]
        ahead, trials = self._step_along(problem, at, step, extra, response, stalled, bounded)
        return ahead, Cost(system.applications + trials, system.preconditionings)

    def _step_along(
        self,
        problem: Problem,
        at: Iterate,
        step: np.ndarray,
        extra: np.ndarray,
        response: np.ndarray | None,
        stalled: bool,
        bounded: bool,
    ) -> tuple[Iterate, int]:
        """Return the iterate after a damped step, and the operator applications it took.

        Parameters
        ----------
        step : ndarray, shape (2 or 3, n_x, n_y)
            Change of the fields.
        extra : ndarray
            Change of the approach, under a load, and of the creepages.
        response : ndarray, optional
            Response of the operator to the step, if it is known.
        """
        under_load = problem.load is not None
        closer, faster = extra[:under_load].sum(), extra[int(under_load) :]
        trials = 0

        def trial(length: float) -> Iterate:
            nonlocal trials
            iterate = Iterate(
                problem,
                at.pressure if problem.is_pressure_fixed else at.pressure + length * step[0],
                at.traction + length * step[-2:],
                at.approach + length * closer,
                at.creepage + length * faster,
                at.ratio,
                bounded,
                None if response is None else at.response + length * response,
            )
            trials += iterate.applications
            return iterate

        length = problem.forces.trust_fraction(at.creepage, faster, at.elastic_slip)
        return self.damped(trial, at.merit_by(at.ratio), length, stalled), trials

    def forcing(self, residual: float, before: float, tolerance: float) -> float:
        """Return the relative tolerance of the next linear system (inexact Newton).

        It follows the gain of the previous step (Eisenstat & Walker 1996, SIAM J. Sci. Comput. 17,
        16-32, choice 2): loose while the stick and slip zones still move, sharp towards the end,
        and never sharper than the tolerance needs.

        Parameters
        ----------
        residual, before : float
            Current natural residual, and the one before the last step; infinite before the first
            one.
        tolerance : float
            Tolerance of the problem.
        """
        gained = min(1.0, residual / before) ** self.golden if before < np.inf else 1.0
        loosest = min(self.loosest, residual**0.25)  # the sharper, the nearer the first guess
        wanted = max(min(loosest, 0.9 * gained), self.sharpest, self.aim * tolerance / residual)
        return float(min(wanted, 0.5))

    def precision(
        self, goal: float, residual: float, tolerance: float, elements: int
    ) -> type[np.floating]:
        """Return single precision for rough goals on large meshes; else double precision.

        Rounding in single precision, 6e-8 of each number, is far below a `rough` goal, even summed
        over a Krylov space, and a step moves half the memory. A response that is stored must not
        add its rounding to the residual of the solution.

        Parameters
        ----------
        goal : float
            Relative residual to which to solve.
        residual, tolerance : float
            Current natural residual, and the tolerance of the problem.
        elements : int
            Number of elements.
        """
        rounded = float(np.finfo(np.float32).eps) * residual
        stored_exactly = rounded <= self.rounding * tolerance or elements >= self.gmres_from
        single = goal >= self.rough and elements >= self.single_from and stored_exactly
        return np.float32 if single else np.float64

    def damped(
        self, trial: Callable[[float], Iterate], merit: float, length: float, stalled: bool
    ) -> Iterate:
        """Return the iterate of the longest acceptable step by halving, else that of least merit.

        The active sets of a step may be worse for some steps before the solution improves, so some
        rise is allowed. If no length is that good, the best one is taken. If the residual has
        `stalled`, full steps swing between two states, and the best length is taken as well.
        """
        trials = []
        for _ in range(self.halvings):
            trials.append(trial(length))
            if not stalled and trials[-1].merit <= self.rise * merit:
                return trials[-1]
            length *= 0.5
        return min(trials, key=lambda iterate: iterate.merit)


def _outcome(problem: Problem, at: Iterate, status: Status, taken: int, cost: Cost) -> Outcome:
    """Return the outcome at an iterate, with pressure and tractions within their bounds."""
    # Tractions beyond a bound, and pressure in an open gap, are part of the residual.
    pressure = at.pressure if problem.is_pressure_fixed else closed(at.pressure, at.gap)
    bound = problem.bound(pressure).radius
    return Outcome(
        status,
        float(at.residual),
        taken,
        cost,
        pressure=pressure,
        gap=at.gap,
        traction=problem.project(at.traction, bound, physical=True),
        slip=at.slip,
        approach=float(at.approach),
        creepage=at.creepage,
        trace=(Note("newton" if problem.is_pressure_fixed else "coupled newton", status),),
    )
