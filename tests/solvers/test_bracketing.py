"""Search for the creepage of a prescribed force."""

from dataclasses import dataclass, field

import numpy as np

from tractive_sam.results import Cost, Status
from tractive_sam.solvers import Bracketing, Continuation, FixedPressure, Outcome, PrescribedForces
from tractive_sam.solvers.problem import Problem


@dataclass
class RoughlyWrong:
    """Force -tanh(creepage - 3); that of rough solutions jumps at a creepage of 2.9."""

    calls: list[float] = field(default_factory=list)

    def solve(self, problem, tolerance, start=None):
        self.calls.append(tolerance)
        if len(problem.forces):  # leads to the end from nearby
            near = abs(np.tanh(start.creepage[0] - 3.0)) < 1e-3
            return Outcome(
                Status.CONVERGED if near else Status.OUT_OF_ITERATIONS, 0.0, 1, Cost(),
                traction=start.traction, slip=problem.rigid, creepage=start.creepage,
            )  # fmt: skip
        jump = 0.3 * (problem.rigid[0] > 2.9) if tolerance > 1e-6 else 0.0
        traction = np.ones_like(problem.rigid)
        traction[0] = -np.tanh(problem.rigid[0] - 3.0) - jump
        none = np.zeros(0)
        return Outcome(
            Status.CONVERGED, 0.0, 1, Cost(), traction=traction, slip=problem.rigid, creepage=none
        )


def test_wrong_forces_of_rough_solutions_do_not_end_the_search():
    solver = RoughlyWrong()
    forces = PrescribedForces(np.array([[1.0, 0.0]]), np.zeros(1))
    elements = np.ones((3, 3))
    problem = Problem(FixedPressure(None, elements, elements), np.zeros((2, 3, 3)), forces=forces)
    outcome = Bracketing(solver, Continuation(solver)).solve(problem, 1e-8)
    assert outcome.converged
    assert 1e-5 in solver.calls  # rough problems first
