"""Wheel and rail: what CONTACT prints for the Manchester benchmark, and conicities of EN 15302.

Case A2.2 of Shackleton & Iwnicki 2008 (Vehicle System Dynamics 46, 129-149): S1002 on UIC 60,
10 kN, G = 82 GPa, nu = 0.28, mu = 0.3, elements of 0.2 mm and slip of first order. The printed
creepages are relative to the contact point of CONTACT, with the opposite sign.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

import tractive_sam as ts
from tractive_sam.contact import Model, equilibrium, share_load, solve_patches_on_fitted_mesh
from tractive_sam.rail import ContactLocus, Patch, Profile
from tractive_sam.validation.closed_forms import STEEL
from tractive_sam.validation.comparison import Comparison, PublishedSet, compare

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
class ReferenceCase:
    """A symmetric reference case of EN 15302, Annex E: wheels of 920 mm, contacts 1500 mm apart.

    `differences` are rolling radius differences at y = 0.1, 0.2, ... 6.8 mm, in micrometres, and
    `conicities` are tan gamma_e for the amplitudes 1, 2, ... 6 mm.
    """

    title: str
    differences: str
    conicities: tuple[str, ...]

    @property
    def locus(self) -> ContactLocus:
        """The contact locus with these differences; it has no contact points."""
        half = 1e-3 * np.array(self.differences.split(), float)
        difference = np.concatenate((-half[::-1], [0.0], half))
        n = difference.size
        points, pairs, none = np.zeros((2, n, 3)), np.zeros((2, n, 2)), np.zeros((2, n))
        return ContactLocus(
            y=np.linspace(-0.1 * half.size, 0.1 * half.size, n),
            roll=none[0],
            points=points,
            wheel=pairs,
            rail=pairs,
            angle=none,
            radius=460.0 + 0.5 * np.array([difference, -difference]),
            jumps=np.zeros(n, bool),
            nominal_radius=460.0,
            tape_distance=1500.0,
        )


# Typed from the standard in the test data of B_ECC-Equivalent-Conicity-Calculation
# (github.com/criogenox).
REFERENCE_CASES = (
    ReferenceCase(
        "wheel A on rail A",
        "32 51 71 92 116 142 167 197 227 257 292 328 361 402 443 481 527 574 616 667 719 766 822 "
        "879 931 992 1055 1111 1177 1236 1299 1346 1407 1471 1539 1598 1673 1752 1834 1906 1995 "
        "2088 2185 2286 2373 2481 2593 2709 2808 2931 3058 3189 3324 3440 3582 3729 3879 4008 4166 "
        "4328 4494 4636 5064 5692 6521 7597 9010 10954",
        ("0.125", "0.155", "0.188", "0.216", "0.254", "0.303"),
    ),
    ReferenceCase(
        "wheel B on rail A",
        "5 10 15 20 25 30 35 40 45 50 55 60 65 70 75 80 85 90 95 100 105 110 115 120 125 130 135 "
        "140 145 1950 2003 2057 2112 2167 2224 2281 2339 2397 2457 2517 2578 2640 2702 2766 2830 "
        "2895 2961 3027 3095 3163 3232 3302 3372 3444 3516 3589 3663 3737 3813 3889 3966 4044 4123 "
        "5392 6111 7050 8270 9895",
        ("0.025", "0.025", "0.058", "0.241", "0.283", "0.302"),
    ),
)


def conicities_of_the_standard(case: ReferenceCase) -> Iterator[Comparison]:
    """Yield equivalent conicities by Klingel's motion, for amplitudes from 1 mm on."""
    for amplitude, printed in enumerate(case.conicities, 1):
        computed = case.locus.klingel_conicity(amplitude)
        yield compare(f"tan gamma_e, amplitude {amplitude} mm", printed, computed, 1e-3)


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
            f"Equivalent conicity from the rolling radius difference, {case.title}",
            "EN 15302:2008+A1:2010, Annex E",
            partial(conicities_of_the_standard, case),
            "0.1 %: differences in micrometres, in steps of 0.1 mm",
        )
        for case in REFERENCE_CASES
    ),
)
