"""Continuation: a hard problem by easier ones, each started from the one before.

The path begins in full slip, at `full` times the creepages: there tractions oppose the rigid slip,
whatever the elasticity does. As the creepages fall, stick spreads from the leading edge. A stretch
of the path that fails is halved.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

from tractive_sam.solvers.problem import Note, Outcome, Problem, ProblemSolver, Start


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
        return follow_path(outcome, solve, "creepage", self.first, self.shortest)

    def easier(self, problem: Problem, done: float) -> Problem:
        """Return the problem with its rigid slip times full^(1 - done): `full` at 0, 1 at 1."""
        return replace(problem, rigid=self.full ** (1.0 - done) * problem.rigid)


def follow_path(
    outcome: Outcome,
    solve: Callable[[float, Outcome], Outcome],
    along: str,
    first: float,
    shortest: float,
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

    Returns
    -------
    Outcome
        With the cost of the path; not converged if it did not lead to its end.
    """
    done, stretch, taken, tried = 0.0, first, 1, outcome
    while outcome.converged and done < 1.0 and stretch >= shortest:
        ahead = min(1.0, done + stretch)
        tried = solve(ahead, outcome)
        taken += 1
        if tried.converged:
            outcome, done, stretch = tried.costing(outcome), ahead, 2.0 * stretch
        else:
            outcome = outcome.costing(tried)
            stretch *= 0.5
    more = f" after {taken} problems"
    if done < 1.0:
        outcome = replace(outcome, status=tried.status, residual=tried.residual)
        more += f", {done:.0%} of the way"
    return replace(outcome, trace=(Note(f"newton continued in {along}", outcome.status, more),))
