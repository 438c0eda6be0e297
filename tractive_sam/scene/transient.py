"""The [transient] table: changes over the rolling distance, and the steps.

A course is a list of values of a key at the knots of the distance, linear between them. Two equal
knots are a jump.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, Field

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

from .gap import Gap
from .schedule import Distance, Schedule, Shifts
from .wear_laws import BY_COEFFICIENT


def _check_knots(places: tuple[float, ...]) -> tuple[float, ...]:
    """Return the knots; raise a ValueError if they descend, or if three are equal."""
    if any(late < early for early, late in pairwise(places)):
        raise ValueError("ascending numbers; two equal numbers are a jump")
    if any(first == last for first, _, last in zip(places, places[1:], places[2:], strict=False)):
        raise ValueError("each number at most twice: two equal numbers are a jump")
    return places


def check_ascending(places: tuple[float, ...]) -> tuple[float, ...]:
    """Return the numbers; raise a ValueError unless they ascend."""
    if any(late <= early for early, late in pairwise(places)):
        raise ValueError("ascending numbers")
    return places


NotBelowZero = Annotated[Real, Field(ge=0)]
Knots = Annotated[tuple[NotBelowZero, ...], AfterValidator(_check_knots)]
Saved = Annotated[tuple[NotBelowZero, ...], AfterValidator(check_ascending)]
Course = tuple[Real, ...]
PositiveCourse = tuple[Positive, ...]


def course(meaning: str, allowed: str = "a list of numbers, one for each knot") -> Any:
    """Define the field of a course."""
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
        "a list of numbers above 0, one for each knot; for separated bodies use load.approach",
    )
    approach: Course | None = course(
        "approach of the bodies, mm, from the first touch of the unworn bodies without moving "
        "profiles; at values up to 0, bodies without profiles are separated"
    )
    force_x: Course | None = course("prescribed tangential force Q_x on body A, N or N/mm")
    force_y: Course | None = course("prescribed tangential force Q_y on body A, N or N/mm")


class CreepageCourse(Table):
    """Courses of keys of [creepage]; with `start = "shift"`, courses of the shifts.

    Examples
    --------
    >>> ts.CreepageCourse(longitudinal=[0.0, -0.003]).spin is None
    True
    """

    shifts: ClassVar[Mapping[str, str]] = {
        "longitudinal": "the shift of A over B in x, mm",
        "lateral": "the shift of A over B in y, mm",
        "spin": "the rotation of A over B, radians",
    }
    """Meaning of each course with `start = "shift"`."""

    longitudinal: Course | None = course(
        f'longitudinal creepage xi_x; with start = "shift", {shifts["longitudinal"]}'
    )
    lateral: Course | None = course(
        f'lateral creepage xi_y; with start = "shift", {shifts["lateral"]}'
    )
    spin: Course | None = course(f'spin creepage phi, 1/mm; with start = "shift", {shifts["spin"]}')


class FrictionCourse(Table):
    """Courses of keys of [friction].

    Examples
    --------
    >>> ts.FrictionCourse(mu=[0.4, 0.1]).mu
    (0.4, 0.1)
    """

    mu: PositiveCourse | None = course(
        "friction coefficient mu1; mu2 changes by the same factor",
        "a list of numbers above 0, one for each knot",
    )


class Profiles(Table):
    """Profiles that are fixed to a body and move through the contact with it.

    As in [gap], a profile adds to the separation: a bump is negative. The point x of the profile is
    at the centre of the contact at the rolling distance x.

    Examples
    --------
    >>> bump = {"x": [-1, 0, 1], "y": [-9, 9], "separation": [[0, 0], [-1e-3, -1e-3], [0, 0]]}
    >>> ts.Profiles(A=bump).B is None
    True
    """

    A: InnerTable[Gap | None] = entry("profile of the upper body", default=None)
    B: InnerTable[Gap | None] = entry("profile of the lower body", default=None)

    @property
    def given(self) -> dict[str, Gap]:
        """The given profiles, by the names of their tables."""
        profiles = {f"transient.profile.{body}": getattr(self, body) for body in "AB"}
        return {table: profile for table, profile in profiles.items() if profile is not None}


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
                given = f"{len(values)} values and {len(knots)} knots"
                yield Fault(f"{table}.{key}", given, "one value for each knot of distance")


def _check_save(entries: ValidEntries) -> Iterator[Fault]:
    """Report stored distances outside the knots."""
    knots, save = entries["distance"], entries["save"]
    if save and not knots[0] <= save[0] <= save[-1] <= knots[-1]:
        cure = f"distances from the first knot to the last, {knots[0]:g} to {knots[-1]:g}"
        yield Fault("save", str(list(save)), cure)


def _check_cycle_start(entries: ValidEntries) -> Iterator[Fault]:
    """Report a stress history that does not begin within the knots."""
    knots, start = entries["distance"], entries["cycle_start"]
    if start is not None and not knots[0] <= start < knots[-1]:
        cure = f"a distance from {knots[0]:g} to below {knots[-1]:g}, within the knots"
        yield Fault("cycle_start", f"{start:g}", cure)


class Transient(Table):
    """Courses of load, creepage and friction over the rolling distance, and the steps.

    Values change linearly between the knots; keys without a course keep their values. With
    ``start = "shift"`` the bodies do not roll: the distance is a parameter, and creepages are the
    shifts of A over B since the bodies were pressed together.

    Examples
    --------
    >>> ts.Transient(distance=[0, 5], creepage={"longitudinal": [0, -0.003]}).start
    'rest'
    """

    distance: Knots = entry(
        "knots: rolling distances, mm",
        "ascending numbers; two equal numbers are a jump",
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
        "distances whose fields are stored, mm",
        "ascending numbers from the first knot to the last",
        default_factory=lambda given: tuple(sorted({*given["distance"]})),
    )
    cycle_start: NotBelowZero | None = entry(
        "distance at which the stress history of [fatigue] begins, mm, for example the start of "
        "the last cycle; the default is the first knot",
        "a number from the first knot to below the last",
        default=None,
    )
    checks: ClassVar[tuple[Check, ...]] = (_check_courses, _check_save, _check_cycle_start)

    @classmethod
    def unfold(cls, given: Mapping[Any, Any]) -> Mapping[Any, Any]:
        """Return keys with a dot, such as ``"creepage.longitudinal"``, as tables."""
        tables: dict[Any, Any] = {}
        for key, value in given.items():
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
        """See `Table.describe`."""
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
        """Schedule of the courses."""
        kind = Distance if self.rolls else Shifts
        profiles = self.profile.given
        return kind(self.distance[-1], self.save, courses=self.courses, profiles=profiles)

    @property
    def rolls(self) -> bool:
        """Whether the bodies roll; otherwise they shift."""
        return self.start != "shift"

    @property
    def jumps(self) -> list[tuple[float, str]]:
        """Knots at which loads, forces or friction jump, mm, with the keys that jump."""
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
        """The courses, by the dotted keys whose values they give."""
        tables = {"load": self.load, "creepage": self.creepage, "friction": self.friction}
        return {
            f"{name}.{key}": values
            for name, table in tables.items()
            for key, values in table.entries().items()
        }


def _check_transient_has_friction(entries: ValidEntries) -> Iterator[Fault]:
    """Report a transient without friction."""
    if entries["transient"] is not None and entries["friction"] is None:
        yield Fault("transient", "without friction", "a [friction] table, which a transient needs")


def _check_transient_excludes(entries: ValidEntries) -> Iterator[Fault]:
    """Report tables and keys that [transient] excludes."""
    if entries["transient"] is None:
        return
    if entries["accuracy"] is not None:
        cure = "a [grid] in place of [accuracy], whose error bars hold for steady states only"
        yield Fault("transient", "together with [accuracy]", cure)
    if entries["friction"] is not None and entries["friction.layer"]:
        given = f"{entries['friction.layer']:g}, with [transient]"
        yield Fault(
            "friction.layer", given, "0: an interfacial layer is not modelled in a transient"
        )
    if entries["solver.method"] in ("uzawa", "anderson"):
        given = f'solver.method = "{entries["solver.method"]}"'
        yield Fault("solver.method", given, '"auto" or "newton" with [transient]')


def _check_sliding_speed_exists(entries: ValidEntries) -> Iterator[Fault]:
    """Report falling friction at shifts, jumps and loads at rest, which have no sliding speed."""
    transient, friction = entries["transient"], entries["friction"]
    if transient is None or friction is None or friction.share is None:
        return
    falls = f'with friction.law = "{friction.law}"'
    why = "the law depends on the sliding speed, and a shift or a jump has no speed"
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
        cure = "nothing: a transient with friction.memory cannot have a strength"
        yield Fault("friction.strength", "with friction.memory and [transient]", cure)


REVOLUTION_KEYS = ("revolutions", "save", "stepping", "turns", "tolerance")
"""Keys of [wear] that only apply to revolutions."""


def _check_wear_of_transient(entries: ValidEntries) -> Iterator[Fault]:
    """Report keys and laws of [wear] that do not fit a transient, and missing revolutions."""
    transient, wear = entries["transient"], entries["wear"]
    if wear is None:
        return
    if entries["process"] is not None:
        return
    if transient is None:
        if "wear.revolutions" not in entries.given:
            cure = "a whole number from 1, or a [transient] with a distance over which it wears"
            yield Fault("wear.revolutions", "nothing", cure)
        return
    for key in REVOLUTION_KEYS:
        if f"wear.{key}" in entries.given:
            cure = "nothing: the wear accumulates over transient.distance"
            yield Fault(f"wear.{key}", "with [transient]", cure)
    laws = set() if wear.named_law else set(wear.laws.values())
    for law in sorted(law for law in laws if law and law not in BY_COEFFICIENT):
        if not transient.rolls:
            cure = (
                "archard or energy: other laws depend on the rolling distance, and shifts have none"
            )
        elif law == "brr" or (law != "jendel" and wear.by == "contact"):
            cure = 'a law with by = "element": T-gamma of the contact holds for steady rolling only'
        else:
            continue
        yield Fault("wear.law", f"{law} with [transient]", cure)
    radii = (abs(entries[f"body.{name}.radius_x"]) for name in "AB")
    turn = 2.0 * math.pi * min(radii)
    distance = transient.distance[-1] - transient.distance[0]
    if transient.rolls and distance > turn:
        cure = f"at most {turn:.5g} mm, one turn: after it worn material returns to the contact"
        yield Fault("transient.distance", f"{distance:g} mm with [wear]", cure)


def _check_keys_of_courses(entries: ValidEntries) -> Iterator[Fault]:
    """Report courses of loads without the key itself, and of a creepage with its force."""
    if entries["transient"] is None:
        return
    for key in ("normal", "approach"):
        if entries[f"transient.load.{key}"] is not None and entries[f"load.{key}"] is None:
            cure = f"load.{key} as well: the mesh and the units follow from it"
            yield Fault(f"transient.load.{key}", f"a course, and no load.{key}", cure)
    for force, creepage in (("force_x", "longitudinal"), ("force_y", "lateral")):
        forced = [k for k in (f"load.{force}", f"transient.load.{force}") if entries[k] is not None]
        crept = f"transient.creepage.{creepage}"
        if forced and entries[crept] is not None:
            yield Fault(crept, f"with {forced[-1]}", "a force or a creepage, not both")
        if f"transient.load.{force}" in forced and f"creepage.{creepage}" in entries.given:
            given = f"with transient.load.{force}"
            yield Fault(f"creepage.{creepage}", given, "a force or a creepage, not both")


def _check_step_length(entries: ValidEntries) -> Iterator[Fault]:
    """Report steps longer than the contact."""
    transient, hertz = entries["transient"], entries["body"].hertz(entries["load"])
    if transient is None or not transient.rolls or transient.step is None or hertz is None:
        return
    length = 2.0 * hertz.a
    if entries["gap"] is None and transient.step > length and math.isfinite(length):
        cure = f"at most {length:.4g} mm: in a longer step all material leaves the contact"
        yield Fault("transient.step", f"{transient.step:g}", cure)


TRANSIENT_CHECKS: tuple[Check, ...] = (
    _check_transient_has_friction,
    _check_transient_excludes,
    _check_sliding_speed_exists,
    _check_wear_of_transient,
    _check_keys_of_courses,
    _check_step_length,
)
"""Checks between [transient] and the other tables."""
