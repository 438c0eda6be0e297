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
from tractive_sam.contact import Model, equilibrium, share_load, solve_patches_on_fitted_mesh
from tractive_sam.validation.wheel_rail import (
    NAMES,
    PATCHES,
    POSITIONS,
    Position,
    model_of_position,
    solve_two_patches,
)

PLANES = ("separate", "common", "coupled", "weighted")
"""Treatments of a tread and a flange root in contact at once; see `Position` and below."""


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
    if position.planes != "weighted":
        return solve_patches_on_fitted_mesh(model_of_position(position, element))
    model = model_of_position(replace(position, planes="coupled"), element)
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


def compare_two_patches() -> list[dict[str, object]]:
    """Return two patches of one wheel, which share its depth and its load, with printed values."""
    rows = []
    for (patch, contact), (mu, printed) in zip(solve_two_patches(), PATCHES, strict=True):
        row: dict[str, object] = {"angle": math.degrees(patch.angle), "mu": mu}
        for name, known in zip(NAMES, printed, strict=True):
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


def compare_pitches() -> list[dict[str, object]]:
    """Return what a free pitch costs: convolutions with the pitch of rolling, and with a free one.

    A free pitch is solved with both wheels, except in the middle of the track. The prescribed one
    is solved for each of the wheels that the free one needs.
    """
    rows: list[dict[str, object]] = []
    for y, yaw in ((0.0, 0.0), (2.0, 0.0), (-4.0, 3.0), (4.5, 5.0), (-5.3, -2.0)):
        counts = []
        scene = ts.Scene.builtin("wheel-rail").replace(
            **{"grid.elements": (25, 31), "grid.half_length": None},
            **{"wheelset.y": y, "wheelset.yaw": yaw},
        )
        sides = ("right",) if y == yaw == 0.0 else ("right", "left")
        # The left wheel here is at the place of the left wheel of the free axle.
        for pitch, of_pitch in (("rolling-radius", sides), ("free", ("right",))):
            changed = (
                scene.replace(**{"wheelset.pitch": pitch, "wheelset.side": side})
                for side in of_pitch
            )
            counts.append(sum(ts.roll(one)["convolutions"].sum() for one in changed))
        rows.append(
            {"y": y, "yaw": yaw, "wheels": len(sides)}
            | {
                "prescribed": counts[0],
                "free": counts[1],
                "free / prescribed": counts[1] / counts[0],
            }
        )
    return rows


if __name__ == "__main__":
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ts.SceneWarning)
        rows = [
            solve_position(replace(position, planes=planes))
            for position in POSITIONS
            for planes in (PLANES if position.planes == "common" else ("separate",))
        ]
        patches = compare_two_patches()
        spins = vary_central_position()
        times = measure_times()
        pitches = compare_pitches()
    write("wheel_rail_pitch", pitches)
    show("Convolutions of a free pitch", pitches)
    write("wheel_rail", rows)
    write("wheel_rail_patches", patches)
    write("wheel_rail_spin", spins)
    write("wheel_rail_times", times)
    show("Manchester benchmark, case A2.2", rows)
    show("Two patches", patches)
    show("Central position", spins)
    show("CPU time", times)
