"""The two bodies: what they are made of and how they are curved."""

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
    Positive,
    Radius,
    Real,
    Row,
    Table,
    ValidEntries,
    entry,
    exactly_one,
)

from .heat import Thermal
from .tables import Load


class Body(Table):
    """One of the two bodies: elastic constants, radii of curvature and hardness.

    Examples
    --------
    >>> steel = ts.Body(young=208e3, poisson=0.3, radius_x=32.5, radius_y=32.5)
    >>> steel.radius_x
    32.5
    """

    young: Positive | None = entry("Young's modulus, MPa", default=None)
    shear: Positive | None = entry("shear modulus, MPa", default=None)
    poisson: Real = entry("Poisson's ratio", "a number from 0 to 0.5", ge=0, le=0.5)
    radius_x: Radius = entry("radius in the rolling direction, mm", "a number, or inf (flat)")
    radius_y: Radius = entry("radius across it, mm", "a number, or inf (flat)")
    hardness: Positive = entry(
        "hardness, in the unit of the other body's: only their ratio counts, the worn depth is "
        "shared in inverse proportion; of both bodies or of none; MPa for the wear law jendel",
        default=1.0,
    )
    width: Positive | None = entry(
        "width across the rolling direction, mm, half of it to either side of y = 0; edges are not "
        "modelled, and a note tells where the contact comes near one",
        default=None,
    )
    density: Positive = entry(
        "density, kg/m3, for the worn mass; by default steel's", default=7850.0
    )
    thermal: Thermal | None = entry("what it conducts heat by", default=None)
    checks: ClassVar[tuple[Check, ...]] = (exactly_one("young", "shear"),)

    @property
    def material(self) -> Material:
        """The elastic constants."""
        if self.shear is not None:
            return Material(self.shear, self.poisson)
        return Material.from_young(self.young, self.poisson)


def _hardness_of_both(entries: ValidEntries) -> Iterator[Fault]:
    given = [body for body in "AB" if f"{body}.hardness" in entries.given]
    if len(given) == 1:
        (other,) = set("AB") - set(given)
        cure = (
            "that of both bodies, or of none: only their ratio counts, which shares the worn depth"
        )
        hardness = entries[f"{given[0]}.hardness"]  # a faulty one is told as such
        yield Fault(f"{other}.hardness", f"nothing, and {hardness:g} of body {given[0]}", cure)


class Bodies(Table):
    """The upper body A and the lower body B.

    Examples
    --------
    >>> ball = ts.Body(young=208e3, poisson=0.3, radius_x=10.0, radius_y=10.0)
    >>> plate = ts.Body(young=70e3, poisson=0.33, radius_x=float("inf"), radius_y=float("inf"))
    >>> pair = ts.Bodies(A=ball, B=plate)
    >>> round(pair.material.E_star)
    58462
    """

    A: Body = entry("the upper body")
    B: Body = entry("the lower body")
    checks: ClassVar[tuple[Check, ...]] = (_hardness_of_both,)

    def describe(self, scene: Any) -> Iterator[Row]:
        """See `Table.describe`."""
        for name, body in (("A", self.A), ("B", self.B)):
            material = body.material
            radii = f"R_x = {body.radius_x:g} mm, R_y = {body.radius_y:g} mm"
            text = f"E = {material.young:g} MPa, nu = {material.poisson:g}, {radii}"
            yield Row(f"body {name}", text, brief=True)
        pair, (radius_x, radius_y) = self.material, self.radii
        yield Row("combined modulus", f"E* = {pair.E_star:.6g} MPa, nu = {pair.poisson:.4g}")
        yield Row("combined radii", f"R_x = {radius_x:.6g} mm, R_y = {radius_y:.6g} mm")

    @property
    def materials(self) -> dict[str, Material]:
        """The elastic constants of each body."""
        return {"A": self.A.material, "B": self.B.material}

    @property
    def material(self) -> CombinedMaterial:
        """The elastic constants of the pair."""
        return combine(self.A.material, self.B.material)

    @property
    def radii(self) -> tuple[float, float]:
        """Combined radii in x and in y, mm: inf for flat, negative where bodies do not fit."""
        return (
            combined_radius(self.A.radius_x, self.B.radius_x),
            combined_radius(self.A.radius_y, self.B.radius_y),
        )

    @property
    def wear_share(self) -> dict[str, float]:
        """Share of each body in the depth worn: inverse to its hardness (paper, eq. 34)."""
        total = self.A.hardness + self.B.hardness
        return {"A": self.B.hardness / total, "B": self.A.hardness / total}

    @property
    def infinitely_long(self) -> bool:
        """Whether both have ``radius_y = inf``: without a [gap] they touch along a line."""
        return self.A.radius_y == self.B.radius_y == math.inf

    def hertz(self, load: Load) -> HertzContact | HertzLine | None:
        """The unworn contact under a load; None unless the radii close on each other.

        Of infinitely long bodies, that of a line, under a load per length.
        """
        radius_x, radius_y = self.radii
        e_star = self.material.plane_strain_modulus
        if not 0 < radius_x < math.inf:
            return None
        if self.infinitely_long and load.approach is None:
            return hertz_line(e_star, radius_x, load.normal, pressure=load.pressure)
        if not 0 < radius_y < math.inf:
            return None
        given = {"load": load.normal, "approach": load.approach, "pressure": load.pressure}
        return hertz(e_star, radius_x, radius_y, **given)

    def normal_load(self, load: Load) -> float | None:
        """The normal load, N or N/mm, as given or of a given peak pressure; None of others."""
        if load.pressure is None:
            return load.normal
        contact = self.hertz(load)
        return None if contact is None else contact.load
