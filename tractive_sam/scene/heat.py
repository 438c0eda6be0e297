"""The [heat] table, and what the bodies conduct heat by."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar

from tractive_sam.schema import Check, Fault, Positive, Real, Row, Table, ValidEntries, entry

ABSOLUTE_ZERO = -273.15

_DEGREES = f"a number from {ABSOLUTE_ZERO}"

LIKE_STEEL = (180e3, 230e3)
"""Young's moduli, MPa, of bodies that are taken for steel where nothing else is said."""


class Thermal(Table):
    """What a body conducts heat by.

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
        """Conductivity over density and heat capacity, mm2/s."""
        return 1e6 * self.conductivity / (self.density * self.heat_capacity)


STEEL = Thermal(conductivity=50.0, heat_capacity=450.0)


class Bulk(Table):
    """Temperature of each body far from the contact.

    Examples
    --------
    >>> ts.Bulk(A=80.0, B=20.0).A
    80.0
    """

    A: Real = entry("bulk temperature of body A, degrees C", _DEGREES, 20.0, ge=ABSOLUTE_ZERO)
    B: Real = entry("bulk temperature of body B, degrees C", _DEGREES, 20.0, ge=ABSOLUTE_ZERO)


def _bulk_is_warm_enough(entries: ValidEntries) -> Iterator[Fault]:
    bulk = entries["bulk"]
    if not isinstance(bulk, Bulk) and bulk < ABSOLUTE_ZERO:
        yield Fault("bulk", f"{bulk:g}", f"at least {ABSOLUTE_ZERO}, in degrees C")


class Heat(Table):
    """Flash temperature of the contact; needs `creepage.speed`.

    Examples
    --------
    >>> ts.Heat(bulk=60.0).bulks
    {'A': 60.0, 'B': 60.0}
    """

    bulk: Real | Bulk = entry(
        "bulk temperature, degrees C, of both bodies or of each",
        f"{_DEGREES}, or {{ A = ..., B = ... }}",
        20.0,
    )
    checks: ClassVar[tuple[Check, ...]] = (_bulk_is_warm_enough,)
    effect: ClassVar[str] = "heat"

    def describe(self, scene: Any) -> Iterator[Row]:
        """See `Table.describe`."""
        bodies, bulk = scene.thermal, self.bulks
        for name, thermal in bodies.items():
            given = "" if getattr(scene.body, name).thermal else " (steel, not given)"
            yield Row(
                f"body {name}",
                f"{thermal.conductivity:g} W/(m K), {thermal.diffusivity:.4g} mm2/s{given}, bulk "
                f"{bulk[name]:g} degC",
            )
        equal = bodies["A"] == bodies["B"] and bulk["A"] == bulk["B"]
        shared = "half to each body" if equal else "by equal temperatures in contact"
        yield Row("shared", shared)
        factors = scene.friction and scene.friction.temperature
        coupled = "contact and temperature in turn" if factors else "no: the contact is solved once"
        yield Row("friction depends on it", coupled)

    @property
    def bulks(self) -> dict[str, float]:
        """Bulk temperature of each body, degrees C."""
        bulk = self.bulk
        return {"A": bulk.A, "B": bulk.B} if isinstance(bulk, Bulk) else dict.fromkeys("AB", bulk)


def _thermal_of_both(entries: ValidEntries) -> Iterator[Fault]:
    given = [body for body in "AB" if entries[f"body.{body}.thermal"] is not None]
    if len(given) == 1:
        (other,) = set("AB") - set(given)
        cure = f"those of both bodies, or of none: that of {given[0]} is given"
        yield Fault(f"body.{other}.thermal", "nothing", cure)


def _heat_needs_speed(entries: ValidEntries) -> Iterator[Fault]:
    if entries["heat"] is not None and entries["creepage.speed"] is None:
        cure = "the rolling speed V, mm/s: [heat] is made by sliding, and carried away by rolling"
        yield Fault("creepage.speed", "nothing", cure)


def _heat_is_conducted(entries: ValidEntries) -> Iterator[Fault]:
    if entries["heat"] is None:
        return
    for body in "AB":
        one = entries[f"body.{body}"]
        E = one.material.young
        if one.thermal is None and not LIKE_STEEL[0] <= E <= LIKE_STEEL[1]:
            cure = (
                "conductivity, density and heat_capacity; steel's are taken only of a Young's "
                f"modulus from {LIKE_STEEL[0]:g} to {LIKE_STEEL[1]:g} MPa, and it is {E:g}"
            )
            yield Fault(f"body.{body}.thermal", "nothing", cure)


def _temperature_needs_heat(entries: ValidEntries) -> Iterator[Fault]:
    answering = [
        f"{table}.temperature"
        for table in ("friction", "wear")
        if entries[table] is not None and entries[f"{table}.temperature"] is not None
    ]
    if entries["heat"] is None:
        cure = "only with a [heat] table, which gives the temperature"
        yield from (Fault(key, "without [heat]", cure) for key in answering)
    if "wear.temperature" in answering and entries["solver.method"] == "uzawa":
        cure = "another solver.method: this one wears before the temperature is known"
        yield Fault("wear.temperature", 'with solver.method = "uzawa"', cure)


def _heat_of_transients(entries: ValidEntries) -> Iterator[Fault]:
    """Refuse shifts, which take no time, and laws that a step does not take the temperature of."""
    transient = entries["transient"]
    if transient is None or entries["heat"] is None:
        return
    if not transient.rolls:
        cure = '"rest" or "steady": a shift takes no time, and how warm surfaces get depends on it'
        yield Fault("transient.start", '"shift" together with [heat]', cure)
    for table in ("friction", "wear"):
        if entries[table] is not None and entries[f"{table}.temperature"] is not None:
            cure = "nothing: temperatures of a transient are computed, but do not act on its steps"
            yield Fault(f"{table}.temperature", "together with [transient]", cure)


HEAT_CHECKS: tuple[Check, ...] = (
    _thermal_of_both,
    _heat_needs_speed,
    _heat_is_conducted,
    _temperature_needs_heat,
    _heat_of_transients,
)
"""What [heat] asks of the other tables."""
