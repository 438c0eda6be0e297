"""Tables for materials of a body: layers, stiffness of transverse isotropy, and relaxation."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import ClassVar, Literal

from tractive_sam.mechanics import (
    HertzContact,
    HertzLine,
    Layer,
    LayeredBody,
    Material,
    RelaxingBody,
    TransverseMaterial,
    contact_modulus,
    creep_terms,
    hertz,
    hertz_line,
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
)


def _check_stiffness(entries: ValidEntries) -> Iterator[Fault]:
    """Report a stiffness that no stable material has."""
    C11, C12, C13, C33 = (entries[key] for key in ("C11", "C12", "C13", "C33"))
    if abs(C12) >= C11:
        yield Fault("C12", f"{C12:g}", f"a magnitude below C11 = {C11:g}")
    elif 2.0 * C13**2 >= C33 * (C11 + C12):
        largest = math.sqrt(0.5 * C33 * (C11 + C12))
        yield Fault("C13", f"{C13:g}", f"a magnitude below {largest:.4g}: sqrt(C33 (C11 + C12)/2)")


def isotropic_material(young: float | None, shear: float | None, poisson: float | None) -> Material:
    """Return isotropic elastic constants from Poisson's ratio and one of both moduli, MPa."""
    nu = required(poisson, "poisson")
    if young is not None:
        return Material.from_young(young, nu)
    return Material(required(shear, "shear"), nu)


class Stiffness(Table):
    """Elastic stiffness of a material that is isotropic in the surface; the index 3 is its normal.

    Examples
    --------
    >>> zinc = ts.Stiffness(C11=165e3, C12=31.1e3, C13=50e3, C33=61.8e3, C44=39.6e3)
    >>> round(zinc.material.tangential.poisson, 4)
    0.0947
    """

    key_advice: ClassVar[Mapping[str, str]] = {
        "C66": "C12: C66 = (C11 - C12)/2",
        "C55": "C44: the material is isotropic in the surface",
        "C22": "C11: the material is isotropic in the surface",
        "C23": "C13: the material is isotropic in the surface",
    }
    C11: Positive = entry("stiffness C11 in the surface, MPa")
    C12: Real = entry("stiffness C12 in the surface, MPa")
    C13: Real = entry("stiffness C13 between surface and normal, MPa")
    C33: Positive = entry("stiffness C33 along the normal, MPa")
    C44: Positive = entry("stiffness C44 in shear parallel to the surface, MPa")
    checks: ClassVar[tuple[Check, ...]] = (_check_stiffness,)

    @property
    def material(self) -> TransverseMaterial:
        """The material."""
        return TransverseMaterial(self.C11, self.C12, self.C13, self.C33, self.C44)


class BodyLayer(Table):
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
    body = LayeredBody(
        tuple(layer.layer for layer in layers),
        Material.from_young(young, entries["poisson"]),
    )
    try:
        _ = body.images
    except ValueError:
        cure = "moduli that differ less, or fewer layers: the response is not resolved"
        yield Fault("layer", f"{len(layers)} layers", cure)


class Relaxation(Table):
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
    ratio: NotNegative = entry(
        "part of the compliance (of the modulus: part that is lost) over that at once", le=1e6
    )
    time: Positive = entry("retardation time of the compliance, or relaxation time, s")
    of: Literal["compliance", "modulus"] = entry(
        "what grows or falls with the time; the same in all terms of a body", default="compliance"
    )


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


def relaxing(
    body: Material | LayeredBody | TransverseMaterial, terms: tuple[Relaxation, ...]
) -> Material | LayeredBody | TransverseMaterial | RelaxingBody:
    """Return a body with terms of relaxation; the body itself if all their ratios are zero."""
    pairs = tuple((term.ratio, term.time) for term in terms if term.ratio > 0.0)
    if not pairs:
        return body
    if terms[0].of == "modulus":
        pairs = creep_terms(pairs)
    return RelaxingBody(body, pairs)


def describe_parts(
    layers: tuple[BodyLayer, ...],
    body: Material | LayeredBody | TransverseMaterial | RelaxingBody,
) -> Iterator[tuple[str, str]]:
    """Yield a label and a text for each layer of a body, and for its relaxation."""
    for k, layer in enumerate(layers):
        moduli = f"E = {layer.material.young:g} MPa, nu = {layer.poisson:g}"
        moduli += ", graded" if layer.gradient != "none" else ""
        if any(compliance := layer.layer.compliance):
            springs = " and ".join(f"{value:g}" for value in compliance)
            moduli += f", on springs with {springs} mm/MPa in shear and along the normal"
        yield f"layer {k}", f"{layer.thickness:g} mm, {moduli}"
    if isinstance(body, RelaxingBody):
        share, times = (
            1.0 / body.factor(0.0, 0.0).real,
            ", ".join(f"{time:.4g}" for _, time in body.terms),
        )
        text = f"creep in {times} s; long after loading {share:.4g} of the modulus"
        yield "relaxation", f"{text}, in all layers; each pass begins at rest"


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


@lru_cache(64)
def layered_contact(
    A: Material | LayeredBody | TransverseMaterial | RelaxingBody,
    B: Material | LayeredBody | TransverseMaterial | RelaxingBody,
    radii: tuple[float, float],
    prescribed: tuple[tuple[str, float | None], ...],
    speed: float = 0.0,
) -> HertzContact | HertzLine:
    """Return the Hertz contact whose modulus is that of the bodies for waves of its length."""
    load = dict(prescribed)

    def contact(log_modulus: float) -> HertzContact | HertzLine:
        e_star, (radius_x, radius_y) = math.exp(log_modulus), radii
        if radius_y == math.inf:
            return hertz_line(e_star, radius_x, load["load"], pressure=load["pressure"])
        return hertz(e_star, radius_x, radius_y, **load)

    # With a larger modulus the contact is smaller and meets more of the layers; the moduli of all
    # lengths enclose the solution.
    inner = [getattr(body, "body", body) for body in (A, B)]
    depth = sum(layer.thickness for body in inner for layer in getattr(body, "layers", ()))
    depth += sum(speed * time for body in (A, B) for _, time in getattr(body, "terms", ()))
    lengths = [(depth or 1.0) * 10.0 ** (0.25 * k) for k in range(-24, 25)]
    moduli = [math.log(contact_modulus(A, B, length, speed)) for length in lengths]
    low, high = min(moduli), max(moduli)
    for _ in range(30):
        middle = 0.5 * (low + high)
        length = contact(middle).mean_semi_axis
        if math.log(contact_modulus(A, B, length, speed)) > middle:
            low = middle
        else:
            high = middle
    return contact(0.5 * (low + high))
