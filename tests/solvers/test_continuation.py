"""The fallbacks of `auto`: Newton's method by way of easier problems, then Anderson's."""

from dataclasses import dataclass, field, replace
from types import SimpleNamespace

import numpy as np
import pytest

from tests.scenes import size, steady
from tests.solvers.small import tangential_problem
from tractive_sam.results.state import Cost, Status
from tractive_sam.solvers import (
    Bracketing,
    Continuation,
    FromRest,
    Newton,
    Outcome,
    PrescribedForces,
    ProblemSolver,
    Start,
)
from tractive_sam.solvers.ladder import METHODS

SMALL = ("grid.half_length=[4.08, 4.08]", "grid.elements=[19, 19]")
DISSIMILAR = (*SMALL, "body.B.shear=8.0", "body.B.poisson=0.45")
FORCES = ("load.force_x=0.1", "load.force_y=0.03")
ALIKE, OTHERS = METHODS["auto"].alike, METHODS["auto"].dissimilar
NEWTON = Newton()


@dataclass(frozen=True)
class Failing:
    """A method with outcomes that count as failed."""

    solver: ProblemSolver

    def solve(self, problem, tolerance, start=None) -> Outcome:
        outcome = self.solver.solve(problem, tolerance, start)
        notes = tuple(replace(note, status=Status.DIVERGED) for note in outcome.trace)
        return replace(outcome, status=Status.DIVERGED, trace=notes)


class Counted:
    """A method that costs one application, and does not lead to a problem as it was given."""

    count = 0

    def solve(self, problem, tolerance, start=None) -> Outcome:
        self.count += 1
        status = Status.CONVERGED if isinstance(problem, float) else Status.DIVERGED
        return Outcome(status, 0.0, 1, Cost(1.0))


@dataclass(frozen=True)
class FallingProblem:
    """What the path from rest reads of a problem with creepages."""

    most: float = np.inf
    friction: object = field(
        default_factory=lambda: SimpleNamespace(law=SimpleNamespace(falls=True))
    )
    forces: tuple = ()
    at_speed_ratio: type = float


@pytest.mark.parametrize("start", [None, Start()])
def test_the_path_from_rest_costs_what_its_problems_cost(start):
    counted = Counted()
    outcome = FromRest(counted, counted).solve(FallingProblem(), 1e-6, start)
    assert outcome.converged
    assert outcome.cost.applications == counted.count


def without_first(ladder, failing=1):
    """The ladder with rungs that count as failed."""
    rungs = tuple(Failing(rung) for rung in ladder.rungs[:failing])
    return replace(ladder, rungs=rungs + ladder.rungs[failing:])


@pytest.mark.parametrize("settings", [SMALL, (*SMALL, *FORCES)])
def test_continued_where_newton_fails(settings):
    reference = steady("spheres", *settings)
    ladder = replace(ALIKE, tangential=without_first(ALIKE.tangential))
    contact = steady("spheres", *settings, solver=ladder)
    assert contact.converged
    assert contact.trace[-1].startswith(("newton continued in", "newton between creepages"))
    assert "newton: diverged" in contact.message
    assert contact.cost.applications > reference.cost.applications
    # Two solves to 1e-8.
    assert size(contact.traction - reference.traction) < 1e-6 * size(reference.traction)


@pytest.mark.parametrize("settings", [DISSIMILAR, (*DISSIMILAR, *FORCES)])
def test_continued_where_the_coupled_newton_fails(settings):
    reference = steady("spheres", *settings)
    contact = steady("spheres", *settings, solver=without_first(OTHERS))
    assert contact.converged
    assert "coupled newton: diverged" in contact.trace
    assert contact.trace[-1].startswith(("newton continued in", "newton between creepages"))
    assert size(contact.traction - reference.traction) < 1e-6 * size(reference.traction)


def test_anderson_where_nothing_else_helps():
    ladder = replace(ALIKE, tangential=without_first(ALIKE.tangential, failing=2))
    contact = steady("spheres", *SMALL, solver=ladder)
    assert contact.converged
    assert [step.split(":")[1].split()[0] for step in contact.trace[1:]] == [
        "diverged",
        "diverged",
        "converged",
    ]
    assert contact.trace[-1].startswith("anderson")
    failed = steady("spheres", *SMALL, *FORCES, solver=ladder)
    assert failed.status is Status.DIVERGED
    assert "newton between creepages: diverged" in failed.message
    # Dissimilar bodies, too, have Anderson's method at the end.
    assert steady("spheres", *DISSIMILAR, solver=without_first(OTHERS, failing=2)).converged


def test_the_path_begins_in_full_slip_and_ends_at_the_problem():
    problem = tangential_problem()
    way = Continuation(NEWTON)
    full = NEWTON.solve(way.easier(problem, 0.0), 1e-8)
    assert full.converged
    # All of the traction opposes the rigid slip: closed form, but for the elastic slip beside it.
    opposed = -problem.normal.pressure * np.sign(problem.rigid[0])
    assert size(full.traction[0] - opposed) < 1e-2 * size(problem.normal.pressure)
    np.testing.assert_array_equal(way.easier(problem, 1.0).rigid, problem.rigid)


def test_a_stretch_that_fails_is_halved():
    """If only short stretches succeed, the path takes more problems, and reports them all."""

    @dataclass(frozen=True)
    class Timid:
        """Solves only what is no more than four times easier or harder than the problem before."""

        def solve(self, problem, tolerance, start=None):
            outcome = NEWTON.solve(problem, tolerance, start)
            strength = np.abs(problem.rigid).max()
            reported = replace(outcome, approach=strength)
            near = start is None or max(strength / start.approach, start.approach / strength) < 4.0
            return reported if near else replace(reported, status=Status.DIVERGED)

    problem = tangential_problem()
    outcome = Continuation(Timid()).solve(problem, 1e-8)
    assert outcome.converged
    # 1000 = 4^5: five stretches at least, and those that failed.
    assert int(outcome.trace[-1].more.split()[1]) > 6
    direct = NEWTON.solve(problem, 1e-8)
    assert size(outcome.traction - direct.traction) < 1e-6 * size(direct.traction)
    assert outcome.cost.applications > direct.cost.applications


def test_a_force_is_bracketed_however_small_it_is():
    """Forces with a product of zero in floating point still have different signs."""

    @dataclass(frozen=True)
    class Tiny:
        """Tractions that fall with the creepage, through zero at 2.5, and cost nothing."""

        def solve(self, problem, tolerance, start=None):
            creepage = 2.5 if len(problem.forces) else float((problem.rigid - rigid)[0, 0, 0])
            traction = np.full_like(rigid, 1e-200 * (2.5 - creepage))
            found = np.array([creepage] if len(problem.forces) else [])
            status, slip = Status.CONVERGED, np.zeros_like(rigid)
            return Outcome(status, 0.0, 1, Cost(), traction=traction, slip=slip, creepage=found)

    single = tangential_problem()
    rigid = single.rigid
    forces = PrescribedForces(np.array([[1.0, 0.0]]), np.zeros(1))
    way = Bracketing(Tiny(), Continuation(Tiny()))
    outcome = way.solve(replace(single, forces=forces), 1e-8)
    assert outcome.converged
    assert outcome.creepage.tolist() == [2.5]
