"""Rolling through revolutions or load blocks, and jumps with a controlled error over many.

The profile with which material enters obeys E(n + 1) = E(n) + R(E(n)), with R the lasting part of
the wear of a pass. Over many revolutions that is stiff: short waves of the profile decay within
tens of them, which limits every explicit jump to 40-75 on the paper's mesh, while the profile
evolves over thousands. At the rim, rows of elements come into contact one after the other, and no
formula that extrapolates the rate holds across that.

A jump therefore integrates a model of the rows, each with a load or an open gap
(`passage.RowContact`), by a stiff method in a few steps that need no contact. What the rate of the
solved contacts misses in the model is smooth; it is a polynomial through the last of them. One
contact is solved at the profile that this predicts. Its model, with what it misses in the contacts
before, then gives the profile from which the next jump starts, and the difference of the two the
error.

A sum is not an integral. For the profile halfway through a revolution, F = E + R/2, it nearly is:
by Euler and Maclaurin, F(m) - F(n) = integral of R dn + (R'(m) - R'(n))/12, and the last term is
small against the error of any jump longer than one revolution. A jump of one is the pass, which
needs no formula.
"""

import math
from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from math import ceil, inf, sqrt
from typing import ClassVar

import numpy as np

from tractive_sam.contact import Model, solve_on_fitted_mesh, with_heat
from tractive_sam.results import PARTS, ROLLED, SHARE, Record, State, cycle_record, restart_fields
from tractive_sam.rolling.observers import Damage
from tractive_sam.rolling.passage import (
    Passage,
    ProfilePoint,
    RowContact,
    attribute_wear,
    complete_passage,
    depth_of_pass,
    first_passage,
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

ALLOWED, POWER = 28.0, 1.3
"""Correction of a profile that a tolerance allows, over its depth: ALLOWED tolerance^POWER.

Errors of the jumps in which rows come into contact add up, and a strict tolerance takes more jumps.
With these values the error of the last profile of `twin-discs` is below the tolerance
(benchmarks/wear.py), and that of each profile below three times the tolerance."""

SUBSTEPS, IMPLICIT = 4, 1.0 - sqrt(0.5)
"""Largest number of steps of the rows within a jump, and least revolutions of one; diagonal of the
two-stage method of second order that damps the shortest waves (Alexander 1977, SIAM J. Numer. Anal.
14, 1006-1021)."""

SETTLING, SETTLED = 0.7, 0.3
"""Longest jump over the distance to the next revolution that is saved, and the final jump, over the
time in which the shortest waves decay.

Rows of elements come into contact at the rim one after the other, and the pressure there rises and
falls with each. Long jumps give the right profile, but not the right moment of each contact."""


def adaptive_passages(
    process: Process[Passage], start: Passage, schedule: Schedule
) -> Iterator[Passage]:
    """Yield the passages in adaptive or fixed jumps, up to the last or an unsolved one.

    Each jump costs one contact; more if it is refused and repeated, or if the mesh has grown.

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
    rows = _RowModel(model, last, last.course[-1], last.jump)
    each = zip(last.weights, rows.responses, strict=True)
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
        if step.length < rows.jump:
            rows = _RowModel(model, last, last.course[-1], int(step.length))
        end, error = jump_on(model, last, int(step.length), rows)
        solves += end.solves
        end = attribute_wear(last, end)
        if control.accepts(error) or step.length == 1:
            end = process.observe(replace(end, responses=rows.responses), last)
            error = max([error, *(observer.missed(model) for observer in end.observed.values())])
        is_outgrown = end.is_outgrown and not model.scene.has_fixed_domain
        if control.accepts(error) or step.length == 1 or is_outgrown:
            if not end.observed:  # the contact has left the mesh
                end = process.observe(end, last)
            return replace(end, solves=solves, jump=int(control.next(step, error)))
        step = control.shorter(step, error)


class _RowModel:
    """Wear rate of all blocks of a passage by their rows, and the profile that it gives.

    Parameters
    ----------
    model : Model
        The scene in numbers.
    passage : Passage
        The passage whose contacts the rows are from.
    point : ProfilePoint
        Its profile, and the rate at this profile.
    jump : int
        Revolutions in which further rows may come into contact.
    """

    def __init__(self, model: Model, passage: Passage, point: ProfilePoint, jump: int = 0) -> None:
        self.jump = jump
        self._point, self._weights = point, passage.weights
        grown = _growth(point.rate, passage)
        # While the rows in contact wear down, the bodies approach each other at the next rows.
        closing = jump * float(passage.gained.max())
        each = zip(model.blocks, passage.turns, passage.contacts, strict=True)
        self._blocks = [
            RowContact(
                block,
                contact,
                turns.gain,
                point.profile,
                grown * turns.gain * depth_of_pass(contact),
                closing,
            )
            for block, turns, contact in each
        ]
        self._inverses = dict[tuple[bytes, float], np.ndarray]()
        self._touching = [block.touching for block in self._blocks]

    @property
    def responses(self) -> list[np.ndarray]:
        """Response of the wear of each block to the profile, (n_y, n_y), 1/revolution."""
        return [block.linear(block.touching)[0] for block in self._blocks]

    def _rate(self, known: np.ndarray, share: float, missed: np.ndarray | float) -> np.ndarray:
        """Return the rate R of the profile known + share R, plus `missed` in rows in contact."""
        changes = 30  # of the rows in contact; each solves a linear system
        for _ in range(changes):
            each = zip(self._weights, self._blocks, self._touching, strict=True)
            parts = [(weight, block.linear(touching)) for weight, block, touching in each]
            response = np.sum([weight * part[0] for weight, part in parts], axis=0)
            rate = np.sum([weight * part[1] for weight, part in parts], axis=0)
            rows = np.flatnonzero(rate)
            key = b"".join(touching.tobytes() for touching in self._touching), share
            if key not in self._inverses:
                system = np.eye(rows.size) - share * response[np.ix_(rows, rows)]
                self._inverses[key] = np.linalg.inv(system)
            source = rate + response @ known + missed
            rate = np.zeros_like(rate)
            rate[rows] = self._inverses[key] @ source[rows]
            profile = known + share * rate
            pairs = zip(self._blocks, self._touching, strict=True)
            updated = [block.update(touching, profile) for block, touching in pairs]
            if all(map(np.array_equal, updated, self._touching)):
                break
            self._touching = updated
        return np.maximum(rate, 0.0)

    def _missed(self, points: Sequence[ProfilePoint]) -> Callable[[float], np.ndarray | float]:
        """Return what the rate of the rows misses, a polynomial through points of the course."""
        others = [point for point in points if point.revolution != self._point.revolution]
        places = [self._point.revolution, *(point.revolution for point in others)]
        values = []
        for point in others:
            self._touching = [point.rate[block.rows] > 0.0 for block in self._blocks]
            smooth = (point.rate > 0.0) & (self._point.rate > 0.0)
            missed = point.rate - self._rate(point.profile, 0.0, 0.0)
            values.append(np.where(smooth, missed, 0.0))

        def interpolate(revolution: float) -> np.ndarray | float:
            total: np.ndarray | float = 0.0
            for place, value in zip(places[1:], values, strict=True):
                factors = [(revolution - at) / (place - at) for at in places if at != place]
                total = total + math.prod(factors) * value
            return total

        return interpolate

    def follow(self, course: Sequence[ProfilePoint], start: int, end: int) -> ProfilePoint:
        """Return the profile and rate at the revolution `end` from those at the point `start`.

        The points of the course are those at which a contact was solved.
        """
        missed, here = self._missed(course), course[start]
        jump = end - here.revolution
        count = max(1, min(SUBSTEPS, jump // SUBSTEPS))
        length, stage = jump / count, IMPLICIT * jump / count
        self._touching = [here.rate[block.rows] > 0.0 for block in self._blocks]
        halfway = here.halfway
        for k in range(count):
            at = here.revolution + k * length
            rate = self._rate(halfway, stage - 0.5, missed(at + stage))
            known = halfway + (length - stage) * rate
            rate = self._rate(known, stage - 0.5, missed(at + length))
            halfway = known + stage * rate
        return ProfilePoint(end, np.maximum(halfway - 0.5 * rate, here.profile), rate)


def jump_on(model: Model, last: Passage, jump: int, rows: _RowModel) -> tuple[Passage, float]:
    """Return the passage after a jump of revolutions, and its error over the tolerance."""
    revolution, here = last.revolution + jump, last.course[-1]
    course = last.course
    if jump > LONGEST_GROWTH * (here.revolution - course[0].revolution):
        course = course[-1:]  # nearer points do not show the course of the rate over the jump
    expected, end = rows.follow(course, -1, revolution), last
    tolerance = required(model.scene.wear, "wear").tolerance
    # Tolerance of the contact conditions for wear within one pass.
    lag, solves = max(tolerance, model.scene.solver.tolerance), 0
    # Tolerated correction of the profile, over its depth. No tolerance allows more than 0.02: from
    # further away one Newton step does not reach the profile, and longer jumps cost more contacts
    # than they save.
    allowed = min(ALLOWED * tolerance**POWER, 0.02)
    # Rows of a mesh that has just grown have unknown gaps: the first contact predicts the second.
    for _ in range(1 if np.isfinite(last.contact.gap).all() else 2):
        # A jump of one revolution is the pass; unworn bodies do not wear in their contact.
        profile = here.profile + here.rate if jump == 1 else expected.profile
        grown = _growth(expected.rate, end)
        end = passage_at(model, revolution, profile, end.contacts, lag, grown)
        solves += end.solves
        if not end.converged or not last.revolution:
            return replace(end, solves=solves), np.inf
        point = ProfilePoint(revolution, profile, end.gained)
        reached = _RowModel(model, end, point).follow((*course, point), -2, revolution)
        correction = np.abs(reached.profile - expected.profile).max()
        error = float(correction / max(profile.max(), 1e-300) / allowed)
        expected = reached
    end = replace(end, solves=solves)
    return replace(end, course=(here, point if jump == 1 else reached)), error


def _growth(expected: np.ndarray, last: Passage) -> np.ndarray:
    """Return the expected wear rate of each row over its last rate; 0 for rows without wear."""
    wears = last.gained > 0.0
    return np.divide(expected, last.gained, out=np.zeros_like(expected), where=wears)


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

    growth: ClassVar[float] = 0.5
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
        # longer they are; slightly with the tolerance. From 50 to 15,000 revolutions of discs of
        # several materials, loads and laws, runs have .6 to 1.8 times as many records.
        tolerance = required(scene.wear, "wear").tolerance
        jumps = 1 + 0.45 * np.log1p(end) ** 2 * max(1.0, (1e-3 / tolerance) ** 0.4)
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
        # Equal blocks are solved as one: each has its share of their revolutions.
        places = zip(spectrum.each, spectrum.places, strict=True)
        lost *= np.reshape([n / spectrum.revolutions[k] for n, k in places], (-1, 1, 1))
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
