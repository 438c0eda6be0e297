"""A wheelset on a track: positions of the surfaces of a wheel and a rail.

Track frame: x along the rolling direction, y outward to the right, z downwards; the tops of the
unloaded rails lie at z = 0, and y = 0 is the middle of the track. A wheelset is displaced by y,
turned by the yaw about z, and by the roll about its own x-axis; a positive roll lowers the right
wheel. A left wheel is computed as a right one in the mirror: y, yaw and roll change their signs.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self, TypeVar

import numpy as np

from .profile import Array, Profile, Rail

AnyRail = TypeVar("AnyRail", bound=Rail)


def place_rail(
    rail: AnyRail, inclination: float, gauge: float, gauge_depth: float = 14.0
) -> AnyRail:
    """Return the right rail in the track frame: inclined, gauge face at gauge/2, top at z = 0.

    Parameters
    ----------
    rail : Rail
        The rail in its own frame. Its first section is placed; others follow.
    inclination : float
        Run of the inclination, 40 for 1:40, towards the track centre; inf for an upright rail.
    gauge : float
        Distance of the gauge faces, mm.
    gauge_depth : float
        Depth below the top within which the gauge is measured, mm (EN 13848-1).

    Raises
    ------
    ValueError
        If the profile ends above this depth on the gauge side.
    """
    turned = rail.moved(-np.arctan(1.0 / inclination), (0.0, 0.0))
    first = turned.section(-np.inf)
    s = np.linspace(first.s[0], first.s[-1], 20 * first.s.size)
    dense = first.at(s)
    top = int(np.argmin(dense[:, 1]))
    inner = dense[: top + 1]
    depth = inner[:, 1] - dense[top, 1]
    if not (depth >= gauge_depth).any():
        raise ValueError(
            f"the rail profile ends {depth.max():.3g} mm below its top on the gauge side; the "
            f"gauge is measured {gauge_depth:g} mm below the top"
        )
    last = int(np.flatnonzero(depth >= gauge_depth)[-1])
    # Between two points of the dense curve the face is straight to 1e-6 mm.
    share = (depth[last] - gauge_depth) / (depth[last] - depth[last + 1])
    at_depth = inner[last, 0] + share * (inner[last + 1, 0] - inner[last, 0])
    face = min(float(inner[last + 1 :, 0].min()), float(at_depth))
    return turned.moved(0.0, (0.5 * gauge - face, -dense[top, 1]))


def top_of(rail: Rail) -> float:
    """Return y of the highest point of the section of a rail at x = 0."""
    points = rail.section(0.0).points
    return float(points[np.argmin(points[:, 1]), 0])


def _vertex(x: Array, gap: Array) -> Array:
    """Return x of the least of gaps (k, n) at equidistant x (k, n), on the parabola around it."""
    columns = np.arange(gap.shape[1])
    k = np.clip(np.argmin(gap, axis=0), 1, gap.shape[0] - 2)
    before, least, after = (gap[k + j, columns] for j in (-1, 0, 1))
    bend = np.maximum(before - 2.0 * least + after, 1e-12)
    shift = np.clip(0.5 * (before - after) / bend, -1.0, 1.0)
    return np.asarray(x[k, columns] + shift * (x[1] - x[0]))


@dataclass(frozen=True, eq=False)
class Wheel:
    """Right wheel of a wheelset, at its position in the track.

    Attributes
    ----------
    profile : Profile
        Cross-section of the wheel, about its tread datum.
    radius : float
        Rolling radius at the tread datum, mm.
    inner : float
        Distance of the backs of the wheels of the wheelset, mm.
    y, yaw, roll : float
        Position of the wheelset: mm, rad, rad.
    z : float
        Depth of the axle below its nominal height, mm.
    slope : float
        Slope of the path of the axle, positive downwards.
    tape_line : float
        Distance of the tread datum from the back of the wheel, mm (EN 13715).
    """

    profile: Profile
    radius: float
    inner: float
    y: float = 0.0
    yaw: float = 0.0
    roll: float = 0.0
    z: float = 0.0
    slope: float = 0.0
    tape_line: float = 70.0

    def mirrored(self) -> Self:
        """Return the left wheel mirrored to a right one: y, yaw and roll change their sign."""
        return replace(self, y=-self.y, yaw=-self.yaw, roll=-self.roll)

    @cached_property
    def turn(self) -> Array:
        """Rotation matrix from the frame of the wheelset to the track frame, shape (3, 3)."""
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        about_z = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        c, s = np.cos(self.roll), np.sin(self.roll)
        return np.asarray(about_z @ np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]))

    @property
    def centre(self) -> Array:
        """Middle of the wheelset's axle in the track frame, mm."""
        return np.array([0.0, self.y, self.z - self.radius])

    @property
    def velocity(self) -> Array:
        """Velocity of the axle over the rolling speed, in the track frame."""
        return np.array([1.0, 0.0, self.slope])

    @property
    def datum(self) -> float:
        """Lateral distance of the tread datum from the middle of the axle, mm."""
        return 0.5 * self.inner + self.tape_line

    def silhouette(self, s: Array) -> tuple[Array, Array]:
        """Return (points where a straight rail can touch, nan if too steep; contact angles).

        A prismatic rail can touch the wheel there only. On the circle of each point of the profile
        this is a linear equation in the cosine and sine of the angle around the axle.

        Parameters
        ----------
        s : ndarray, shape (n,)
            Arc lengths of the profile.

        Returns
        -------
        points : ndarray, shape (n, 3)
            In the track frame, mm; nan if the flange is too steep for this point.
        angles : ndarray, shape (n,)
            Angle of the tangent plane to the horizontal, rad.
        """
        return self._points_ahead(s, np.tan(self.profile.angle(s)) * self.turn[0, 1])

    def cut(self, s: Array, x: Array) -> tuple[Array, Array]:
        """Return (points (..., 3), contact angles) of the wheel in planes across the track.

        Parameters
        ----------
        s, x : ndarray, shape (...)
            Arc lengths of the profile and positions along the track, mm.
        """
        local = self.profile.at(s)
        ahead = x - self.turn[0, 1] * (self.datum + local[..., 0])
        return self._points_ahead(s, ahead / (self.radius + local[..., 1]))

    def _points_ahead(self, s: Array, ahead: Array) -> tuple[Array, Array]:
        """Return (points, contact angles) at arc lengths s, in a direction around the axle.

        `ahead` is the cosine of the angle between this direction and the x axis, shape (...).
        """
        local, slope, (along, _, down) = self.profile.at(s), self.profile.angle(s), self.turn[0]
        with np.errstate(invalid="ignore"):
            around = np.arcsin(ahead / np.hypot(along, down)) - np.arctan2(down, along)
        radius = self.radius + local[..., 1]
        sine, cosine = np.sin(around), np.cos(around)
        points = np.stack((radius * sine, self.datum + local[..., 0], radius * cosine), axis=-1)
        normals = np.stack((np.cos(slope) * sine, -np.sin(slope), np.cos(slope) * cosine), axis=-1)
        normals = normals @ self.turn.T
        return points @ self.turn.T + self.centre, np.arctan2(-normals[..., 1], normals[..., 2])

    def facing(self, rail: Rail, s: Array, planes: int = 25) -> tuple[Array, Array]:
        """Return (points (n, 3), contact angles) with the least vertical distance from a rail.

        A prismatic rail can touch the wheel only on the silhouette. Otherwise the distance is
        compared in planes across the track, and then in closer ones around the least distance.

        Parameters
        ----------
        rail : Rail
            The rail in the track frame.
        s : ndarray, shape (n,)
            Arc lengths of the profile.
        planes : int
            Number of planes at first; between them the distance is taken as a parabola.
        """
        if rail.steepest == 0.0:
            return self.silhouette(s)
        step = 2.0 * rail.steepest * self.radius / (planes - 1)
        x: Array = np.outer(step * (np.arange(planes) - planes // 2), np.ones(s.size))
        gap = np.stack([self._gap(rail.section(float(at[0])), s, at) for at in x])
        for _ in range(2):
            step /= 8.0
            x = np.asarray(_vertex(x, gap) + step * np.array([[-1.0], [0.0], [1.0]]))
            gap = np.stack([self._gap(rail, s, at) for at in x])
        return self.cut(s, _vertex(x, gap))

    def _gap(self, rail: Rail, s: Array, x: Array) -> Array:
        """Return the vertical gap at arc lengths s in planes x, shape (n,), mm; 1 m beside it."""
        points, _ = self.cut(s, x)
        below, _, _ = rail.across(x, points[:, 1], near=top_of(rail))
        outside = np.abs(below[:, 0] - points[:, 1]) > 1e-3
        return np.where(outside, 1e3, below[:, 1] - points[:, 2])

    def at_contact(self, gap: float) -> Self:
        """Return the wheel lowered by a vertical gap, mm, so that it touches the rail."""
        return replace(self, z=self.z + gap)
