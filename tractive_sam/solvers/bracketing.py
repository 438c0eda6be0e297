"""Forces to transmit met between two creepages, where Newton's method fails.

A force falls as its creepage grows. Where nearly everything slips it falls in stairs, one for every
element that turns from slipping forward to slipping backward: so it is of dissimilar bodies that
roll freely with little friction. A Newton step sees no slope on a stair, and far too steep a one
between two; between a creepage with too much force and one with too little it is found all the
same.
"""

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from tractive_sam.results.status import Status
from tractive_sam.solvers.continuation import Problem, Solve, Start, continued
from tractive_sam.solvers.outcome import Outcome
from tractive_sam.solvers.problem import Transmission

FIRST, GROWTH = 1.0, 8.0
"""First step in search of the other side, in units of slip; how much longer each next one is."""

ROUGHLY = 1e-5
"""Residual asked for on the way."""

CLOSE = 1e-4
"""Force missed, over the sum of all tractions, from which Newton's method leads to the end."""


def led(problem: Problem, tolerance: float, solve: Solve, first: Start) -> Outcome:
    """Solve by way of easier problems; arguments of `bracketed`."""
    way = bracketed if len(problem.transmission) else continued
    return way(problem, tolerance, solve, first)


class _NotSolvedError(Exception):
    """Ends the way at a problem that could not be solved, or that no creepage has the force."""


def bracketed(problem: Problem, tolerance: float, solve: Solve, first: Start) -> Outcome:
    """Solve by giving creepages in place of the first force; another one is left to `solve`.

    Parameters
    ----------
    problem : TangentialProblem or CoupledProblem
        With forces to transmit.
    tolerance : float
        Natural residual, relative, at which to stop.
    solve : callable
        Solves a problem to a tolerance, from the outcome of a similar one.
    first : object
        Such an outcome, or what `solve` takes in place of one.

    Returns
    -------
    Outcome
        With the cost of the whole way; not converged where a problem on it could not be solved, or
        no creepage has the force.
    """
    forces = problem.transmission
    vector, target = forces.vectors[0], forces.target[0]
    others = Transmission(forces.vectors[1:], forces.target[1:])
    rough = max(tolerance, ROUGHLY)
    now, taken = first, 0

    def beyond(creepage: float) -> float:
        """Force above its target under a creepage; zero where it is close."""
        nonlocal now, taken
        given = replace(
            problem, rigid=problem.rigid + creepage * vector[:, None, None], transmission=others
        )
        start = now if now is None else replace(now, creepage=now.creepage[1:])
        found = solve(given, rough, start)
        if not found.converged:
            found = led(given, rough, solve, start).after(found)
        found = replace(found, creepage=np.append(creepage, found.creepage))
        now = found.after(now) if taken else found
        taken += 1
        if not found.converged:
            raise _NotSolvedError
        missed = vector @ found.traction.sum(axis=(1, 2)) - target
        close = CLOSE * np.linalg.norm(vector) * np.hypot(*found.traction).sum()
        return float(missed) if abs(missed) > close else 0.0

    try:
        here = 0.0 if first is None else float(first.creepage[0])
        missed = sides = beyond(here)
        step = np.sign(missed) * FIRST
        while missed * sides > 0.0:
            if forces.lost(now.creepage, forces.others(now.slip, now.creepage)):
                now = replace(now, status=Status.DIVERGED, residual=1.0)
                raise _NotSolvedError
            before, here = here, here + step
            missed, step = beyond(here), GROWTH * step
        if missed:
            brentq(beyond, before, here, disp=False)
        last = solve(problem, tolerance, now)
        taken += 1
        now = last.after(now)
    except _NotSolvedError:
        pass  # its outcome tells why
    told = f"newton between creepages: {now.status} after {taken} problems"
    return replace(now, trace=(told,))
