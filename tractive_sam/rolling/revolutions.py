"""Rolling through revolutions, under one load or through the blocks of a duty cycle."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from tractive_sam.contact import solve_blocks_on_fitted_mesh, with_heat
from tractive_sam.results import PARTS, ROLLED, SHARE, Record, State, cycle_record, restart_fields
from tractive_sam.rolling.adaptive import adaptive_passages
from tractive_sam.rolling.damage import Damage
from tractive_sam.rolling.passage import (
    Passage,
    ProfilePoint,
    complete_passage,
    first_passage,
    next_passage,
    start_passage,
)
from tractive_sam.rolling.process import Process, Recorder, StoredStep
from tractive_sam.scene import Scene, Spectrum
from tractive_sam.schema import required


class Revolutions(Process[Passage]):
    """Process of steady rolling: revolution by revolution with wear, or in adaptive jumps."""

    finite = ("approach", "Qx", "Qy", "Mz", "xi_x", "xi_y", "spin", "work_supplied", "residual")

    observers = (Damage,)

    def begin(self) -> Passage:
        """Return revolution zero: the steady contacts with the initial wear."""
        return first_passage(self.model)

    def begin_fitted(self) -> tuple["Revolutions", Passage]:
        """Solve all blocks on a fitted mesh; return the process on it, and revolution zero."""
        model, contacts = solve_blocks_on_fitted_mesh(self.model)
        return self._copy_with(model), start_passage(model, contacts)

    def advance(self, last: Passage) -> Iterator[Passage]:
        """Yield the revolutions after one, singly or in jumps, to the end or an unsolved one."""
        schedule, blocks = self.model.scene.schedule, self.model.blocks
        last = replace(last, contacts=tuple(map(with_heat, blocks, last.contacts)))
        if schedule.adaptive or schedule.fixed:
            yield from adaptive_passages(self, last, schedule)
            return
        while last.converged and last.revolution < schedule.end:
            last = next_passage(self.model, last)
            yield last

    @classmethod
    def expected_records(cls, scene: Scene, dx: float) -> int:
        """Return the (approximate) number of records for elements of the length dx, mm."""
        end = int(scene.schedule.end)
        if scene.schedule.fixed:
            return 1 + len(scene.schedule.stops)
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
