"""Creep forces from a table, from approximate theories and from contacts: error against time.

A thousand points are not used by any table: a/b is in the range of the built-in table `steel`, and
scaled creepages and spin have normal distributions up to full slip. The reference is a contact with
two to three times the elements of any node of the table. Errors are the larger error of (Q_x, Q_y),
divided by mu P, and, if a method gives the moment, its error divided by mu P c. Times are for one
evaluation on one core; the table is also evaluated for an array of a million points, with gradients
and errors, and in C. The figure compares the errors at the test points of the table with its error
bars.

    python benchmarks/tables.py [POINTS]

Page: docs/howto/tables.md
"""

import math
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from timing import RESULTS, show, write

import tractive_sam as ts
from tractive_sam.lookup import c_sources
from tractive_sam.plot import table_errors
from tractive_sam.reference import fastsim, linear_creep_forces, vermeulen_johnson
from tractive_sam.tables.design import MU, Contacts, unit_scene

NU, FINE = 0.3, 47
SPREAD = np.array([0.4, 0.4, 0.8])
"""Of the scaled creepages."""

TABLE = "table `steel`"

MANY = 1_000_000
"""Points at once."""

FEW = 40
"""a/b among the points: of each one the operators are made once."""


def points(table: ts.CreepTable, count: int) -> list[tuple[float, np.ndarray]]:
    """Return random a/b and scaled creepages, sorted by a/b."""
    random = np.random.default_rng(20)
    ratios = np.exp(random.uniform(*np.log(table.ellipticity), FEW))
    return [(float(ratios[k * FEW // count]), random.normal(size=3) * SPREAD)
            for k in range(count)]  # fmt: skip


def contact_of(ratio: float) -> dict:
    """A contact in which scaled creepages are creepages: G = mu P = c = 1."""
    root = math.sqrt(ratio)
    return {"a": root, "b": 1.0 / root, "load": 1.0, "mu": 1.0, "shear": 1.0}


def linear(ratio: float, w: np.ndarray) -> np.ndarray:
    """Kalker's linear theory, cut off at mu P."""
    here = contact_of(ratio)
    creepages = dict(zip(("xi_x", "xi_y", "spin"), w, strict=True))
    forces = np.array(linear_creep_forces(here["a"], here["b"], 1.0, NU, **creepages))
    return forces * [*[1.0 / max(1.0, math.hypot(*forces[:2]))] * 2, 1.0]


def by_vermeulen_johnson(ratio: float, w: np.ndarray) -> np.ndarray:
    """Vermeulen & Johnson's curve of the size of the force of linear theory (Shen et al. 1983)."""
    here = contact_of(ratio)
    creepages = dict(zip(("xi_x", "xi_y", "spin"), w, strict=True))
    force = np.array(linear_creep_forces(here["a"], here["b"], 1.0, NU, **creepages)[:2])
    size = math.hypot(*force)
    return np.array([*(float(vermeulen_johnson(size / 3.0)) / size * force), math.nan])


def by_fastsim(ratio: float, w: np.ndarray) -> np.ndarray:
    """FASTSIM with 30 x 30 elements."""
    here = contact_of(ratio)
    creepages = dict(zip(("xi_x", "xi_y", "spin"), w, strict=True))
    return np.array(fastsim(**here, poisson=NU, **creepages, elements=(30, 30)))


def at_once(points: list[tuple[float, np.ndarray]]) -> tuple[np.ndarray, dict]:
    """All points as arrays: creepages, and the contacts."""
    root = np.sqrt([ratio for ratio, _ in points])
    contact = {"a": root, "b": 1.0 / root, "load": 1.0, "mu": 1.0, "shear": 1.0}
    return np.array([w for _, w in points]).T, contact


def within(table: ts.CreepTable, points: list, errors: np.ndarray) -> float:
    """Return the fraction of the points with errors within the reported error bars."""
    w, contact = at_once(points)
    return float((errors <= table(*w, **contact).error.T).all(axis=1).mean())


class FirstOrder:
    """Contacts of first order on 12 x 12 elements, the usual nodes of tables."""

    def __init__(self):
        self.scenes = {}

    def __call__(self, ratio: float, w: np.ndarray) -> np.ndarray:
        """Solve one."""
        if ratio not in self.scenes:
            scene = unit_scene(ratio, NU)
            grid = {"half_length": (scene.hertz.a, scene.hertz.b), "elements": (12, 12)}
            self.scenes[ratio] = scene.replace(grid=grid, **{"solver.slip": "upwind"})
        scene = self.scenes[ratio]
        c, bound = scene.hertz.mean_semi_axis, MU * scene.normal_load
        xi = w * bound / (scene.material.shear * c**2) / np.array([1.0, 1.0, c])
        creepage = dict(zip(("longitudinal", "lateral", "spin"), xi, strict=True))
        contact = ts.solve(scene.replace(creepage=creepage), throw=False)
        return np.array([contact.Qx, contact.Qy, contact.Mz / c]) / bound


def seconds_in_c(table: ts.CreepTable) -> float:
    """Time of an evaluation with its gradient in C; nan without a compiler."""
    if shutil.which("cc") is None:
        return math.nan
    program = """
#include "steel.h"
#include <stdio.h>
#include <time.h>
int main(void) {
    double f[3], sum = 0.0;
    int k, n = 200000;
    clock_t began = clock();
    for (k = 0; k < n; k++) {
        double t = k / (double)n;
        steel(t - 0.5, 0.3 * t, 1.0 - t, 1.0 + t, 1.0, 1.0, 1.0, 1.0, 0.3, f, 0);
        sum += f[0];
    }
    fprintf(stderr, "%g", sum);
    printf("%.9g", (clock() - began) / (double)CLOCKS_PER_SEC / n);
    return 0;
}
"""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in (c_sources(table, "steel") | {"main.c": program}).items():
            Path(folder, name).write_text(text)
        command = ["cc", "-O2", "main.c", "steel.c", "-o", "main", "-lm"]
        subprocess.run(command, cwd=folder, check=True)
        completed = subprocess.run(
            ["./main"], cwd=folder, capture_output=True, text=True, check=True
        )
    return float(completed.stdout)


def main() -> None:
    """Print, write and draw the comparison."""
    table = ts.open_table("steel")
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    random_points = points(table, count)
    contacts: dict[float, Contacts] = {}
    exact = []
    for ratio, w in random_points:
        if ratio not in contacts:
            contacts = {ratio: Contacts(unit_scene(ratio, NU))}
        exact.append(contacts[ratio].forces(w, FINE))
    exact = np.array(exact)

    def looked_up(ratio: float, w: np.ndarray) -> np.ndarray:
        f = table(*w, **contact_of(ratio))
        return np.array([f.Qx, f.Qy, f.Mz])

    methods = {
        f"{TABLE}, single points": looked_up,
        "Kalker's linear theory": linear,
        "Vermeulen-Johnson": by_vermeulen_johnson,
        "FASTSIM, 30 x 30": by_fastsim,
        "first order, 12 x 12": FirstOrder(),
    }
    rows = []
    for name, method in methods.items():
        method(*random_points[0])
        began = process_time()
        values = np.array([method(*point) for point in random_points])
        spent = (process_time() - began) / count
        errors = np.abs(values - exact)
        force = errors[:, :2].max(axis=1)
        rows.append(
            {
                "method": name,
                "s": spent,
                "median": float(np.median(force)),
                "worst": float(force.max()),
                "moment": float(np.median(errors[:, 2])),
            }
        )
        if method is looked_up:
            inside = within(table, random_points, errors)
    table_row = rows[0]
    w, contact = at_once(random_points * max(1, MANY // count))
    for name, what in (
        ("in arrays", lambda f: f),
        ("in arrays, with gradients", lambda f: (f.gradient, f.error)),
    ):
        began = process_time()
        what(table(*w, **contact))
        each = (process_time() - began) / w.shape[1]
        rows.append(table_row | {"method": f"{TABLE}, {name}", "s": each})
    in_c = seconds_in_c(table)
    if math.isfinite(in_c):
        rows.append(table_row | {"method": f"{TABLE}, in C", "s": in_c})
    title = f"{count} points: errors over mu P, and time of one; {inside:.1%} are inside the error"
    made = f"{table.nodes} nodes, {table.about['cpu_seconds'] / 3600.0:.3f} core-hours to make"
    show(f"{title} that the table reports; {made}", rows)
    print(write("tables", rows))
    about = {"points": count, "inside": inside, "nodes": table.nodes,
             "tolerance": float(table.about["tolerance"]),
             "cpu_seconds": float(table.about["cpu_seconds"])}  # fmt: skip
    print(write("tables_about", [about]))
    print(draw(rows))
    path = RESULTS / "tables_held_out.png"
    table_errors(table).savefig(path, dpi=150)
    print(path)


LABELS = {  # of a method: position of its label, in points from its median, and its alignment
    "Kalker's linear theory": (8, 0, "left"),
    "Vermeulen-Johnson": (8, -5, "left"),
    "FASTSIM, 30 x 30": (0, -14, "center"),
    "first order, 12 x 12": (0, -14, "center"),
}


def draw(rows: list[dict]) -> Path:
    """Draw median and largest error against the time of an evaluation."""
    figure, axes = plt.subplots(figsize=(7.0, 4.2), layout="constrained")
    colours = iter(("C1", "C2", "C3", "C4"))
    for row in rows:
        name, _, how = row["method"].partition(f"{TABLE}, ")
        color = "C0" if how else next(colours)
        axes.plot([row["s"]] * 2, [row["median"], row["worst"]], "-", color=color, alpha=0.6)
        axes.plot(row["s"], row["median"], "o", color=color)
        axes.plot(row["s"], row["worst"], "_", markersize=12, color=color)
        x, y, aligned = LABELS.get(name, (4, -8, "right"))
        axes.annotate(how or name, (row["s"], row["median"]), (x, y), color=color, ha=aligned,
                      textcoords="offset points", rotation=30 if how else 0,
                      rotation_mode="anchor", va="top" if how else "center")  # fmt: skip
    table = next(row for row in rows if row["method"].startswith(TABLE))
    axes.annotate(TABLE, (table["s"], table["worst"]), (10, -4), color="C0", va="top",
                  textcoords="offset points")  # fmt: skip
    axes.set(xscale="log", yscale="log", xlim=(5e-7, 5e-2), ylim=(3e-5, 1.5),
             xlabel="time of an evaluation, s", ylabel=r"error of $Q_x$, $Q_y$ divided by $\mu P$",
             title="Median (points) and largest errors (bars)")  # fmt: skip
    axes.grid(alpha=0.3)
    path = RESULTS / "tables.png"
    figure.savefig(path, dpi=150)
    return path


if __name__ == "__main__":
    main()
