"""Wheel and rail: what CONTACT prints for the Manchester benchmark, and conicities of EN 15302.

Case A2.2 of Shackleton & Iwnicki 2008 (Vehicle System Dynamics 46, 129-149): S1002 on UIC 60,
10 kN, G = 82 GPa, nu = 0.28, mu = 0.3, elements of 0.2 mm and slip of first order. The printed
creepages are relative to the contact point of CONTACT, with the opposite sign.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from importlib.resources import files
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

import tractive_sam as ts
from tractive_sam.contact import Model, equilibrium, share_load, solve_patches_on_fitted_mesh
from tractive_sam.rail import (
    ConicityCheck,
    ContactLocus,
    Patch,
    Profile,
    Wheel,
    find_locus,
    from_measurement,
)
from tractive_sam.validation.closed_forms import STEEL
from tractive_sam.validation.comparison import Comparison, PublishedSet, compare

Array = NDArray[np.float64]

TABLES: dict[str, Any] = {
    "body": {"A": STEEL, "B": STEEL},
    "wheel": {"profile": "S1002", "radius": 460.0},
    "rail": {"profile": "UIC60-manchester"},
    "friction": {"mu": 0.3},
}


@dataclass(frozen=True)
class Position:
    """A position of the wheelset (mm, mrad) and the values that CONTACT prints for it.

    `point` and `angle` are x and y (mm) and angle (rad) of the contact plane, `creepages` the
    longitudinal and lateral creepage and the spin (1/mm), `forces` are P, p_max, the approach and
    the magnitudes of Q_x and Q_y. A right wheel counts as the mirror of a left one. `planes` are
    "separate" for each patch, "common" for the printed plane, or "coupled" for a single patch in
    the printed plane, in which the pressure at each point deforms the other points.
    """

    side: str
    y: float
    yaw: float
    roll: float
    point: tuple[float, float]
    angle: float
    creepages: tuple[float, float, float]
    forces: tuple[float, float, float, float, float]
    planes: str = "separate"

    @property
    def wheelset(self) -> dict[str, Any]:
        """The [wheelset] table."""
        place = {"y": self.y, "yaw": self.yaw, "roll": self.roll}
        return {"side": self.side, **place, "load": 1e4}

    def creepages_at(self, patch: Patch, ahead: float) -> tuple[float, float, float]:
        """Return the printed creepages at the origin of a patch, in the signs of this package.

        Parameters
        ----------
        patch : Patch
            The patch.
        ahead : float
            Distance along x from the centre of an element to the point at which CONTACT takes the
            spin, mm.
        """
        longitudinal, lateral, spin = self.creepages
        sign = 1.0 if self.side == "left" else -1.0
        along = patch.origin[0] - self.point[0] + ahead
        across = (patch.origin[1] - self.point[1]) / math.cos(patch.angle)
        spin *= sign
        return -longitudinal - spin * across, sign * lateral + spin * along, spin

    def in_printed_plane(self, patch: Patch) -> Patch:
        """Return a patch in the plane that CONTACT prints."""
        x, y = self.point
        assert isinstance(patch.rail, Profile)
        z = float(patch.rail.height(np.array([y]))[0])
        limits = tuple(
            (patch.origin[1] - y + limit * math.cos(patch.angle)) / math.cos(self.angle)
            for limit in patch.limits
        )
        return replace(patch, origin=np.array([x, y, z]), angle=self.angle, limits=limits)


POSITIONS = (
    Position("right", 0.0, 0.0, 0.0, (0.0, 751.8726), -0.0290, (-5.665e-5, 0.0, 6.302e-5),
             (9997, 338.3, 0.01596, 0.28, 253.6)),
    Position("left", 1.5, 3.6, -0.08103, (2.7017, 755.9669), -0.0152,
             (-7.53e-4, 3.599e-3, -3.33e-5), (10050, 446.5, 0.02007, 641.1, 2942)),
    Position("left", 4.5, 10.8, -0.2977, (8.1878, 757.799), -0.0091,
             (-1.591e-3, 1.079e-2, -2.049e-5), (10030, 540.2, 0.02209, 440.6, 2976)),
    Position("right", 5.0, 12.0, -0.3554, (-6.9999, 727.0855), -0.2905,
             (4.174e-3, 1.255e-2, 6.188e-4), (9619, 1556, 0.02719, 763.3, 2738), "common"),
    Position("right", 5.5, 13.2, -0.4777, (-7.3700, 726.1169), -0.3363,
             (4.379e-3, 1.401e-2, 7.122e-4), (9629, 1486, 0.02926, 850.2, 2759)),
    Position("right", 6.0, 14.4, -0.6272, (-7.3822, 725.1371), -0.4176,
             (5.077e-3, 1.580e-2, 8.744e-4), (9709, 1149, 0.02728, 880, 2775)),
    Position("right", 6.5, 15.6, -4.376, (5.8010, 718.4931), -1.1591,
             (1.828e-2, 3.905e-2, 1.937e-3), (15440, 2603, 0.03623, 1987, 4170)),
    Position("right", 8.0, 19.2, -8.606, (-0.9036, 719.8316), -0.9501,
             (2.127e-2, 3.300e-2, 1.701e-3), (12720, 2634, 0.03494, 2070, 3195)),
    Position("right", 10.0, 24.0, -11.26431, (-5.2821, 721.0880), -0.7992,
             (2.378e-2, 3.445e-2, 1.486e-3), (11440, 2643, 0.03411, 1947, 2820)),
)  # fmt: skip


def _patches_of(scene: ts.Scene) -> tuple[Patch, ...]:
    """Return the patches of a scene with a wheel and a rail."""
    assert scene.wheel_rail is not None
    return scene.wheel_rail.patches


def model_of_position(
    position: Position, element: float = 0.2, slip: str = "upwind", ahead: float = 1.0 / 6.0
) -> Model:
    """Return the model of a position with its printed creepages.

    With several patches in separate planes, the longitudinal creepage belongs to the first one and
    determines the angular velocity of the wheel; other creepages follow from the motion.

    Parameters
    ----------
    position : Position
        The position.
    element : float
        Size of the elements, mm.
    slip : str
        Scheme of the slip, as `solver.slip`.
    ahead : float
        Distance ahead of the centre of an element at which the spin is taken, in elements: 1/6 in
        CONTACT (its input FACPHI), 0 in this package.
    """
    wheelset, motion = position.wheelset, dict[str, Any]()
    own = _patches_of(ts.Scene(**TABLES, wheelset=wheelset))
    half = np.max([patch.half_length for patch in own], axis=0)
    patches, separate = own, len(own) > 1 and position.planes == "separate"
    if position.planes != "separate":
        patches = tuple(position.in_printed_plane(patch) for patch in own)
        ends = [abs(patch.origin[1] - position.point[1]) + patch.half_length[1] for patch in own]
        half[1] = max(ends)
    if position.planes == "coupled":
        patches = (replace(patches[0], limits=(-np.inf, np.inf)),)
    creepage = position.creepages_at(patches[0], ahead * element)
    if separate:
        slow, fast = (own[0].creepages(pitch)[0] for pitch in (0.0, 1e-3))  # linear in the pitch
        wheelset["pitch"] = 1e-3 * (creepage[0] - slow) / (fast - slow)
    else:
        motion["creepage"] = dict(zip(("longitudinal", "lateral", "spin"), creepage, strict=True))
    elements = [2 * round(1.2 * length / element) + 1 for length in half]
    grid = {"half_length": [0.5 * element * n for n in elements], "elements": elements}
    scene = ts.Scene(**TABLES, wheelset=wheelset, grid=grid, solver={"slip": slip}, **motion)
    assert scene.wheel_rail is not None
    return Model(scene, wheel_rail=replace(scene.wheel_rail, patches=patches))


# Position y = 5 mm with separate patches (the example mbench_a22_varfric of CONTACT): friction
# coefficient; P, p_max, approach, |Q_x|, |Q_y|. VPITCH is -4.3353637 at 2 m/s.
PATCHES = (
    (0.2323, (8244, 1579, 0.02714, 637.2, 1805)),
    (0.2581, (1536, 305.1, 0.006464, 0.28, 396.3)),
)


def solve_two_patches(element: float = 0.2) -> list[tuple[Patch, ts.State]]:
    """Return two patches of one wheel with their contacts, which share its depth and its load."""
    place = {"y": 5.0, "yaw": 12.0, "roll": -0.3554, "pitch": 4.3353637 * 0.46 / 2.0 - 1.0}
    tables = {**TABLES, "wheelset": {**place, "load": 1e4}, "solver": {"slip": "upwind"}}
    half = np.max([patch.half_length for patch in _patches_of(ts.Scene(**tables))], axis=0)
    elements = [2 * round(1.2 * length / element) + 1 for length in half]
    grid = {"half_length": [0.5 * element * n for n in elements], "elements": elements}
    scene = ts.Scene(**tables, grid=grid)
    models = {
        id(patch): Model(scene.replace(**{"friction.mu": mu}))
        for patch, (mu, _) in zip(_patches_of(scene), PATCHES, strict=True)
    }

    def solve(model: Model, start: ts.State | None) -> ts.State:
        assert model.patch is not None
        local = models[id(model.patch)].of_patch(model.patch, model.wheel_depth)
        return equilibrium(local, start=start, check_resolution=False)

    return list(zip(_patches_of(scene), share_load(Model(scene), solve), strict=True))


NAMES = ("P", "p_max", "approach", "Qx", "Qy")


def _compare_with_printed(
    computed: dict[str, float], printed: tuple[float, ...]
) -> Iterator[Comparison]:
    """Yield comparisons with values of four printed digits."""
    units = ("N", "MPa", "mm", "N", "N")
    for name, unit, value in zip(NAMES, units, printed, strict=True):
        # Creepage forces are uncertain by a share of the friction force.
        scale = TABLES["friction"]["mu"] * computed["P"] if name in ("Qx", "Qy") else 0.0
        text = f"{value:#.4g}"
        yield compare(f"|{name}|, {unit}", text, abs(computed[name]), 1e-2, scale)


def position_as_printed(position: Position) -> Iterator[Comparison]:
    """Yield the forces of all patches of a position, with pressure and approach of the largest."""
    _, contacts = solve_patches_on_fitted_mesh(model_of_position(position))
    first = max(contacts, key=lambda contact: contact.P)
    computed = {
        "P": sum(contact.P for contact in contacts),
        "p_max": max(contact.p_max for contact in contacts),
        "approach": first.approach,
        "Qx": sum(contact.Qx for contact in contacts),
        "Qy": sum(contact.Qy for contact in contacts),
    }
    return _compare_with_printed(computed, position.forces)


def patches_as_printed(number: int) -> Iterator[Comparison]:
    """Yield a patch of the position y = 5 mm with separate planes."""
    _, contact = solve_two_patches()[number]
    computed = {name: float(getattr(contact, name)) for name in NAMES}
    return _compare_with_printed(computed, PATCHES[number][1])


@dataclass(frozen=True)
class ConicityCase:
    """A reference case of EN 15302, Annex E: two wheels R-UIC 519 on rails S-UIC 519-A.

    The wheels are 1360 mm apart, back to back, and have 920 mm at the tape line. The wheelset does
    not roll: each rail carries its wheel at the same height.

    Attributes
    ----------
    number : int
        Number of the case.
    wheels : str
        Letters of the right and of the left wheel.
    smaller : float
        Radius by which the left wheel is smaller, mm.
    """

    number: int
    wheels: str
    smaller: float = 0.0

    @property
    def title(self) -> str:
        """Number of the case, profiles and diameters of the right and the left wheel."""
        return f"E{self.number}: {'/'.join(self.wheels)}, 920/{920.0 - 2.0 * self.smaller:g} mm"

    @property
    def locus_of_differences(self) -> ContactLocus:
        """The locus with the rolling radius differences of the standard, in steps of 0.1 mm."""
        difference = 1e-3 * _read_standard()[self.wheels]
        reach = 0.1 * (difference.size // 2)
        y = np.linspace(-reach, reach, difference.size)
        return self._locus(y, 460.0 + 0.5 * difference, 460.0 - 0.5 * difference)

    @property
    def locus_of_profiles(self) -> ContactLocus:
        """The locus with the rolling radii of both wheels on the rail."""
        # The left wheel is the mirror of a right one.
        (y, right), (mirrored, left) = map(_find_rolling_radii, self.wheels)
        both = np.union1d(y, mirrored)
        return self._locus(both, np.interp(both, y, right), np.interp(-both, mirrored, left))

    def _locus(self, y: Array, right: Array, left: Array) -> ContactLocus:
        """Return the locus with rolling radii of equal wheels; it has no contact points."""
        points, pairs, none = np.zeros((2, y.size, 3)), np.zeros((2, y.size, 2)), np.zeros(y.size)
        return ContactLocus(
            y=y,
            roll=none,
            points=points,
            wheel=pairs,
            rail=pairs,
            angle=pairs[..., 0],
            radius=np.array([right, left - self.smaller]),
            jumps=np.diff(y, prepend=-np.inf) < 1e-4,  # 24 um times 1/1000 apart
            nominal_radius=460.0,
            tape_distance=1500.0,
        )

    def check(self, from_profiles: bool = True, every: int = 1) -> ConicityCheck:
        """Return conicities beside those of the standard, at every n-th amplitude from 1 to 7.5 mm.

        The tolerance is the smaller one of 0.05 and half the value (Annex F).
        """
        reference = 1e-3 * _read_standard()["conicities"][self.number - 1][::every]
        amplitudes = np.arange(10, 76, every) / 10.0
        locus = self.locus_of_profiles if from_profiles else self.locus_of_differences
        label = "from profiles" if from_profiles else "from differences"
        tolerance = np.minimum(0.05, 0.5 * reference)
        return locus.check_conicity(self.title, label, amplitudes, reference, tolerance)

    def compare(self, from_profiles: bool) -> Iterator[Comparison]:
        """Yield the values of `check` at whole and half mm.

        From the radius differences, 0.1 % of the value and the digits count as the tolerance.
        """
        check = self.check(from_profiles, every=5)
        columns = (check.amplitude, check.reference, check.tolerance, check.conicity, check.reasons)
        for amplitude, value, tolerance, conicity, reason in zip(*columns, strict=True):
            allowed = tolerance if from_profiles else 1e-3 * value + 5.001e-4
            name = f"tan gamma_e, amplitude {amplitude:g} mm"
            yield Comparison(name, f"{value:.3f}", float(conicity), allowed, value, reason)


CONICITY_CASES = (
    *(ConicityCase(k, 2 * letter) for k, letter in enumerate("ABHI", 1)),
    *(ConicityCase(k, 2 * letter, 1.0) for k, letter in enumerate("ABHI", 5)),
    ConicityCase(9, "AB"),
)


@cache
def _read_standard() -> Mapping[str, Array]:
    """Read profiles, radius differences and conicities of EN 15302, with their `source`.

    `A`, `B`, `H`, `I` are heights of the wheels in steps of 0.135 mm from -70 mm, and `rail` of the
    rail in steps of 0.0715 mm from -32.5 mm, in nm, upwards. The differences by pairs of wheels, in
    um, are in steps of 0.1 mm around 0, and the conicities of E1 to E9, in thousandths, in steps of
    0.1 mm from 1 mm. The differences of E5 to E8 are those of E1 to E4 and 1 mm.
    """
    with (files(__package__) / "en15302.npz").open("rb") as file, np.load(file) as arrays:
        return dict(arrays)


def find_standard_locus(
    letter: str, positions: Sequence[float], roll: float | None = 0.0
) -> ContactLocus:
    """Return the locus of equal wheels of EN 15302, whose profiles are 750 mm from the middle.

    Parameters
    ----------
    letter : str
        Letter of the wheels: A, B, H or I.
    positions : sequence of float
        Lateral positions of the wheelset, mm.
    roll : float, optional
        Roll, rad; None lets both wheels rest on the rails.
    """
    arrays = _read_standard()
    kinds: tuple[tuple[Literal["wheel", "rail"], str, float, float], ...]
    kinds = (("wheel", letter, -70.0, 0.135), ("rail", "rail", -32.5, 0.0715))
    profiles = []
    for kind, name, first, spacing in kinds:
        y = first + spacing * np.arange(arrays[name].size)
        points = np.stack((y, 1e-6 * arrays[name]), axis=1)
        profiles.append(from_measurement(points, kind, smoothing=0.0))
    wheel = Wheel(profiles[0], radius=460.0, inner=1360.0)
    return find_locus(wheel, profiles[1].moved(0.0, (750.0, 0.0)), positions, roll)


@cache
def _find_rolling_radii(letter: str) -> tuple[Array, Array]:
    """Return positions and rolling radii, mm, of the right wheel with a profile of EN 15302."""
    locus = find_standard_locus(letter, [0.15 * k for k in range(-60, 61)])
    return locus.y, locus.radius[0]


def check_locus(standard: str = "EN15302") -> list[ConicityCheck]:
    """Compute the reference cases of a standard, from its profiles and from its radius differences.

    Parameters
    ----------
    standard : str
        Name of the standard: EN15302, the edition 2008+A1:2010 with nine cases.

    Raises
    ------
    ValueError
        If the standard is not known.

    Examples
    --------
    >>> from tractive_sam.validation import check_locus
    >>> any(check.differs.any() for check in check_locus("EN15302"))
    False
    """
    if standard.replace(" ", "").upper() != "EN15302":
        raise ValueError(f"standard {standard!r}; allowed: EN15302")
    return [case.check(kind) for kind in (True, False) for case in CONICITY_CASES]


CHOICES = "1 %: CONTACT samples the profiles in steps of an element"

SETS = (
    *(
        PublishedSet(
            f"S1002 on UIC 60, wheelset at y = {position.y:g} mm, {position.side} wheel",
            "Shackleton and Iwnicki 2008, case A2.2; printed by CONTACT",
            partial(position_as_printed, position),
            CHOICES,
            quick=position.y in (1.5, 6.0),
        )
        for position in POSITIONS
    ),
    *(
        PublishedSet(
            f"S1002 on UIC 60 at y = 5 mm with separate planes, {name}",
            "CONTACT, example mbench_a22_varfric",
            partial(patches_as_printed, number),
            CHOICES,
            quick=False,
        )
        for number, name in enumerate(("flange root", "tread"))
    ),
    *(
        PublishedSet(
            f"Conicity of {case.title}, from the {'profiles' if kind else 'radius differences'}",
            "EN 15302:2008+A1:2010, Annexes D, E and F",
            partial(case.compare, kind),
            "the tolerance of the standard, 0.05 or half the value"
            if kind
            else "0.1 %: differences in micrometres, in steps of 0.1 mm",
            quick=not kind,
        )
        for kind in (True, False)
        for case in CONICITY_CASES
    ),
)
