"""Jumps over many revolutions, with the error held and no limit by stability.

The profile with which material enters obeys E(n + 1) = E(n) + R(E(n)), R what lasts of the wear of
a pass. Over many revolutions that is stiff: short waves of the profile decay within tens of them,
which limits every explicit jump to 40-75 on the paper's mesh, while the profile itself evolves
over thousands. The two-step backward differentiation formula damps the shortest waves in a jump of
any length.

A sum is no integral. In the profile halfway through a revolution, F = E + R/2, it nearly is one:
by Euler and Maclaurin, F(m) - F(n) = integral of R dn + (R'(m) - R'(n))/12, and the last term is
small against the error of any jump longer than one revolution. A jump of one is the pass itself,
which needs no formula. Made linearly implicit in the response J of `rolling.response`,

    c_0 F_n + c_1 F_(n-1) + c_2 F_(n-2) = R* + J (E_n - E*),

with rate and profile extrapolated, R* and E*, from the two revolutions before, it keeps its second
order for any approximation of J (as IMEX methods do: Ascher, Ruuth & Wetton 1995, SIAM J. Numer.
Anal. 32, 797-823), and a jump costs one contact. The rate found there, against the one expected,
gives the error and corrects the profile from which the next jump starts: one Newton step of the
implicit formula, free of charge.

The formula misses dF/dn by a third of what the rate R differs from its extrapolation. That third is
taken back where waves are long, which makes the order three; it is left where they are short, by
the factor (1 - J/c_0)^-1, with which the formula stays stable at any length and at any growth of
the jumps up to 2.

At the rim, rows of elements come into contact one after the other, and no formula of many steps
holds across that. Such a row is worn from the moment at which its gap has closed, at a rate that
grows from zero.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from tractive_sam.contact import Model
from tractive_sam.rolling.control import ErrorControl, FixedSteps, Stops
from tractive_sam.rolling.passage import Passage, ProfilePoint, credited, passage_at
from tractive_sam.rolling.process import Process
from tractive_sam.rolling.response import block_responses, cycle_response
from tractive_sam.scene import Schedule

ALLOWED, POWER = 42.0, 1.3
"""Correction of a profile that a tolerance allows, over its depth: ALLOWED tolerance^POWER.

Errors of the jumps in which rows come into contact add up, and a strict tolerance takes more jumps.
With these, the error of the profile of `twin-discs` goes in proportion to the tolerance, and is up
to three times as large (benchmarks/wear.py)."""

LARGEST = 0.02
"""Correction of the profile, over its depth, that no tolerance allows: from further away one Newton
step does not lead to the profile, and longer jumps cost more contacts than they spare."""

NEW_ROWS = 4
"""Passes over the formula of rows that come into contact, which depends on when they do."""

REPEATS, ROUGHNESS = 2, 0.3
"""A jump is solved again at the corrected profile, at most so often, while the correction changes
the wear rate of a row, and with it its pressure, by more than a share of the largest: a row that
came into contact during the jump carries far too much or too little at first."""

SETTLING, SETTLED = 0.35, 0.3
"""Longest jump over the distance to the next revolution that is saved, and the jump that is short
enough at last, over the time in which the shortest waves decay.

Rows of elements come into contact at the rim one after the other, and the pressure there rises and
falls with each. Long jumps meet the profile, but not the moment of that."""


def adaptive_passages(
    process: Process[Passage], start: Passage, schedule: Schedule
) -> Iterator[Passage]:
    """Roll from a passage to the end in jumps, meeting every revolution to be saved.

    Each jump costs one contact; more where rows come into contact, and where it is refused and
    tried again.

    Parameters
    ----------
    process : Process
        What is rolled.
    start : Passage
        Where to go on.
    schedule : Schedule
        What to meet, and where to end.
    """
    control: Stops | FixedSteps = Stops(ErrorControl(order=3), schedule.stops, SETTLING)
    if schedule.fixed:
        control = FixedSteps(schedule.stops)
    last = start
    while last.converged and last.revolution < schedule.end:
        last = _next_jump(process, last, control)
        yield last


def _next_jump(process: Process[Passage], last: Passage, control: Stops | FixedSteps) -> Passage:
    """The longest jump towards the next stop that keeps the error within the tolerance."""
    model = process.model
    # While the rows in contact wear down, the bodies close in on the rows beside them.
    closing = last.jump * last.gained.sum() / max(np.count_nonzero(last.gained), 1)
    responses = block_responses(model, last, closing)
    response = sum(w * one for w, one in zip(last.weights, responses, strict=True))
    fastest = np.abs(np.diag(response)).max()
    settled = int(SETTLED / max(fastest, 1e-12))
    step = control.first(last.revolution, last.jump, settled)
    solves = 0
    while True:
        jump = _one if step.length == 1 else _many
        now, error = jump(model, last, step.length, response)
        solves += now.solves
        now = credited(last, now)
        if control.accepts(error) or step.length == 1:
            now = process.observe(replace(now, responses=responses), last)
            error = max([error, *(one.missed(model) for one in now.observed.values())])
        off_grid = now.off_grid and not model.scene.has_fixed_domain
        if control.accepts(error) or step.length == 1 or off_grid:
            if not now.observed:  # the contact has left the mesh
                now = process.observe(now, last)
            return replace(now, solves=solves, jump=control.next(step, error))
        step = control.shorter(step, error)


@dataclass(frozen=True, eq=False)
class _Formula:
    """The two-step formula of a jump; from one revolution, that of Euler.

    A row of elements that comes into contact during the jump has a formula of its own.
    """

    jump: int
    here: ProfilePoint
    """Where the jump starts."""
    known: np.ndarray
    """c_1 F_(n-1) + c_2 F_(n-2), per revolution."""
    profile: np.ndarray
    """E*, extrapolated."""
    rate: np.ndarray
    """R*, extrapolated."""
    leading: np.ndarray
    """c_0 of each row, 1/revolution."""
    worn_before: np.ndarray
    """Rows that have a course to extrapolate: those that were worn two solved revolutions ago."""
    third: float
    """What the formula misses of dF/dn, over what the rate differs from R*."""

    @classmethod
    def of(cls, course: tuple[ProfilePoint, ...], jump: int) -> "_Formula":
        last, worn_before = course[-1], course[0].rate > 0.0
        if len(course) == 1:
            leading = np.full(last.profile.size, 1.0 / jump)
            known = -leading * last.halfway
            return cls(jump, last, known, last.profile, last.rate, leading, worn_before, 0.0)
        before = course[-2]
        ratio = jump / (last.revolution - before.revolution)
        leading = np.full(last.profile.size, (1.0 + 2.0 * ratio) / (1.0 + ratio) / jump)
        known = (ratio**2 / (1.0 + ratio) * before.halfway - (1.0 + ratio) * last.halfway) / jump
        profile = last.profile + ratio * (last.profile - before.profile)
        rate = last.rate + ratio * (last.rate - before.rate)
        return cls(jump, last, known, profile, rate, leading, worn_before, 1.0 / 3.0)

    def with_new_rows(
        self, response: np.ndarray, open_: np.ndarray, profile: np.ndarray, rate: np.ndarray
    ) -> "_Formula":
        """The formula for rows that come into contact, by a profile and the rate there.

        Their gaps close evenly. What closes after they touch would wear them at a rate that grows
        from zero, if they did not wear; they wear at half the last rate on the mean.
        """
        new = ~self.worn_before & (self.here.rate <= 0.0) & (rate > 0.0)
        if not new.any():
            return self
        unworn = rate - np.diag(response) * (profile - self.here.profile)
        closing = unworn + open_  # may be nothing, where a row only just touches
        part = np.divide(unworn, closing, out=np.ones_like(closing), where=new & (closing > 0.0))
        in_contact = np.maximum(part * self.jump, 1.0)  # revolutions of the jump
        leading = np.where(new, 2.0 / in_contact, self.leading)
        known = np.where(new, -leading * self.here.profile, self.known)
        return replace(self, leading=leading, known=known)

    @property
    def _share(self) -> np.ndarray:
        """Of the rate, on its side of the formula: the rest is in F."""
        return 1.0 - 0.5 * self.leading

    def _solved(self, response: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """(c_0 - J)^-1 of a rate; rows out of contact, which are not coupled, by themselves."""
        rows = np.flatnonzero(response.any(axis=0) | response.any(axis=1))
        system = -self._share[rows, None] * response[np.ix_(rows, rows)]
        system.flat[:: rows.size + 1] += self.leading[rows]
        found = rate / self.leading
        found[rows] = np.linalg.solve(system, rate[rows])
        return found

    def predicted(self, response: np.ndarray, offset: np.ndarray) -> np.ndarray:
        """The profile E with the rate R = offset + J E."""
        return self._solved(response, self._share * offset - self.known)

    def correction(self, response: np.ndarray, profile: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """What a profile misses, by the rate found there."""
        missed = self._share * rate - self.leading * profile - self.known
        return self._solved(response, np.where(rate > 0.0, missed, 0.0))

    def of_third_order(self, response: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """What the formula itself misses of the profile where it has this rate."""
        # (c_0 - J)^-1 makes a correction of the profile of what the rate misses; c_0 (c_0 - J)^-1
        # once more leaves it to long waves, whose rate has a smooth course.
        known = self.worn_before & (rate > 0.0)
        missed = np.where(known, self.third * (self.rate - rate), 0.0)
        return self.leading * self._solved(response, self._solved(response, missed))


def _lag(model: Model) -> float:
    """Residual that the wear within a pass may leave."""
    return max(model.scene.wear.tolerance, model.scene.solver.tolerance)


def _error(model: Model, correction: np.ndarray, profile: np.ndarray) -> float:
    """A correction over the one that the tolerance allows."""
    allowed = min(ALLOWED * model.scene.wear.tolerance**POWER, LARGEST)
    return float(np.abs(correction).max() / max(profile.max(), 1e-300) / allowed)


def _one(model: Model, last: Passage, jump: int, response: np.ndarray) -> tuple[Passage, float]:
    """The next revolution, and the error over the tolerance that the formula would have had."""
    here, formula = last.course[-1], _Formula.of(last.course, jump)
    predicted, expected, response = _predicted(last, formula, response)
    profile = here.profile + here.rate if last.revolution else here.profile
    revolution = last.revolution + 1
    grown = _grown(expected, last)
    now = passage_at(model, revolution, profile, last.contacts, _lag(model), grown)
    if not now.converged:
        return now, np.inf
    # A single pass needs no formula: it only tells what the next, longer jump would miss. The rate
    # found at the true profile is moved to the one that the formula predicts.
    rate = now.gained + response @ (predicted - profile)
    error = _error(model, formula.correction(response, predicted, rate), profile)
    # Nothing is extrapolated from the unworn bodies: nothing is worn in their contact.
    course = (here, *now.course) if last.revolution else now.course
    return replace(now, course=course), error


def _many(model: Model, last: Passage, jump: int, response: np.ndarray) -> tuple[Passage, float]:
    """One step of the formula and its error over the tolerance."""
    revolution, here = last.revolution + jump, last.course[-1]
    formula, open_ = _Formula.of(last.course, jump), _open(last, response)
    profile, expected, response = _predicted(last, formula, response)
    lag = _lag(model)
    now = passage_at(model, revolution, profile, last.contacts, lag, _grown(expected, last))
    solves, error = 0, np.inf
    for repeats in range(1 + REPEATS):
        solves += now.solves
        if not now.converged:
            return replace(now, solves=solves), np.inf
        fitting = formula.with_new_rows(response, open_, profile, now.gained)
        correction = fitting.correction(response, profile, now.gained)
        if repeats == 0:
            error = _error(model, correction, profile)
        correction += fitting.of_third_order(response, now.gained + response @ correction)
        corrected = np.maximum(profile + correction, here.profile)  # nothing grows back
        # The contact is not solved again after the correction, unless it changes a rate by much:
        # then the response of the contact before does not tell what it does.
        change = response @ correction
        smooth = np.abs(change).max() <= ROUGHNESS * now.gained.max()
        if error > 1.0 or smooth or repeats == REPEATS:
            break
        profile, expected = corrected, np.maximum(now.gained + change, 0.0)
        now = passage_at(model, revolution, profile, now.contacts, lag, _grown(expected, now))
        response = cycle_response(model, now)
    reached = ProfilePoint(revolution, corrected, now.gained + change)
    return replace(now, solves=solves, course=(here, reached)), error


def _grown(expected: np.ndarray, last: Passage) -> np.ndarray:
    """The rate that is expected over that of a passage, row by row; of others nothing is known."""
    known = last.gained > 0.0
    return np.divide(expected, last.gained, out=np.zeros_like(expected), where=known)


def _open(last: Passage, response: np.ndarray) -> np.ndarray:
    """Rate of wear of each row that was lost as its gap was open, mm per revolution."""
    stiffness = -np.diag(response)
    near = stiffness > 0.0
    gap = np.min([contact.gap.min(axis=0) for contact in last.contacts], axis=0)
    return np.where(near, stiffness * np.where(near, gap, 0.0), 0.0)


def _predicted(
    last: Passage, formula: _Formula, response: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The profile by the formula, the rate expected there, and the response of rows in contact.

    Rows that were not worn two solved revolutions ago have no course to extrapolate. They
    start from the last one, and carry no pressure before their gap has closed; those whose gap
    does not close stay out of contact.
    """
    here, new, open_ = formula.here, ~formula.worn_before, _open(last, response)
    # R = offset + J E: linear about the extrapolated state, of new rows about the last one, where
    # what is left of the gap counts like a pressure below zero.
    offset = np.where(
        new,
        here.rate - response @ here.profile - open_,
        formula.rate - response @ formula.profile,
    )
    response = response.copy()
    while True:
        fitting = formula
        for _ in range(NEW_ROWS):
            profile = fitting.predicted(response, offset)
            expected = offset + response @ profile
            before, fitting = fitting, formula.with_new_rows(response, open_, profile, expected)
            if fitting is before:
                break
        # A row out of contact neither wears nor answers. Without it the others carry more, so they
        # are asked again; rows only leave, so this ends.
        apart = new & (expected < 0.0)
        if not apart.any():
            return np.maximum(profile, here.profile), np.maximum(expected, 0.0), response
        offset[apart] = 0.0
        response[apart] = 0.0
        response[:, apart] = 0.0
        new &= ~apart
