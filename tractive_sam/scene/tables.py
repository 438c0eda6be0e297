"""The small tables of a scene: load, creepage, grid, accuracy, subsurface planes; summaries.

Units mm, N, MPa, degrees, revolutions.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal, TypeVar

from pydantic import AfterValidator, BeforeValidator, Field, PlainValidator

from tractive_sam.mechanics import HertzContact, HertzLine
from tractive_sam.safe_text import Html, as_html
from tractive_sam.schema import (
    Check,
    Fault,
    LawTable,
    NamedLaw,
    OptionalPositivePerAxis,
    Positive,
    Real,
    Row,
    Table,
    ValidEntries,
    describe_law_names,
    describe_tables,
    entry,
    exactly_one,
    not_both,
    number_to_tuple,
    optional,
    shorten,
    warn,
)


def describe_load(
    scene: Any, keys: Iterable[str] = ("load", "wheelset", "wear", "load_history", "duty")
) -> dict[str, str]:
    """Describe load, wear and blocks of a scene in a few rows, text by label.

    Parameters
    ----------
    scene : Scene
        The scene.
    keys : iterable of str
        Tables with the rows to return.

    Returns
    -------
    dict of str to str
        Text of the brief rows by their label.
    """
    rows = describe_tables(scene)
    return {row.label: row.text for key in keys for row in rows[key] if row.brief}


def summarize(scene: Any) -> dict[str, str]:
    """Return a short description of a scene, text by label."""
    summary, further, entries = {"title": scene.title or "none"}, [], scene.entries()
    for key, rows in describe_tables(scene).items():
        brief = {row.label: row.text for row in rows if row.brief}
        summary |= brief
        if not brief and entries.get(key) is not None:
            further.append(f"[{key}]")
    if further:
        summary["other tables"] = ", ".join(sorted(further))
    return summary


def format_pair(first: float, second: float) -> str:
    """Return one number if both are equal, else both in parentheses."""
    return f"{first:g}" if first == second else f"({first:g}, {second:g})"


def draw_ellipse(hertz: Any, side: int = 190) -> Html:
    """Return a drawing (SVG) of the Hertz contact ellipse, true to scale, x upwards.

    Parameters
    ----------
    hertz : HertzContact or HertzLine or None
        The contact; the result is empty for None and for a line contact.
    side : int
        Side of the drawing, pixels.
    """
    if hertz is None or math.isinf(hertz.b):
        return Html()
    largest = max(hertz.a, hertz.b)
    rx, ry, half = 0.33 * side * hertz.b / largest, 0.33 * side * hertz.a / largest, side / 2
    axes = as_html(f"2a = {2 * hertz.a:.3g} mm, 2b = {2 * hertz.b:.3g} mm")
    size, blue = 'font-size="12"', "#0072b2"
    parts = (
        f'<svg width="{side}" height="{side + 18}" role="img" aria-label="{axes}">',
        f'<path d="M{half} {side - 6}V6m-4 7 4-7 4 7M6 {half}H{side - 6}" stroke="#999" ',
        f'fill="none"/><ellipse cx="{half}" cy="{half}" rx="{rx:.1f}" ry="{ry:.1f}" fill="{blue}" ',
        f'fill-opacity=".3" stroke="{blue}"/><text x="{half + 7}" y="15" {size}>x</text>',
        f'<text x="{side - 14}" y="{half - 6}" {size}>y</text>',
        f'<text x="{half}" y="{side + 13}" text-anchor="middle" {size}>{axes}</text></svg>',
    )
    return Html("".join(parts))


class PointContact:
    """Units and motions of a contact of finite width, as opposed to a line contact.

    Attributes
    ----------
    creepages : tuple of str
        Relative motions of the rigid bodies.
    weibull_slope : float
        Usual slope of the Weibull distribution of lives, for ball bearings (Lundberg and Palmgren
        1947).
    """

    creepages: ClassVar[tuple[str, ...]] = ("xi_x", "xi_y", "spin")
    weibull_slope: ClassVar[float] = 10.0 / 9.0

    def unit(self, unit: str) -> str:
        """Return the unit of a quantity of the full contact, unchanged for a point contact."""
        return unit


class LineContact(PointContact):
    """Units and motions of a line contact: bodies infinitely long in y, plane strain.

    Resultants, areas and volumes are per length, mm. The slip by spin would vary in y. The usual
    slope of lives is for roller bearings (Lundberg and Palmgren 1952).
    """

    creepages = ("xi_x", "xi_y")
    weibull_slope = 9.0 / 8.0

    def unit(self, unit: str) -> str:
        """Return the unit per length of a quantity: N/mm for N."""
        return {"mm3": "mm2", "mm2": "mm"}.get(unit, f"{unit}/mm")


@dataclass(frozen=True)
class Plane:
    """Plane x, y or z = number below the contact, with the text form ``y=0.75a``.

    Parameters
    ----------
    axis : "x", "y" or "z"
        The normal of the plane; z is the depth below the surface of a body.
    number : float
        The position; mm, or multiples of `unit`.
    unit : "", "a" or "b"
        Empty for mm, or the semi-axis of the unworn contact in x or in y.
    label : str
        Name of what lies on it, in place of its text form: "inclusion-1".
    """

    axis: Literal["x", "y", "z"]
    number: float
    unit: Literal["", "a", "b"] = ""
    label: str = ""

    @classmethod
    def parse(cls, text: object) -> Plane:
        """Return the plane that a text ``<axis>=<number>[a|b]`` describes.

        Raises
        ------
        ValueError
            If the text has another form, or the plane is above the surface (z < 0).
        """
        if isinstance(text, Plane):
            return text
        number_form = r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?"
        form = rf"(?P<axis>[xyz])\s*=\s*(?P<number>{number_form})\s*(?P<unit>[ab]?)"
        parts = re.fullmatch(form, text.strip(), re.ASCII) if isinstance(text, str) else None
        if not parts:
            examples = '"y=0", "x=-0.3" (mm), "y=0.75a" or "z=0.5b" (semi-axes of the contact)'
            raise ValueError(f"planes like {examples}")
        number = float(parts["number"]) + 0.0  # no negative zero
        if parts["axis"] == "z" and number < 0:
            raise ValueError("a depth z of at least 0")
        if abs(number) > 1e30:
            raise ValueError("a plane at a finite distance")
        # The form allows no other names.
        return cls(parts["axis"], number, parts["unit"])  # type: ignore[arg-type]

    def value_in(self, a: float, b: float) -> float:
        """Return the position of the plane in mm, for a contact with the semi-axes a, b in mm."""
        return self.number * {"": 1.0, "a": a, "b": b}[self.unit]

    def __str__(self) -> str:
        return self.label or f"{self.axis}={repr(self.number).removesuffix('.0')}{self.unit}"


Item = TypeVar("Item")


def check_distinct(items: tuple[Item, ...]) -> tuple[Item, ...]:
    """Return items unchanged; raise a ValueError if one occurs twice."""
    if len(set(items)) < len(items):
        raise ValueError("each item once")
    return items


class Load(Table):
    """Normal load, approach or pressure, and prescribed tangential forces.

    In a line contact (both bodies with ``radius_y = inf``), forces are given per unit length, N/mm.

    Examples
    --------
    >>> ts.Load(normal=300.0, force_x=120.0).force_x
    120.0
    """

    normal: Positive | None = optional("normal load P, N; in a line contact, N/mm")
    approach: Real | None = optional(
        "approach of the bodies, mm; it is zero at the first touch of the unworn bodies or at "
        "the zero of the separation (see gap.datum)",
        'a number above 0; with gap.datum = "separation", any number',
    )
    pressure: Positive | None = optional(
        "peak contact pressure p0 of the unworn bodies according to Hertz, MPa; the load "
        "follows from it"
    )
    tilt: Real | None = optional(
        "angle between the axes of rollers with a profile, mrad: they are farther apart at y > 0",
        "a number from -100 to 100",
        ge=-100,
        le=100,
    )
    moment: Real | None = optional(
        "moment of the pressure about the x axis, the integral of p y, N mm, in place of tilt, "
        "which is found"
    )
    force_x: Real | None = optional("prescribed force Q_x on body A, N or N/mm")
    force_y: Real | None = optional("prescribed force Q_y on body A, N or N/mm")
    checks: ClassVar[tuple[Check, ...]] = (
        exactly_one("normal", "approach", "pressure"),
        not_both("tilt", "moment"),
    )
    key_advice: ClassVar[Mapping[str, str]] = {
        f"traction_{axis}": f"force_{axis}, the new name of the key" for axis in "xy"
    }

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield report rows (label, text): the load and the peak pressure by Hertz.

        Parameters as in `Table.describe`.
        """
        if scene.wheelset is not None:
            return  # reported with the wheelset; its patches are no Hertz contacts
        hertz, unit = scene.hertz, scene.force_unit
        by = "by Hertz, with the equivalent modulus" if scene.body.depends_on_length else "by Hertz"
        key, value = self.prescribed_key, getattr(self, self.prescribed_key)
        name, unit_of_key = {"normal": ("P", unit), "approach": ("approach", "mm")}.get(
            key, ("p0", f"MPa {by}, unworn")
        )
        text = f"{name} = {value:g} {unit_of_key}"
        if hertz is None:
            yield Row("load", text, brief=True)
            return
        computed = {
            "P": f"P = {hertz.load:.6g} {unit}",
            "p0": f"p0 = {hertz.p0:.6g} MPa {by}, unworn",
        }
        rest = " and ".join(part for symbol, part in computed.items() if symbol != name)
        yield Row("load", f"{text}: {rest}", brief=True)
        yield Row("unworn contact (Hertz)", hertz.describe())

    @property
    def prescribed_key(self) -> str:
        """Which key gives the load: "normal", "approach" or "pressure"."""
        keys = (key for key in ("pressure", "approach") if getattr(self, key) is not None)
        return next(keys, "normal")


class Creepage(Table):
    """Creepages, spin and rolling speed of the rigid bodies.

    Examples
    --------
    >>> ts.Creepage(longitudinal=-0.005, spin=0.01)
    Creepage(longitudinal=-0.005, lateral=0.0, spin=0.01, speed=None)
    """

    key_advice: ClassVar[Mapping[str, str]] = {"slip": "longitudinal, lateral or spin"}
    longitudinal: Real = entry("longitudinal creepage xi_x", default=0.0)
    lateral: Real = entry("lateral creepage xi_y", default=0.0)
    spin: Real = entry("spin creepage phi, 1/mm", default=0.0)
    speed: Positive | None = optional(
        "rolling speed V, mm/s; required by [heat] and by laws that depend on the sliding speed"
    )

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield report rows: creepages other than zero, and forces prescribed for creepages.

        Parameters as in `Table.describe`.
        """
        load, courses, unit = scene.load, scene.schedule.courses, scene.force_unit
        drives = {
            "load.force_x": ("Q_x", load.force_x, f" {unit} (creepage found)"),
            "load.force_y": ("Q_y", load.force_y, f" {unit} (creepage found)"),
            "creepage.longitudinal": ("xi_x", self.longitudinal or None, ""),
            "creepage.lateral": ("xi_y", self.lateral or None, ""),
            "creepage.spin": ("spin", self.spin or None, " /mm"),
        }
        parts = [
            f"{name} as in [transient]" if key in courses else f"{name} = {value:g}{unit}"
            for key, (name, value, unit) in drives.items()
            if value is not None or key in courses
        ]
        yield Row("rolling", ", ".join(parts) or "free", brief=True)


_Elements = Annotated[int, Field(ge=3, le=10**6)]
_ElementsPerAxis = Annotated[
    tuple[_Elements, ...], BeforeValidator(number_to_tuple), Field(min_length=1, max_length=2)
]


_Centre = Annotated[
    tuple[Real, ...], BeforeValidator(number_to_tuple), Field(min_length=1, max_length=2)
]

MAX_ELEMENTS = 5 * 10**7
"""Largest number of elements of a grid: more would need several hundred GiB."""


def _check_number_of_elements(entries: ValidEntries) -> Iterator[Fault]:
    """Report a grid with more elements than any machine has memory for."""
    elements = entries["elements"]
    if elements is not None and math.prod(elements) > MAX_ELEMENTS:
        yield Fault("elements", str(elements), f"at most {MAX_ELEMENTS:.0e} elements in all")


def _check_shape_of_elements(entries: ValidEntries, longest: float = 1e6) -> Iterator[Fault]:
    """Report elements whose longer side is more than `longest` times the other one.

    Parameters
    ----------
    entries : ValidEntries
        Entries of [grid].
    longest : float
        Largest ratio of the sides of an element.
    """
    half_length, elements = entries["half_length"] or (), entries["elements"] or ()
    if len(half_length) == len(elements) == 2:
        dx, dy = (length / n for length, n in zip(half_length, elements, strict=True))
        if not 1.0 / longest <= dx / dy <= longest:
            size = f"elements of {2 * dx:.3g} x {2 * dy:.3g} mm"
            yield Fault("half_length", size, f"elements at most {longest:g} times as long as wide")


def _check_centre_of_domain(entries: ValidEntries) -> Iterator[Fault]:
    """Report a grid centre without half lengths, or with another number of directions."""
    centre, half_length = entries["centre"], entries["half_length"]
    if centre is None:
        return
    if half_length is None:
        cure = "nothing without grid.half_length: the default domain is centred at the origin"
        yield Fault("centre", shorten(centre), cure)
    elif len(centre) != len(half_length):
        allowed = f"as many numbers as grid.half_length: {len(half_length)}"
        yield Fault("centre", shorten(centre), allowed)


def _check_grid_is_not_empty(entries: ValidEntries) -> Iterator[Fault]:
    """Report a [grid] without keys."""
    if entries["half_length"] is None and entries["elements"] is None:
        yield Fault("half_length", "nothing", "half_length, elements or both; or remove [grid]")


class Mesh(Table):
    """Rectangle of equal elements around the origin or another centre.

    In a line contact, each pair is a single number, the value in x. Without `half_length`, the
    domain follows from the contact, as in a scene without [grid]. It grows with the contact; the
    element size does not change. Without `elements`, the element size follows from the contact.

    Examples
    --------
    >>> ts.Mesh(half_length=(0.35, 1.4), elements=(41, 121)).elements
    (41, 121)
    """

    half_length: OptionalPositivePerAxis = optional(
        "half-lengths of the domain in x and y, mm; by default, they follow from the contact",
        "a pair of numbers above 0",
    )
    elements: _ElementsPerAxis | None = optional(
        "numbers of elements of the mesh in x and y; by default, they follow from the contact",
        "a pair of integers from 3 to 1e6",
    )
    centre: _Centre | None = optional(
        "centre of the domain in x and y, mm; by default, the origin, which is the vertex of "
        "the radii",
        "a pair of numbers",
    )
    checks: ClassVar[tuple[Check, ...]] = (
        _check_grid_is_not_empty,
        _check_centre_of_domain,
        _check_number_of_elements,
        _check_shape_of_elements,
    )

    @property
    def place(self) -> tuple[float, float]:
        """Centre (x, y) of the mesh, mm; the origin by default."""
        x, y = (*(self.centre or ()), 0.0, 0.0)[:2]
        return x, y

    @property
    def origin(self) -> str:
        """Text that says whether domain and elements are set, or chosen from the contact."""
        if self.half_length is None:
            return "given, the domain chosen from the contact"
        return "given" if self.elements else "chosen from the contact, the domain given"


class Accuracy(Table):
    """Requested relative error, from which mesh and tolerances follow.

    The mesh is refined until the error bars of the forces, the moment and the wear depth are within
    the tolerance. For unworn bodies, this criterion also includes the peak contact pressure. The
    error bar of the largest stress does not affect the mesh and may be wider.

    Examples
    --------
    >>> ts.Accuracy(tolerance=1e-2).elements
    300000
    """

    tolerance: Real = entry("relative error of the results", default=1e-3, ge=1e-5, le=0.1)
    elements: int = entry(
        "largest number of elements of the mesh", default=300_000, ge=1000, le=5 * 10**7
    )

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield a report row with the tolerance and how the mesh is refined to meet it."""
        yield Row(
            "requested",
            f"{self.tolerance:g}, relative: the mesh is refined until the error bars are within "
            "this tolerance; with [wear] two coarser meshes are rolled first, and show whether it "
            "must be refined further",
        )


class Subsurface(Table):
    """Planes, depths and bodies for which stress is computed.

    Examples
    --------
    >>> ts.Subsurface(planes=("y=0", "x=0.5a"), depth=2.0).bodies
    ('A', 'B')
    """

    planes: Annotated[
        tuple[Annotated[Plane, PlainValidator(Plane.parse)], ...], AfterValidator(check_distinct)
    ] = entry(
        "planes on which the stress is computed", 'a list of planes like "y=0.75a"', min_length=1
    )
    depth: Positive = entry("depth, in units of the semi-axis a", default=1.5)
    elements: int = entry("number of points along the depth", default=64, ge=2, le=10**6)
    bodies: Annotated[tuple[Literal["A", "B"], ...], AfterValidator(check_distinct)] = entry(
        "bodies for which the stress is computed", default=("A", "B"), min_length=1
    )
    effect: ClassVar[str] = "stress"

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield report rows: bodies, planes and depths for which stress is computed."""
        hertz = scene.hertz
        deepest = f"{self.depth:g} a" if hertz is None else f"{self.depth * hertz.a:.4g} mm"
        yield Row("bodies", ", ".join(self.bodies))
        yield Row("planes", f"{', '.join(map(str, self.planes))}, with the stored fields")
        yield Row("depths", f"{self.elements} down to {deepest}, denser towards the surface")


class ElasticBodies(LawTable):
    """Homogeneous half-spaces, or a user-defined elastic law.

    The parameters of a law of another package are further keys. If the law has parameters `A` and
    `B`, it receives the materials of the bodies. The mesh and the units follow from the Hertz
    contact of homogeneous bodies.

    Examples
    --------
    >>> ts.ElasticBodies(law="my_package:Coated", thickness=0.1).law.parameters
    {'thickness': 0.1}
    """

    law: Literal["half-spaces"] | NamedLaw = entry(
        "elastic law: how tractions displace the surfaces of the bodies",
        describe_law_names(("half-spaces",)),
        "half-spaces",
    )
    law_names: ClassVar[tuple[str, ...]] = ("half-spaces",)

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield a report row with the name of a user-defined elastic law; none for half-spaces."""
        if self.named_law:
            yield Row("elasticity", f"{self.named_law}, in place of half-spaces", brief=True)


class Solver(Table):
    """Methods and tolerance of the solution of the contact.

    Examples
    --------
    >>> ts.Solver(method="newton", tolerance=1e-6).method
    'newton'
    """

    method: Literal["auto", "uzawa", "anderson", "newton"] = entry(
        'method for the tangential problem; "uzawa" is the method of the paper', default="auto"
    )
    slip: Literal["auto", "upwind"] = entry(
        'discretisation of the slip: "auto" is of second order; "upwind", the scheme of the '
        "paper, is of first order",
        default="auto",
    )
    tolerance: Real = entry(
        "relative tolerance of the contact conditions", default=1e-8, ge=1e-13, le=1e-2
    )


@dataclass(frozen=True)
class FewestElements:
    """Smallest numbers of elements across a contact that resolve contact and slip.

    Attributes
    ----------
    contact : int
        For the contact itself: with one or two elements its extent and its pressure depend on the
        mesh only, and no element has neighbours in contact on both sides.
    slip : int
        Number that resolves a stick and a slip area.
    """

    contact: int = 3
    slip: int = 8


def warn_if_coarse(grid: Mesh, contact: HertzContact | HertzLine, margin: float = 1.15) -> None:
    """Issue a warning if a grid is too coarse to resolve the Hertz contact.

    Parameters
    ----------
    grid : Mesh
        The grid of the scene.
    contact : HertzContact or HertzLine
        The unworn contact on it.
    margin : float
        Advised half length over the semi-axis, as for a chosen mesh.
    """
    if grid.elements is None:
        return
    elements = grid.elements if len(grid.elements) > 1 else grid.elements[0]
    semi_axes = (contact.a, contact.b)[: len(grid.elements)]
    half_length = grid.half_length or semi_axes
    sides = [*zip("xy", grid.elements, half_length, semi_axes, strict=False)]
    across = [n * semi_axis / half for _, n, half, semi_axis in sides]
    if min(across) >= FewestElements.slip:
        return
    if min(across) < FewestElements.contact:
        covered = " x ".join(f"{count:.2g}" for count in across)
        advised = ", ".join(f"{margin * semi_axis:.3g}" for semi_axis in semi_axes)
        fewest = math.ceil(FewestElements.slip * margin)
        needed = (
            f" and at least {fewest} elements per direction" if min(grid.elements) < fewest else ""
        )
        warn(
            f"grid.elements: {elements} do not resolve the Hertz contact, which covers {covered} "
            "of them in x and y; check the units of [load] and of the radii, or use "
            f"grid.half_length = [{advised}]{needed}"
        )
        return
    needs = [
        f"at least {math.ceil(FewestElements.slip * half / semi_axis)} in {axis}"
        for (axis, _, half, semi_axis), count in zip(sides, across, strict=True)
        if count < FewestElements.slip
    ]
    warn(f"grid.elements: {elements} resolves the contact poorly; use {', '.join(needs)}")
