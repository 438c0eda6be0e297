"""Contact of a wheel and a rail: points of touch, and the patches under a load."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
import scipy  # its parts are loaded when first used

from .patch import Patch
from .profile import Array, Rail
from .wheelset import Wheel, top_of


class NoContactError(ValueError):
    """Error of a wheel position in which the wheel does not rest on the rail."""


@dataclass(frozen=True, eq=False)
class Clearance:
    """Vertical distance between wheel and rail at points of the wheel.

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
    def measure(cls, wheel: Wheel, rail: Rail, s: Array) -> Clearance:
        """Return vertical gap (inf beside the rail) and angles at arc lengths of the wheel."""
        points, angles = wheel.facing(rail, s)
        y = np.nan_to_num(points[:, 1], nan=1e9)
        below, rail_angles, rail_s = rail.across(points[:, 0], y, near=top_of(rail))
        outside = ~(np.abs(below[:, 0] - y) < 1e-6)
        gap = np.where(outside, np.inf, below[:, 1] - np.nan_to_num(points[:, 2]))
        return cls(s, points, gap, np.stack((angles, rail_angles)), rail_s)

    def refined(self, wheel: Wheel, rail: Rail, window: float, parts: int = 8) -> Clearance:
        """Return the clearance at denser points within `window` of its minimum, and only there."""
        near = self.gap <= self.gap.min() + window
        near[1:] |= near[:-1]
        near[:-1] |= near[1:]
        starts = np.flatnonzero(near[:-1] & near[1:])
        share = np.arange(parts) / parts
        dense = self.s[starts, None] + np.diff(self.s)[starts, None] * share
        s = np.unique(np.concatenate((dense.ravel(), self.s[near])))
        return self.measure(wheel, rail, s)


def find_contact_points(wheel: Wheel, rail: Rail, window: float = 0.0) -> Clearance:
    """Return the clearance at local minima of the gap, least first, up to `window` above it.

    Parameters
    ----------
    wheel, rail : Wheel and Rail
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
    s = wheel.profile.s
    s = s[:: max(1, s.size // 400)]  # of S1002, 0.4 mm apart
    clearance = Clearance.measure(wheel, rail, s)
    _check_contact(clearance, wheel)
    inner = clearance.gap[1:-1]
    # Between nodes, a minimum may be lower by their distance squared over 8 times the curvature.
    limit = clearance.gap.min() + window + 0.125 * 0.1 * float(np.diff(s).max()) ** 2
    low = (inner <= clearance.gap[:-2]) & (inner < clearance.gap[2:]) & (inner <= limit)
    nodes = np.flatnonzero(low) + 1
    if not nodes.size:
        nodes = np.array([np.argmin(clearance.gap)])
    touching = Clearance.measure(
        wheel, rail, np.array([_equal_angles(wheel, rail, s[k - 1 : k + 2]) for k in nodes])
    )
    order = np.argsort(touching.gap)
    order = order[touching.gap[order] <= touching.gap.min() + window]
    return Clearance(
        *(touching.s[order], touching.points[order], touching.gap[order]),
        *(touching.angles[:, order], touching.rail_s[order]),
    )


def _equal_angles(
    wheel: Wheel, rail: Rail, around: Array, parts: int = 16, times: int = 3
) -> float:
    """Return the arc length near a node at which wheel and rail have equal angles (touch).

    The interval is divided several times, and interpolated linearly at last: nodes 0.4 mm apart
    leave less than 1e-9 mm. The distance is stationary there.

    Parameters
    ----------
    wheel, rail : Wheel and Rail
        See `contact_points`.
    around : ndarray, shape (3,)
        Arc lengths of the node and of its neighbours.
    parts, times : int
        Parts of each division, and number of divisions.
    """
    first, node, last = around
    for _ in range(times):
        s = np.linspace(first, last, parts + 1)
        clearance = Clearance.measure(wheel, rail, s)
        steepness = clearance.angles[0] - clearance.angles[1]
        minima = np.flatnonzero((steepness[:-1] >= 0.0) & (steepness[1:] <= 0.0))
        if not minima.size:
            return float(node)  # a kink of a worn or a measured profile
        k = int(minima[np.argmin(clearance.gap[minima])])
        first, last = s[k], s[k + 1]
    return float(np.interp(0.0, steepness[[k + 1, k]], s[[k + 1, k]]))


def lowest_gap(wheel: Wheel, rail: Rail) -> float:
    """Return the least vertical distance of a wheel from the rail, mm; error without contact."""
    return float(find_contact_points(wheel, rail).gap[0])


def free_roll(right: Wheel, rail: Rail, tolerance: float = 1e-11) -> float:
    """Return the roll angle, rad, at which both wheels of a wheelset touch equal rails.

    Parameters
    ----------
    right : Wheel
        The right wheel; its roll is the initial guess.
    rail : Rail
        The right rail, in the track frame.
    tolerance : float
        Error of the roll, rad.
    """

    def difference(roll: float) -> float:
        turned = replace(right, roll=roll)
        return lowest_gap(turned, rail) - lowest_gap(turned.mirrored(), rail)

    return float(scipy.optimize.newton(difference, right.roll, x1=right.roll + 1e-5, tol=tolerance))


def _check_contact(
    clearance: Clearance, wheel: Wheel, flange_top: float = 2.0, lowest_flange: float = 5.0
) -> None:
    """Raise a NoContactError unless the wheel rests on its tread or the face of its flange.

    Parameters
    ----------
    clearance : Clearance
        Distance at the nodes of the wheel profile.
    wheel : Wheel
        The wheel.
    flange_top : float
        Height of the top of the flange, mm; its face ends there (EN 13715).
    lowest_flange : float
        Height above the tread datum up to which a profile has no flange, mm; flanges have 25 to 36.
    """
    if not np.isfinite(clearance.gap).any():
        raise NoContactError("the wheel does not meet the rail")
    k = int(np.argmin(clearance.gap))
    height = wheel.profile.at(clearance.s)[:, 1]
    # Cylindrical and crowned wheels have no flange.
    has_flange = height.max() - float(wheel.profile.height(0.0)) > lowest_flange
    if has_flange and (height[k] > height.max() - flange_top or k <= np.argmax(height)):
        raise NoContactError("the wheel has derailed: the top of its flange is on the rail")
    measured = np.isfinite(clearance.gap[max(k - 1, 0) : k + 2])
    if k in (0, clearance.gap.size - 1) or not measured.all():
        raise NoContactError("the contact is at an end of a profile, which may be too short")


def find_patches(wheel: Wheel, rail: Rail, load: float, e_star: float) -> list[Patch]:
    """Return patches of a loaded wheel, largest first; NoContactError beyond 0.5 mm of depth.

    Patches are the separate regions in which the undeformed bodies overlap if they approach each
    other as far as the load requires, estimated from the areas of overlap as for Hertz contacts.
    The plane of a patch is at the centre of its overlap and has the mean angle there.

    Parameters
    ----------
    wheel, rail : Wheel and Rail
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
    touching = find_contact_points(wheel, rail)
    wheel = wheel.at_contact(float(touching.gap[0]))
    limit = 0.5 / float(np.cos(touching.angles[0, 0]))
    coarse = Clearance.measure(wheel, rail, wheel.profile.s)
    clearance = coarse.refined(wheel, rail, window=1.2 * limit)

    def excess(depth: float) -> float:
        return sum(overlap.force(e_star) for overlap in _overlaps(clearance, wheel, depth)) - load

    deepest = 1e-3
    while excess(deepest) < 0.0 and deepest < limit:
        deepest *= 2.0
    if excess(deepest) < 0.0:
        raise NoContactError(
            f"the load of {load:g} N presses the wheel more than 0.5 mm deep normal to the contact "
            f"plane, at a contact angle of {np.degrees(touching.angles[0, 0]):.0f} degrees; lower "
            "the load"
        )
    depth = float(scipy.optimize.brentq(excess, 1e-9, deepest, xtol=1e-9))
    overlaps = _overlaps(clearance, wheel, depth)
    between = [-np.inf]
    for before, after in pairwise(overlaps):
        ends = slice(before.part.stop - 1, after.part.start + 1)
        between.append(float(clearance.points[ends, 1][np.argmax(clearance.gap[ends])]))
    between.append(np.inf)
    pairs = sorted(zip(overlaps, pairwise(between), strict=True), key=lambda p: -p[0].force(e_star))
    return [overlap.patch(wheel, rail, limits, depth) for overlap, limits in pairs]


@dataclass(frozen=True, eq=False)
class _Overlap:
    """Region of a `Clearance` in which the undeformed wheel and rail overlap, with its depth."""

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
        """Return the mean over the overlap of clearance values, weighted by the squared depth."""
        return float(self._weights @ values[self.part])

    @cached_property
    def _angles(self) -> Array:
        """Means of the angles of wheel and rail at all points of the clearance, rad."""
        return np.asarray(self.clearance.angles.mean(axis=0))

    @cached_property
    def angle(self) -> float:
        """Contact angle of the overlap: weighted mean of the angles, rad."""
        return self._mean(self._angles)

    @property
    def _half_length(self) -> Array:
        """Half length of the overlap in x at each of its points, mm."""
        return np.sqrt(2.0 * self.radius * self.depth)  # cos(angle) cancels

    def force(self, e_star: float) -> float:
        """Return the vertical force, N, of a Hertz contact with the area of the overlap."""
        y = self.clearance.points[self.part, 1]
        cosine = np.cos(self.angle)
        area = 2.0 * (self._half_length * np.gradient(y)).sum() / cosine if y.size > 1 else 0.0
        normal = 4.0 / 3.0 * e_star * self.depth.max() * cosine * np.sqrt(area / (2.0 * np.pi))
        return float(normal * cosine)

    def patch(self, wheel: Wheel, rail: Rail, limits: tuple[float, float], depth: float) -> Patch:
        """Return the contact patch at the centre of the overlap, for a depth of the wheel, mm."""
        points = self.clearance.points
        y = self._mean(points[:, 1])
        x = self._mean(points[:, 0])
        origin = np.array([x, *rail.across(x, y, near=top_of(rail))[0]])
        half = float(self._half_length.max())
        along = rail.across(x + half * np.array([-1.0, 1.0]), y, near=top_of(rail))[0]
        # Within the length of a contact, the height of a rail changes by far less.
        if (along[..., 1] > origin[2] + 10.0).any():
            raise NoContactError(
                f"the contact at x = {x:.4g} mm reaches the beginning or end of a part of the rail"
            )
        wide = 0.5 * float(np.ptp(points[self.part, 1])) / float(np.cos(self.angle))
        angles = self._angles[self.part][self.depth >= 0.5 * self.depth.max()]
        first, last = ((limit - y) / float(np.cos(self.angle)) for limit in limits)
        spread = float(np.ptp(angles))
        return Patch(wheel, rail, origin, self.angle, (half, wide), spread, (first, last), depth)


def _overlaps(clearance: Clearance, wheel: Wheel, depth: float) -> list[_Overlap]:
    """Return the overlap regions when the wheel is lowered by a depth, mm, below first touch."""
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
    """Return slices of an overlap, divided where its depth falls below `share` of both maxima.

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
