"""Plausible ranges of entries and of computed values, and notes on values outside of them.

`RULES` lists the ranges with the reason of their bounds. A note names the value, its key, what is
probably meant, and what to do. The scene is computed as given.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tractive_sam.mechanics import HertzContact, HertzLine, Material

from .bodies import Bodies
from .tables import Load
from .wear import PER_INTENSITY


@dataclass(frozen=True)
class Reading:
    """Value of a scene or result that a plausibility rule judges, with its key.

    Attributes
    ----------
    key : str
        Key of the value in the scene.
    value : float
        The value, in the unit of its rule.
    details : mapping of str to object
        Further values that the note of the rule prints.
    """

    key: str
    value: float
    details: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Pair:
    """Two bodies with their Hertz contact, the subject of plausibility rules.

    Attributes
    ----------
    bodies : Bodies
        The bodies.
    hertz : HertzContact or HertzLine or None
        Their contact; None if the radii give no closed contact.
    key : str
        Key of the load.
    rough : bool
        Whether a [gap] is added to the radii, so that the pressure differs from Hertz's.
    """

    bodies: Bodies
    hertz: HertzContact | HertzLine | None
    key: str
    rough: bool = False

    @classmethod
    def from_tables(cls, bodies: Bodies, load: Load) -> "Pair":
        """Return the pair of two bodies under a load, with its Hertz contact."""
        return cls(bodies, bodies.hertz(load), f"load.{load.prescribed_key}")

    @classmethod
    def from_scene(cls, scene: Any) -> "Pair":
        """Return the pair of a scene's bodies, under the largest load of its [transient]."""
        hertz, key, schedule = scene.hertz, f"load.{scene.load.prescribed_key}", scene.schedule
        largest = 0.0 if hertz is None or not schedule.own_load else hertz.load
        for name, value in schedule.largest_loads.items():
            load = type(scene.load)(**{name.removeprefix("load."): value})
            under = None if hertz is None else scene.body.hertz(load)
            if under is not None and under.load > largest:
                hertz, key, largest = under, schedule.course_keys[name], under.load
        return cls(scene.body, hertz, key, scene.has_gap)


@dataclass(frozen=True)
class Peak:
    """Largest computed pressure, its position as text, and the materials: a subject of rules."""

    pressure: float
    place: str
    materials: Mapping[str, Material]


def read_moduli(below: float) -> Callable[[Pair], Iterator[Reading]]:
    """Return a function that yields Young's moduli of bodies with a Poisson's ratio below one."""

    def read(pair: Pair) -> Iterator[Reading]:
        for name, material in pair.bodies.materials.items():
            if 0.0 <= material.poisson < below:
                yield Reading(f"body.{name}", material.young)

    return read


def read_radii(pair: Pair) -> Iterator[Reading]:
    """Yield the magnitudes of radius_x and radius_y of both bodies, mm."""
    for name, body in (("A", pair.bodies.A), ("B", pair.bodies.B)):
        for key in ("radius_x", "radius_y"):
            value = getattr(body, key)
            yield Reading(f"body.{name}.{key}", abs(value), {"given": value, "mm": 1e3 * value})


def _are_metals(materials: Mapping[str, Material], softest: float = 4e4) -> bool:
    """Return whether both bodies are as stiff as metals; magnesium, a soft one, has 4.5e4 MPa."""
    return all(material.young >= softest for material in materials.values())


def read_pressure_of_metals(pair: Pair) -> Iterator[Reading]:
    """Yield the peak pressure according to Hertz, MPa, if both bodies are as stiff as metals."""
    # With a gap the pressure is known when the contact is solved.
    if pair.hertz is not None and not pair.rough and _are_metals(pair.bodies.materials):
        meant = "is the load in N (N/mm for a line contact), not in kN, and are the radii in mm?"
        if pair.key == "load.pressure":
            meant = "is the pressure in MPa, not in GPa? 1 GPa is 1000 MPa"
        elif pair.key.endswith("approach"):
            meant = "is the approach in mm, not in m?"
        yield Reading(pair.key, pair.hertz.p0, {"meant": meant})


def read_approach_of_metals(pair: Pair) -> Iterator[Reading]:
    """Yield the approach by Hertz of metals under a given load, um, unless p0 is noted already."""
    hertz, is_load = pair.hertz, pair.key.endswith("load.normal") and not pair.rough
    if hertz is None or not is_load or not _are_metals(pair.bodies.materials):
        return
    if hertz.p0 >= 10.0:  # below, the pressure has a note
        yield Reading(pair.key, 1e3 * hertz.approach, {"load": hertz.load})


def read_computed_pressure_of_metals(peak: Peak) -> Iterator[Reading]:
    """Yield the largest pressure of a solved contact between metals, MPa; none without contact."""
    if peak.pressure > 0.0 and _are_metals(peak.materials):
        yield Reading("p_max", peak.pressure, {"place": peak.place})


def read_shakedown_ratio(scene: Any) -> Iterator[Reading]:
    """Yield the peak Hertz pressure over the shear yield stress; none without a Hertz contact."""
    if scene.hertz is not None:
        p0 = scene.hertz.p0
        yield Reading("fatigue", p0 / scene.fatigue.shear_yield_stress, {"p0": p0})


def read_creepages(scene: Any) -> Iterator[Reading]:
    """Yield the magnitudes of both creepages."""
    for key in ("longitudinal", "lateral"):
        creepage = getattr(scene.creepage, key)
        details = {"given": creepage, "percent": 100.0 * creepage, "meant": 0.01 * creepage}
        yield Reading(f"creepage.{key}", abs(creepage), details)


def read_speed(scene: Any) -> Iterator[Reading]:
    """Yield the rolling speed, mm/s, unless bodies relax: they may be made to roll slowly."""
    speed = scene.creepage.speed
    if not scene.body.relaxes:
        yield Reading("creepage.speed", speed, {"mm": 1e3 * speed})


def read_wear_rate(scene: Any) -> Iterator[Reading]:
    """Yield the wear per frictional work times E*, dimensionless."""
    mu = (1.0, 1.0) if scene.friction is None else scene.friction.mu
    i = max(np.multiply(scene.wear.per_work(mu) or 0.0, mu))
    e_star = scene.material.plane_strain_modulus
    yield Reading("wear", i * e_star, {"i": i, "k": PER_INTENSITY * i})


def read_wear_coefficients(scene: Any) -> Iterator[Reading]:
    """Yield each distinct wear coefficient, mm3/(N m); intensities are converted to it."""
    wear = scene.wear
    if wear.intensity is not None:
        for i in dict.fromkeys(wear.intensity):
            yield Reading("wear.intensity", PER_INTENSITY * i, {"given": f" (i = {i:g} /MPa)"})
    elif isinstance(wear.coefficient, tuple):
        for k in dict.fromkeys(wear.coefficient):
            yield Reading("wear.coefficient", k, {"given": ""})
    elif wear.coefficient is not None:
        for body, k in wear.coefficient.entries().items():
            yield Reading(f"wear.coefficient.{body}", k, {"given": ""})


def read_widths(scene: Any) -> Iterator[Reading]:
    """Yield the width 2b of a Hertz point contact over the width of each body with a width."""
    if isinstance(scene.hertz, HertzContact):
        yield from read_width_ratios(scene, 2.0 * scene.hertz.b)


def read_width_ratios(scene: Any, width: float) -> Iterator[Reading]:
    """Yield the width of a contact, mm, over the width of each body; none for bodies without."""
    for name, body in (("A", scene.body.A), ("B", scene.body.B)):
        # The contact of a roller with a profile ends within it.
        if body.width is not None and body.profile is None and not body.ends:
            details = {"width": width, "name": name, "body": body.width}
            yield Reading("body", width / body.width, details)


def read_conformity(pair: Pair) -> Iterator[Reading]:
    """Yield the half angle of the contact of a body in a concave one, degrees, and its errors.

    The errors are those of a half-space for a disc in a hole of equal material in plane strain,
    with the patch of the conformal contact: how much it underestimates the load and the peak
    pressure, in per cent. Its equation has the kernel cos t ln(2 sin(|t|/2)) + 1/4 in place of
    ln |t| (`tests/scene/test_conformity.py`).
    """
    angles = 0.0, 5.0, 10.0, 20.0, 30.0, 45.0, 60.0
    load = 1.0, 1.0041, 1.0167, 1.0698, 1.1693, 1.4623, 2.1759
    peak = 1.0, 1.0051, 1.0206, 1.0866, 1.2120, 1.5913, 2.5474
    if pair.hertz is None or pair.rough:
        return
    for axis, half in (("x", pair.hertz.a), ("y", pair.hertz.b)):
        key = f"radius_{axis}"
        radii = getattr(pair.bodies.A, key), getattr(pair.bodies.B, key)
        convex = max(radii)
        if min(radii) >= 0.0 or math.isinf(convex):
            continue
        angle = math.degrees(math.asin(min(half / convex, 1.0)))
        at = angle**2, np.square(angles)  # both errors are proportional to the square at first
        errors = [100.0 * (float(np.interp(*at, ratios)) - 1.0) for ratios in (load, peak)]
        curves = axis == "y" or pair.bodies.infinitely_long
        cure = "add [conformal]" if curves else "reduce the load"
        details = {"axis": axis, "load": errors[0], "peak": errors[1], "cure": cure}
        yield Reading(f"body.A.{key}, body.B.{key}", angle, details)


def read_contact_angles(scene: Any) -> Iterator[Reading]:
    """Yield the largest range of the contact angle over a patch of a wheel, degrees."""
    angle = max(patch.angle_range for patch in scene.wheel_rail.patches)
    yield Reading("wheelset", math.degrees(angle))


@dataclass(frozen=True)
class Rule:
    """Rule with a range of implausible values of an entry, and the note that it causes.

    Attributes
    ----------
    name : str
        Name of the rule.
    subject : str
        Kind of object that `read` reads: a `Pair` for "bodies" and "contact", a `Scene` for
        "scene", a `Peak` for "result".
    read : callable
        Yields the values of a subject.
    note : str
        Format of the note after the key, with ``value``, ``above``, ``below`` and the details.
    reason : str
        Reason of the bounds.
    needs : str
        Dotted key of a scene that the rule needs; empty if none.
    above, below : float
        The bounds; both are plausible.
    """

    name: str
    subject: str
    read: Callable[[Any], Iterable[Reading]]
    note: str
    reason: str
    needs: str = ""
    above: float = -math.inf
    below: float = math.inf

    def notes(self, subject: Any) -> Iterator[tuple[str, str]]:
        """Yield (key, note) for each implausible value in a scene, pair or result."""
        if not self.needs or subject.has(self.needs):
            yield from self.judge(self.read(subject))

    def judge(self, readings: Iterable[Reading]) -> Iterator[tuple[str, str]]:
        """Yield (key, note) for each reading with a value in the implausible range."""
        for reading in readings:
            if self.above < reading.value < self.below:
                details = {"above": self.above, "below": self.below, **reading.details}
                yield reading.key, self.note.format(value=reading.value, **details)


RULES = (
    Rule(
        "modulus in GPa",
        "bodies",
        read_moduli(0.45),
        "E = {value:g} MPa is a value of soft plastics; is it in GPa? Steel has 2.1e5 MPa",
        "metals and ceramics have 30 to 1000 GPa; rubber, with a Poisson's ratio of 0.45 or more, "
        "may have 30 to 1000 MPa",
        above=np.nextafter(30.0, 0.0),
        below=np.nextafter(1000.0, np.inf),
    ),
    Rule(
        "modulus beyond any material",
        "bodies",
        read_moduli(np.inf),
        "E = {value:g} MPa is stiffer than any material; is it in Pa? Steel has 2.1e5 MPa",
        "diamond has 1.2e6 MPa; above 2e12, diamond in Pa with a margin, a rigid body is meant",
        above=2e6,
        below=np.nextafter(2e12, np.inf),
    ),
    Rule(
        "radius in m",
        "bodies",
        read_radii,
        "{given:g} mm is less than {below:g} mm; is it in m? {given:g} m is {mm:g} mm",
        "balls of the smallest bearings have 0.1 mm; wheels and discs in m have 0.005 to 1",
        below=0.1,
    ),
    Rule(
        "density in g/cm3",
        "bodies",
        lambda pair: [
            Reading(f"body.{name}.density", getattr(pair.bodies, name).density) for name in "AB"
        ],
        "{value:g} kg/m3 is lighter than any solid; is it in g/cm3 or t/m3? Steel has 7850 "
        "kg/m3; the worn mass is proportional to the density",
        "balsa has 100 kg/m3, and osmium 22.6 g/cm3",
        below=100.0,
    ),
    Rule(
        "high pressure",
        "contact",
        lambda pair: [] if pair.hertz is None else [Reading(pair.key, pair.hertz.p0)],
        "p0 = {value:.4g} MPa by Hertz is more than any material withstands ({above:g} MPa); check "
        "the units mm, N and MPa",
        "hardened steel has a hardness of 8000 MPa; ceramics yield at about 10000",
        above=1e4,
    ),
    Rule(
        "low pressure",
        "contact",
        read_pressure_of_metals,
        "p0 = {value:.3g} MPa by Hertz is improbable for rolling metals, which carry 100 to 5000 "
        "MPa; {meant}",
        "at 10 MPa the contact of metals is smaller than 1e-4 of the radius, and roughness carries "
        "it; a load in kN gives a tenth of p0, a pressure in GPa a thousandth",
        below=10.0,
    ),
    Rule(
        "load in kN",
        "contact",
        read_approach_of_metals,
        "under {load:g} N (N/mm for a line contact), the bodies approach by {value:.2g} um, less "
        "than the roughness of ground surfaces, which then carries the load; is the load in kN?",
        "ground surfaces have a roughness of 0.2 to 1 um; discs and wheels of steel approach by 1 "
        "to 100 um, and under a load in kN in place of N by a hundredth of it",
        below=0.2,
    ),
    Rule(
        "conforming bodies",
        "contact",
        read_conformity,
        "the bodies conform in {axis}: with a half angle of {value:.3g} degrees, the half-space "
        "gives about {load:.2g} % less load and {peak:.2g} % less peak pressure for this patch "
        "than a body in a hole (plane strain, equal materials); {cure}",
        "at a half angle of 10 degrees, the error of the peak pressure is 2 %",
        above=10.0,
    ),
    Rule(
        "computed high pressure",
        "result",
        lambda peak: [Reading("p_max", peak.pressure, {"place": peak.place})],
        "{value:.4g} MPa{place} is more than any material withstands ({above:g} MPa); heights of a "
        "gap in another unit, or peaks as sharp as an element, may be the reason: see p_95, and "
        "check [gap], [load] and the radii",
        "as for the pressure by Hertz",
        above=1e4,
    ),
    Rule(
        "computed low pressure",
        "result",
        read_computed_pressure_of_metals,
        "{value:.3g} MPa{place} is improbable for rolling metals, which carry 100 to 5000 MPa; "
        "check the units of [load] (N, MPa, mm) and of the radii (mm)",
        "as for the pressure by Hertz",
        below=10.0,
    ),
    Rule(
        "contact near an edge",
        "scene",
        read_widths,
        "the contact is {width:.3g} mm wide and body {name} {body:g} mm; its edges, at which the "
        "pressure rises, are not modelled: reduce the load, describe a crown by [gap], or compute "
        "a line contact (radius_y = inf, load.normal in N/mm)",
        "the distance to an edge is then a quarter of the half width",
        above=0.8,
    ),
    Rule(
        "conformal contact",
        "scene",
        read_contact_angles,
        "the contact angle varies by {value:.3g} degrees over a patch; more than {above:g} is a "
        "conformal contact, which a half-space does not describe: the forces are estimates",
        "the normals at the edges then differ by 7.5 degrees from the normal of the plane, and "
        "their components along it by 1 %",
        needs="wheelset",
        above=15.0,
    ),
    Rule(
        "no shakedown",
        "scene",
        read_shakedown_ratio,
        "p0 = {p0:.4g} MPa is {value:.3g} times the yield stress in shear; above {above:g} there "
        "is no shakedown: the material yields in every pass, and the elastic stress is not valid",
        "a circular contact without friction shakes down up to 4.7, a line up to 4",
        needs="fatigue.shear_yield_stress",
        above=4.7,
    ),
    Rule(
        "creepage in per cent",
        "scene",
        read_creepages,
        "{given:g} is {percent:g} %; if {given:g} % is meant, write {meant:g}",
        "beyond 0.1 bodies slide rather than roll; 1 is one body at rest",
        above=0.1,
    ),
    Rule(
        "speed in m/s",
        "scene",
        read_speed,
        "{value:g} mm/s is slow; is it in m/s? {value:g} m/s is {mm:g} mm/s; falling friction and "
        "heat depend on the speed",
        "discs, gears and wheels roll at 1e2 to 1e5 mm/s, in m/s 0.1 to 100",
        needs="creepage.speed",
        above=0.0,
        below=60.0,
    ),
    Rule(
        "half speed in m/s",
        "scene",
        lambda scene: [
            Reading("friction.half_speed", speed, {"mm": 1e3 * speed})
            for speed in [scene.friction.half_speed]
        ],
        "{value:g} mm/s is slow; is it in m/s? {value:g} m/s is {mm:g} mm/s",
        "friction of rolling contacts falls at sliding speeds of 1e1 to 1e3 mm/s, in m/s 0.01 to 1",
        needs="friction.half_speed",
        above=0.0,
        below=2.0,
    ),
    Rule(
        "friction in per cent",
        "scene",
        lambda scene: [Reading("friction.mu", max(scene.friction.mu))],
        "{value:g} is more than any surfaces reach; is it in per cent?",
        "rubber on a dry road, and cold welds, have up to 2",
        needs="friction",
        above=2.0,
    ),
    Rule(
        "fast wear",
        "scene",
        read_wear_rate,
        "i = {i:g} /MPa, k = {k:g} mm3/(N m), is a thousand times the wear of dry steel; check the "
        "unit: wear.coefficient is in mm3/(N m), wear.intensity in 1/MPa",
        "wear intensity times E*: a thousand times the wear of dry steel, k = 2e-5 mm3/(N m)",
        needs="wear",
        above=2.0,
    ),
    Rule(
        "slow wear",
        "scene",
        read_wear_coefficients,
        "k = {value:g} mm3/(N m){given} is less than any material has; is it in m2/N or "
        "m3/(N m)? 1e-13 m2/N is 1e-4 mm3/(N m), which is 1e-7 /MPa",
        "diamond-like carbon in oil wears by 1e-10 mm3/(N m); dry steel in m2/N has 1e-15 to 1e-12",
        needs="wear",
        above=0.0,
        below=1e-10,
    ),
)
"""The plausible ranges, with the reason of each."""


def _judge(kind: str, subject: Any) -> Iterator[tuple[str, str]]:
    """Yield (key, note) of all rules of a kind for its subject (bodies, scene or result)."""
    for rule in RULES:
        if rule.subject == kind:
            yield from rule.notes(subject)


def pair_notes(pair: Pair) -> Iterator[str]:
    """Yield a note for each implausible property of two bodies and their load."""
    for kind in ("bodies", "contact"):
        yield from (f"{key}: {note}" for key, note in _judge(kind, pair))


def edge_notes(scene: Any, width: float) -> Iterator[str]:
    """Yield a note for each body that is hardly wider than a contact of this width, mm."""
    (rule,) = (rule for rule in RULES if rule.read is read_widths)
    yield from (note for _, note in rule.judge(read_width_ratios(scene, width)))


def conformity_notes(angle: float) -> Iterator[str]:
    """Yield a note if the contact angle varies by many degrees (`angle`) over a patch."""
    (rule,) = (rule for rule in RULES if rule.read is read_contact_angles)
    yield from (note for _, note in rule.judge([Reading("wheelset", angle)]))


def pressure_notes(scene: Any, pressure: float, place: str = "") -> Iterator[str]:
    """Yield a note if the largest computed pressure is implausible and the Hertz contact is not.

    There is no note if the scene already has one about its pressure by Hertz.

    Parameters
    ----------
    scene : Scene
        The scene that was computed.
    pressure : float
        The largest pressure of all its contacts, MPa.
    place : str
        Text that follows the number, for example the revolution.
    """
    if not any(_judge("contact", Pair.from_scene(scene))):
        peak = Peak(pressure, place, scene.materials)
        yield from (note for _, note in _judge("result", peak))


def scene_notes(scene: Any) -> Iterator[str]:
    """Yield a note for each implausible or unused entry of a scene."""
    yield from pair_notes(Pair.from_scene(scene))
    yield from (f"{key}: {note}" for key, note in _judge("scene", scene))
    for name in ("wheel", "rail"):
        if (table := getattr(scene, name)) is not None:
            yield from (f"{name}.profile: {note}" for note in table.notes)
    yield from _unused_entries(scene)
    yield from _unused_steel(scene)
    yield from _creepage_without_friction(scene)
    yield from _replaced_motion(scene)


def _unused_entries(scene: Any) -> Iterator[str]:
    """Yield a note for each creepage or force of a scene that a course of [transient] replaces."""
    courses = {} if scene.has("transient.stage") else scene.schedule.courses
    for key, course in courses.items():
        table, _, name = key.partition(".")
        value = getattr(scene, table).entries().get(name)
        if (table == "creepage" or name.startswith("force")) and value not in (None, course[0]):
            yield f"{key}: {value:g} is not used, as transient.{key} gives it; remove it"


def _unused_steel(scene: Any) -> Iterator[str]:
    """Yield a note for residual stress, hardness and inclusions on which no column depends."""
    inclusions = {inclusion.body for inclusion in scene.inclusion or ()}
    for body in "AB":
        tables = [table for table in (scene.subsurface, scene.fatigue) if table is not None]
        used = body in inclusions or any(body in table.bodies for table in tables)
        if scene.has(f"residual.{body}") and not used:
            cure = f"add [fatigue], [subsurface] or [[inclusion]] of body {body}"
            yield f"residual.{body}: no column depends on it; {cure}"
        if not scene.has(f"fatigue.{body}"):
            continue
        rule = scene.fatigue.criterion, scene.fatigue.sensitivity
        strength = getattr(scene.fatigue, body)
        for key in ("hardness", "inclusion"):
            if getattr(strength, key) is None:
                continue
            limits = [
                {name: list(values) for name, values in table.find_curves(*rule).items()}
                for table in (strength, strength.model_copy(update={key: None}))
            ]
            if all(limits[0][name] == limits[1].get(name) for name in limits[0].keys() - {key}):
                cure = "limit and shear_yield follow from other keys; remove it"
                yield f"fatigue.{body}.{key}: not used, as {cure}"


def _creepage_without_friction(scene: Any) -> Iterator[str]:
    """Yield a note for creepages without friction."""
    if scene.friction is not None:
        return
    used = {"speed"} if scene.body.relaxes else set()
    if nonzero := [k for k, value in scene.creepage.settings().items() if value and k not in used]:
        keys = ", ".join(f"creepage.{key}" for key in nonzero)
        yield f"{keys}: without [friction] there is no traction; add friction.mu"


def _replaced_motion(scene: Any) -> Iterator[str]:
    """Yield notes on creepages that are 0, and on a pitch that is not used, as others are given."""
    if scene.wheelset is None or scene.wheel_rail.is_motion(scene.creepage):
        return
    motion = dict(zip(("longitudinal", "lateral", "spin"), scene.wheel_rail.creepages, strict=True))
    given = scene.creepage.entries()
    zero = {key: value for key, value in motion.items() if key not in given}
    if zero and len(zero) < len(motion):
        keys = ", ".join(f"creepage.{key}" for key in motion if key in given)
        values = ", ".join(f"creepage.{key} = {value:.4g}" for key, value in zero.items())
        yield (
            f"{keys}: [creepage] replaces all creepages due to the motion of the wheelset, so that "
            f"{' and '.join(zero)} {'is' if len(zero) == 1 else 'are'} 0, and wheelset.pitch is "
            f"not used; if this is not meant, add those of the motion ({values}), or give none"
        )
    elif not zero and "pitch" in scene.wheelset.entries():
        yield "wheelset.pitch: not used, as [creepage] replaces the motion; remove one of them"
