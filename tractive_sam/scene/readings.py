"""Values of a scene and of a result that have a plausible range."""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tractive_sam.mechanics import HertzContact, HertzLine, Material

from .bodies import Bodies
from .tables import Load
from .wear_laws import PER_INTENSITY


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


def read_moduli(lower: float, upper: float) -> Callable[[Pair], Iterator[Reading]]:
    """Return a function that yields Young's moduli of bodies with a Poisson's ratio in a range.

    Parameters
    ----------
    lower, upper : float
        Range of Poisson's ratio; the upper bound is excluded.
    """

    def read(pair: Pair) -> Iterator[Reading]:
        for name, material in pair.bodies.materials.items():
            if lower <= material.poisson < upper:
                yield Reading(f"body.{name}", material.young)

    return read


def read_densities(pair: Pair) -> Iterator[Reading]:
    """Yield the densities of the bodies, kg/m3."""
    for name, body in (("A", pair.bodies.A), ("B", pair.bodies.B)):
        yield Reading(f"body.{name}.density", body.density)


def read_radii(pair: Pair) -> Iterator[Reading]:
    """Yield the magnitudes of radius_x and radius_y of both bodies, mm."""
    for name, body in (("A", pair.bodies.A), ("B", pair.bodies.B)):
        for key in ("radius_x", "radius_y"):
            value = getattr(body, key)
            yield Reading(f"body.{name}.{key}", abs(value), {"given": value, "mm": 1e3 * value})


def read_hertz_pressure(pair: Pair) -> Iterator[Reading]:
    """Yield the peak pressure according to Hertz, MPa."""
    if pair.hertz is not None:
        yield Reading(pair.key, pair.hertz.p0)


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


def read_computed_pressure(peak: Peak) -> Iterator[Reading]:
    """Yield the largest pressure of a solved contact, MPa, with its position."""
    yield Reading("p_max", peak.pressure, {"place": peak.place})


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


def read_friction(scene: Any) -> Iterator[Reading]:
    """Yield the larger of the friction coefficients mu1 and mu2."""
    yield Reading("friction.mu", max(scene.friction.mu))


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
        if body.width is not None:
            details = {"width": width, "name": name, "body": body.width}
            yield Reading("body", width / body.width, details)


def read_contact_angles(scene: Any) -> Iterator[Reading]:
    """Yield the largest range of the contact angle over a patch of a wheel, degrees."""
    angle = max(patch.angle_range for patch in scene.wheel_rail.patches)
    yield Reading("wheelset", math.degrees(angle))
