"""Parts of a body that change its response: stiffness, layers and relaxation."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any, ClassVar, Literal, Self, cast

import numpy as np

from tractive_sam.mechanics import (
    AnisotropicMaterial,
    Layer,
    LayeredBody,
    Material,
    RelaxingBody,
    SurfaceResponse,
    TransverseMaterial,
    Woehler,
    creep_terms,
    limit_from_bending,
    strength_from_hardness,
)
from tractive_sam.schema import (
    Check,
    Fault,
    NotNegative,
    Positive,
    Real,
    Table,
    ValidEntries,
    entry,
    exactly_one,
    optional,
    required,
    shorten,
)


class BodyPart(Table):
    """Base class of tables of a body that change its response; `Body.parts` lists them."""

    excludes: ClassVar[dict[str, str]] = {
        "elasticity.law": "a user-defined law gives the response of both bodies",
        "wheel": "the contacts of a wheel are found for homogeneous, isotropic bodies",
        "conformal": "the response of a curved patch is that of homogeneous, isotropic bodies",
        "body.ends": "ends are those of homogeneous, isotropic bodies",
    }
    internal: ClassVar[frozenset[str]] = frozenset(("change", "describe_part"))

    @classmethod
    def change(cls, parts: Sequence[Self], body: SurfaceResponse) -> SurfaceResponse:
        """Return the response of a body with these parts; an equal one if they change nothing."""
        raise NotImplementedError

    @classmethod
    def describe_part(
        cls, parts: Sequence[Self], body: SurfaceResponse
    ) -> Iterator[tuple[str, str]]:
        """Yield labels and texts of report rows for these parts and the response with them."""
        yield from ()


def _complete_stiffness(entries: Mapping[str, Any]) -> np.ndarray:
    """Return the stiffness (6, 6) by the constants of a class of symmetry, MPa."""
    C = {name: value for name, value in entries.items() if name[0] == "C" and value is not None}
    if entries.get("crystal") is not None:
        C11, C12, C44, _ = Stiffness.crystals[entries["crystal"]]
        C = {"C11": 1e3 * C11, "C12": 1e3 * C12, "C44": 1e3 * C44}
    if "C33" not in C:
        C |= {"C33": C["C11"], "C13": C["C12"], "C66": C["C44"]}
    if "C22" not in C:
        plane = 0.5 * (C["C11"] - C["C12"])
        C = {"C66": plane} | C | {"C22": C["C11"], "C23": C["C13"], "C55": C["C44"]}
    matrix = np.zeros((6, 6))
    for name, value in C.items():
        i, j = int(name[1]) - 1, int(name[2]) - 1
        matrix[i, j] = matrix[j, i] = value
    return matrix


def _check_constants_of_class(entries: ValidEntries) -> Iterator[Fault]:
    """Report constants that are missing or do not belong to a class of symmetry."""
    given = {name for name in entries.given if name[0] == "C"}
    if entries["crystal"] is not None:
        yield from (
            Fault(k, f"with crystal = {entries['crystal']}", "one of them") for k in sorted(given)
        )
        return
    symmetric = {"C11", "C12", "C13", "C33", "C44"}
    needed, kind = symmetric | {"C22", "C23", "C55", "C66"}, "without an axis of such symmetry"
    if given <= {"C11", "C12", "C44"}:
        needed, kind = {"C11", "C12", "C44"}, "with cubic symmetry"
    elif given <= symmetric | {"C66"}:
        needed, kind = symmetric, "with a sixfold or fourfold axis 3"
    for name in sorted(needed - given):
        yield Fault(name, "nothing", f"a number: a material {kind} needs {sorted(needed)}")


def _check_stiffness(entries: ValidEntries) -> Iterator[Fault]:
    """Report a stiffness that no stable material has, or whose response is not resolved."""
    entries.require(("crystal", *(k for k in entries.given if k[0] == "C")))
    if any(_check_constants_of_class(entries)) or any(_check_orientation(entries)):
        return
    C = _complete_stiffness(entries)
    for i, j in zip(*np.triu_indices(6), strict=True):
        name = f"C{i + 1}{j + 1}"
        bound = math.sqrt(max(0.0, C[i, i] * C[j, j]))
        if (i == j and C[i, i] <= 0.0) or (i != j and abs(C[i, j]) >= bound > 0.0):
            cure = "a positive number" if i == j else f"a magnitude below {bound:.4g}"
            yield Fault(name, f"{C[i, j]:g}", f"{cure}, as the elastic energy is positive")
            return
    if np.linalg.eigvalsh(C)[0] <= 1e-12 * C.max():
        name, largest = "C12", "smaller"
        if "C13" in entries.given:
            name = "C13"
            if C[0, 0] + C[0, 1] > 0.0 and C[0, 2] == C[1, 2]:
                largest = f"a magnitude below {math.sqrt(0.5 * C[2, 2] * (C[0, 0] + C[0, 1])):.4g}"
        cure = f"{largest}: the constants together give no positive elastic energy"
        yield Fault(name, f"{entries[name]:g}", cure)
        return
    try:
        _ = _find_material(entries).compliances
    except ValueError as error:
        yield Fault("C11", f"{C[0, 0]:g}", f"constants that differ less: {error}")


def _check_orientation(entries: ValidEntries) -> Iterator[Fault]:
    """Report directions that are missing, zero or not at right angles, and angles beside them."""
    normal, along = entries["normal"], entries["along"]
    angles = sorted(entries.given & {"phi1", "Phi", "phi2"})
    for key, other in (("normal", "along"), ("along", "normal")):
        if entries[key] is None:
            if entries[other] is not None:
                yield Fault(key, "nothing", f"the direction of both axes: {other} is given")
            continue
        yield from (
            Fault(angle, f"with {key}", "angles or directions, not both") for angle in angles
        )
        if not any(entries[key]):
            yield Fault(key, "[0, 0, 0]", "a direction")
            return
    if normal is not None and along is not None:
        cosine = np.dot(normal, along) / math.hypot(*normal) / math.hypot(*along)
        if abs(cosine) > 1e-6:
            angle = math.degrees(math.acos(max(-1.0, min(1.0, cosine))))
            yield Fault("along", f"{list(along)}, at {angle:.4g} degrees to normal", "90 degrees")


def _find_material(entries: Any) -> TransverseMaterial | AnisotropicMaterial:
    """Return the material of a table with valid constants, with its axes turned."""
    C, rotation = _complete_stiffness(entries), None
    if entries["normal"] is not None:
        z, x = (np.array(entries[key]) / math.hypot(*entries[key]) for key in ("normal", "along"))
        rotation = np.stack((x, np.cross(z, x), z))
    elif any(entries[key] for key in ("phi1", "Phi", "phi2")):
        rotation = np.eye(3)
        for key, (i, j) in (("phi1", (0, 1)), ("Phi", (1, 2)), ("phi2", (0, 1))):
            cos, sin = (f(math.radians(entries[key])) for f in (math.cos, math.sin))
            turn = np.eye(3)
            turn[[i, i, j, j], [i, j, i, j]] = cos, -sin, sin, cos
            rotation = rotation @ turn
    material = AnisotropicMaterial.from_matrix(C, rotation)
    C = np.array(material.stiffness)
    names = zip(("C11", "C12", "C13", "C33", "C44"), (0, 0, 0, 2, 3), (0, 1, 2, 2, 3), strict=True)
    five = {name: float(C[i, j]) for name, i, j in names}
    like = _complete_stiffness(five)
    if np.abs(C - like).max() <= 1e-12 * C.max():  # isotropic in the surface: in closed form
        return TransverseMaterial(**five)
    return material


_stored_material = lru_cache(64)(lambda entries: _find_material(dict(entries)))
"""The material of a table by its entries."""


def isotropic_material(young: float | None, shear: float | None, poisson: float | None) -> Material:
    """Return isotropic elastic constants from Poisson's ratio and one of both moduli, MPa."""
    nu = required(poisson, "poisson")
    if young is not None:
        return Material.from_young(young, nu)
    return Material(required(shear, "shear"), nu)


class Stiffness(BodyPart):
    """Elastic stiffness of an anisotropic material, and its axes.

    The constants that are given state the class of symmetry: C11, C12, C44 of a cubic crystal; C11,
    C12, C13, C33, C44 of a material that is isotropic across its axis 3, with C66 of a fourfold
    axis; nine of an orthotropic material; up to 21 of any other. Without angles and directions, the
    axes 1, 2, 3 are x, y, z.

    Examples
    --------
    >>> zinc = ts.Stiffness(C11=165e3, C12=31.1e3, C13=50e3, C33=61.8e3, C44=39.6e3)
    >>> round(zinc.material.tangential.poisson, 4)
    0.0947
    >>> turned = ts.Stiffness(crystal="iron", normal=(1, 1, 1), along=(1, -1, 0))
    >>> round(2.0 / turned.material.compliances[0])
    232514
    """

    crystals: ClassVar[Mapping[str, tuple[float, float, float, str]]] = {
        "aluminium": (106.75, 60.41, 28.34, "CRC Handbook, 98th ed."),
        "copper": (168.3, 121.2, 75.7, "Epstein & Carlson (1965), in CRC Handbook"),
        "gold": (192.44, 162.98, 42.0, "CRC Handbook, 98th ed."),
        "iron": (226.0, 140.0, 116.0, "CRC Handbook, 98th ed."),
        "nickel": (248.1, 154.9, 124.2, "CRC Handbook, 98th ed."),
        "silicon": (165.7, 63.9, 79.6, "Hopcroft, Nix & Kenny, J. MEMS 19 (2010) 229-238"),
        "tungsten": (522.39, 204.37, 160.58, "Lowrie & Gonas (1967), in CRC Handbook"),
    }
    """C11, C12 and C44 of cubic crystals at room temperature, GPa, and their source."""
    crystal: (
        Literal["aluminium", "copper", "gold", "iron", "nickel", "silicon", "tungsten"] | None
    ) = optional("cubic crystal with known constants, in place of the constants")
    C11: Real | None = optional("stiffness C11, MPa")
    C12: Real | None = optional("stiffness C12, MPa")
    C13: Real | None = optional("stiffness C13, MPa; of a cubic crystal C12")
    C14: Real | None = optional("stiffness C14, MPa; 0 by default")
    C15: Real | None = optional("stiffness C15, MPa; 0 by default")
    C16: Real | None = optional("stiffness C16, MPa; 0 by default")
    C22: Real | None = optional("stiffness C22, MPa; C11 if the axis 3 is one of symmetry")
    C23: Real | None = optional("stiffness C23, MPa; C13 if the axis 3 is one of symmetry")
    C24: Real | None = optional("stiffness C24, MPa; 0 by default")
    C25: Real | None = optional("stiffness C25, MPa; 0 by default")
    C26: Real | None = optional("stiffness C26, MPa; 0 by default")
    C33: Real | None = optional("stiffness C33, MPa; of a cubic crystal C11")
    C34: Real | None = optional("stiffness C34, MPa; 0 by default")
    C35: Real | None = optional("stiffness C35, MPa; 0 by default")
    C36: Real | None = optional("stiffness C36, MPa; 0 by default")
    C44: Real | None = optional("stiffness C44, shear of the axes 2 and 3, MPa")
    C45: Real | None = optional("stiffness C45, MPa; 0 by default")
    C46: Real | None = optional("stiffness C46, MPa; 0 by default")
    C55: Real | None = optional("stiffness C55, shear of 1 and 3, MPa; C44 by symmetry")
    C56: Real | None = optional("stiffness C56, MPa; 0 by default")
    C66: Real | None = optional("stiffness C66, shear of 1 and 2, MPa; (C11 - C12)/2 by symmetry")
    normal: tuple[Real, Real, Real] | None = optional(
        "direction of z in the axes 1, 2, 3, any length"
    )
    along: tuple[Real, Real, Real] | None = optional(
        "direction of x in the axes 1, 2, 3, at right angles to z"
    )
    phi1: Real = entry("first Euler angle (Bunge), about z, degrees", default=0.0)
    Phi: Real = entry("second Euler angle, about the turned x, degrees", default=0.0)
    phi2: Real = entry("third Euler angle, about the axis 3, degrees", default=0.0)
    checks: ClassVar[tuple[Check, ...]] = (
        _check_constants_of_class,
        _check_orientation,
        _check_stiffness,
    )

    @property
    def material(self) -> TransverseMaterial | AnisotropicMaterial:
        """The material in the axes of the contact; in closed form if isotropic in the surface."""
        return _stored_material(tuple(vars(self).items()))

    @classmethod
    def change(cls, parts: Sequence[Self], body: SurfaceResponse) -> SurfaceResponse:
        """Return the anisotropic material (`BodyPart.change`)."""
        return parts[0].material if parts else body

    def describe_moduli(self) -> str:
        """Return a text with the modulus for pressure and the constants for tractions."""
        material, like = self.material, self.material.tangential
        text = f"E* = {2.0 / material.compliances[0]:.6g} MPa for pressure, G = {like.shear:.6g} "
        text += f"MPa, nu = {like.poisson:.4g} for traction"
        if isinstance(material, AnisotropicMaterial):
            text += ", means over the directions in the surface"
        return text


class BodyLayer(BodyPart):
    """Layer of a body on the layer or body below: a coating, a case, a rubber cover.

    Examples
    --------
    >>> carbon = ts.BodyLayer(thickness=0.003, young=300e3, poisson=0.2)
    >>> round(carbon.material.shear)
    125000
    """

    key_advice: ClassVar[Mapping[str, str]] = {
        "hardness": "hardness of the body, which wears",
        "thermal": "thermal of the body: heat flows as in the body below",
        "compliance": "shear_compliance and normal_compliance",
    }
    excludes = BodyPart.excludes | {
        "load.pressure": "the Hertz pressure is that of homogeneous bodies: load.normal or "
        "load.approach"
    }
    thickness: Positive = entry("thickness, mm")
    young: Positive | None = optional("Young's modulus, MPa")
    shear: Positive | None = optional("shear modulus, MPa")
    poisson: Real = entry("Poisson's ratio", ge=0, le=0.5)
    gradient: Literal["none", "exponential"] = entry(
        "change of the shear modulus over the depth: the same everywhere (none), or an exponential "
        "from that of the layer at its upper face to that of what lies below",
        default="none",
    )
    shear_compliance: NotNegative = entry(
        "compliance in shear of the interface below, mm/MPa: its jump of displacement over its "
        "traction; 0 if bonded",
        default=0.0,
    )
    normal_compliance: NotNegative = entry(
        "compliance of the interface below along its normal, mm/MPa; 0 if bonded", default=0.0
    )
    checks: ClassVar[tuple[Check, ...]] = (exactly_one("young", "shear"),)

    @property
    def layer(self) -> Layer:
        """The layer as part of an elastic law."""
        compliance = self.shear_compliance, self.normal_compliance
        return Layer(self.thickness, self.material, self.gradient, compliance)

    @property
    def material(self) -> Material:
        """Elastic constants of the layer, at its upper face."""
        return isotropic_material(self.young, self.shear, self.poisson)

    @classmethod
    def change(cls, parts: Sequence[Self], body: SurfaceResponse) -> SurfaceResponse:
        """Return the body with layers, without lower ones that equal it (`BodyPart.change`)."""
        layers = [part.layer for part in parts]
        while layers and layers[-1].material == body and not any(layers[-1].compliance):
            layers.pop()
        return LayeredBody(tuple(layers), cast(Material, body)) if layers else body

    @classmethod
    def describe_part(
        cls, parts: Sequence[Self], body: SurfaceResponse
    ) -> Iterator[tuple[str, str]]:
        """Yield a label and a text for each layer."""
        for k, part in enumerate(parts):
            moduli = f"E = {part.material.young:g} MPa, nu = {part.poisson:g}"
            moduli += ", graded" if part.gradient != "none" else ""
            if any(compliance := part.layer.compliance):
                springs = " and ".join(f"{value:g}" for value in compliance)
                moduli += f", on springs with {springs} mm/MPa in shear and along the normal"
            yield f"layer {k}", f"{part.thickness:g} mm, {moduli}"


def check_layers(
    entries: ValidEntries, moduli: float = 1e4, thicknesses: float = 1e4
) -> Iterator[Fault]:
    """Report layers that differ too much for the response to be resolved.

    Parameters
    ----------
    entries : ValidEntries
        Entries of a body.
    moduli, thicknesses : float
        Largest ratios of Young's moduli of layers and body, and of thicknesses.
    """
    layers = entries["layer"]
    if not layers or entries["stiffness"] is not None or entries["poisson"] is None:
        return
    young = entries["young"]
    if young is None and entries["shear"] is not None:
        young = 2.0 * entries["shear"] * (1.0 + entries["poisson"])
    if young is None:
        return
    for k, layer in enumerate(layers):
        ratio = layer.material.young / young
        if not 1.0 / moduli <= ratio <= moduli:
            key = "young" if layer.young is not None else "shear"
            value = f"{getattr(layer, key):g}, {ratio:.3g} times the body's"
            cure = f"a modulus from {1 / moduli:g} to {moduli:g} times that of the body below"
            yield Fault(f"layer[{k}].{key}", value, cure)
            return
    thickness = [layer.thickness for layer in layers]
    if max(thickness) > thicknesses * min(thickness):
        k = thickness.index(min(thickness))
        cure = f"at least {max(thickness) / thicknesses:g} mm, a share of the thickest layer"
        yield Fault(f"layer[{k}].thickness", f"{thickness[k]:g}", cure)
        return
    try:
        _ = BodyLayer.change(layers, Material.from_young(young, entries["poisson"])).images
    except ValueError:
        cure = "moduli that differ less, or fewer layers: the response is not resolved"
        yield Fault("layer", f"{len(layers)} layers", cure)


def layered_body(scene: Any, body: str) -> LayeredBody:
    """Return the elastic layers of a body, also those with the constants of the body below."""
    table = getattr(scene.body, body)
    return LayeredBody(tuple(layer.layer for layer in table.layer), table.material)


def find_strengths(
    given: Mapping[str, np.ndarray], inclusion: float | None, criterion: Any, sensitivity: Any
) -> dict[str, np.ndarray]:
    """Return hardness, limit and shear_yield by name, without unknown ones.

    Parameters
    ----------
    given : mapping
        Those that are given, by name; the others follow from the hardness.
    inclusion : float or None
        Square root of the area of the largest inclusion, micrometres.
    criterion, sensitivity
        See `Strength.find_curves`.
    """
    found = dict(given)
    if "hardness" not in found:
        return found
    strength, bending = strength_from_hardness(found["hardness"], inclusion)
    found.setdefault("shear_yield", strength / math.sqrt(3.0))
    has_rule = sensitivity is not None or criterion == "orthogonal-shear"
    if "limit" not in found and has_rule and isinstance(criterion, str):
        strength = math.sqrt(3.0) * found["shear_yield"]
        found["limit"] = limit_from_bending(criterion, sensitivity, bending, strength)
    return found


def _check_layer_strength(entries: ValidEntries) -> Iterator[Fault]:
    """Report a layer with two sources of its strength, with none, or with inclusions alone."""
    strengths = [key for key in ("limit", "shear_yield") if key in entries.given]
    if "hardness" in entries.given and strengths:
        cure = f"hardness or {' and '.join(strengths)}, not both"
        yield Fault("hardness", f"with {' and '.join(strengths)}", cure)
    elif "hardness" not in entries.given and not strengths:
        yield Fault("limit", "nothing", "limit or shear_yield, MPa, or hardness, HV, of the layer")
    if "inclusion" in entries.given and "hardness" not in entries.given:
        yield Fault("inclusion", shorten(entries["inclusion"]), "only with hardness")


class LayerStrength(Table):
    """Strength and life of one layer of a body, `[[body.A.layer]]` with the same place.

    Examples
    --------
    >>> ts.LayerStrength(limit=25.0, exponent=6.0).limit
    25.0
    """

    key_advice: ClassVar[Mapping[str, str]] = {
        "thickness": "thickness in [[body.A.layer]]",
        "depth": "thickness in [[body.A.layer]]: the strength is constant in a layer",
        "sensitivity": "fatigue.sensitivity, which is common to all layers",
        "criterion": "fatigue.criterion, which is common to all layers",
        "yield_strength": "shear_yield, the yield stress in tension over sqrt 3",
    }
    internal: ClassVar[frozenset[str]] = frozenset(("describe_strength", "find_life"))
    strengths: ClassVar[tuple[str, ...]] = ("limit", "shear_yield")
    hardest_without_inclusions: ClassVar[float] = 400.0
    """Vickers hardness up to which the fatigue limit does not depend on inclusions."""
    limit: Positive | None = optional("fatigue limit of the criterion, MPa", le=1e5)
    shear_yield: Positive | None = optional("yield stress in shear k, MPa", le=1e5)
    hardness: Real | None = optional(
        "Vickers hardness of a layer of steel, HV, from which limit and shear_yield follow",
        ge=80.0,
        le=1500.0,
    )
    inclusion: Positive | None = optional(
        "square root of the area of the largest inclusion, micrometres; needed above 400 HV"
    )
    cycles: Positive | None = optional(
        "number of cycles to failure at a utilisation of 1; by default that of [fatigue]"
    )
    exponent: Positive | None = optional(
        "exponent of the Wöhler curve; by default that of [fatigue]", le=100.0
    )
    knee: bool | None = optional(
        "whether life is infinite below a utilisation of 1; by default as in [fatigue]"
    )
    checks: ClassVar[tuple[Check, ...]] = (_check_layer_strength,)

    def find_values(self, criterion: Any, sensitivity: float | None) -> dict[str, float]:
        """Return limit and shear_yield by name, MPa, without unknown ones.

        Parameters as in `Strength.find_curves`.
        """
        if self.hardness is not None:
            hardness = {"hardness": np.array(self.hardness)}
            found = find_strengths(hardness, self.inclusion, criterion, sensitivity)
            return {name: float(found[name]) for name in self.strengths if name in found}
        values = {name: getattr(self, name) for name in self.strengths}
        return {name: value for name, value in values.items() if value is not None}

    def find_life(self, table: Any) -> Woehler:
        """Return the Wöhler curve, by default that of the table [fatigue]."""
        given = {name: getattr(self, name) for name in ("cycles", "exponent", "knee")}
        return replace(table.life, **{k: value for k, value in given.items() if value is not None})

    def describe_strength(self, table: Any) -> str:
        """Return a text with the strength and the life of the layer, with the table [fatigue]."""
        values = self.find_values(table.criterion, table.sensitivity)
        parts = [f"{name.replace('_', ' ')} {value:.6g} MPa" for name, value in values.items()]
        curve = self.find_life(table)
        if "limit" in values:
            life = f"life {curve.cycles:g} cycles at the limit, to the power -{curve.exponent:g}"
            parts.append(f"{life}, infinite below" if curve.knee else life)
        return "; ".join(parts)


def check_strength_of_layers(
    entries: ValidEntries, body: str, curves: Mapping[str, Any]
) -> Iterator[Fault]:
    """Report layers of a body without a strength that others or the body below have.

    Parameters
    ----------
    entries : ValidEntries
        Entries of [fatigue].
    body : str
        "A" or "B".
    curves : mapping
        Strength of the body below the layers over the depth, by name.
    """
    layers = entries[body].layer
    rule = entries["criterion"], entries["sensitivity"]
    values = [layer.find_values(*rule) for layer in layers]
    common = {"limit": {"limit"}, "shear_yield": {"shear_yield", "yield_strength"}}
    for k, layer in enumerate(layers):
        hardest = LayerStrength.hardest_without_inclusions
        if layer.inclusion is None and (layer.hardness or 0.0) > hardest:
            cure = (
                f"a number above 0: the limit of steel above {hardest:g} HV depends on inclusions"
            )
            yield Fault(f"{body}.layer[{k}].inclusion", "nothing", cure)
    for name in LayerStrength.strengths if layers else ():
        is_below = name in curves or bool(entries.given & common[name])
        lacking = [k for k, each in enumerate(values) if name not in each]
        if is_below and lacking:
            cure = f"a number above 0, MPa: [fatigue] has one, that of body {body} below its layers"
            yield Fault(f"{body}.layer[{lacking[0]}].{name}", "nothing", cure)
        elif not is_below and len(lacking) < len(layers):
            cure = f"a number above 0, MPa, for body {body} below its layers, which have one"
            yield Fault(name, "nothing", cure)
    if layers and entries["volume"] is not None:
        yield Fault("volume", f"with {body}.layer", "one of them: the volume has one material")


class Relaxation(BodyPart):
    """Term of a Prony series: a part of the creep of a body, or of the relaxation of its modulus.

    After the time t the compliance is that of young and poisson times 1 + sum of ratio (1 - exp(-t
    / time)) over all terms, for `of` = "compliance"; for "modulus" it is the modulus times 1 - this
    sum. Poisson's ratio does not change.

    Examples
    --------
    >>> ts.Relaxation(ratio=1.0, time=0.01).of
    'compliance'
    """

    key_advice: ClassVar[Mapping[str, str]] = {
        "tau": "time, in s",
        "modulus": 'ratio, of the body\'s modulus, with of = "modulus"',
        "poisson": "poisson of the body: it does not change with the time",
    }
    excludes = BodyLayer.excludes | {
        "tables": "forces of bodies that relax do not scale with load and creepage",
    }
    ratio: NotNegative = entry(
        "part of the compliance (of the modulus: part that is lost) over that at once", le=1e6
    )
    time: Positive = entry("retardation time of the compliance, or relaxation time, s")
    of: Literal["compliance", "modulus"] = entry(
        "what grows or falls with the time; the same in all terms of a body", default="compliance"
    )

    @classmethod
    def change(cls, parts: Sequence[Self], body: SurfaceResponse) -> SurfaceResponse:
        """Return the body with terms whose ratios are above zero (`BodyPart.change`)."""
        pairs = tuple((term.ratio, term.time) for term in parts if term.ratio > 0.0)
        if not pairs:
            return body
        return RelaxingBody(body, creep_terms(pairs) if parts[0].of == "modulus" else pairs)

    @classmethod
    def describe_part(
        cls, parts: Sequence[Self], body: SurfaceResponse
    ) -> Iterator[tuple[str, str]]:
        """Yield a label and a text for the relaxation of a body."""
        if isinstance(body, RelaxingBody):
            share = 1.0 / body.factor(0.0, 0.0).real
            times = ", ".join(f"{time:.4g}" for _, time in body.terms)
            text = f"creep in {times} s; long after loading {share:.4g} of the modulus"
            yield "relaxation", f"{text}, in all layers"


def check_relaxation(entries: ValidEntries) -> Iterator[Fault]:
    """Report terms of the compliance and of the modulus together, or nothing left of a modulus."""
    terms = entries["relaxation"]
    for k, term in enumerate(terms):
        if term.of != terms[0].of:
            cure = f'"{terms[0].of}", as in the first term: convert the measured values'
            yield Fault(f"relaxation[{k}].of", f'"{term.of}"', cure)
            return
    lost = sum(term.ratio for term in terms)
    if terms and terms[0].of == "modulus" and lost >= 1.0 - 1e-6:
        cure = 'a sum of all terms below 1 with of = "modulus": a solid keeps a part of it'
        yield Fault("relaxation[0].ratio", f"terms with the sum {lost:g}", cure)


def check_constants(entries: ValidEntries) -> Iterator[Fault]:
    """Report elastic constants that are missing, or given twice."""
    given = entries.given & {"young", "shear", "poisson"}
    if entries["stiffness"] is not None:
        keys = sorted(given | (entries.given & {"layer"}))
        if keys:
            cure = "[stiffness] or isotropic constants and layers, not both"
            yield Fault("stiffness", f"with {' and '.join(keys)}", cure)
        return
    if "poisson" not in given:
        yield Fault("poisson", "nothing", "a number from 0 to 0.5")
    yield from exactly_one("young", "shear")(entries)
