"""Checks between [transient] and the other tables of a scene."""

import math
from collections.abc import Iterator

from tractive_sam.schema import Check, Fault, ValidEntries

from .force_checks import constant_quantities
from .stage import Stage
from .wear_laws import BY_COEFFICIENT


def _check_tables_of_transient(entries: ValidEntries) -> Iterator[Fault]:
    """Report a missing [friction] table, and tables and keys that [transient] excludes."""
    if entries["transient"] is None:
        return
    friction = entries["friction"]
    if friction is None:
        yield Fault("transient", "without friction", "a [friction] table, which a transient needs")
    elif friction.share is not None and friction.memory and friction.strength is not None:
        cure = "nothing: a transient with friction.memory cannot have a strength"
        yield Fault("friction.strength", "with friction.memory and [transient]", cure)
    if entries["accuracy"] is not None:
        cure = "a [grid] in place of [accuracy]: error bars hold for steady states only"
        yield Fault("transient", "together with [accuracy]", cure)
    if friction is not None and friction.layer:
        value = f"{friction.layer:g}, with [transient]"
        yield Fault(
            "friction.layer", value, "0: an interfacial layer is not modelled in a transient"
        )
    if entries["solver.method"] in ("uzawa", "anderson"):
        value = f'solver.method = "{entries["solver.method"]}"'
        yield Fault("solver.method", value, '"auto" or "newton" with [transient]')


def _check_sliding_speed_exists(entries: ValidEntries) -> Iterator[Fault]:
    """Report falling friction with shifts, jumps or forces at the start from rest."""
    transient, friction = entries["transient"], entries["friction"]
    if transient is None or friction is None or friction.share is None:
        return
    falls = f'with friction.law = "{friction.law}"'
    why = "the law depends on the sliding speed, and a shift or a jump has no speed"
    if transient.shift_keys:
        for key in transient.shift_keys:
            yield Fault(key, f'"shift" {falls}', f"stages that roll: {why}")
        return
    constant, courses = constant_quantities(entries), transient.stages[0].courses
    for key, place, changed in transient.jumps(constant):
        cure = f"knots a short distance apart: {why}"
        yield Fault(key, f"a jump of {changed} at {place:g} mm {falls}", cure)
    for force in ("load.force_x", "load.force_y"):
        first = transient.stages[0].values_at(0, constant)[force]
        if transient.start == "rest" and first:
            key = transient.schedule.course_keys[force] if force in courses else force
            cure = f'0 at the first knot, or transient.start = "steady": {why}'
            yield Fault(key, f"{first:g} at the start from rest {falls}", cure)


REVOLUTION_KEYS = ("revolutions", "save", "stepping", "turns", "tolerance")
"""Keys of [wear] that only apply to revolutions."""


def _check_wear_of_transient(entries: ValidEntries) -> Iterator[Fault]:
    """Report entries of [wear] that a transient excludes, or without it the missing revolutions."""
    transient, wear = entries["transient"], entries["wear"]
    if wear is None or entries["process"] is not None:
        return
    if transient is None:
        if "wear.revolutions" not in entries.given:
            cure = "an integer from 1, or a [transient] with a distance over which it wears"
            yield Fault("wear.revolutions", "nothing", cure)
        return
    for key in REVOLUTION_KEYS:
        if f"wear.{key}" in entries.given:
            cure = "nothing: the wear accumulates over transient.distance"
            yield Fault(f"wear.{key}", "with [transient]", cure)
    laws = set() if wear.named_law else set(wear.laws.values())
    for law in sorted(law for law in laws if law and law not in BY_COEFFICIENT):
        if transient.shift_keys:
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
    first, last = transient.knots[0], transient.knots[-1]
    distance = transient.schedule.rolled(last) - transient.schedule.rolled(first)
    if distance > turn:
        cure = f"at most {turn:.5g} mm, one turn: after it worn material returns to the contact"
        key = f"{[*transient.by_key][-1]}.distance"
        yield Fault(key, f"{distance:g} mm with [wear]", cure)


def _check_keys_of_courses(entries: ValidEntries) -> Iterator[Fault]:
    """Report load courses without their key in [load], and creepages prescribed with a force."""
    transient, either = entries["transient"], "a force or a creepage, not both"
    if transient is None:
        return
    for key, stage in transient.by_key.items():
        for force, creepage in Stage.forced:
            if {f"load.{force}", f"creepage.{creepage}"} <= stage.courses.keys():
                yield Fault(f"{key}.creepage.{creepage}", f"with {key}.load.{force}", either)
    if transient.stage:
        return
    courses = transient.stages[0].courses
    for key in ("load.normal", "load.approach"):
        if key in courses and entries[key] is None:
            cure = f"{key} as well: the mesh and the units follow from it"
            yield Fault(f"transient.{key}", f"a course, and no {key}", cure)
    for force, creepage in Stage.forced:
        load, crept = f"load.{force}", f"creepage.{creepage}"
        if entries[load] is not None and load not in courses and crept in courses:
            yield Fault(f"transient.{crept}", f"with {load}", either)
        if load in courses and crept in entries.given:
            yield Fault(crept, f"with transient.{load}", either)


def _check_step_length(entries: ValidEntries) -> Iterator[Fault]:
    """Report steps longer than the contact."""
    transient, hertz = entries["transient"], entries["body"].hertz(entries["load"])
    if transient is None or hertz is None or entries["gap"] is not None:
        return
    length = 2.0 * hertz.a
    for key, stage in transient.by_key.items():
        if stage.rolls and stage.step is not None and length < stage.step:
            cure = f"at most {length:.4g} mm: in a longer step all material leaves the contact"
            yield Fault(f"{key}.step", f"{stage.step:g}", cure)


TRANSIENT_CHECKS: tuple[Check, ...] = (
    _check_tables_of_transient,
    _check_sliding_speed_exists,
    _check_wear_of_transient,
    _check_keys_of_courses,
    _check_step_length,
)
"""Checks between [transient] and the other tables."""
