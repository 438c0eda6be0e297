"""Checks between the tables of a scene: what no table can know by itself."""

from __future__ import annotations

import math
from collections.abc import Iterator

from tractive_sam.mechanics import HertzContact, HertzLine, full_slip_force, load_to_carry
from tractive_sam.schema import Check, Fault, ValidEntries, not_both, shorten, warn

from .bodies import Bodies
from .duty import duty_fits
from .heat import HEAT_CHECKS
from .line_contact import LINE_CHECKS, is_line
from .plausibility import pair_notes
from .process import PROCESS_CHECKS
from .readings import Pair
from .transient import TRANSIENT_CHECKS
from .wear import Wear

MOST_SLENDER = 1000.0
"""Ratio of the semi-axes up to which a grid is chosen: beyond it takes millions of elements."""

UNEQUAL = 0.05
"""Part by which circumferences may differ that are taken for equal without a word."""

LARGEST_CONTACT = 0.3
"""Semi-axis over radius up to which the bodies are taken for half-spaces without a word."""


def _wear_needs_friction(entries: ValidEntries) -> Iterator[Fault]:
    if entries["wear"] is not None and entries["friction"] is None:
        yield Fault("wear", "without friction", "only with a [friction] table: no slip, no work")


def _traction_needs_friction(entries: ValidEntries) -> Iterator[Fault]:
    for key in ("load.force_x", "load.force_y"):
        if key in entries.given and entries["friction"] is None:
            yield Fault(key, "without friction", "only with a [friction] table to transmit it")


def _falling_needs_speed(entries: ValidEntries) -> Iterator[Fault]:
    friction = entries["friction"]
    if friction is None or friction.share is None or entries["creepage.speed"] is not None:
        return
    cure = f'the rolling speed V, mm/s: friction.law = "{friction.law}" depends on that of sliding'
    yield Fault("creepage.speed", "nothing", cure)


def _friction_carries_the_traction(entries: ValidEntries) -> Iterator[Fault]:
    if entries["transient"] is not None:
        return  # `_friction_carries_the_courses` looks at every knot
    forces = entries["load.force_x"], entries["load.force_y"]
    angle = math.radians(entries["friction.angle"])
    for names, given, limit in _beyond(forces, _load(entries), entries["friction.mu"], angle):
        yield _too_much(entries, [f"load.{name}" for name in names], given, limit)


def _friction_carries_the_courses(entries: ValidEntries) -> Iterator[Fault]:
    """Find the first knot at which it does not; of a load that is given."""
    transient, mu = entries["transient"], entries["friction.mu"]
    if transient is None or transient.load.approach is not None:
        return
    courses, angle = transient.courses, math.radians(entries["friction.angle"])
    constant = {
        "load.force_x": entries["load.force_x"],
        "load.force_y": entries["load.force_y"],
        "load.normal": _load(entries),
        "friction.mu": mu[0],
    }
    for k, place in enumerate(transient.distance):
        now = {key: courses[key][k] if key in courses else constant[key] for key in constant}
        force_x, force_y, load, mu1 = now.values()
        weakened = (mu1, mu1 * mu[1] / mu[0])
        found = [*_beyond((force_x, force_y), load, weakened, angle)]
        for names, given, limit in found:
            keys = [f"transient.load.{n}" if f"load.{n}" in courses else f"load.{n}" for n in names]
            unit = " mm" if transient.rolls else ""
            yield _too_much(entries, keys, f"{given} at {place:g}{unit}", limit)
        if found:
            return


def _load(entries: ValidEntries) -> float | None:
    """The normal load where it is given; else only the solution tells what friction carries."""
    if entries["load.pressure"] is not None:
        return entries["body"].normal_load(entries["load"])
    return entries["load.normal"]


def _beyond(
    forces: tuple[float | None, float | None],
    load: float | None,
    mu: tuple[float, float],
    angle: float,
) -> Iterator[tuple[tuple[str, ...], str, float]]:
    """Forces that friction cannot carry: their names, what is given, and the limit."""
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
        # With the other force free, friction carries the most in full slip along this axis.
        most = abs(full_slip_force(load, mu, angle, (1.0 - axis, float(axis)))[axis])
        if force is not None and abs(force) >= most:
            yield (name,), shorten(force), most


def _too_much(entries: ValidEntries, keys: list[str], given: str, limit: float) -> Fault:
    unit = "N/mm" if is_line(entries) else "N"
    cure = f"less than {limit:.6g} {unit}: friction can carry at most this much in this direction"
    return Fault(", ".join(keys), given, cure)


def _forces_are_for_newton(entries: ValidEntries) -> Iterator[Fault]:
    method = entries["solver.method"]
    given = [k for k in ("load.force_x", "load.force_y") if entries[k] is not None]
    if method in ("uzawa", "anderson") and given:
        text = f'"auto" or "newton", which find the creepages of {" and ".join(given)}'
        yield Fault("solver.method", shorten(method), text)


def _bodies_can_touch(entries: ValidEntries) -> Iterator[Fault]:
    if entries["gap"] is not None:  # it may close what the radii leave open
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
            cure = "radii that curve one body against the other in x, or a [gap]"
        else:
            cure = (
                "a contact of finite width, or both inf (a line contact): give one body a smaller "
                "radius_y (a crown), or its profile as a [gap]"
            )
        given = f"{radius_A:g} and {radius_B:g}, no contact possible"
        yield Fault(f"body.A.{key}, body.B.{key}", given, cure)


def _grid_holds_the_contact(entries: ValidEntries) -> Iterator[Fault]:
    if entries["gap"] is not None:  # the Hertz ellipse is not the contact
        return
    half_length, contact = entries["grid.half_length"] or (), entries["body"].hertz(entries["load"])
    if contact is None or len(half_length) != (1 if is_line(entries) else 2):
        return
    for axis, length, name, semi_axis in _directions(half_length, contact):
        if length < semi_axis:
            least = f"{1.00001 * semi_axis:.6g}"  # rounded up
            cure = f"at least {least} in {axis}: the contact has the semi-axis {name} there"
            pair = Pair.from_tables(entries["body"], entries["load"])
            cure = "; ".join((cure, *pair_notes(pair)))
            yield Fault("grid.half_length", shorten(half_length), cure)


def _grid_is_given_to_slender_contacts(entries: ValidEntries) -> Iterator[Fault]:
    grid = entries["grid"]
    whole = grid is not None and None not in (grid.half_length, grid.elements)
    if entries["gap"] is not None or whole or is_line(entries):
        return
    contact = entries["body"].hertz(entries["load"])
    if contact is not None and not 1.0 / MOST_SLENDER <= contact.a / contact.b <= MOST_SLENDER:
        radii = ", ".join(f"body.{b}.radius_{axis}" for axis in "xy" for b in "AB")
        given = f"a contact of semi-axes {contact.a:.3g} and {contact.b:.3g} mm and no whole grid"
        cure = (
            f"semi-axes up to {MOST_SLENDER:g} times as long as each other; for others both keys "
            "of [grid], or a line contact: radius_y = inf of both bodies"
        )
        yield Fault(radii, given, cure)


def _a_body_comes_round(entries: ValidEntries) -> Iterator[Fault]:
    wear, radii = entries["wear"], (entries["body.A.radius_x"], entries["body.B.radius_x"])
    if entries["transient"] is not None:
        return
    if wear is not None and wear.turns == "each" and radii == (math.inf, math.inf):
        cure = 'a finite radius_x of the body whose turns are counted, or "equal"'
        yield Fault("wear.turns", '"each" with two bodies that are flat in x', cure)


def _pressure_is_of_the_radii(entries: ValidEntries) -> Iterator[Fault]:
    pressure = entries["load.pressure"]
    if pressure is not None and entries["gap"] is not None:
        cure = "load.normal or load.approach: with a [gap] the radii alone do not tell the contact"
        yield Fault("load.pressure", shorten(pressure), cure)


def _one_sharing_of_wear(entries: ValidEntries) -> Iterator[Fault]:
    hard = [key for key in ("body.A.hardness", "body.B.hardness") if key in entries.given]
    if hard and entries["wear"] is not None and entries["wear"].share is not None:
        cure = "no hardness: the coefficient of each body tells its share"
        yield Fault(", ".join(hard), "together with a wear.coefficient of each body", cure)


def _law_has_what_it_needs(entries: ValidEntries) -> Iterator[Fault]:
    wear = entries["wear"]
    laws = {} if wear is None else wear.laws
    if "brr" in laws.values() and is_line(entries):
        cure = "another law: it goes by T-gamma of a whole contact, N, and this one has N/mm"
        yield Fault("wear.law", "brr in a line contact", cure)
    for body in (body for body, law in laws.items() if law == "jendel"):
        if f"body.{body}.hardness" not in entries.given:
            cure = "MPa: the law jendel goes by the pressure over the hardness"
            yield Fault(f"body.{body}.hardness", "nothing", cure)
    if "jendel" in laws.values() and entries["creepage.speed"] is None:
        cure = "the rolling speed, mm/s: the law jendel goes by the sliding speed"
        yield Fault("creepage.speed", "nothing", cure)


def _fatigue_is_of_steady_rolling(entries: ValidEntries) -> Iterator[Fault]:
    if entries["fatigue"] is not None and entries["transient"] is not None:
        cure = "no [transient]: only in steady rolling the material lives through what is along x"
        yield Fault("fatigue", "together with [transient]", cure)


SCENE_CHECKS: tuple[Check, ...] = (
    _fatigue_is_of_steady_rolling,
    not_both("load.force_x", "creepage.longitudinal"),
    not_both("load.force_y", "creepage.lateral"),
    not_both("grid", "accuracy"),
    _wear_needs_friction,
    _traction_needs_friction,
    _falling_needs_speed,
    _friction_carries_the_traction,
    _friction_carries_the_courses,
    _forces_are_for_newton,
    _bodies_can_touch,
    _grid_holds_the_contact,
    _grid_is_given_to_slender_contacts,
    _a_body_comes_round,
    _pressure_is_of_the_radii,
    _one_sharing_of_wear,
    _law_has_what_it_needs,
    duty_fits,
    *LINE_CHECKS,
    *TRANSIENT_CHECKS,
    *PROCESS_CHECKS,
    *HEAT_CHECKS,
)
"""All checks of a valid scene."""


def warn_if_large(bodies: Bodies, contact: HertzContact | HertzLine) -> None:
    """Warn, once for all directions, of a contact that is not small against the radii.

    Parameters
    ----------
    bodies : Bodies
        The bodies; their own radii count as well as the combined ones, which alone say nothing of
        conforming bodies.
    contact : HertzContact or HertzLine
        Their unworn contact.
    """
    ratios = []
    for axis, name, combined in zip("xy", "ab", bodies.radii, strict=True):
        key = f"radius_{axis}"
        smallest = min(abs(getattr(bodies.A, key)), abs(getattr(bodies.B, key)), combined)
        ratio = getattr(contact, name) / smallest if smallest < math.inf else 0.0
        if ratio > LARGEST_CONTACT:
            ratios.append(f"{name}/R_{axis} = {ratio:.2g}")
    if ratios:
        text = (
            f"body: the contact is large against the radii, {' and '.join(ratios)}; half-spaces "
            f"stand for bodies up to about {LARGEST_CONTACT:g}. Lower the [load]"
        )
        warn(text)


def warn_if_unequal(bodies: Bodies, wear: Wear) -> None:
    """Warn of bodies that wear and come round unequally often, unless that was asked for.

    Parameters
    ----------
    bodies : Bodies
        The bodies.
    wear : Wear
        Their wear; ``turns = "each"``, written down, tells that unequal turns are meant.
    """
    radii = {name: abs(getattr(bodies, name).radius_x) for name in "AB"}
    alike = max(radii.values()) <= (1.0 + UNEQUAL) * min(radii.values())
    if alike or (wear.turns == "each" and "turns" in wear.model_fields_set):
        return
    counted = "A" if math.isfinite(radii["A"]) else "B"
    meaning = 'each body meets its own wear again, averaged over the phase (wear.turns = "each")'
    if wear.turns != "each":
        meaning = 'wear.turns = "each" lets each body meet its own wear, averaged over the phase'
    text = (
        f"wear.turns: radius_x of A is {radii['A']:g} and of B {radii['B']:g}, so the bodies do "
        f"not turn equally often, a flat one never; wear.revolutions counts those of {counted}, "
        f"and {meaning}"
    )
    warn(text)


def _directions(
    half_length: tuple[float, ...], contact: HertzContact | HertzLine
) -> list[tuple[str, float, str, float]]:
    """Axis, half length of the grid, name and value of the semi-axis, for x and y, of lines x."""
    return list(zip("xy", half_length, "ab", (contact.a, contact.b), strict=False))
