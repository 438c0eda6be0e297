"""The schedule of a scene, courses of keys over its coordinate, and stages of a [transient].

A scene without [wear] is a single contact. [wear] is rolled revolution by revolution, and a
[transient] step by step over a distance, or over a parameter if the bodies only shift.

A course is a list of values of a key at the knots of the distance, linear between them. Two equal
knots are a jump.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field

from tractive_sam.schema import (
    Check,
    Fault,
    InnerTable,
    Positive,
    Real,
    Row,
    Table,
    ValidEntries,
    entry,
    number_to_tuple,
    optional,
)

from .gap import Gap


def _check_knots(places: tuple[float, ...]) -> tuple[float, ...]:
    """Return knots unchanged; raise a ValueError if they descend, or if three are equal."""
    if any(late < early for early, late in pairwise(places)):
        raise ValueError("a list of ascending numbers; two equal numbers are a jump")
    if any(first == last for first, _, last in zip(places, places[1:], places[2:], strict=False)):
        raise ValueError("each number at most twice: two equal numbers are a jump")
    return places


def check_ascending(places: tuple[float, ...]) -> tuple[float, ...]:
    """Return numbers unchanged; raise a ValueError unless they ascend."""
    if any(late <= early for early, late in pairwise(places)):
        raise ValueError("a list of ascending numbers, each once")
    return places


NotBelowZero = Annotated[Real, Field(ge=0)]
Knots = Annotated[tuple[NotBelowZero, ...], AfterValidator(_check_knots)]
Saved = Annotated[tuple[NotBelowZero, ...], AfterValidator(check_ascending)]
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
        scene = scene.replace(transient=None, wear=None)
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
