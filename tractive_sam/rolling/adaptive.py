"""Jumps over many revolutions, with the error held and no limit by stability.

The profile with which material enters obeys E(n + 1) = E(n) + R(E(n)), R the wear of a pass. Taken
as dE/dn = R(E), it is stiff: short waves of the profile decay within tens of revolutions, which
limits every explicit jump to 40-75 of them on the paper's mesh, while the profile itself evolves
over thousands. The two-step backward differentiation formula damps the shortest waves in a jump of
any length. Made linearly implicit in the response J of `rolling.response`,

    c_0 E_n + c_1 E_(n-1) + c_2 E_(n-2) = R* + J (E_n - E*),

with rate and profile extrapolated, R* and E*, from the two revolutions before, it keeps its second
order for any approximation of J (as IMEX methods do: Ascher, Ruuth & Wetton 1995, SIAM J. Numer.
Anal. 32, 797-823), and a jump costs one contact. The rate found there, against the one expected,
gives the error and corrects the profile from which the next jump starts: one Newton step of the
implicit formula, free of charge. The rate is R - J R / 2, with which the differential equation goes
through the revolutions that the sum over them meets, to the second order.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from tractive_sam.contact import Model
from tractive_sam.rolling.passage import Milestone, Passage, next_passage, off_grid, passage_at
from tractive_sam.rolling.response import wear_response

SAFETY, SHORTEST_CUT, LONGEST_GROWTH = 0.8, 0.2, 2.0
"""Of the step control; with variable steps the formula is stable up to a growth by 2.4."""

LAG = 0.3
"""Residual that the wear within a pass may leave, over the tolerance of the stepping."""

PESSIMISM = 15.0
"""What the correction of the profile, the estimate of the error, overstates.

With it, the profile of the scene `twin-discs` after 15,000 revolutions is within half of the
tolerance (benchmarks/wear.py)."""

LARGEST = 0.02
"""Correction of the profile, over its depth, that no tolerance allows: from further away one Newton
step does not lead to the profile, and longer jumps cost more contacts than they spare."""

REPEATS, ROUGHNESS = 2, 0.1
"""A jump is solved again at the corrected profile, at most so often, while the correction changes
the wear rate of a row, and with it its pressure, by more than a share of the largest: a row that
came into contact during the jump carries far too much or too little at first."""

SETTLING, SETTLED = 0.2, 0.3
"""Longest jump over the distance to the next revolution that is saved, and the jump that is short
enough at last, over the time in which the shortest waves decay.

Rows of elements come into contact at the rim one after the other, and the pressure there rises and
falls with each. Long jumps meet the profile, but not the moment of that."""


def adaptive_passages(model: Model, start: Passage) -> Iterator[Passage]:
    """Roll from a passage to the end in jumps, meeting every revolution to be saved.

    Each jump costs one contact; more where rows come into contact, and where it is refused and
    tried again.

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
    closing = last.jump * last.worn.sum() / max(np.count_nonzero(last.worn), 1)
    response = wear_response(model, last.contact, closing)
    jump = _towards(stop - last.revolution, last.jump, response)
    solves = 0
    while True:
        now, error = _jump(model, last, jump, response)
        solves += now.solves
        change = np.clip(SAFETY / np.cbrt(max(error, 1e-6)), SHORTEST_CUT, LONGEST_GROWTH)
        if error <= 1.0 or jump == 1 or (off_grid(now) and model.scene.grid is None):
            # A jump cut short to meet a stop says little about the next one.
            after = max(jump * change, last.jump if jump < last.jump else 0.0)
            return replace(now, solves=solves, jump=max(1, int(after)))
        jump = max(1, int(jump * change))


def _towards(distance: int, jump: int, response: np.ndarray) -> int:
    """The jump, shortened on the way to a stop at some distance."""
    fastest = np.abs(np.diag(response)).max()
    settled = int(SETTLED / fastest) if fastest * distance > SETTLED else distance
    return min(jump, distance, max(1, settled, int(np.ceil(SETTLING * distance))))


@dataclass(frozen=True)
class _Formula:
    """The two-step formula of a jump; with one milestone, that of Euler."""

    known: np.ndarray
    """c_1 E_(n-1) + c_2 E_(n-2), per revolution."""
    profile: np.ndarray
    """E*, extrapolated."""
    rate: np.ndarray
    """R*, extrapolated."""
    leading: float
    """c_0, 1/revolution."""

    @classmethod
    def of(cls, course: tuple[Milestone, ...], jump: int) -> "_Formula":
        last = course[-1]
        if len(course) == 1:
            return cls(-last.profile / jump, last.profile, last.rate, 1.0 / jump)
        before = course[-2]
        ratio = jump / (last.revolution - before.revolution)
        leading = (1.0 + 2.0 * ratio) / (1.0 + ratio) / jump
        known = (ratio**2 / (1.0 + ratio) * before.profile - (1.0 + ratio) * last.profile) / jump
        profile = last.profile + ratio * (last.profile - before.profile)
        rate = last.rate + ratio * (last.rate - before.rate)
        return cls(known, profile, rate, leading)


def _jump(model: Model, last: Passage, jump: int, response: np.ndarray) -> tuple[Passage, float]:
    """One step of the formula and its error over the tolerance."""
    tolerance = model.scene.wear.tolerance
    lag = max(LAG * tolerance, model.scene.solver.tolerance)
    revolution, entering = last.revolution + jump, last.course[-1].profile
    formula = _Formula.of(last.course, jump)
    profile, expected, response = _predicted(last, formula, response)
    now = passage_at(model, revolution, profile, last.contact, lag, expected)
    solves, error = 0, np.inf
    for repeats in range(1 + REPEATS):
        solves += now.solves
        if not now.contact.converged:
            return replace(now, solves=solves), np.inf
        rate = now.worn - 0.5 * response @ now.worn
        missed = np.where(rate > 0.0, rate - formula.leading * profile - formula.known, 0.0)
        system = formula.leading * np.eye(entering.size) - response
        correction = np.linalg.solve(system, missed)
        corrected = np.maximum(profile + correction, entering)
        change = response @ correction
        if repeats == 0:
            allowed = min(PESSIMISM * tolerance, LARGEST)
            error = np.abs(correction).max() / max(profile.max(), 1e-300) / allowed
        smooth = np.abs(change).max() <= ROUGHNESS * now.worn.max()
        if error > 1.0 or smooth or repeats == REPEATS:
            break
        profile, expected = corrected, np.maximum(now.worn + change, 0.0)
        now = passage_at(model, revolution, profile, now.contact, lag, expected)
        response = wear_response(model, now.contact)
    reached = Milestone(revolution, corrected, rate + change)
    return replace(now, solves=solves, course=(last.course[-1], reached)), error


def _predicted(
    last: Passage, formula: _Formula, response: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The profile by the formula, the rate expected there, and the response of rows in contact.

    Rows that were not worn two milestones ago have no course to extrapolate. They start from the
    last milestone, and carry no pressure before their gap has closed; those whose gap does not
    close stay out of contact.
    """
    here = last.course[-1]
    new = last.course[0].rate <= 0.0
    stiffness = np.diag(response)
    near = stiffness < 0.0
    opened = np.where(near, stiffness * np.where(near, last.contact.gap.min(axis=0), 0.0), 0.0)
    offset = np.where(
        new,
        here.rate - response @ here.profile + opened,
        formula.rate - response @ formula.profile,
    )
    response = response.copy()
    while True:
        system = formula.leading * np.eye(offset.size) - response
        profile = np.linalg.solve(system, offset - formula.known)
        expected = offset + response @ profile
        apart = new & (expected < 0.0)
        if not apart.any():
            return np.maximum(profile, here.profile), np.maximum(expected, 0.0), response
        offset[apart] = 0.0
        response[apart] = 0.0
        response[:, apart] = 0.0
        new &= ~apart
