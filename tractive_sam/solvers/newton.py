"""Preconditioned semismooth Newton-Krylov method.

The friction law is the root of F(p) = p - disc(p - s(p)), unilateral contact the root of p - max(0,
p - gap). In a step the slip of an element that sticks vanishes, and the traction of one that slips
moves along the disc. For bodies of equal material the tractions are the only unknowns, under a
fixed pressure. Pressure makes dissimilar surfaces slip and tractions make them lift, and
alternating between both problems diverges for strong coupling: then pressure and tractions are
unknowns of one iteration.

The linear systems are preconditioned by the circulant inverse for the pressure and by the
kinematics for the tractions (`operators.kinematics`). They are solved by generalised conjugate
residuals, so that no application of the elastic operator is lost: the response to a step is known
unless a traction has to be returned to its bound. On large meshes they are solved by GMRES in
single precision, which holds one vector of each iteration instead of three.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tractive_sam.results import Cost, Status
from tractive_sam.solvers.conjugate_gradients import ConjugateGradients
from tractive_sam.solvers.krylov import Basis, conjugate_residuals, gmres
from tractive_sam.solvers.newton_system import Iterate, System
from tractive_sam.solvers.outcome import Note, Outcome, Start, closed, needed
from tractive_sam.solvers.problem import FixedPressure, NormalProblem, Problem
from tractive_sam.solvers.progress import report_progress


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
    single_from: float = 5_000
    gmres_from: float = 5_000
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
            if at.residual <= tolerance and not (at.is_admissible or problem.kinematics.joint):
                # Only the slip by these tractions dissipates what drives the bodies.
                at, bounded, cost = at.within_bound(problem), True, cost + Cost(1.0)
            if at.residual <= tolerance:
                status = Status.CONVERGED
                break
            if not np.isfinite(at.residual) or problem.forces.diverged(
                at.creepage, at.elastic_slip
            ):
                status = Status.DIVERGED
                break
            if at.residual < 0.9 * smallest:
                smallest, since = at.residual, taken
            if taken - since > self.hopeless or taken == self.steps:
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
        return at.with_creepage(problem, at.creepage + change)

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
