"""Continuation: a hard problem by way of easier ones, each started from the one before.

The way begins in full slip, at `FULL` times the creepages: there tractions oppose the rigid slip,
whatever the elasticity does. As the creepages fall, stick spreads from the leading edge. A stretch
of the way that fails is halved.
"""

from dataclasses import dataclass, replace

from tractive_sam.solvers.outcome import Note, Outcome, Solver, Start
from tractive_sam.solvers.problem import Problem


@dataclass(frozen=True)
class Continuation:
    """Continuation in the creepages.

    Attributes
    ----------
    solver : Solver
        Solves each problem, from the outcome of the one before.
    full : float
        Creepages at the beginning of the way, over those asked for.
    first, shortest : float
        Stretches of the way from 0 to 1: the first one, and the shortest before giving up.
    rough : float
        Residual asked for on the way.
    """

    solver: Solver
    full: float = 1e3
    first: float = 0.25
    shortest: float = 1.0 / 64.0
    rough: float = 1e-4

    def solve(
        self, problem: Problem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Solve by way of easier problems; see `Solver`.

        Returns
        -------
        Outcome
            With the cost of the whole way; not converged where it did not lead to its end.
        """
        rough = max(tolerance, self.rough)
        now = self.solver.solve(self.eased(problem, 0.0), rough, start)
        done, stretch, taken = 0.0, self.first, 1
        while now.converged and done < 1.0 and stretch >= self.shortest:
            ahead = min(1.0, done + stretch)
            last = tolerance if ahead == 1.0 else rough
            tried = self.solver.solve(self.eased(problem, ahead), last, now)
            taken += 1
            if tried.converged:
                now, done, stretch = tried.costing(now), ahead, 2.0 * stretch
            else:
                now = now.costing(tried)
                stretch *= 0.5
        if done < 1.0:
            failed = tried if now.converged else now
            now = replace(now, status=failed.status, residual=failed.residual)
        more = f" after {taken} problems"
        if done < 1.0:
            more += f", {done:.0%} of the way"
        return replace(now, trace=(Note("newton continued in creepage", now.status, more),))

    def eased(self, problem: Problem, done: float) -> Problem:
        """The problem at a part of the way, from 0 to 1."""
        return replace(problem, rigid=self.full ** (1.0 - done) * problem.rigid)
