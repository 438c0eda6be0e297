"""Whether friction that falls with sliding leaves one solution.

Consider one element of compliance c, with fixed tractions of all others: if its traction falls by
dq, it slips by c dq more. An element that sticks under q can also slide by s if its bound g has
fallen enough: c (q - g(s)) >= s. An element that slides by s can also stick, under g(s) + s/c, if
the bound of rest allows it: c (g(0) - g(s)) >= s. Both are secants of the bound. A second state of
sliding is possible if the tangent is steep: -c g'(s) >= 1.

In steady rolling a particle slips by the difference of two displacements, so that elements behind
hardly act on those ahead, and each counts alone. In a step it slips by the displacement itself:
all elements displace each other, and their bounds fall together. Two solutions differ in slip by
ds = -A dq, with dq = -G ds by the secants G of the bounds: there is one solution if the spectral
radius of G A is below one.
"""

from dataclasses import dataclass, replace

import numpy as np

from tractive_sam.mechanics import Bound
from tractive_sam.operators import FrictionSlip
from tractive_sam.solvers.problem import (
    FixedPressure,
    Outcome,
    Problem,
    ProblemSolver,
    Start,
    needed,
)


def steepness(
    problem: Problem,
    pressure: np.ndarray,
    gap: np.ndarray,
    traction: np.ndarray,
    slip: np.ndarray,
    reaction: float = 1.1,
) -> float:
    """Return the fall of friction over its uniqueness limit; from 1 on several solutions may exist.

    Parameters
    ----------
    problem : Problem
        The problem that was solved.
    pressure, gap : ndarray, shape (n_x, n_y)
        Pressure and gap of the solution, dimensionless.
    traction, slip : ndarray, shape (2, n_x, n_y)
        Traction of the solution and slip of the leading faces, dimensionless.
    reaction : float
        Ratio of an element's compliance with elastic neighbours to that with fixed ones. With it,
        18 of 22 random line contacts from 1 on have another solution, and none of 38 below
        (``benchmarks/branches.py``).
    """
    seen = problem.friction_slip(pressure, gap)
    bound = problem.bound_sliding(problem.bound(pressure), pressure, traction, slip, seen)
    if bound.slope is None:
        return 0.0
    sliding, _ = problem.sliding(pressure, gap, traction, slip)
    joint = problem.kinematics.joint
    compliance = max(problem.kinematics.self_influence(problem.operators)[::2])
    tangent = float(bound.slope.steepness[sliding].max(initial=0.0))
    if seen.staggered and not joint:
        # The slip at the centre has three quarters of the slip of the leading face. Being a mean of
        # faces it is continuous from stick to slip: secants do not matter.
        return 0.75 * compliance * tangent
    size = np.hypot(*seen.sticking(slip, traction))
    samples = 48 if joint else 96
    secants = _secants(problem, seen, bound, pressure, traction, sliding, size, samples)
    if joint:
        slope = np.maximum(secants, np.where(sliding, bound.slope.steepness, 0.0))
        return _joint_steepness(problem, traction, slope)
    return compliance * max(tangent, reaction * float(secants.max(initial=0.0)))


@dataclass(frozen=True)
class UniqueSolution:
    """Solver that uses a start only if the solution is unique, else follows a path.

    So the result does not depend on the start of the search.

    Attributes
    ----------
    nearby : ProblemSolver
        Solves a problem from a start.
    path : ProblemSolver
        Solves it without a start, if `nearby` fails or finds one of several solutions.
    """

    nearby: ProblemSolver
    path: ProblemSolver

    def solve(
        self, problem: Problem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Solve from a start; if several solutions may exist, solve again without it."""
        if start is None or not problem.kinematics.joint:
            return self.path.solve(problem, tolerance, start)
        outcome = self.nearby.solve(problem, tolerance, start)
        if not outcome.converged:
            return self.path.solve(problem, tolerance).costing(outcome)
        solution = outcome
        if isinstance(fixed := problem.normal, FixedPressure):
            solution = replace(outcome, pressure=fixed.pressure, gap=fixed.gap)
        steepest = steepness(problem, *solution.fields)
        if steepest < 1.0:
            return replace(outcome, steepness=steepest)
        return self.path.solve(problem, tolerance).costing(outcome)


def _joint_steepness(
    problem: Problem, traction: np.ndarray, slope: np.ndarray, iterations: int = 6
) -> float:
    """Return the spectral radius that decides on uniqueness if elements act on each other.

    Parameters
    ----------
    problem : Problem
        A step.
    traction : ndarray, shape (2, n_x, n_y)
        Tractions of the solution.
    slope : ndarray, shape (n_x, n_y)
        Slopes of the bounds.
    iterations : int
        Most power iterations, of one application each. Scaled by the root of the slopes the matrix
        is symmetric and nearly positive: the error of Rayleigh's quotient falls with the square,
        and a vector that shrinks everywhere shows that the radius is below one (Collatz 1942,
        Math. Z. 48, 221-226), which is all that matters then.
    """
    carried, root = np.hypot(*traction), np.sqrt(np.maximum(slope, 0.0))
    if not root.any():
        return 0.0
    along = root * traction / np.where(carried > 0.0, carried, 1.0)
    vector, radius = root / np.linalg.norm(root), 0.0
    for _ in range(iterations):
        answer = (along * problem.operators.tangential(along * vector)).sum(axis=0)
        radius = float((vector * answer).sum())
        ahead = vector > 0.0
        if (answer[ahead] < vector[ahead]).all():
            break
        vector = np.maximum(answer, 0.0) / np.linalg.norm(answer)
    return radius


def _secants(
    problem: Problem,
    seen: FrictionSlip,
    bound: Bound,
    pressure: np.ndarray,
    traction: np.ndarray,
    sliding: np.ndarray,
    size: np.ndarray,
    samples: int,
) -> np.ndarray:
    """Return the steepest secants of falling friction between stick and slip, (n_x, n_y).

    The fall of a bound is summed up over slips from 1e-6 to 100 of full slip, of 96 each a fifth
    more than the one before, so that a memory counts only as far as the element itself fills it.
    """
    carried = np.hypot(*traction)
    sticking = (seen.bound > 0.0) & ~sliding
    against = -traction / np.where(carried > 0.0, carried, 1.0)
    fall = before = np.zeros_like(carried)
    last, steepest = 0.0, np.zeros_like(carried)
    for slipped in np.geomspace(1e-6, 1e2, samples):
        moved = problem.friction.bound_sliding(
            pressure, slipped * against, seen.bound, seen.staggered
        )
        slope = needed(moved.slope, "bound.slope").steepness
        ahead = fall + 0.5 * (slope + before if last else 2.0 * slope) * (slipped - last)
        passed = sliding & (last < size) & (size <= slipped)
        share = (size[passed] - last) / (slipped - last)
        fallen = fall[passed] + share * (ahead - fall)[passed]
        steepest[passed] = np.maximum(steepest[passed], fallen / size[passed])
        missed = carried - (bound.radius - ahead)
        steepest = np.where(sticking, np.maximum(steepest, missed / slipped), steepest)
        fall, before, last = ahead, slope, slipped
    return steepest
