"""What can be modelled but looks as if it was given in another unit, or forgotten."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from tractive_sam.mechanics import HertzContact

from .tables import PER_INTENSITY

if TYPE_CHECKING:
    from tractive_sam.mechanics import HertzLine, Material

    from .scene import Scene

LIKE_GPA = (30.0, 1000.0)
"""Young's moduli in MPa that are those of metals and ceramics in GPa."""

SOFT = 0.45
"""Poisson's ratio from which such a modulus is taken for rubber's without a word."""

LIKE_PA = (1e9, 2e12)
"""Young's moduli in MPa that are those of plastics to diamond in Pa."""

HARDEST = 1e4
"""Peak pressure that no engineering material withstands, MPa."""

MOST_CREEPAGE = 0.1
"""Creepage beyond which bodies rather slide than roll; 1 is one body at rest."""

MOST_FRICTION = 2.0
"""Friction coefficient of rubber on a dry road, and of cold welds."""

MOST_WEAR = 2.0
"""Wear intensity times E*: a thousand times that of dry steel, of k = 2e-5 mm3/(N m)."""


NEAR_EDGE = 0.8
"""Width of the contact over that of a body from which an edge is as near as half a half width."""

MOST_SHAKEN = 4.7
"""p0/k up to which a circular contact without friction shakes down; a line up to 4."""

_STEEL = "Steel has 2.1e5 MPa"


def doubtful_contact(
    materials: Mapping[str, Material], hertz: HertzContact | HertzLine | None
) -> Iterator[str]:
    """A line for each body, and for a load, that looks as if it was given in another unit."""
    for name, material in materials.items():
        E = material.young
        if LIKE_GPA[0] <= E <= LIKE_GPA[1] and material.poisson < SOFT:
            yield f"body.{name}: E = {E:g} MPa is that of a soft plastic; in GPa? {_STEEL}"
        elif LIKE_PA[0] <= E <= LIKE_PA[1]:
            yield f"body.{name}: E = {E:g} MPa is beyond any material; in Pa? {_STEEL}"
    if hertz is not None and hertz.p0 > HARDEST:
        yield (
            f"load: p0 = {hertz.p0:.4g} MPa by Hertz, and no material withstands "
            f"{HARDEST:g} MPa; units are mm, N and MPa"
        )


def near_edge(scene: Scene, width: float) -> Iterator[str]:
    """What to say of each body that is hardly wider than a contact of that width, mm."""
    for name, body in (("A", scene.body.A), ("B", scene.body.B)):
        if body.width is not None and width > NEAR_EDGE * body.width:
            yield (
                f"the contact is {width:.3g} mm wide and body {name} {body.width:g} mm; its edges "
                "are not modelled, and pressure rises there"
            )


def doubts(scene: Scene) -> Iterator[str]:
    """A line for each entry that is doubtful, with what may be meant."""
    yield from doubtful_contact(scene.materials, scene.hertz)
    if isinstance(scene.hertz, HertzContact):
        yield from (f"body: {told}" for told in near_edge(scene, 2.0 * scene.hertz.b))
    k = None if scene.fatigue is None else scene.fatigue.shear_yield_stress
    if k is not None and scene.hertz is not None and scene.hertz.p0 > MOST_SHAKEN * k:
        yield (
            f"fatigue: p0 = {scene.hertz.p0:.4g} MPa is {scene.hertz.p0 / k:.3g} times the yield "
            f"stress in shear, and above {MOST_SHAKEN:g} nothing shakes down: material flows in "
            "every pass, and elastic stress is not what it sees"
        )
    for key in ("longitudinal", "lateral"):
        creepage = getattr(scene.creepage, key)
        if abs(creepage) > MOST_CREEPAGE:
            yield f"creepage.{key}: {creepage:g} is {100 * creepage:g} %; 1 % is 0.01"
    for key, course in scene.transient.courses.items() if scene.transient else ():
        table, _, name = key.partition(".")
        given = getattr(scene, table).entries().get(name)
        if (table == "creepage" or name.startswith("force")) and given not in (None, course[0]):
            yield f"{key}: {given:g} is not used, transient.{key} stands for it; leave it out"
    if scene.friction is None:
        moved = [key for key, value in scene.creepage.settings().items() if value]
        if moved:
            keys = ", ".join(f"creepage.{key}" for key in moved)
            yield f"{keys}: without [friction] there is no traction; friction.mu gives it"
    elif max(scene.friction.mu) > MOST_FRICTION:
        yield f"friction.mu: {max(scene.friction.mu):g} is more than surfaces have; in per cent?"
    if scene.wear is None:
        return
    mu = (1.0, 1.0) if scene.friction is None else scene.friction.mu
    i = max(np.multiply(scene.wear.per_work(mu) or 0.0, mu))
    if i * scene.material.plane_strain_modulus > MOST_WEAR:
        yield (
            f"wear: i = {i:g} /MPa, k = {PER_INTENSITY * i:g} mm3/(N m), is a thousand times what "
            "is usual of dry steel; wear.coefficient is in mm3/(N m), wear.intensity in 1/MPa"
        )
