"""Whether friction that falls with sliding leaves one solution.

Consider one element of compliance c, with fixed tractions of all others: if its traction falls by
dq, it slips by c dq more. An element that sticks under q can also slide by s if its bound g has
fallen enough: c (q - g(s)) >= s. An element that slides by s can also stick, under g(s) + s/c, if
the bound of rest allows it: c (g(0) - g(s)) >= s. Both are secants of the bound. A second state of
sliding is possible if the tangent is steep: -c g'(s) >= 1.
"""

import numpy as np

from tractive_sam.mechanics import Bound
from tractive_sam.operators import FrictionSlip
from tractive_sam.solvers.problem import Problem


def steepness(
    problem: Problem,
    pressure: np.ndarray,
    gap: np.ndarray,
    traction: np.ndarray,
    slip: np.ndarray,
    reaction: float = 1.1,
) -> float:
    """Return how fast friction falls over what leaves one solution; from 1 on there may be several.

    Parameters
    ----------
    problem : Problem
        What is solved.
    pressure, gap : ndarray, shape (n_x, n_y)
        Of the solution, dimensionless.
    traction, slip : ndarray, shape (2, n_x, n_y)
        Of the solution, dimensionless; slip of the leading faces.
    reaction : float
        Ratio of an element's compliance with elastic neighbours to that with fixed ones. With it,
        18 of 22 random line contacts from 1 on have another solution, and none of 38 below
        (``benchmarks/branches.py``).
    """
    seen = problem.friction_slip(pressure, gap)
    bound = problem.bound_sliding(problem.bound(pressure), pressure, traction, slip, seen)
    if bound.slope is None:
        return 0.0
    sliding = problem.sliding(pressure, gap, traction, slip)
    compliance = max(problem.operators.self_influence[::2])
    tangent = float(bound.slope.steepness[sliding].max(initial=0.0))
    if seen.staggered:
        # The slip at the centre has three quarters of the slip of the leading face. Being a mean of
        # faces it is continuous from stick to slip: secants do not matter.
        return 0.75 * compliance * tangent
    size = np.hypot(*seen.sticking(slip, traction))
    return compliance * max(
        tangent, reaction * _secant(problem, seen, bound, pressure, traction, sliding, size)
    )


def _secant(
    problem: Problem,
    seen: FrictionSlip,
    bound: Bound,
    pressure: np.ndarray,
    traction: np.ndarray,
    sliding: np.ndarray,
    size: np.ndarray,
    samples: int = 96,
) -> float:
    """Return the steepest secant of the bound between stick and slip, of one element alone.

    The fall of a bound is summed up over slips from 1e-6 to 100 of full slip, each a fifth more
    than the one before, so that a memory counts only as far as the element itself fills it.
    """
    carried = np.hypot(*traction)
    sticking = (seen.bound > 0.0) & ~sliding
    against = -traction / np.where(carried > 0.0, carried, 1.0)
    fall = before = np.zeros_like(carried)
    last = steepest = 0.0
    for slipped in np.geomspace(1e-6, 1e2, samples):
        moved = problem.friction.bound_sliding(
            pressure, slipped * against, seen.bound, seen.staggered
        )
        slope = moved.slope.steepness
        ahead = fall + 0.5 * (slope + before if last else 2.0 * slope) * (slipped - last)
        passed = sliding & (last < size) & (size <= slipped)
        share = (size[passed] - last) / (slipped - last)
        fallen = fall[passed] + share * (ahead - fall)[passed]
        steepest = max(steepest, float((fallen / size[passed]).max(initial=0.0)))
        missed = carried - (bound.radius - ahead)
        steepest = max(steepest, float((missed[sticking] / slipped).max(initial=0.0)))
        fall, before, last = ahead, slope, slipped
    return steepest
