"""A wheelset on a track: positions of the surfaces of a wheel and a rail.

Track frame: x along the rolling direction, y outward to the right, z downwards; the tops of the
unloaded rails lie at z = 0, and y = 0 is the middle of the track. A wheelset is displaced by y,
turned by the yaw about z, and by the roll about its own x-axis; a positive roll lowers the right
wheel. A left wheel is computed as a right one in the mirror: y, yaw and roll change their signs.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from .profile import Array, Profile


def place_rail(
    rail: Profile, inclination: float, gauge: float, gauge_depth: float = 14.0
) -> Profile:
    """Return the right rail in the track frame: inclined, gauge face at gauge/2, top at z = 0.

    Parameters
    ----------
    rail : Profile
        The rail in its own frame.
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
    s = np.linspace(turned.s[0], turned.s[-1], 20 * turned.s.size)
    dense = turned.at(s)
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
    """

    tape_line = 70.0
    """Distance of the tread datum from the back of the wheel, mm (EN 13715)."""

    profile: Profile
    radius: float
    inner: float
    y: float = 0.0
    yaw: float = 0.0
    roll: float = 0.0
    z: float = 0.0

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
        local, slope = self.profile.at(s), self.profile.angle(s)
        ahead = self.turn[0]
        needed = np.sin(slope) * ahead[1] / np.cos(slope)
        reach = np.hypot(ahead[0], ahead[2])
        with np.errstate(invalid="ignore"):
            around = np.arcsin(needed / reach) - np.arctan2(ahead[2], ahead[0])
        radius = self.radius + local[:, 1]
        sine, cosine = np.sin(around), np.cos(around)
        points = np.stack((radius * sine, self.datum + local[:, 0], radius * cosine), axis=1)
        normals = np.stack((np.cos(slope) * sine, -np.sin(slope), np.cos(slope) * cosine), axis=1)
        normals = normals @ self.turn.T
        return points @ self.turn.T + self.centre, np.arctan2(-normals[:, 1], normals[:, 2])

    def at_contact(self, gap: float) -> Self:
        """Return the wheel lowered by a vertical gap, mm, so that it touches the rail."""
        return replace(self, z=self.z + gap)
