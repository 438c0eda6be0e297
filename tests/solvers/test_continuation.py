"""The fallbacks of `auto`: Newton's method by way of easier problems, then Anderson's."""

from dataclasses import replace

import numpy as np
import pytest

from tests.conftest import size, steady
from tractive_sam.contact import in_sequence, together
from tractive_sam.results.status import Cost, Status
from tractive_sam.solvers.continuation import eased
from tractive_sam.solvers.newton import newton
from tractive_sam.solvers.outcome import Outcome

SMALL = ("grid.half_length=[4.08, 4.08]", "grid.elements=[19, 19]")
DISSIMILAR = (*SMALL, "body.B.shear=8.0", "body.B.poisson=0.45")
FORCES = ("load.traction_x=0.1", "load.traction_y=0.03")


def failing_once(solve):
    """A method whose first attempt counts as failed."""
    attempts = []

    def tried(*arguments):
        outcome = solve(*arguments)
        attempts.append(outcome)
        return outcome if len(attempts) > 1 else replace(outcome, status=Status.DIVERGED)

    return tried


@pytest.mark.parametrize("settings", [SMALL, (*SMALL, *FORCES)])
def test_continued_where_newton_fails(settings, monkeypatch):
    reference = steady("spheres", *settings)
    monkeypatch.setattr(in_sequence, "nested_tangential", failing_once(newton_alone))
    contact = steady("spheres", *settings)
    assert contact.converged
    assert contact.trace[-1].startswith(("newton continued in", "newton between creepages"))
    assert "by way of" in contact.message
    assert "newton: diverged" in contact.message
    assert contact.cost.applications > reference.cost.applications
    # Two solves to 1e-8.
    assert size(contact.traction - reference.traction) < 1e-6 * size(reference.traction)


def newton_alone(problem, tolerance, solve):
    return solve(problem, tolerance)


@pytest.mark.parametrize("settings", [DISSIMILAR, (*DISSIMILAR, *FORCES)])
def test_continued_where_the_coupled_newton_fails(settings, monkeypatch):
    reference = steady("spheres", *settings)
    monkeypatch.setattr(together, "_newton_from", failing_once(together._newton_from))
    contact = steady("spheres", *settings)
    assert contact.converged
    assert "coupled newton: diverged" in contact.trace
    assert contact.trace[-1].startswith(("newton continued in", "newton between creepages"))
    assert size(contact.traction - reference.traction) < 1e-6 * size(reference.traction)


def test_anderson_where_nothing_else_helps(monkeypatch):
    def fails(problem, *_):
        nothing = np.zeros_like(problem.rigid)
        return Outcome(
            Status.DIVERGED, 1.0, 0, Cost(), traction=nothing, slip=nothing, creepage=np.zeros(0)
        )

    monkeypatch.setattr(in_sequence, "nested_tangential", fails)
    monkeypatch.setattr(in_sequence, "newton", fails)
    contact = steady("spheres", *SMALL)
    assert contact.converged
    assert contact.trace[1:] == (
        "newton: diverged",
        "newton continued in creepage: diverged after 1 problems, 0% of the way",
        "anderson: converged",
    )
    failed = steady("spheres", *SMALL, *FORCES)
    assert failed.status is Status.DIVERGED
    assert "newton between creepages: diverged" in failed.message
    assert steady("spheres", *SMALL, 'solver.method="newton"').status is Status.DIVERGED


def test_the_way_begins_in_full_slip_and_ends_at_the_problem():
    from tests.solvers.test_methods import tangential_problem  # noqa: PLC0415

    problem = tangential_problem()
    full = newton(eased(problem, 0.0), 1e-8)
    assert full.converged
    # All of the traction opposes the rigid slip: closed form, but for the elastic slip beside it.
    opposed = -problem.bound * np.sign(problem.rigid[0])
    assert size(full.traction[0] - opposed) < 1e-2 * size(problem.bound)
    np.testing.assert_array_equal(eased(problem, 1.0).rigid, problem.rigid)
