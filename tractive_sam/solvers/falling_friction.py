"""Friction that falls with sliding: solutions by continuation from rest, and their uniqueness.

Consider one element of compliance c, with fixed tractions of all others: if its traction falls by
dq, it slips by c dq more. An element that sticks under q can also slide by s if its bound g has
fallen enough: c (q - g(s)) >= s. An element that slides by s can also stick, under g(s) + s/c, if
the bound of rest allows it: c (g(0) - g(s)) >= s. Both are secants of the bound. A second state of
sliding is possible if the tangent is steep: -c g'(s) >= 1.

In steady rolling a particle slips by the difference of two displacements, so that elements behind
hardly act on those ahead, and each counts alone. In a step it slips by the displacement itself:
all elements displace each other, and their bounds fall together. Two solutions differ in slip by
ds = -A dq, with dq = -G ds by the secants G of the bounds: there is one solution if the spectral
radius of G A is below one.

If Newton's method fails, a path begins in full slip, at `full` times the creepages: there tractions
oppose the rigid slip, whatever the elasticity does. As the creepages fall, stick spreads from the
leading edge. A stretch of the path that fails is halved.

A falling law may have several solutions. The path begins with friction at rest (or at great speed),
which has one, and Newton's method leads from there. If it fails, the path passes through slower (or
faster) rolling, and each problem starts from the one before. If the solution that the path follows
ceases to exist, friction is fixed at its values in the last solution, again and again, which leads
to the next solution. If prescribed forces are not found, the traction curve is followed up to its
maximum.

`Bracketing` finds prescribed forces by a search between creepages. A force falls as its creepage
grows. If nearly everything slips it falls in stairs, one for every
element that turns from slipping forward to slipping backward. This happens in dissimilar bodies
that roll freely with little friction. A Newton step finds no slope on a stair, and a far too steep
one between two. A search between a creepage with too much force and one with too little still finds
the force.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import scipy

from tractive_sam.mechanics import Bound, ScaledFriction
from tractive_sam.operators import FrictionSlip
from tractive_sam.results import Status
from tractive_sam.solvers.problem import (
    FixedPressure,
    Note,
    Outcome,
    PrescribedForces,
    Problem,
    ProblemSolver,
    Start,
    needed,
)


def steepness(
    problem: Problem,
    pressure: np.ndarray,
    gap: np.ndarray,
    traction: np.ndarray,
    slip: np.ndarray,
    reaction: float = 1.1,
) -> float:
    """Return the fall of friction over its uniqueness limit; from 1 on several solutions may exist.

    Parameters
    ----------
    problem : Problem
        The problem that was solved.
    pressure, gap : ndarray, shape (n_x, n_y)
        Pressure and gap of the solution, dimensionless.
    traction, slip : ndarray, shape (2, n_x, n_y)
        Traction of the solution and slip of the leading faces, dimensionless.
    reaction : float
        Ratio of an element's compliance with elastic neighbours to that with fixed ones. With it,
        18 of 22 random line contacts from 1 on have another solution, and none of 38 below
        (``benchmarks/branches.py``).
    """
    seen = problem.friction_slip(pressure, gap)
    bound = problem.bound_sliding(problem.bound(pressure), pressure, traction, slip, seen)
    if bound.slope is None:
        return 0.0
    sliding, _ = problem.sliding(pressure, gap, traction, slip)
    joint = problem.kinematics.joint
    compliance = max(problem.kinematics.self_influence(problem.operators)[::2])
    tangent = float(bound.slope.steepness[sliding].max(initial=0.0))
    if seen.staggered and not joint:
        # The slip at the centre has three quarters of the slip of the leading face. Being a mean of
        # faces it is continuous from stick to slip: secants do not matter.
        return 0.75 * compliance * tangent
    size = np.hypot(*seen.sticking(slip, traction))
    samples = 48 if joint else 96
    secants = _secants(problem, seen, bound, pressure, traction, sliding, size, samples)
    if joint:
        slope = np.maximum(secants, np.where(sliding, bound.slope.steepness, 0.0))
        return _joint_steepness(problem, traction, slope)
    return compliance * max(tangent, reaction * float(secants.max(initial=0.0)))


@dataclass(frozen=True)
class UniqueSolution:
    """Solver that uses a start only if the solution is unique, else follows a path.

    So the result does not depend on the start of the search.

    Attributes
    ----------
    nearby : ProblemSolver
        Solves a problem from a start.
    path : ProblemSolver
        Solves it without a start, if `nearby` fails or finds one of several solutions.
    attempt : float
        Applications after which `nearby` gives up.
    """

    nearby: ProblemSolver
    path: ProblemSolver
    attempt: float = 400.0

    def solve(
        self, problem: Problem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Solve from a start; if several solutions may exist, solve again without it."""
        if start is None or not problem.kinematics.joint:
            return self.path.solve(problem, tolerance, start)
        outcome = self.nearby.solve(replace(problem, most=self.attempt), tolerance, start)
        if not outcome.converged:
            return self.path.solve(problem, tolerance).costing(outcome)
        solution = outcome
        if isinstance(fixed := problem.normal, FixedPressure):
            solution = replace(outcome, pressure=fixed.pressure, gap=fixed.gap)
        steepest = steepness(problem, *solution.fields)
        if steepest < 1.0:
            return replace(outcome, steepness=steepest)
        return self.path.solve(problem, tolerance).costing(outcome)


def _joint_steepness(
    problem: Problem, traction: np.ndarray, slope: np.ndarray, iterations: int = 6
) -> float:
    """Return the spectral radius that decides on uniqueness if elements act on each other.

    Parameters
    ----------
    problem : Problem
        A step.
    traction : ndarray, shape (2, n_x, n_y)
        Tractions of the solution.
    slope : ndarray, shape (n_x, n_y)
        Slopes of the bounds.
    iterations : int
        Most power iterations, of one application each. Scaled by the root of the slopes the matrix
        is symmetric and nearly positive: the error of Rayleigh's quotient falls with the square,
        and a vector that shrinks everywhere shows that the radius is below one (Collatz 1942,
        Math. Z. 48, 221-226), which is all that matters then.
    """
    carried, root = np.hypot(*traction), np.sqrt(np.maximum(slope, 0.0))
    if not root.any():
        return 0.0
    along = root * traction / np.where(carried > 0.0, carried, 1.0)
    vector, radius = root / np.linalg.norm(root), 0.0
    for _ in range(iterations):
        answer = (along * problem.operators.tangential(along * vector)).sum(axis=0)
        radius = float((vector * answer).sum())
        ahead = vector > 0.0
        if (answer[ahead] < vector[ahead]).all():
            break
        vector = np.maximum(answer, 0.0) / np.linalg.norm(answer)
    return radius


def _secants(
    problem: Problem,
    seen: FrictionSlip,
    bound: Bound,
    pressure: np.ndarray,
    traction: np.ndarray,
    sliding: np.ndarray,
    size: np.ndarray,
    samples: int,
) -> np.ndarray:
    """Return the steepest secants of falling friction between stick and slip, (n_x, n_y).

    The fall of a bound is summed up over slips from 1e-6 to 100 of full slip, of 96 each a fifth
    more than the one before, so that a memory counts only as far as the element itself fills it.
    """
    carried = np.hypot(*traction)
    sticking = (seen.bound > 0.0) & ~sliding
    against = -traction / np.where(carried > 0.0, carried, 1.0)
    fall = before = np.zeros_like(carried)
    last, steepest = 0.0, np.zeros_like(carried)
    for slipped in np.geomspace(1e-6, 1e2, samples):
        moved = problem.friction.bound_sliding(
            pressure, slipped * against, seen.bound, seen.staggered
        )
        slope = needed(moved.slope, "bound.slope").steepness
        ahead = fall + 0.5 * (slope + before if last else 2.0 * slope) * (slipped - last)
        passed = sliding & (last < size) & (size <= slipped)
        share = (size[passed] - last) / (slipped - last)
        fallen = fall[passed] + share * (ahead - fall)[passed]
        steepest[passed] = np.maximum(steepest[passed], fallen / size[passed])
        missed = carried - (bound.radius - ahead)
        steepest = np.where(sticking, np.maximum(steepest, missed / slipped), steepest)
        fall, before, last = ahead, slope, slipped
    return steepest


@dataclass(frozen=True)
class Continuation:
    """Solver that follows a path of easier problems, from full slip to the prescribed creepages.

    Attributes
    ----------
    solver : ProblemSolver
        Solves each problem, from the outcome of the one before.
    full : float
        Creepages at the beginning of the path, over the prescribed ones.
    first, shortest : float
        Stretches of the path from 0 to 1: the first one, and the shortest before giving up.
    rough : float
        Residual of the problems before the last.
    """

    solver: ProblemSolver
    full: float = 1e3
    first: float = 0.25
    shortest: float = 1.0 / 64.0
    rough: float = 1e-4

    def solve(
        self, problem: Problem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Solve a problem along a path of larger creepages that fall to the prescribed ones.

        Returns
        -------
        Outcome
            With the cost of the path; not converged if it did not lead to its end.
        """
        rough = max(tolerance, self.rough)

        def solve(ahead: float, before: Outcome) -> Outcome:
            last = tolerance if ahead == 1.0 else rough
            return self.solver.solve(self.easier(problem, ahead), last, before)

        outcome = self.solver.solve(self.easier(problem, 0.0), rough, start)
        # Most problems of the path take a fraction of the bound of one problem.
        most = 5.0 * problem.most
        return follow_path(outcome, solve, "creepage", self.first, self.shortest, most)

    def easier(self, problem: Problem, done: float) -> Problem:
        """Return the problem with its rigid slip times full^(1 - done): `full` at 0, 1 at 1."""
        return replace(problem, rigid=self.full ** (1.0 - done) * problem.rigid)


def follow_path(
    outcome: Outcome,
    solve: Callable[[float, Outcome], Outcome],
    along: str,
    first: float,
    shortest: float,
    most: float = np.inf,
) -> Outcome:
    """Solve problems along a path from 0 to 1 in adaptive steps; return the last solved outcome.

    Parameters
    ----------
    outcome : Outcome
        Outcome at the beginning of the path.
    solve : callable
        Solves the problem at a part of the path, from the outcome of the one before.
    along : str
        Name of the quantity that changes along the path.
    first, shortest : float
        Stretches: the first one, and the shortest before giving up.
    most : float
        Applications of the path after which it begins no further problem.

    Returns
    -------
    Outcome
        With the cost of the path; not converged if it did not lead to its end.
    """
    done, stretch, taken, most = 0.0, first, 1, most + outcome.cost.applications
    failed = outcome
    if outcome.converged:  # of another problem
        failed = replace(outcome, status=Status.OUT_OF_ITERATIONS, residual=1.0)
    while outcome.converged and done < 1.0 and stretch >= shortest:
        if outcome.cost.applications >= most:
            break
        ahead = min(1.0, done + stretch)
        tried = solve(ahead, outcome)
        taken += 1
        if tried.converged:
            outcome, done, stretch = tried.costing(outcome), ahead, 2.0 * stretch
        else:
            outcome, failed = outcome.costing(tried), tried
            stretch *= 0.5
    more = f" after {taken} problems"
    if done < 1.0:
        outcome = replace(outcome, status=failed.status, residual=failed.residual)
        more += f", {done:.0%} of the way"
    return replace(outcome, trace=(Note(f"newton continued in {along}", outcome.status, more),))


@dataclass(frozen=True)
class FromRest:
    """Solver for friction that falls with sliding, by a path from slow or fast rolling.

    Attributes
    ----------
    solver : ProblemSolver
        Solves the first problem of the path, and the last one if nothing else does.
    nearby : ProblemSolver
        Solves every other problem from a start nearby.
    sliding : bool
        Whether the path begins at great speed.
    rough : float
        Residual of the intermediate problems.
    first, shortest : float
        Parts of the path from 0 to 1: the first one, and the shortest that is tried.
    growth : float
        Growth of the creepage from step to step, up to the maximum of the traction curve.
    turns : int
        Most problems with fixed friction if the path ends early.
    attempt, most : float
        Applications after which Newton's method gives up a problem in which friction falls, and
        after which a path gives up.
    """

    solver: ProblemSolver
    nearby: ProblemSolver
    last: ProblemSolver | None = None
    sliding: bool = False
    rough: float = 1e-3
    first: float = 0.25
    shortest: float = 1.0 / 64.0
    growth: float = 2.0
    turns: int = 128
    attempt: float = 400.0
    most: float = 2_000.0

    def solve(
        self, problem: Problem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Solve from a start; without one, or if that fails, along a path of rolling speeds."""
        if not problem.friction.law.falls:
            return self.solver.solve(problem, tolerance, start)
        begin = np.inf if self.sliding else 0.0
        constant = problem.at_speed_ratio(begin)
        problem, spent = replace(problem, most=self.attempt), []
        if start is not None:
            outcome = self.nearby.solve(problem, tolerance, start)
            if outcome.converged:
                return outcome
            spent.append(outcome)
        easier = self.solver.solve(constant, max(tolerance, self.rough))
        at_once = self.nearby.solve(problem, tolerance, easier)
        outcome = _add_cost(at_once, easier, *spent)
        if not outcome.converged and easier.converged:
            outcome = _add_cost(self._continued(problem, tolerance, easier), at_once, *spent)
            if not outcome.converged and len(problem.forces):
                outcome = self._with_top(problem, outcome, easier)
            elif not outcome.converged:
                outcome = self._with_fixed_friction(problem, tolerance, outcome)
        if not outcome.converged and outcome.top is None and self.last is not None:
            outcome = self.last.solve(problem, tolerance, easier).after(outcome)
        return outcome

    def _continued(self, problem: Problem, tolerance: float, start: Outcome) -> Outcome:
        """Solve problems at speeds from `start` to the problem; return the last solved outcome."""
        # Forces that one creepage has no more are beyond the top: no need to come quite near it.
        shortest = 0.5 * self.first if len(problem.forces) else self.shortest

        def solve(ahead: float, before: Outcome) -> Outcome:
            speed = 1.0 / ahead if self.sliding else ahead
            last = tolerance if ahead == 1.0 else max(tolerance, self.rough)
            return self.nearby.solve(problem.at_speed_ratio(speed), last, before)

        return follow_path(start, solve, "speed", self.first, shortest, self.most)

    def _with_fixed_friction(self, problem: Problem, tolerance: float, start: Outcome) -> Outcome:
        """Solve with the friction of the solution before, in turn, until Newton's method converges.

        A path ends where its solution ceases to exist. Less friction causes more slip, and more
        slip less friction: from great speed on, the friction of these problems only rises, and from
        rest it only falls, to the next solution (Tarski 1955, Pacific J. Math. 5, 285-309).
        """
        # Rougher, a problem would be solved by the solution before, and nothing would change.
        exact = max(tolerance, 1e-3 * self.rough)
        outcome, rest = start, problem.friction.at_speed_ratio(0.0)
        factor, change, length = np.ones(()), np.zeros(()), 1.0
        for turn in range(self.turns):
            fields = outcome.fields
            largest = rest.bound(fields.pressure).radius
            found = problem.sliding(*fields)[1].radius / np.where(largest > 0.0, largest, np.inf)
            factor, before = (found if turn == 0 else factor), change
            change = found - factor
            # Where solutions nearly exist, friction changes little from one to the next.
            length = self.growth * length if (change * before).sum() > 0.0 else 1.0
            factor = np.maximum(factor + length * change, 0.0)
            law = ScaledFriction(rest.law, factor)
            fixed = replace(problem, friction=replace(rest, law=law))
            outcome = self.nearby.solve(fixed, exact, outcome).costing(outcome)
            if not outcome.converged:
                break
            if turn & (turn + 1) == 0:  # seldom: a failure costs more than a turn
                brief = replace(problem, most=0.5 * self.attempt)  # near the solution, less do
                solved = self.nearby.solve(brief, tolerance, outcome)
                outcome = outcome.costing(solved)
                if solved.converged:
                    note = Note("newton after fixed friction", solved.status, f", {turn + 1} times")
                    return replace(solved, cost=outcome.cost, trace=(*start.trace, note))
        return replace(start, cost=outcome.cost)

    def _with_top(self, problem: Problem, outcome: Outcome, start: Outcome) -> Outcome:
        """Return an outcome with the maximum of the traction curve, if it is below the force."""
        forces = problem.forces
        vector, target = forces.vectors[0], forces.target[0]
        remaining = PrescribedForces(forces.vectors[1:], forces.target[1:])
        force = _Curve(self.nearby, problem, remaining, vector, start, self.rough, self.most)
        step, at_zero = force.unit, force(0.0)
        sign = np.sign(target - at_zero) or 1.0
        before, here = 0.0, -sign * step
        value, last = sign * force(here), sign * at_zero
        while value > last and abs(here) < 1e6 * step:
            before, last, here = here / self.growth, value, here * self.growth
            value = sign * force(here)
        if not np.isfinite(value):
            return outcome.costing(force.spent)
        maximum = scipy.optimize.minimize_scalar(
            lambda creepage: -sign * force(creepage),
            bounds=sorted((before, here)),
            method="bounded",
            options={"xatol": 1e-3 * abs(here)},
        )
        top = None
        if -maximum.fun < sign * target:
            top = (float(-sign * maximum.fun), float(maximum.x))
        return replace(outcome.costing(force.spent), top=top)


class _Curve:
    """Tangential force as a function of the creepage, each solved from the last solution.

    After `most` applications it has no values any more.
    """

    def __init__(self, solver, problem, remaining, vector, start, tolerance, most):
        self._solver, self._problem, self._remaining = solver, problem, remaining
        self._vector, self._tolerance, self._most = vector, tolerance, most
        self.spent = replace(start, cost=start.cost.scaled(0.0))
        self._start = start
        self.unit = 0.1 * (1.0 + np.abs(start.creepage[:1]).sum())

    def __call__(self, creepage: float) -> float:
        if self.spent.cost.applications >= self._most:
            return np.nan
        problem = replace(
            self._problem,
            rigid=self._problem.rigid + creepage * self._vector[:, None, None],
            forces=self._remaining,
        )
        start = replace(self._start, creepage=self._start.creepage[1:])
        outcome = self._solver.solve(problem, self._tolerance, start)
        if not outcome.converged:  # too far from it: from nothing
            outcome = self._solver.solve(problem, self._tolerance).costing(outcome)
        self.spent = self.spent.costing(outcome)
        if not outcome.converged:
            return np.nan  # ends the way up
        self._start = replace(outcome, creepage=np.append(creepage, outcome.creepage))
        return float(self._vector @ outcome.traction.sum(axis=(1, 2)))


def _add_cost(outcome: Outcome, *earlier: Outcome) -> Outcome:
    """Return an outcome with the cost of earlier outcomes added."""
    for previous in earlier:
        outcome = outcome.costing(previous)
    return outcome


class _NotSolvedError(Exception):
    """Raised if an intermediate problem was not solved, or no creepage gives the force."""


@dataclass(frozen=True)
class Bracketing:
    """Solver that finds the creepage for the first prescribed force by bracketing.

    Attributes
    ----------
    solver : ProblemSolver
        Solves each problem, from the outcome of the one before.
    continuation : Continuation
        Solves, under given creepages, what `solver` does not.
    first, growth : float
        First step in search of the other side, in units of slip; how much longer each next one is.
    rough : float
        Residual of the intermediate problems.
    close : float
        Force missed, over the sum of all tractions, from which the solver leads to the end.
    """

    solver: ProblemSolver
    continuation: Continuation
    first: float = 1.0
    growth: float = 8.0
    rough: float = 1e-5
    close: float = 1e-4

    def solve(
        self, problem: Problem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Search the creepage for the first prescribed force; without forces use continuation.

        Returns
        -------
        Outcome
            The outcome with the cost of all problems; not converged if one of them could not be
            solved, or if no creepage has the force.
        """
        forces = problem.forces
        if not len(forces):
            return self.continuation.solve(problem, tolerance, start)
        search = _Search(self, problem, tolerance, start)
        try:
            self._approach(search, tolerance, start)
            last = self.solver.solve(problem, tolerance, search.known)
            search.add(last)
        except _NotSolvedError:
            pass  # the outcome has the reason
        outcome = search.outcome
        note = Note("newton between creepages", outcome.status, f" after {search.taken} problems")
        return replace(outcome, trace=(note,))

    def _approach(self, search: "_Search", tolerance: float, start: Start | Outcome | None) -> None:
        """Search creepages until the first force is close to its prescribed value.

        Intermediate problems are solved roughly; if that does not lead there, to the tolerance.
        """
        here = 0.0 if start is None or start.creepage is None else float(start.creepage[0])
        for search.rough in sorted({max(tolerance, self.rough), tolerance}, reverse=True):
            force_missed = cache(search.force_missed)
            before, missed = here, force_missed(here)
            side = np.sign(missed)
            step = side * self.first
            while missed and np.sign(missed) == side:
                search.check_creepage()
                before, here = here, here + step
                missed, step = force_missed(here), self.growth * step
            if missed:
                here = scipy.optimize.brentq(force_missed, before, here, disp=False)
            if not search.missed:
                break  # else the force of a rough solution was on the wrong side


class _Search:
    """Search for the creepage of a force: solves problems, each from the previous outcome.

    Attributes
    ----------
    known : Start or Outcome, optional
        Start of the next problem: the last outcome, at first the initial guess.
    outcome : Outcome
        The last outcome, with the cost of all problems before.
    taken : int
        Number of problems solved.
    rough : float
        Residual to which problems are solved.
    missed : float
        Last force minus its target, 0.0 if it is close.
    """

    outcome: Outcome

    def __init__(
        self, method: Bracketing, problem: Problem, tolerance: float, start: Start | Outcome | None
    ):
        forces = problem.forces
        self.method, self.problem, self.rough, self.missed = method, problem, tolerance, 0.0
        self.vector, self.target = forces.vectors[0], forces.target[0]
        self.others = PrescribedForces(forces.vectors[1:], forces.target[1:])
        self.known, self.taken = start, 0

    def add(self, outcome: Outcome) -> None:
        """Store an outcome, with the cost of earlier ones, as the start of the next problem."""
        self.outcome = self.known = outcome.costing(self.outcome) if self.taken else outcome
        self.taken += 1

    def force_missed(self, creepage: float) -> float:
        """Solve under a creepage; return the force minus its target, or 0.0 if it is close.

        Raises
        ------
        _NotSolvedError
            If the problem was not solved.
        """
        rigid = self.problem.rigid + creepage * self.vector[:, None, None]
        problem = replace(self.problem, rigid=rigid, forces=self.others)
        first = self.known
        if first is not None and first.creepage is not None:
            first = replace(first, creepage=first.creepage[1:])
        outcome = self.method.solver.solve(problem, self.rough, first)
        if not outcome.converged:
            outcome = self.method.solve(problem, self.rough, first).costing(outcome)
        self.add(
            replace(
                outcome, creepage=np.append(creepage, needed(outcome.creepage, "outcome.creepage"))
            )
        )
        if not outcome.converged:
            raise _NotSolvedError
        traction = needed(outcome.traction, "outcome.traction")
        missed = self.vector @ traction.sum(axis=(1, 2)) - self.target
        size = np.linalg.norm(self.vector) * np.hypot(*traction).sum()
        self.missed = float(missed) if abs(missed) > self.method.close * size else 0.0
        return self.missed

    def check_creepage(self) -> None:
        """Raise an error if the creepage is so large that no creepage gives the force."""
        forces, last = self.problem.forces, self.outcome
        creepage, slip = (
            needed(last.creepage, "outcome.creepage"),
            needed(last.slip, "outcome.slip"),
        )
        if forces.diverged(creepage, forces.elastic_slip(slip, creepage)):
            self.outcome = replace(last, status=Status.DIVERGED, residual=1.0)
            raise _NotSolvedError
