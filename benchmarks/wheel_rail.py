"""Wheel and rail: positions of the Manchester benchmark, and CPU time of positions and wear.

The results that CONTACT prints for case A2.2 (Shackleton & Iwnicki 2008, Vehicle System Dynamics
46, 129-149) belong to S1002 on UIC 60, 10 kN, G = 82 GPa, nu = 0.28, mu = 0.3, elements of 0.2 mm
and slip of first order. Its creepages are relative to its contact point, with the opposite sign.

Page: docs/theory/wheel-rail.md
"""

import math
import warnings
from time import process_time

import numpy as np
from timing import show, write

import tractive_sam as ts

STEEL = {"shear": 82e3, "poisson": 0.28}
TABLES = {
    "body": {"A": STEEL, "B": STEEL},
    "wheel": {"profile": "S1002", "radius": 460.0},
    "rail": {"profile": "UIC60-manchester"},
    "friction": {"mu": 0.3},
}
# side, y mm, yaw mrad, roll mrad, contact y, creepages; P, p_max, approach, |Q_x|, |Q_y|
POSITIONS = (
    ("right", 0.0, 0.0, 0.0, 751.8726, (-5.665e-5, 0.0, 6.302e-5),
     (9997, 338.3, 0.01596, 0.28, 253.6)),
    ("left", 1.5, 3.6, -0.08103, 755.9669, (-7.53e-4, 3.599e-3, -3.33e-5),
     (10050, 446.5, 0.02007, 641.1, 2942)),
    ("left", 4.5, 10.8, -0.2977, 757.799, (-1.591e-3, 1.079e-2, -2.049e-5),
     (10030, 540.2, 0.02209, 440.6, 2976)),
    ("right", 5.0, 12.0, -0.3554, 727.0855, (4.174e-3, 1.255e-2, 6.188e-4),
     (9619, 1556, 0.02719, 763.3, 2738)),
    ("right", 5.5, 13.2, -0.4777, 726.1169, (4.379e-3, 1.401e-2, 7.122e-4),
     (9629, 1486, 0.02926, 850.2, 2759)),
    ("right", 6.0, 14.4, -0.6272, 725.1371, (5.077e-3, 1.580e-2, 8.744e-4),
     (9709, 1149, 0.02728, 880, 2775)),
)  # fmt: skip


def scene_of_position(row: tuple, element: float = 0.2, slip: str = "upwind") -> ts.Scene:
    """Return the scene of a position with its printed creepages.

    With several patches the longitudinal creepage belongs to the first one, and determines the
    angular velocity of the wheel; other creepages follow from the motion.
    """
    side, y, yaw, roll, contact_y, printed, _ = row
    wheelset = {"side": side, "y": y, "yaw": yaw, "roll": roll, "load": 1e4}
    patches = ts.Scene(**TABLES, wheelset=wheelset).wheel_rail.patches
    patch = patches[0]
    sign = 1.0 if side == "left" else -1.0
    spin = sign * printed[2]
    across = (patch.origin[1] - contact_y) / math.cos(patch.angle)
    creepage = (-printed[0] - spin * across, sign * printed[1], spin)
    motion = {"creepage": dict(zip(("longitudinal", "lateral", "spin"), creepage, strict=True))}
    if len(patches) > 1:
        slow, fast = patch.creepages(0.0)[0], patch.creepages(1e-3)[0]  # linear in the pitch
        motion = {}
        wheelset["pitch"] = 1e-3 * (creepage[0] - slow) / (fast - slow)
    half = np.max([one.half_length for one in patches], axis=0)
    elements = [2 * round(1.2 * length / element) + 1 for length in half]
    grid = {"half_length": [0.5 * element * n for n in elements], "elements": elements}
    return ts.Scene(**TABLES, wheelset=wheelset, grid=grid, solver={"slip": slip}, **motion)


def solve_position(row: tuple) -> dict[str, object]:
    """Return one position: computed and printed forces of all patches, and the largest pressure."""
    history = ts.roll(scene_of_position(row))
    last = {
        "P": sum(history["P"]),
        "p_max": max(history["p_max"]),
        "approach": max(history["approach"]),
    }
    last |= {"Qx": sum(history["Qx"]), "Qy": sum(history["Qy"])}
    values = {"y": row[1], "angle": float(history["contact_angle"][-1]), "patches": len(history)}
    for (name, value), known in zip(last.items(), row[-1], strict=True):
        values |= {name: abs(float(value)), f"{name} printed": known}
    return values


def refine_central_position() -> list[dict[str, object]]:
    """Return lateral force and spin moment of the central position on finer meshes."""
    rows = []
    for element in (0.4, 0.2, 0.1):
        values: dict[str, object] = {"element": element}
        for order, slip in (("first", "upwind"), ("second", "auto")):
            contact = ts.solve(scene_of_position(POSITIONS[0], element, slip))
            values |= {f"Qy {order} order": abs(contact.Qy), f"Mz {order} order": abs(contact.Mz)}
        rows.append(values)
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
    ts.wear_profiles(scene.with_set(["wear.step_depth=0.1"]))
    start = process_time()
    worn = ts.wear_profiles(scene)
    step = (process_time() - start) / (3 * worn.revolutions.size)
    return [
        {"work": "locus of 21 positions", "CPU s": locus},
        {"work": "scene of a position", "CPU s": position},
        {"work": "position of a wear step, 25 x 31 elements", "CPU s": step},
    ]


if __name__ == "__main__":
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ts.SceneWarning)
        rows = [solve_position(row) for row in POSITIONS]
        meshes = refine_central_position()
        times = measure_times()
    write("wheel_rail", rows)
    write("wheel_rail_mesh", meshes)
    write("wheel_rail_times", times)
    show("Manchester benchmark, case A2.2", rows)
    show("Central position on finer meshes", meshes)
    show("CPU time", times)
