"""Roughness: the part of a measured map that a mesh does not resolve, and a fine enough mesh.

The gap is sampled at the centres of elements, like the displacements. Waves between
the samples of the mesh are not resolved: they appear as longer ones. A wave of amplitude h and wave
number q is flattened by a pressure of the amplitude E* q h/2 (Johnson 1985, Contact Mechanics,
13.2), and many waves by E*/2 times their rms slope. So the slope of the unresolved part shows
whether it matters, compared with the pressure of the contact. Its height does not: white noise has
one height on all meshes, while a smooth profile has little slope between the elements however
finely it was sampled.

The map is not averaged over the elements. An average would lower all summits, and with them the
pressure, without a warning, and would shift profiles that are resolved.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from tractive_sam.contact.measured import Gap, interpolate, samples_per_length
from tractive_sam.results import Grid
from tractive_sam.scene import Scene
from tractive_sam.schema import required


@dataclass(frozen=True)
class UnresolvedPart:
    """Samples of a map per element, and the rms height and slope that the mesh does not resolve.

    Attributes
    ----------
    samples : float
        Samples of the map per element.
    height, slope : float
        Root mean square of the difference between the map and its interpolation from the mesh, mm,
        and of its slope.
    """

    samples: float
    height: float
    slope: float


@dataclass(frozen=True, eq=False)
class Roughness:
    """A measured height map and the contact pressure, to judge whether a mesh resolves the map.

    Attributes
    ----------
    map : Gap
        Coordinates and heights, mm.
    e_star : float
        Combined modulus, MPa.
    pressure : float
        Pressure of the contact without the map, MPa.
    travels : bool
        Whether the map passes through the contact in x, so that all of it counts.
    share : float
        Largest pressure that flattens the unresolved part, over the pressure of the contact. At a
        tenth the usual mesh resolves the kinks of worn profiles; roughness that is not resolved
        takes a multiple.
    """

    map: Gap
    e_star: float
    pressure: float
    travels: bool = False
    share: float = 0.1

    def unresolved_parts(self, grid: Grid) -> tuple[UnresolvedPart, UnresolvedPart]:
        """Return the parts of the map that a mesh does not resolve, along x and along y."""
        x, y, heights = self.map
        if grid.elements[1] == 1:  # a row: only y = 0 counts
            heights = interpolate(y, heights.T, np.clip([0.0], y[0], y[-1])).T
            return self._along(x, heights, grid.x, grid.dx), UnresolvedPart(0.0, 0.0, 0.0)
        near_y = np.abs(y - grid.centre[1]) <= grid.half_length[1]
        near_x = np.abs(x - grid.centre[0]) <= (math.inf if self.travels else grid.half_length[0])
        of_x = heights[:, near_y] if near_y.any() else heights
        of_y = heights[near_x] if near_x.any() else heights
        return (
            self._along(x, of_x, grid.x, grid.dx),
            self._along(y, of_y.T, grid.y, grid.dy, travels=False),
        )

    def _along(
        self, axis: np.ndarray, heights: np.ndarray, at: np.ndarray, side: float, travels=None
    ) -> UnresolvedPart:
        """Return rms height and slope along the first axis that points `at` miss; or zeros."""
        samples = side * samples_per_length(axis)
        if self.travels if travels is None else travels:
            at = np.arange(axis[0], axis[-1] + side, side)
        at = np.clip(at, axis[0], axis[-1])
        at = np.unique(at)
        inside = (axis >= at[0]) & (axis <= at[-1])
        if samples <= 1.0 or at.size < 3 or np.count_nonzero(inside) < 3:
            return UnresolvedPart(samples, 0.0, 0.0)
        seen = interpolate(at, interpolate(axis, heights, at), axis[inside])
        rest = heights[inside] - seen
        slopes = np.diff(rest, axis=0) / np.diff(axis[inside])[:, None]
        height, slope = (float(np.sqrt(np.mean(part**2))) for part in (rest, slopes))
        return UnresolvedPart(samples, height, slope)

    def flattening(self, part: UnresolvedPart) -> float:
        """Return the rms pressure that would flatten an unresolved part, MPa."""
        return 0.5 * self.e_star * part.slope

    def unresolved(self, grid: Grid) -> tuple[bool, bool]:
        """Return whether a mesh fails to resolve the map, as (along x, along y)."""
        allowed = self.share * self.pressure
        along_x, along_y = (self.flattening(part) > allowed for part in self.unresolved_parts(grid))
        return along_x, along_y

    def resolving(self, grid: Grid) -> Grid:
        """Return a mesh of the same domain, refined until it resolves the map.

        Its elements are shorter by roots of 2, and not shorter than the step of the map; their
        number along a refined axis is odd.
        """
        steps = [1.0 / max(samples_per_length(coordinates), 1e-300) for coordinates in self.map[:2]]
        while any(coarse := self.unresolved(grid)):
            elements: list[int] = []
            for n, half, step, refine in zip(
                grid.elements, grid.half_length, steps, coarse, strict=True
            ):
                finest = _odd(2.0 * half / step)
                elements.append(min(_odd(math.sqrt(2.0) * n), max(n, finest)) if refine else n)
            along, across = elements
            if (along, across) == grid.elements:
                break
            grid = replace(grid, elements=(along, across))
        return grid


def _odd(number: float) -> int:
    """Return the smallest odd integer that is at least this number."""
    return 2 * math.ceil(0.5 * (number - 1.0) - 1e-9) + 1


def rough_maps(
    scene: Scene, measured: Gap | None, profiles: tuple[Gap, ...], half_length: tuple[float, ...]
) -> Iterator[tuple[str, Roughness]]:
    """Yield (table, roughness) for the measured [gap] of a scene and its moving profiles.

    Parameters
    ----------
    scene : Scene
        The scene.
    measured : Gap, optional
        The map of its [gap].
    profiles : tuple of Gap
        Profiles that its [transient] has fixed to the bodies.
    half_length : tuple of float
        Half lengths of the mesh, mm; they stand for the contact if the radii do not close.
    """
    e_star, pressure = (
        scene.material.plane_strain_modulus,
        _pressure(scene.under_largest_load, half_length),
    )
    if measured is not None:
        yield "gap", Roughness(measured, e_star, pressure)
    if profiles:
        for table, profile in zip(scene.schedule.profiles, profiles, strict=True):
            yield table, Roughness(profile, e_star, pressure, travels=scene.schedule.rolls)


def _pressure(scene: Scene, half_length: tuple[float, ...]) -> float:
    """Return the largest Hertz pressure of a scene, MPa; an estimate without Hertz contact."""
    if scene.hertz is not None:
        return scene.hertz.p0
    length = 0.5 * math.sqrt(half_length[0] * half_length[-1])
    if scene.normal_load is not None:
        return scene.normal_load / (math.pi * length**2)
    # The interference of a separation that is not counted from the first touch is not known yet.
    approach = max(required(scene.load.approach, "load.approach"), 1e-3 * length)
    return 0.5 * scene.material.plane_strain_modulus * approach / length


def refine_for_maps(
    grid: Grid, maps: list[Roughness], max_elements: int = 2**17, slender: float = 5.0
) -> Grid:
    """Return a mesh fine enough for the maps, or the given mesh if that is too large.

    A mesh that resolves a part of the waves costs more and settles nothing.

    Parameters
    ----------
    grid : Grid
        The usual mesh.
    maps : list of Roughness
        The maps.
    max_elements : int
        Most elements of the finer mesh: a contact on them takes seconds to a minute.
    slender : float
        Largest ratio of the sides of an element of a refined mesh.
    """
    finer = grid
    for roughness in maps:
        finer = roughness.resolving(finer)
    if finer != grid and grid.elements[1] > 1:
        shorter = min(finer.dx, finer.dy)
        sides = zip(finer.elements, (finer.dx, finer.dy), strict=True)
        along, across = (max(n, _odd(n * side / (slender * shorter))) for n, side in sides)
        finer = replace(grid, elements=(along, across))
    return finer if math.prod(finer.elements) <= max_elements else grid
