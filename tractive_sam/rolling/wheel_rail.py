"""The patches of a wheel on a rail, one record each."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Self

from tractive_sam.contact import Model, solve_patches_on_fitted_mesh
from tractive_sam.rail import Patch
from tractive_sam.results import COORDINATE, Grid, Quantity, State
from tractive_sam.rolling.damage import Damage
from tractive_sam.rolling.passage import start_passage
from tractive_sam.rolling.process import Process, Step, StepRecord, StoredStep
from tractive_sam.scene import Scene

WHEEL_COLUMNS = (
    Quantity("contact_y", "mm", "lateral position of the patch on the rail, outward", label="y"),
    Quantity(
        "contact_angle",
        "degrees",
        "angle between the tangent plane of the patch and the horizontal",
    ),
    Quantity("angle_range", "degrees", "range of the contact angle over the patch"),
    Quantity("rolling_radius", "mm", "rolling radius of the wheel at the patch"),
    Quantity("pitch", "1", "ratio of the angular velocity of the wheelset to V / radius, minus 1"),
    Quantity("patches", "1", "number of patches of the wheel that carry load", format="d"),
)
"""Columns of a patch of a wheel."""


def describe_patch(patch: Patch, contact: State, patches: int) -> dict[str, Any]:
    """Return the values of `WHEEL_COLUMNS`, by name, of a solved wheel-rail patch."""
    rows, scene = contact.grid.y[contact.touching.any(axis=0)], contact.scene
    follows = scene.wheel_rail.is_motion(scene.creepage)
    return {
        "contact_y": float(patch.origin[1]),
        "contact_angle": math.degrees(patch.angle),
        "angle_range": math.degrees(patch.angle_range_over(rows)) if rows.size else math.nan,
        "rolling_radius": patch.rolling_radius,
        "pitch": patch.pitch_at(contact.xi_x) if follows else math.nan,
        "patches": patches,
    }


@dataclass(frozen=True, eq=False)
class PatchStep(Step):
    """Step of `WheelRailPatches`: one solved contact patch of a wheel on a rail.

    Attributes
    ----------
    patch : Patch
        Geometry of the patch.
    number : int
        Its place among the patches by increasing load, from 1.
    patches : int
        Number of patches.
    """

    patch: Patch | None = None
    number: int = 1
    patches: int = 1

    @property
    def place(self) -> float:
        """Number of the patch by increasing load, from 1: the coordinate of its record."""
        return self.number

    def on(self, grid: Grid) -> Self:
        """Return the step on a wider mesh of equal elements (`Step.on`)."""
        return replace(self, contacts=tuple(contact.on(grid) for contact in self.contacts))

    def record(self, block: int | None = None) -> StepRecord:
        """Return the contact of the patch, with its number and geometry, for its record."""
        assert self.patch is not None
        values = {"patch": self.number, "jump": 1, "solves": 1}
        values |= describe_patch(self.patch, self.contact, self.patches)
        return StepRecord(self.contact, values)


@dataclass(frozen=True, eq=False)
class PatchDamage(Damage):
    """Observer of the fatigue of wheel and rail, separately for each patch.

    Patches load different material, so that no damage adds up from one record to the next.
    """

    def begin(self, passage: Step, model: Model) -> Self:
        """Return the observer after the pass of a patch, which begins undamaged."""
        return super().begin(start_passage(model, passage.contacts), model)

    def after(self, passage: Step, model: Model) -> Self:
        """Return the observer after another patch, without the damage of previous patches."""
        return self.begin(passage, model)

    def restore(self, passage: Step, stored: StoredStep) -> Self:
        """Return an observer without damage: later patches do not depend on it."""
        return self


class WheelRailPatches(Process[PatchStep]):
    """Process that solves all contact patches of a wheel on a rail, which share its load."""

    columns = (
        Quantity(
            "patch", "1", "patches by increasing load", format="d", whole=True, role=COORDINATE
        ),
        *WHEEL_COLUMNS,
    )
    observers = (PatchDamage,)
    first_applications = 240.0  # each trial of the load of a patch is a contact

    def begin(self) -> PatchStep:
        """Return the first step: the solved patch with the least load."""
        return self.begin_fitted()[1]

    def begin_fitted(self) -> tuple[Self, PatchStep]:
        """Solve all patches on a fitted mesh; return the process on it, and its first step."""
        model, steps = solve_patch_steps(self.model)
        process = self._copy_with(model)
        process.solved = steps
        return process, steps[0]

    solved: tuple[PatchStep, ...] = ()

    def advance(self, last: PatchStep) -> Iterator[PatchStep]:
        """Yield the solved patches with more load than the patch `last`."""
        steps = self.solved or solve_patch_steps(self.model)[1]
        yield from (step for step in steps if step.number > last.number and last.converged)

    @classmethod
    def restore(cls, scene: Scene, stored: StoredStep) -> PatchStep:
        """Return the step of a stored record: number and contact, without the patch geometry."""
        number = int(stored.history["patch"][stored.row])
        return PatchStep((stored.contact(scene),), number=number)

    @classmethod
    def expected_records(cls, scene: Scene, dx: float) -> int:
        """Return the number of contact patches: each patch is a record."""
        return len(scene.wheel_rail.patches)


def solve_patch_steps(model: Model) -> tuple[Model, tuple[PatchStep, ...]]:
    """Return (model, touching patches by load) on a fitted mesh; only the unsolved one, if any."""
    model, contacts = solve_patches_on_fitted_mesh(model)
    pairs = [*zip(contacts, model.scene.wheel_rail.patches, strict=True)]
    touching = [pair for pair in pairs if pair[0].touching.any()] or pairs[:1]
    ordered: list[tuple[State, Patch]] = sorted(touching, key=lambda pair: pair[0].P)
    failed = next((contact for contact in contacts if not contact.converged), None)
    if failed is not None:  # the history ends with it
        ordered = [(failed, ordered[0][1])]
    return model, tuple(
        PatchStep((contact,), patch=patch, number=k + 1, patches=len(ordered))
        for k, (contact, patch) in enumerate(ordered)
    )
