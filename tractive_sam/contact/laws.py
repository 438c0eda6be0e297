"""The laws of mechanics of a scene: the one place that makes laws from its tables."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tractive_sam.mechanics import (
    BRR,
    JENDEL,
    USFD,
    VON_MISES,
    Archard,
    ArchardByWork,
    ConstantShare,
    Coulomb,
    Crossland,
    CycleCriterion,
    DangVan,
    Elasticity,
    Energy,
    Exponential,
    FallingCoulomb,
    FatemiSocie,
    Findley,
    FrictionLaw,
    InterfacialLayer,
    LateralFactor,
    OrthogonalShear,
    PerBody,
    Rational,
    Regimes,
    SlidingShare,
    StressCriterion,
    TGammaPerArea,
    TGammaTotal,
    VolumeLife,
    WearLaw,
    WearMap,
    Woehler,
    describe,
    fingerprint,
)
from tractive_sam.results import UNNAMED, LawRecord, State, describe_laws
from tractive_sam.scene import BY_COEFFICIENT, PER_INTENSITY, Scene, WearLaws
from tractive_sam.schema import Fault, SceneError, build_law, required


@dataclass(frozen=True)
class Laws:
    """The laws of a contact: elasticity, friction, wear, stress criterion, fatigue and life.

    Attributes
    ----------
    elasticity : Elasticity
        Elastic response of both bodies.
    friction : FrictionLaw or None
        Law of friction; None without friction.
    wear : WearLaw or None
        Law of wear; None without wear.
    criterion : StressCriterion
        Criterion for the stress in the bodies.
    fatigue : CycleCriterion or None
        Criterion for cycles of stress; None without a limit.
    life : Woehler or None
        Number of cycles that the material endures, by utilisation.
    volume : VolumeLife or None
        Number of cycles that the volume under stress endures.

    Examples
    --------
    >>> laws = ts.Laws.of(scene)
    >>> laws.friction
    Coulomb(mu=(0.4013, 0.4013), angle=0.0)
    >>> weaker = laws.replace(friction=ts.Coulomb(mu=(0.3, 0.3)))
    >>> ts.solve(scene, laws=weaker).Qx < contact.Qx
    True
    """

    elasticity: Elasticity
    friction: FrictionLaw | None = None
    wear: WearLaw | None = None
    criterion: StressCriterion = VON_MISES
    fatigue: CycleCriterion | None = None
    life: Woehler | None = None
    volume: VolumeLife | None = None

    @classmethod
    def of(cls, scene: Scene) -> "Laws":
        """Return the laws that the tables of a scene define, also those of other packages.

        Raises
        ------
        SceneError
            If the scene names a law of another package that may not be used or does not take the
            parameters.
        """
        laws = cls.of_package(scene)
        named = {name: law for name, build in _NAMED.items() if (law := build(scene)) is not None}
        return laws.replace(**named) if named else laws

    @classmethod
    def of_package(cls, scene: Scene) -> "Laws":
        """Return the laws that this package makes from a scene, without those of others.

        In place of a law of another package there is none, or homogeneous bodies.
        """
        elasticity = _with_layer(scene.pair.elasticity(scene), scene)
        laws, table = (elasticity, _friction(scene), _wear(scene)), scene.fatigue
        life = None if table is None or table.limit is None else table.life
        return cls(*laws, fatigue=_fatigue(scene), life=life, volume=_volume(scene))

    def replace(self, **laws: Any) -> "Laws":
        """Return a copy with the laws given by keyword."""
        return replace(self, **laws)

    @classmethod
    def of_contact(cls, contact: State, needed: Sequence[str] = ("elasticity",)) -> "Laws":
        """Return the laws with which a contact was solved; raise a ValueError if unknown.

        Parameters
        ----------
        contact : State
            The contact.
        needed : sequence of str
            Attributes that will be used.

        Raises
        ------
        ValueError
            If the contact was read from a file, and a needed law had replaced the law of its scene:
            files do not store laws.
        """
        if isinstance(contact.laws, Laws):
            return contact.laws
        missing = {k: record for k, record in contact.laws.items() if k in (*needed, UNNAMED)}
        if missing:
            raise ValueError(
                f"laws: the contact was computed with {describe_laws(missing)} in place of the law "
                "of its scene, and results files do not store laws; give laws=... with that law"
            )
        return cls.of_package(contact.scene).worn((contact,), contact.scene)

    def worn(self, contacts: Sequence[State], scene: Scene) -> "Laws":
        """Return the laws with layers that are as thin as wear leaves them ([wear] layer_step).

        The depth is that worn off before the contact, a mean over the rows with their load.

        Parameters
        ----------
        contacts : sequence of State
            Contacts before which it is worn.
        scene : Scene
            Scene of these laws, with unworn bodies.
        """
        step = None if scene.wear is None else scene.wear.layer_step
        if step is None:
            return self
        load = sum(contact.pressure.sum(axis=0) for contact in contacts)
        depth = sum((c.pressure.sum(axis=0) * c.wear[-1]).sum() for c in contacts)
        depth /= max(load.sum(), 1e-300)
        of_A, of_B = (float(scene.turns.share_of_entering(body) * depth) for body in "AB")
        return self.replace(elasticity=self.elasticity.worn((of_A, of_B), step))

    def of_block(self, scene: Scene, block: Scene) -> "Laws":
        """Return the laws of a duty block; laws that replace those of the scene remain replaced."""
        replaced = self._differing_from(Laws.of(scene))
        return Laws.of(block).replace(**replaced)

    def differences_from(self, scene: Scene) -> dict[str, LawRecord]:
        """Return records, by attribute, of laws that this package does not make from the scene.

        They replaced laws of the scene, or the scene names laws of other packages.
        """
        return {
            name: LawRecord(describe(law), fingerprint(law), getattr(law, "frame", None))
            for name, law in self._differing_from(Laws.of_package(scene)).items()
        }

    def _differing_from(self, reference: "Laws") -> dict[str, Any]:
        """Return the laws that differ from those of `reference`, by attribute."""
        return {
            name: law
            for name, law in vars(self).items()
            if fingerprint(law) != fingerprint(getattr(reference, name))
        }


def _with_layer(bodies: Elasticity, scene: Scene) -> Elasticity:
    """Return the elasticity with the interfacial layer of a scene added, if it has one."""
    layer = 0.0 if scene.friction is None else scene.friction.layer
    return InterfacialLayer(bodies, layer) if layer else bodies


def _named_elasticity(scene: Scene) -> Elasticity | None:
    """Return the elastic law of another package that a scene names, with its layer; else None."""
    table = scene.elasticity
    if table is None or table.named_law is None:
        return None
    law = build_law("elasticity.law", table.named_law, Elasticity, scene.materials)
    return _with_layer(law, scene)


def _named_friction(scene: Scene) -> FrictionLaw | None:
    """Return the friction law of another package that a scene names, or None; check its frame.

    Raises
    ------
    SceneError
        If its frame differs from the table's, which limits, units and the wear law use.
    """
    table = scene.friction
    if table is None or table.named_law is None:
        return None
    law = build_law("friction.law", table.named_law, FrictionLaw, _tribology(scene))
    if not np.allclose(law.frame.matrix, table.frame.matrix, rtol=1e-9, atol=1e-12):
        mu, angle = law.frame.mu, math.degrees(law.frame.angle)
        values = f"{list(table.mu)} at {table.angle:g} degrees"
        allowed = f"the frame of {table.named_law.name}: mu = {list(mu)}, angle = {angle:g}"
        raise SceneError([Fault("friction.mu, friction.angle", values, allowed)])
    return law


def _named_wear(scene: Scene) -> WearLaw | None:
    """Return the wear law of another package that a scene names; else None."""
    if scene.wear is None or scene.wear.named_law is None:
        return None
    return build_law("wear.law", scene.wear.named_law, WearLaw, _tribology(scene))


def _named_criterion(scene: Scene) -> CycleCriterion | None:
    """Return the fatigue criterion of another package that a scene names; else None."""
    table = scene.fatigue
    if table is None or table.limit is None or table.named_law is None:
        return None
    parameters = {"yield_stress": table.yield_stress}
    return build_law("fatigue.criterion", table.named_law, CycleCriterion, parameters)


def _tribology(scene: Scene) -> dict[str, Any]:
    """Return parameters that friction and wear laws may take from the scene: mu, angle, speed."""
    frame, speed = required(scene.friction, "friction").frame, scene.creepage.speed
    parameters = {"mu": frame.mu, "angle": frame.angle}
    return parameters if speed is None else parameters | {"speed": speed}


_NAMED = {
    "elasticity": _named_elasticity,
    "friction": _named_friction,
    "wear": _named_wear,
    "fatigue": _named_criterion,
}
"""Functions that build the laws of other packages named by a scene, by attribute of `Laws`."""


def _friction(scene: Scene) -> Coulomb | None:
    """Return the friction law of a scene; None if it has none or one of another package."""
    table = scene.friction
    if table is None or table.named_law:
        return None
    mu, angle = table.mu, float(np.deg2rad(table.angle))
    if not table.varies:
        return Coulomb(mu, angle)
    sliding: SlidingShare | None = None
    speed, memory = 0.0, 0.0
    if table.falls:
        shapes: dict[str, Callable[..., SlidingShare]] = {
            "exponential": Exponential, "rational": Rational, "polach": Exponential
        }  # fmt: skip
        sliding = shapes[str(table.law)](*required(table.share, "friction.kinetic"))
    elif table.memory and table.temperature is not None:
        sliding = ConstantShare()
    if sliding is not None:
        speed, memory = required(scene.creepage.speed, "creepage.speed"), table.memory
    strength = np.inf if table.strength is None else table.strength
    lateral = None if table.across is None else LateralFactor(*np.array(table.across).T)
    return FallingCoulomb(mu, angle, sliding, speed, memory, strength, lateral=lateral)


def _wear(scene: Scene) -> WearLaw | None:
    """Return the wear law of a scene; None if it has none or one of another package."""
    table = scene.wear
    if table is None or table.named_law:
        return None
    if table.together:
        return _by_coefficient(scene, str(table.law), table.intensities)
    return PerBody(**{body: _of_body(scene, body) for body in "AB"})


def _by_coefficient(scene: Scene, law: str, intensities: tuple[float, float]) -> WearLaw:
    """Return Energy, Archard (for upwind slip) or ArchardByWork with intensities of both axes."""
    frame = required(scene.friction, "friction").frame
    if law == "energy":
        return Energy(intensities, frame.angle)
    assert law == "archard"
    if scene.solver.slip == "upwind":
        return Archard(intensities, frame.angle)
    return ArchardByWork(intensities, frame.mu, frame.angle)


def _of_body(scene: Scene, name: str) -> WearLaw | None:
    """Return the separate wear law of body "A" or "B", or None if it does not wear."""
    table, body = required(scene.wear, "wear"), getattr(scene.body, name)
    law, chosen = table.laws[name], table.sets[name]
    if law in BY_COEFFICIENT:
        i = getattr(table.coefficient, name) / PER_INTENSITY
        return _by_coefficient(scene, required(law, "wear.law"), (i, i))
    match law:
        case "usfd" | "table":
            points = table.law.table if isinstance(table.law, WearLaws) else None
            regimes = USFD[chosen] if chosen else Regimes.through(required(points, "wear.law"))
            return TGammaPerArea(regimes, body.density, table.by == "contact")
        case "brr":
            return TGammaTotal(BRR[required(chosen, "wear.law")])
        case "jendel":
            frame = required(scene.friction, "friction").frame
            speed = required(scene.creepage.speed, "creepage.speed")
            coefficients, _ = JENDEL[required(chosen, "wear.law")]
            return WearMap(coefficients, body.hardness, speed, frame.mu, frame.angle)
    return None


def _fatigue(scene: Scene) -> CycleCriterion | None:
    """Return the fatigue criterion of a scene; None without limit or if of another package."""
    table = scene.fatigue
    if table is None or table.limit is None or table.named_law:
        return None
    if table.criterion == "orthogonal-shear":
        return OrthogonalShear()
    if table.criterion == "fatemi-socie":
        yield_stress = required(table.yield_stress, "fatigue.yield_stress")
        return FatemiSocie(required(table.sensitivity, "fatigue.sensitivity"), yield_stress)
    kinds = {kind.name: kind for kind in (DangVan, Crossland, Findley)}
    return kinds[str(table.criterion)](required(table.sensitivity, "fatigue.sensitivity"))


def _volume(scene: Scene) -> VolumeLife | None:
    """Return the law for the life of a stressed volume, or None without [fatigue.volume]."""
    table = None if scene.fatigue is None else scene.fatigue.volume
    if table is None:
        return None
    slope = table.slope or scene.contact_type.weibull_slope
    exponents = table.stress_exponent, table.depth_exponent
    return VolumeLife(table.constant or math.nan, slope, table.limit, *exponents)
