"""The [heat] table, and the thermal properties of the bodies."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar

from tractive_sam.schema import Check, Fault, Positive, Real, Row, Table, ValidEntries, entry

ABSOLUTE_ZERO = -273.15


class Thermal(Table):
    """Thermal properties of a body: conductivity, density and heat capacity.

    Examples
    --------
    >>> round(ts.Thermal(conductivity=50.0, density=7850.0, heat_capacity=450.0).diffusivity, 2)
    14.15
    """

    conductivity: Positive = entry("heat conductivity, W/(m K)")
    density: Positive = entry("density, kg/m3", default=7850.0)
    heat_capacity: Positive = entry("heat capacity, J/(kg K)")

    @property
    def diffusivity(self) -> float:
        """Thermal diffusivity, conductivity over density and heat capacity, mm2/s."""
        return 1e6 * self.conductivity / (self.density * self.heat_capacity)


STEEL = Thermal(conductivity=50.0, heat_capacity=450.0)


class Bulk(Table):
    """Bulk temperature of each body, far from the contact.

    Examples
    --------
    >>> ts.Bulk(A=80.0, B=20.0).A
    80.0
    """

    A: Real = entry("bulk temperature of body A, degrees C", default=20.0, ge=ABSOLUTE_ZERO)
    B: Real = entry("bulk temperature of body B, degrees C", default=20.0, ge=ABSOLUTE_ZERO)


def _check_bulk(entries: ValidEntries) -> Iterator[Fault]:
    """Report a bulk temperature below absolute zero."""
    bulk = entries["bulk"]
    if not isinstance(bulk, Bulk) and bulk < ABSOLUTE_ZERO:
        yield Fault("bulk", f"{bulk:g}", f"at least {ABSOLUTE_ZERO}, in degrees C")


class Heat(Table):
    """Flash temperature of the contact above bulk temperatures; needs `creepage.speed`.

    Examples
    --------
    >>> ts.Heat(bulk=60.0).bulks
    {'A': 60.0, 'B': 60.0}
    """

    bulk: Real | Bulk = entry(
        "bulk temperature, degrees C, for both bodies together or for each body",
        f"a number of at least {ABSOLUTE_ZERO}, or {{ A = ..., B = ... }}",
        20.0,
    )
    checks: ClassVar[tuple[Check, ...]] = (_check_bulk,)
    effect: ClassVar[str] = "heat"

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield report rows: thermal properties, the share of heat of each body, and coupling."""
        bodies, bulk = scene.thermal, self.bulks
        for name, thermal in bodies.items():
            origin = "" if getattr(scene.body, name).thermal else " (steel, by default)"
            yield Row(
                f"body {name}",
                f"{thermal.conductivity:g} W/(m K), {thermal.diffusivity:.4g} mm2/s{origin}, bulk "
                f"{bulk[name]:g} degC",
            )
        equal = bodies["A"] == bodies["B"] and bulk["A"] == bulk["B"]
        share = "half of the heat" if equal else "from equal surface temperatures in contact"
        yield Row("share of each body", share)
        factors = scene.friction and scene.friction.temperature
        coupled = "yes, iterated" if factors else "no: the contact is solved once"
        yield Row("friction depends on temperature", coupled)

    @property
    def bulks(self) -> dict[str, float]:
        """Bulk temperature of each body, degrees C."""
        bulk = self.bulk
        return {"A": bulk.A, "B": bulk.B} if isinstance(bulk, Bulk) else dict.fromkeys("AB", bulk)


def _check_thermal_of_both(entries: ValidEntries) -> Iterator[Fault]:
    """Report thermal properties of one body only."""
    with_table = [body for body in "AB" if entries[f"body.{body}.thermal"] is not None]
    if len(with_table) == 1:
        (missing,) = set("AB") - set(with_table)
        cure = f"a table for both bodies or for none; body {with_table[0]} has one"
        yield Fault(f"body.{missing}.thermal", "nothing", cure)


def _check_heat_has_speed(entries: ValidEntries) -> Iterator[Fault]:
    """Report [heat] without the rolling speed."""
    if entries["heat"] is not None and entries["creepage.speed"] is None:
        cure = "rolling speed V, mm/s, which [heat] needs"
        yield Fault("creepage.speed", "nothing", cure)


def _check_thermal_is_present(
    entries: ValidEntries, steel: tuple[float, float] = (180e3, 230e3)
) -> Iterator[Fault]:
    """Report missing thermal properties of a body that is not steel.

    Parameters
    ----------
    entries : ValidEntries
        Entries of the scene.
    steel : tuple of float
        Range of Young's modulus, MPa, in which the default is steel.
    """
    if entries["heat"] is None:
        return
    for name in "AB":
        body = entries[f"body.{name}"]
        E = body.material.young
        if body.thermal is None and not steel[0] <= E <= steel[1]:
            cure = (
                "conductivity, density and heat_capacity; the default, steel, needs a Young's "
                f"modulus from {steel[0]:g} to {steel[1]:g} MPa, and the body has {E:g} MPa"
            )
            yield Fault(f"body.{name}.thermal", "nothing", cure)


def _check_temperature_has_heat(entries: ValidEntries) -> Iterator[Fault]:
    """Report laws with temperature but without [heat], and wear with temperature under "uzawa"."""
    keys = [
        f"{table}.temperature"
        for table in ("friction", "wear")
        if entries[table] is not None and entries[f"{table}.temperature"] is not None
    ]
    if entries["heat"] is None:
        cure = "a [heat] table, which gives the temperature"
        yield from (Fault(key, "without [heat]", cure) for key in keys)
    if "wear.temperature" in keys and entries["solver.method"] == "uzawa":
        cure = 'solver.method = "auto", "newton" or "anderson"'
        yield Fault("wear.temperature", 'with solver.method = "uzawa"', cure)


def _check_heat_of_transient(entries: ValidEntries) -> Iterator[Fault]:
    """Report [heat] with shifts, which take no time, and laws of a transient with temperature."""
    transient = entries["transient"]
    if transient is None or entries["heat"] is None:
        return
    for key in transient.shift_keys:
        cure = "stages that roll: temperature depends on time, and a shift takes no time"
        yield Fault(key, '"shift" with [heat]', cure)
    for table in ("friction", "wear"):
        if entries[table] is not None and entries[f"{table}.temperature"] is not None:
            cure = "nothing: in a transient the laws do not depend on the temperature"
            yield Fault(f"{table}.temperature", "with [transient]", cure)


HEAT_CHECKS: tuple[Check, ...] = (
    _check_thermal_of_both,
    _check_heat_has_speed,
    _check_thermal_is_present,
    _check_temperature_has_heat,
    _check_heat_of_transient,
)
"""Checks between [heat] and the other tables."""
