"""Wheel and rail: positions of the Manchester benchmark, and CPU time of positions and wear.

The results that CONTACT prints for case A2.2 (Shackleton & Iwnicki 2008, Vehicle System Dynamics
46, 129-149) belong to S1002 on UIC 60, 10 kN, G = 82 GPa, nu = 0.28, mu = 0.3, elements of 0.2 mm
and slip of first order. Its creepages are relative to its contact point, with the opposite sign.

Page: docs/theory/wheel-rail.md
"""

import math
import warnings
from dataclasses import dataclass, replace
from time import process_time

import numpy as np
from timing import show, write

import tractive_sam as ts
from tractive_sam.contact import Model, equilibrium, solve_patches_on_fitted_mesh
from tractive_sam.contact.wheel_rail import share_load
from tractive_sam.rail import Patch

STEEL = {"shear": 82e3, "poisson": 0.28}
TABLES = {
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
    the printed plane, in which the pressure at each point deforms the other points. "weighted" is
    such a patch with the influence that CONTACT gives its two parts on each other.
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
    def wheelset(self) -> dict[str, object]:
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
             (4.174e-3, 1.255e-2, 6.188e-4), (9619, 1556, 0.02719, 763.3, 2738)),
    Position("right", 5.0, 12.0, -0.3554, (-6.9999, 727.0855), -0.2905,
             (4.174e-3, 1.255e-2, 6.188e-4), (9619, 1556, 0.02719, 763.3, 2738), "common"),
    Position("right", 5.0, 12.0, -0.3554, (-6.9999, 727.0855), -0.2905,
             (4.174e-3, 1.255e-2, 6.188e-4), (9619, 1556, 0.02719, 763.3, 2738), "coupled"),
    Position("right", 5.0, 12.0, -0.3554, (-6.9999, 727.0855), -0.2905,
             (4.174e-3, 1.255e-2, 6.188e-4), (9619, 1556, 0.02719, 763.3, 2738), "weighted"),
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
    wheelset, motion = position.wheelset, {}
    own = ts.Scene(**TABLES, wheelset=wheelset).wheel_rail.patches
    half = np.max([patch.half_length for patch in own], axis=0)
    patches, separate = own, len(own) > 1 and position.planes == "separate"
    if position.planes != "separate":
        patches = tuple(position.in_printed_plane(patch) for patch in own)
        ends = [abs(patch.origin[1] - position.point[1]) + patch.half_length[1] for patch in own]
        half[1] = max(ends)
    if position.planes in ("coupled", "weighted"):
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
    return Model(scene, wheel_rail=replace(scene.wheel_rail, patches=patches))


@dataclass(frozen=True)
class WeightedInfluence:
    """Influence of the pressure of two patches in one plane on each other, as CONTACT weights it.

    CONTACT multiplies the normal displacement that the pressure in one patch causes in another by
    ((8 mm - d) / (8 mm - 4 mm))^0.8, but not the tangential displacement. d is the distance of the
    boxes around the areas in which the undeformed bodies overlap. The lengths are its inputs D_SEP
    and D_COMB (routines combine_cpatches and normcg_matvec of its source, github.com/eve70a).

    Attributes
    ----------
    limit : float
        Lateral position between the patches, mm.
    """

    limit: float

    def weight(self, model: Model) -> float:
        """Return the factor at the depth of a model's wheel; 1 for a single patch."""
        half_x, half_y = model.grid.half_length
        x, y = np.linspace(-half_x, half_x, 201), np.linspace(-half_y, half_y, 801)
        overlap = model.patch.lowered(model.wheel_depth).gap(x, y) < 0.0
        parts = [np.argwhere(overlap & side) for side in (y < self.limit, y > self.limit)]
        if not all(part.size for part in parts):
            return 1.0
        boxes = [(part.min(axis=0), part.max(axis=0)) for part in parts]
        (first, last), (second, end) = boxes
        apart = np.maximum(0, np.maximum(first - end, second - last)) * (x[1] - x[0], y[1] - y[0])
        return min(1.0, max(0.0, (8.0 - math.hypot(*apart)) / (8.0 - 4.0)) ** 0.8)

    def solve(self, model: Model, start: ts.State | None) -> ts.State:
        """Return the contact: the gap is corrected for the missing part of the influence."""
        missing = 1.0 - self.weight(model)
        sides = [(model.grid.y > self.limit) == upper for upper in (False, True)]
        correction = np.zeros(model.grid.elements)
        for _ in range(20):
            start = equilibrium(model, correction, start, check_resolution=False)
            previous, correction = correction, np.zeros(model.grid.elements)
            for side in sides:
                pressure = np.where(side, start.pressure, 0.0) / model.units.pressure
                displacement = model.operators.normal(pressure[None])[0] * model.units.gap
                correction -= np.where(side, 0.0, missing * displacement)
            if np.abs(correction - previous).max() < 1e-6 * start.approach:
                break
        return start


def solve_contacts(position: Position, element: float = 0.2) -> tuple[Model, tuple[ts.State, ...]]:
    """Return the model of a position and the contacts in its patches."""
    model = model_of_position(position, element)
    if position.planes != "weighted":
        return solve_patches_on_fitted_mesh(model)
    parts = model_of_position(replace(position, planes="common")).wheel_rail.patches
    limit = max(y for part in parts for y in part.limits if np.isfinite(y))
    influence = WeightedInfluence(limit)
    return model, share_load(model, influence.solve)


def solve_position(position: Position) -> dict[str, object]:
    """Return one position: computed and printed forces of all patches, and the largest pressure.

    The largest pressure is computed with elements of 0.1 mm as well.
    """
    model, contacts = solve_contacts(position)
    values = {"y": position.y, "planes": position.planes}
    first = max(range(len(contacts)), key=lambda k: contacts[k].P)
    angle = math.degrees(model.wheel_rail.patches[first].angle)
    values |= {"angle": angle, "patches": sum(bool(contact.touching.any()) for contact in contacts)}
    computed = {
        "P": sum(contact.P for contact in contacts),
        "p_max": max(contact.p_max for contact in contacts),
        "approach": contacts[first].approach,
        "Qx": sum(contact.Qx for contact in contacts),
        "Qy": sum(contact.Qy for contact in contacts),
    }
    for (name, value), printed in zip(computed.items(), position.forces, strict=True):
        values |= {name: abs(float(value)), f"{name} printed": printed}
    _, finer = solve_contacts(position, 0.1)
    return values | {"p_max fine": max(contact.p_max for contact in finer)}


# Position y = 5 mm with separate patches (the example mbench_a22_varfric of CONTACT): friction
# coefficient; P, p_max, approach, |Q_x|, |Q_y|. VPITCH is -4.3353637 at 2 m/s.
PATCHES = (
    (0.2323, (8244, 1579, 0.02714, 637.2, 1805)),
    (0.2581, (1536, 305.1, 0.006464, 0.28, 396.3)),
)


def solve_two_patches(element: float = 0.2) -> list[dict[str, object]]:
    """Return two patches of one wheel, which share its depth and its load, with printed values."""
    place = {"y": 5.0, "yaw": 12.0, "roll": -0.3554, "pitch": 4.3353637 * 0.46 / 2.0 - 1.0}
    tables = {**TABLES, "wheelset": {**place, "load": 1e4}, "solver": {"slip": "upwind"}}
    half = np.max([patch.half_length for patch in ts.Scene(**tables).wheel_rail.patches], axis=0)
    elements = [2 * round(1.2 * length / element) + 1 for length in half]
    grid = {"half_length": [0.5 * element * n for n in elements], "elements": elements}
    scene = ts.Scene(**tables, grid=grid)
    patches = scene.wheel_rail.patches
    models = {
        id(patch): Model(scene.replace(**{"friction.mu": mu}))
        for patch, (mu, _) in zip(patches, PATCHES, strict=True)
    }

    def solve(model: Model, start: ts.State | None) -> ts.State:
        local = models[id(model.patch)].of_patch(model.patch, model.wheel_depth)
        return equilibrium(local, start=start, check_resolution=False)

    rows = []
    contacts = share_load(Model(scene), solve)
    for contact, patch, (mu, printed) in zip(contacts, patches, PATCHES, strict=True):
        row: dict[str, object] = {"angle": math.degrees(patch.angle), "mu": mu}
        names = ("P", "p_max", "approach", "Qx", "Qy")
        for name, known in zip(names, printed, strict=True):
            row |= {name: abs(float(getattr(contact, name))), f"{name} printed": known}
        rows.append(row)
    return rows


def vary_central_position() -> list[dict[str, object]]:
    """Return lateral force and spin moment for different points of the spin, schemes and meshes.

    In the middle position, in the plane of CONTACT and in the one of this package.
    """
    variants = [(True, 0.2, "upwind", 1.0 / 6.0), (True, 0.2, "upwind", 0.0)]
    variants += [(False, e, "upwind", 0.0) for e in (0.4, 0.2, 0.1)]
    variants += [(False, e, "auto", 0.0) for e in (0.4, 0.2, 0.1)]
    rows: list[dict[str, object]] = []
    for printed_plane, element, slip, ahead in variants:
        planes = "common" if printed_plane else "separate"
        position = replace(POSITIONS[0], planes=planes)
        _, (contact,) = solve_patches_on_fitted_mesh(
            model_of_position(position, element, slip, ahead)
        )
        rows.append(
            {
                "plane": "CONTACT" if printed_plane else "tractive_sam",
                "element": element,
                "scheme": "first order" if slip == "upwind" else "second order",
                "ahead": ahead * element,
                "Qy": abs(contact.Qy),
                "Mz": abs(contact.Mz),
            }
        )
    return rows


def measure_times() -> list[dict[str, object]]:
    """Return CPU seconds of a locus, a position and a wear step of one position."""
    scene = ts.Scene.builtin("wheel-wear")
    ts.contact_locus(scene, [0.0, 1.0])
    start = process_time()
    ts.contact_locus(scene, np.linspace(-6.0, 6.0, 21))
    locus = process_time() - start
    start = process_time()
    for y in np.linspace(0.0, 4.0, 20):
        _ = scene.without_blocks.replace(wear=None, **{"wheelset.y": float(y)}).wheel_rail
    position = (process_time() - start) / 20
    ts.roll(scene.with_set(["wear.revolutions=100"]))
    start = process_time()
    history = ts.roll(scene.with_set(["wear.tolerance=0.03"]))
    step = (process_time() - start) / history["solves"].sum()
    return [
        {"work": "locus of 21 positions", "CPU s": locus},
        {"work": "scene of a position", "CPU s": position},
        {"work": "position of a wear step, 25 x 31 elements", "CPU s": step},
    ]


if __name__ == "__main__":
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ts.SceneWarning)
        rows = [solve_position(position) for position in POSITIONS]
        patches = solve_two_patches()
        spins = vary_central_position()
        times = measure_times()
    write("wheel_rail", rows)
    write("wheel_rail_patches", patches)
    write("wheel_rail_spin", spins)
    write("wheel_rail_times", times)
    show("Manchester benchmark, case A2.2", rows)
    show("Two patches", patches)
    show("Central position", spins)
    show("CPU time", times)
