"""Whether friction that falls with sliding leaves one solution: the measure, and its use."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from tests.solvers.small import tangential_problem
from tractive_sam.mechanics import FallingCoulomb, SlidingShare
from tractive_sam.operators import RollingStep
from tractive_sam.results import Cost
from tractive_sam.solvers import Outcome, Start, Status, steepness
from tractive_sam.solvers.falling_friction import UniqueSolution

N = 11  # elements in a direction
MIDDLE = 1.0  # dimensionless slip


@dataclass(frozen=True)
class Drop(SlidingShare):
    """A share of 1 / (1 + (speed / middle)^4), which falls more steeply than its secants."""

    middle: float
    least = 0.0

    def at(self, speed):
        ratio = speed / self.middle
        share = 1.0 / (1.0 + ratio**4)
        return share, -4.0 / self.middle * ratio**3 * share**2


def falling_problem(middle, slip="upwind", step=False):
    """Return a problem in which friction falls around the dimensionless slip `middle`."""
    problem = tangential_problem(N, slip)
    law = FallingCoulomb(mu=(1.0, 1.0), sliding=Drop(middle * problem.friction.slip), speed=1.0)
    friction = replace(problem.friction, law=law)
    kinematics = RollingStep(problem.kinematics.stencil, length=1.0) if step else problem.kinematics
    return replace(problem, friction=friction, kinematics=kinematics)


def fields_of(problem, middle, carried, ratios):
    """Return pressure, gap, traction and slip; the rear slides, the front carries a share."""
    pressure, gap = problem.normal.pressure, problem.normal.gap
    sliding = (pressure > 0.0) & (np.arange(N) < 6)[:, None]
    ratio = sliding * np.linspace(*ratios, N)
    direction = np.array([0.8, 0.6])[:, None, None]
    radius = pressure * np.where(sliding, 1.0 / (1.0 + ratio**4), carried)
    return pressure, gap, -radius * direction, middle * ratio * direction


def slopes_of(middle, pressure, traction, slip):
    """Return the steepest secants between stick and slip, and the tangents of sliding elements."""
    carried, size = np.hypot(*traction), np.hypot(*slip)
    other = middle * np.geomspace(1e-3, 30.0, 3000)[:, None, None]
    to_slip = ((carried - pressure / (1.0 + (other / middle) ** 4)) / other).max(axis=0)
    to_stick = (pressure - carried) / np.where(size > 0.0, size, 1.0)
    tangents = -pressure * Drop(middle).at(size)[1]
    return np.maximum(np.where(size > 0.0, to_stick, to_slip), 0.0), tangents


STATES = {  # share of the bound that sticking elements carry, slips of the others over `middle`
    "sticking elements can slide": (0.98, (0.2, 0.3)),
    "sliding elements can stick": (0.3, (2.0, 3.0)),
    "sliding elements can slide otherwise": (0.3, (0.8, 0.9)),
}


@pytest.mark.parametrize("case", STATES)
def test_in_steady_rolling_the_steepest_element_decides(case):
    problem = falling_problem(MIDDLE)
    fields = fields_of(problem, MIDDLE, *STATES[case])
    secants, tangents = slopes_of(MIDDLE, fields[0], *fields[2:])
    first, _, second = problem.operators.self_influence
    # 1.1 is the effect of the neighbours, 0.02 that of the sampled slips.
    expected = max(first, second) * max(tangents.max(), 1.1 * secants.max())
    assert steepness(problem, *fields) == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize("case", STATES)
def test_in_a_step_a_spectral_radius_decides(case):
    problem = falling_problem(MIDDLE, step=True)
    fields = fields_of(problem, MIDDLE, *STATES[case])
    slopes = np.maximum(*slopes_of(MIDDLE, fields[0], *fields[2:])).ravel()
    along = -np.array([0.8, 0.6])[:, None, None]
    units = np.eye(N * N).reshape(-1, N, N)
    columns = [(along * problem.operators.tangential(along * u)).sum(axis=0).ravel() for u in units]
    radius = np.abs(np.linalg.eigvals(slopes[:, None] * np.stack(columns, axis=1))).max()
    # Each sampled slip is half as large again as the one before: secants from stick are 0.06 too
    # flat. The power iteration comes within 0.01.
    allowed = 0.07 if case.startswith("sticking") else 0.01
    assert steepness(problem, *fields) == pytest.approx(radius, rel=allowed)


def test_a_mean_of_faces_has_three_quarters_of_the_slip_of_a_face():
    problem = falling_problem(MIDDLE, "auto")
    pressure, gap, traction, slip = fields_of(problem, MIDDLE, 0.3, (1.6, 1.8))
    sliding, bound = problem.sliding(pressure, gap, traction, slip)
    tangents = bound.slope.steepness
    assert tangents[sliding].max() < tangents.max()  # a sticking element slips at one face
    expected = 0.75 * max(problem.operators.self_influence) * tangents[sliding].max()
    assert steepness(problem, pressure, gap, traction, slip) == pytest.approx(expected)


class Recorder:
    """A solver that returns an outcome, and stores the starts that it is given."""

    def __init__(self, **outcome):
        self.outcome, self.starts = Outcome(**outcome), []

    def solve(self, problem, tolerance, start=None):
        self.starts.append(start)
        return self.outcome


def solve_near(middle, start, step=True, status=Status.CONVERGED):
    """Return the outcome of `UniqueSolution`, and the starts of the path; each solver costs 1."""
    problem = falling_problem(middle, "auto" if step else "upwind", step)
    traction, slip = fields_of(problem, middle, 0.3, (2.0, 3.0))[2:]
    known = {"status": status, "residual": 0.0, "iterations": 1, "cost": Cost(1)}
    nearby, path = Recorder(traction=traction, slip=slip, **known), Recorder(**known)
    return UniqueSolution(nearby, path).solve(problem, 1e-6, start), path.starts


def test_a_start_is_used_if_the_solution_near_it_is_the_only_one():
    outcome, starts = solve_near(2.4, Start())
    assert not starts
    assert 0.5 < outcome.steepness < 1.0


@pytest.mark.parametrize(("middle", "status"), [(1.4, Status.CONVERGED), (2.4, Status.DIVERGED)])
def test_a_path_without_the_start_follows_otherwise(middle, status):
    outcome, starts = solve_near(middle, Start(), status=status)
    assert starts == [None]
    assert outcome.cost == Cost(2)  # of both


@pytest.mark.parametrize(("start", "step"), [(None, True), (Start(), False)])
def test_without_a_start_and_in_steady_rolling_only_the_path_is_used(start, step):
    outcome, starts = solve_near(2.4, start, step)
    assert starts == [start]
    assert outcome.cost == Cost(1)
