"""What the Newton methods share: when to stop, how exactly to solve, how far to go."""

from collections.abc import Callable
from typing import Protocol, TypeVar

import numpy as np

from tractive_sam.results.status import Status
from tractive_sam.solvers.problem import Transmission

HALVINGS = 6

PATIENCE = 3
"""Steps without a smaller residual after which a step is taken as far only as it helps."""

HOPELESS = 20
"""Steps without a smaller residual after which no more are taken."""

LOOSEST = 0.3
GOLDEN = 0.5 * (1.0 + 5.0**0.5)
"""Loosest relative residual of the linear system of a step, and the order that steps aim at."""

SHARP = 1e-5
"""That of a step which is taken only as far as it helps: where the residual has stalled, only a
sharp step is sure to lead down."""

ROUGH = 1e-4
"""Relative residual down to which a linear system may be solved in single precision."""

LARGE = 10_000
"""Elements from which single precision pays: below, memory does not bound the time."""


class Iterate(Protocol):
    """A state with its natural residual, its merit and the creepages found so far.

    `others` is the slip beside that of the creepages (`Transmission.others`).
    """

    residual: float
    merit: float
    creepage: np.ndarray
    others: float


State = TypeVar("State", bound=Iterate)


def newton_steps(
    at: State,
    advance: Callable[[State, float, bool], State],
    transmission: Transmission,
    tolerance: float,
    steps: int,
) -> tuple[State, int, Status]:
    """Advance until the residual meets the tolerance, the state runs away, or steps run out.

    `advance` takes a state, the relative residual to which to solve its linear system, and whether
    the residual has stalled; it returns the next state.

    Returns
    -------
    at : State
        Where it ended.
    taken : int
        Steps taken.
    status : Status
        Why it ended.
    """
    least, since, before = np.inf, 0, np.inf
    for taken in range(steps + 1):
        if at.residual <= tolerance:
            return at, taken, Status.CONVERGED
        if not np.isfinite(at.residual) or transmission.lost(at.creepage, at.others):
            return at, taken, Status.DIVERGED
        if at.residual < 0.9 * least:
            least, since = at.residual, taken
        if taken - since > HOPELESS:
            return at, taken, Status.OUT_OF_ITERATIONS
        if taken < steps:
            stalled = taken - since >= PATIENCE
            goal = SHARP if stalled else forcing(at.residual, before, tolerance)
            before = at.residual
            at = advance(at, goal, stalled)
    return at, steps, Status.OUT_OF_ITERATIONS


def forcing(residual: float, before: float, tolerance: float) -> float:
    """Relative residual to which a linear system is worth solving (inexact Newton).

    By how much the step before has gained (Eisenstat & Walker 1996, SIAM J. Sci. Comput. 17, 16-32,
    choice 2): loose while the stick and slip zones still move, sharp towards the end, and never
    beyond what the tolerance needs.

    Parameters
    ----------
    residual, before : float
        Natural residuals now and before the last step; infinite before the first one.
    tolerance : float
        That of the problem.
    """
    gained = min(1.0, residual / before) ** GOLDEN if before < np.inf else 1.0
    loosest = min(LOOSEST, residual**0.25)  # the sharper, the nearer the first guess
    wanted = max(min(loosest, 0.9 * gained), 1e-3, 0.3 * tolerance / residual)
    return float(min(wanted, 0.5))


def precision(goal: float, elements: int) -> type:
    """Type of numbers in which to solve a linear system to a relative residual.

    A step need not be exact; what it leads to is evaluated in double precision.
    """
    return np.float32 if goal >= ROUGH and elements >= LARGE else np.float64


def damped(trial: Callable[[float], State], merit: float, length: float, stalled: bool) -> State:
    """The trial of the length given, or of the longest halving that does not raise the merit.

    The active sets of a step may be worse for a while on the way to a better solution, so a rise
    by half is allowed; where none is that good, the best one is taken. Where the residual has
    stalled, full steps swing between two states: then the best one is taken as well.
    """
    trials = []
    for _ in range(HALVINGS):
        trials.append(trial(length))
        if not stalled and trials[-1].merit <= 1.5 * merit:
            return trials[-1]
        length *= 0.5
    return min(trials, key=lambda one: one.merit)
