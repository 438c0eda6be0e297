"""Stages of a [transient]: rolling or shifting, each with its courses and steps.

A course is a list of values of a key at the knots of the distance, linear between them. Two equal
knots are a jump.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, Literal

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
    optional,
)

from .courses import CreepageCourse, FrictionCourse, Knots, LoadCourse


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
