"""Contact locus of a wheelset: contact points, rolling radii and equivalent conicity."""

import warnings
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TypeAlias

import numpy as np
import scipy  # its parts are loaded when first used

from .contact import Clearance, find_contact_points, free_roll
from .profile import Array, Profile
from .wheelset import Wheel


@dataclass(frozen=True, eq=False)
class ConicityCheck:
    """Equivalent conicities beside reference values with a tolerance.

    Attributes
    ----------
    title, label : str
        The case, and what its rolling radii follow from.
    amplitude, reference, tolerance, conicity : ndarray, shape (n,)
        Amplitudes, mm; reference values, their tolerances and computed values, tan gamma_e.
    reasons : tuple of str
        Why a value is beyond its tolerance, if the computation shows it; otherwise an empty text.
    """

    title: str
    label: str
    amplitude: Array
    reference: Array
    tolerance: Array
    conicity: Array
    reasons: tuple[str, ...]

    @property
    def agrees(self) -> np.ndarray:
        """Whether values are within their tolerance, shape (n,)."""
        return np.asarray(np.abs(self.conicity - self.reference) <= self.tolerance)

    @property
    def differs(self) -> np.ndarray:
        """Whether values are beyond their tolerance without a reason, shape (n,)."""
        return ~self.agrees & np.array([not reason for reason in self.reasons], bool)


@dataclass(frozen=True, eq=False)
class ContactLocus:
    """Contact points of the wheels of a wheelset on the rails, over its lateral position.

    Arrays of sides have the right wheel first. Positions of the left side refer to its mirror.

    Attributes
    ----------
    y : ndarray, shape (n,)
        Lateral positions of the wheelset, increasing, mm.
    roll : ndarray, shape (n,)
        Roll, rad.
    points : ndarray, shape (2, n, 3)
        Contact points in the track frame of each side, mm.
    wheel, rail : ndarray, shape (2, n, 2)
        These points in the frames of the wheel and of the placed rail, lateral and down, mm.
    angle : ndarray, shape (2, n)
        Contact angles, rad.
    radius : ndarray, shape (2, n)
        Rolling radii, mm.
    jumps : ndarray of bool, shape (n,)
        Positions at which the contact of a side is on another part of the profile than at the
        position before, which differs from them by less than a thousandth of their spacing.
    nominal_radius, tape_distance : float
        Radius at the tread datum, and distance of the tread data of both wheels, mm.

    Examples
    --------
    >>> locus = ts.contact_locus(ts.Scene.builtin("wheel-rail"), [-3.0, 0.0, 3.0])
    >>> bool(abs(locus.radius_difference[1]) < 1e-9)
    True
    """

    y: Array
    roll: Array
    points: Array
    wheel: Array
    rail: Array
    angle: Array
    radius: Array
    jumps: np.ndarray
    nominal_radius: float
    tape_distance: float

    @property
    def radius_difference(self) -> Array:
        """Rolling radius of the right wheel minus the radius of the left one, shape (n,), mm."""
        return np.asarray(self.radius[0] - self.radius[1])

    def conicity(self, amplitude: float, samples: int = 400) -> float:
        """Return the equivalent conicity by harmonic linearisation, tan gamma_e.

        It is the cone with an equal first harmonic of the rolling radius difference over a
        sinusoidal motion of the wheelset.

        Parameters
        ----------
        amplitude : float
            Amplitude of the lateral motion, within `y`, mm.
        samples : int
            Points over a wavelength.

        Raises
        ------
        ValueError
            If the amplitude is not positive or leaves `y`.
        """
        self._check_amplitude(amplitude)
        phase = 2.0 * np.pi * (np.arange(samples) + 0.5) / samples
        difference = np.interp(amplitude * np.sin(phase), self.y, self.radius_difference)
        return float((difference * np.sin(phase)).mean() / amplitude)

    def conicity_error(self, amplitude: float) -> float:
        """Return an error bar of `conicity`: its change if every other position is left out.

        Linear interpolation between half as many positions has about four times the error. The
        larger change by even and by odd positions counts. Below `least_amplitude`, the error bar is
        at least the difference from the conicity there.
        """
        near_jump = self.jumps | np.append(self.jumps[1:], False)
        names = ("y", "roll", "jumps", "points", "wheel", "rail", "angle", "radius")
        arrays = {name: getattr(self, name) for name in names}
        resolved = min(max(amplitude, self.least_amplitude), -self.y[0], self.y[-1])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            conicity = self.conicity(amplitude)
            errors = [abs(self.conicity(resolved) - conicity)]
            for first in (0, 1):
                retained = near_jump | (np.arange(self.y.size) % 2 == first)
                retained[[0, -1]] = True
                fewer = {k: a[..., retained] if a.ndim < 3 else a[:, retained]
                         for k, a in arrays.items()}  # fmt: skip
                errors.append(abs(replace(self, **fewer).conicity(amplitude) - conicity))
        return max(errors)

    @property
    def least_amplitude(self) -> float:
        """Amplitude with two positions on each side, mm: the conicity below is one of a chord."""
        return 2.0 * float(np.diff(self.y).max())

    def klingel_conicity(self, amplitude: float) -> float:
        """Return the equivalent conicity by integration of Klingel's motion, tan gamma_e.

        A free wheelset follows y'' = -difference / (tape distance x radius); the cone has its
        wavelength at its amplitude, half the distance of the extreme positions (EN 15302). The
        wavelength is a quadrature of the first integral of the motion. Cylinders have 0.

        Parameters
        ----------
        amplitude : float
            Amplitude of the lateral motion, within `y`, mm.

        Raises
        ------
        ValueError
            If the amplitude is not positive or leaves `y`, or there is no such motion, as around
            the middle of hollow wheels.
        """
        self._check_amplitude(amplitude)
        potential = self._potential
        extremes = self._find_extremes(amplitude)
        if extremes is None:
            raise ValueError(
                f"amplitude {amplitude:g} mm: the middle of the motion lies so far from y = 0 that "
                f"it leaves the positions up to {self.y[-1]:g} mm; use a larger reach"
            )
        middle, half = 0.5 * sum(extremes), 0.5 * (extremes[1] - extremes[0])
        angles = np.pi * (np.arange(2000) + 0.5) / 2000 - 0.5 * np.pi  # no end point: 0/0 there
        energy = potential(extremes[0]) - potential(middle + half * np.sin(angles))
        largest_of_cone = 1e-7 * half**2 / (self.tape_distance * self.nominal_radius)
        if np.abs(energy).max() <= largest_of_cone:  # cones of 1e-7 count as cylinders
            return 0.0
        if not (energy > 0.0).all():
            raise ValueError(
                f"amplitude {amplitude:g} mm: Klingel's motion is not defined, as the rolling "
                "radius difference drives the wheelset away from the middle (hollow wheels); use "
                "another amplitude, or the harmonic conicity"
            )
        wavelength = 2.0 * np.pi * float((half * np.cos(angles) / np.sqrt(2.0 * energy)).mean())
        return self.tape_distance * self.nominal_radius / 2.0 * (2.0 * np.pi / wavelength) ** 2

    def check_conicity(
        self,
        title: str,
        label: str,
        amplitudes: Sequence[float] | Array,
        reference: Sequence[float] | Array,
        tolerance: Sequence[float] | Array,
        step: float = 0.1,
    ) -> ConicityCheck:
        """Return conicities by Klingel's motion beside reference values.

        Parameters
        ----------
        title, label : str
            See `ConicityCheck`.
        amplitudes, reference, tolerance : sequence of float, shape (n,)
            Amplitudes, mm, with reference values of tan gamma_e and their tolerances. Amplitudes
            of motions that leave the positions are left out.
        step : float
            Spacing of the positions of the reference, mm. It locates a jump of the contact to one
            step only, and interpolates over this step.

        Examples
        --------
        >>> locus = ts.contact_locus(ts.Scene.builtin("wheel-rail"), [-2.0, -1.0, 0.0, 1.0, 2.0])
        >>> locus.check_conicity("S1002", "free roll", [2.0], [0.23], [0.05]).agrees
        array([ True])
        """
        rows, reasons = [], []
        for row in zip(amplitudes, reference, tolerance, strict=True):
            amplitude, value, allowed = map(float, row)
            if amplitude > min(-self.y[0], self.y[-1]) or self._find_extremes(amplitude) is None:
                continue
            conicity = np.nan
            with suppress(ValueError):
                conicity = self.klingel_conicity(amplitude)
            agrees = abs(conicity - value) <= allowed
            reasons.append("" if agrees else self._find_jump(amplitude, value, allowed, step))
            rows.append((amplitude, value, allowed, conicity))
        given, values, allowances, conicities = np.array(rows).reshape(-1, 4).T
        found = given, values, allowances, conicities, tuple(reasons)
        return ConicityCheck(title, label, *found)

    def _find_jump(self, amplitude: float, value: float, tolerance: float, step: float) -> str:
        """Describe a jump of the contact within two steps of an extreme position, if there is one.

        The conicity must also have the value, within its tolerance, at an amplitude within a step.
        """
        ends, jumps = np.array(self.extremes(amplitude)), self.y[self.jumps]
        distance = np.abs(jumps[:, None] - ends).min(axis=1, initial=np.inf)
        if not (distance <= 2.0 * step).any():
            return ""
        for shift in sorted(step * np.linspace(-1.0, 1.0, 21), key=abs):
            with suppress(ValueError):
                if abs(self.klingel_conicity(amplitude + shift) - value) <= tolerance:
                    jump = abs(jumps[np.argmin(distance)])
                    return (
                        f"the contact jumps at |y| = {jump:.3f} mm, and positions of the reference "
                        f"{step:g} mm apart do not resolve this: the conicity agrees at an "
                        f"amplitude of {amplitude + shift:.2f} mm"
                    )
        return ""

    @property
    def _potential(self) -> "scipy.interpolate.PPoly":
        """Potential energy of the lateral motion (Klingel), a function of the position."""
        values = self.radius_difference / (self.tape_distance * self.nominal_radius)
        return scipy.interpolate.make_interp_spline(self.y, values, k=1).antiderivative()

    def extremes(self, amplitude: float) -> tuple[float, float]:
        """Return (lowest, highest) y of a free motion, mm; ±amplitude if none is found."""
        return self._find_extremes(amplitude) or (-amplitude, amplitude)

    def _find_extremes(self, amplitude: float) -> tuple[float, float] | None:
        """Return (lowest, highest) y of a free motion, mm; None if it leaves the positions."""
        potential = self._potential

        def excess(middle: float) -> float:
            return float(potential(middle + amplitude) - potential(middle - amplitude))

        asymmetry, largest = abs(excess(0.0)), np.ptp(potential(self.y))
        if asymmetry <= 1e-12 * largest:  # rounding
            return -amplitude, amplitude
        room = max(min(self.y[-1], -self.y[0]) - amplitude, 0.0)
        middles = np.linspace(-room, room, 400)
        above = potential(middles + amplitude) > potential(middles - amplitude)
        changes = np.flatnonzero(above[1:] != above[:-1])
        if not changes.size:
            return (-amplitude, amplitude) if asymmetry <= 1e-6 * largest else None
        # Hollow wheels have several such motions; the one nearest to y = 0 is meant.
        k = changes[np.argmin(np.abs(middles[changes] + middles[changes + 1]))]
        middle = float(scipy.optimize.brentq(excess, middles[k], middles[k + 1], xtol=1e-12))
        return middle - amplitude, middle + amplitude

    def _check_amplitude(self, amplitude: float) -> None:
        """Raise a ValueError unless an amplitude, mm, is positive and within the positions."""
        largest = min(-self.y[0], self.y[-1])
        if not 0.0 < amplitude <= largest:
            raise ValueError(
                f"amplitude {amplitude:g} mm; allowed: above 0 and up to {largest:g}, the "
                "positions of the locus on both sides"
            )
        if amplitude < self.least_amplitude:
            least = f"below {self.least_amplitude:.3g} mm, twice the spacing of the positions"
            text = f"amplitude {amplitude:g} mm: not resolved {least}; compute more positions"
            warnings.warn(text, stacklevel=3)

    def columns(self) -> dict[str, Array]:
        """Return the locus as table columns by name: lengths in mm, roll mrad, angles degrees."""
        sides: dict[str, Array] = {}
        for k, side in enumerate(("right", "left")):
            sides |= {
                f"contact_y_{side}": self.points[k, :, 1],
                f"wheel_y_{side}": self.wheel[k, :, 0],
                f"contact_angle_{side}": np.degrees(self.angle[k]),
                f"rolling_radius_{side}": self.radius[k],
            }
        columns = {"y": self.y, "roll": 1e3 * self.roll, **sides}
        return {**columns, "radius_difference": self.radius_difference, "jump": self.jumps * 1.0}


def find_locus(
    wheel: Wheel, rail: Profile, positions: Sequence[float], roll: float | None = None
) -> ContactLocus:
    """Return the contact points, roll and radii of a wheelset at sorted lateral positions.

    Parameters
    ----------
    wheel : Wheel
        The right wheel; its y and its roll are not used.
    rail : Profile
        The right rail, in the track frame.
    positions : sequence of float
        Lateral positions of the wheelset, mm; they are sorted. If a contact jumps between two of
        them, the positions next to the jump are added.
    roll : float, optional
        Roll, rad; by default both wheels rest on the rails.

    Raises
    ------
    NoContactError
        See `find_contact_points`.
    """
    touched: dict[float, _Touch] = {}
    angle = wheel.roll
    for y in sorted(map(float, positions)):
        touched[y] = angle, _ = _touch(replace(wheel, y=y, roll=angle), rail, roll)
    beyond_jumps: list[float] = []
    for left, right in pairwise(list(touched)):
        ends = {y: touched[y] for y in (left, right)}
        if _movement(ends) > 4.0 * (right - left) + 1.0:
            ends = _locate_jump(replace(wheel, roll=touched[right][0]), rail, roll, ends)
            touched |= ends
            beyond_jumps += [*ends][1:]
    places = np.array(sorted(touched))
    rolls, pairs = zip(*(touched[y] for y in places), strict=True)
    sides = [[pair[k] for pair in pairs] for k in (0, 1)]
    wheel_s = np.array([[contact.s[0] for contact in side] for side in sides])
    rail_s = np.array([[contact.rail_s[0] for contact in side] for side in sides])
    at_wheel = wheel.profile.at(wheel_s)
    return ContactLocus(
        places,
        np.array(rolls),
        np.array([[contact.points[0] for contact in side] for side in sides]),
        at_wheel,
        rail.at(rail_s),
        np.array([[contact.angles[0, 0] for contact in side] for side in sides]),
        wheel.radius + at_wheel[..., 1],
        np.isin(places, beyond_jumps),
        wheel.radius,
        2.0 * wheel.datum,
    )


_Touch: TypeAlias = tuple[float, list[Clearance]]
"""Roll, rad, and contacts of the right and the left wheel."""


def _touch(placed: Wheel, rail: Profile, roll: float | None) -> _Touch:
    """Return (roll, rad, contacts of [right, left] wheel); roll = None frees the wheelset."""
    placed = replace(placed, roll=free_roll(placed, rail) if roll is None else roll)
    return placed.roll, [find_contact_points(side, rail) for side in (placed, placed.mirrored())]


def _movement(ends: Mapping[float, _Touch]) -> float:
    """Return the larger movement along both wheels, mm, between two positions."""
    (_, before), (_, after) = ends.values()
    return max(abs(b.s[0] - a.s[0]) for a, b in zip(before, after, strict=True))


def _locate_jump(
    wheel: Wheel,
    rail: Profile,
    roll: float | None,
    ends: Mapping[float, _Touch],
    halvings: int = 12,
) -> dict[float, _Touch]:
    """Return the positions next to a jump, by bisection; none if the contact moves continuously.

    The half with the larger movement is retained. At a jump, the movement stays; otherwise it falls
    with the interval.

    Parameters
    ----------
    wheel : Wheel
        The right wheel.
    rail : Profile
        The right rail, in the track frame.
    roll : float, optional
        Roll, rad; by default both wheels rest on the rails.
    ends : mapping of float to (float, list of Clearance)
        Both positions, mm, with roll and contacts.
    halvings : int
        Number of halvings.
    """
    first = _movement(ends)
    for _ in range(halvings):
        (left, before), (right, after) = ends.items()
        y = 0.5 * (left + right)
        middle = _touch(replace(wheel, y=y), rail, roll)
        ends = max({left: before, y: middle}, {y: middle, right: after}, key=_movement)
    return dict(ends) if _movement(ends) > 0.5 * first else {}
