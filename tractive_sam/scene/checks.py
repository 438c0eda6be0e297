"""Checks between the tables of a scene."""

import math
from collections.abc import Iterator

from tractive_sam.mechanics import HertzContact, HertzLine
from tractive_sam.schema import Check, Fault, ValidEntries, not_both, shorten, warn

from .bodies import HEAT_CHECKS, Bodies
from .contact_checks import FORCE_CHECKS, LINE_CHECKS, TRANSIENT_CHECKS, is_line
from .duty import check_blocks
from .observer import check_observers
from .plausibility import Pair, pair_notes
from .process import PROCESS_CHECKS
from .wear import Wear
from .wheel_rail import WHEEL_CHECKS


def _check_wear_has_friction(entries: ValidEntries) -> Iterator[Fault]:
    """Report wear without friction."""
    if entries["wear"] is not None and entries["friction"] is None:
        yield Fault(
            "wear",
            "without friction",
            "a [friction] table with mu above 0: without friction there is no frictional work",
        )


def _check_falling_law_has_speed(entries: ValidEntries) -> Iterator[Fault]:
    """Report a friction law that depends on the sliding speed, without the rolling speed."""
    friction = entries["friction"]
    if friction is None or friction.share is None or entries["creepage.speed"] is not None:
        return
    cure = f'rolling speed V, mm/s: friction.law = "{friction.law}" depends on the sliding speed'
    yield Fault("creepage.speed", "nothing", cure)


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
    if elastic is not None and elastic.named_law:
        return  # a coating changes the size of the contact
    if entries["gap"] is not None or entries["wheel"] is not None:
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


def _check_pressure_has_no_gap(entries: ValidEntries) -> Iterator[Fault]:
    """Report a Hertz pressure together with a [gap]."""
    pressure = entries["load.pressure"]
    if pressure is not None and entries["gap"] is not None:
        cure = "load.normal or load.approach: a [gap] changes the Hertz contact of the radii"
        yield Fault("load.pressure", shorten(pressure), cure)


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
    if "jendel" in laws.values() and entries["creepage.speed"] is None:
        cure = "rolling speed, mm/s: the law jendel depends on the sliding speed"
        yield Fault("creepage.speed", "nothing", cure)


def _check_stress_history(entries: ValidEntries) -> Iterator[Fault]:
    """Report [transient] with a cycle start but no [fatigue], or with [fatigue.volume]."""
    fatigue, transient = entries["fatigue"], entries["transient"]
    if transient is None:
        return
    if fatigue is None and transient.cycle_start is not None:
        yield Fault("transient.cycle_start", f"{transient.cycle_start:g}", "only with [fatigue]")
    if fatigue is not None and fatigue.volume is not None:
        cure = "without [transient]: a volume is stressed evenly only in steady rolling"
        yield Fault("fatigue.volume", "with [transient]", cure)


SCENE_CHECKS: tuple[Check, ...] = (
    _check_stress_history,
    *FORCE_CHECKS,
    not_both("load.force_x", "creepage.longitudinal"),
    not_both("load.force_y", "creepage.lateral"),
    not_both("grid", "accuracy"),
    _check_wear_has_friction,
    _check_falling_law_has_speed,
    _check_bodies_can_touch,
    _check_grid_contains_contact,
    _check_slender_contact_has_grid,
    _check_a_body_turns,
    _check_pressure_has_no_gap,
    _check_approach_is_positive,
    _check_share_of_wear,
    _check_inputs_of_wear_law,
    check_blocks,
    *LINE_CHECKS,
    *WHEEL_CHECKS,
    *TRANSIENT_CHECKS,
    *PROCESS_CHECKS,
    check_observers,
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
