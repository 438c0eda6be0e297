"""Contact of a wheel and a rail: points of touch, and the patches under a load."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
import scipy  # its parts are loaded when first used

from .profile import Array, Profile
from .wheelset import Wheel


class NoContactError(ValueError):
    """The wheel does not rest on the rail."""


@dataclass(frozen=True, eq=False)
class Clearance:
    """Vertical distance of a wheel from the rail, along the points of the wheel that can touch it.

    Attributes
    ----------
    s : ndarray, shape (n,)
        Arc lengths of the wheel profile, mm.
    points : ndarray, shape (n, 3)
        Points of the wheel in the track frame, mm.
    gap : ndarray, shape (n,)
        Vertical distance, mm; inf beside the rail.
    angles : ndarray, shape (2, n)
        Angles of the wheel and of the rail below it, rad.
    rail_s : ndarray, shape (n,)
        Arc lengths of the rail profile below, mm.
    """

    s: Array
    points: Array
    gap: Array
    angles: Array
    rail_s: Array

    @classmethod
    def measure(cls, wheel: Wheel, rail: Profile, s: Array) -> Clearance:
        """Measure the distance at arc lengths of the wheel profile."""
        points, angles = wheel.silhouette(s)
        y = np.nan_to_num(points[:, 1], nan=1e9)
        rail_s = rail.locate(y, near=_top(rail))
        below = rail.at(rail_s)
        outside = ~(np.abs(below[:, 0] - y) < 1e-6)
        gap = np.where(outside, np.inf, below[:, 1] - np.nan_to_num(points[:, 2]))
        return cls(s, points, gap, np.stack((angles, rail.angle(rail_s))), rail_s)

    def refined(self, wheel: Wheel, rail: Profile, window: float, parts: int = 8) -> Clearance:
        """Return the distance at denser points of the part within a window above its minimum."""
        near = self.gap <= self.gap.min() + window
        near[1:] |= near[:-1]
        near[:-1] |= near[1:]
        starts = np.flatnonzero(near[:-1] & near[1:])
        share = np.arange(parts) / parts
        dense = self.s[starts, None] + np.diff(self.s)[starts, None] * share
        s = np.unique(np.concatenate((dense.ravel(), self.s[near])))
        return self.measure(wheel, rail, s)


def _top(rail: Profile) -> float:
    """Return y of the highest node of a rail."""
    return float(rail.points[np.argmin(rail.points[:, 1]), 0])


def _steepness(wheel: Wheel, rail: Profile, s: float) -> float:
    """Return the angle of the wheel minus the angle of the rail below it, rad."""
    clearance = Clearance.measure(wheel, rail, np.array([s]))
    return float(clearance.angles[0, 0] - clearance.angles[1, 0])


def find_contact_points(wheel: Wheel, rail: Profile, window: float = 0.0) -> Clearance:
    """Return the points of first touch of wheel and rail, and of near touch.

    Parameters
    ----------
    wheel, rail : Wheel and Profile
        A right wheel, and the right rail in the track frame.
    window : float
        Largest vertical distance above the least one at which a local minimum counts, mm.

    Returns
    -------
    Clearance
        Local minima of the distance, with equal angles of wheel and rail, the least one first.

    Raises
    ------
    NoContactError
        If they miss each other, or the contact is beyond the top of the flange or at an end of a
        profile.
    """
    clearance = Clearance.measure(wheel, rail, wheel.profile.s)
    _check_contact(clearance, wheel)
    inner = clearance.gap[1:-1]
    limit = clearance.gap.min() + window + 1e-3  # the minimum between nodes may be a little lower
    low = (inner <= clearance.gap[:-2]) & (inner < clearance.gap[2:]) & (inner <= limit)
    nodes = np.flatnonzero(low) + 1 if window else [int(np.argmin(clearance.gap))]
    touching = Clearance.measure(
        wheel, rail, np.array([_equal_angles(wheel, rail, int(k)) for k in nodes])
    )
    order = np.argsort(touching.gap)
    order = order[touching.gap[order] <= touching.gap.min() + window]
    return Clearance(
        touching.s[order],
        touching.points[order],
        touching.gap[order],
        touching.angles[:, order],
        touching.rail_s[order],
    )


def _equal_angles(wheel: Wheel, rail: Profile, node: int) -> float:
    """Return the arc length beside a node at which wheel and rail have equal angles."""
    first, last = wheel.profile.s[[node - 1, node + 1]]
    if _steepness(wheel, rail, first) * _steepness(wheel, rail, last) >= 0.0:
        return float(wheel.profile.s[node])  # a kink of a worn or a measured profile
    # The distance is stationary there: an error of 1e-9 mm changes it by less than 1e-18 mm.
    return float(
        scipy.optimize.brentq(lambda s: _steepness(wheel, rail, s), first, last, xtol=1e-9)
    )


def lowest_gap(wheel: Wheel, rail: Profile) -> float:
    """Return the least vertical distance of a wheel from the rail, mm."""
    return float(find_contact_points(wheel, rail).gap[0])


def free_roll(right: Wheel, rail: Profile, tolerance: float = 1e-11) -> float:
    """Return the roll at which both wheels of a wheelset touch equal rails, rad.

    Parameters
    ----------
    right : Wheel
        The right wheel; its roll is the initial guess.
    rail : Profile
        The right rail, in the track frame.
    tolerance : float
        Error of the roll, rad.
    """

    def difference(roll: float) -> float:
        turned = replace(right, roll=roll)
        return lowest_gap(turned, rail) - lowest_gap(turned.mirrored(), rail)

    return float(scipy.optimize.newton(difference, right.roll, x1=right.roll + 1e-5, tol=tolerance))


def _check_contact(clearance: Clearance, wheel: Wheel, flange_top: float = 2.0) -> None:
    """Raise an error unless the wheel rests on the rail with its tread or the face of its flange.

    Parameters
    ----------
    clearance : Clearance
        Distance at the nodes of the wheel profile.
    wheel : Wheel
        The wheel.
    flange_top : float
        Height of the top of the flange, mm; its face ends there (EN 13715).
    """
    if not np.isfinite(clearance.gap).any():
        raise NoContactError("the wheel does not meet the rail: check y, inner and gauge")
    k = int(np.argmin(clearance.gap))
    height = wheel.profile.points[:, 1]
    if height[k] > height.max() - flange_top or k <= np.argmax(height):
        raise NoContactError(
            "the wheel has derailed: the top of its flange is on the rail; reduce y or yaw"
        )
    measured = np.isfinite(clearance.gap[max(k - 1, 0) : k + 2])
    if k == clearance.gap.size - 1 or not measured.all():
        raise NoContactError(
            "the contact is at an end of a profile: extend the profile, or check y, inner and gauge"
        )


@dataclass(frozen=True, eq=False)
class Patch:
    """A contact patch in its own tangent plane.

    In the plane x points along the rolling direction and y outward, up the flange of the wheel if
    the angle is negative; distances normal to it are positive from the rail to the wheel.

    Attributes
    ----------
    wheel, rail : Wheel and Profile
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
    """

    wheel: Wheel
    rail: Profile
    origin: Array
    angle: float
    half_length: tuple[float, float]
    angle_range: float
    limits: tuple[float, float] = (-np.inf, np.inf)

    @property
    def lateral(self) -> Array:
        """Unit vector of y in the track frame."""
        return np.array([0.0, np.cos(self.angle), np.sin(self.angle)])

    @property
    def normal(self) -> Array:
        """Unit vector from the rail to the wheel in the track frame."""
        return np.array([0.0, np.sin(self.angle), -np.cos(self.angle)])

    @cached_property
    def wheel_s(self) -> float:
        """Arc length of the wheel profile at the origin, mm."""
        return float(self.wheel_at(np.zeros((1, 1)), np.zeros((1, 1)))[1][0, 0])

    @property
    def rolling_radius(self) -> float:
        """Radius of the wheel at the origin, mm."""
        return self.wheel.radius + float(self.wheel.profile.at(self.wheel_s)[1])

    @property
    def radius_x(self) -> float:
        """Radius of the wheel in the plane through x and the normal, mm."""
        return self.rolling_radius / float(np.cos(self.angle))

    def rail_profile(self, y: Array) -> tuple[Array, Array]:
        """Return height of the rail over the plane, mm, and its arc length, at y, shape (n,)."""
        s = self.rail.locate(y, self.origin[1:], self.angle, near=float(self.origin[1]))
        return (self.rail.at(s) - self.origin[1:]) @ self.normal[1:], s

    def wheel_profile(self, y: Array) -> tuple[Array, Array]:
        """Return height of the wheel over the plane at x = 0, and its arc length, shape (n,)."""
        height, s = self.wheel_at(np.zeros((1, 1)), np.asarray(y)[None, :])
        return height[0], s[0]

    def angle_range_over(self, y: Array) -> float:
        """Return the difference of the contact angles over positions in the plane, rad.

        The contact angle is the mean of the angles of wheel and rail.
        """
        wheel = self.wheel.profile.angle(self.wheel_profile(y)[1])
        return float(np.ptp(0.5 * (wheel + self.rail.angle(self.rail_profile(y)[1]))))

    def gap(self, x: Array, y: Array, apart: float = 1.0) -> Array:
        """Return the normal distance of the undeformed surfaces, mm.

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
        height, _ = self.wheel_at(np.asarray(x)[:, None], np.asarray(y)[None, :])
        outside = (y < self.limits[0]) | (y > self.limits[1])
        return np.asarray(height - self.rail_profile(y)[0] + apart * outside)

    def wheel_at(self, x: Array, y: Array, steps: int = 8) -> tuple[Array, Array]:
        """Return height of the wheel over points of the plane, and arc length of its profile.

        By Newton's method for the point of the wheel on the normal, exact for any yaw and roll.
        """
        wheel, x, y = self.wheel, *np.broadcast_arrays(x, y)
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
        """Return the slip of the wheel over the rail per rolling speed.

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
        height, _ = self.rail_profile(y)
        spin = -(1.0 + pitch) / self.wheel.radius * self.wheel.turn[:, 1]
        at = (self.origin - self.wheel.centre)[:, None, None] + np.multiply.outer(
            self.lateral, np.ones((x.size, 1)) * y
        )
        at = at + np.multiply.outer(self.normal, np.ones((x.size, 1)) * height)
        at = at + np.multiply.outer(np.array([1.0, 0.0, 0.0]), x[:, None] * np.ones(y.size))
        velocity = np.array([1.0, 0.0, 0.0])[:, None, None] + np.cross(spin, at, axisb=0, axisc=0)
        return np.stack((velocity[0], np.tensordot(self.lateral, velocity, 1)))

    def creepages(self, pitch: float = 0.0) -> tuple[float, float, float]:
        """Return longitudinal and lateral creepage and spin (1/mm) at the origin."""
        axle = -(1.0 + pitch) / self.wheel.radius * self.wheel.turn[:, 1]
        velocity = np.array([1.0, 0.0, 0.0]) + np.cross(axle, self.origin - self.wheel.centre)
        spin = self.lateral @ np.cross(axle, np.array([1.0, 0.0, 0.0]))
        return float(velocity[0]), float(velocity @ self.lateral), float(spin)


def find_patches(wheel: Wheel, rail: Profile, load: float, e_star: float) -> list[Patch]:
    """Return the patches of a wheel under a vertical load, the one with most load first.

    Patches are the separate regions in which the undeformed bodies overlap if they approach each
    other as far as the load requires, estimated from the areas of overlap as for Hertz contacts.
    The plane of a patch is at the centre of its overlap and has the mean angle there.

    Parameters
    ----------
    wheel, rail : Wheel and Profile
        A right wheel, and the right rail in the track frame.
    load : float
        Vertical load, N.
    e_star : float
        Contact modulus 1/(1/E_A' + 1/E_B'), MPa.

    Raises
    ------
    NoContactError
        See `find_contact_points`.
    """
    wheel = wheel.at_contact(lowest_gap(wheel, rail))
    coarse = Clearance.measure(wheel, rail, wheel.profile.s)
    clearance = coarse.refined(wheel, rail, window=0.6)

    def excess(depth: float) -> float:
        return sum(overlap.force(e_star) for overlap in _overlaps(clearance, wheel, depth)) - load

    deepest = 1e-3
    while excess(deepest) < 0.0 and deepest < 0.5:
        deepest *= 2.0
    if excess(deepest) < 0.0:
        raise NoContactError(
            f"the load of {load:g} N presses the wheel more than 0.5 mm deep; lower the load"
        )
    depth = float(scipy.optimize.brentq(excess, 1e-9, deepest, xtol=1e-9))
    overlaps = _overlaps(clearance, wheel, depth)
    between = [-np.inf]
    for before, after in pairwise(overlaps):
        ends = slice(before.part.stop - 1, after.part.start + 1)
        between.append(float(clearance.points[ends, 1][np.argmax(clearance.gap[ends])]))
    between.append(np.inf)
    pairs = sorted(zip(overlaps, pairwise(between), strict=True), key=lambda p: -p[0].force(e_star))
    return [overlap.patch(wheel, rail, limits) for overlap, limits in pairs]


@dataclass(frozen=True, eq=False)
class _Overlap:
    """A region in which the undeformed bodies overlap: a part of a `Clearance`."""

    clearance: Clearance
    part: slice
    depth: Array
    """Vertical overlap at its points, mm."""
    radius: float

    @cached_property
    def _weights(self) -> Array:
        """Weights of the points of the overlap, shape (n,): its squared depth, normalised."""
        y = self.clearance.points[self.part, 1]
        weights = self.depth**2 * np.gradient(y) if y.size > 1 else np.ones(1)
        return np.asarray(weights / weights.sum())

    def _mean(self, values: Array) -> float:
        """Return the weighted mean over the overlap of values at all points."""
        return float(self._weights @ values[self.part])

    @cached_property
    def _angles(self) -> Array:
        """Mean of the angles of wheel and rail at all points, rad."""
        return np.asarray(self.clearance.angles.mean(axis=0))

    @cached_property
    def angle(self) -> float:
        """Mean angle, rad."""
        return self._mean(self._angles)

    @property
    def _half_length(self) -> Array:
        """Half length of the overlap in x at its points, mm."""
        return np.sqrt(2.0 * self.radius * self.depth)  # cos(angle) cancels

    def force(self, e_star: float) -> float:
        """Return the vertical force of a Hertz contact with an equal area of overlap, N."""
        y = self.clearance.points[self.part, 1]
        cosine = np.cos(self.angle)
        area = 2.0 * (self._half_length * np.gradient(y)).sum() / cosine if y.size > 1 else 0.0
        normal = 4.0 / 3.0 * e_star * self.depth.max() * cosine * np.sqrt(area / (2.0 * np.pi))
        return float(normal * cosine)

    def patch(self, wheel: Wheel, rail: Profile, limits: tuple[float, float]) -> Patch:
        """Return the patch of the overlap, between lateral positions in the track, mm."""
        points = self.clearance.points
        y = self._mean(points[:, 1])
        z = float(rail.at(rail.locate(y, near=_top(rail)))[1])
        origin = np.array([self._mean(points[:, 0]), y, z])
        wide = 0.5 * float(np.ptp(points[self.part, 1])) / float(np.cos(self.angle))
        angles = self._angles[self.part][self.depth >= 0.5 * self.depth.max()]
        half = float(self._half_length.max()), wide
        first, last = ((limit - y) / float(np.cos(self.angle)) for limit in limits)
        return Patch(wheel, rail, origin, self.angle, half, float(np.ptp(angles)), (first, last))


def _overlaps(clearance: Clearance, wheel: Wheel, depth: float) -> list[_Overlap]:
    """Return the regions of overlap of a wheel at a depth, mm, below the first touch."""
    overlap = depth - clearance.gap
    edges = np.flatnonzero(np.diff(np.concatenate(([0], (overlap > 0.0).astype(int), [0]))))
    parts = [part for first, last in edges.reshape(-1, 2) for part in _divide(overlap, first, last)]
    radius = [
        wheel.radius + float(wheel.profile.at(clearance.s[part])[:, 1].mean()) for part in parts
    ]
    return [
        _Overlap(clearance, part, overlap[part], r)
        for part, r in zip(parts, radius, strict=True)
        if part.stop - part.start > 1
    ]


def _divide(overlap: Array, first: int, last: int, share: float = 0.5) -> list[slice]:
    """Divide a region of overlap between its maxima.

    In Hertz contacts the surfaces touch in the area in which the undeformed bodies overlap by more
    than half of the approach. So two patches are separate if the overlap between them falls below
    this share of both maxima.
    """
    lowest = [
        k for k in range(first + 1, last - 1) if overlap[k - 1] > overlap[k] <= overlap[k + 1]
    ]
    for k in sorted(lowest, key=lambda k: overlap[k]):
        if overlap[k] < share * min(overlap[first:k].max(), overlap[k:last].max()):
            return [*_divide(overlap, first, k, share), *_divide(overlap, k, last, share)]
    return [slice(first, last)]
