"""The mesh of a scene that does not give one."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from tractive_sam.contact.measured import Gap, refine_for_maps, rough_maps
from tractive_sam.mechanics import hertz_line
from tractive_sam.rail import Patch
from tractive_sam.results import Grid
from tractive_sam.scene import ALONG, MAX_ELEMENTS, Scene
from tractive_sam.schema import Fault, SceneError, required

MARGIN = 1.15
"""Half length of the domain over the semi-axis of the Hertzian contact."""

ACROSS = 64
"""Elements across the shorter axis of the contact."""


def enlarge(grid: Grid, axes: tuple[bool, bool] = (True, True)) -> Grid:
    """Return a mesh of equal elements whose half length is a quarter larger along some axes."""
    # Factor by which a chosen mesh grows when the contact reaches its edge.
    growth = 1.25
    x, y = (growth if grows else 1.0 for grows in axes)
    return extend_to(grid, (x * grid.half_length[0], y * grid.half_length[1]))


def extend_to(grid: Grid, half_length: tuple[float, float]) -> Grid:
    """Return a mesh with elements added on both sides, until it has at least these half lengths."""
    more = [
        max(0, int(np.ceil(0.5 * n * (required / half - 1.0) - 1e-9))) if n > 1 else 0
        for required, half, n in zip(half_length, grid.half_length, grid.elements, strict=True)
    ]
    if not any(more):
        return grid
    elements = (grid.elements[0] + 2 * more[0], grid.elements[1] + 2 * more[1])
    half_length = (0.5 * elements[0] * grid.dx, 0.5 * elements[1] * grid.dy)
    return replace(grid, half_length=half_length, elements=elements)


def describe_grid_entries(grid: Grid) -> str:
    """Return the [grid] entries of a scene that define a mesh, as text."""
    lengths = ", ".join(f"{half:.10g}" for half in grid.half_length[: grid.directions])
    elements = ", ".join(map(str, grid.elements[: grid.directions]))
    centre = ", ".join(f"{place:.10g}" for place in grid.centre[: grid.directions])
    text = f"grid.half_length=[{lengths}] and grid.elements=[{elements}]"
    return f"grid.centre=[{centre}], {text}" if any(grid.centre) else text


class _Ellipse(NamedTuple):
    """Semi-axes of a contact ellipse, mm."""

    a: float
    b: float


def choose_grid(
    scene: Scene,
    measured: Gap | None = None,
    profiles: tuple[Gap, ...] = (),
    finer: float | None = None,
    patches: Sequence[Patch] = (),
) -> Grid:
    """Return the mesh of a scene: its [grid], completed by the Hertz contact or measured gap.

    Chosen elements are at most twice as long as wide or the reverse; their number is odd, so that
    one is centred on the axis. If a map is finer, they are refined until the unresolved rest does
    not matter (`contact.measured`); with [accuracy] the results decide instead.

    Parameters
    ----------
    scene : Scene
        The scene.
    measured : Gap, optional
        The measured separation of a scene with [gap].
    profiles : tuple of Gap
        Profiles that a [transient] has fixed to the bodies.
    finer : float, optional
        Elements of a chosen mesh along each axis over the usual number; maps are ignored then.
    patches : sequence of Patch
        Patches of a wheel with worn profiles; by default those of the scene.

    Raises
    ------
    SceneError
        If the domain, for example of a measured gap, is too long for elements of this size; if flat
        bodies have only a profile to choose the domain from.
    """
    centre = (0.0, 0.0) if scene.grid is None else scene.grid.place
    grid = replace(_usual_grid(scene, measured, finer or 1.0, patches), centre=centre)
    has_elements = scene.grid is not None and scene.grid.elements is not None
    if has_elements or finer is not None or scene.accuracy is not None:
        return grid
    maps = rough_maps(scene, measured, profiles, grid.half_length)
    return refine_for_maps(grid, [roughness for _, roughness in maps])


def _usual_grid(scene: Scene, measured: Gap | None, finer: float, patches: Sequence[Patch]) -> Grid:
    """Return the mesh of a scene without regard to roughness."""
    # Half length in the lateral direction of a scene that wears; it grows with the contact.
    worn_margin = 1.5
    wears, shifts_only = scene.wear is not None, scene.schedule.shifts
    scene = scene.under_largest_load
    length: tuple[float, ...] | None = None
    elements: tuple[int, ...] | None = None
    if scene.grid is not None:
        length, elements = scene.grid.half_length, scene.grid.elements
    if scene.body.has_roller:
        extent_of_roller = _extent_of_roller(scene, length, finer)
    if length and elements:
        return Grid.from_half_lengths(length, elements)
    if scene.line:
        half, number = _line_extent(scene, measured, length, finer)
        return Grid.from_half_lengths(half, elements or (number,))
    if scene.body.has_roller:
        half_length, side = extent_of_roller
    elif scene.hertz is None:
        half_length, side = _extent_of_gap(required(measured, "gap"), length, finer)
    else:
        lateral = worn_margin if wears else MARGIN
        along = worn_margin if wears and shifts_only else MARGIN  # fretting lets it grow in x, too
        half_length, side = _extent_of_contacts(scene, (along, lateral), length, finer, patches)
    nx, ny = elements or (
        int(2 * np.ceil(half / s - 0.5) + 1) for half, s in zip(half_length, side, strict=True)
    )
    if scene.body.has_ends and not length:  # the faces lie between rows, one row beyond each
        narrow = min(required(body.width, "body.width") for body in scene.body.rollers.values())
        ny = ny if elements else max(ny, 11)
        half_length = half_length[0], 0.5 * narrow * ny / (ny - 2)
    if nx * ny > MAX_ELEMENTS:
        domain = f"a domain of {2 * half_length[0]:g} x {2 * half_length[1]:g} mm"
        cure = "half_length and elements, both given: the chosen mesh would have too many elements"
        raise SceneError([Fault("grid", domain, cure)])
    return Grid(half_length, (nx, ny))


def _line_extent(
    scene: Scene, measured: Gap | None, length: tuple[float, ...] | None, finer: float
) -> tuple[tuple[float, ...], int]:
    """Return (half_length,) and the elements of a line contact; a set `length` is retained."""
    # Elements across a line contact; they cost next to nothing.
    across_line = 512
    if scene.hertz is None:  # flat bodies with a profile along x
        x, *_ = required(measured, "gap")
        length = length or (float(max(-x[0], x[-1])),)
        return length, 2 * int(0.5 * across_line * finer) + 1
    half = [block.hertz.a for block in (scene.spectrum.scenes if scene.spectrum else (scene,))]
    length = length or (MARGIN * max(half),)
    return length, 2 * int(0.5 * across_line * finer * length[0] / min(half)) + 1


def _extent_of_roller(
    scene: Scene, length: tuple[float, ...] | None, finer: float
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return half lengths and element sides of the mesh of a roller, from its nominal line contact.

    Tilt and ends widen the contact by up to about a half. Along a roller the pressure changes
    slowly: elements are four times as long as wide there.

    Raises
    ------
    SceneError
        If ends are so near to each other that what they add is not resolved.
    """
    widths = [required(body.width, "body.width") for body in scene.body.rollers.values()]
    width = min(widths) if scene.body.has_ends else max(widths)
    modulus, radius = scene.body.contact_modulus(0.1 * width), scene.body.radii[0]
    if scene.normal_load is None:
        a = math.sqrt(2.0 * radius * required(scene.load.approach, "load.approach"))
    else:
        a = hertz_line(modulus, radius, scene.normal_load / width).a
    thinnest = 0.003  # below it the pressure is .1 % too large, at .0003 by 2 %
    if scene.body.has_ends and width < thinnest * a:
        value = f"{width:g} mm, with ends, {width / a:.2g} of the half length of the contact"
        name = next(name for name in "AB" if getattr(scene.body, name).width == width)
        raise SceneError([Fault(f"body.{name}.width", value, f"at least {thinnest * a:.3g} mm")])
    dx = 4.0 * a / (ACROSS * finer)
    dy = 2.0 * dx if scene.body.has_ends else 4.0 * dx
    return (length[0], length[1]) if length else (1.6 * a, 0.51 * width), (dx, dy)


def _extent_of_gap(
    measured: Gap, length: tuple[float, ...] | None, finer: float
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return half lengths and element sides of the mesh of flat bodies with a measured gap."""
    x, y, _ = measured
    along, across = length or (float(max(-x[0], x[-1])), float(max(-y[0], y[-1])))
    if length is None and along >= ALONG:
        cure = "a number: a profile across the track does not give the length of the contact"
        raise SceneError([Fault("grid.half_length", "nothing", cure)])
    side = 2.0 * (0.5 * min(along, across)) / (ACROSS * finer)
    return (along, across), (side, side)


def _extent_of_contacts(
    scene: Scene,
    margin: tuple[float, float],
    length: tuple[float, ...] | None,
    finer: float,
    patches: Sequence[Patch],
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return half lengths and element sides of a mesh that contains all blocks or wheel patches.

    `margin` is the half length over the semi-axis, along x and y, of each contact of the scene.
    """
    shifts = scene.spectrum.shifts if scene.spectrum else (0.0,)
    contacts = [block.hertz for block in (scene.spectrum.scenes if scene.spectrum else (scene,))]
    if scene.wheelset is not None:
        # The contact of bodies that overlap in an ellipse is sqrt(2) times smaller.
        contacts = [
            _Ellipse(*(half / math.sqrt(2.0) for half in patch.half_length))
            for patch in patches or scene.wheel_rail.patches
        ]
        shifts = (0.0,) * len(contacts)
    along, lateral = margin
    reach = [lateral * c.b + abs(y) for c, y in zip(contacts, shifts, strict=True)]
    half_x, half_y = length or (along * max(c.a for c in contacts), max(reach))
    if scene.wheelset is not None:  # one mesh for all patches: small ones on fewer elements
        contacts[1:] = [_Ellipse(3.0 * c.a, 3.0 * c.b) for c in contacts[1:]]
    dx, dy = (2.0 * min(getattr(c, axis) for c in contacts) / (ACROSS * finer) for axis in "ab")
    return (half_x, half_y), (min(dx, 2.0 * dy), min(dy, 2.0 * dx))
