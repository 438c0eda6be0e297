"""Profile files: two columns, as instruments and vehicle programs write them."""

import re
from os import PathLike
from pathlib import Path
from typing import Literal

import numpy as np
import scipy  # its parts are loaded when first used

from tractive_sam.input_file import read_text

from .profile import Array, Profile

SECTIONS = ".slcs"
"""Suffix of a file of sections of a rail."""

SUFFIXES = (".prw", ".prr", ".wheel", ".rail", ".whl", ".ban", ".csv", ".txt", ".dat", SECTIONS)
"""Suffixes of profile files. All are text with a point on each line; other lines are skipped."""

UNITS = {"mm": 1.0, "m": 1e3, "in": 25.4}
"""Units of length, in mm."""

Kind = Literal["wheel", "rail", "section"]
"""Kinds of profiles; "section" is one section of a rail with sections, which may be wider."""


class ProfileError(ValueError):
    """Error of a profile file that cannot be used."""


def read_profile(
    path: str | PathLike[str], kind: Kind, unit: str | None = None, smoothing: float | None = None
) -> Profile:
    """Read a wheel or rail profile, in any orientation; raise ProfileError if it is unusable.

    Lines that begin with two numbers, separated by blanks, tabs, commas or semicolons, are points:
    lateral position and height. Directions may be reversed: the flange shows which side of a wheel
    is inside and which is down, and a rail ends on its flanks. For files with ``units.len.f = ...``
    lengths are divided by this factor to metres.

    Parameters
    ----------
    path : path-like
        The file.
    kind : {"wheel", "rail", "section"}
        Kind of the profile; "section" is one of several sections of a rail.
    unit : {"mm", "m", "in"}, optional
        Unit of lengths; by default the unit in the file, or mm.
    smoothing : float, optional
        Root mean square distance of a cubic smoothing spline from the points, mm; by default the
        profile interpolates the points.

    Raises
    ------
    ProfileError
        If the file cannot be read, or its points are not a profile; the message states the line or
        the place, and what is allowed.
    """
    try:
        text = read_text(path, max_bytes=10**7, encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise ProfileError(f"{path}: cannot be read: {error}") from None
    try:
        points = _read_points(text)
        factor = re.search(r"units\.len\.f\s*=\s*([-+.\deE]+)", text)
        scale = 1e3 / float(factor[1]) if factor and unit is None else UNITS[unit or "mm"]
        return from_measurement(scale * points, kind, smoothing)
    except ValueError as error:
        raise ProfileError(f"{path}: {error}") from None


def _read_points(text: str) -> Array:
    """Return points (n, 2) from the text of a profile file; skip a heading without numbers."""
    block = re.search(r"point\.begin(.*?)point\.end", text, re.DOTALL)
    points = []
    for line in (block[1] if block else text).splitlines():
        entries = re.split(r"[,;\s]+", line.split("!")[0].strip())
        try:
            points.append((float(entries[0]), float(entries[1])))
        except (ValueError, IndexError):
            if points and any(entry.strip() for entry in entries) and not block:
                number = text.splitlines().index(line) + 1
                raise ValueError(f"line {number}: {line.strip()[:40]!r}; two numbers") from None
    return np.array(points, dtype=float).reshape(-1, 2)


def from_measurement(points: Array, kind: Kind, smoothing: float | None = None) -> Profile:
    """Return the profile through measured points in any orientation; near them if smoothed.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        Lateral positions and heights along the profile, mm, in any of the four directions.
    kind : {"wheel", "rail", "section"}
        See `read_profile`.
    smoothing : float, optional
        See `read_profile`.

    Raises
    ------
    ValueError
        If they are no profile of a wheel or a rail in mm, or it is not clear which side is down.
    """
    if len(points) < 20:
        raise ValueError(f"{len(points)} points; at least 20 are needed")
    if not np.isfinite(points).all():
        raise ValueError("a coordinate is not finite; allowed: finite numbers")
    _check_size(points, kind)
    steps = np.diff(points, axis=0)
    lengths = np.hypot(*steps.T)
    if (lengths == 0.0).any():
        k = int(np.flatnonzero(lengths == 0.0)[0])
        raise ValueError(f"points {k + 1} and {k + 2} are equal; allowed: different points")
    turns = np.abs(np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))))
    if turns.max() > 0.6 * np.pi:
        k = int(np.argmax(turns)) + 2
        raise ValueError(
            f"the points turn back at point {k} ({points[k - 1, 0]:g}, {points[k - 1, 1]:g}) mm; "
            "allowed: points in their order along the profile"
        )
    _check_crossing(points)
    return _spline(_orient(points, kind), smoothing)


def _spline(points: Array, smoothing: float | None) -> Profile:
    """Return the spline profile through points, or at an rms distance `smoothing` from them."""
    s = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))))
    if smoothing is None:
        curve = scipy.interpolate.CubicSpline(s, points)
        return Profile.from_nodes(curve(s), curve(s, 1))

    def fit(exponent: float) -> "scipy.interpolate.BSpline":
        return scipy.interpolate.make_smoothing_spline(s, points, lam=10.0**exponent)

    def excess(exponent: float) -> float:
        rest = fit(exponent)(s) - points
        return float(np.sqrt((rest**2).sum(axis=1).mean())) - smoothing

    low, high = -8.0, 8.0
    if excess(high) < 0.0:
        raise ValueError(f"smoothing {smoothing:g} mm leaves a straight line; use less")
    exponent = low if excess(low) > 0.0 else scipy.optimize.brentq(excess, low, high, xtol=1e-3)
    smoothed = fit(exponent)
    return Profile.from_nodes(smoothed(s), smoothed(s, 1))


def _orient(points: Array, kind: Kind) -> Array:
    """Return points in the standard orientation: y outward, in increasing order, z down.

    A part of a profile counts by the width that it spans: the distances of the points do not
    matter, and steep faces hardly count.
    """
    across = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(points[:, 0])))))
    y, z = (np.interp(np.linspace(0.0, across[-1], 1001), across, values) for values in points.T)
    points = points * (_wheel_signs(y, z) if kind == "wheel" else (1.0, _end_direction(z)))
    return points if points[-1, 0] > points[0, 0] else points[::-1]


def _wheel_signs(y: Array, z: Array) -> tuple[float, float]:
    """Return the signs of y and z with which the flange of a wheel is inside and points down."""
    low, tread, high = np.percentile(z, (2.0, 50.0, 98.0))
    excess = high + low - 2.0 * tread  # the flange reaches farther from the tread than other parts
    flange = y[np.sign(excess) * (z - tread) > 8.0]  # mm: a third of the height of a flange
    inside = y.mean() - flange.mean() if flange.size else 0.0
    if abs(excess) < 0.1 * (high - low) or abs(inside) < 0.2 * np.ptp(y):
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
    width, limits = float(np.ptp(points[:, 0])), {"wheel": (60.0, 200.0), "rail": (25.0, 120.0)}
    limits["section"] = 25.0, 400.0  # of a crossing, with its wing rails
    lower, upper = limits[kind]
    if not lower <= width <= upper:
        units = [u for u, f in UNITS.items() if lower <= width * f <= upper]
        hint = f"; its unit is probably {units[0]}: give unit" if units else ""
        raise ValueError(f"a {kind} {width:.4g} mm wide; allowed: {lower:g} to {upper:g} mm{hint}")


def _check_crossing(points: Array) -> None:
    """Raise a ValueError with the coordinates if a profile crosses itself."""
    a, d = points[:-1], np.diff(points, axis=0)
    if abs(np.sign(d[:, 0]).sum()) == len(d):
        return  # a graph over y
    between = a[None, :, :] - a[:, None, :]
    cross = d[:, None, 0] * d[None, :, 1] - d[:, None, 1] * d[None, :, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (between[..., 0] * d[None, :, 1] - between[..., 1] * d[None, :, 0]) / cross
        u = (between[..., 0] * d[:, None, 1] - between[..., 1] * d[:, None, 0]) / cross
    i, j = np.nonzero((t > 0.0) & (t < 1.0) & (u > 0.0) & (u < 1.0))
    apart = np.abs(i - j) > 1
    if apart.any():
        x, y = points[i[apart][0]]
        raise ValueError(f"the profile crosses itself near ({x:.4g}, {y:.4g}) mm")


def write_profile(profile: Profile, path: str | PathLike[str], kind: Kind, title: str = "") -> None:
    """Write a profile: .prw or .prr as SIMPACK with z upwards, others as columns, z downwards.

    Parameters
    ----------
    profile : Profile
        The profile.
    path : path-like
        The file. With the suffix .prw or .prr, z points upwards as these files require; with
        others, lines of y and z in mm, z downwards.
    kind : {"wheel", "rail"}
        Kind of the profile.
    title : str
        A line of text about it.
    """
    up = -1.0 if Path(path).suffix in (".prw", ".prr") else 1.0
    lines = [f"{y:.9f} {up * z:.9f}" for y, z in profile.points]
    if up < 0.0:
        number = int(kind == "wheel")
        head = f"header.begin\n  version = 1\n  type = {number}\nheader.end\nspline.begin"
        unit = f"  comment = '{title}'\n  units.len.f = 1000.0\n  point.begin"
        lines = [head, unit, *lines, "  point.end", "spline.end"]
    else:
        lines = [f"! {title or kind}: y and z in mm, y outward, z down", *lines]
    Path(path).write_text("\n".join(lines) + "\n", encoding="utf-8")
