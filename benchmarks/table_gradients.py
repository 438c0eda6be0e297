"""Gradients of the built-in table `steel`, compared with contacts solved on finer meshes.

The slopes at zero creepage are Kalker's creep coefficients C11, C22, C23 (from the lateral force
due to spin, and from the moment due to lateral creepage) and C33, for several a/b. Their reference
is extrapolated from 22 meshes of 29 to 131 elements across the contact. Gradients at random points,
drawn as in `benchmarks/tables.py`, are compared with contacts of 43 elements: the largest of the
nine errors is divided by sqrt(K_ii K_jj) with the slopes K_ii at zero creepage.

    python benchmarks/table_gradients.py [POINTS]

Page: docs/howto/tables.md
"""

import math
import sys

import numpy as np
from timing import show, write

import tractive_sam as ts
from tractive_sam.reference import creep_coefficients
from tractive_sam.tables.design import Contacts, unit_scene

NAMES = {"C11": (0, 0), "C22": (1, 1), "C23, force": (1, 2), "C23, moment": (2, 1), "C33": (2, 2)}
KALKER = {"C11": "C11", "C22": "C22", "C23, force": "C23", "C33": "C33"}


def contact_of(ratio: float) -> dict:
    """Return a contact with G = mu P = c = 1, so that scaled creepages are creepages."""
    root = math.sqrt(ratio)
    return {"a": root, "b": 1.0 / root, "load": 1.0, "mu": 1.0, "shear": 1.0}


def at_rest(table: ts.CreepTable, ratio: float) -> dict:
    """Return the errors of the slopes at zero creepage for one a/b, in per cent."""
    meshes = 2 * np.unique(np.rint(np.geomspace(29, 131, 22) / 2).astype(int)) + 1
    limit, bar = Contacts(unit_scene(ratio, 0.3)).slopes_at_rest(meshes)
    forces = table(0.0, 0.0, 0.0, **contact_of(ratio))
    kalker = creep_coefficients(ratio, 0.3)
    row = {"a/b": ratio}
    for name, at in NAMES.items():
        size = abs(limit[at])
        row[name] = 100.0 * (forces.gradient[at] / limit[at] - 1.0)
        row[f"bar of {name}"] = 100.0 * forces.gradient_error[at] / size
        row[f"reference of {name}"] = 100.0 * bar[at] / size
        if name in KALKER:
            row[f"Kalker of {name}"] = 100.0 * (getattr(kalker, KALKER[name]) / size - 1.0)
    return row


def anywhere(table: ts.CreepTable, count: int, per_ratio: int = 5) -> list[dict]:
    """Return relative errors of gradients at random points, and whether the bars contain them."""
    random, rows = np.random.default_rng(60), []
    while len(rows) < count:
        ratio = float(np.exp(random.uniform(*np.log(table.ellipticity))))
        contacts = Contacts(unit_scene(ratio, 0.3))
        slopes = np.abs(np.diag(table(0.0, 0.0, 0.0, **contact_of(ratio)).gradient))
        size = np.sqrt(np.outer(slopes, slopes))
        for w in random.normal(size=(per_ratio, 3)) * [0.4, 0.4, 0.8]:
            solved = contacts.solve(w, 43, 43, 1.0).gradient
            forces = table(*w, **contact_of(ratio))
            errors = np.abs(forces.gradient - solved)
            inside = bool((errors <= forces.gradient_error).all())
            rows.append({"ratio": ratio, "forces": float((errors / size)[:2].max()),
                         "moment": float((errors / size)[2].max()), "inside": inside})  # fmt: skip
    return rows[:count]


def main() -> None:
    """Print and write both comparisons."""
    table = ts.open_table("steel")
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    low, high = table.ellipticity
    ratios = (low, 0.3, 0.42, 0.5, 0.7, 1.0, 1.2, 1.7, 2.0, 2.4, 3.1, 3.7, 3.9, high)
    rows = [at_rest(table, min(max(ratio, low), high)) for ratio in ratios]
    show("errors of slopes at zero creepage, in per cent", rows)
    print(write("table_slopes", rows))
    points = anywhere(table, count)
    about = {"points": count, "inside": float(np.mean([row["inside"] for row in points]))}
    for name in ("forces", "moment"):
        errors = np.array([row[name] for row in points])
        about |= {f"{name} median": float(np.median(errors)),
                  f"{name} 95%": float(np.quantile(errors, 0.95)),
                  f"{name} largest": float(errors.max())}  # fmt: skip
    show(f"errors of gradients at {count} points, divided by sqrt(K_ii K_jj)", [about])
    print(write("table_gradients", [about]))


if __name__ == "__main__":
    main()
