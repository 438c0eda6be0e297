"""Schedules of a scene: courses, the [transient] and its stages, named processes and observers.

A scene without [wear] is a single contact. [wear] is rolled revolution by revolution, and a
[transient] step by step over a distance, or over a parameter if the bodies only shift.

A course is a list of values of a key at the knots of the distance, linear between them. Two equal
knots are a jump.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import AfterValidator, BeforeValidator

from tractive_sam.schema import (
    Check,
    Fault,
    InnerTable,
    LawTable,
    NamedLaw,
    NotNegative,
    Positive,
    Real,
    Row,
    Table,
    ValidEntries,
    ascending,
    describe_law_names,
    entry,
    number_to_tuple,
    optional,
)

from .inputs import Gap


def _check_knots(places: tuple[float, ...]) -> tuple[float, ...]:
    """Return knots unchanged; raise a ValueError if they descend, or if three are equal."""
    if any(late < early for early, late in pairwise(places)):
        raise ValueError("a list of ascending numbers; two equal numbers are a jump")
    if any(first == last for first, _, last in zip(places, places[1:], places[2:], strict=False)):
        raise ValueError("each number at most twice: two equal numbers are a jump")
    return places


REVOLUTION_KEYS = tuple(
    f"wear.{key}" for key in ("revolutions", "save", "stepping", "turns", "tolerance")
)
"""Keys of [wear] that only apply to revolutions."""

Knots = Annotated[tuple[NotNegative, ...], AfterValidator(_check_knots)]
Saved = Annotated[tuple[NotNegative, ...], ascending("a list of ascending numbers, each once")]
Course = Annotated[tuple[Real, ...], BeforeValidator(number_to_tuple)]
PositiveCourse = Annotated[tuple[Positive, ...], BeforeValidator(number_to_tuple)]


def course(meaning: str, allowed: str = "a number, or a list of numbers, one for each knot") -> Any:
    """Return the definition of a field for a course: one number for each knot."""
    return entry(meaning, allowed, None)


class LoadCourse(Table):
    """Courses over the rolling distance of the keys of [load], in a [transient].

    Examples
    --------
    >>> ts.LoadCourse(force_x=[0.0, 0.1]).force_x
    (0.0, 0.1)
    """

    normal: PositiveCourse | None = course(
        "normal load P, N or N/mm",
        "a number above 0, or a list of them, one for each knot; for separated bodies use "
        "load.approach",
    )
    approach: Course | None = course(
        "approach of the bodies, mm, from the first touch of the unworn bodies without moving "
        "profiles; at values up to 0, bodies without profiles are separated"
    )
    force_x: Course | None = course("prescribed tangential force Q_x on body A, N or N/mm")
    force_y: Course | None = course("prescribed tangential force Q_y on body A, N or N/mm")


class CreepageCourse(Table):
    """Courses over the rolling distance of the keys of [creepage], or of shifts.

    Examples
    --------
    >>> ts.CreepageCourse(longitudinal=[0.0, -0.003]).spin is None
    True
    """

    shifts: ClassVar[Mapping[str, str]] = {
        "longitudinal": "the shift of A relative to B in x, mm",
        "lateral": "the shift of A relative to B in y, mm",
        "spin": "the rotation of A relative to B, radians",
    }
    """Meaning of each course in a shift."""

    longitudinal: Course | None = course(
        f"longitudinal creepage xi_x; in a shift, {shifts['longitudinal']}"
    )
    lateral: Course | None = course(f"lateral creepage xi_y; in a shift, {shifts['lateral']}")
    spin: Course | None = course(f"spin creepage phi, 1/mm; in a shift, {shifts['spin']}")


class FrictionCourse(Table):
    """Courses over the rolling distance of the keys of [friction], in a [transient].

    Examples
    --------
    >>> ts.FrictionCourse(mu=[0.4, 0.1]).mu
    (0.4, 0.1)
    """

    mu: PositiveCourse | None = course(
        "friction coefficient mu1; mu2 changes in proportion",
        "a number above 0, or a list of them, one for each knot",
    )


class Profiles(Table):
    """Height profiles that are fixed to the bodies and move through the contact with them.

    As in [gap], a profile adds to the separation: a bump is negative. The point x of the profile is
    at the centre of the contact at the rolling distance x.

    Examples
    --------
    >>> bump = {"x": [-1, 0, 1], "y": [-9, 9], "separation": [[0, 0], [-1e-3, -1e-3], [0, 0]]}
    >>> ts.Profiles(A=bump).B is None
    True
    """

    A: InnerTable[Gap | None] = optional("profile of the upper body")
    B: InnerTable[Gap | None] = optional("profile of the lower body")

    @property
    def by_table(self) -> dict[str, Gap]:
        """Moving profiles of the bodies that have one, by the names of their tables."""
        profiles = {f"transient.profile.{body}": getattr(self, body) for body in "AB"}
        return {table: profile for table, profile in profiles.items() if profile is not None}


@dataclass(frozen=True)
class Schedule:
    """Base class of schedules, and schedule of one contact: coordinate, end, stored values.

    Attributes
    ----------
    end : float
        Last value of the coordinate.
    save : tuple of float
        Values of the coordinate at which fields are stored.
    adaptive : bool
        Whether a jump over many revolutions is as long as its error allows.
    fixed : bool
        Whether each jump leads to the next value of `save`.
    courses : mapping of str to tuple of float
        Values at the knots, by the dotted key that changes.
    course_keys : mapping of str to str
        Dotted key of the first course of each of these keys.
    profiles : mapping of str to Gap
        Profiles that are fixed to the bodies and move with them, by the names of their tables.
    own_load : bool
        Whether the load of [load] applies, at least in a stage of a transient.
    shifting : tuple of (float, float)
        First and last value of the coordinate of each stage in which the bodies shift.
    """

    end: float = 0
    save: tuple[float, ...] = (0,)
    adaptive: bool = False
    fixed: bool = False
    courses: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    course_keys: Mapping[str, str] = field(default_factory=dict)
    profiles: Mapping[str, Gap] = field(default_factory=dict)
    own_load: bool = True
    shifting: tuple[tuple[float, float], ...] = ()

    save_key: ClassVar[str] = "wear.save"
    """Key of the scene that lists `save`."""
    end_key: ClassVar[str] = "wear.revolutions"
    """Key of the scene that gives `end`."""
    ends_there: ClassVar[bool] = True
    """Whether the last record is at `end`; otherwise `end` is an upper bound."""
    revolves: ClassVar[bool] = True
    """Whether every record is steady rolling, after a number of revolutions."""
    rolls: ClassVar[bool] = True
    """Whether material rolls through the contact."""
    in_sequence: ClassVar[bool] = True
    """Whether each record follows from the one before."""
    shifts: ClassVar[bool] = False
    """Whether the bodies only shift over each other."""
    message_start: ClassVar[str] = ""
    """Beginning of a message about a record, with its place; empty of the only one."""

    def __contains__(self, place: float) -> bool:
        """Return whether fields are stored at a value of the coordinate."""
        return place in self.save

    @property
    def stops(self) -> tuple[float, ...]:
        """Values of the coordinate at which a step must end, ascending."""
        return tuple(sorted({*self.save, self.end}))

    def rolled(self, places: Any) -> Any:
        """Return the distance rolled, mm, up to values of the coordinate: without the shifts.

        It is the coordinate without the parts in which the bodies shift.
        """
        shifted = (np.clip(places, first, last) - first for first, last in self.shifting)
        return places - sum(shifted)

    def shifts_at(self, place: float) -> bool:
        """Return whether the bodies shift in the step that ends at a value of the coordinate."""
        return self.shifts or any(first < place <= last for first, last in self.shifting)

    def under_largest_load(self, scene: Any) -> Any:
        """Return the scene under its largest load, which sets the mesh: the scene itself."""
        return scene

    @property
    def largest_loads(self) -> dict[str, float]:
        """Largest normal load and approach of the courses, by key, if they are above zero."""
        loads = {
            key: max(self.courses.get(key, (0.0,))) for key in ("load.normal", "load.approach")
        }
        return {key: load for key, load in loads.items() if load > 0.0}


class RevolutionSchedule(Schedule):
    """Schedule of a scene with [wear], over revolutions."""

    message_start = "revolution {}: "


class Distance(Schedule):
    """Schedule of a [transient] that rolls, over the distance in mm."""

    save_key, end_key = "transient.save", "transient.distance"
    revolves = False
    message_start = "after {:g} mm: "

    def under_largest_load(self, scene: Any) -> Any:
        """Return the steady scene, without wear, under the largest load of its courses."""
        at_rest = scene.body.relaxes and scene.creepage.speed is None
        slow = {"creepage.speed": 1e-9} if at_rest else {}  # the bodies have relaxed
        scene = scene.replace(transient=None, wear=None, **slow)
        candidates = [scene.replace(**{key: load}) for key, load in self.largest_loads.items()]
        if self.own_load or not candidates:
            candidates.append(scene)
        if len(candidates) == 1:
            return candidates[0]
        return max(candidates, key=lambda case: 0.0 if case.hertz is None else case.hertz.load)


class Shifts(Distance):
    """Schedule of a [transient] without rolling, over the parameter of the shifts."""

    rolls, shifts = False, True
    message_start = "after {:g} of the parameter: "

    def rolled(self, places: Any) -> Any:
        """Return zero for each value of the coordinate: the bodies do not roll."""
        return 0.0 * places


class PatchSchedule(Schedule):
    """Schedule over the patches of a wheel on a rail, by increasing load."""

    save_key = end_key = "wheelset"
    revolves = ends_there = in_sequence = False
    message_start = "patch {:g}: "


class NamedSchedule(Schedule):
    """Schedule of a user-defined process, over its coordinate."""

    save_key, end_key = "process.save", "process.end"
    revolves = False
    message_start = "at {:g}: "


def check_courses(entries: ValidEntries) -> Iterator[Fault]:
    """Report courses without one value or one for each knot, and knots that span no distance."""
    knots = entries["distance"]
    if knots[0] == knots[-1]:
        yield Fault("distance", str(list(knots)), "a last knot above the first one")
    for table, kind in (
        ("load", LoadCourse),
        ("creepage", CreepageCourse),
        ("friction", FrictionCourse),
    ):
        for key in kind.model_fields:
            values = entries.get(f"{table}.{key}")
            if values is not None and len(values) not in (1, len(knots)):
                value = f"{len(values)} values and {len(knots)} knots"
                cure = "one value for each knot of distance, or a single one"
                yield Fault(f"{table}.{key}", value, cure)


class CourseTable(Table):
    """Base class of [transient] and its stages: knots, courses of keys at the knots, and steps."""

    distance: Knots = entry(
        "knots: rolling distances, mm",
        "a list of two or more ascending numbers; two equal numbers are a jump",
        min_length=2,
    )
    load: InnerTable[LoadCourse] = entry("courses of the load", default=LoadCourse())
    creepage: InnerTable[CreepageCourse] = entry(
        "courses of the creepages", default=CreepageCourse()
    )
    friction: InnerTable[FrictionCourse] = entry(
        "courses of the friction", default=FrictionCourse()
    )
    step: Positive | None = optional(
        "longest step, mm; the default is one element, a tenth of the distance between two "
        "knots for shifts, or a quarter of the contact length for adaptive steps"
    )
    stepping: Literal["even", "adaptive"] = entry(
        "steps of equal length, except before a knot (even), or steps as long as their error "
        "allows (adaptive)",
        default="even",
    )
    tolerance: Real = entry(
        "relative error of the tractions in an adaptive step", default=1e-3, gt=0, le=0.1
    )
    duration: Positive | None = optional(
        "time of a shift from its first knot to the last, s, in which bodies relax; by default it "
        "takes no time",
    )
    forced: ClassVar[tuple[tuple[str, str], ...]] = (
        ("force_x", "longitudinal"),
        ("force_y", "lateral"),
    )
    """Forces, and the creepages that they replace."""

    @classmethod
    def unfold(cls, entries: Mapping[Any, Any]) -> Mapping[Any, Any]:
        """Return entries with dotted keys, as ``"creepage.longitudinal"``, as nested tables."""
        tables: dict[Any, Any] = {}
        for key, value in entries.items():
            table, dot, name = str(key).partition(".")
            if not dot:
                merge = isinstance(value, Mapping) and isinstance(tables.get(key), dict)
                tables[key] = {**value, **tables[key]} if merge else value
                continue
            inner = tables.get(table, {})
            if isinstance(inner, Table):
                inner = inner.entries()
            tables[table] = {**inner, name: value} if isinstance(inner, Mapping) else inner
        return tables

    @property
    def courses(self) -> dict[str, tuple[float, ...]]:
        """Values at the knots of each course, by the dotted key that the course sets."""
        tables = {"load": self.load, "creepage": self.creepage, "friction": self.friction}
        return {
            f"{name}.{key}": values if len(values) > 1 else values * len(self.distance)
            for name, table in tables.items()
            for key, values in table.entries().items()
        }

    @property
    def knot_range(self) -> range:
        """Indices of the knots."""
        return range(len(self.distance))

    @property
    def has_own_load(self) -> bool:
        """Whether normal load and approach have no course, so that [load] gives them."""
        return self.load.normal is None and self.load.approach is None

    def values_at(self, knot: int, constant: Mapping[str, Any]) -> dict[str, Any]:
        """Return the prescribed quantities at a knot, by dotted key; None: not prescribed.

        Parameters
        ----------
        knot : int
            Index of the knot.
        constant : mapping of str to float or None
            The quantities without courses. The course of a load or approach, and the course of a
            force or creepage, replace the other one.
        """
        courses, values = self.courses, dict(constant)
        if not self.has_own_load:
            values |= {"load.normal": None, "load.approach": None}
        for force, creepage in self.forced:
            if f"creepage.{creepage}" in courses:
                values[f"load.{force}"] = None
        return values | {key: course[knot] for key, course in courses.items()}


class Stage(CourseTable):
    """Stage of a [transient], in which the bodies roll or shift.

    Each stage begins with the contact at the end of the stage before. Its first knot is the last
    knot of that stage. A key without a course has the value of its table. A stage may prescribe a
    creepage where the scene or another stage prescribes the force, and an approach in place of a
    load. Loads and forces that differ from those at the end of the stage before take a shift.

    With ``motion = "shift"``, the bodies do not roll: the distance is a parameter, and the
    creepages are the shifts of A relative to B in the stage, or, if the stage before prescribes the
    same shift, since that one began. Without a course there is no shift.

    Examples
    --------
    >>> press = ts.Stage(motion="shift", distance=[0, 1], load={"force_x": [0.0, 0.1]})
    >>> roll = ts.Stage(distance=[1, 5], creepage={"longitudinal": -0.001})
    >>> ts.Transient(stage=[press, roll]).schedule.end
    5.0
    """

    motion: Literal["rolling", "shift"] = entry(
        "motion of the bodies: they roll (rolling), or they are displaced without rolling (shift)",
        default="rolling",
    )
    checks: ClassVar[tuple[Check, ...]] = (check_courses,)

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield report rows: distance, courses of load and motion, and steps of the stage."""
        unit = "mm" if self.rolls else "of the parameter"
        longest = "one element" if self.rolls else "a tenth of the distance between two knots"
        length = longest if self.step is None else f"{self.step:g} {unit}"
        steps = f"of {length}, shorter before a knot"
        if self.stepping == "adaptive":
            steps = (
                f"as long as the error of the extrapolated tractions is below {self.tolerance:g}"
            )
        yield Row("distance", f"from {self.distance[0]:g} to {self.distance[-1]:g} {unit}")
        courses = ", ".join(self.courses) or "none: the values of the other tables hold"
        yield Row("courses", courses)
        yield Row("steps", f"{steps}; each step starts from the two before")

    @property
    def rolls(self) -> bool:
        """Whether the bodies roll in the stage; otherwise they shift without rolling."""
        return self.motion == "rolling"


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
    cycle_start: NotNegative | None = optional(
        "distance at which the stress history of [fatigue] begins, mm, for example the start of "
        "the last cycle; the default is the first knot",
        "a number from the first knot to below the last",
    )
    excludes: ClassVar[dict[str, str]] = {
        **dict.fromkeys(REVOLUTION_KEYS, "the wear accumulates over transient.distance"),
        **dict.fromkeys(
            ("friction.temperature", "wear.temperature"),
            "in a transient the laws do not depend on the temperature",
        ),
        "wear.layer_step": "in a transient layers stay",
        "friction.layer": "an interfacial layer is not modelled in a transient",
        "fatigue.volume": "a volume is stressed evenly only in steady rolling",
        "load.moment": "a transient finds no tilt: give load.tilt",
        "duty": "blocks are steady rolling",
        "accuracy": "error bars hold for steady states only: give a [grid]",
    }
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


def _check_process_save(entries: ValidEntries) -> Iterator[Fault]:
    """Report `save` of [process] if it has values beyond `end`, the last one of its coordinate."""
    save, end = entries["save"], entries["end"]
    if save and save[-1] > end:
        yield Fault("save", str(list(save)), f"values of the coordinate up to end, {end:g}")


class ProcessTable(LawTable):
    """Name, parameters and end of a process, a class that determines the sequence of contacts.

    The name is a subclass of `Process` in an installed package, or an entry point of this package
    in the group "tractive_sam.laws". Further keys are parameters of the class.

    Examples
    --------
    >>> ts.ProcessTable(name="my_package:IndexingDrive", end=10, passes=5).save
    (0.0, 10.0)
    """

    name: NamedLaw = entry("process", describe_law_names(()))
    end: Real = entry("last value of the coordinate of the process", ge=0)
    save: Annotated[tuple[Real, ...], ascending("a list of ascending numbers, each once")] = entry(
        "values of the coordinate at which fields are stored",
        "a list of ascending numbers up to end",
        default_factory=lambda entries: tuple(sorted({0.0, entries["end"]})),
    )
    law_key: ClassVar[str] = "name"
    excludes: ClassVar[dict[str, str]] = {
        **dict.fromkeys(("transient", "duty", "accuracy"), "the process gives the contacts"),
        **dict.fromkeys(REVOLUTION_KEYS, "the process wears up to process.end"),
        "wear.layer_step": "in a process layers stay",
    }
    checks: ClassVar[tuple[Check, ...]] = (_check_process_save,)

    @property
    def schedule(self) -> Schedule:
        """Schedule of the named process: end and values of its coordinate to store."""
        return NamedSchedule(self.end, self.save)

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield report rows: name of the process, its end and the places of stored fields."""
        yield Row("name", str(self.name))
        yield Row(
            "end",
            f"{self.end:g}; fields stored at {', '.join(f'{place:g}' for place in self.save)}",
        )


class ObserverTable(LawTable):
    """Name and parameters of an observer, a class that computes further quantities of records.

    The name is a subclass of `Observer` in an installed package, or an entry point of this package
    in the group "tractive_sam.laws". Further keys are parameters of the class.

    Examples
    --------
    >>> ts.ObserverTable(name="my_package:FrictionEnergy", threshold=0.5).name.parameters
    {'threshold': 0.5}
    """

    name: NamedLaw = entry("observer", describe_law_names(()))
    law_key: ClassVar[str] = "name"

    @classmethod
    def describe_array(cls, observers: Sequence[Any], scene: Any) -> Iterator[Row]:
        """Yield a row with the name of each observer, for reports of a scene."""
        for observer in observers:
            yield Row("observer", str(observer.name))
