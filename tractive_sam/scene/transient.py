"""The [transient] table: changes over the rolling distance, and the steps.

A course is a list of values of a key at the knots of the distance, linear between them. Two equal
knots are a jump.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
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
)

from .courses import (
    CreepageCourse,
    FrictionCourse,
    Knots,
    LoadCourse,
    NotBelowZero,
    Profiles,
    Saved,
)
from .schedule import Distance, Schedule, Shifts


def _check_courses(entries: ValidEntries) -> Iterator[Fault]:
    """Report courses with another number of values than knots, and a distance of 0."""
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
            if values is not None and len(values) != len(knots):
                value = f"{len(values)} values and {len(knots)} knots"
                yield Fault(f"{table}.{key}", value, "one value for each knot of distance")


def _check_save(entries: ValidEntries) -> Iterator[Fault]:
    """Report distances to be stored that lie outside the knots."""
    knots, save = entries["distance"], entries["save"]
    if save and not knots[0] <= save[0] <= save[-1] <= knots[-1]:
        cure = f"distances from the first knot to the last, {knots[0]:g} to {knots[-1]:g}"
        yield Fault("save", str(list(save)), cure)


def _check_cycle_start(entries: ValidEntries) -> Iterator[Fault]:
    """Report a start of the load cycle (cycle_start) outside the knots."""
    knots, start = entries["distance"], entries["cycle_start"]
    if start is not None and not knots[0] <= start < knots[-1]:
        cure = f"a distance from {knots[0]:g} to below {knots[-1]:g}, within the knots"
        yield Fault("cycle_start", f"{start:g}", cure)


class Transient(Table):
    """Courses of load, creepage and friction over distance, and steps.

    Values change linearly between the knots; a key without a course has the value of its table.
    With ``start = "shift"``, the bodies do not roll: the distance is a parameter, and the creepages
    are the shifts of A relative to B since the bodies were pressed together.

    Examples
    --------
    >>> ts.Transient(distance=[0, 5], creepage={"longitudinal": [0, -0.003]}).start
    'rest'
    """

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
    profile: InnerTable[Profiles] = entry(
        "profiles that move through the contact", default=Profiles()
    )
    start: Literal["rest", "steady", "shift"] = entry(
        "state before the first knot: pressed together without rolling (rest), or rolling "
        "steadily (steady); with shift, the bodies are displaced without rolling",
        default="rest",
    )
    step: Positive | None = entry(
        "longest step, mm; the default is one element, a tenth of the distance between two "
        "knots for shifts, or a quarter of the contact length for adaptive steps",
        default=None,
    )
    stepping: Literal["even", "adaptive"] = entry(
        "steps of equal length, except before a knot (even), or steps as long as their error "
        "allows (adaptive)",
        default="even",
    )
    tolerance: Real = entry(
        "relative error of the tractions in an adaptive step",
        default=1e-3,
        gt=0,
        le=0.1,
    )
    save: Saved = entry(
        "distances at which fields are stored, mm",
        "a list of ascending numbers from the first knot to the last",
        default_factory=lambda entries: tuple(sorted({*entries["distance"]})),
    )
    cycle_start: NotBelowZero | None = entry(
        "distance at which the stress history of [fatigue] begins, mm, for example the start of "
        "the last cycle; the default is the first knot",
        "a number from the first knot to below the last",
        default=None,
    )
    checks: ClassVar[tuple[Check, ...]] = (_check_courses, _check_save, _check_cycle_start)

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

    def describe(self, scene: Any) -> Iterator[Row]:
        """Return the rows (label, text) that describe the table in reports of a scene."""
        start = {
            "rest": "bodies pressed together, without traction",
            "steady": "steady rolling with the values of the first knot",
            "shift": "bodies pressed together; they do not roll but shift, by the courses of "
            "[creepage] in mm and radians",
        }
        unit = "mm" if self.rolls else "of the parameter"
        longest = "one element" if self.rolls else "a tenth of the distance between two knots"
        length = longest if self.step is None else f"{self.step:g} {unit}"
        steps = f"of {length}, shorter before a knot"
        if self.stepping == "adaptive":
            steps = (
                f"as long as the error of the extrapolated tractions is below {self.tolerance:g}"
            )
        yield Row("starts from", start[self.start])
        yield Row("distance", f"from {self.distance[0]:g} to {self.distance[-1]:g} {unit}")
        courses = ", ".join(self.courses) or "none: the values of the other tables hold"
        yield Row("courses", courses)
        yield Row("steps", f"{steps}; each step starts from the two before")
        yield Row("fields stored at", ", ".join(f"{place:g}" for place in self.save))

    @property
    def schedule(self) -> Schedule:
        """Schedule of the transient: its end, distances to store, and courses."""
        kind = Distance if self.rolls else Shifts
        profiles = self.profile.by_table
        return kind(self.distance[-1], self.save, courses=self.courses, profiles=profiles)

    @property
    def rolls(self) -> bool:
        """Whether the bodies roll; otherwise they are shifted without rolling."""
        return self.start != "shift"

    @property
    def jumps(self) -> list[tuple[float, str]]:
        """(Distance in mm, keys) of each knot at which loads, forces or friction jump."""
        jumps = []
        for k, (first, last) in enumerate(pairwise(self.distance)):
            keys = [
                key
                for key, values in self.courses.items()
                if values[k] != values[k + 1] and not key.startswith("creepage.")
            ]
            if first == last and keys:
                jumps.append((first, ", ".join(keys)))
        return jumps

    @property
    def courses(self) -> dict[str, tuple[float, ...]]:
        """Values of each course at the knots, by the dotted key that the course sets."""
        tables = {"load": self.load, "creepage": self.creepage, "friction": self.friction}
        return {
            f"{name}.{key}": values
            for name, table in tables.items()
            for key, values in table.entries().items()
        }
