"""Uzawa's method: the paper's solver and the baseline that the others are measured against."""

import numpy as np

from tractive_sam.results.status import Cost, Status
from tractive_sam.solvers.fixed_point import CoupledMap, TangentialMap
from tractive_sam.solvers.outcome import Outcome

ITERATIONS = 100_000
PATIENCE = 400
"""Iterations without a smaller residual after which the step is taken to be too long."""


def uzawa(
    mapping: TangentialMap | CoupledMap,
    tolerance: float,
    start: np.ndarray,
    iterations: int = ITERATIONS,
) -> Outcome:
    """Repeat the projected step until the contact conditions hold (paper, section 7.5).

    Departures from the paper: it stops on the change of the iterate, which is small also where the
    step is, here the residual of the contact conditions is what has to fall; and it leaves the
    choice of the steps to the user, here they are taken from a bound and shortened if that was
    too bold.
    """
    before = mapping.applications
    state = best = mapping.admissible(start)
    least, since = np.inf, 0
    status = Status.OUT_OF_ITERATIONS
    taken = 0
    for taken in range(iterations + 1):
        now = mapping(state)
        if now.residual <= tolerance:
            status = Status.CONVERGED
            break
        if now.residual < least:
            best, least, since = state, now.residual, taken
        elif not np.isfinite(now.residual) or taken - since > PATIENCE:
            mapping.shorten(0.7)
            state, since = best, taken
            continue
        state = now.image
    cost = Cost(mapping.applications - before)
    return Outcome(status, now.residual, taken, cost, **now.fields)
