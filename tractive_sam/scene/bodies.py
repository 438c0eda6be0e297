"""The two bodies, and the [heat] table."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import Any, ClassVar, Literal

from tractive_sam.mechanics import (
    CombinedMaterial,
    ContactPatch,
    Elasticity,
    FlatPatch,
    HalfSpaces,
    HertzContact,
    HertzLine,
    LinearHalfSpaces,
    Material,
    Strips,
    SurfaceResponse,
    combine,
    combined_radius,
    hertz,
    hertz_line,
    pair,
)
from tractive_sam.schema import (
    Check,
    Fault,
    InnerTable,
    Positive,
    Radius,
    Real,
    Row,
    Table,
    ValidEntries,
    entry,
    optional,
)

from .layers import (
    BodyLayer,
    BodyPart,
    Relaxation,
    Stiffness,
    check_constants,
    check_layers,
    check_relaxation,
    isotropic_material,
)
from .roller import RollerProfile, describe_rollers, find_ends
from .tables import Load

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
        if scene.body.relaxes:
            yield Row("heat of relaxation", "inside the bodies, not in the flash temperature")

    @property
    def bulks(self) -> dict[str, float]:
        """Bulk temperature of each body, degrees C."""
        bulk = self.bulk
        return {"A": bulk.A, "B": bulk.B} if isinstance(bulk, Bulk) else dict.fromkeys("AB", bulk)


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
    keys = [f"{table}.temperature" for table in ("friction", "wear")]
    keys = [key for key in keys if entries.get(key) is not None]
    if entries["heat"] is None:
        cure = "a [heat] table, which gives the temperature"
        yield from (Fault(key, "without [heat]", cure) for key in keys)
    if "wear.temperature" in keys and entries["solver.method"] == "uzawa":
        cure = 'solver.method = "auto", "newton" or "anderson"'
        yield Fault("wear.temperature", 'with solver.method = "uzawa"', cure)


def _check_heat_of_transient(entries: ValidEntries) -> Iterator[Fault]:
    """Report [heat] with shifts, which take no time."""
    transient = entries["transient"]
    if transient is None or entries["heat"] is None:
        return
    for key in transient.shift_keys:
        cure = "stages that roll: temperature depends on time, and a shift takes no time"
        yield Fault(key, '"shift" with [heat]', cure)


HEAT_CHECKS: tuple[Check, ...] = (
    _check_thermal_is_present,
    _check_temperature_has_heat,
    _check_heat_of_transient,
)
"""Checks between [heat] and the other tables."""


class Body(Table):
    """Body: elastic constants, radii of curvature, hardness, density and thermal properties.

    Examples
    --------
    >>> steel = ts.Body(young=208e3, poisson=0.3, radius_x=32.5, radius_y=32.5)
    >>> steel.radius_x
    32.5
    """

    key_advice: ClassVar[Mapping[str, str]] = {
        "tilt": "load.tilt, for rollers, or [gap] with heights that rise across the track",
        "diameter": "radius_x, half of the diameter, mm",
        "crown": "radius_y, the radius across the track, profile of a roller, or [gap]",
        "hardness_depth": "depth and hardness in [fatigue.A]; body.A.hardness is for the wear law",
    }
    young: Positive | None = optional("Young's modulus, MPa")
    shear: Positive | None = optional("shear modulus, MPa")
    poisson: Real | None = optional("Poisson's ratio", ge=0, le=0.5)
    stiffness: InnerTable[Stiffness | None] = optional(
        "stiffness of an anisotropic material, in place of a modulus and Poisson's ratio"
    )
    radius_x: Radius = entry("radius in the rolling direction, mm", "a number, or inf (flat)")
    radius_y: Radius = entry("radius in the lateral direction, mm", "a number, or inf (flat)")
    hardness: Positive = entry(
        "hardness, for both bodies or for none, in any unit (for the wear law jendel, in MPa); "
        "the bodies wear in inverse proportion to it",
        default=1.0,
    )
    width: Positive | None = optional(
        "lateral width, mm, centred at y = 0; without ends, its edges are not modelled, but a note "
        "is printed if the contact is near an edge"
    )
    ends: Literal["free", "quick"] | None = optional(
        'ends of a body of this width: "free", without traction, or "quick", by a factor on mirror '
        "images of the pressure; without it, material beyond the ends counts as half-space"
    )
    profile: InnerTable[RollerProfile | None] = optional(
        "profile of a roller across the track: a table, the name of a form, or a text file with "
        "the columns y and depth"
    )
    density: Positive = entry(
        "density, kg/m3, for the worn mass; the default is for steel", default=7850.0
    )
    thermal: InnerTable[Thermal | None] = optional("thermal properties")
    layer: tuple[BodyLayer, ...] = entry(
        "layers from the surface down, to the body",
        "at least one layer, [[body.A.layer]]",
        (),
        min_length=1,
        max_length=100,
    )
    relaxation: tuple[Relaxation, ...] = entry(
        "terms by which the body with all its layers relaxes; young is the modulus at once",
        "at least one term, [[body.A.relaxation]]",
        (),
        min_length=1,
        max_length=100,
    )
    parts: ClassVar[Mapping[str, type[BodyPart]]] = {
        "stiffness": Stiffness,
        "layer": BodyLayer,
        "relaxation": Relaxation,
    }
    """Kinds of parts that change the response, in their order, by key."""
    checks: ClassVar[tuple[Check, ...]] = (check_constants, check_layers, check_relaxation)

    @property
    def shape(self) -> RollerProfile:
        """Profile of a roller; straight without one."""
        return self.profile or RollerProfile(form="points", y=(-1.0, 0.0, 1.0), depth=(0.0,) * 3)

    @property
    def material(self) -> Material:
        """Elastic constants of the body, below its layers; of [stiffness] the tangential ones."""
        if self.stiffness is not None:
            return self.stiffness.material.tangential
        return isotropic_material(self.young, self.shear, self.poisson)

    @property
    def response(self) -> SurfaceResponse:
        """Response of the body with all its parts; that of its material without any."""
        return [self.material, *self._responses.values()][-1]

    @property
    def kinds(self) -> dict[str, Mapping[str, str]]:
        """Keys that make the body more than isotropic and homogeneous, and what they exclude."""
        kinds = {key: self.parts[key].excludes for key in self._responses}
        return kinds | ({} if self.ends is None else {"ends": RollerProfile.excluded_by_ends})

    @property
    def _responses(self) -> dict[str, SurfaceResponse]:
        """Response of the body with each of its parts that change it, from below, by key."""
        body: SurfaceResponse = self.material
        responses = {}
        for key, kind in self.parts.items():
            if (changed := kind.change(self.given(key), body)) != body:
                responses[key] = body = changed
        return responses

    def given(self, key: str) -> tuple[Any, ...]:
        """Return the tables of a part, none, one or several."""
        value = getattr(self, key)
        return value if isinstance(value, tuple) else (value,) if value is not None else ()


def _check_keys_of_both(entries: ValidEntries) -> Iterator[Fault]:
    """Report a hardness or thermal properties of one body only."""
    reasons = {
        "hardness": "their ratio gives the shares in the wear",
        "thermal": "without it both are of steel",
    }
    for key, reason in reasons.items():
        bodies = [body for body in "AB" if f"{body}.{key}" in entries.given]
        if len(bodies) == 1:
            _ = entries[f"{bodies[0]}.{key}"]  # if it is not valid, it has its own fault
            (missing,) = set("AB") - set(bodies)
            cure = f"a value for both bodies or for none: {reason}"
            yield Fault(f"{missing}.{key}", f"nothing, but body {bodies[0]} has it", cure)


def _check_laws_combine(entries: ValidEntries) -> Iterator[Fault]:
    """Report bodies that need different elastic laws."""
    try:
        pair(entries["A"].response, entries["B"].response)
    except ValueError as error:
        keys = [f"{name}.{key}" for name in "AB" for key in entries[name].kinds]
        yield Fault(", ".join(keys), "together", str(error))


class Bodies(Table):
    """Upper body A and the lower body B.

    Examples
    --------
    >>> ball = ts.Body(young=208e3, poisson=0.3, radius_x=10.0, radius_y=10.0)
    >>> plate = ts.Body(young=70e3, poisson=0.33, radius_x=float("inf"), radius_y=float("inf"))
    >>> pair = ts.Bodies(A=ball, B=plate)
    >>> round(pair.material.E_star)
    58462
    """

    A: InnerTable[Body] = entry("the upper body")
    B: InnerTable[Body] = entry("the lower body")
    checks: ClassVar[tuple[Check, ...]] = (_check_keys_of_both, _check_laws_combine)

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield report rows: moduli and radii of each body, combined modulus and radii."""
        for name, body in (("A", self.A), ("B", self.B)):
            material = body.material
            radii = f", R_x = {body.radius_x:g} mm, R_y = {body.radius_y:g} mm"
            text = f"E = {material.young:g} MPa, nu = {material.poisson:g}"
            text = text if body.stiffness is None else body.stiffness.describe_moduli()
            yield Row(f"body {name}", text if scene.wheelset else text + radii, brief=True)
            for key, kind in body.parts.items():
                for label, text in kind.describe_part(body.given(key), body.response):
                    yield Row(f"{label} of {name}", text, brief=True)
        if any(body.layer for body in (self.A, self.B)):
            text = "thinned" if scene.has("wear.layer_step") else "not thinned"
            yield Row("layers", f"{text} by wear; heat flows as in the body below")
        if self.depends_on_length and (contact := scene.hertz) is not None:
            modulus = self.contact_modulus(contact.mean_semi_axis, scene.creepage.speed)
            text = f"E* = {modulus:.6g} MPa for waves as long as the contact"
            yield Row("equivalent modulus", f"{text}; mesh, units and a follow from it")
        yield from describe_rollers(self, scene)
        both, (radius_x, radius_y) = self.material, self.radii
        if self.is_isotropic:
            yield Row("combined modulus", f"E* = {both.E_star:.6g} MPa, nu = {both.poisson:.4g}")
        elif not self.depends_on_length:
            modulus = self.contact_modulus(1.0)
            yield Row("combined modulus", f"E* = {modulus:.6g} MPa for pressure")
        if scene.wheelset is None:
            yield Row("combined radii", f"R_x = {radius_x:.6g} mm, R_y = {radius_y:.6g} mm")

    @property
    def materials(self) -> dict[str, Material]:
        """Elastic constants of each body."""
        return {"A": self.A.material, "B": self.B.material}

    @property
    def material(self) -> CombinedMaterial:
        """Combined elastic constants of the pair of bodies."""
        return combine(self.A.material, self.B.material)

    @property
    def is_layered(self) -> bool:
        """Whether a body has layers."""
        return any("layer" in body.kinds for body in (self.A, self.B))

    @property
    def depends_on_length(self) -> bool:
        """Whether the response of a body depends on the length of the contact."""
        return self.half_spaces().reach > 0.0

    @property
    def relaxes(self) -> bool:
        """Whether a body relaxes."""
        return any(body.relaxes for body in self.responses.values())

    @property
    def is_isotropic(self) -> bool:
        """Whether both bodies are homogeneous and isotropic."""
        return all(body.is_isotropic for body in self.responses.values())

    @property
    def responses(self) -> dict[str, SurfaceResponse]:
        """Elastic constants or layers of each body."""
        return {"A": self.A.response, "B": self.B.response}

    def half_spaces(
        self, datum: float | None = None, speed: float | None = None
    ) -> LinearHalfSpaces:
        """Return the elastic law by the responses of both bodies, also of isotropic ones.

        Parameters
        ----------
        datum : float, optional
            For line contacts, see `Strips`.
        speed : float, optional
            Rolling speed, mm/s; without it bodies that relax are at rest.
        """
        return pair(self.A.response, self.B.response, datum).at_speed(speed)

    def patch(self, scene: Any) -> ContactPatch:
        """Return the geometry and motion of the patch in the tangent plane of both bodies."""
        return FlatPatch(*self.radii)

    def elasticity(self, scene: Any) -> Elasticity:
        """Return the elastic law of both bodies in a scene."""
        radius = self.radii[0]
        # Flat bodies have no radius: `Strips.spanning` sets the datum by the mesh.
        datum = radius if 0.0 < radius < math.inf else 0.0
        if self.has_ends:
            return find_ends(self, datum)
        if self.is_isotropic:
            return (
                Strips(**self.materials, datum=datum)
                if scene.line
                else HalfSpaces(**self.materials)
            )
        return self.half_spaces(datum if scene.line else None, scene.creepage.speed)

    def contact_modulus(self, length: float, speed: float | None = None) -> float:
        """Return the contact modulus E*, MPa; of layers for waves as long as a contact, mm.

        Bodies that relax have that at the rolling speed, mm/s, or without it that at rest.
        """
        if self.is_isotropic:
            return self.material.plane_strain_modulus
        return self.half_spaces(speed=speed).contact_modulus(length)

    @property
    def radii(self) -> tuple[float, float]:
        """Combined radii in x and in y, mm: inf for flat bodies, negative for conforming ones."""
        return (
            combined_radius(self.A.radius_x, self.B.radius_x),
            combined_radius(self.A.radius_y, self.B.radius_y),
        )

    @property
    def wear_share(self) -> dict[str, float]:
        """Share of each body in the wear depth, inverse to its hardness (paper, eq. 34)."""
        total = self.A.hardness + self.B.hardness
        return {"A": self.B.hardness / total, "B": self.A.hardness / total}

    @property
    def has_roller(self) -> bool:
        """Whether a body has a profile or ends."""
        return bool(self.rollers)

    @property
    def rollers(self) -> dict[str, Body]:
        """Bodies that have a profile or ends."""
        bodies = {"A": self.A, "B": self.B}
        return {name: body for name, body in bodies.items() if body.profile or body.ends}

    @property
    def has_ends(self) -> bool:
        """Whether a body has ends that are modelled."""
        return self.A.ends is not None or self.B.ends is not None

    @property
    def infinitely_long(self) -> bool:
        """Whether both bodies have ``radius_y = inf``: a line contact without a gap over y."""
        return self.A.radius_y == self.B.radius_y == math.inf

    def hertz(self, load: Load, speed: float | None = None) -> HertzContact | HertzLine | None:
        """Return the Hertz contact under a load; None if radii or approach close no contact.

        Infinitely long bodies have a line contact under a load per length. That of anisotropic
        bodies is exact; the half axes are half lengths along x and y. The contact of bodies
        with layers is that of homogeneous bodies with their `contact_modulus`: an estimate.
        """
        radius_x, radius_y = self.radii
        if not 0 < radius_x < math.inf:
            return None
        is_line = self.infinitely_long and load.approach is None
        if not is_line and not 0 < radius_y < math.inf:
            return None  # without a [gap] there is no contact
        if load.approach is not None and load.approach <= 0:
            return None
        prescribed = {"load": load.normal, "approach": load.approach, "pressure": load.pressure}
        if not self.is_isotropic:
            return _find_hertz(self.half_spaces(speed=speed), self.radii, *prescribed.values())
        e_star = self.contact_modulus(1.0)
        if is_line:
            return hertz_line(e_star, radius_x, load.normal, pressure=load.pressure)
        return hertz(e_star, radius_x, radius_y, **prescribed)

    def normal_load(self, load: Load) -> float | None:
        """Return the normal load, N or N/mm, set or from a pressure; None for an approach."""
        if load.pressure is None:
            return load.normal
        contact = self.hertz(load)
        return None if contact is None else contact.load


@lru_cache(64)
def _find_hertz(
    law: LinearHalfSpaces, radii: tuple[float, float], load: Any, approach: Any, pressure: Any
) -> HertzContact | HertzLine:
    """Return the Hertz contact of a law; the last ones are stored."""
    return law.hertz(*radii, load=load, approach=approach, pressure=pressure)
