"""Do the twin discs crack or wear? Damage with and without wear, and its cost.

    python benchmarks/fatigue.py             # the twin discs: a CSV, half an hour
    python benchmarks/fatigue.py bounds      # shakedown of 200 random scenes: is lower <= upper?
    python benchmarks/fatigue.py laws        # line contacts and ellipses, against closed forms

The discs roll 15,000 revolutions at beta = 0, 45 and 90, on the mesh of the paper and on meshes
with half and twice as many elements along each axis, at two tolerances of the stepping. The
material has k = 300 MPa and Dang Van's criterion with a = 1/3, 250 MPa at 1e7 cycles, and the
exponent 10. "without wear" is the damage of the unworn contact after all revolutions. Rows are
written as they are computed, the most informative first. Rows that the present code has already
written are not computed again. Seconds are CPU seconds of the process.

Page: docs/theory/fatigue.md
"""

import csv
import sys
import tempfile
from hashlib import sha256
from pathlib import Path
from time import process_time

import numpy as np
from error_bars import random_scenes
from scipy.integrate import trapezoid
from scipy.interpolate import PchipInterpolator
from timing import RESULTS, show, write

import tractive_sam as ts
from tractive_sam.mechanics import DangVan, interpolate_over_depth, residual_shear
from tractive_sam.reference import line_pressure_stress, line_shear_stress

MATERIAL = {"shear_yield": 300.0, "sensitivity": 1.0 / 3.0, "limit": 250.0}
REVOLUTIONS = 15_000
CASES = tuple(
    (beta, mesh, tolerance)
    for tolerance, mesh in (
        (1e-3, (41, 121)),
        (1e-3, (21, 61)),
        (1e-3, (81, 241)),
        (1e-4, (41, 121)),
        (1e-4, (21, 61)),
        (1e-4, (81, 241)),
    )
    for beta in (45, 0, 90)
)
"""In the order of their information."""

MESHES = (51, 101, 201, 401)


def discs(beta: float, mesh: tuple[int, int], tolerance: float) -> ts.Scene:
    """Return the twin discs with a material."""
    settings = [
        f"friction.angle={beta}",
        f"grid.elements={list(mesh)}",
        f"wear.tolerance={tolerance}",
        f"wear.revolutions={REVOLUTIONS}",
        f"wear.save=[0, 1000, 4000, {REVOLUTIONS}]",
    ]
    return ts.Scene.builtin("twin-discs").with_set(settings).replace(subsurface=None)


def row(beta: float, mesh: tuple[int, int], tolerance: float) -> dict:
    """Return the results of one run, with its cost relative to a run without fatigue."""
    scene = discs(beta, mesh, tolerance)
    began = process_time()
    plain_contacts = int(ts.roll(scene)["solves"].sum())
    plain_seconds = process_time() - began
    with tempfile.TemporaryDirectory() as folder:
        began = process_time()
        history = ts.roll(scene.replace(fatigue=MATERIAL), Path(folder) / "a.h5")
        seconds = process_time() - began
        columns = {}
        for k, body in enumerate("AB"):
            unworn = REVOLUTIONS / history["fatigue_life"][0, k]
            inside = REVOLUTIONS * _inside(history, body)
            columns |= {
                f"most {body}": np.nanmax(history["damage"][:, k]),
                f"damage {body}": history["damage"][-1, k],
                f"error {body}": history["damage_error"][-1, k],
                f"depth {body}": history["damage_at"][-1, k, 2],
                f"without wear {body}": unworn,
                f"inside without wear {body}": inside,
                f"removed {body}": 1.0 - history["damage"][-1, k] / unworn,
                f"crack at {body}": history["initiation"][-1, k],
                f"margin {body}": history["wear_margin"][-1, k],
                f"certain {body}": history["shakedown_lower"][-1, k],
            }
        worn = history.fatigue("A").worn.max()
    contacts = int(history["solves"].sum())
    cost = {
        "records": len(history),
        "contacts": contacts,
        "contacts without": plain_contacts,
        "seconds": seconds,
        "without": plain_seconds,
    }
    return columns | {"worn A, mm": float(worn)} | cost


def _inside(history: ts.History, body: str) -> float:
    """Return the damage of a revolution at least one element below the unworn surface."""
    k = "AB".index(body)
    life = ts.Laws.of(history.scene).life
    return float(life.damage(history["utilisation_interior"][:1, k])[0])


def bounds(count: int = 200) -> None:
    """Compute both shakedown limits of random scenes."""
    rows = []
    for number, scene in enumerate(random_scenes(count, 5)):
        hertz = scene.hertz
        grid = {"half_length": [1.3 * hertz.a, 1.3 * hertz.b], "elements": [31, 31]}
        tired = scene.replace(subsurface=None, grid=grid, fatigue={"yield_strength": 1.0})
        contact = ts.solve(tired, throw=False)
        if not contact.converged:
            continue
        for body, fatigue in ts.fatigue(contact).items():
            ratio = fatigue.path_radius / np.maximum(fatigue.residual_shear, 1e-300)
            relevant = fatigue.residual_shear > 1e-6 * fatigue.residual_shear.max()
            rows.append(
                {
                    "scene": number,
                    "body": body,
                    "p0/k certain": hertz.p0 / fatigue.largest("residual_shear").value,
                    "p0/k impossible": hertz.p0 / fatigue.largest("path_radius").value,
                    "largest ratio": float(ratio[relevant].max()),
                }
            )
    write("fatigue_bounds", rows)
    worst = max(row["largest ratio"] for row in rows)
    print(f"{len(rows)} bodies: the largest share of the upper in the lower bound is {worst:.9f}")


def laws() -> None:
    """Return errors for several meshes: shakedown of lines in full slip, shear of a sphere."""
    rows = []
    for elements in MESHES:
        scene = ts.Scene.builtin("cylinders").replace(subsurface=None)
        grid = {"half_length": 1.1 * scene.hertz.a, "elements": elements}
        row = {}
        for mu, certain in ((0.1, 3.5643), (0.2, 3.2025), (0.3, 2.8997)):
            slips = {"friction.mu": mu, "creepage.longitudinal": -0.05, "grid": grid}
            line = scene.replace(fatigue={"shear_yield": 300.0}, **slips)
            residual = ts.fatigue(ts.solve(line))["A"].largest("residual_shear")
            row[f"mu = {mu}"] = line.hertz.p0 / residual.interior
            row[f"error {mu}"] = row[f"mu = {mu}"] / certain - 1.0
            if mu == 0.3:
                row["surface 0.3"] = line.hertz.p0 / residual.surface
                row["error of the surface"] = row["surface 0.3"] / 2.99702 - 1.0
        rows.append({"elements": elements} | row)
    write("fatigue_laws", rows)
    write("fatigue_closed_forms", closed_forms())
    write("fatigue_depths", between())
    show("p0/k up to which shakedown of a line contact in full slip is certain", rows)


def closed_forms() -> list[dict]:
    """Return p0/k up to which lines in full slip shake down, inside and at the surface."""
    rows = []
    x, depths = np.linspace(-4.0, 4.0, 1601)[:, None], np.linspace(0.3, 0.6, 61)
    for mu in (0.0, 0.1, 0.2, 0.3, 0.31, 0.315, 0.32, 0.33, 0.367):

        def cycles(z, mu=mu):
            pressed = line_pressure_stress(x, z, 1.0, 1.0, 0.3)
            stress = pressed + mu * line_shear_stress(x, z, 1.0, 1.0, 0.3)
            return np.concatenate((stress, np.zeros_like(stress[:, :1])), axis=1)

        inside = max(residual_shear(cycles(np.array([z])))[0] for z in depths)
        surface = residual_shear(cycles(np.zeros(1)))[0]
        rows.append({"mu": mu, "inside": 1.0 / inside, "surface": 1.0 / surface})
    show("Closed form", rows)
    return rows


def between() -> list[dict]:
    """Integrate utilisation^10 over the depth of lines in full slip, from few depths."""
    near = np.geomspace(1e-7, 1.0, 150)
    sides = [side + sign * near for side in (-1.0, 1.0) for sign in (-1.0, 1.0)]
    x = np.unique(np.concatenate((np.linspace(-4.0, 4.0, 801), *sides, (-1.0, 1.0))))[:, None]
    criterion, rows = DangVan(1.0 / 3.0), []

    def used(z, mu):
        stress = line_pressure_stress(x, z, 1.0, 1.0, 0.3)
        stress = stress + mu * line_shear_stress(x, z, 1.0, 1.0, 0.3)
        return criterion(np.concatenate((stress, np.zeros_like(stress[:, :1])), axis=1))

    for mu in (0.05, 0.3, 0.6):
        fine = np.concatenate(([0.0], np.geomspace(1e-6, 1.5, 400)))
        exact = trapezoid(used(fine, mu) ** 10, fine)
        for element in (0.16, 0.08, 0.04, 0.02):
            depth = element + (1.5 - element) * np.linspace(0.0, 1.0, 23) ** 1.5
            depth = np.concatenate(([0.0], depth))
            z, here = np.linspace(0.0, np.sqrt(1.5), 4000) ** 2, used(depth, mu)
            by_root = interpolate_over_depth(depth, here[None], z)[0]
            by_depth = PchipInterpolator(depth, here)(z)
            errors = (trapezoid(u**10, z) / exact - 1.0 for u in (by_root, by_depth))
            columns = zip(("over the root", "over the depth"), errors, strict=True)
            rows.append({"mu": mu, "element/a": element} | dict(columns))
    show("Integral of the damage over the depth, relative error", rows)
    return rows


def _case(row: dict) -> tuple[str, ...]:
    return tuple(str(row[name]) for name in ("beta", "mesh", "tolerance"))


def _written() -> list[dict]:
    path = RESULTS / "fatigue.csv"
    return list(csv.DictReader(path.open(newline=""))) if path.exists() else []


def _code() -> str:
    """Return a hash of the package, which changes with each of its lines."""
    files = sorted(Path(ts.__file__).parent.rglob("*.py"))
    return sha256(b"".join(file.read_bytes() for file in files)).hexdigest()[:8]


def main() -> None:
    """Run the benchmark named on the command line."""
    if sys.argv[1:] == ["bounds"]:
        return bounds()
    if sys.argv[1:] == ["laws"]:
        return laws()
    code, rows = _code(), []
    by_case = {_case(row): row for row in _written() if row.get("code") == code}
    few = discs(45, (21, 61), 1e-3).with_set(["wear.revolutions=2", "wear.save=[2]"])
    ts.roll(few.replace(fatigue=MATERIAL))  # what is compiled does not count
    for beta, mesh, tolerance in CASES:
        about = {"beta": beta, "mesh": f"{mesh[0]} x {mesh[1]}", "tolerance": tolerance}
        done = by_case.get(_case(about))
        rows.append(done or about | row(beta, mesh, tolerance) | {"code": code})
        write("fatigue", rows)
        if not done:
            show("Twin discs, 15,000 revolutions", rows[-1:])
            sys.stdout.flush()
    return None


if __name__ == "__main__":
    main()
