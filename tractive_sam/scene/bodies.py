"""The two bodies: elastic constants, radii and hardness."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, ClassVar

from tractive_sam.mechanics import (
    CombinedMaterial,
    HertzContact,
    HertzLine,
    Material,
    combine,
    combined_radius,
    hertz,
    hertz_line,
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
    exactly_one,
    optional,
)

from .heat import Thermal
from .tables import Load


class Body(Table):
    """Body: elastic constants, radii of curvature, hardness, density and thermal properties.

    Examples
    --------
    >>> steel = ts.Body(young=208e3, poisson=0.3, radius_x=32.5, radius_y=32.5)
    >>> steel.radius_x
    32.5
    """

    young: Positive | None = optional("Young's modulus, MPa")
    shear: Positive | None = optional("shear modulus, MPa")
    poisson: Real = entry("Poisson's ratio", ge=0, le=0.5)
    radius_x: Radius = entry("radius in the rolling direction, mm", "a number, or inf (flat)")
    radius_y: Radius = entry("radius in the lateral direction, mm", "a number, or inf (flat)")
    hardness: Positive = entry(
        "hardness, for both bodies or for none, in any unit (for the wear law jendel, in MPa); "
        "the bodies wear in inverse proportion to it",
        default=1.0,
    )
    width: Positive | None = optional(
        "lateral width, mm, centred at y = 0; edges are not modelled, but a note is printed if "
        "the contact is near an edge"
    )
    density: Positive = entry(
        "density, kg/m3, for the worn mass; the default is for steel", default=7850.0
    )
    thermal: InnerTable[Thermal | None] = optional("thermal properties")
    checks: ClassVar[tuple[Check, ...]] = (exactly_one("young", "shear"),)

    @property
    def material(self) -> Material:
        """Elastic constants of the body."""
        if self.young is not None:
            return Material.from_young(self.young, self.poisson)
        assert self.shear is not None  # as exactly one of both is given
        return Material(self.shear, self.poisson)


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
            material = body.material
            radii = f", R_x = {body.radius_x:g} mm, R_y = {body.radius_y:g} mm"
            text = f"E = {material.young:g} MPa, nu = {material.poisson:g}"
            yield Row(f"body {name}", text if scene.wheelset else text + radii, brief=True)
        pair, (radius_x, radius_y) = self.material, self.radii
        yield Row("combined modulus", f"E* = {pair.E_star:.6g} MPa, nu = {pair.poisson:.4g}")
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
    def infinitely_long(self) -> bool:
        """Whether both bodies have ``radius_y = inf``: a line contact without a gap over y."""
        return self.A.radius_y == self.B.radius_y == math.inf

    def hertz(self, load: Load) -> HertzContact | HertzLine | None:
        """Return the Hertz contact under a load; None if radii or approach close no contact.

        Infinitely long bodies have a line contact under a load per length.
        """
        radius_x, radius_y = self.radii
        e_star = self.material.plane_strain_modulus
        if not 0 < radius_x < math.inf:
            return None
        if self.infinitely_long and load.approach is None:
            return hertz_line(e_star, radius_x, load.normal, pressure=load.pressure)
        if not 0 < radius_y < math.inf or (load.approach is not None and load.approach <= 0):
            return None  # without a [gap] there is no contact
        prescribed = {"load": load.normal, "approach": load.approach, "pressure": load.pressure}
        return hertz(e_star, radius_x, radius_y, **prescribed)

    def normal_load(self, load: Load) -> float | None:
        """Return the normal load, N or N/mm, set or from a pressure; None for an approach."""
        if load.pressure is None:
            return load.normal
        contact = self.hertz(load)
        return None if contact is None else contact.load
