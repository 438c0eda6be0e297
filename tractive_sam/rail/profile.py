"""Smooth cross-sections of wheels and rails."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol, Self

import numpy as np
import scipy  # its parts are loaded when first used
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def rotation(angle: float) -> Array:
    """Return the matrix (2, 2) that rotates rows (y, z) by an angle, rad, if they precede it."""
    return np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


class Rail(Protocol):
    """Protocol of the surface of a rail: a `Profile` along the track, or varying sections."""

    @property
    def steepest(self) -> float:
        """Largest slope along the track; 0 if the rail is prismatic."""

    def section(self, x: float) -> Profile:
        """Return the cross-section at a position along the track, mm."""

    def across(
        self,
        x: ArrayLike,
        y: ArrayLike,
        origin: ArrayLike = (0.0, 0.0),
        angle: float = 0.0,
        near: float | None = None,
    ) -> tuple[Array, Array, Array]:
        """Return points (..., 2), angles and arc lengths at positions along an inclined axis.

        For varying sections numbers of points take the place of arc lengths.

        Parameters
        ----------
        x, y : array_like
            Positions along the track and along the axis, mm; they are broadcast.
        origin, angle, near
            See `Profile.locate`.
        """

    def moved(self, angle: float, shift: ArrayLike) -> Self:
        """Return the rail with its sections rotated by an angle, rad, and then shifted, mm."""

    def seen_from(self, x: float) -> Self:
        """Return the rail in a frame whose origin lies at a position along the track, mm."""


@dataclass(frozen=True, eq=False)
class Profile:
    """Cross-section of a wheel or rail: a smooth curve over its arc length.

    Lateral positions y increase outward, from the track centre to the field side; z points
    downwards. The origin of a wheel profile is the tread datum, of a rail profile the middle of its
    top. Both belong to the right-hand side of a vehicle.

    Parameters
    ----------
    s : ndarray, shape (n,)
        Arc length of the nodes, increasing, mm.
    points : ndarray, shape (n, 2)
        y and z of the nodes, mm.
    tangents : ndarray, shape (n, 2)
        Unit tangents at the nodes. Between nodes the curve is a cubic in s.
    notes : tuple of str
        What a file states or its points show, and the profile leaves out; not kept by changes.

    Examples
    --------
    >>> from tractive_sam.rail import builtin_profile
    >>> wheel = builtin_profile("S1002")
    >>> float(round(wheel.height(-55.0), 6))
    28.0
    """

    steepest = 0.0
    """Slope of a rail with this profile along the track (see `Rail`)."""

    s: Array
    points: Array
    tangents: Array
    notes: tuple[str, ...] = ()

    @classmethod
    def from_pieces(cls, pieces: list[tuple[Array, Array]]) -> Profile:
        """Return the profile of connected pieces, each beginning at the end of the previous one."""
        points = np.concatenate([p[k > 0 :] for k, (p, _) in enumerate(pieces)])
        tangents = np.concatenate([t[k > 0 :] for k, (_, t) in enumerate(pieces)])
        return cls(arc_lengths(points, tangents), points, tangents)

    @classmethod
    def from_nodes(cls, points: Array, directions: Array) -> Profile:
        """Return the profile through points, shape (n, 2), with tangents of any length there."""
        tangents = directions / np.hypot(directions[:, :1], directions[:, 1:])
        return cls(arc_lengths(points, tangents), points, tangents)

    @cached_property
    def _curve(self) -> scipy.interpolate.CubicHermiteSpline:
        """Cubic spline through the nodes with their tangents, over the arc length."""
        return scipy.interpolate.CubicHermiteSpline(self.s, self.points, self.tangents)

    def at(self, s: ArrayLike, order: int = 0) -> Array:
        """Return (y, z) at arc lengths s, or a derivative by s, shape (..., 2)."""
        return np.asarray(self._curve(s, order))

    def angle(self, s: ArrayLike) -> Array:
        """Return the angle of the tangent at arc lengths s, rad; positive if z grows with y."""
        tangent = self.at(s, 1)
        return np.arctan2(tangent[..., 1], tangent[..., 0])

    def curvature(self, s: ArrayLike) -> Array:
        """Return the curvature (change of angle over arc length) at arc lengths s, 1/mm."""
        first, second = self.at(s, 1), self.at(s, 2)
        cross = first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
        return np.asarray(cross / (first**2).sum(axis=-1) ** 1.5)

    def locate(
        self,
        v: ArrayLike,
        origin: ArrayLike = (0.0, 0.0),
        angle: float = 0.0,
        near: float | None = None,
    ) -> Array:
        """Return arc lengths at positions v along an inclined axis, clipped to the profile's ends.

        Parameters
        ----------
        v : array_like
            Positions along the axis, mm, measured from its origin.
        origin : array_like, shape (2,)
            y and z of the origin.
        angle : float
            Angle of the axis, rad.
        near : float, optional
            y of a point of the part of the profile that is meant if there are several; by default
            at the median of the positions.

        Returns
        -------
        ndarray
            Arc lengths; beyond an end of the profile the arc length of the end.
        """
        axis = np.array([np.cos(angle), np.sin(angle)])
        if near is None:
            near = float(np.asarray(origin)[0] + np.median(np.asarray(v)) * axis[0])
        positions = (self.points - np.asarray(origin)) @ axis
        first, last = _increasing_run(positions, self.points[:, 0], near)
        run = slice(first, last + 1)
        s = np.interp(np.asarray(v), positions[run], self.s[run])
        for _ in range(3):
            coordinate = (self.at(s) - np.asarray(origin)) @ axis
            s = s - (coordinate - v) / np.maximum(self.at(s, 1) @ axis, 0.05)
            s = np.clip(s, self.s[first], self.s[last])
        return np.asarray(s)

    def height(self, y: ArrayLike) -> Array:
        """Return z at lateral positions, mm; beyond the ends, z of the nearest end."""
        return np.asarray(self.at(self.locate(y))[..., 1])

    def section(self, x: float) -> Profile:
        """Return the profile: the cross-section of a prismatic rail at any position."""
        return self

    def across(
        self,
        x: ArrayLike,
        y: ArrayLike,
        origin: ArrayLike = (0.0, 0.0),
        angle: float = 0.0,
        near: float | None = None,
    ) -> tuple[Array, Array, Array]:
        """Return points (..., 2), angles and arc lengths of a prismatic rail; see `Rail.across`."""
        s = self.locate(y, origin, angle, near)
        return self.at(s), self.angle(s), s

    def seen_from(self, x: float) -> Profile:
        """Return the profile: a prismatic rail looks the same from any position."""
        return self

    def moved(self, angle: float, shift: ArrayLike) -> Profile:
        """Return the profile rotated by an angle, rad, and then shifted, mm.

        Parameters
        ----------
        angle : float
            Angle that is added to the angles of all tangents, rad.
        shift : array_like, shape (2,)
            Displacement in y and z of the origin, mm.
        """
        turn = rotation(angle)
        return Profile(self.s, self.points @ turn + np.asarray(shift), self.tangents @ turn)

    def with_nodes(self, s: Array) -> Profile:
        """Return the curve with nodes at arc lengths s; the same one if they contain its nodes."""
        return Profile(s, self.at(s), self.at(s, 1))

    def refined(self, spacing: float) -> Profile:
        """Return the same curve with further nodes, at most a spacing apart, mm."""
        parts = np.ceil(np.diff(self.s) / spacing - 1e-9).astype(int)
        number = np.concatenate([k + np.arange(n) / n for k, n in enumerate(parts)])
        s = np.interp(number, np.arange(self.s.size), self.s)
        return self.with_nodes(np.append(s, self.s[-1]))

    def ground(self, start: float, end: float, factors: ArrayLike, outward: float) -> Profile:
        """Return the profile without a depth that is a sum of splines over its lateral position.

        Parameters
        ----------
        start, end : float
            Lateral positions y between which it is ground, mm.
        factors : array_like, shape (n,)
            Factors of n equal cubic B-splines, one beside the other: the depth normal to the
            profile, mm. It begins and ends without a step, a kink or a jump of curvature.
        outward : float
            See `worn`.

        Raises
        ------
        ValueError
            If the profile has no such positions.
        """
        zeros, factors = np.zeros(3), np.asarray(factors, dtype=float)
        first, last = self.points[:, 0].min(), self.points[:, 0].max()
        if not first <= start < end <= last:
            allowed = f"ascending, within {first:.4g} to {last:.4g} mm"
            raise ValueError(f"ground: y from {start:g} to {end:g} mm; allowed: {allowed}")
        width = (end - start) / (factors.size + 3)
        knots = start + width * np.arange(-3, factors.size + 7)
        depth = scipy.interpolate.BSpline(knots, np.concatenate((zeros, factors, zeros)), 3)
        fine = self.refined(0.125 * width)
        y = np.clip(fine.points[:, 0], start, end)
        return fine.worn(depth(y), outward)

    def worn(self, depth: ArrayLike, outward: float) -> Profile:
        """Return the profile worn by depths normal to it; `outward` is 1 for wheels, -1 for rails.

        Parameters
        ----------
        depth : array_like, shape (n,)
            Depth at the nodes, mm; Akima's interpolant (1970, J. ACM 17, 589-602) between them.
        outward : float
            1 if the outward normal points downwards (a wheel), -1 if upwards (a rail).
        """
        removed = scipy.interpolate.Akima1DInterpolator(self.s, np.asarray(depth, dtype=float))
        normals = np.stack((-self.tangents[:, 1], self.tangents[:, 0]), axis=1)
        offset = -outward * removed(self.s)[:, None]
        slope = -outward * removed(self.s, 1)[:, None]
        stretch = 1.0 - offset * self.curvature(self.s)[:, None]
        directions = stretch * self.tangents + slope * normals
        return Profile.from_nodes(self.points + offset * normals, directions)


def arc_lengths(points: Array, tangents: Array) -> Array:
    """Return the arc lengths of points with unit tangents, from 0, shape (n,), mm.

    Each chord counts as the chord of a circular arc between its tangents, an error of fifth order.
    """
    chords = np.hypot(*np.diff(points, axis=0).T)
    half = 0.5 * np.abs(np.diff(np.unwrap(np.arctan2(tangents[:, 1], tangents[:, 0]))))
    return np.concatenate(([0.0], np.cumsum(chords / np.sinc(half / np.pi))))


def interpolate_run(v: Array, positions: Array, y: Array, near: float) -> Array:
    """Return numbers of points at positions `v`, on the part that increases around y = `near`."""
    first, last = _increasing_run(positions, y, near)
    return np.interp(v, positions[first : last + 1], np.arange(first, last + 1))


def _increasing_run(positions: Array, y: Array, near: float) -> tuple[int, int]:
    """Return the first and last index around y = `near` between which positions increase."""
    start = int(np.argmin(np.abs(y - near)))
    falls = np.flatnonzero(np.diff(positions) <= 0.0)
    before, after = falls[falls < start], falls[falls >= start]
    first = int(before[-1]) + 1 if before.size else 0
    last = int(after[0]) if after.size else positions.size - 1
    return first, max(last, first)
