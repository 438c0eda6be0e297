"""A contact patch of a wheel and a rail in its own tangent plane."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from .profile import Array, Rail
from .wheelset import Wheel


@dataclass(frozen=True, eq=False)
class Patch:
    """Contact patch of a wheel on a rail, in its tangent plane (x rolling, y outward).

    In the plane x points along the rolling direction and y outward, up the flange of the wheel if
    the angle is negative; distances normal to it are positive from the rail to the wheel.

    Attributes
    ----------
    wheel, rail : Wheel and Rail
        The wheel as it first touches the rail, and the rail.
    origin : ndarray, shape (3,)
        Origin of the plane in the track frame, on the rail, mm.
    angle : float
        Angle of the plane to the horizontal, rad: positive if it descends outward.
    half_length : tuple of float
        Half lengths in x and y within which the undeformed bodies would overlap, mm.
    angle_range : float
        Difference of the contact angles, rad, in the area in which the undeformed bodies would
        overlap by more than half of the largest depth, the area of a Hertz contact. It is large if
        the contact is conformal.
    limits : tuple of float
        Lateral positions in the plane beyond which other patches touch, mm.
    depth : float
        Vertical distance of the wheel below its first touch, mm, for the gap; `find_patches` gives
        its estimate. The slip does not depend on it.
    """

    wheel: Wheel
    rail: Rail
    origin: Array
    angle: float
    half_length: tuple[float, float]
    angle_range: float
    limits: tuple[float, float] = (-np.inf, np.inf)
    depth: float = 0.0

    def lowered(self, depth: float) -> Self:
        """Return the patch with its depth below first touch set to `depth`, mm.

        In the inclined plane the wheel moves not only towards the rail, but also along the plane.
        """
        return replace(self, depth=depth)

    @property
    def lateral(self) -> Array:
        """Unit vector of the patch's y axis in the track frame."""
        return np.array([0.0, np.cos(self.angle), np.sin(self.angle)])

    @property
    def normal(self) -> Array:
        """Unit normal of the patch, from the rail to the wheel, in the track frame."""
        return np.array([0.0, np.sin(self.angle), -np.cos(self.angle)])

    @cached_property
    def _lowered_wheel(self) -> Wheel:
        """Wheel lowered to the depth of the patch."""
        return self.wheel.at_contact(self.depth)

    @cached_property
    def wheel_s(self) -> float:
        """Arc length of the wheel profile at the patch's origin, mm."""
        return float(self.wheel_at(np.zeros((1, 1)), np.zeros((1, 1)))[1][0, 0])

    @property
    def rolling_radius(self) -> float:
        """Rolling radius of the wheel at the patch's origin, mm."""
        return self.wheel.radius + float(self.wheel.profile.at(self.wheel_s)[1])

    @property
    def radius_x(self) -> float:
        """Radius of curvature of the wheel at the patch's origin, in the plane of x, mm."""
        return self.rolling_radius / float(np.cos(self.angle))

    @cached_property
    def opening(self) -> float:
        """Smallest distance between wheel and rail along the normal, mm; negative if they overlap.

        The points of the wheel that face the rail (`Wheel.facing`) around the origin are searched,
        as far as the undeformed bodies overlap on either side: normals of a steep plane also cross
        the back of the flange. The interval around the nearest point is divided again and again,
        down to 1e-4 mm.
        """
        ahead = np.array([1.0, 0.0, 0.0])
        axes = np.stack((ahead, self.lateral, self.normal), axis=1)
        around = 2.0 * self.half_length[1] * np.array([-1.0, 1.0])
        first, last = np.clip(self.wheel_s + around, *self.wheel.profile.s[[0, -1]])
        for _ in range(4):
            s = np.linspace(first, last, 33)
            points, _angles = self._lowered_wheel.facing(self.rail, s)
            x, y, height = ((np.nan_to_num(points, nan=1e9) - self.origin) @ axes).T
            outside = (np.abs(y) > 1e6) | (y <= self.limits[0]) | (y >= self.limits[1])
            gap = height - self.rail_at(x, np.where(outside, 0.0, y))[0]
            gap[outside] = np.inf
            k = int(np.argmin(gap))
            first, last = s[max(k - 1, 0)], s[min(k + 1, s.size - 1)]
        return float(gap.min())

    def rail_at(self, x: Array, y: Array) -> tuple[Array, Array, Array]:
        """Return rail (height normal to the patch, angle, arc length) at x and y, mm and rad.

        x and y are broadcast; for a prismatic rail the results have the shape of y.
        """
        points, angle, s = self.rail.across(
            x + self.origin[0], y, self.origin[1:], self.angle, near=float(self.origin[1])
        )
        return (points - self.origin[1:]) @ self.normal[1:], angle, s

    def wheel_profile(self, y: Array) -> tuple[Array, Array]:
        """Return (wheel height along the patch normal, profile arc length) at x = 0 and y, mm."""
        height, s = self.wheel_at(np.zeros((1, 1)), np.asarray(y)[None, :])
        return height[0], s[0]

    def angle_range_over(self, y: Array) -> float:
        """Return the range (largest minus smallest) of the contact angle over y (n,), rad.

        The contact angle is the mean of the angles of wheel and rail.
        """
        wheel = self.wheel.profile.angle(self.wheel_profile(y)[1])
        return float(np.ptp(0.5 * (wheel + self.rail_at(np.zeros(1), y)[1])))

    def gap(self, x: Array, y: Array, apart: float = 1.0) -> Array:
        """Return the undeformed gap normal to the patch, mm, (n, m), plus `apart` beside limits.

        Parameters
        ----------
        x, y : ndarray, shape (n,) and (m,)
            Positions in the plane, mm.
        apart : float
            Distance to add beyond the limits, mm, so that other patches are not counted again.

        Returns
        -------
        ndarray, shape (n, m)
        """
        along, across = np.asarray(x)[:, None], np.asarray(y)[None, :]
        outside = (across < self.limits[0]) | (across > self.limits[1])
        height = self.wheel_at(along, across)[0] - self.rail_at(along, across)[0]
        return np.asarray(height + apart * outside)

    def wheel_at(self, x: Array, y: Array, steps: int = 8) -> tuple[Array, Array]:
        """Return (height of the wheel normal to the patch, its profile arc length) at (x, y), mm.

        By Newton's method for the point of the wheel on the normal, exact for any yaw and roll.
        """
        wheel, x, y = self._lowered_wheel, *np.broadcast_arrays(x, y)
        turned = wheel.turn.T
        base = (turned @ (self.origin - wheel.centre))[:, None, None]
        base = base + turned[:, :1, None] * x + (turned @ self.lateral)[:, None, None] * y
        along = turned @ self.normal
        height = np.zeros(x.shape)
        s = wheel.profile.locate(base[1, 0] - wheel.datum, near=float(base[1].mean() - wheel.datum))
        s = np.broadcast_to(s, x.shape)
        for _ in range(steps):
            q = base + along[:, None, None] * height
            radius, local, slope = np.hypot(q[0], q[2]), wheel.profile.at(s), wheel.profile.at(s, 1)
            across = radius - wheel.radius - local[..., 1], q[1] - wheel.datum - local[..., 0]
            change = (q[0] * along[0] + q[2] * along[2]) / radius
            determinant = -change * slope[..., 0] + along[1] * slope[..., 1]
            step = (across[0] * slope[..., 0] - across[1] * slope[..., 1]) / determinant
            move = (change * across[1] - along[1] * across[0]) / -determinant
            height, s = height + step, np.clip(s + move, *wheel.profile.s[[0, -1]])
            if np.abs(step).max() < 1e-11:
                break
        return height, s

    def rigid_slip(self, x: Array, y: Array, pitch: float = 0.0) -> Array:
        """Return the rigid slip of the wheel over the rail per rolling speed, (2, n_x, n_y).

        Parameters
        ----------
        x, y : ndarray, shape (n_x,) and (n_y,)
            Points of the rail, mm.
        pitch : float
            Angular velocity of the wheel over V / radius, minus 1.

        Returns
        -------
        ndarray, shape (2, n_x, n_y)
            Components along x and y of the plane.
        """
        height = self.rail_at(x[:, None], y[None, :])[0]
        spin = -(1.0 + pitch) / self.wheel.radius * self.wheel.turn[:, 1]
        at = (self.origin - self.wheel.centre)[:, None, None] + np.multiply.outer(
            self.lateral, np.ones((x.size, 1)) * y
        )
        at = at + np.multiply.outer(self.normal, np.ones((x.size, 1)) * height)
        at = at + np.multiply.outer(np.array([1.0, 0.0, 0.0]), x[:, None] * np.ones(y.size))
        velocity = self.wheel.velocity[:, None, None] + np.cross(spin, at, axisb=0, axisc=0)
        return np.stack((velocity[0], np.tensordot(self.lateral, velocity, 1)))

    def pitch_at(self, longitudinal: float) -> float:
        """Return the pitch at which the longitudinal creepage at the origin has a value."""
        unmoved, moved = (self.creepages(pitch)[0] for pitch in (0.0, 1.0))
        return (longitudinal - unmoved) / (moved - unmoved)

    def moment_about_axle(self, force: tuple[float, float], spin_moment: float) -> float:
        """Return the moment about the axle, N mm, of tractions on the wheel.

        The pressure has none: the normals of a surface of revolution meet its axis.

        Parameters
        ----------
        force : tuple of float
            Sum of the tractions along x and y of the plane, N.
        spin_moment : float
            Their moment about the normal at the origin, M_z, N mm.
        """
        along = np.array([1.0, 0.0, 0.0])
        moment = np.cross(
            self.origin - self.wheel.centre, force[0] * along + force[1] * self.lateral
        )
        moment = moment + spin_moment * np.cross(along, self.lateral)
        return float(self.wheel.turn[:, 1] @ moment)

    def creepages(self, pitch: float = 0.0) -> tuple[float, float, float]:
        """Return longitudinal and lateral creepage and spin (1/mm) at the patch's origin."""
        axle = -(1.0 + pitch) / self.wheel.radius * self.wheel.turn[:, 1]
        velocity = self.wheel.velocity + np.cross(axle, self.origin - self.wheel.centre)
        spin = self.lateral @ np.cross(axle, np.array([1.0, 0.0, 0.0]))
        return float(velocity[0]), float(velocity @ self.lateral), float(spin)
