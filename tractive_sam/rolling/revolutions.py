"""Rolling through revolutions or load blocks, and jumps with a controlled error over many.

The profile with which material enters obeys E(n + 1) = E(n) + R(E(n)), with R the lasting part of
the wear of a pass. Over many revolutions that is stiff: short waves of the profile decay within
tens of them, which limits every explicit jump to 40-75 on the paper's mesh, while the profile
evolves over thousands. The two-step backward differentiation formula damps the shortest waves in a
jump of any length.

A sum is not an integral. For the profile halfway through a revolution, F = E + R/2, it nearly is:
by Euler and Maclaurin, F(m) - F(n) = integral of R dn + (R'(m) - R'(n))/12, and the last term is
small against the error of any jump longer than one revolution. A jump of one is the pass, which
needs no formula. Made linearly implicit in the response J of `rolling.passage`,

    c_0 F_n + c_1 F_(n-1) + c_2 F_(n-2) = R* + J (E_n - E*),

with rate and profile extrapolated, R* and E*, from the two revolutions before, it has second order
for any approximation of J (as IMEX methods do: Ascher, Ruuth & Wetton 1995, SIAM J. Numer. Anal.
32, 797-823), and a jump costs one contact. The difference between the computed and the expected
rate gives the error and corrects the profile from which the next jump starts: one Newton step of
the implicit formula at no cost.

The formula misses dF/dn by a third of the difference between the rate R and its extrapolation. For
long waves that third is corrected, which makes the order three. For short waves it remains, by the
factor (1 - J/c_0)^-1, with which the formula is stable at any length and for growths of the jumps
up to 2.

At the rim, rows of elements come into contact one after the other, and no multi-step formula holds
across that. These rows wear from the moment at which their gap has closed, at a rate that grows
from zero.
"""

import math
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import ceil, inf, sqrt
from typing import ClassVar

import numpy as np

from tractive_sam.contact import Model, solve_on_fitted_mesh, with_heat
from tractive_sam.results import PARTS, ROLLED, SHARE, Record, State, cycle_record, restart_fields
from tractive_sam.rolling.observers import Damage
from tractive_sam.rolling.passage import (
    Passage,
    ProfilePoint,
    attribute_wear,
    block_responses,
    complete_passage,
    first_passage,
    mean_wear_response,
    next_passage,
    passage_at,
    start_passage,
)
from tractive_sam.rolling.process import (
    LONGEST_GROWTH,
    ErrorControl,
    FixedSteps,
    Process,
    Recorder,
    Stops,
    StoredStep,
)
from tractive_sam.scene import Scene, Schedule, Spectrum
from tractive_sam.schema import required

ALLOWED, POWER = 42.0, 1.3
"""Correction of a profile that a tolerance allows, over its depth: ALLOWED tolerance^POWER.

Errors of the jumps in which rows come into contact add up, and a strict tolerance takes more jumps.
With these values the error of the profile of `twin-discs` is proportional to the tolerance, and up
to three times as large (benchmarks/wear.py)."""

REPEATS, ROUGHNESS = 2, 0.3
"""A jump is solved again at the corrected profile, at most this often, while the correction changes
the wear rate of a row, and with it its pressure, by more than this share of the largest: a row that
came into contact during the jump first carries far too much or too little load."""

SETTLING, SETTLED = 0.35, 0.3
"""Longest jump over the distance to the next revolution that is saved, and the final jump, over the
time in which the shortest waves decay.

Rows of elements come into contact at the rim one after the other, and the pressure there rises and
falls with each. Long jumps give the right profile, but not the right moment of each contact."""


def adaptive_passages(
    process: Process[Passage], start: Passage, schedule: Schedule
) -> Iterator[Passage]:
    """Yield the passages in adaptive or fixed jumps, up to the last or an unsolved one.

    Each jump costs one contact; more if rows come into contact, or if it is refused and repeated.

    Parameters
    ----------
    process : Process
        The process.
    start : Passage
        Last passage.
    schedule : Schedule
        Revolutions to save, and the last one.
    """
    control: Stops | FixedSteps = Stops(ErrorControl(order=3), schedule.stops, SETTLING)
    if schedule.fixed:
        # The first revolution has the rate of the bodies as they are; a jump extrapolates from it.
        control = FixedSteps(tuple(sorted({1, *schedule.stops})))
    last = start
    unworn = process.model.laws
    while last.converged and last.revolution < schedule.end:
        process = process.with_laws(unworn.worn(last.contacts, process.model.scene))
        last = _next_jump(process, last, control)
        yield last


def _next_jump(process: Process[Passage], last: Passage, control: Stops | FixedSteps) -> Passage:
    """Return the passage after the longest jump of revolutions with a tolerated error."""
    model = process.model
    # While the rows in contact wear down, the bodies approach each other at the next rows.
    closing = last.jump * last.gained.sum() / max(np.count_nonzero(last.gained), 1)
    responses = block_responses(model, last, closing)
    each = zip(last.weights, responses, strict=True)
    response = np.sum([weight * block for weight, block in each], axis=0)
    fastest = np.abs(np.diag(response)).max()
    settled = int(SETTLED / max(fastest, 1e-12))
    longest, thinning = float(last.jump), required(model.scene.wear, "wear").layer_step
    if thinning is not None:  # no jump wears more off a layer than a step of its thickness
        bodies = model.scene.body.A, model.scene.body.B
        thickness = min(layer.thickness for body in bodies for layer in body.layer)
        worn = max(float(last.gained.max()), 1e-300)
        longest = max(1.0, min(longest, math.floor(thinning * thickness / worn)))
    step = control.first(last.revolution, int(longest), settled)
    solves = 0
    while True:
        jump = _roll if step.length == 1 else jump_on
        end, error = jump(model, last, int(step.length), response)
        solves += end.solves
        end = attribute_wear(last, end)
        if control.accepts(error) or step.length == 1:
            end = process.observe(replace(end, responses=responses), last)
            error = max([error, *(observer.missed(model) for observer in end.observed.values())])
        is_outgrown = end.is_outgrown and not model.scene.has_fixed_domain
        if control.accepts(error) or step.length == 1 or is_outgrown:
            if not end.observed:  # the contact has left the mesh
                end = process.observe(end, last)
            return replace(end, solves=solves, jump=int(control.next(step, error)))
        step = control.shorter(step, error)


@dataclass(frozen=True, eq=False)
class _TwoStepFormula:
    """Two-step implicit formula that extrapolates the worn profile over a jump.

    A row of elements that comes into contact during the jump has a separate formula.
    """

    jump: int
    here: ProfilePoint
    """Start of the jump."""
    past: np.ndarray
    """c_1 F_(n-1) + c_2 F_(n-2), per revolution."""
    profile: np.ndarray
    """E*, the extrapolated profile."""
    rate: np.ndarray
    """R*, the extrapolated rate."""
    leading: np.ndarray
    """c_0 of each row, 1/revolution."""
    worn_before: np.ndarray
    """Rows that can be extrapolated: those worn two solved revolutions ago."""
    third: float
    """Error of dF/dn by the formula, over the difference between the rate and R*."""

    @classmethod
    def from_course(cls, course: tuple[ProfilePoint, ...], jump: int) -> "_TwoStepFormula":
        """Return the formula of a jump, in revolutions, from the last one or two solved ones."""
        last, worn_before = course[-1], course[0].rate > 0.0
        if len(course) == 1:
            leading = np.full(last.profile.size, 1.0 / jump)
            past = -leading * last.halfway
            return cls(jump, last, past, last.profile, last.rate, leading, worn_before, 0.0)
        before = course[-2]
        ratio = jump / (last.revolution - before.revolution)
        leading = np.full(last.profile.size, (1.0 + 2.0 * ratio) / (1.0 + ratio) / jump)
        past = (ratio**2 / (1.0 + ratio) * before.halfway - (1.0 + ratio) * last.halfway) / jump
        profile = last.profile + ratio * (last.profile - before.profile)
        rate = last.rate + ratio * (last.rate - before.rate)
        return cls(jump, last, past, profile, rate, leading, worn_before, 1.0 / 3.0)

    def with_new_rows(
        self, response: np.ndarray, open_: np.ndarray, profile: np.ndarray, rate: np.ndarray
    ) -> "_TwoStepFormula":
        """Return the formula with separate coefficients for rows new in contact, if any.

        Their gaps close at a constant rate. Once they touch, the closing gap would wear them at a
        rate that grows from zero if they did not wear; on average they wear at half the last rate.
        """
        new = ~self.worn_before & (self.here.rate <= 0.0) & (rate > 0.0)
        if not new.any():
            return self
        unworn = rate - np.diag(response) * (profile - self.here.profile)
        closing = unworn + open_  # zero if a row only touches
        part = np.divide(unworn, closing, out=np.ones_like(closing), where=new & (closing > 0.0))
        in_contact = np.maximum(part * self.jump, 1.0)  # revolutions of the jump
        leading = np.where(new, 2.0 / in_contact, self.leading)
        past = np.where(new, -leading * self.here.profile, self.past)
        return replace(self, leading=leading, past=past)

    @property
    def _share(self) -> np.ndarray:
        """Coefficient of the wear rate in the formula, for each row of elements (one y)."""
        return 1.0 - 0.5 * self.leading

    def _solve(self, response: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """Return (c_0 - J)^-1 times a wear rate, mm; rows out of contact: rate / c_0."""
        rows = np.flatnonzero(response.any(axis=0) | response.any(axis=1))
        system = -self._share[rows, None] * response[np.ix_(rows, rows)]
        system.flat[:: rows.size + 1] += self.leading[rows]
        solution = rate / self.leading
        solution[rows] = np.linalg.solve(system, rate[rows])
        return solution

    def predict(self, response: np.ndarray, offset: np.ndarray) -> np.ndarray:
        """Return the profile E at the end of the jump; its wear rate is R = offset + J E."""
        return self._solve(response, self._share * offset - self.past)

    def correction(self, response: np.ndarray, profile: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """Return the Newton correction, mm, of a predicted profile; rows without wear miss nothing.

        `response` is the Jacobian of the rate with respect to the profile, 1/revolution.
        """
        missed = self._share * rate - self.leading * profile - self.past
        return self._solve(response, np.where(rate > 0.0, missed, 0.0))

    def third_order_correction(self, response: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """Return the correction, mm, that removes the formula's leading error from a profile."""
        # (c_0 - J)^-1 turns a missing rate into a correction of the profile; c_0 (c_0 - J)^-1
        # then restricts it to long waves, which have rates with a smooth course.
        smooth = self.worn_before & (rate > 0.0)
        missed = np.where(smooth, self.third * (self.rate - rate), 0.0)
        return self.leading * self._solve(response, self._solve(response, missed))


def _wear_tolerance(model: Model) -> float:
    """Return the tolerance of the contact conditions for wear within one pass."""
    return max(required(model.scene.wear, "wear").tolerance, model.scene.solver.tolerance)


def _relative_correction(model: Model, correction: np.ndarray, profile: np.ndarray) -> float:
    """Return the largest correction of a profile over the tolerated one: the error of a jump."""
    # Correction of the profile, over its depth, that no tolerance allows: from further away one
    # Newton step does not reach the profile, and longer jumps cost more contacts than they save.
    largest = 0.02
    allowed = min(ALLOWED * required(model.scene.wear, "wear").tolerance ** POWER, largest)
    return float(np.abs(correction).max() / max(profile.max(), 1e-300) / allowed)


def _roll(model: Model, last: Passage, jump: int, response: np.ndarray) -> tuple[Passage, float]:
    """Return the passage one revolution later, and the error of the next jump over tolerance."""
    here, formula = last.course[-1], _TwoStepFormula.from_course(last.course, jump)
    predicted, expected, response = _predict(last, formula, response)
    profile = here.profile + here.rate if last.revolution else here.profile
    revolution = last.revolution + 1
    grown = _growth(expected, last)
    end = passage_at(model, revolution, profile, last.contacts, _wear_tolerance(model), grown)
    if not end.converged:
        return end, np.inf
    # A pass needs no formula: the error belongs to the next, longer jump. The rate computed at the
    # true profile is moved to the profile that the formula predicts.
    rate = end.gained + response @ (predicted - profile)
    error = _relative_correction(model, formula.correction(response, predicted, rate), profile)
    # Unworn bodies cannot be extrapolated: nothing wears in their contact.
    course = (here, *end.course) if last.revolution else end.course
    return replace(end, course=course), error


def jump_on(model: Model, last: Passage, jump: int, response: np.ndarray) -> tuple[Passage, float]:
    """Return the passage after a jump of revolutions, and its error over the tolerance."""
    revolution, here = last.revolution + jump, last.course[-1]
    formula = _TwoStepFormula.from_course(last.course, jump)
    open_ = _rate_lost_to_gap(last, response)
    profile, expected, response = _predict(last, formula, response)
    lag = _wear_tolerance(model)
    end = passage_at(model, revolution, profile, last.contacts, lag, _growth(expected, last))
    solves, error = 0, np.inf
    for repeats in range(1 + REPEATS):
        solves += end.solves
        if not end.converged:
            return replace(end, solves=solves), np.inf
        fitting = formula.with_new_rows(response, open_, profile, end.gained)
        correction = fitting.correction(response, profile, end.gained)
        if repeats == 0:
            error = _relative_correction(model, correction, profile)
        correction += fitting.third_order_correction(response, end.gained + response @ correction)
        corrected = np.maximum(profile + correction, here.profile)  # wear cannot decrease
        # The contact is solved again after the correction only if a rate changes by much: then the
        # response of the contact before does not predict the change.
        change = response @ correction
        smooth = np.abs(change).max() <= ROUGHNESS * end.gained.max()
        if error > 1.0 or smooth or repeats == REPEATS:
            break
        profile, expected = corrected, np.maximum(end.gained + change, 0.0)
        end = passage_at(model, revolution, profile, end.contacts, lag, _growth(expected, end))
        response = mean_wear_response(model, end)
    reached = ProfilePoint(revolution, corrected, end.gained + change)
    return replace(end, solves=solves, course=(here, reached)), error


def _growth(expected: np.ndarray, last: Passage) -> np.ndarray:
    """Return the expected wear rate of each row over its last rate; 0 for rows without wear."""
    wears = last.gained > 0.0
    return np.divide(expected, last.gained, out=np.zeros_like(expected), where=wears)


def _rate_lost_to_gap(last: Passage, response: np.ndarray) -> np.ndarray:
    """Return the wear rate that the open gap of each row costs, mm per revolution."""
    stiffness = -np.diag(response)
    near = stiffness > 0.0
    gap = np.min([contact.gap.min(axis=0) for contact in last.contacts], axis=0)
    return np.where(near, stiffness * np.where(near, gap, 0.0), 0.0)


def _predict(
    last: Passage, formula: _TwoStepFormula, response: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return predicted profile and wear rate after a jump, and the response of rows in contact.

    Rows that were not worn two solved revolutions ago cannot be extrapolated. They start from the
    last revolution, and carry no pressure before their gap has closed; if it does not close they
    stay out of contact.
    """
    # Iterations of the formula of rows that come into contact, which depends on when they do.
    new_rows = 4
    here, new, open_ = formula.here, ~formula.worn_before, _rate_lost_to_gap(last, response)
    # R = offset + J E is linear about the extrapolated state, for new rows about the last one; the
    # remaining gap acts like a negative pressure.
    offset = np.where(
        new, here.rate - response @ here.profile - open_, formula.rate - response @ formula.profile
    )
    response = response.copy()
    while True:
        fitting = formula
        for _ in range(new_rows):
            profile = fitting.predict(response, offset)
            expected = offset + response @ profile
            before, fitting = fitting, formula.with_new_rows(response, open_, profile, expected)
            if fitting is before:
                break
        # A row out of contact neither wears nor responds. Without it the others carry more, so they
        # are predicted again; rows only leave, so this ends.
        open_rows = new & (expected < 0.0)
        if not open_rows.any():
            return np.maximum(profile, here.profile), np.maximum(expected, 0.0), response
        offset[open_rows] = 0.0
        response[open_rows] = 0.0
        response[:, open_rows] = 0.0
        new &= ~open_rows


class Forecast:
    """Forecast of the remaining steps and time of a roll, updated record by record.

    Jumps grow with the revolutions rolled, and shorten before every stop: they are predicted one by
    one, by the rule of `rolling.process`.

    Parameters
    ----------
    scene : Scene
        Scene that is rolled.

    Attributes
    ----------
    done, left : float
        Contacts solved, and contacts to solve.
    end : float
        Coordinate of the end.
    """

    growth: ClassVar[float] = 0.4
    """Exponent of the growth of jumps with the revolutions rolled, once wear shapes the contact."""

    unhindered: ClassVar[float] = 0.5
    """Jump over the revolutions rolled above which only its own growth or a stop limits it."""

    shaped: ClassVar[float] = 0.02
    """Wear depth over the approach of the bodies above which wear shapes the contact: jumps of
    spheres and twin discs stop doubling at .0145 to .018 (runs of tests/rolling/test_forecast.py).
    """

    recent: ClassVar[int] = 20
    """Number of records with times per contact that are used for the remaining ones."""

    longest: ClassVar[int] = 100_000
    """Steps that are predicted one by one; further steps have the length of the last one."""

    def __init__(self, scene: Scene) -> None:
        schedule = scene.schedule
        self._stops, self.end = schedule.stops, schedule.end
        self._adaptive = schedule.adaptive
        self._wish, self._spent = 0.0, list[tuple[float, float]]()
        self._here, self._step = 0.0, 1.0
        # Longest step that may reach a stop directly: until a step was cut, the last one that wear
        # did not limit, as both depend on the time in which waves of the profile decay.
        self._settled, self._unhindered = 0.0, 1.0
        self.done = self.left = 0.0

    def add(
        self, place: float, jump: float, solves: float, seconds: float, worn: float = 0.0
    ) -> None:
        """Update the forecast by a record: its coordinate, next jump, contact solves and seconds.

        `worn` is its wear depth over the approach of the bodies.
        """
        if self._adaptive and self._wish and place > self._here:
            self._learn(place - self._here, self._distance_to_stop(self._here), self._wish)
        step = place - self._here
        self._step = step if step > 0.0 else self._step
        before, self._here, self._wish = self._wish, place, jump
        self._spent = [*self._spent[1 - self.recent :], (solves, seconds)]
        self.done += solves
        steps = (self.end - place) / self._step
        if self._adaptive:
            steps = self._count_steps(jump, before or jump, worn)
        self.left = steps * float(np.mean([solves for solves, _ in self._spent]))

    @property
    def remaining_seconds(self) -> float:
        """Return the estimated remaining time, s, from the last records; 0 without records."""
        if not self._spent:
            return 0.0
        first = 1 if 1 < len(self._spent) < self.recent else 0
        solves, seconds = map(sum, zip(*self._spent[first:], strict=True))
        return self.left * seconds / solves if solves else 0.0

    def _learn(self, step: float, distance: float, wish: float) -> None:
        """Adjust, by a step taken, the longest step that may end directly at a stop."""
        nearer, longest = ceil(SETTLING * distance), min(wish, distance)
        if nearer < step < longest:
            self._settled = step
        elif step == nearer < longest:
            self._settled = min(self._settled or self._unhindered, step)
        elif step > nearer and self._settled:
            self._settled = max(self._settled, step)

    def _distance_to_stop(self, here: float) -> float:
        """Return the distance from a coordinate to the next stop of the schedule after it."""
        return self._stops[bisect_right(self._stops, here)] - here

    def _count_steps(self, jump: float, before: float, worn: float) -> float:
        """Return the predicted number of remaining steps, from the last two proposed jumps."""
        here, shaped, count = self._here, self._here, 0
        wish = sqrt(jump * before)
        if worn < self.shaped and jump >= self.unhindered * here:
            wish, shaped = jump, max(here, 1.0) * self.shaped / worn if worn > 0.0 else inf
            self._unhindered = jump * shaped / max(here, 1.0)
        settled = self._settled or self._unhindered
        while here < self.end:
            distance = self._distance_to_stop(here)
            nearer = ceil(SETTLING * distance)
            step = max(1.0, min(wish, distance, max(settled, nearer)))
            if count == self.longest:
                return count + (self.end - here) / step
            grown = (here + step) / max(here, 1.0)
            here += step
            wish *= LONGEST_GROWTH if here < shaped else grown**self.growth
            count += 1
        return count


class Revolutions(Process[Passage]):
    """Process of steady rolling: revolution by revolution with wear, or in adaptive jumps."""

    finite = ("approach", "Qx", "Qy", "Mz", "xi_x", "xi_y", "spin", "work_supplied", "residual")

    observers = (Damage,)

    def begin(self) -> Passage:
        """Return revolution zero: the steady contacts with the initial wear."""
        return first_passage(self.model)

    def begin_fitted(self) -> tuple["Revolutions", Passage]:
        """Solve all blocks on a fitted mesh; return the process on it, and revolution zero."""
        model, contacts = solve_on_fitted_mesh(self.model)
        return self._copy_with(model), start_passage(model, contacts)

    def advance(self, last: Passage) -> Iterator[Passage]:
        """Yield the revolutions after one, singly or in jumps, to the end or an unsolved one."""
        schedule, blocks = self.model.scene.schedule, self.model.blocks
        last = replace(last, contacts=tuple(map(with_heat, blocks, last.contacts)))
        if schedule.adaptive or schedule.fixed:
            yield from adaptive_passages(self, last, schedule)
            return
        process, unworn = self, self.model.laws
        while last.converged and last.revolution < schedule.end:
            process = process.with_laws(unworn.worn(last.contacts, self.model.scene))
            last = process.observe(next_passage(process.model, last), last)
            yield last

    @classmethod
    def expected_records(cls, scene: Scene, dx: float) -> int:
        """Return the (approximate) number of records for elements of the length dx, mm."""
        end = int(scene.schedule.end)
        if scene.schedule.fixed:
            return 1 + len({1, *scene.schedule.stops})
        if not scene.schedule.adaptive:
            return 1 + end
        # Jumps first double, then grow in proportion to the revolutions rolled, more slowly the
        # longer they are; slightly with the tolerance. From 10 to 50,000 revolutions of discs of
        # several crowns, runs have .5 to 1.8 times as many records.
        tolerance = required(scene.wear, "wear").tolerance
        jumps = 1 + 0.62 * np.log1p(end) ** 2 * max(1.0, (1e-3 / tolerance) ** 0.3)
        return 1 + min(end, round(jumps))

    @classmethod
    def restore(cls, scene: Scene, stored: StoredStep) -> Passage:
        """Return the passage of a stored record; `adopt` adds wear shares and observers."""
        history, row = stored.history, stored.row
        stored.require(cls.finite)
        stored.require(("entering_profile", "wear_per_revolution"), before=1)
        course = tuple(
            ProfilePoint(
                int(history["revolution"][k]),
                history["entering_profile"][k],
                history["wear_per_revolution"][k],
            )
            for k in (row - 1, row)
            if k > 0  # the unworn bodies cannot be extrapolated
        )
        jump = history["jump"][row]
        if not jump >= 1.0:  # "not" rather than "<": nan must fail, too
            raise LookupError("jump")
        contacts = cls._restore_contacts(scene, stored)
        blocks = cls._restore_blocks(scene, stored, len(contacts))
        return Passage(contacts, int(history["revolution"][row]), 0, int(jump), course, **blocks)

    @classmethod
    def _restore_contacts(cls, scene: Scene, stored: StoredStep) -> tuple[State, ...]:
        """Return the contact of a stored step, as a tuple of one."""
        return (stored.contact(scene),)

    @classmethod
    def _restore_blocks(cls, scene: Scene, stored: StoredStep, blocks: int) -> dict:
        """Return the stored wear by block and body (`parts`, or None), and equal `weights`."""
        history = stored.history
        parts = history[PARTS.name][stored.row] if PARTS.name in history.columns else None
        return {"parts": parts, "weights": (1.0,) * blocks}

    def adopt(self, step: Passage, stored: StoredStep) -> Passage:
        """Return a restored revolution with its observers and the wear shares of the model."""
        return super().adopt(complete_passage(self.model, step), stored)


class DutyCycle(Revolutions):
    """Process of steady rolling through the load blocks of a scene with [[duty]]."""

    @property
    def spectrum(self) -> Spectrum:
        """Load spectrum: the blocks of the duty cycle, with equal blocks merged."""
        return required(self.model.scene.spectrum, "duty")

    def state(self, step: Passage) -> dict[str, np.ndarray]:
        """Return all arrays of all blocks, by name, from which the process can resume.

        There are arrays of each block, in order.
        """
        each = [restart_fields(step.contacts[k]) for k in self.spectrum.places]
        stacked = {name: np.stack([fields[name] for fields in each]) for name in each[0]}
        return stacked | self._state_besides_fields(step)

    def record(self, step: Passage, recorder: Recorder) -> Record:
        """Return the record of a duty cycle, combined from the records of its blocks.

        It is combined from the records of the blocks (`results.record`).
        """
        spectrum = self.spectrum
        records = [
            self._record_contact(step, step.record(k), recorder, k)
            for k in range(len(self.model.blocks))
        ]
        values = step.record().values
        for seen in self._observers_of(step):
            columns, of_blocks = seen.record(self.model, {}), seen.record_block(0)
            values |= {name: columns[name] for name in columns if name not in of_blocks}
        del values["wear_max"]
        values["seconds"] = math.nan  # of the cycle, measured by its recording
        lost = np.stack((step.worn_parts, step.worn_parts + step.gained_by_block))[
            :, list(spectrum.places)
        ]
        lost *= _share_among_equal(spectrum)
        values[PARTS.name] = lost[0]
        sections = lost[1].sum(axis=(1, 2))
        values[SHARE.name] = sections / (sections.sum() or 1.0)
        values[ROLLED.name] = -1 if step.rolled is None else step.rolled
        each = [records[k] for k in spectrum.places]
        of_observers = [column for seen in self._observers_of(step) for column in seen.columns]
        user_columns = (*recorder.columns, *self.columns, *of_observers, PARTS, ROLLED, SHARE)
        record = cycle_record(each, spectrum.each, values, self.model.scene, user_columns)
        return record.with_fatigue(self._cycles(step))

    @classmethod
    def _restore_contacts(cls, scene: Scene, stored: StoredStep) -> tuple[State, ...]:
        """Return the contacts of a stored step, one for each different block."""
        spectrum = required(scene.spectrum, "duty")
        return tuple(
            stored.contact(scene, spectrum.places.index(k))
            for k, scene in enumerate(spectrum.scenes)
        )

    @classmethod
    def _restore_blocks(cls, scene: Scene, stored: StoredStep, blocks: int) -> dict:
        """Return stored wear by different block and body (`parts`), and `weights` of blocks.

        Equal blocks are combined.
        """
        parts = stored.history[PARTS.name][stored.row]
        spectrum = required(scene.spectrum, "duty")
        combined = np.zeros((blocks, *parts.shape[1:]))
        np.add.at(combined, list(spectrum.places), parts)
        restored = {"parts": combined, "weights": (1.0,) * blocks}
        rolled = int(stored.history[ROLLED.name][stored.row])
        if rolled >= 0:
            restored["weights"] = tuple(float(k == rolled) for k in range(blocks))
        return restored


def _share_among_equal(spectrum: Spectrum) -> np.ndarray:
    """Return the share of each block in the revolutions of all blocks equal to it."""
    each = zip(spectrum.each, spectrum.places, strict=True)
    share = [n / spectrum.revolutions[k] for n, k in each]
    return np.reshape(share, (-1, 1, 1))
