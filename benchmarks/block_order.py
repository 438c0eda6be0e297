"""Is the effect of the block order within damage_error? Random duty cycles rolled as their mean.

    python benchmarks/block_order.py [--cases 18] [--seeds 1 2 3]

The scenes are discs on a coarse mesh with two to four random blocks. Each block has a random load,
creepage and lateral position, and one to six revolutions. Adaptive jumps cover complete cycles and
use the mean over the blocks; the reference computes every revolution in order. For each body, the
difference of the damage is compared with `damage_error` of the jumps. The median of their ratio
shows whether the error bar is useful: 1 would be the smallest possible bar.

Page: docs/theory/fatigue.md
"""

import argparse
import random
import warnings

import numpy as np
from timing import show, write

import tractive_sam as ts

STEEL = {"young": 208e3, "poisson": 0.3, "radius_x": 30.0}
GRID = {"half_length": [0.5, 0.96], "elements": [17, 33]}
"""Mesh for contacts of up to 400 N that are shifted by up to 0.15 mm."""


def blocks(chance: random.Random) -> list[dict]:
    """Return random blocks of a duty cycle."""
    return [
        {
            "revolutions": chance.randint(1, 6),
            "load": {"normal": round(chance.uniform(150.0, 400.0), 1)},
            "creepage": {
                "longitudinal": round(chance.choice((-1, 1)) * chance.uniform(1e-3, 6e-3), 5),
                "lateral": round(chance.uniform(-2e-3, 2e-3), 5),
            },
            "shift_y": chance.randint(-5, 5) * 0.96 / 33,
        }
        for _ in range(chance.randint(2, 4))
    ]


def case(chance: random.Random) -> ts.Scene:
    """Return a random scene of complete cycles."""
    duty = blocks(chance)
    cycle = sum(block["revolutions"] for block in duty)
    revolutions = cycle * max(1, round(chance.uniform(12, 90) / cycle))
    worn = {body: round(10 ** chance.uniform(-3.5, -1.7), 6) for body in "AB"}
    radii = [round(chance.uniform(25.0, 60.0), 1) for _ in "AB"]
    criterion = chance.choice(("dang-van", "crossland"))
    return ts.Scene(
        body={b: STEEL | {"radius_y": r} for b, r in zip("AB", radii, strict=True)},
        load={"normal": 300.0},
        creepage={"longitudinal": -0.003},
        friction={"mu": round(chance.uniform(0.1, 0.4), 2)},
        grid=GRID,
        fatigue={
            "criterion": criterion,
            "sensitivity": 0.3,
            "limit": 250.0,
            "cycles": 1e6,
            "exponent": round(chance.uniform(3.0, 10.0), 1),
            "elements": 8,
        },
        wear={"coefficient": worn, "revolutions": revolutions, "save": [0, revolutions]},
        duty=duty,
    )


def compare(scene: ts.Scene) -> list[dict]:
    """Return the differences between jumps and every revolution, one row for each body."""
    jumps = ts.roll(scene)
    each = ts.roll(scene.with_set(["wear.stepping=every-revolution"]))
    rows = []
    for k, body in enumerate("AB"):
        exact = each["damage"][-1, k]
        # Both have the error by the points of stress paths, and every revolution no other one.
        bar = jumps["damage_error"][-1, k] - each["damage_error"][-1, k]
        missed = abs(jumps["damage"][-1, k] - exact)
        rows.append(
            {
                "body": body,
                "blocks": len(scene.duty),
                "revolutions": scene.wear.revolutions,
                "records": len(jumps),
                "worn, mm": float(each.fatigue(body).worn.max()),
                "difference": missed / exact,
                "bar": bar / exact,
                "bar / difference": bar / missed,
            }
        )
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=18)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    rows, summary = [], []
    for seed in options.seeds:
        chance, ratios = random.Random(seed), []
        for number in range(options.cases):
            block_rows = compare(case(chance))
            ratios += [row["bar / difference"] for row in block_rows]
            rows += [{"seed": seed, "case": number} | row for row in block_rows]
        within = sum(ratio >= 1.0 for ratio in ratios)
        summary_row = {"seed": seed, "bodies": len(ratios), "within": within, "least": min(ratios)}
        summary.append(summary_row | {"median": float(np.median(ratios))})
    write("block_order", rows)
    write("block_order_ratios", summary)
    show("Error of the damage due to the block order", rows)
    show("Ratio of the error bar to the difference", summary)


if __name__ == "__main__":
    main()
