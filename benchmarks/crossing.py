"""Does a wheel on two rails of a crossing agree with another program?

CONTACT's example two_patches: a wheel S1002 on the nose and the wing rail of a crossing, given by
sections along the track. Its profiles are not part of this package; the argument is the folder
testbank/profiles of its source (github.com/eve70a/CONTACT).

Page: docs/theory/wheel-rail.md
"""

import argparse
import math
import tempfile
import warnings
from pathlib import Path

import numpy as np
from timing import show, write

import tractive_sam as ts

NAMES = ("P", "p_max", "approach", "Qx", "Qy")
PRINTED = {
    0.2: ((4790, 1584, 0.02054, 1313, 557.3), (6171, 634.5, 0.01725, 1611, 152.9)),
    0.05: ((4755, 1573, 0.02047, 1303, 552.1), (6201, 621.4, 0.01734, 1602, 151.9)),
}
"""CONTACT on the nose and the wing rail: P, p_max, approach, |Q_x|, |Q_y|, by the size of elements.

Elements of 0.2 mm: as its example prints. Elements of 0.05 mm: the same version (revision 2707,
gfortran 12.2, DX = DS = 0.05, EPS = 1e-6) at the prescribed height Z_WS = -0.9237838 mm (NORM = 0),
where FZ is 10 kN; with a prescribed load, its iteration ends without contact.
"""

NUMBER = 13
"""Sections with both rails: the last ones of the file uk_interrupt_v2.slcs."""


def write_sections(profiles: Path, path: Path) -> None:
    """Write the sections that contain both rails, with absolute paths of their profiles."""
    lines = (profiles / "uk_interrupt_v2.slcs").read_text().splitlines()
    entries = [line for line in lines if line.strip() and not line.lstrip().startswith("%")]
    files = [line for line in entries if "'" in line][-NUMBER:]
    marks = [line for line in entries if "999." in line][-NUMBER:]
    head = ["0.0 1000.0", f"{NUMBER}", "11 0 0", "1"]
    path.write_text(
        "\n".join([*head, *files, *marks]).replace("uk_crossing", f"{profiles}/uk_crossing")
    )


def crossing_scene(sections: Path, wheel: Path, element: float) -> ts.Scene:
    """Return the scene of the example, with elements of this size, mm."""
    steel = {"shear": 82e3, "poisson": 0.28}
    tables = {
        "body": {"A": steel, "B": steel},
        "wheel": {"profile": str(wheel)},
        "rail": {"profile": str(sections), "unit": "m", "inclination": math.inf},
        # VPITCH is -4.3481181 at 2 m/s.
        "wheelset": {"x": 160.0, "y": 3.52, "roll": 0.0, "pitch": 4.3481181 * 0.46 / 2.0 - 1.0},
        "friction": {"mu": 0.3},
        "solver": {"slip": "upwind"},
    }
    tables["rail"]["origin"], tables["wheelset"]["load"] = [750.0, 0.0], 1e4
    half = np.max([p.half_length for p in ts.Scene(**tables).wheel_rail.patches], axis=0)
    elements = [2 * round(1.2 * length / element) + 1 for length in half]
    grid = {"half_length": [0.5 * element * n for n in elements], "elements": elements}
    return ts.Scene(**tables, grid=grid)


def solve_crossing(profiles: Path) -> list[dict[str, object]]:
    """Return both patches with elements of 0.2 and 0.05 mm, and the values of CONTACT."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "crossing.slcs"
        write_sections(profiles.resolve(), path)
        wheel = profiles.resolve() / "MBench_S1002_v3.prw"
        for element, contacts in PRINTED.items():
            history = ts.roll(crossing_scene(path, wheel, element))
            for k, printed in enumerate(contacts):
                row: dict[str, object] = {"angle": history["contact_angle"][k], "element": element}
                for name, known in zip(NAMES, printed, strict=True):
                    row |= {name: abs(float(history[name][k])), f"{name} printed": known}
                rows.append(row)
    return rows


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("profiles", type=Path, help="folder testbank/profiles of CONTACT")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ts.SceneWarning)
        rows = solve_crossing(parser.parse_args().profiles)
    write("wheel_rail_crossing", rows)
    show("Nose and wing rail of a crossing", rows)
