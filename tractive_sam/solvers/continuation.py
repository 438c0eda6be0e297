"""Continuation: a hard problem by way of easier ones, each started from the one before.

The way begins in full slip, at `FULL` times the creepages: there tractions oppose the rigid slip,
whatever the elasticity does. As the creepages fall, stick spreads from the leading edge. A stretch
of the way that fails is halved.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

from tractive_sam.solvers.outcome import Outcome
from tractive_sam.solvers.problem import CoupledProblem, TangentialProblem

FULL = 1e3
FIRST, SHORTEST = 0.25, 1.0 / 64.0
"""Stretches of the way from 0 to 1: the first one, and the shortest before giving up."""

ROUGHLY = 1e-4
"""Residual asked for on the way."""

Problem = TypeVar("Problem", TangentialProblem, CoupledProblem)
Start = TypeVar("Start")
"""An outcome, or whatever else has its fields."""

Solve = Callable[[Problem, float, Start], Outcome]


def continued(problem: Problem, tolerance: float, solve: Solve, first: Start) -> Outcome:
    """Solve by continuation in the creepages.

    Parameters
    ----------
    problem : TangentialProblem or CoupledProblem
        The problem.
    tolerance : float
        Natural residual, relative, at which to stop.
    solve : callable
        Solves a problem to a tolerance, from the outcome of a similar one.
    first : object
        Handed to `solve` in place of such an outcome, where the way begins.

    Returns
    -------
    Outcome
        With the cost of the whole way; not converged where it did not lead to its end.
    """
    rough = max(tolerance, ROUGHLY)
    now = solve(eased(problem, 0.0), rough, first)
    done, stretch, taken = 0.0, FIRST, 1
    while now.converged and done < 1.0 and stretch >= SHORTEST:
        ahead = min(1.0, done + stretch)
        tried = solve(eased(problem, ahead), tolerance if ahead == 1.0 else rough, now)
        taken += 1
        if tried.converged:
            now, done, stretch = tried.after(now), ahead, 2.0 * stretch
        else:
            now = replace(now, cost=now.cost + tried.cost)
            stretch *= 0.5
    if done < 1.0:
        failed = tried if now.converged else now
        now = replace(now, status=failed.status, residual=failed.residual)
    led = f"newton continued in creepage: {now.status} after {taken} problems"
    if done < 1.0:
        led += f", {done:.0%} of the way"
    return replace(now, trace=(led,))


def eased(problem: Problem, done: float) -> Problem:
    """The problem at a part of the way, from 0 to 1."""
    return replace(problem, rigid=FULL ** (1.0 - done) * problem.rigid)
