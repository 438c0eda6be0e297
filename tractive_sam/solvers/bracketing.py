"""Prescribed forces met between two creepages, where Newton's method fails.

A force falls as its creepage grows. Where nearly everything slips it falls in stairs, one for every
element that turns from slipping forward to slipping backward: so it is of dissimilar bodies that
roll freely with little friction. A Newton step sees no slope on a stair, and far too steep a one
between two; between a creepage with too much force and one with too little it is found all the
same.
"""

from dataclasses import dataclass, replace

import numpy as np
import scipy  # its parts are loaded when first used

from tractive_sam.results import Status
from tractive_sam.solvers.continuation import Continuation
from tractive_sam.solvers.outcome import Note, Outcome, Solver, Start
from tractive_sam.solvers.problem import PrescribedForces, Problem


class _NotSolvedError(Exception):
    """Raised if a problem on the path was not solved, or no creepage gives the force."""


@dataclass(frozen=True)
class Bracketing:
    """Finds the creepage for the first prescribed force by bracketing; the solver finds the second.

    Attributes
    ----------
    solver : Solver
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

    solver: Solver
    continuation: Continuation
    first: float = 1.0
    growth: float = 8.0
    rough: float = 1e-5
    close: float = 1e-4

    def solve(
        self, problem: Problem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Solve between creepages; see `Solver`. Problems of given creepages are continued.

        Returns
        -------
        Outcome
            With the cost of the whole way; not converged where a problem on it could not be solved,
            or no creepage has the force.
        """
        forces = problem.forces
        if not len(forces):
            return self.continuation.solve(problem, tolerance, start)
        vector, target = forces.vectors[0], forces.target[0]
        others = PrescribedForces(forces.vectors[1:], forces.target[1:])
        rough = max(tolerance, self.rough)
        now, taken = start, 0

        def beyond(creepage: float) -> float:
            """Force above its target under a creepage; zero where it is close."""
            nonlocal now, taken
            given = replace(
                problem, rigid=problem.rigid + creepage * vector[:, None, None], forces=others
            )
            known = now is not None and now.creepage is not None
            first = replace(now, creepage=now.creepage[1:]) if known else now
            found = self.solver.solve(given, rough, first)
            if not found.converged:
                found = self.solve(given, rough, first).costing(found)
            found = replace(found, creepage=np.append(creepage, found.creepage))
            now = found.costing(now) if taken else found
            taken += 1
            if not found.converged:
                raise _NotSolvedError
            missed = vector @ found.traction.sum(axis=(1, 2)) - target
            close = self.close * np.linalg.norm(vector) * np.hypot(*found.traction).sum()
            return float(missed) if abs(missed) > close else 0.0

        try:
            here = 0.0 if start is None or start.creepage is None else float(start.creepage[0])
            missed = beyond(here)
            side = np.sign(missed)
            step = side * self.first
            while missed and np.sign(missed) == side:
                if forces.diverged(now.creepage, forces.elastic_slip(now.slip, now.creepage)):
                    now = replace(now, status=Status.DIVERGED, residual=1.0)
                    raise _NotSolvedError
                before, here = here, here + step
                missed, step = beyond(here), self.growth * step
            if missed:
                scipy.optimize.brentq(beyond, before, here, disp=False)
            last = self.solver.solve(problem, tolerance, now)
            taken += 1
            now = last.costing(now)
        except _NotSolvedError:
            pass  # its outcome has the reason
        note = Note("newton between creepages", now.status, f" after {taken} problems")
        return replace(now, trace=(note,))
