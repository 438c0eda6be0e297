"""The [transient] table: changes over the rolling distance, in one stage or several.

See `stage` for courses.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from itertools import pairwise
from typing import Any, ClassVar, Literal

from tractive_sam.schema import Check, Fault, InnerTable, Row, ValidEntries, entry, optional

from .schedule import (
    CourseTable,
    Distance,
    Knots,
    NotBelowZero,
    Profiles,
    Saved,
    Schedule,
    Shifts,
    Stage,
    check_courses,
)


def _check_stages(entries: ValidEntries) -> Iterator[Fault]:
    """Report faulty knots and courses, keys that belong to stages, and stages that do not join."""
    stages = entries["stage"]
    if not stages:
        if "distance" not in entries.given:
            yield Fault("distance", "nothing", "a list of knots, mm, or [[transient.stage]]")
        else:
            yield from check_courses(entries)
        return
    for key in CourseTable.model_fields:
        if key in entries.given:
            yield Fault(key, "with [[transient.stage]]", "nothing: each stage has its own")
    if entries["start"] == "shift":
        cure = '"rest" or "steady"; a stage shifts with motion = "shift"'
        yield Fault("start", '"shift" with [[transient.stage]]', cure)
    for k, (before, after) in enumerate(pairwise(stages)):
        if before.distance[-1] != after.distance[0]:
            cure = f"a first knot at the end of the stage before, {before.distance[-1]:g}"
            yield Fault(f"stage[{k + 1}].distance", str(list(after.distance)), cure)


def _knots(entries: ValidEntries) -> tuple[float, ...]:
    """Return the knots of all stages in one tuple."""
    stages = entries["stage"]
    return tuple(s for stage in stages for s in stage.distance) or entries["distance"]


def _check_save(entries: ValidEntries) -> Iterator[Fault]:
    """Report distances to be stored that lie outside the knots."""
    knots, save = _knots(entries), entries["save"]
    if save and knots and not knots[0] <= save[0] <= save[-1] <= knots[-1]:
        cure = f"distances from the first knot to the last, {knots[0]:g} to {knots[-1]:g}"
        yield Fault("save", str(list(save)), cure)


def _check_cycle_start(entries: ValidEntries) -> Iterator[Fault]:
    """Report a start of the load cycle (cycle_start) outside the knots."""
    knots, start = _knots(entries), entries["cycle_start"]
    if start is not None and knots and not knots[0] <= start < knots[-1]:
        cure = f"a distance from {knots[0]:g} to below {knots[-1]:g}, within the knots"
        yield Fault("cycle_start", f"{start:g}", cure)


class Transient(CourseTable):
    """Table [transient]: courses of load, creepage and friction over distance, or stages.

    Values change linearly between the knots; a key without a course has the value of its table.
    With ``start = "shift"``, the bodies do not roll: the distance is a parameter, and the creepages
    are the shifts of A relative to B since the bodies were pressed together. ``stage`` is a list of
    tables in place of the courses: the bodies roll or shift in each stage, one after another.

    Examples
    --------
    >>> ts.Transient(distance=[0, 5], creepage={"longitudinal": [0, -0.003]}).start
    'rest'
    """

    distance: Knots = entry(
        "knots: rolling distances, mm",
        "a list of two or more ascending numbers; two equal numbers are a jump",
        (),
        min_length=2,
    )
    stage: tuple[Stage, ...] = entry(
        "stages in their order, in place of distance and courses",
        "at least one stage, [[transient.stage]]",
        (),
        min_length=1,
    )
    profile: InnerTable[Profiles] = entry(
        "profiles that move through the contact", default=Profiles()
    )
    start: Literal["rest", "steady", "shift"] = entry(
        "state before the first knot: pressed together without rolling (rest), or rolling "
        "steadily (steady); with shift, the bodies are displaced without rolling",
        default="rest",
    )
    save: Saved = entry(
        "distances at which fields are stored, mm",
        "a list of ascending numbers from the first knot to the last",
        default_factory=lambda entries: tuple(
            sorted({*entries["distance"], *(s for k in entries["stage"] for s in k.distance)})
        ),
    )
    cycle_start: NotBelowZero | None = optional(
        "distance at which the stress history of [fatigue] begins, mm, for example the start of "
        "the last cycle; the default is the first knot",
        "a number from the first knot to below the last",
    )
    checks: ClassVar[tuple[Check, ...]] = (_check_stages, _check_save, _check_cycle_start)

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield report rows: start; distance, courses and steps of each stage; stored places."""
        start = {
            "rest": "bodies pressed together, without traction",
            "steady": "steady rolling with the values of the first knot",
            "shift": "bodies pressed together; they do not roll but shift, by the courses of "
            "[creepage] in mm and radians",
        }
        if self.stage and self.start == "steady" and not self.stage[0].rolls:
            start["steady"] = "steady rolling with the values of [load], [creepage] and [friction]"
        yield Row("starts from", start[self.start])
        if not self.stage:
            yield from self.stages[0].describe(scene)
        for k, stage in enumerate(self.stage):
            motion = "rolls" if stage.rolls else "shifts"
            text = "; ".join(f"{row.label} {row.text}" for row in stage.describe(scene))
            yield Row(f"stage {k}", f"{motion}; {text}")
        yield Row("fields stored at", ", ".join(f"{place:g}" for place in self.save))

    @cached_property
    def stages(self) -> tuple[Stage, ...]:
        """Stages of the transient; without [[transient.stage]], one with the table's entries."""
        if self.stage:
            return self.stage
        motion: Literal["rolling", "shift"] = "shift" if self.start == "shift" else "rolling"
        entries = {key: getattr(self, key) for key in CourseTable.model_fields}
        return (Stage(motion=motion, **entries),)

    @property
    def by_key(self) -> dict[str, Stage]:
        """Stages by the dotted keys of their tables in a scene."""
        keys = [f"transient.stage[{k}]" for k in range(len(self.stage))] or ["transient"]
        return dict(zip(keys, self.stages, strict=True))

    @property
    def schedule(self) -> Schedule:
        """Schedule of the transient: its end, distances to store, and courses."""
        courses: dict[str, tuple[float, ...]] = {}
        keys: dict[str, str] = {}
        for table, stage in self.by_key.items():
            for key, values in stage.courses.items():
                courses[key] = (*courses.get(key, ()), *values)
                keys.setdefault(key, f"{table}.{key}")
        return (Distance if self.rolls else Shifts)(
            self.knots[-1],
            self.save,
            courses=courses,
            course_keys=keys,
            profiles=self.profile.by_table,
            own_load=any(stage.has_own_load for stage in self.stages),
            shifting=tuple((s.distance[0], s.distance[-1]) for s in self.stages if not s.rolls),
        )

    @property
    def knots(self) -> tuple[float, ...]:
        """Knots of all stages in one tuple, mm."""
        return tuple(place for stage in self.stages for place in stage.distance)

    @property
    def rolls(self) -> bool:
        """Whether the bodies roll in a stage; otherwise they only shift."""
        return any(stage.rolls for stage in self.stages)

    @property
    def shift_keys(self) -> tuple[str, ...]:
        """Dotted keys of the entries due to which bodies shift; empty if they roll throughout."""
        if not self.stage:
            return ("transient.start",) if self.start == "shift" else ()
        return tuple(f"{key}.motion" for key, stage in self.by_key.items() if not stage.rolls)

    @property
    def only_rolls(self) -> bool:
        """Whether the bodies roll in every stage."""
        return all(stage.rolls for stage in self.stages)

    @property
    def is_mixed(self) -> bool:
        """Whether the bodies roll in some stages and shift in others."""
        return self.rolls and not self.only_rolls

    def jumps(self, constant: Mapping[str, Any]) -> list[tuple[str, float, str]]:
        """Return the jumps of loads, forces or friction: key of the knots, position (mm), keys.

        Parameters
        ----------
        constant : mapping of str to float or None
            Loads, forces and friction without courses (`CourseTable.values_at`).

        Returns
        -------
        list of (str, float, str)
            Dotted key of the knots, place, mm, and the keys that jump.
        """
        knots = [
            (f"{key}.distance", stage.distance[k], stage.values_at(k, constant))
            for key, stage in self.by_key.items()
            for k in stage.knot_range
        ]
        jumps = []
        for (_, first, before), (key, last, after) in pairwise(knots):
            changed = [
                name
                for name, value in after.items()
                if value not in (None, before[name]) and not name.startswith("creepage.")
            ]
            if first == last and changed:
                jumps.append((key, first, ", ".join(changed)))
        return jumps
