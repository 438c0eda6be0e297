"""A given load through the approach, for methods that solve under a given approach."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from tractive_sam.results.status import Status
from tractive_sam.solvers.fixed_point import CoupledMap
from tractive_sam.solvers.outcome import Outcome

CORRECTIONS = 60


def under_load(
    solve: Callable[[CoupledMap, float, np.ndarray], Outcome],
    mapping: CoupledMap,
    tolerance: float,
    start: np.ndarray,
    approach: float,
) -> Outcome:
    """Correct the approach until the load is met (paper, section 7.5, steps a.1 and a.2).

    Parameters
    ----------
    solve : callable
        Method under given approach.
    mapping : CoupledMap
        The problem as a map, with a load.
    tolerance : float
        Natural residual, and relative error of the load, at which to stop.
    start : ndarray, shape (3, n_x, n_y)
        First guess of pressure and tractions.
    approach : float
        First guess of the approach.
    """
    problem = mapping.problem
    outcome = last = None
    state = start
    for _ in range(CORRECTIONS):
        mapping.problem = replace(problem, approach=approach)
        missed = np.inf if last is None else abs(last[1])
        # The load can be no better than the contact from which it is summed.
        inner = max(0.1 * tolerance, min(1e-3, 0.1 * missed))
        now = replace(solve(mapping, inner, state), approach=approach)
        outcome = now if outcome is None else now.after(outcome)
        if not now.converged:
            break
        state = np.concatenate((now.pressure[None], now.traction))
        error = now.pressure.sum() / problem.load - 1.0
        if abs(error) <= tolerance and now.residual <= tolerance:
            break
        # Secants, within reason of Hertz's load ~ approach^3/2: a load from a contact that is not
        # solved sharply does not bear an extrapolation.
        slope = hertz = 1.5 / approach
        if last is not None and approach != last[0]:
            slope = (error - last[1]) / (approach - last[0])
            slope = min(max(slope, 0.3 * hertz), 3.0 * hertz)
        last = (approach, error)
        approach -= error / slope
    else:
        outcome = replace(outcome, status=Status.OUT_OF_ITERATIONS)
    mapping.problem = problem
    return outcome
