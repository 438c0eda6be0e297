"""Every solver on small problems with known solutions from dense matrices."""

from dataclasses import replace

import numpy as np
import pytest

from tests.scenes import size
from tests.solvers.small import (
    ALIKE,
    DISSIMILAR,
    disc,
    given_approach,
    problem_of,
    tangential_problem,
    with_fixed_pressure,
)
from tractive_sam.results.state import Cost, Status
from tractive_sam.solvers import (
    Anderson,
    Bracketing,
    ConjugateGradients,
    Continuation,
    Ladder,
    Nested,
    Newton,
    Note,
    Outcome,
    PrescribedForces,
    Sequential,
    Start,
    Uzawa,
)
from tractive_sam.solvers.krylov import gmres
from tractive_sam.solvers.ladder import METHODS, NORMAL, ROUGH_SEQUENTIAL
from tractive_sam.solvers.newton import Iterate, System
from tractive_sam.solvers.projection import ProjectedMap

TIGHT = 1e-10
FORCES = PrescribedForces(np.eye(2), np.array([8.0, 3.0]))


@pytest.fixture(scope="module")
def alike():
    return problem_of(*ALIKE)


@pytest.fixture(scope="module")
def dissimilar():
    return problem_of(*DISSIMILAR)


def dense_residual(problem, outcome):
    """The natural residuals of pressure and tractions, by dense matrices and plain numpy."""
    pressure, traction = outcome.pressure, outcome.traction
    shape = pressure.shape
    missed = []
    if problem.is_pressure_fixed:
        response = (problem.operators.slip.as_matrix() @ traction.ravel()).reshape(2, *shape)
    else:
        fields = np.concatenate((pressure[None], traction))
        matrix = problem.operators.coupled.as_matrix()
        response = (matrix @ fields.ravel()).reshape(3, *shape)
        gap = problem.normal.gap + response[0] - outcome.approach
        missed.append(size(np.minimum(pressure, gap)) / size(pressure))
    slip = problem.rigid + problem.forces.slip(outcome.creepage) + response[-2:]
    nearest = disc(traction - slip, pressure)
    return max(*missed, size(nearest - traction) / size(nearest), 0.0)


def dense_normal(problem, rounds=50):
    """Pressure under a given approach, by solving for the active set until it stays."""
    n = problem.gap.size
    matrix = problem.operators.normal.as_matrix()
    depth = (problem.approach - problem.gap).ravel()
    active = depth > 0
    for _ in range(rounds):
        pressure = np.zeros(n)
        pressure[active] = np.linalg.solve(matrix[np.ix_(active, active)], depth[active])
        now = (pressure - (matrix @ pressure - depth)) > 0
        if (now == active).all():
            return pressure.reshape(problem.gap.shape)
        active = now
    raise AssertionError("the active set does not settle")


def test_conjugate_gradients_by_an_active_set_and_a_dense_solve(alike):
    problem = given_approach(alike).normal
    outcome = ConjugateGradients().solve(problem, TIGHT)
    assert outcome.converged
    np.testing.assert_allclose(outcome.pressure, dense_normal(problem), atol=1e-8)
    loaded = replace(problem, load=float(outcome.pressure.sum()))
    again = ConjugateGradients().solve(loaded, TIGHT)
    # The load requested is the one that the approach gave.
    assert again.approach == pytest.approx(problem.approach, rel=1e-8)


@pytest.mark.parametrize("solver", [Newton(), Anderson(), Uzawa(), Continuation(Newton())])
def test_tangential_problem(alike, solver):
    problem = with_fixed_pressure(alike)
    outcome = solver.solve(problem, TIGHT)
    assert outcome.converged
    # Equal sums in another order: rounding over the tolerance.
    assert dense_residual(problem, outcome) <= 1.01 * TIGHT


@pytest.mark.parametrize("solver", [Newton(), Anderson(), Uzawa()])
@pytest.mark.parametrize("control", ["load", "approach"])
def test_coupled_problem(dissimilar, solver, control):
    problem = dissimilar if control == "load" else given_approach(dissimilar)
    outcome = solver.solve(problem, 1e-8)
    assert outcome.converged
    # Projected iterations solve ten times closer than asked, to sum up the load.
    assert dense_residual(problem, outcome) <= 1.01e-8
    if control == "load":
        assert outcome.pressure.sum() == pytest.approx(problem.load, rel=1e-7)
    else:
        assert outcome.approach == problem.normal.approach


@pytest.mark.parametrize("solver", [Newton(), Bracketing(Newton(), Continuation(Newton()))])
def test_prescribed_forces(alike, dissimilar, solver):
    for problem in (with_fixed_pressure(alike), dissimilar):
        start = None if problem.is_pressure_fixed else ROUGH_SEQUENTIAL.solve(problem, TIGHT)
        given = replace(problem, forces=FORCES)
        start = start and replace(start, creepage=np.zeros(2))
        outcome = solver.solve(given, 1e-9, start)
        assert outcome.converged
        np.testing.assert_allclose(outcome.traction.sum(axis=(1, 2)), FORCES.target, rtol=1e-7)
        assert dense_residual(given, outcome) <= 1.01e-9


@pytest.mark.parametrize("slip", ["upwind", "auto"])
def test_fixed_pressure_is_coupled_with_the_unchanged_pressure(slip):
    """Bodies of equal material: both blocks at once and one after the other agree."""
    problem = problem_of(*ALIKE, slip=slip)
    one = Sequential(ConjugateGradients(), Newton()).solve(problem, TIGHT)
    both = Newton().solve(problem, TIGHT)
    assert one.converged
    assert both.converged
    # Residuals of 1e-10, amplified by the operators.
    np.testing.assert_allclose(one.pressure, both.pressure, atol=1e-8)
    np.testing.assert_allclose(one.traction, both.traction, atol=1e-7)


@pytest.mark.parametrize("elements", [40, 61])
def test_nested_meshes_lead_to_the_same_at_less_cost(elements):
    problem = tangential_problem(elements)
    plain, nested = Newton().solve(problem, TIGHT), Nested(Newton()).solve(problem, TIGHT)
    assert nested.converged
    np.testing.assert_allclose(nested.traction, plain.traction, atol=1e-7)
    assert nested.cost.applications < plain.cost.applications
    # From a start at once, without coarser meshes.
    again = Nested(Newton()).solve(problem, TIGHT, nested)
    assert again.cost.applications == 1


def test_cost_is_what_the_operators_were_applied():
    """Reported by the solvers, counted by the operators."""
    for settings in (ALIKE, DISSIMILAR):
        problem = problem_of(*settings, elements=13)
        problem = problem if problem.coupled else with_fixed_pressure(problem)
        operators = problem.operators
        start = ROUGH_SEQUENTIAL.solve(problem, 1e-8) if not problem.is_pressure_fixed else None
        for solver in (Newton(), Anderson(), Uzawa()):
            used = operators.slip if problem.is_pressure_fixed else operators.coupled
            before = used.applications, operators.tangential_inverse.applications
            cost = solver.solve(problem, 1e-7, start).cost
            after = used.applications, operators.tangential_inverse.applications
            assert (cost.applications, cost.preconditioner) == tuple(np.subtract(after, before))
    problem = problem_of(*ALIKE, elements=13)
    before = problem.operators.normal.applications
    cost = ConjugateGradients().solve(problem.normal, 1e-8).cost
    assert cost.applications == problem.operators.normal.applications - before


@pytest.mark.parametrize("settings", [ALIKE, DISSIMILAR])
@pytest.mark.parametrize("slip", ["upwind", "auto"])
def test_newton_steps_converge_quadratically(settings, slip):
    """A Newton step from a state that is off by h is off by h squared."""
    problem = problem_of(*settings, slip=slip)
    if not problem.coupled:
        problem = with_fixed_pressure(problem)
    solved = Newton().solve(problem, 1e-13)
    rng = np.random.default_rng(0)
    inside = solved.pressure > 0.05 * solved.pressure.max()
    nudge = rng.normal(size=solved.traction.shape) * solved.pressure * inside

    def missed(h):
        at = Iterate(
            problem,
            solved.pressure,
            solved.traction + h * nudge,
            solved.approach,
            np.zeros(0),
        )
        system = System(problem, at, np.float64)
        rhs = system.right_hand_side()
        step, _ = gmres(system.operator, system.preconditioner, rhs, 1e-12, 400)
        now = at.fields(problem.is_pressure_fixed) + system.fields(step)
        return size(now[-2:] - solved.traction) / size(at.traction - solved.traction)

    far, near = missed(1e-3), missed(1e-5)
    # A hundredth of the error is missed by as much less; the rest is rounding of the solution.
    assert near < 0.03 * far + 1e-6


def test_a_step_too_bold_is_shortened():
    problem = tangential_problem()
    mapping = ProjectedMap.from_problem(problem, problem.normal.pressure > 0.0, step_factor=12.0)
    outcome, shortened = Uzawa().iterate(mapping, 1e-6, np.zeros_like(problem.rigid))
    assert outcome.converged
    assert (shortened.steps < mapping.steps).all()  # and the map itself is as it was


class Never:
    """A method that never finds anything."""

    def solve(self, problem, tolerance, start=None):
        zero = np.zeros_like(problem.rigid)
        note = Note("never", Status.DIVERGED)
        return Outcome(Status.DIVERGED, 1.0, 0, Cost(5.0), traction=zero, slip=zero, trace=(note,))


def test_a_ladder_climbs_until_one_converges(alike):
    problem = with_fixed_pressure(alike)
    outcome = Ladder((Never(), Newton(), Never()), with_forces=1).solve(problem, 1e-8)
    assert outcome.converged
    assert [note.status for note in outcome.trace] == [Status.DIVERGED, Status.CONVERGED]
    assert outcome.cost.applications == Newton().solve(problem, 1e-8).cost.applications + 5.0
    forced = replace(problem, forces=FORCES)
    assert not Ladder((Never(), Newton()), with_forces=1).solve(forced, 1e-8).converged


def test_problems_are_never_changed(alike):
    before = {name: np.copy(getattr(alike.normal, name)) for name in ("gap", "load", "approach")}
    for method in METHODS.values():
        method.alike.solve(alike, 1e-6)
    for name, value in before.items():
        np.testing.assert_array_equal(getattr(alike.normal, name), value)


def test_what_a_method_cannot_do_it_refuses(alike):
    with pytest.raises(ValueError, match="forces"):
        Uzawa().solve(replace(alike, forces=FORCES), 1e-6)
    with pytest.raises(ValueError, match="wear"):
        Newton().solve(replace(alike, wear=lambda *fields: 0.0 * fields[0]), 1e-6)


def test_bodies_that_do_not_touch_need_no_solver(alike):
    apart = replace(alike.normal, load=None, approach=-1.0)
    outcome = Sequential(NORMAL, Newton()).solve(replace(alike, normal=apart), 1e-8, Start())
    assert outcome.converged
    assert not outcome.pressure.any()
