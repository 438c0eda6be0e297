"""The measured separation of a scene at the elements of its mesh."""

import numpy as np
import scipy  # its parts are loaded when first used

from tractive_sam.results import Grid

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
        total = separation + _parabola(x, y, radii)
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


def _parabola(x: np.ndarray, y: np.ndarray, radii: tuple[float, float]) -> np.ndarray:
    """Return the gap x²/(2 R_x) + y²/(2 R_y) of two radii, shape (len(x), len(y)), mm."""
    return 0.5 * (x[:, None] ** 2 / radii[0] + y[None, :] ** 2 / radii[1])


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
