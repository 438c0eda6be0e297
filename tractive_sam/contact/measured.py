"""The measured separation of a scene at the elements of its mesh, and its roughness.

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
import scipy  # its parts are loaded when first used

from tractive_sam.results import Grid
from tractive_sam.scene import Scene
from tractive_sam.schema import required

Gap = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Coordinates x (n,), y (m,) and separation (n, m) of a measured gap, mm."""


def resample(measured: Gap, grid: Grid) -> np.ndarray:
    """Return the measured gap at the elements of a mesh, mm; constant beyond the measurement.

    It uses Akima's interpolation (1970, J. ACM 17, 589-602) in x and then in y. This is exact for
    parabolas, the form of bodies near a contact; with bilinear interpolation facets would carry the
    pressure. Unlike a spline it does not ring at the steps of a profile.
    """
    return sample_gap(measured, *_clip_to_gap(measured, grid.x, grid.y))


def gap_across(measured: Gap, grid: Grid) -> np.ndarray:
    """Return the measured gap across the track, at x = 0 and the rows of a mesh, mm."""
    return sample_gap(measured, *_clip_to_gap(measured, np.zeros(1), grid.y))[0]


def lowest_separation(
    measured: Gap, grid: Grid, resampled: np.ndarray, radii: tuple[float, float]
) -> float:
    """Return the least sum of the gap of radii and the measured gap, also between samples, mm.

    It depends on the mesh only by what that covers. From the lowest sample, and from the lowest
    element, the neighbourhood is divided again and again.

    Parameters
    ----------
    measured : Gap
        The measured separation.
    grid : Grid
        The mesh.
    resampled : ndarray, shape (n_x, n_y)
        The gap at the elements, from `resample`, mm.
    radii : tuple of float
        R_x and R_y of both bodies together, mm.
    """
    starts = _part_on_mesh(measured, grid), (grid.x, grid.y, resampled)
    return min(_lowest_around(measured, grid, radii, start) for start in starts)


def _lowest_around(
    measured: Gap, grid: Grid, radii: tuple[float, float], points: Gap, divisions: int = 12
) -> float:
    """Return the least separation near the lowest of some points, by repeated subdivision, mm.

    Twelve divisions, each by four, reduce the error of the points by 4^-24.
    """
    x, y, separation = points
    ends = (grid.x[0], grid.x[-1]), (grid.y[0], grid.y[-1])
    lowest = np.inf
    for _ in range(divisions):
        total = separation + 0.5 * (x[:, None] ** 2 / radii[0] + y[None, :] ** 2 / radii[1])
        i, j = map(int, np.unravel_index(np.argmin(total), total.shape))
        lowest = min(lowest, float(total[i, j]))
        x, y = (
            np.linspace(*_neighbours(places, k, side, *end), 9)
            for places, k, side, end in zip((x, y), (i, j), (grid.dx, grid.dy), ends, strict=True)
        )
        separation = sample_gap(_part_near(measured, x, y), *_clip_to_gap(measured, x, y))
    return lowest


def _neighbours(
    places: np.ndarray, k: int, side: float, first: float, last: float
) -> tuple[float, float]:
    """Return the coordinates on both sides of the k-th one, limited to the mesh."""
    before = places[k - 1] if k > 0 else places[k] - side
    after = places[k + 1] if k + 1 < len(places) else places[k] + side
    return float(np.clip(before, first, last)), float(np.clip(after, first, last))


def _part_near(measured: Gap, x: np.ndarray, y: np.ndarray) -> Gap:
    """Return the part of a measured gap that its interpolation between given x and y depends on."""
    spans = []
    for coordinates, at in zip(measured[:2], (x, y), strict=True):
        # Akima's slopes depend on two samples on each side.
        first, last = np.searchsorted(coordinates, (at[0], at[-1]))
        spans.append(slice(max(first - 4, 0), last + 4))
    return measured[0][spans[0]], measured[1][spans[1]], measured[2][spans[0], spans[1]]


def _clip_to_gap(measured: Gap, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return coordinates limited to the measured gap, which is continued as a constant."""
    return np.clip(x, *measured[0][[0, -1]]), np.clip(y, *measured[1][[0, -1]])


def uncovered_axes(measured: Gap, grid: Grid) -> list[str]:
    """Return the axes ("x", "y") along which a mesh exceeds the measured gap by over an element."""
    x, y, _ = measured
    sides = (("x", x, grid.x, grid.dx), ("y", y, grid.y, grid.dy))
    return [
        axis
        for axis, coordinates, at, side in sides
        if coordinates[0] > at[0] + side or coordinates[-1] < at[-1] - side
    ]


def standing_roughness(measured: Gap, grid: Grid) -> float:
    """Return the rms height along x about a fitted polynomial, mm; 0 if negligible."""
    # Degree of the polynomial in x that is taken for the form of a body, which stays as it turns.
    degree = 4
    x, _, separation = _part_on_mesh(measured, grid)
    if x.size <= degree + 1:
        return 0.0
    powers = np.vander(x / np.abs(x).max(), degree + 1)
    form = powers @ np.linalg.lstsq(powers, separation, rcond=None)[0]
    rest = float(np.sqrt(np.mean((separation - form) ** 2)))
    rounding = 1e-12 * float(np.abs(separation).max())  # of a distance that all share
    return rest if rest > max(1e-3 * float(np.ptp(separation)), rounding) else 0.0


def _part_on_mesh(measured: Gap, grid: Grid) -> Gap:
    """Return the part of a measured gap within the mesh; interpolated if it has no sample there."""
    x, y, separation = measured
    middles = grid.centre[0], grid.centre[1] - grid.shift
    x_in, y_in = (
        coordinates[np.abs(coordinates - middle) <= length]
        for coordinates, middle, length in zip((x, y), middles, grid.half_length, strict=True)
    )
    if x_in.size and y_in.size:
        return x_in, y_in, separation[np.ix_(np.isin(x, x_in), np.isin(y, y_in))]
    x_in, y_in = (indices if indices.size else np.zeros(1) for indices in (x_in, y_in))
    return x_in, y_in, sample_gap(measured, x_in, y_in)


def samples_per_length(coordinates: np.ndarray) -> float:
    """Return the samples per length, 1/mm, from the median spacing; 0 for a single sample."""
    return 1.0 / float(np.median(np.diff(coordinates))) if coordinates.size > 1 else 0.0


def sample_gap(gap: Gap, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Interpolate a gap (Akima) at coordinates x and y, shape (len(x), len(y))."""
    rows = interpolate(gap[0], gap[2], x)
    return interpolate(gap[1], rows.T, y).T


def interpolate(samples: np.ndarray, values: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Interpolate values along the first axis (Akima), extrapolated beyond the samples."""
    if samples.size == 2:  # a straight line; Akima's slopes need a third point
        share = ((places - samples[0]) / (samples[1] - samples[0]))[:, None]
        return (1.0 - share) * values[0] + share * values[1]
    return scipy.interpolate.Akima1DInterpolator(samples, values, extrapolate=True)(places)


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
        scene.body.contact_modulus(math.sqrt(half_length[0] * half_length[-1])),
        _pressure(scene.under_largest_load, half_length),
    )
    # Points beyond the ends of a roller do not touch, and its profile is smooth.
    if measured is not None and not scene.body.has_roller:
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
    return 0.5 * scene.body.contact_modulus(length) * approach / length


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
