"""The two bodies, the [heat] table, and the [fatigue] table: strength of their material."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Literal, get_args

from pydantic import AfterValidator, Field

from tractive_sam.mechanics import (
    AnisotropicMaterial,
    CombinedMaterial,
    HertzContact,
    HertzLine,
    LayeredBody,
    Material,
    RelaxingBody,
    SurfaceResponse,
    TransverseMaterial,
    combine,
    combined_radius,
    contact_modulus,
    hertz,
    hertz_line,
)
from tractive_sam.schema import (
    Check,
    Fault,
    InnerTable,
    LawTable,
    NamedLaw,
    NotNegative,
    Positive,
    Radius,
    Real,
    Row,
    Table,
    ValidEntries,
    describe_law_names,
    entry,
    not_both,
    optional,
    shorten,
)

from .layers import (
    BodyLayer,
    Relaxation,
    Stiffness,
    anisotropic_contact,
    check_constants,
    check_layers,
    check_relaxation,
    describe_parts,
    isotropic_material,
    layered_contact,
    relaxing,
)
from .roller import RollerProfile, describe_rollers
from .steel import Strength, check_strength_of_bodies, find_surface_strength
from .tables import Load, check_distinct

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
        "crown": "radius_y, the radius across the track, profile of a roller, or [gap]",
        "hardness_depth": "[fatigue.A] or [fatigue.B] with depth and hardness; body.A.hardness is "
        "for the wear law",
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
        """Elastic constants or layers, of a body that relaxes with its terms."""
        return relaxing(self.elastic, self.relaxation)

    @property
    def elastic(self) -> SurfaceResponse:
        """Elastic constants of a homogeneous body, also of one with equal layers, or the layers."""
        if self.stiffness is not None:
            return self.stiffness.material
        layers = [layer.layer for layer in self.layer]
        while layers and layers[-1].material == self.material and not any(layers[-1].compliance):
            layers.pop()
        return LayeredBody(tuple(layers), self.material) if layers else self.material


def _check_hardness_of_both(entries: ValidEntries) -> Iterator[Fault]:
    """Report the hardness of one body only."""
    bodies = [body for body in "AB" if f"{body}.hardness" in entries.given]
    if len(bodies) == 1:
        (missing,) = set("AB") - set(bodies)
        cure = "a hardness for both bodies or for none: their ratio gives the shares in the wear"
        hardness = entries[f"{bodies[0]}.hardness"]  # if valid; otherwise it has its own fault
        yield Fault(f"{missing}.hardness", f"nothing, and {hardness:g} for body {bodies[0]}", cure)


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
    checks: ClassVar[tuple[Check, ...]] = (_check_hardness_of_both,)

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield report rows: moduli and radii of each body, combined modulus and radii."""
        for name, body in (("A", self.A), ("B", self.B)):
            material, other = body.material, body.elastic
            radii = f", R_x = {body.radius_x:g} mm, R_y = {body.radius_y:g} mm"
            text = f"E = {material.young:g} MPa, nu = {material.poisson:g}"
            if isinstance(other, (TransverseMaterial, AnisotropicMaterial)):
                modulus = 2.0 / other.compliances[0]
                tangential = f"G = {material.shear:.6g} MPa, nu = {material.poisson:.4g}"
                text = f"E* = {modulus:.6g} MPa for pressure, {tangential} for traction"
                if isinstance(other, AnisotropicMaterial):
                    text += ", means over the directions in the surface"
            yield Row(f"body {name}", text if scene.wheelset else text + radii, brief=True)
            for label, text in describe_parts(body.layer, body.response):
                yield Row(f"{label} of {name}", text, brief=True)
        if any(body.layer for body in (self.A, self.B)):
            text = "in steps" if scene.has("wear.layer_step") else "not at all"
            yield Row("layers", f"thinned by wear {text}; heat flows as in the body below")
        if self.is_layered and (contact := scene.hertz) is not None:
            modulus = self.contact_modulus(contact.mean_semi_axis, scene.creepage.speed)
            text = f"E* = {modulus:.6g} MPa for waves as long as the contact"
            yield Row("equivalent modulus", f"{text}; mesh, units and a follow from it")
        yield from describe_rollers(self, scene)
        pair, (radius_x, radius_y) = self.material, self.radii
        if self.is_isotropic:
            yield Row("combined modulus", f"E* = {pair.E_star:.6g} MPa, nu = {pair.poisson:.4g}")
        elif not self.is_layered:
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
        """Whether the response of a body depends on the length of the contact."""
        lengthy = LayeredBody, RelaxingBody
        return any(isinstance(body, lengthy) for body in self.responses.values())

    @property
    def relaxes(self) -> bool:
        """Whether a body relaxes."""
        return any(isinstance(body, RelaxingBody) for body in self.responses.values())

    @property
    def is_anisotropic(self) -> bool:
        """Whether a body responds differently to waves of different direction."""
        return any(isinstance(body, AnisotropicMaterial) for body in self.responses.values())

    @property
    def is_isotropic(self) -> bool:
        """Whether both bodies are homogeneous and isotropic."""
        return all(isinstance(body, Material) for body in self.responses.values())

    @property
    def responses(self) -> dict[str, SurfaceResponse]:
        """Elastic constants or layers of each body."""
        return {"A": self.A.response, "B": self.B.response}

    @property
    def coupled(self) -> bool:
        """Whether the bodies are dissimilar or anisotropic, so that pressure may move them."""
        if self.is_isotropic:
            return self.material.coupling != 0.0
        return len(set(self.responses.values())) == 2 or self.is_anisotropic

    def contact_modulus(self, length: float, speed: float | None = None) -> float:
        """Return the contact modulus E*, MPa; of layers for waves as long as a contact, mm.

        Bodies that relax have that at the rolling speed, mm/s, or without it that at rest.
        """
        if self.is_isotropic:
            return self.material.plane_strain_modulus
        return contact_modulus(self.A.response, self.B.response, length, speed or 0.0)

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
    def rollers(self) -> list[Body]:
        """Bodies that have a profile or ends."""
        return [body for body in (self.A, self.B) if body.profile is not None or body.ends]

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
        if self.is_layered or self.is_anisotropic:
            items, each = tuple(prescribed.items()), (self.A.response, self.B.response)
            return (
                layered_contact(*each, self.radii, items, speed or 0.0)
                if self.is_layered
                else anisotropic_contact(*each, self.radii, items)
            )
        e_star = self.contact_modulus(1.0)  # of all lengths
        if is_line:
            return hertz_line(e_star, radius_x, load.normal, pressure=load.pressure)
        return hertz(e_star, radius_x, radius_y, **prescribed)

    def normal_load(self, load: Load) -> float | None:
        """Return the normal load, N or N/mm, set or from a pressure; None for an approach."""
        if load.pressure is None:
            return load.normal
        contact = self.hertz(load)
        return None if contact is None else contact.load


_MAX_EXPONENT = 100.0
"""Exponent of a Wöhler curve for which 1 % of the stress changes the life by a factor of e."""


def _check_table_has_purpose(entries: ValidEntries) -> Iterator[Fault]:
    """Report a table with neither a yield stress nor a limit."""
    if not entries.given & {"shear_yield", "yield_strength", "limit", "A", "B"}:
        cure = "[fatigue] shear_yield or yield_strength (shakedown), limit (utilisation), in MPa"
        yield Fault("limit", "nothing, and no yield stress", cure)


def _check_sensitivity(entries: ValidEntries) -> Iterator[Fault]:
    """Report a sensitivity that is missing, too large or unused by the fatigue criterion."""
    # Upper bound and definition of the sensitivity, for each criterion with a sensitivity. At the
    # bounds of the first two the fatigue limit in torsion equals that in bending.
    sensitivities = {
        "dang-van": (1.5, "3 (tau_e/sigma_e - 1/2), torsion and bending limits"),
        "crossland": (3.0 - math.sqrt(3.0), "3 tau_e/sigma_e - sqrt 3, torsion, bending limits"),
        "findley": (10.0, "k, sigma_e/tau_e = 2 / (1 + k/sqrt(1 + k²)), bending, torsion limits"),
        "fatemi-socie": (10.0, "k"),
    }
    criterion, value = entries["criterion"], entries["sensitivity"]
    if isinstance(criterion, NamedLaw):
        return
    if criterion not in sensitivities:
        if value is not None:
            yield Fault("sensitivity", shorten(value), f'nothing: "{criterion}" has no sensitivity')
        return
    upper, meaning = sensitivities[criterion]
    allowed = f'from 0 to below {upper:.4g} for "{criterion}" ({meaning})'
    if value is None:
        if entries["limit"] is not None:
            yield Fault("sensitivity", "nothing", allowed)
    elif value >= upper:
        yield Fault("sensitivity", shorten(value), allowed)


def _check_yield_of_criterion(entries: ValidEntries) -> Iterator[Fault]:
    """Report a missing yield stress that "fatemi-socie" needs, if a fatigue limit is set."""
    if entries["criterion"] != "fatemi-socie" or entries["limit"] is None:
        return
    has_yield = entries.given & {"shear_yield", "yield_strength"}
    if not has_yield and find_surface_strength(entries, "shear_yield") is None:
        yield Fault("yield_strength", "nothing", 'a number above 0, which "fatemi-socie" needs')


class FatigueVolume(Table):
    """Fatigue life of the stressed volume, with a Weibull slope.

    The law is that of Lundberg and Palmgren or, with a stress limit, the law of Ioannides and
    Harris; see `ts.VolumeLife`.

    Examples
    --------
    >>> ts.FatigueVolume(constant=1e-34).survival
    0.9
    """

    constant: float | None = optional(
        "material constant A, in N, mm and cycles; without this key, no life is computed",
        ge=1e-100,
        le=1e100,
    )
    survival: float = entry(
        "survival probability of the complete volume", default=0.9, gt=0.0, lt=1.0
    )
    slope: Positive | None = optional(
        "Weibull slope; the default is 10/9, or 9/8 for a line contact"
    )
    limit: NotNegative = entry("stress below which there is no damage, MPa", default=0.0)
    stress_exponent: Positive = entry(
        "exponent of the stress", default=31.0 / 3.0, le=_MAX_EXPONENT
    )
    depth_exponent: NotNegative = entry("exponent of the depth", default=7.0 / 3.0, le=10.0)


def _check_limit_is_given(entries: ValidEntries) -> Iterator[Fault]:
    """Report a user-defined criterion, or [fatigue.volume], without the limit of the criterion."""
    if entries["limit"] is not None:
        return
    if isinstance(entries["criterion"], NamedLaw):
        yield Fault("limit", "nothing", f"a number above 0, which {entries['criterion']} needs")
    if entries["volume"] is not None:
        cure = "a number above 0: [fatigue.volume] needs the utilisation of the criterion"
        yield Fault("limit", "nothing", cure)


CriterionName = Literal["dang-van", "crossland", "findley", "fatemi-socie", "orthogonal-shear"]


class Fatigue(LawTable):
    """Shakedown limits, fatigue criterion, life, and damage during wear.

    The shakedown limits follow from a yield stress. The utilisation follows from the fatigue limit
    of the criterion, and the damage from the utilisation and a Wöhler curve. The stress is
    computed for elastic material.

    The parameters of a criterion of another package are further keys. If the criterion has a
    parameter `yield_stress` (in tension), it receives the value from the scene.

    Examples
    --------
    >>> steel = ts.Fatigue(shear_yield=300.0, sensitivity=0.333, limit=250.0)
    >>> steel.criterion, round(steel.yield_stress, 1)
    ('dang-van', 519.6)
    """

    shear_yield: Positive | None = optional("yield stress in shear k, MPa")
    yield_strength: Positive | None = optional("yield stress in tension, sqrt 3 k, MPa")
    criterion: CriterionName | NamedLaw = entry(
        "fatigue criterion", describe_law_names(get_args(CriterionName)), "dang-van"
    )
    sensitivity: NotNegative | None = optional(
        "sensitivity of the criterion to normal stress: a for Dang Van and Crossland, k for "
        "Findley and Fatemi-Socie",
        "a number of at least 0; the upper bound depends on the criterion",
    )
    A: InnerTable[Strength | None] = optional("strength of body A over the depth")
    B: InnerTable[Strength | None] = optional("strength of body B over the depth")
    limit: Positive | None = Field(
        title="fatigue limit of the criterion, MPa; the utilisation is the equivalent stress "
        "divided by this limit, or by the limit over the depth in [fatigue.A] and [fatigue.B]; by "
        "default, the latter at the surface",
        default_factory=lambda entries: find_surface_strength(entries, "limit"),
    )
    cycles: Positive = entry("number of cycles to failure at a utilisation of 1", default=1e7)
    exponent: Positive = entry(
        "exponent of the Wöhler curve, life = cycles * utilisation ** -exponent",
        default=10.0,
        le=_MAX_EXPONENT,
    )
    knee: bool = entry("whether life is infinite below a utilisation of 1", default=False)
    depth: Positive = entry("depth, in units of the semi-axis a", default=1.5)
    elements: int = entry("number of points along the depth", default=24, ge=8, le=10**4)
    bodies: Annotated[tuple[Literal["A", "B"], ...], AfterValidator(check_distinct)] = entry(
        "bodies for which fatigue is computed", default=("A", "B"), min_length=1
    )
    volume: InnerTable[FatigueVolume | None] = optional("life of the stressed volume")
    tolerance: float = entry(
        "error of the damage, divided by the largest damage; a jump is shortened if its error "
        "exceeds 0.3 times this tolerance; the column damage_error contains the total error",
        default=1e-2,
        ge=1e-6,
        le=1.0,
    )
    law_key: ClassVar[str] = "criterion"
    law_names: ClassVar[tuple[str, ...]] = get_args(CriterionName)
    law_fields: ClassVar[tuple[str, ...]] = ("sensitivity",)
    checks: ClassVar[tuple[Check, ...]] = (
        not_both("shear_yield", "yield_strength"),
        _check_table_has_purpose,
        _check_sensitivity,
        _check_yield_of_criterion,
        _check_limit_is_given,
        check_strength_of_bodies,
    )

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield report rows: bodies, shakedown limits, life and depths of the fatigue analysis."""
        k, hertz = self.shear_yield_stress, scene.hertz
        shakedown = "left out: neither shear_yield nor yield_strength is given"
        if k is not None:
            bounds = "certain by Melan (rho_xx and rho_yy), impossible by Koiter"
            shakedown = f"k = {k:.6g} MPa: {bounds}"
        yield Row("bodies", ", ".join(self.bodies))
        yield Row("shakedown", shakedown)
        if k is not None and hertz is not None:
            ratio = f"{hertz.p0 / k:.3g} unworn; shakedown limit of a frictionless line contact: 4"
            yield Row("p0/k", ratio)
        if self.limit is None:
            yield Row("utilisation and damage", "left out: limit is not given")
        else:
            life = f"{self.cycles:g} cycles at {self.limit:g} MPa, to the power -{self.exponent:g}"
            yield Row("life", f"{life}, infinite below" if self.knee else life)
        yield Row(
            "depths",
            f"{self.elements} down to {self.depth:g} a; between the surface and the depth of one "
            "element the stress changes with the square root of the depth",
        )
        plastic = "yielding above the shakedown limit is not modelled"
        yield Row("stress", f"elastic: {plastic}")
        missing = ["bending"]
        missing += ["residual stress from manufacture"] if scene.residual is None else []
        missing += [] if self.A or self.B else ["hardness over the depth"]
        yield Row("not included", ", ".join(missing))
        for body in self.bodies:
            if getattr(self, body) is not None:
                units = {"hardness": "HV", "limit": "MPa", "shear_yield": "MPa"}
                curves = {name: scene.steel[body].curves.get(name) for name in units}
                parts = [
                    f"{name.replace('_', ' ')} {curve[1][0]:.4g} at the surface, "
                    f"{curve[1][-1]:.4g} {units[name]} at {curve[0][-1]:.4g} mm"
                    for name, curve in curves.items()
                    if curve is not None
                ]
                yield Row(f"strength of body {body}", "; ".join(parts))

    @property
    def yield_stress(self) -> float | None:
        """Yield stress in tension, MPa, as set or sqrt(3) times k; None if neither is set.

        If it is set over the depth only, the value at the surface.
        """
        if self.yield_strength is not None:
            return self.yield_strength
        k = self.shear_yield or find_surface_strength(vars(self), "shear_yield")
        return None if k is None else math.sqrt(3.0) * k

    @property
    def shear_yield_stress(self) -> float | None:
        """Yield stress in shear k, MPa, as set or from tension over sqrt(3); None without both."""
        return None if self.yield_stress is None else self.yield_stress / math.sqrt(3.0)
