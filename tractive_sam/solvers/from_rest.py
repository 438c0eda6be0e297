"""Friction that falls with sliding, solved on a path from friction at rest.

A falling law may have several solutions. The path begins with friction at rest (or at great speed),
which has one, and Newton's method leads from there. If it fails, the path passes through slower (or
faster) rolling, and each problem starts from the one before. If the solution that the path follows
ceases to exist, friction is fixed at its values in the last solution, again and again, which leads
to the next solution. If prescribed forces are not found,
the traction curve is followed up to its maximum.
"""

from dataclasses import dataclass, replace

import numpy as np
import scipy  # its parts are loaded when first used

from tractive_sam.mechanics import ScaledFriction
from tractive_sam.solvers.continuation import follow_path
from tractive_sam.solvers.problem import (
    Note,
    Outcome,
    PrescribedForces,
    Problem,
    ProblemSolver,
    Start,
)


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
    """

    solver: ProblemSolver
    nearby: ProblemSolver
    sliding: bool = False
    rough: float = 1e-3
    first: float = 0.25
    shortest: float = 1.0 / 64.0
    growth: float = 2.0
    turns: int = 128

    def solve(
        self, problem: Problem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Solve from a start; without one, or if that fails, along a path of rolling speeds."""
        if not problem.friction.law.falls:
            return self.solver.solve(problem, tolerance, start)
        spent = []
        if start is not None:
            outcome = self.nearby.solve(problem, tolerance, start)
            if outcome.converged:
                return outcome
            spent.append(outcome)
        begin = np.inf if self.sliding else 0.0
        easier = self.solver.solve(problem.at_speed_ratio(begin), max(tolerance, self.rough))
        at_once = self.nearby.solve(problem, tolerance, easier)
        outcome = _add_cost(at_once, easier, *spent)
        if not outcome.converged and easier.converged:
            outcome = _add_cost(self._continued(problem, tolerance, easier), at_once, *spent)
            if not outcome.converged and len(problem.forces):
                outcome = self._with_top(problem, outcome, easier)
            elif not outcome.converged:
                outcome = self._with_fixed_friction(problem, tolerance, outcome)
        if not outcome.converged and outcome.top is None:
            outcome = self.solver.solve(problem, tolerance, easier).after(outcome)
        return outcome

    def _continued(self, problem: Problem, tolerance: float, start: Outcome) -> Outcome:
        """Solve problems at speeds from `start` to the problem; return the last solved outcome."""
        # Forces that one creepage has no more are beyond the top: no need to come quite near it.
        shortest = 0.5 * self.first if len(problem.forces) else self.shortest

        def solve(ahead: float, before: Outcome) -> Outcome:
            speed = 1.0 / ahead if self.sliding else ahead
            last = tolerance if ahead == 1.0 else max(tolerance, self.rough)
            return self.nearby.solve(problem.at_speed_ratio(speed), last, before)

        return follow_path(start, solve, "speed", self.first, shortest)

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
                return start.costing(outcome)
            if turn & (turn + 1) == 0:  # seldom: a failure costs more than a turn
                solved = self.nearby.solve(problem, tolerance, outcome)
                outcome = outcome.costing(solved)
                if solved.converged:
                    note = Note("newton after fixed friction", solved.status, f", {turn + 1} times")
                    return replace(solved, cost=outcome.cost, trace=(*start.trace, note))
        return start.costing(outcome)

    def _with_top(self, problem: Problem, outcome: Outcome, start: Outcome) -> Outcome:
        """Return an outcome with the maximum of the traction curve, if it is below the force."""
        forces = problem.forces
        vector, target = forces.vectors[0], forces.target[0]
        remaining = PrescribedForces(forces.vectors[1:], forces.target[1:])
        force = _Curve(self.nearby, problem, remaining, vector, start, self.rough)
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
    """Tangential force as a function of the creepage, each solved from the last solution."""

    def __init__(self, solver, problem, remaining, vector, start, tolerance):
        self._solver, self._problem, self._remaining = solver, problem, remaining
        self._vector, self._tolerance = vector, tolerance
        self.spent = replace(start, cost=start.cost.scaled(0.0))
        self._start = start
        self.unit = 0.1 * (1.0 + np.abs(start.creepage[:1]).sum())

    def __call__(self, creepage: float) -> float:
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
