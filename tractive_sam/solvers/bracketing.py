"""Prescribed forces met by a search between creepages, if Newton's method fails.

A force falls as its creepage grows. If nearly everything slips it falls in stairs, one for every
element that turns from slipping forward to slipping backward. This happens in dissimilar bodies
that roll freely with little friction. A Newton step finds no slope on a stair, and a far too steep
one between two. A search between a creepage with too much force and one with too little still finds
the force.
"""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import scipy  # its parts are loaded when first used

from tractive_sam.results import Status
from tractive_sam.solvers.falling_friction import Continuation
from tractive_sam.solvers.problem import (
    Note,
    Outcome,
    PrescribedForces,
    Problem,
    ProblemSolver,
    Start,
    needed,
)


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
