"""The laws of mechanics that a scene names: the one place where its tables become laws."""

import math
from collections.abc import Sequence
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
    ByChart,
    ByTotal,
    ByWork,
    Coulomb,
    Crossland,
    CycleCriterion,
    DangVan,
    EachBody,
    Elasticity,
    Energy,
    Exponential,
    FallingCoulomb,
    FatemiSocie,
    Findley,
    FrictionLaw,
    HalfSpaces,
    Layered,
    OrthogonalShear,
    Rational,
    Regimes,
    StressCriterion,
    Strips,
    VolumeLife,
    WearLaw,
    Woehler,
    describe,
    fingerprint,
)
from tractive_sam.results import UNNAMED, LawRecord, State, describe_laws
from tractive_sam.scene import BY_COEFFICIENT, PER_INTENSITY, Scene


@dataclass(frozen=True)
class Laws:
    """The mechanics of a contact.

    Attributes
    ----------
    elasticity : Elasticity
        How the bodies give way.
    friction : FrictionLaw or None
        What friction does; None without.
    wear : WearLaw or None
        How a pass wears; None without.
    criterion : StressCriterion
        What stress in the bodies is judged by.
    fatigue : CycleCriterion or None
        What the cycles of stress are judged by; None without a limit.
    life : Woehler or None
        How many cycles the material endures at a utilisation.
    volume : VolumeLife or None
        How many all of its volume endures.

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
        """The laws that the tables of a scene name."""
        laws = _elasticity(scene), _friction(scene), _wear(scene)
        return cls(*laws, fatigue=_fatigue(scene), life=_life(scene), volume=_volume(scene))

    def replace(self, **laws: Any) -> "Laws":
        """These laws, with others in place of some."""
        return replace(self, **laws)

    @classmethod
    def of_contact(cls, contact: State, needed: Sequence[str] = ("elasticity",)) -> "Laws":
        """Return the laws that a contact was solved with.

        Parameters
        ----------
        contact : State
            The contact.
        needed : sequence of str
            Attributes that will be used.

        Raises
        ------
        ValueError
            If the contact was read from a file, and a needed law had replaced that of its scene: a
            file does not hold it.
        """
        if isinstance(contact.laws, Laws):
            return contact.laws
        missing = {k: one for k, one in contact.laws.items() if k in (*needed, UNNAMED)}
        if missing:
            raise ValueError(
                f"laws: the contact was computed with {describe_laws(missing)} in place of the law "
                "of its scene, which a results file does not hold; give laws=... with that law"
            )
        return cls.of(contact.scene)

    def of_block(self, scene: Scene, block: Scene) -> "Laws":
        """Return the laws of a block of a scene; laws that replace the scene's remain."""
        replaced = {name: getattr(self, name) for name in self.differences_from(scene)}
        return Laws.of(block).replace(**replaced)

    def differences_from(self, scene: Scene) -> dict[str, LawRecord]:
        """Return the laws that differ from those of a scene, by the name of their attribute."""
        of_scene = Laws.of(scene)
        return {
            name: LawRecord(describe(law), fingerprint(law), getattr(law, "frame", None))
            for name, law in vars(self).items()
            if fingerprint(law) != fingerprint(getattr(of_scene, name))
        }


def _elasticity(scene: Scene) -> Elasticity:
    """Of line contact relative to the surface one combined radius away; with the layer."""
    A, B = scene.materials["A"], scene.materials["B"]
    bodies = Strips(A, B, scene.body.radii[0]) if scene.line else HalfSpaces(A, B)
    layer = 0.0 if scene.friction is None else scene.friction.layer
    return Layered(bodies, layer) if layer else bodies


def _friction(scene: Scene) -> Coulomb | None:
    table = scene.friction
    if table is None:
        return None
    mu, angle, share = table.mu, float(np.deg2rad(table.angle)), table.share
    falls = share is not None and share[0] < 1.0
    if not falls and table.strength is None and table.temperature is None:
        return Coulomb(mu, angle)
    sliding, speed, memory = None, 0.0, 0.0
    if falls:
        sliding = (Rational if table.law == "rational" else Exponential)(*share)
        speed, memory = scene.creepage.speed, table.memory
    strength = np.inf if table.strength is None else table.strength
    return FallingCoulomb(mu, angle, sliding, speed, memory, strength)


def _wear(scene: Scene) -> WearLaw | None:
    """That of the paper with its slip."""
    table = scene.wear
    if table is None:
        return None
    if table.together:
        return _by_coefficient(scene, table.law, table.intensities)
    return EachBody(**{body: _of_body(scene, body) for body in "AB"})


def _by_coefficient(scene: Scene, law: str, intensities: tuple[float, float]) -> WearLaw:
    friction = _friction(scene)
    mu, angle = ((1.0, 1.0), 0.0) if friction is None else (friction.mu, friction.angle)
    if law == "energy":
        return Energy(intensities, angle)
    if scene.solver.slip == "upwind":
        return Archard(intensities, angle)
    falling = friction if isinstance(friction, FallingCoulomb) else None
    return ArchardByWork(intensities, mu, angle, falling)


def _of_body(scene: Scene, name: str) -> WearLaw | None:
    """The law by which a body wears on its own."""
    table, body = scene.wear, getattr(scene.body, name)
    law, chosen = table.laws[name], table.sets[name]
    if law in BY_COEFFICIENT:
        i = getattr(table.coefficient, name) / PER_INTENSITY
        return _by_coefficient(scene, law, (i, i))
    match law:
        case "usfd" | "table":
            known = USFD[chosen] if chosen else Regimes.through(table.law.table)
            return ByWork(known, body.density, table.by == "contact")
        case "brr":
            return ByTotal(BRR[chosen])
        case "jendel":
            friction, speed = _friction(scene), scene.creepage.speed
            mu, angle = friction.mu, friction.angle
            return ByChart(JENDEL[chosen][0], body.hardness, speed, mu, angle)
    return None


def _fatigue(scene: Scene) -> CycleCriterion | None:
    table = scene.fatigue
    if table is None or table.limit is None:
        return None
    if table.criterion == "orthogonal-shear":
        return OrthogonalShear()
    if table.criterion == "fatemi-socie":
        return FatemiSocie(table.sensitivity, table.yield_stress)
    kinds = {one.name: one for one in (DangVan, Crossland, Findley)}
    return kinds[table.criterion](table.sensitivity)


def _life(scene: Scene) -> Woehler | None:
    table = scene.fatigue
    if table is None or table.limit is None:
        return None
    return Woehler(table.cycles, table.exponent, table.knee)


def _volume(scene: Scene) -> VolumeLife | None:
    asked = None if scene.fatigue is None else scene.fatigue.volume
    if asked is None:
        return None
    slope = asked.slope or (9.0 / 8.0 if scene.line else 10.0 / 9.0)
    exponents = asked.stress_exponent, asked.depth_exponent
    return VolumeLife(asked.constant or math.nan, slope, asked.limit, *exponents)
