"""Jumps over many revolutions, with the error held and no limit by stability.

The profile with which material enters obeys E(n + 1) = E(n) + R(E(n)), R the wear of a pass. Taken
as dE/dn = R(E), it is stiff: short waves of the profile decay within tens of revolutions, which
limits every explicit jump to 40-75 of them on the paper's mesh, while the profile itself evolves
over thousands. A Rosenbrock-W method of second order (ROS2: Verwer, Spee, Blom & Hundsdorfer 1999,
SIAM J. Sci. Comput. 20, 1456-1480) is linearly implicit in the response of `rolling.response` only,
keeps its order for any approximation of it, and is L-stable: the shortest waves vanish in a jump of
any length.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from tractive_sam.contact import Model
from tractive_sam.rolling.passage import Passage, next_passage, off_grid, passage_at
from tractive_sam.rolling.response import wear_response

GAMMA = 1.0 - np.sqrt(0.5)
"""Coefficient of ROS2 with which it is L-stable and its error small."""

SAFETY, SHORTEST_CUT, LONGEST_GROWTH = 0.8, 0.2, 3.0
"""Of the step control."""

LAG = 0.1
"""Residual that the wear within a pass may leave, over the tolerance of the stepping."""

PESSIMISM = 10.0
"""What the error estimate, that of the embedded method of first order, overstates.

With it, the profile of the scene `twin-discs` after 15,000 revolutions is within about two
tolerances everywhere and within a fifth of one at its deepest (benchmarks/wear.py)."""


def adaptive_passages(model: Model, start: Passage) -> Iterator[Passage]:
    """Roll from a passage to the end in jumps, meeting every revolution to be saved.

    Each jump costs two contacts, and one more where it is refused and tried again.

    Parameters
    ----------
    model : Model
        The scene in numbers.
    start : Passage
        Where to go on.
    """
    wear = model.scene.wear
    stops = sorted({*wear.save, wear.revolutions})
    last = start
    while last.contact.converged and last.revolution < wear.revolutions:
        if last.revolution == 0:
            last = next_passage(model, last)
        else:
            stop = next(stop for stop in stops if stop > last.revolution)
            last = _next_jump(model, last, stop)
        yield last


def _next_jump(model: Model, last: Passage, stop: int) -> Passage:
    """The longest jump towards the stop that keeps the error within the tolerance."""
    # While the rows in contact wear down, the bodies close in on the rows beside them.
    closing = last.jump * float(last.worn[last.worn > 0.0].mean())
    response = wear_response(model, last.contact, closing)
    jump = _towards(stop - last.revolution, last.jump)
    solves = 0
    while True:
        now, error = _jump(model, last, jump, response)
        solves += now.solves
        change = np.clip(SAFETY / np.sqrt(max(error, 1e-6)), SHORTEST_CUT, LONGEST_GROWTH)
        if error <= 1.0 or jump == 1 or (off_grid(now) and model.scene.grid is None):
            # A jump cut short to meet a stop says little about the next one.
            after = max(jump * change, last.jump if jump < last.jump else 0.0)
            return replace(now, solves=solves, jump=max(1, int(after)))
        jump = max(1, int(jump * change))


def _towards(distance: int, jump: int) -> int:
    """A jump that meets the stop; two equal ones rather than a long and a very short one."""
    if jump >= distance:
        return distance
    return min(jump, -(-distance // 2))


def _jump(model: Model, last: Passage, jump: int, response: np.ndarray) -> tuple[Passage, float]:
    """One step of ROS2 and its error over the tolerance."""
    tolerance = model.scene.wear.tolerance
    lag = max(LAG * tolerance, model.scene.solver.tolerance)
    revolution, entering = last.revolution + jump, last.entering
    system = np.eye(entering.size) - GAMMA * jump * response

    first = np.linalg.solve(system, last.worn)
    trial = np.maximum(entering + jump * first, entering)
    expected = np.maximum(last.worn + response @ (trial - entering), 0.0)
    middle = passage_at(model, revolution, trial, last.contact, lag, expected)
    if not middle.contact.converged:
        return middle, np.inf
    second = np.linalg.solve(system, middle.worn - 2.0 * first)
    profile = np.maximum(entering + jump * (1.5 * first + 0.5 * second), entering)

    # The embedded solution of first order, entering + jump * first, is L-stable as well.
    missed = 0.5 * jump * (first + second)
    error = np.abs(missed).max() / profile.max() / (PESSIMISM * tolerance)
    if error > 1.0 and jump > 1:
        return middle, error
    expected = np.maximum(middle.worn + response @ (profile - trial), 0.0)
    now = passage_at(model, revolution, profile, middle.contact, lag, expected)
    return replace(now, solves=middle.solves + now.solves), error
