"""Contact locus of a wheelset: contact points, rolling radii and equivalent conicity."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy  # its parts are loaded when first used

from .contact import Clearance, find_contact_points, free_roll
from .profile import Array, Profile
from .wheelset import Wheel


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
        Positions at which the contact of a side is on another part of the profile than before.
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

    def klingel_conicity(self, amplitude: float) -> float:
        """Return the equivalent conicity by integration of Klingel's motion, tan gamma_e.

        A free wheelset follows y'' = -difference / (tape distance x radius); the cone has its
        wavelength at its amplitude, half the distance of the extreme positions (EN 15302). The
        wavelength is a quadrature of the first integral of the motion.

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
        if not (energy > 0.0).all():
            raise ValueError(
                f"amplitude {amplitude:g} mm: Klingel's motion is not defined, as the rolling "
                "radius difference drives the wheelset away from the middle (hollow wheels); use "
                "another amplitude, or the harmonic conicity"
            )
        wavelength = 2.0 * np.pi * float((half * np.cos(angles) / np.sqrt(2.0 * energy)).mean())
        return self.tape_distance * self.nominal_radius / 2.0 * (2.0 * np.pi / wavelength) ** 2

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

        if abs(excess(0.0)) <= 1e-6 * np.ptp(potential(self.y)):  # symmetric, up to rounding
            return -amplitude, amplitude
        room = max(min(self.y[-1], -self.y[0]) - amplitude, 0.0)
        middles = np.linspace(-room, room, 400)
        above = potential(middles + amplitude) > potential(middles - amplitude)
        changes = np.flatnonzero(above[1:] != above[:-1])
        if not changes.size:
            return None
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
        Lateral positions of the wheelset, mm; they are sorted.
    roll : float, optional
        Roll, rad; by default both wheels rest on the rails.

    Raises
    ------
    NoContactError
        See `find_contact_points`.
    """
    places = np.array(sorted(map(float, positions)))
    pairs: list[list[Clearance]] = []
    rolls, angle = [], wheel.roll
    for y in places:
        angle, pair = _touch(replace(wheel, y=float(y), roll=angle), rail, roll)
        rolls.append(angle)
        pairs.append(pair)
    sides = [[pair[k] for pair in pairs] for k in (0, 1)]
    wheel_s = np.array([[contact.s[0] for contact in side] for side in sides])
    rail_s = np.array([[contact.rail_s[0] for contact in side] for side in sides])
    at_wheel = wheel.profile.at(wheel_s)
    moved = np.abs(np.diff(wheel_s, axis=1, prepend=wheel_s[:, :1])).max(axis=0)
    jumps = moved > 4.0 * np.diff(places, prepend=places[:1]) + 1.0
    for k in np.flatnonzero(jumps):
        ends = [(float(places[j]), wheel_s[:, j]) for j in (k - 1, k)]
        jumps[k] = _jumps_between(replace(wheel, roll=rolls[k]), rail, roll, ends)
    return ContactLocus(
        places,
        np.array(rolls),
        np.array([[contact.points[0] for contact in side] for side in sides]),
        at_wheel,
        rail.at(rail_s),
        np.array([[contact.angles[0, 0] for contact in side] for side in sides]),
        wheel.radius + at_wheel[..., 1],
        jumps,
        wheel.radius,
        2.0 * wheel.datum,
    )


def _touch(placed: Wheel, rail: Profile, roll: float | None) -> tuple[float, list[Clearance]]:
    """Return (roll, rad, contacts of [right, left] wheel); roll = None frees the wheelset."""
    placed = replace(placed, roll=free_roll(placed, rail) if roll is None else roll)
    return placed.roll, [find_contact_points(side, rail) for side in (placed, placed.mirrored())]


def _jumps_between(
    wheel: Wheel,
    rail: Profile,
    roll: float | None,
    ends: list[tuple[float, Array]],
    halvings: int = 5,
) -> bool:
    """Return whether the larger movement of a contact persists as the interval is halved.

    Half of the interval is retained, the one with the larger movement. At a jump, the movement
    stays; otherwise it falls with the interval.

    Parameters
    ----------
    wheel : Wheel
        The right wheel.
    rail : Profile
        The right rail, in the track frame.
    roll : float, optional
        Roll, rad; by default both wheels rest on the rails.
    ends : list of (float, ndarray)
        Both positions, mm, with the arc lengths of the contacts of both wheels.
    halvings : int
        Number of halvings.
    """

    def movement(pair: list[tuple[float, Array]]) -> float:
        return float(np.abs(pair[1][1] - pair[0][1]).max())

    first = movement(ends)
    for _ in range(halvings):
        y = 0.5 * (ends[0][0] + ends[1][0])
        _, pair = _touch(replace(wheel, y=y), rail, roll)
        middle = y, np.array([contact.s[0] for contact in pair])
        ends = max([ends[0], middle], [middle, ends[1]], key=movement)
    return movement(ends) > 0.5 * first
