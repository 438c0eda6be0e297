"""A user-defined method in place of the package's, for one contact and for a roll."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

import tractive_sam as ts

SOLVERS = ts.solvers


@dataclass(frozen=True)
class Clipped:
    """Plain projected iteration of the tangential problem, without a start it begins at zero."""

    step: float = 0.3
    most: int = 20_000

    def solve(self, problem, tolerance, start=None):
        traction = np.zeros_like(problem.rigid) if start is None else start.traction
        pressure, gap = problem.normal.pressure, problem.normal.gap
        radius, seen = problem.bound(pressure).radius, problem.friction_slip(pressure, gap)
        status, residual = SOLVERS.Status.OUT_OF_ITERATIONS, np.inf
        taken = 0
        while taken < self.most and status is not SOLVERS.Status.CONVERGED:
            taken += 1
            slip = problem.rigid + problem.response(traction)
            opposed = problem.opposed(traction, slip, seen)
            nearest = problem.project(traction - opposed, radius, physical=False)
            residual = np.linalg.norm(nearest - traction) / np.linalg.norm(nearest)
            if residual <= tolerance:
                status = SOLVERS.Status.CONVERGED
            else:
                traction = problem.project(traction - self.step * opposed, radius, physical=False)
        return SOLVERS.Outcome(
            status,
            residual,
            taken,
            SOLVERS.Cost(taken),
            traction=traction,
            slip=slip,
            trace=(SOLVERS.Note("clipped", status),),
        )


MINE = SOLVERS.Sequential(SOLVERS.ConjugateGradients(), Clipped())
SMALL = ["grid.elements=[15, 15]", "solver.tolerance=1e-7"]


def test_finds_the_same_contact():
    scene = ts.Scene.builtin("spheres").with_set(SMALL)
    mine, theirs = ts.solve(scene, solver=MINE), ts.solve(scene)
    assert mine.converged
    assert "clipped: converged" in mine.trace
    # Two solves to 1e-7, amplified by the slip operator.
    np.testing.assert_allclose(mine.traction, theirs.traction, atol=1e-4 * theirs.p_max)


def test_rolls():
    settings = ["wear.revolutions=2", "wear.save=[0, 2]", "grid.elements=[15, 27]"]
    scene = ts.Scene.builtin("twin-discs").with_set([*settings, "solver.tolerance=1e-7"])
    mine, theirs = ts.roll(scene, solver=MINE), ts.roll(scene)
    assert mine.finished
    assert mine["wear_max"][-1] == pytest.approx(theirs["wear_max"][-1], rel=1e-4)


def test_a_failure_is_reported_and_raised():
    scene = ts.Scene.builtin("spheres").with_set(SMALL)
    hasty = replace(MINE, tangential=Clipped(most=3))
    with pytest.raises(ts.NotConverged) as caught:
        ts.solve(scene, solver=hasty)
    assert "clipped" in str(caught.value)


def test_what_is_no_solver_is_refused():
    scene = ts.Scene.builtin("spheres")
    with pytest.raises(TypeError, match="solver"):
        ts.solve(scene, solver="newton")
    with pytest.raises(TypeError, match="laws"):
        ts.solve(scene, laws=ts.Coulomb())
