"""Rails whose cross-section varies along the track, such as a crossing nose."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Self

import numpy as np
import scipy  # its parts are loaded when first used
from numpy.typing import ArrayLike

from tractive_sam.input_file import read_text
from tractive_sam.text_table import Remark, find_length_units, list_first

from .files import ProfileError
from .profile import Array, Profile, interpolate_run, rotation


@dataclass(frozen=True, eq=False)
class RailSections:
    """Rail given by cross-sections at several positions along the track (see `Rail`).

    Between the sections, corresponding points are interpolated by cubics; beyond the first and the
    last section, the rail is prismatic. A part of the section that begins or ends along the track,
    such as a wing rail, exists between two sections that both have it.

    Attributes
    ----------
    x : ndarray, shape (n,)
        Positions of the sections, increasing, mm.
    points : ndarray, shape (n, m, 2)
        y and z of corresponding points of the sections, mm.
    tangents : ndarray, shape (n, m, 2)
        Their derivatives by the number of the point, mm. Between points, a section is a cubic.
        Zero for the first and last points that a section does not have; at these, `points` are
        those of the nearest section that has them.
    notes : tuple of str
        Notes of the profiles of the sections (see `Profile`).
    """

    steepest = 0.13
    """Largest slope along the track up to which contact points are found: ramps have 0.1."""

    absent_depth = 100.0
    """Depth at which the rail is taken to be beside the parts that exist, mm."""

    x: Array
    points: Array
    tangents: Array
    notes: tuple[str, ...] = ()

    @classmethod
    def from_profiles(
        cls, x: Array, profiles: Sequence[Profile], marks: Array, spacing: float = 0.25
    ) -> Self:
        """Return the rail of profiles whose points correspond between marks.

        Parameters
        ----------
        x : ndarray, shape (n,)
            Positions of the profiles, mm.
        profiles : sequence of Profile
            The profiles.
        marks : ndarray, shape (n, k)
            Arc lengths of corresponding points, for example of edges, from one end of each profile
            to the other, mm. Points between two of them correspond by their relative arc length.
            nan before and after the marks that a section has.
        spacing : float
            Largest distance of the points, mm.
        """
        lengths = np.diff(marks, axis=1)
        numbers = np.ceil(np.nanmax(lengths, axis=0) / spacing).astype(int)
        count = len(numbers)
        place = np.concatenate([*(k + np.arange(n) / n for k, n in enumerate(numbers)), [count]])
        s = np.stack([np.interp(place, np.arange(count + 1), along) for along in marks])
        s[:, np.searchsorted(place, np.arange(count + 1))] = marks  # also beside one that is nan
        exists = np.isfinite(s)
        parts = (np.zeros((x.size, place.size, 2)), np.zeros((x.size, place.size, 2)))
        for k, (profile, there) in enumerate(zip(profiles, exists, strict=True)):
            for order, part in enumerate(parts):
                part[k, there] = profile.at(s[k, there], order)
            parts[1][k, there] *= np.gradient(s[k, there])[:, None]
        points, tangents = parts
        for j in np.flatnonzero(~exists.all(axis=0)):
            having = np.flatnonzero(exists[:, j])
            nearest = having[np.argmin(np.abs(x[:, None] - x[having]), axis=1)]
            points[:, j] = points[nearest, j]
        notes = tuple(dict.fromkeys(note for profile in profiles for note in profile.notes))
        return cls(x, points, tangents, notes)

    @cached_property
    def _sections(self) -> dict[float, Profile]:
        """Cross-sections that were requested, by their position."""
        return {}

    @cached_property
    def _along(self) -> Array:
        """Coefficients (4, n - 1, m, 4) of cubics of points and tangents in x, by their power.

        They are those of cubic splines through all neighbouring sections that have the point.
        """
        nodes = np.concatenate((self.points, self.tangents), axis=-1)
        exists = self.tangents.any(axis=-1)
        coefficients = np.zeros((4, self.x.size - 1, *nodes.shape[1:]))
        coefficients[3] = nodes[:-1]
        patterns, of_point = np.unique(exists, axis=1, return_inverse=True)
        for k, there in enumerate(patterns.T):
            edges = np.flatnonzero(np.diff(np.r_[False, there, False]))
            columns = np.flatnonzero(of_point.ravel() == k)
            for first, end in edges.reshape(-1, 2):
                if end - first > 1:
                    spline = scipy.interpolate.CubicSpline(
                        self.x[first:end], nodes[first:end, columns]
                    )
                    coefficients[:, first : end - 1, columns] = spline.c
        return coefficients

    @cached_property
    def _range(self) -> Array:
        """First and last point that both sections around each interval have, (2, n - 1)."""
        exists = np.asarray(self.tangents.any(axis=-1))
        both = exists[:-1] & exists[1:]
        return np.stack([both.argmax(axis=1), both.shape[1] - 1 - both[:, ::-1].argmax(axis=1)])

    def _before(self, x: Array) -> Array:
        """Return the number of the section before positions along the track."""
        return np.clip(np.searchsorted(self.x, x) - 1, 0, self.x.size - 2)

    def _at(self, x: Array, number: Array) -> tuple[Array, Array]:
        """Return points (..., 2) and their derivatives by the number of a point, cubic in it."""
        c, x = self._along, np.clip(x, self.x[0], self.x[-1])
        before = self._before(x)
        k = np.minimum(number.astype(int), self._range[1][before] - 1)
        beyond, t = (x - self.x[before])[..., None], (number - k)[..., None]
        first, second = (sum(c[3 - n, before, j] * beyond**n for n in range(4)) for j in (k, k + 1))
        a, da, b, db = first[..., :2], first[..., 2:], second[..., :2], second[..., 2:]
        cubic, square = da + db - 2.0 * (b - a), 3.0 * (b - a) - 2.0 * da - db
        points = a + t * (da + t * (square + t * cubic))
        return points, da + t * (2.0 * square + t * 3.0 * cubic)

    def section(self, x: float) -> Profile:
        """Return the cross-section at a position along the track, mm."""
        if x not in self._sections:
            first, last = self._range[:, self._before(np.asarray(x))]
            numbers = np.arange(float(first), float(last) + 1.0)
            self._sections[x] = Profile.from_nodes(*self._at(np.full(numbers.shape, x), numbers))
        return self._sections[x]

    def across(
        self,
        x: ArrayLike,
        y: ArrayLike,
        origin: ArrayLike = (0.0, 0.0),
        angle: float = 0.0,
        near: float | None = None,
    ) -> tuple[Array, Array, Array]:
        """Return points (..., 2), angles and numbers of points; see `Rail.across`.

        Beside the parts that exist there, the points lie deep below the rail.
        """
        along, v = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
        axis, origin = np.array([np.cos(angle), np.sin(angle)]), np.asarray(origin)
        near = float(origin[0]) if near is None else near
        place = np.interp(along, self.x, np.arange(self.x.size))
        before = np.minimum(place.astype(int), self.x.size - 2)
        number, (first, last) = np.zeros(v.shape), self._range
        for k in np.unique(before):
            here, part = before == k, slice(first[k], last[k] + 1)
            ends = [
                interpolate_run(v[here], (points - origin) @ axis, points[:, 0], near)
                for points in self.points[k : k + 2, part]
            ]
            number[here] = first[k] + ends[0] + (place[here] - k) * (ends[1] - ends[0])
        first, last = first[before], last[before]
        points, tangents = self._at(along, number)
        for _ in range(3):
            slope = np.maximum(tangents @ axis, 0.01)
            number = number - ((points - origin) @ axis - v) / slope
            number = np.clip(number, first, last)
            points, tangents = self._at(along, number)
        missing = (first > 0) & (number == first) | (last < self.points.shape[1] - 1) & (
            number == last
        )
        points[..., 1] += np.where(missing, self.absent_depth, 0.0)
        return points, np.arctan2(tangents[..., 1], tangents[..., 0]), number

    def moved(self, angle: float, shift: ArrayLike) -> Self:
        """Return all sections rotated by an angle, rad, and then shifted, mm."""
        turn = rotation(angle)
        points = self.points @ turn + np.asarray(shift)
        return replace(self, points=points, tangents=self.tangents @ turn)

    def seen_from(self, x: float) -> Self:
        """Return the rail in a frame whose origin lies at a position along the track, mm."""
        return replace(self, x=self.x - x)


def read_sections(path: str | PathLike[str], read: Callable[[Path], Profile]) -> RailSections:
    """Read a file of sections (.slcs): positions and profile files, as CONTACT reads them.

    Its lines, without comments after ``%`` or ``!``: offset and scale of positions; number of
    sections; numbers of marks, kinks and accelerations; a number (the kind of spline, not used);
    position and file of each section, the file in quotes; position and marks of each section, the
    arc lengths in mm of corresponding points from the end with the smallest y, or -1 if a section
    does not have the point.

    Parameters
    ----------
    path : path-like
        The file.
    read : callable
        Reads a profile from a path, which is relative to the folder of the file.

    Raises
    ------
    ProfileError
        If the file or a profile cannot be used.
    """
    try:
        text = read_text(path, max_bytes=10**6, encoding=None)
        parts = [re.split("[%!]", f"{line}%", maxsplit=1) for line in text.splitlines()]
        entries = [re.findall(r"'[^']*'|[^\s,]+", line) for line, _ in parts if line.strip()]
        rail = _from_lines(entries, Path(path).parent, read)
        remarks = [Remark(k, comment.strip(" %!")) for k, (_, comment) in enumerate(parts, 1)]
        other = [
            r.place for r in remarks if r.states("scale") or {*find_length_units(r.text)} - {"mm"}
        ]
        note = f"comments of {Path(path).name} that are not used: {list_first(other, 3)}"
        return replace(rail, notes=(*rail.notes, note)) if other else rail
    except (OSError, ValueError) as error:
        raise ProfileError(f"{path}: cannot be read: {error}") from None
    except IndexError:
        raise ProfileError(f"{path}: a line is missing or too short") from None


def _from_lines(
    lines: list[list[str]], folder: Path, read: Callable[[Path], Profile]
) -> RailSections:
    """Return the rail of the entries of a file of sections; raise a ValueError for other files."""
    offset, scale = float(lines[0][0]), float(lines[0][1])
    number, (marks, kinks, changes) = int(lines[1][0]), map(int, lines[2][:3])
    if kinks or changes:
        raise ValueError(f"{kinks} kinks and {changes} accelerations; allowed: 0 and 0")
    rows = lines[4 : 4 + number]
    x = scale * (offset + np.array([float(row[0]) for row in rows]))
    if len(rows) != number or number < 2 or not (np.diff(x) > 0.0).all():
        raise ValueError(f"{len(rows)} sections; allowed: {number} (at least 2), at increasing x")
    if (further := lines[4 + number * (1 + (marks > 1)) :]) or {*map(len, rows)} != {2}:
        value = f"{len(further)} further lines" if further else "sections of other than two entries"
        raise ValueError(f"{value}; allowed: a position and a file, then 2 marks or more, or none")
    profiles = [read(folder / row[1].strip("'")) for row in rows]
    ends = np.array([[0.0, profile.s[-1]] for profile in profiles])
    if marks < 2:
        return RailSections.from_profiles(x, profiles, ends)
    places, *_ = zip(*rows, strict=True)
    table = [row[1:] for row in lines[4 + number :]]
    if [*map(len, table)] != [marks] * number:
        raise ValueError(f"{len(table)} rows of marks; allowed: {number} rows of {marks}")
    if [float(row[0]) for row in lines[4 + number :]] != [*map(float, places)]:
        raise ValueError("marks at other positions than the sections; allowed: the same positions")
    given = np.array(table, dtype=float)
    arcs = _with_absent_marks(np.minimum(given, ends[:, 1:]), x, ends)
    falls = (np.diff(arcs, axis=1) <= 0.0).any() or (np.isfinite(arcs).sum(axis=1) < 2).any()
    if given[given != -1.0].min(initial=0.0) < 0.0 or falls:
        cure = "allowed: increasing arc lengths, and -1 for a mark that a section does not have"
        raise ValueError(f"marks from {np.nanmin(arcs):g} to {np.nanmax(arcs):g} mm; {cure}")
    if not (np.isfinite(arcs[:-1]) & np.isfinite(arcs[1:])).any(axis=1).all():
        raise ValueError("two neighbouring sections without a common mark; allowed: common parts")
    return RailSections.from_profiles(x, profiles, arcs)


def _with_absent_marks(arcs: Array, x: Array, ends: Array) -> Array:
    """Return marks (n, k) with places for those that a section does not have (-1), mm.

    A feature, such as an edge, that begins or ends along the track is a plain point in the sections
    that do not have it. Between the neighbouring marks, it has the same relative place as in the
    nearest section that has all three; without one, marks are equidistant. The outermost marks are
    the ends of the profile. Marks before one at the start of a profile, or after one at its end,
    are of parts that the section does not have, such as another rail that begins there: nan.

    Parameters
    ----------
    arcs : ndarray, shape (n, k)
        Arc lengths of the marks in each section, -1 if absent.
    x : ndarray, shape (n,)
        Positions of the sections, mm.
    ends : ndarray, shape (n, 2)
        Arc lengths of the ends of the profiles, mm.
    """
    has = arcs != -1.0
    filled, numbers = arcs.copy(), np.arange(arcs.shape[1])
    starts, stops = has & (arcs <= ends[:, :1]), has & (arcs >= ends[:, 1:])
    before = starts.any(axis=1)[:, None] & (numbers < starts.argmax(axis=1)[:, None])
    after = stops.any(axis=1)[:, None] & (numbers > stops.argmax(axis=1)[:, None])
    missing = ~has & (before | after)
    for column, end in ((0, ends[:, 0]), (-1, ends[:, 1])):
        filled[~has[:, column], column] = end[~has[:, column]]
    filled[missing], known = np.nan, has | missing
    known[:, [0, -1]] = True
    for section, mark in np.argwhere(~known):
        left = int(np.flatnonzero(known[section, :mark])[-1])
        right = mark + 1 + int(np.flatnonzero(known[section, mark + 1 :])[0])
        complete = np.flatnonzero((known & ~missing)[:, [left, mark, right]].all(axis=1))
        share = (mark - left) / (right - left)
        if complete.size:
            a, b, c = filled[complete[np.argmin(np.abs(x[complete] - x[section]))]][
                [left, mark, right]
            ]
            share = (b - a) / (c - a)
        first, last = filled[section, [left, right]]
        filled[section, mark] = first + share * (last - first)
    return filled
