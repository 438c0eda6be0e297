"""Inclusions of a body, [[inclusion]]: their shape, place, stiffness and misfit."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field

from tractive_sam.mechanics import Material
from tractive_sam.schema import (
    Check,
    Fault,
    NotNegative,
    Positive,
    Real,
    Row,
    Table,
    ValidEntries,
    entry,
    exactly_one,
    optional,
    shorten,
)

from .checks import is_line


def _fill_stiffness(value: Any) -> Any:
    """Return the rows of a stiffness of named constants; missing ones follow from symmetry."""
    if not isinstance(value, Mapping) or not {"C11", "C12", "C44"} <= set(value):
        return value
    names = {"C11", "C12", "C13", "C22", "C23", "C33", "C44", "C55", "C66"}
    if not set(value) <= names:
        return value
    filled = {"C22": "C11", "C33": "C11", "C13": "C12", "C55": "C44"}
    C = {name: value.get(name, value.get(like)) for name, like in filled.items()}
    C |= {"C23": C["C13"], **value}
    if "C66" not in value:
        cubic = not {"C13", "C33"} & set(value)
        C["C66"] = C["C44"] if cubic else 0.5 * (C["C11"] - C["C12"])
    rows = np.diag([C[f"C{k}{k}"] for k in range(1, 7)]).tolist()
    for i, j in combinations(range(3), 2):
        rows[i][j] = rows[j][i] = C[f"C{i + 1}{j + 1}"]
    return tuple(map(tuple, rows))


def _repeat(value: Any) -> Any:
    """Return (x, x, x) for a number x; other values unchanged."""
    return (value,) * 3 if isinstance(value, int | float) and not isinstance(value, bool) else value


_Lengths = Annotated[tuple[Positive, Positive, Positive], BeforeValidator(_repeat)]
_Rows = Annotated[tuple[Real, ...], Field(min_length=6, max_length=6)]
_Stiffness = Annotated[
    tuple[_Rows, ...], BeforeValidator(_fill_stiffness), Field(min_length=6, max_length=6)
]
_Strains = Annotated[
    tuple[Annotated[Real, Field(ge=-0.1, le=0.1)], ...],
    BeforeValidator(lambda value: value if _repeat(value) is value else (*_repeat(value), 0, 0, 0)),
]


def _check_material(entries: ValidEntries) -> Iterator[Fault]:
    """Report a stiffness that no stable material has, and a modulus without Poisson's ratio."""
    if "stiffness" in entries.given:
        rows = np.array(entries["stiffness"])
        if np.abs(rows - rows.T).max() > 1e-6 * np.abs(rows).max():
            yield Fault("stiffness", "rows unlike the columns", "a symmetric matrix, MPa")
        elif np.linalg.eigvalsh(rows).min() <= 0.0:
            cure = "a matrix whose eigenvalues are all positive, MPa"
            yield Fault("stiffness", "of an unstable material", cure)
        if "poisson" in entries.given:
            yield Fault("poisson", "with stiffness", "young with poisson, or stiffness")
    elif entries["young"] and entries["poisson"] is None:
        yield Fault("poisson", "nothing, with young", "a number from 0 to below 0.5")
    void = entries["young"] == 0.0
    if void and "eigenstrain" in entries.given:
        yield Fault("eigenstrain", "of a void", "nothing: a void has no misfit")


def _check_depth(entries: ValidEntries) -> Iterator[Fault]:
    """Report an inclusion that reaches the surface."""
    radii, size = entries["radii"], entries["size"]
    half = radii[2] if radii else 0.5 * size[2] if size else 0.0
    if entries["at"][2] <= half:
        cure = f"a depth above {half:g} mm, its half height: it lies below the surface"
        yield Fault("at", shorten(list(entries["at"])), cure)


class Inclusion(Table):
    """Inclusion in a body: an ellipsoid or a cuboid of another material, a void, or a misfit.

    Its faces or axes are parallel to x, y and the depth. It passes below the contact as the body
    rolls.

    Examples
    --------
    >>> alumina = ts.Inclusion(at=[0.0, 0.0, 0.2], radii=0.01, young=389e3, poisson=0.25)
    >>> alumina.half
    (0.01, 0.01, 0.01)
    """

    key_advice: ClassVar[Mapping[str, str]] = {
        "radius": "radii",
        "diameter": "radii, half of it",
        "depth": "at, with x, y and the depth",
        "E": "young",
    }
    body: Literal["A", "B"] = entry("the body that contains it", default="A")
    at: tuple[Real, Real, Positive] = entry(
        "x, y and depth of its centre below the unworn surface, mm; x counts between inclusions",
        "a list of three numbers, the depth above 0",
    )
    radii: _Lengths | None = optional(
        "semi-axes of an ellipsoid along x, y and the depth, mm; a number is that of a sphere",
        "a number above 0, or a list of three of them",
    )
    size: _Lengths | None = optional(
        "sides of a cuboid along x, y and the depth, mm; a number is that of a cube",
        "a number above 0, or a list of three of them",
    )
    young: NotNegative | None = optional("Young's modulus, MPa; 0 is a void", le=1e9)
    poisson: Real | None = optional("Poisson's ratio", ge=0, lt=0.5)
    stiffness: _Stiffness | None = optional(
        "stiffness of an anisotropic material, MPa: 6 x 6 for stresses and engineering strains xx, "
        "yy, zz, yz, xz, xy; or C11, C12, C44 and others by names, of a cubic or hexagonal crystal",
        "a list of six lists of six numbers, or a table of C11, C12, C44 and others",
    )
    eigenstrain: _Strains | None = optional(
        "strain that it would have without the body, from swelling or cooling: xx, yy, zz, xy, xz, "
        "yz of the tensor; a number is equal along all axes",
        "a number, or a list of six numbers, from -0.1 to 0.1",
        min_length=6,
        max_length=6,
    )
    lifts: bool = entry(
        "whether its displacement of the surface changes the contact while it passes below",
        default=False,
    )
    cells: int = entry(
        "cells across the smallest inclusion of those close to each other", default=11, ge=5, le=63
    )
    checks: ClassVar[tuple[Check, ...]] = (
        exactly_one("radii", "size"),
        exactly_one("young", "stiffness"),
        _check_material,
        _check_depth,
    )

    @property
    def is_ellipsoid(self) -> bool:
        """Whether it is an ellipsoid; if not, it is a cuboid."""
        return self.radii is not None

    @property
    def half(self) -> tuple[float, float, float]:
        """Half of its extent along x, y and the depth, mm."""
        if self.radii is not None:
            return self.radii
        x, y, z = self.size or (0.0, 0.0, 0.0)
        return 0.5 * x, 0.5 * y, 0.5 * z

    @property
    def volume(self) -> float:
        """Volume, mm^3."""
        return math.prod(self.half) * (4.0 * math.pi / 3.0 if self.is_ellipsoid else 8.0)

    @property
    def misfit(self) -> tuple[float, ...]:
        """Strain xx, yy, zz, xy, xz, yz that it would have without the body."""
        return self.eigenstrain or (0.0,) * 6

    @property
    def matrix(self) -> NDArray[np.float64]:
        """Stiffness (6, 6), from strains xx, yy, zz, xy, xz, yz of tensors to stresses, MPa."""
        if self.stiffness is not None:
            order = [0, 1, 2, 5, 4, 3]  # of xx, yy, zz, xy, xz, yz among xx, yy, zz, yz, xz, xy
            rows = np.array(self.stiffness)[np.ix_(order, order)]
            return rows * np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
        young, nu = self.young or 0.0, self.poisson or 0.0
        shear = 0.5 * young / (1.0 + nu)
        rows = 2.0 * shear * np.eye(6)
        rows[:3, :3] += 2.0 * shear * nu / (1.0 - 2.0 * nu)
        return rows

    @classmethod
    def describe_array(cls, inclusions: Sequence[Inclusion], scene: Any) -> Iterator[Row]:
        """Yield a row for each inclusion, and one on what is left out, for reports of a scene."""
        for k, one in enumerate(inclusions):
            shape = "radii" if one.is_ellipsoid else "half sides"
            text = f"in body {one.body}, {shape} {' x '.join(f'{h:.4g}' for h in one.half)} mm at "
            text += f"({', '.join(f'{place:.4g}' for place in one.at)}) mm, "
            if one.stiffness is not None:
                text += "anisotropic"
            else:
                text += f"E = {one.young:g} MPa" if one.young else "void"
            text += ", with misfit" if any(one.misfit) else ""
            text += "; its lift of the surface changes the contact" if one.lifts else ""
            yield Row(f"inclusion {k + 1}", text)
        if inclusions:
            left_out = "plasticity, cracks, and bonds that open"
            if not all(one.lifts for one in inclusions):
                left_out = f"displacement of the surface in the gap without lifts; {left_out}"
            yield Row("left out", left_out)


def check_inclusions(entries: ValidEntries) -> Iterator[Fault]:
    """Report inclusions in bodies that are not isotropic, and inclusions that overlap."""
    inclusions: tuple[Inclusion, ...] = entries["inclusion"]
    if inclusions and entries["transient"] is not None and entries["transient"].schedule.shifts:
        yield Fault("inclusion", "with shifts", "bodies that roll: inclusions pass the contact")
    for k, one in enumerate(inclusions):
        if one.lifts:
            yield from (
                Fault(f"inclusion[{k}].lifts", f"true, {reason}", cure)
                for is_so, reason, cure in (
                    (
                        is_line(entries),
                        "in a line contact",
                        "false, or a finite radius_y of one body: the lift ends across the track",
                    ),
                    (
                        entries["transient"] is not None,
                        "with [transient]",
                        "false, or steady rolling: each contact above inclusions is a steady one",
                    ),
                    (
                        entries["wheel"] is not None,
                        "with [wheel]",
                        "false, or radii and a [gap]: the patches of a wheel share their load",
                    ),
                )
                if is_so
            )
        width = getattr(entries["body"], one.body).width
        if width is not None and abs(one.at[1]) + one.half[1] > 0.5 * width:
            cure = f"y within {0.5 * width - one.half[1]:g} mm of 0: the body is {width:g} mm wide"
            yield Fault(f"inclusion[{k}].at", shorten(list(one.at)), cure)
        if not isinstance(entries["body"].responses[one.body], Material):
            cure = "a body of young or shear and poisson, without layers or stiffness"
            yield Fault(f"inclusion[{k}].body", one.body, cure)
        elif entries["body"].responses[one.body].poisson >= 0.5:
            yield Fault(f"inclusion[{k}].body", one.body, "a body with a Poisson's ratio below 0.5")
    for (i, one), (k, other) in combinations(enumerate(inclusions), 2):
        apart = np.abs(np.subtract(one.at, other.at)) / np.add(one.half, other.half)
        spheres = one.is_ellipsoid and other.is_ellipsoid
        if one.body == other.body and (np.linalg.norm(apart) if spheres else apart.max()) < 1.0:
            cure = f"a place outside of inclusion[{i}], which it overlaps"
            yield Fault(f"inclusion[{k}].at", shorten(list(other.at)), cure)
