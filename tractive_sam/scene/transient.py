"""The [transient] table: what changes over the distance rolled, and how it is stepped through.

Courses are lists of values at the knots of the distance, linear between them; two equal knots are a
jump. They stand for keys of other tables, by their dotted names.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, Field

from tractive_sam.schema import Check, Fault, Positive, Real, Row, Table, ValidEntries, entry

from .gap import Gap


def _ascending(places: tuple[float, ...]) -> tuple[float, ...]:
    if any(late < early for early, late in pairwise(places)):
        raise ValueError("numbers that do not fall; two equal ones are a jump")
    if any(first == last for first, _, last in zip(places, places[1:], places[2:], strict=False)):
        raise ValueError("each number at most twice: two equal ones are a jump")
    return places


def rising(places: tuple[float, ...]) -> tuple[float, ...]:
    """Return places that ascend; raise a ValueError otherwise."""
    if any(late <= early for early, late in pairwise(places)):
        raise ValueError("ascending numbers")
    return places


NotBelowZero = Annotated[Real, Field(ge=0)]
Knots = Annotated[tuple[NotBelowZero, ...], AfterValidator(_ascending)]
Saved = Annotated[tuple[NotBelowZero, ...], AfterValidator(rising)]
Course = tuple[Real, ...]
PositiveCourse = tuple[Positive, ...]


def course(meaning: str, allowed: str = "a list of numbers, one for each knot") -> Any:
    """Define a field for a course."""
    return entry(meaning, allowed, None)


class LoadCourse(Table):
    """Courses of keys of [load].

    Examples
    --------
    >>> ts.LoadCourse(force_x=[0.0, 0.1]).force_x
    (0.0, 0.1)
    """

    normal: PositiveCourse | None = course(
        "normal load P, N or N/mm",
        "a list of numbers above 0, one for each knot; load.approach lets bodies part",
    )
    approach: Course | None = course(
        "approach of the bodies, mm, from the first touch of the unworn ones without travelling "
        "profiles; bodies without these are apart up to 0"
    )
    force_x: Course | None = course("prescribed tangential force Q_x on body A, N or N/mm")
    force_y: Course | None = course("prescribed tangential force Q_y on body A, N or N/mm")


class CreepageCourse(Table):
    """Courses of keys of [creepage]; of `start = "shift"` the shifts themselves.

    Examples
    --------
    >>> ts.CreepageCourse(longitudinal=[0.0, -0.003]).spin is None
    True
    """

    longitudinal: Course | None = course(
        'longitudinal creepage xi_x; of start = "shift" the shift of A over B in x, mm'
    )
    lateral: Course | None = course(
        'lateral creepage xi_y; of start = "shift" the shift of A over B in y, mm'
    )
    spin: Course | None = course(
        'spin creepage phi, 1/mm; of start = "shift" the turn of A over B, radians'
    )


class FrictionCourse(Table):
    """Courses of keys of [friction].

    Examples
    --------
    >>> ts.FrictionCourse(mu=[0.4, 0.1]).mu
    (0.4, 0.1)
    """

    mu: PositiveCourse | None = course(
        "friction coefficient mu1; mu2 changes in the same proportion",
        "a list of numbers above 0, one for each knot",
    )


class Profiles(Table):
    """Profiles that are fixed to a body and travel through the contact with it.

    As [gap]: what is added to the separation, so that a bump is negative. The place x of a profile
    is in the middle of the contact when the distance x has been rolled.

    Examples
    --------
    >>> bump = {"x": [-1, 0, 1], "y": [-9, 9], "separation": [[0, 0], [-1e-3, -1e-3], [0, 0]]}
    >>> ts.Profiles(A=bump).B is None
    True
    """

    A: Gap | None = entry("of the upper body", default=None)
    B: Gap | None = entry("of the lower body", default=None)

    @property
    def given(self) -> dict[str, Gap]:
        """Those that there are, by the names of their tables."""
        found = {f"transient.profile.{body}": getattr(self, body) for body in "AB"}
        return {table: one for table, one in found.items() if one is not None}


def _of_the_knots(entries: ValidEntries) -> Iterator[Fault]:
    knots = entries["distance"]
    if knots[0] == knots[-1]:
        yield Fault("distance", str(list(knots)), "knots that go on from the first one")
    for table, kind in (
        ("load", LoadCourse),
        ("creepage", CreepageCourse),
        ("friction", FrictionCourse),
    ):
        for key in kind.model_fields:
            values = entries.get(f"{table}.{key}")
            if values is not None and len(values) != len(knots):
                given = f"{len(values)} values and {len(knots)} knots"
                yield Fault(f"{table}.{key}", given, "one value for each knot of distance")


def _saved_on_the_way(entries: ValidEntries) -> Iterator[Fault]:
    knots, save = entries["distance"], entries["save"]
    if save and not knots[0] <= save[0] <= save[-1] <= knots[-1]:
        cure = f"distances from the first knot to the last, {knots[0]:g} to {knots[-1]:g}"
        yield Fault("save", str(list(save)), cure)


class Transient(Table):
    """What changes over the distance rolled.

    Quantities change linearly between the knots; what has no course stays as its own table says.
    With ``start = "shift"`` nothing rolls: the distance is a mere parameter, and creepages are the
    shifts of A over B since the bodies were pressed together.

    Examples
    --------
    >>> ts.Transient(distance=[0, 5], creepage={"longitudinal": [0, -0.003]}).start
    'rest'
    """

    distance: Knots = entry("knots, distance rolled, mm", "numbers that do not fall", min_length=2)
    load: LoadCourse = entry("courses of the load", default=LoadCourse())
    creepage: CreepageCourse = entry("courses of the creepages", default=CreepageCourse())
    friction: FrictionCourse = entry("courses of the friction", default=FrictionCourse())
    profile: Profiles = entry("profiles that travel through the contact", default=Profiles())
    start: Literal["rest", "steady", "shift"] = entry(
        "what the bodies did before: they were only pressed together, or they rolled steadily as "
        "the first knot says; or they are not to roll but to shift",
        '"rest", "steady" or "shift"',
        "rest",
    )
    step: Positive | None = entry(
        "longest step, mm; by default one element, of shifts a tenth of the way between two knots, "
        "and of adaptive steps a quarter of the contact",
        default=None,
    )
    stepping: Literal["even", "adaptive"] = entry(
        "whether steps are equally long but for the last one to a knot, or as long as their error "
        "allows",
        '"even" or "adaptive"',
        "even",
    )
    tolerance: Real = entry(
        "error of an adaptive step, relative: that of the tractions",
        "a number above 0, at most 0.1",
        1e-3,
        gt=0,
        le=0.1,
    )
    save: Saved = entry(
        "distances whose fields are stored, mm",
        "ascending numbers from the first knot to the last",
        default_factory=lambda given: tuple(sorted({*given["distance"]})),
    )
    checks: ClassVar[tuple[Check, ...]] = (_of_the_knots, _saved_on_the_way)

    @classmethod
    def unfold(cls, given: Mapping[Any, Any]) -> Mapping[Any, Any]:
        """Keys with a dot in them, as in ``"creepage.longitudinal"``, as tables."""
        tables: dict[Any, Any] = {}
        for key, value in given.items():
            table, dot, name = str(key).partition(".")
            if not dot:
                more = isinstance(value, Mapping) and isinstance(tables.get(key), dict)
                tables[key] = {**value, **tables[key]} if more else value
                continue
            inner = tables.get(table, {})
            if isinstance(inner, Table):
                inner = inner.entries()
            tables[table] = {**inner, name: value} if isinstance(inner, Mapping) else inner
        return tables

    def describe(self, scene: Any) -> Iterator[Row]:
        """See `Table.describe`."""
        start = {
            "rest": "the bodies pressed together, without traction",
            "steady": "steady rolling with the values of the first knot",
            "shift": "the bodies pressed together; they do not roll but shift, by the courses of "
            "[creepage] in mm and radians",
        }
        unit = "mm" if self.rolls else "of the parameter"
        longest = "one element" if self.rolls else "a tenth of a stretch"
        steps = f"of {longest if self.step is None else f'{self.step:g} {unit}'}, shorter to a knot"
        if self.stepping == "adaptive":
            steps = f"as long as the tractions are extrapolated to {self.tolerance:g}"
        yield Row("starts from", start[self.start])
        yield Row("distance", f"from {self.distance[0]:g} to {self.distance[-1]:g} {unit}")
        courses = ", ".join(self.courses) or "none: the values of the other tables remain"
        yield Row("courses", courses)
        yield Row("steps", f"{steps}; each from the two before")
        yield Row("fields stored at", ", ".join(f"{place:g}" for place in self.save))

    @property
    def rolls(self) -> bool:
        """Whether the bodies roll, or only shift."""
        return self.start != "shift"

    @property
    def jumps(self) -> list[tuple[float, str]]:
        """Knots at which loads, forces or friction jump, mm, and the keys that do."""
        found = []
        for k, (first, last) in enumerate(pairwise(self.distance)):
            keys = [
                key
                for key, values in self.courses.items()
                if values[k] != values[k + 1] and not key.startswith("creepage.")
            ]
            if first == last and keys:
                found.append((first, ", ".join(keys)))
        return found

    @property
    def courses(self) -> dict[str, tuple[float, ...]]:
        """The courses by the dotted keys they stand for."""
        tables = {"load": self.load, "creepage": self.creepage, "friction": self.friction}
        return {
            f"{name}.{key}": values
            for name, table in tables.items()
            for key, values in table.entries().items()
        }


def _transient_needs_friction(entries: ValidEntries) -> Iterator[Fault]:
    if entries["transient"] is not None and entries["friction"] is None:
        yield Fault("transient", "without friction", "only with a [friction] table")


def _transient_is_alone(entries: ValidEntries) -> Iterator[Fault]:
    if entries["transient"] is None:
        return
    if entries["accuracy"] is not None:
        cure = "a [grid] in place of it: the error bars are those of steady states"
        yield Fault("transient", "together with [accuracy]", cure)
    if entries["friction"] is not None and entries["friction.layer"]:
        given = f"{entries['friction.layer']:g}, together with [transient]"
        yield Fault("friction.layer", given, "no layer: that of a transient is not modelled")
    if entries["solver.method"] in ("uzawa", "anderson"):
        given = f'solver.method = "{entries["solver.method"]}"'
        yield Fault("solver.method", given, '"auto" or "newton" with [transient]')


def _sliding_has_a_speed(entries: ValidEntries) -> Iterator[Fault]:
    """Refuse shifts with friction that falls with the speed of sliding: they take no time."""
    transient, friction = entries["transient"], entries["friction"]
    if transient is None or friction is None or friction.share is None:
        return
    falls = f'together with friction.law = "{friction.law}"'
    why = "it depends on the speed of sliding, and a shift has none"
    if not transient.rolls:
        yield Fault("transient.start", f'"shift" {falls}', f'"rest" or "steady": {why}')
        return
    for place, keys in transient.jumps:
        cure = f"knots a short distance apart: {why}"
        yield Fault("transient.distance", f"a jump of {keys} at {place:g} mm {falls}", cure)
    for force in ("load.force_x", "load.force_y"):
        first = transient.courses.get(force, (entries[force],))[0]
        if transient.start == "rest" and first:
            key = f"transient.{force}" if force in transient.courses else force
            cure = f'0 at the first knot, or transient.start = "steady": {why}'
            yield Fault(key, f"{first:g} at the start from rest {falls}", cure)
    if friction.memory and friction.strength is not None:
        cure = "one of both: the strength hides what the memory of a transient continues from"
        yield Fault("friction.strength", "together with friction.memory and [transient]", cure)


OF_REVOLUTIONS = ("revolutions", "save", "stepping", "turns", "tolerance")
"""Keys of [wear] that a transient has no use for."""

LINEAR = ("archard", "energy")
"""Wear laws by which twice the slip wears twice as deep, whatever way is rolled."""


def _wears_over_the_distance(entries: ValidEntries) -> Iterator[Fault]:
    transient, wear = entries["transient"], entries["wear"]
    if wear is None:
        return
    if entries["process"] is not None:
        return
    if transient is None:
        if "wear.revolutions" not in entries.given:
            cure = (
                "how many, a whole number from 1; or a [transient], which wears over its distance"
            )
            yield Fault("wear.revolutions", "nothing", cure)
        return
    for key in OF_REVOLUTIONS:
        if f"wear.{key}" in entries.given:
            cure = "nothing: it wears over the distance of the courses"
            yield Fault(f"wear.{key}", "together with [transient]", cure)
    laws = set() if wear.named_law else set(wear.laws.values())
    for law in sorted({law for law in laws if law and law not in LINEAR}):
        if not transient.rolls:
            cure = "archard or energy: others go by the distance rolled, and shifts have none"
        elif law == "brr" or (law != "jendel" and wear.by == "contact"):
            cure = "a law of each element: T-gamma of the whole contact tells steady rolling only"
        else:
            continue
        yield Fault("wear.law", f"{law} together with [transient]", cure)
    radii = (abs(entries[f"body.{name}.radius_x"]) for name in "AB")
    turn, way = 2.0 * math.pi * min(radii), transient.distance[-1] - transient.distance[0]
    if transient.rolls and way > turn:
        cure = f"at most {turn:.5g} mm: a body that has turned would meet what it has worn"
        yield Fault("transient.distance", f"{way:g} mm together with [wear]", cure)


def _courses_of_what_is_asked(entries: ValidEntries) -> Iterator[Fault]:
    if entries["transient"] is None:
        return
    for key in ("normal", "approach"):
        if entries[f"transient.load.{key}"] is not None and entries[f"load.{key}"] is None:
            cure = f"load.{key} itself as well: it tells the mesh and the units"
            yield Fault(f"transient.load.{key}", f"a course, and no load.{key}", cure)
    for force, creepage in (("force_x", "longitudinal"), ("force_y", "lateral")):
        forced = [k for k in (f"load.{force}", f"transient.load.{force}") if entries[k] is not None]
        crept = f"transient.creepage.{creepage}"
        if forced and entries[crept] is not None:
            yield Fault(crept, f"together with {forced[-1]}", "one of both: a force or a creepage")
        if f"transient.load.{force}" in forced and f"creepage.{creepage}" in entries.given:
            given = f"together with transient.load.{force}"
            yield Fault(f"creepage.{creepage}", given, "one of both: a force or a creepage")


def _steps_within_the_contact(entries: ValidEntries) -> Iterator[Fault]:
    transient, hertz = entries["transient"], entries["body"].hertz(entries["load"])
    if transient is None or not transient.rolls or transient.step is None or hertz is None:
        return
    most = 2.0 * hertz.a
    if entries["gap"] is None and transient.step > most and math.isfinite(most):
        cure = f"at most {most:.4g} mm: in a longer step all material leaves the contact"
        yield Fault("transient.step", f"{transient.step:g}", cure)


TRANSIENT_CHECKS: tuple[Check, ...] = (
    _transient_needs_friction,
    _transient_is_alone,
    _sliding_has_a_speed,
    _wears_over_the_distance,
    _courses_of_what_is_asked,
    _steps_within_the_contact,
)
"""Checks between [transient] and the other tables."""
