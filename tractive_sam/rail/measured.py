"""Profiles through measured points: their direction, their order, their noise, and a spline."""

import math
from dataclasses import replace
from typing import Literal

import numpy as np
import scipy  # its parts are loaded when first used

from tractive_sam.text_table import LENGTHS

from .profile import Array, Profile

UNITS = {name: LENGTHS[name] for name in ("mm", "m", "in", "cm", "um")}
"""Units of length of profiles, in mm."""

Kind = Literal["wheel", "rail", "section"]
"""Kinds of profiles; "section" is one section of a rail with sections, which may be wider."""


def from_measurement(
    points: Array, kind: Kind, smoothing: float | None = None, inside: Array | None = None
) -> Profile:
    """Return the profile through measured points in any orientation; near them if smoothed.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        Lateral positions and heights along the profile, mm, in any of the four directions.
    kind : {"wheel", "rail", "section"}
        See `read_profile`.
    smoothing : float, optional
        See `read_profile`.
    inside : ndarray of bool, shape (n,), optional
        Points that belong to the profile; all points show its directions. By default all.

    Raises
    ------
    ValueError
        If they are no profile of a wheel or a rail in mm, or it is not clear which side is down.
    """
    if len(points) < 20 or not np.isfinite(points).all():
        raise ValueError(f"{len(points)} points; allowed: at least 20, of finite numbers")
    _check_size(points, kind)
    steps = np.diff(points, axis=0)
    if (equal := np.flatnonzero((steps == 0.0).all(axis=1))).size:
        places = f"points {equal[0] + 1} and {equal[0] + 2}"
        raise ValueError(f"{places} are equal; allowed: different points")
    turns = np.abs(np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))))
    if turns.max() > 0.6 * np.pi:
        k = int(np.argmax(turns)) + 2
        raise ValueError(
            f"the points turn back at point {k} ({points[k - 1, 0]:g}, {points[k - 1, 1]:g}) mm; "
            "allowed: points in their order along the profile"
        )
    if abs(np.sign(steps[:, 0]).sum()) < len(steps):  # where y only rises or falls, neither occurs
        _check_return(points)
        _check_crossing(points)
    digit = math.hypot(*(_find_digit(column) for column in points.T))
    points = points * _find_signs(points, kind)
    if inside is not None:
        points = points[inside]
        if len(points) < 20:
            raise ValueError(f"{len(points)} points within the bounds; at least 20 are needed")
    ordered = points if points[-1, 0] > points[0, 0] else points[::-1]
    return _fit_spline(ordered, smoothing, digit)


def check_datum(profile: Profile, tape_line: float, radius: float = 460.0) -> str:
    """Return notes on a wheel whose origin may not be its tread datum; "" if there are none.

    They compare the back of the wheel with the tape line, and the height of the tread at y = 0
    with zero.

    Parameters
    ----------
    profile : Profile
        Profile of a wheel. Its back is known if the profile begins with a steep face.
    tape_line : float
        Distance of the tread datum from the back, mm.
    radius : float
        Radius of the wheel at z = 0, mm.

    Raises
    ------
    ValueError
        If the origin of the profile is not its tread datum.
    """
    points, height = profile.points, _check_height(profile, radius)
    top = int(np.argmax(points[:, 1]))
    face = profile.at(np.linspace(0.0, min(0.5, profile.s[-1]), 20), 1)
    has_back = abs(face[:, 0].mean()) < 0.17 * abs(face[:, 1].mean())  # 80 degrees
    if points[top, 1] - np.median(points[:, 1]) < 10.0 or points[top, 0] > points[:, 0].mean():
        notes = "it has no flange, so that its origin, the tread datum, is not checked", height
        return "; ".join(filter(None, notes))
    back = float(points[: top + 1, 0].min())
    shift = -tape_line - back if has_back else -tape_line + 15.0 - float(points[top, 0])
    part, place = ("back", back) if has_back else ("flange", points[top, 0])
    if abs(shift) > 20.0:
        raise ValueError(
            f"its {part} is at y = {place:.4g} mm: the origin of a wheel profile is its tread "
            f"datum, tape_line = {tape_line:g} mm from the back; add {shift:.4g} to all y (XOffset "
            "of Miniprof, shift.y of SIMPACK, or the column y), or correct tape_line"
        )
    note = f"its back is at y = {back:.4g} mm, and not {tape_line:g} mm from its origin, the "
    note += f"tread datum; set tape_line = {-back:.4g}, or add {shift:.4g} to all y"
    notes = note if has_back and abs(shift) > 1.0 else "", height
    return "; ".join(filter(None, notes))


def _check_height(profile: Profile, radius: float) -> str:
    """Return a note if the tread is more than 1 mm from z = 0 at the tread datum; else ""."""
    y, depth = profile.points[:, 0], float(profile.height(0.0))
    if abs(depth) <= 1.0 or not y.min() <= 0.0 <= y.max():
        return ""
    worn = ", unless this is wear since the radius was measured" if depth < 0.0 else ""
    return (
        f"its tread is at z = {depth:.4g} mm (downwards) at the tread datum, y = 0, where the "
        f"rolling radius is thus {radius + depth:.6g} mm, and not wheel.radius = {radius:g} mm; "
        f"let z be 0 there{worn} (YOffset of Miniprof, shift.z of SIMPACK, or the column z)"
    )


def _find_digit(values: Array) -> float:
    """Return the last decimal place of values, 1 to 1e-9."""
    for place in 10.0 ** -np.arange(9):
        multiples = values / place
        # The rounding error of a number, in units of the place, grows with its number of digits.
        if np.abs(multiples - np.round(multiples)).max() < 1e-6 + 1e-15 * np.abs(multiples).max():
            return float(place)
    return 1e-9


def _fit_spline(points: Array, smoothing: float | None, digit: float) -> Profile:
    """Return the spline profile through points, or at an rms distance `smoothing` from them.

    If the points scatter as their last digit makes them, they are smoothed by their scatter.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        Points, mm.
    smoothing : float, optional
        The distance, mm; 0 interpolates the points.
    digit : float
        Last printed digit, as the root of the sum of squares of both coordinates, mm.
    """
    s = _arc_lengths(points)
    spacing, scatter = float(np.median(np.diff(s))), _estimate_scatter(points, s)
    # Of white noise through a spline; a contact does not see waves shorter than about 0.2 mm.
    slope = scatter * np.pi / (np.sqrt(3.0) * max(spacing, 0.1))
    note = ""

    def pressure() -> str:
        """Return the rms pressure of waves of this slope between steel bodies, as text."""
        return f"{float(f'{0.5 * 1.154e5 * slope:.1e}'):g} MPa"

    if smoothing is None and slope > 5e-4:  # 30 MPa
        note = (
            f"the points scatter by about {scatter:.2g} mm rms, which changes the peak "
            f"pressure of steel bodies by about {pressure()}; smoothing = {scatter:.2g} reduces it"
        )
        if scatter <= 0.6 * digit:  # rounding causes 0.29 of the digit
            smoothing = scatter = max(scatter, 0.29 * digit)
            note = (
                f"the points scatter by their last digit, {scatter:.2g} mm rms, which would "
                f"change the peak pressure of steel bodies by about {pressure()}; they are "
                "smoothed by this distance, and about {left} are left; set smoothing to another "
                "distance, or to 0 for a spline through the points"
            )
    if smoothing:
        profile, slope = _smooth(points, s, smoothing, scatter)
    else:
        curve = scipy.interpolate.CubicSpline(s, points)
        profile = Profile.from_nodes(curve(s), curve(s, 1))
    return replace(profile, notes=(note.format(left=pressure()),) if note else ())


def _estimate_scatter(points: Array, s: Array, shortest: float = 0.2) -> float:
    """Return the rms scatter of points about a smooth curve, mm, from their high differences.

    Differences of white noise have a known variance; differences of a smooth curve fall with
    their order. The smaller estimate of two orders counts, and three quarters of the differences,
    since corners have large ones. Closer points than `shortest`, mm, are thinned out: the errors of
    rounded neighbours are equal.
    """
    thinned = points[:: max(1, int(shortest / np.median(np.diff(s))))]
    if len(thinned) < 20:
        return 0.0
    estimates = []
    for order, gain in ((4, 70.0), (6, 924.0)):  # sums of the squared binomial coefficients
        differences = np.abs(np.diff(thinned, order, axis=0)) / np.sqrt(gain)
        estimates.append(np.quantile(differences, 0.75, axis=0) / 1.150)  # of the normal law
    return float(np.hypot(*np.minimum(*estimates)))


def _smooth(points: Array, s: Array, distance: float, scatter: float) -> tuple[Profile, float]:
    """Return a smoothing spline at an rms distance from points, and its slope error, rms.

    It minimises the squared distances plus a factor times the integral of the squared second
    derivatives, on uniform knots (P-spline, Eilers and Marx 1996, Stat. Sci. 11, 89-121), so that
    its cost is proportional to the number of points.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        Points, mm.
    s : ndarray, shape (n,)
        Their arc lengths, mm.
    distance : float
        Root mean square distance, mm.
    scatter : float
        Scatter of the points, mm, which causes the slope error.
    """
    count = int(np.clip(2 * len(s), 200, 4000))
    knots = s[0] + (s[-1] - s[0]) / count * np.arange(-3.0, count + 4.0)
    knots[count + 3] = max(knots[count + 3], s[-1])  # rounding
    basis = scipy.interpolate.BSpline.design_matrix(s, knots, 3)
    sides, gram = basis.T @ points, (basis.T @ basis).tocsr()
    second = scipy.sparse.diags([1.0, -2.0, 1.0], [0, 1, 2], shape=(count + 1, count + 3))
    penalty = (second.T @ second).tocsr()
    bands = np.zeros((2, 4, count + 3))
    for k in range(4):
        for band, matrix in zip(bands, (gram, penalty), strict=True):
            band[k, : count + 3 - k] = matrix.diagonal(k)

    def fit(exponent: float) -> Array:
        left = bands[0] + 10.0**exponent * bands[1]
        return scipy.linalg.solveh_banded(left, sides, lower=True)

    def excess(exponent: float) -> float:
        rest = basis @ fit(exponent) - points
        return float(np.sqrt((rest**2).sum(axis=1).mean())) - distance

    low, high = -6.0, 10.0
    if excess(high) < 0.0:
        raise ValueError(f"smoothing {distance:g} mm leaves a straight line; use less")
    exponent = low if excess(low) > 0.0 else scipy.optimize.brentq(excess, low, high, xtol=1e-3)
    curve = scipy.interpolate.BSpline(knots, fit(exponent), 3)
    # The spline is a filter 1 / (1 + (width k)^4) of waves k; its integral gives the error.
    step, spacing = knots[1] - knots[0], (s[-1] - s[0]) / len(s)
    width = (10.0**exponent * step**3 * spacing) ** 0.25
    slope = scatter * np.sqrt(0.0884 * spacing / width**3)
    nodes = s if len(s) <= 2 * count else np.linspace(s[0], s[-1], count)
    return Profile.from_nodes(curve(nodes), curve(nodes, 1)), float(slope)


def _find_signs(points: Array, kind: Kind) -> tuple[float, float]:
    """Return the signs of y and z in the standard orientation: y outward, z down.

    A part of a profile counts by the width that it spans: the distances of the points do not
    matter, and steep faces hardly count.
    """
    across = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(points[:, 0])))))
    y, z = (np.interp(np.linspace(0.0, across[-1], 1001), across, values) for values in points.T)
    return _wheel_signs(y, z) if kind == "wheel" else (1.0, _end_direction(z))


def _wheel_signs(y: Array, z: Array) -> tuple[float, float]:
    """Return the signs of y and z with which the flange of a wheel is inside and points down."""
    low, tread, high = np.percentile(z, (2.0, 50.0, 98.0))
    excess = high + low - 2.0 * tread  # the flange reaches farther from the tread than other parts
    flange = y[np.sign(excess) * (z - tread) > 8.0]  # mm: a third of the height of a flange
    inside = y.mean() - flange.mean() if flange.size else 0.0
    if abs(excess) < 0.1 * (high - low) or abs(inside) < 0.2 * np.ptp(y):
        if (z[0] - tread) * (z[-1] - tread) < 0.0:  # a tread without its flange
            raise ValueError("which side is down is not clear; allowed: a wheel with its flange")
        return 1.0, -_end_direction(z)  # a roller, or flanges on both sides
    return float(np.sign(inside)), float(np.sign(excess))


def _end_direction(z: Array) -> float:
    """Return the sign of the z direction in which a profile ends; raise a ValueError if not clear.

    The ends are compared with their neighbourhoods and with the mean. Sections of noses with a wide
    foot, and of crossings with a deep flangeway, differ from the neighbourhoods by 0.16 of their
    depth or more; a groove between two flat ends does not, whose direction is not known.
    """
    ends = z[0] + z[-1]
    bend = ends - z[:50].mean() - z[-50:].mean()
    if abs(bend) < 0.05 * np.ptp(z) or bend * (ends - 2.0 * z.mean()) < 0.0:
        raise ValueError("which side is down is not clear; allowed: a flange, or an end on a flank")
    return float(np.copysign(1.0, bend))


def _check_size(points: Array, kind: Kind) -> None:
    """Raise a ValueError if the width of a profile is implausible in mm, and name the unit."""
    # A section may be of a crossing, with its wing rails.
    limits = {"wheel": (60.0, 200.0), "rail": (25.0, 120.0), "section": (25.0, 400.0)}
    width, (lower, upper) = float(np.ptp(points[:, 0])), limits[kind]
    if not lower <= width <= upper:
        units = [unit for unit, factor in UNITS.items() if lower <= width * factor <= upper]
        hint = f"; its unit is probably {' or '.join(units)}: give unit" if units else ""
        raise ValueError(f"a {kind} {width:.4g} mm wide; allowed: {lower:g} to {upper:g} mm{hint}")


def _arc_lengths(points: Array) -> Array:
    """Return the length of the path to each point, shape (n,), mm."""
    return np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))))


def _check_return(points: Array) -> None:
    """Raise a ValueError if a quarter of a profile or more lies on another part of it."""
    s = _arc_lengths(points)
    step = max(0.5, s[-1] / 2000)
    at = np.arange(0.0, s[-1], step)
    path = np.stack([np.interp(at, s, column) for column in points.T], axis=1)
    pairs = scipy.spatial.cKDTree(path).query_pairs(1.5 * step, output_type="ndarray")
    pairs = pairs[np.abs(pairs[:, 0] - pairs[:, 1]) > 10]
    share = np.unique(pairs).size / len(path)
    if share > 0.25:
        y, z = path[pairs[len(pairs) // 2, 0]]
        raise ValueError(
            f"{100 * share:.0f} % of the points return along the profile, as at ({y:.4g}, {z:.4g}) "
            "mm; allowed: each part once: keep the points of one pass of the instrument"
        )


def _check_crossing(points: Array, most: int = 10**7) -> None:
    """Raise a ValueError with the coordinates if a profile crosses itself.

    Segments that cross have centres within the sum of their half lengths. Long segments are divided
    for this search, so that few pairs are near enough to be compared.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        Points along the profile, mm.
    most : int
        Largest number of pairs.
    """
    d = np.diff(points, axis=0)
    lengths = np.hypot(*d.T)
    longest = max(2.0 * float(np.median(lengths)), float(lengths.sum()) / 20000)
    parts = np.ceil(lengths / longest).astype(int)
    owner = np.repeat(np.arange(len(d)), parts)
    share = np.concatenate([(np.arange(n) + 0.5) / n for n in parts])
    tree = scipy.spatial.cKDTree(points[owner] + share[:, None] * d[owner])
    if tree.count_neighbors(tree, longest) > 2 * most:
        raise ValueError(
            f"{len(points)} points at very unequal distances, and an undercut; thin them out"
        )
    pairs = np.unique(owner[tree.query_pairs(longest, output_type="ndarray")], axis=0)
    i, j = pairs[np.abs(pairs[:, 0] - pairs[:, 1]) > 1].T
    between = points[j] - points[i]
    cross = d[i, 0] * d[j, 1] - d[i, 1] * d[j, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (between[:, 0] * d[j, 1] - between[:, 1] * d[j, 0]) / cross
        u = (between[:, 0] * d[i, 1] - between[:, 1] * d[i, 0]) / cross
    crossing = np.flatnonzero((t > 0.0) & (t < 1.0) & (u > 0.0) & (u < 1.0))
    if crossing.size:
        y, z = points[i[crossing[0]]]
        raise ValueError(f"the profile crosses itself near ({y:.4g}, {z:.4g}) mm")
