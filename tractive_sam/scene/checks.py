"""Checks between the tables of a scene: contacts, prescribed forces, transients, wear."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

from tractive_sam.mechanics import HertzContact, HertzLine, full_slip_force, load_to_carry
from tractive_sam.schema import Check, Fault, NamedLaw, Table, ValidEntries, not_both, shorten, warn

from .bodies import HEAT_CHECKS, Bodies
from .duty import check_blocks
from .plausibility import Pair, pair_notes
from .schedule import Stage
from .wear import BY_COEFFICIENT, Wear, check_layers_wear
from .wheel_rail import WHEEL_CHECKS

_CROWN = "or a finite radius_y of one body, for a contact of finite width"


def is_line(entries: ValidEntries) -> bool:
    """Return whether the entries of a scene describe a line contact."""
    gap = entries["gap"]
    long = all(entries[f"body.{b}.radius_y"] == math.inf for b in "AB")
    return long and (gap is None or gap.profile == "x")


def _check_keys_of_points(entries: ValidEntries) -> Iterator[Fault]:
    """Report an approach, spin, or friction that varies across, in a line contact."""
    even = f"in a line contact, which is constant in y; {_CROWN}"
    infinite = "the approach of a line contact relative to distant points is infinite"
    excluded = (
        ("load.approach", None, f"load.normal, in N/mm: {infinite}; {_CROWN}"),
        ("creepage.spin", 0, f"0 {even}"),
        ("friction.across", None, f"nothing {even}"),
    )
    for key, default, cure in excluded:
        if is_line(entries) and entries[key] not in (None, default):
            yield Fault(key, shorten(entries[key]), cure)


def _check_directions_of_grid(entries: ValidEntries) -> Iterator[Fault]:
    """Report grid entries with two numbers in a line contact, or with one in another."""
    if entries["grid"] is None:
        return
    line = is_line(entries)
    for key, values in (("half_length", "numbers above 0"), ("elements", "integers from 3")):
        value = entries[f"grid.{key}"]
        if value is None:
            continue
        if line and len(value) == 2:
            cure = f"one number, for x: a line contact is constant in y; {_CROWN}"
            yield Fault(f"grid.{key}", shorten(value), cure)
        elif not line and len(value) == 1:
            cure = f"a pair of {values}, in x and y; one number is for line contacts"
            if entries["body"].infinitely_long:
                cure += ', which a [gap] with profile = "x" allows'
            yield Fault(f"grid.{key}", shorten(value[0]), cure)


def _check_unit_of_planes(entries: ValidEntries) -> Iterator[Fault]:
    """Report stress planes in units of the semi-axis b, which a line contact lacks."""
    if entries["subsurface"] is None or not is_line(entries):
        return
    for plane in entries["subsurface.planes"]:
        if plane.unit == "b":
            cure = "a plane in mm or in a: the semi-axis b of a line contact is infinite"
            yield Fault("subsurface.planes", shorten(str(plane)), cure)


LINE_CHECKS: tuple[Check, ...] = (
    _check_keys_of_points,
    _check_directions_of_grid,
    _check_unit_of_planes,
)
"""Checks of line contacts."""


def _check_friction(entries: ValidEntries) -> Iterator[Fault]:
    """Report forces, wear and transients without friction."""
    reasons = {
        "load.force_x": "without friction there is no tangential force",
        "load.force_y": "without friction there is no tangential force",
        "wear": "without friction, of mu above 0, there is no frictional work",
        "transient": "a transient needs it",
    }
    if entries["friction"] is None:
        for key in filter(entries.given.__contains__, reasons):
            yield Fault(key, "without friction", f"a [friction] table: {reasons[key]}")


def _check_force_limit(entries: ValidEntries) -> Iterator[Fault]:
    """Report prescribed forces above the friction limit in a scene without [transient]."""
    if entries["transient"] is not None:
        return  # `_check_force_limit_at_knots` covers it
    forces = entries["load.force_x"], entries["load.force_y"]
    angle = math.radians(entries["friction.angle"])
    for names, value, limit in _forces_above_limit(
        forces, _normal_load(entries), _largest_mu(entries), angle
    ):
        yield _limit_fault(entries, [f"load.{name}" for name in names], value, limit)


def _check_force_limit_at_knots(entries: ValidEntries) -> Iterator[Fault]:
    """Report the first knot at which forces exceed the friction limit of a known normal load."""
    transient, mu, largest = entries["transient"], entries["friction.mu"], _largest_mu(entries)
    if transient is None:
        return
    angle, constant = math.radians(entries["friction.angle"]), constant_quantities(entries)
    knots = (
        (table, stage, k) for table, stage in transient.by_key.items() for k in stage.knot_range
    )
    for table, stage, k in knots:
        values = stage.values_at(k, constant)
        forces = values["load.force_x"], values["load.force_y"]
        factor = values["friction.mu"] / mu[0]
        mu_at_knot = factor * largest[0], factor * largest[1]
        excess = [*_forces_above_limit(forces, values["load.normal"], mu_at_knot, angle)]
        for names, value, limit in excess:
            given = (f"load.{name}" for name in names)
            keys = [f"{table}.{key}" if key in stage.courses else key for key in given]
            unit = " mm" if stage.rolls else ""
            yield _limit_fault(entries, keys, f"{value} at {stage.distance[k]:g}{unit}", limit)
        if excess:
            return


def constant_quantities(entries: ValidEntries) -> dict[str, float | None]:
    """Return loads, forces and friction of [load] and [friction] by dotted key; None if not set."""
    keys = ("load.approach", "load.force_x", "load.force_y")
    values: dict[str, float | None] = {key: entries[key] for key in keys}
    return values | {"load.normal": _normal_load(entries), "friction.mu": entries["friction.mu"][0]}


def _check_method(entries: ValidEntries) -> Iterator[Fault]:
    """Report a method that does not solve for the creepages of forces, or the steps in time."""
    keys = "load.force_x", "load.force_y", "transient"
    needed = [key for key in keys if entries[key] is not None]
    if needed and entries["solver.method"] in ("uzawa", "anderson"):
        cure = f'"auto" or "newton", which {" and ".join(needed)} need'
        yield Fault("solver.method", shorten(entries["solver.method"]), cure)


def _largest_mu(entries: ValidEntries) -> tuple[float, float]:
    """Return (mu1, mu2) at the lateral position with the largest friction."""
    mu1, mu2 = entries["friction.mu"]
    across = None if entries["friction"] is None else entries["friction"].across
    factor = 1.0 if across is None else max(factor for _, factor in across)
    return factor * mu1, factor * mu2


def _normal_load(entries: ValidEntries) -> float | None:
    """Return the normal load, or None if only the solution of the contact gives it."""
    if entries["load.pressure"] is not None:
        return entries["body"].normal_load(entries["load"])
    return entries["load.normal"]


def _forces_above_limit(
    forces: tuple[float | None, float | None],
    load: float | None,
    mu: tuple[float, float],
    angle: float,
) -> Iterator[tuple[tuple[str, ...], str, float]]:
    """Yield (names, value as text, limit) of forces that friction cannot transmit."""
    if load is None:
        return
    force_x, force_y = forces
    if force_x is not None and force_y is not None:
        share = load_to_carry((force_x, force_y), mu, angle) / load
        if share >= 1:
            limit = math.hypot(force_x, force_y) / share
            yield ("force_x", "force_y"), shorten((force_x, force_y)), limit
        return
    for axis, (name, force) in enumerate((("force_x", force_x), ("force_y", force_y))):
        # If the other force is free, the limit is the force of full slip along this axis.
        limit = abs(full_slip_force(load, mu, angle, (1.0 - axis, float(axis)))[axis])
        if force is not None and abs(force) >= limit:
            yield (name,), shorten(force), limit


def _limit_fault(entries: ValidEntries, keys: list[str], value: str, limit: float) -> Fault:
    """Return the fault of forces above the friction limit."""
    unit = "N/mm" if is_line(entries) else "N"
    cure = f"less than {limit:.6g} {unit}: friction can carry at most this much in this direction"
    return Fault(", ".join(keys), value, cure)


FORCE_CHECKS: tuple[Check, ...] = (
    _check_friction,
    _check_force_limit,
    _check_force_limit_at_knots,
    _check_method,
)
"""Checks of prescribed forces."""


def _check_strength_of_transient(entries: ValidEntries) -> Iterator[Fault]:
    """Report a friction law with memory and strength, which [transient] excludes."""
    friction = entries["friction"] if entries["transient"] is not None else None
    if friction and friction.share and friction.memory and friction.strength is not None:
        cure = "nothing: a transient with friction.memory cannot have a strength"
        yield Fault("friction.strength", "with friction.memory and [transient]", cure)


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


def _check_duration(entries: ValidEntries) -> Iterator[Fault]:
    """Report the duration of shifts of bodies that do not relax, and of rolling."""
    transient = entries["transient"]
    for key, stage in {} if transient is None else transient.by_key.items():
        if stage.duration is None:
            continue
        if stage.rolls:
            cure = "nothing: bodies that roll take the time that creepage.speed gives"
            yield Fault(f"{key}.duration", f"{stage.duration:g}, without a shift", cure)
        elif not entries["body"].relaxes:
            cure = "nothing, or body.A.relaxation: without it a shift does not depend on time"
            yield Fault(f"{key}.duration", f"{stage.duration:g}", cure)


def _check_wear_of_transient(entries: ValidEntries) -> Iterator[Fault]:
    """Report wear that a transient does not follow, or without it the missing revolutions."""
    transient, wear = entries["transient"], entries["wear"]
    if wear is None or entries["process"] is not None:
        return
    if transient is None:
        if "wear.revolutions" not in entries.given:
            cure = "an integer from 1, or a [transient] with a distance over which it wears"
            yield Fault("wear.revolutions", "nothing", cure)
        return
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
    _check_strength_of_transient,
    _check_sliding_speed_exists,
    _check_wear_of_transient,
    _check_duration,
    _check_keys_of_courses,
    _check_step_length,
)
"""Checks between [transient] and the other tables."""


def _check_speed(entries: ValidEntries) -> Iterator[Fault]:
    """Report bodies, laws or a [heat] table that depend on the rolling speed, without it."""
    friction, wear, sliding = entries["friction"], entries["wear"], "depends on the sliding speed"
    reasons = []
    if friction is not None and friction.share is not None:
        reasons.append(f'friction.law = "{friction.law}" {sliding}')
    if wear is not None and "jendel" in wear.laws.values():
        reasons.append(f"the wear law jendel {sliding}")
    if entries["heat"] is not None:
        reasons.append("[heat] depends on it")
    transient = entries["transient"]
    rolls = transient is None or transient.rolls or transient.start == "steady"
    if entries["body"].relaxes and rolls:
        reasons.append("the response of a body with relaxation depends on it")
    if reasons and entries["creepage.speed"] is None:
        yield Fault("creepage.speed", "nothing", f"rolling speed V, mm/s: {'; '.join(reasons)}")


def _check_bodies_can_touch(entries: ValidEntries) -> Iterator[Fault]:
    """Report radii that give no closed contact."""
    if entries["gap"] is not None:  # it may limit the contact if the radii do not
        return
    for axis in "xy":
        key = f"radius_{axis}"
        radius_A, radius_B = entries[f"body.A.{key}"], entries[f"body.B.{key}"]
        curvature = 1 / radius_A + 1 / radius_B
        if curvature > 0 or (axis == "y" and is_line(entries)):
            continue
        if curvature < 0:
            cure = f"1/A + 1/B above 0: the concave body must have the larger radius in {axis}"
        elif axis == "x":
            cure = "a finite radius_x of one body, or a [gap]"
        else:
            cure = (
                "a contact of finite width, or both inf (a line contact): give one body a smaller "
                "radius_y (a crown), or its profile as a [gap]"
            )
        radii = f"{radius_A:g} and {radius_B:g}, no contact possible"
        yield Fault(f"body.A.{key}, body.B.{key}", radii, cure)


def _check_grid_contains_contact(entries: ValidEntries) -> Iterator[Fault]:
    """Report a grid smaller than the contact."""
    elastic = entries["elasticity"]
    if (elastic is not None and elastic.named_law) or entries["body"].depends_on_length:
        return  # layers change the size of the contact: the Hertz contact is an estimate
    if any(entries[key] is not None for key in ("gap", "wheel", "conformal")):
        return  # the Hertz ellipse is not the contact
    half_length, contact = entries["grid.half_length"] or (), entries["body"].hertz(entries["load"])
    if contact is None or len(half_length) != (1 if is_line(entries) else 2):
        return
    place = entries["grid"].place
    for axis, length, name, semi_axis in _directions(half_length, contact):
        away = abs(place["xy".index(axis)])
        if length < semi_axis + away:
            smallest = f"{1.00001 * (semi_axis + away):.6g}"  # rounded up
            cure = f"at least {smallest} mm in {axis}, the semi-axis {name} that [load] causes"
            cure += " and the distance of grid.centre" if away else ""
            pair = Pair.from_tables(entries["body"], entries["load"])
            cure = "; ".join((cure, *pair_notes(pair)))
            yield Fault("grid.half_length", shorten(half_length), cure)


def _check_slender_contact_has_grid(
    entries: ValidEntries, max_ratio: float = 1000.0
) -> Iterator[Fault]:
    """Report a contact with very unequal semi-axes without a complete [grid].

    Parameters
    ----------
    entries : ValidEntries
        Entries of the scene.
    max_ratio : float
        Ratio of the semi-axes up to which a grid is chosen; above it a grid needs millions of
        elements.
    """
    grid = entries["grid"]
    complete = grid is not None and None not in (grid.half_length, grid.elements)
    if entries["gap"] is not None or entries["wheel"] is not None:
        return
    if complete or is_line(entries):
        return
    contact = entries["body"].hertz(entries["load"])
    if contact is not None and not 1.0 / max_ratio <= contact.a / contact.b <= max_ratio:
        radii = ", ".join(f"body.{b}.radius_{axis}" for axis in "xy" for b in "AB")
        value = (
            f"a contact of semi-axes {contact.a:.3g} and {contact.b:.3g} mm without a full [grid]"
        )
        cure = (
            f"a ratio of the semi-axes up to {max_ratio:g}; otherwise give both keys of [grid], "
            "or make it a line contact: radius_y = inf of both bodies"
        )
        yield Fault(radii, value, cure)


def _check_a_body_turns(entries: ValidEntries) -> Iterator[Fault]:
    """Report wear.turns "each" for two flat bodies, which have no revolutions to count."""
    wear, radii = entries["wear"], (entries["body.A.radius_x"], entries["body.B.radius_x"])
    if entries["transient"] is not None:
        return
    if wear is not None and wear.turns == "each" and radii == (math.inf, math.inf):
        cure = 'a finite radius_x of one body, or "equal"'
        yield Fault("wear.turns", '"each" with two bodies that are flat in x', cure)


def _check_approach_is_positive(entries: ValidEntries) -> Iterator[Fault]:
    """Report an approach of 0 or less, counted from the first touch."""
    approach, gap = entries["load.approach"], entries["gap"]
    if approach is None or approach > 0.0 or (gap is not None and gap.datum == "separation"):
        return
    cure = 'a number above 0; at 0 or below only a [gap] with datum = "separation" interferes'
    yield Fault("load.approach", shorten(approach), cure)


def _check_share_of_wear(entries: ValidEntries) -> Iterator[Fault]:
    """Report hardness together with a wear coefficient of each body."""
    hard = [key for key in ("body.A.hardness", "body.B.hardness") if key in entries.given]
    if hard and entries["wear"] is not None and entries["wear"].share is not None:
        cure = "no hardness: the share of each body follows from its coefficient"
        yield Fault(", ".join(hard), "with a wear.coefficient of each body", cure)


def _check_inputs_of_wear_law(entries: ValidEntries) -> Iterator[Fault]:
    """Report inputs that a published wear law needs and lacks, and brr in a line contact."""
    wear = entries["wear"]
    laws = {} if wear is None else wear.laws
    if "brr" in laws.values() and is_line(entries):
        cure = "another law: brr depends on T-gamma in N, which in a line contact is in N/mm"
        yield Fault("wear.law", "brr in a line contact", cure)
    for body in (body for body, law in laws.items() if law == "jendel"):
        if f"body.{body}.hardness" not in entries.given:
            cure = "hardness in MPa: the law jendel depends on the pressure over the hardness"
            yield Fault(f"body.{body}.hardness", "nothing", cure)


def _check_stress_history(entries: ValidEntries) -> Iterator[Fault]:
    """Report [transient] with a cycle start but no [fatigue]."""
    start = entries["transient.cycle_start"] if entries["transient"] is not None else None
    if entries["fatigue"] is None and start is not None:
        yield Fault("transient.cycle_start", f"{start:g}", "only with [fatigue]")


def _check_observers(entries: ValidEntries) -> Iterator[Fault]:
    """Report observers that are named twice in a scene."""
    names = [observer.name.name for observer in entries["observer"]]
    for k, name in enumerate(names):
        if name in names[:k]:
            yield Fault(f"observer[{k}].name", name, "each observer once")


def find_exclusions(tables: Mapping[str, Any]) -> dict[str, dict[str, str]]:
    """Return why tables and keys of a scene are excluded: reasons by what excludes them, by key.

    Tables and kinds of bodies list what they exclude (`Table.excludes`, `Body.kinds`). A key
    "body.NAME" is that of both bodies.

    Parameters
    ----------
    tables : mapping
        Tables of a scene by name.
    """
    owners = {key: value.excludes for key, value in tables.items() if isinstance(value, Table)}
    for name in "AB":
        kinds = getattr(tables["body"], name).kinds
        owners |= {f"body.{name}.{key}": rows for key, rows in kinds.items()}
    found: dict[str, dict[str, str]] = {}
    for owner, rows in owners.items():
        for key, reason in rows.items():
            head, _, last = key.partition("body.")
            for each in [key] if head else [f"body.A.{last}", f"body.B.{last}"]:
                found.setdefault(each, {})[owner] = reason
    return found


def _check_excluded(entries: ValidEntries) -> Iterator[Fault]:
    """Report tables and keys that others or kinds of bodies exclude, with the reason."""
    _ = entries["body"]
    tables = {key: value for key, value in entries.items() if "." not in key}
    for key, reasons in find_exclusions(tables).items():
        value = entries.get(key)
        named = isinstance(value, NamedLaw) or not key.endswith(".law")
        for owner, reason in reasons.items() if value and named and key in entries.given else ():
            with_owner = f"with {owner}" if "." in owner else f"with [{owner}]"
            yield Fault(key, with_owner, f"nothing: {reason}")


SCENE_CHECKS: tuple[Check, ...] = (
    _check_stress_history,
    *FORCE_CHECKS,
    not_both("load.force_x", "creepage.longitudinal"),
    not_both("load.force_y", "creepage.lateral"),
    not_both("grid", "accuracy"),
    _check_speed,
    _check_bodies_can_touch,
    _check_excluded,
    check_layers_wear,
    _check_grid_contains_contact,
    _check_slender_contact_has_grid,
    _check_a_body_turns,
    _check_approach_is_positive,
    _check_share_of_wear,
    _check_inputs_of_wear_law,
    check_blocks,
    *LINE_CHECKS,
    *WHEEL_CHECKS,
    *TRANSIENT_CHECKS,
    _check_observers,
    *HEAT_CHECKS,
)
"""All checks between the tables of a scene."""


def warn_if_large(bodies: Bodies, contact: HertzContact | HertzLine, largest: float = 0.3) -> None:
    """Issue a warning if a contact is not small compared with the radii of the bodies.

    Parameters
    ----------
    bodies : Bodies
        The bodies; the radius of each body and the combined radius are compared, as conforming
        bodies have a large combined radius.
    contact : HertzContact or HertzLine
        Unworn contact of the bodies.
    largest : float
        Semi-axis over radius up to which bodies are half-spaces without a warning.
    """
    ratios = []
    for axis, name, combined in zip("xy", "ab", bodies.radii, strict=True):
        key = f"radius_{axis}"
        smallest = min(abs(getattr(bodies.A, key)), abs(getattr(bodies.B, key)), combined)
        ratio = getattr(contact, name) / smallest if smallest < math.inf else 0.0
        if ratio > largest:
            ratios.append(f"{name}/R_{axis} = {ratio:.2g}")
    if ratios:
        text = (
            f"body: the contact is large compared with the radii, {' and '.join(ratios)}; the "
            f"half-space approximation holds up to about {largest:g}; reduce the [load]"
        )
        warn(text)


def unequal_turns(bodies: Bodies, wear: Wear, difference: float = 0.05) -> str:
    """Return a note if wearing bodies of unequal circumference turn unequally often, or "".

    Parameters
    ----------
    bodies : Bodies
        The bodies.
    wear : Wear
        Their wear; ``turns = "each"`` in the scene avoids the note.
    difference : float
        Relative difference of the circumferences up to which there is no note.
    """
    radii = {name: abs(getattr(bodies, name).radius_x) for name in "AB"}
    alike = max(radii.values()) <= (1.0 + difference) * min(radii.values())
    if alike or (wear.turns == "each" and "turns" in wear.model_fields_set):
        return ""
    counted = "A" if math.isfinite(radii["A"]) else "B"
    meaning = 'worn material returns after a turn of its body (wear.turns = "each")'
    if wear.turns != "each":
        meaning = 'with wear.turns = "each" worn material returns after a turn of its body'
    return (
        f"wear.turns: radius_x of A is {radii['A']:g} and of B {radii['B']:g}, so the bodies do "
        f"not turn equally often (a flat body never turns); wear.revolutions counts the turns of "
        f"{counted}, and {meaning}"
    )


def _directions(
    half_length: tuple[float, ...], contact: HertzContact | HertzLine
) -> list[tuple[str, float, str, float]]:
    """Return (axis, half length, name of semi-axis, semi-axis) for x and, if it exists, y."""
    return list(zip("xy", half_length, "ab", (contact.a, contact.b), strict=False))
