"""Plausible ranges of what a scene gives and of what is computed, and the note beyond each.

The table `RULES` holds the ranges, each with the reason of its bounds. A note says what is
doubtful, where, what is probably meant, and what to do. The scene is computed as given.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .readings import (
    Pair,
    Peak,
    Reading,
    read_computed_pressure,
    read_computed_pressure_of_metals,
    read_creepages,
    read_densities,
    read_friction,
    read_hertz_pressure,
    read_moduli,
    read_pressure_of_metals,
    read_radii,
    read_shakedown_ratio,
    read_wear_coefficients,
    read_wear_rate,
    read_width_ratios,
    read_widths,
)

if TYPE_CHECKING:
    from .scene import Scene


@dataclass(frozen=True)
class Rule:
    """A range of implausible values: more than `above` and less than `below`.

    Attributes
    ----------
    name : str
        Name of the rule.
    subject : str
        What it reads: "bodies" and "contact" a `Pair`, "scene" a `Scene`, "result" a `Peak`.
    read : callable
        Yields the readings of a subject.
    note : str
        Format of the note after the key, with ``value``, ``above``, ``below`` and the details.
    reason : str
        Why the bounds are where they are.
    needs : str
        Dotted key of a scene without which there is nothing to read; empty if none.
    above, below : float
        The bounds; both are plausible.
    """

    name: str
    subject: str
    read: Callable[[Any], Iterator[Reading]]
    note: str
    reason: str
    needs: str = ""
    above: float = -math.inf
    below: float = math.inf

    def notes(self, subject: Any) -> Iterator[tuple[str, str]]:
        """Yield the key and the note of each implausible value."""
        if not self.needs or subject.has(self.needs):
            yield from self.judge(self.read(subject))

    def judge(self, readings: Iterable[Reading]) -> Iterator[tuple[str, str]]:
        """Yield the key and the note of each implausible reading."""
        for reading in readings:
            if self.above < reading.value < self.below:
                known = {"above": self.above, "below": self.below, **reading.details}
                yield reading.key, self.note.format(value=reading.value, **known)


_STEEL = "Steel has 2.1e5 MPa"

RULES = (
    Rule(
        "modulus in GPa",
        "bodies",
        read_moduli(0.0, 0.45),
        "E = {value:g} MPa is that of a soft plastic; in GPa? " + _STEEL,
        "metals and ceramics have 30 to 1000 GPa; rubber, with a Poisson's ratio of 0.45 or more, "
        "may have as many MPa",
        above=np.nextafter(30.0, 0.0),
        below=np.nextafter(1000.0, np.inf),
    ),
    Rule(
        "modulus beyond any material",
        "bodies",
        read_moduli(0.0, np.inf),
        "E = {value:g} MPa is beyond any material; in Pa? " + _STEEL,
        "diamond has 1.2e6 MPa; above 2e12, diamond in Pa with a margin, a rigid body is meant",
        above=2e6,
        below=np.nextafter(2e12, np.inf),
    ),
    Rule(
        "radius in m",
        "bodies",
        read_radii,
        "{given:g} mm is less than {below:g} mm; in m? {given:g} m is {mm:g} mm",
        "balls of the smallest bearings have 0.1 mm; wheels and discs in m have 0.005 to 1",
        below=0.1,
    ),
    Rule(
        "density in g/cm3",
        "bodies",
        read_densities,
        "{value:g} kg/m3 is less than any solid body has; in g/cm3 or t/m3? Steel has 7850 "
        "kg/m3. The worn mass is in proportion to it",
        "balsa has 100 kg/m3, and osmium 22.6 g/cm3",
        below=100.0,
    ),
    Rule(
        "high pressure",
        "contact",
        read_hertz_pressure,
        "p0 = {value:.4g} MPa by Hertz, and no material withstands {above:g} MPa; units are "
        "mm, N and MPa",
        "hardened steel has a hardness of 8000 MPa; ceramics yield at about 10000",
        above=1e4,
    ),
    Rule(
        "low pressure",
        "contact",
        read_pressure_of_metals,
        "p0 = {value:.3g} MPa by Hertz is too little for metals that roll, which carry 100 "
        "to 5000 MPa; {meant}",
        "at 10 MPa the contact of metals is less than 1e-4 of the radius, and roughness carries "
        "it; a load of kN given in N is 10 times too low in p0, a pressure of GPa 1000 times",
        below=10.0,
    ),
    Rule(
        "computed high pressure",
        "result",
        read_computed_pressure,
        "{value:.4g} MPa{place}, and no material withstands {above:g} MPa: it would yield. Heights "
        "of a gap in another unit, or peaks as sharp as an element, do that; look at p_95, and "
        "check [gap], [load] and the radii",
        "the bounds are those of the pressure by Hertz",
        above=1e4,
    ),
    Rule(
        "computed low pressure",
        "result",
        read_computed_pressure_of_metals,
        "{value:.3g} MPa{place} is too little for metals that roll, which carry 100 to 5000 MPa; "
        "check the units of [load] (N, MPa, mm) and of the radii (mm)",
        "the bounds are those of the pressure by Hertz",
        below=10.0,
    ),
    Rule(
        "contact near an edge",
        "scene",
        read_widths,
        "the contact is {width:.3g} mm wide and body {name} {body:g} mm; its edges are not "
        "modelled, and pressure rises there",
        "an edge is then as near as a quarter of a half width",
        above=0.8,
    ),
    Rule(
        "no shakedown",
        "scene",
        read_shakedown_ratio,
        "p0 = {p0:.4g} MPa is {value:.3g} times the yield stress in shear, and above "
        "{above:g} nothing shakes down: material flows in every pass, and elastic stress is not "
        "what it sees",
        "a circular contact without friction shakes down up to 4.7, a line up to 4",
        needs="fatigue.shear_yield_stress",
        above=4.7,
    ),
    Rule(
        "creepage in per cent",
        "scene",
        read_creepages,
        "{given:g} is {percent:g} %; 1 % is 0.01",
        "beyond 0.1 bodies slide rather than roll; 1 is one body at rest",
        above=0.1,
    ),
    Rule(
        "friction in per cent",
        "scene",
        read_friction,
        "{value:g} is more than surfaces have; in per cent?",
        "rubber on a dry road, and cold welds, have up to 2",
        needs="friction",
        above=2.0,
    ),
    Rule(
        "fast wear",
        "scene",
        read_wear_rate,
        "i = {i:g} /MPa, k = {k:g} mm3/(N m), is a thousand times what is usual of dry "
        "steel; wear.coefficient is in mm3/(N m), wear.intensity in 1/MPa",
        "wear intensity times E*: a thousand times that of dry steel, of k = 2e-5 mm3/(N m)",
        needs="wear",
        above=2.0,
    ),
    Rule(
        "slow wear",
        "scene",
        read_wear_coefficients,
        "k = {value:g} mm3/(N m){given} is less than anything wears; in m2/N or "
        "m3/(N m)? 1e-13 m2/N is 1e-4 mm3/(N m), which is 1e-7 /MPa",
        "diamond-like carbon in oil wears by 1e-10 mm3/(N m); dry steel in m2/N has 1e-15 to 1e-12",
        needs="wear",
        above=0.0,
        below=1e-10,
    ),
)
"""The plausible ranges, with the reason of each."""


def _judge(subject: str, of: Any) -> Iterator[tuple[str, str]]:
    """Yield the key and the note of each implausible value of a subject."""
    for rule in RULES:
        if rule.subject == subject:
            yield from rule.notes(of)


def pair_notes(pair: Pair) -> Iterator[str]:
    """Yield a note for each entry of the bodies, and for a load, that is implausible."""
    for subject in ("bodies", "contact"):
        yield from (f"{key}: {note}" for key, note in _judge(subject, pair))


def near_edge(scene: Scene, width: float) -> Iterator[str]:
    """Yield a note for each body that is hardly wider than a contact of a width, mm."""
    (rule,) = (rule for rule in RULES if rule.read is read_widths)
    yield from (note for _, note in rule.judge(read_width_ratios(scene, width)))


def pressure_notes(scene: Scene, pressure: float, place: str = "") -> Iterator[str]:
    """Yield a note if the largest pressure that was computed is implausible.

    It yields nothing where the scene already has a note about its pressure by Hertz.

    Parameters
    ----------
    scene : Scene
        What was computed.
    pressure : float
        The largest pressure of all its contacts, MPa.
    place : str
        Where that is, to follow the number.
    """
    if not any(_judge("contact", Pair.from_scene(scene))):
        peak = Peak(pressure, place, scene.materials)
        yield from (note for _, note in _judge("result", peak))


def scene_notes(scene: Scene) -> Iterator[str]:
    """Yield a note for each entry that is implausible, with what may be meant."""
    yield from pair_notes(Pair.from_scene(scene))
    yield from (f"{key}: {note}" for key, note in _judge("scene", scene))
    yield from _unused_entries(scene)
    yield from _creepage_without_friction(scene)


def _unused_entries(scene: Scene) -> Iterator[str]:
    for key, course in scene.schedule.courses.items():
        table, _, name = key.partition(".")
        given = getattr(scene, table).entries().get(name)
        if (table == "creepage" or name.startswith("force")) and given not in (None, course[0]):
            yield f"{given:g} is not used, transient.{key} stands for it; leave it out"


def _creepage_without_friction(scene: Scene) -> Iterator[str]:
    if scene.friction is not None:
        return
    if moved := [key for key, value in scene.creepage.settings().items() if value]:
        keys = ", ".join(f"creepage.{key}" for key in moved)
        yield f"{keys}: without [friction] there is no traction; friction.mu gives it"
