"""Residual stress and hardness over the depth: what they change in a line contact.

The first table follows the residual stress that rolling leaves at several depths. The second table
gives the utilisation and the load factors of a case-hardened roller, with and without its residual
stress and hardness, for several criteria.

    python benchmarks/steel.py

Page: docs/howto/steel.md
"""

import numpy as np
from timing import show, write

from tractive_sam.mechanics import RollingMarch, hertz_line
from tractive_sam.run import roll
from tractive_sam.scene import Scene

STEEL = {"young": 208e3, "poisson": 0.3, "radius_y": float("inf")}
CASE = {"depth": [0.0, 0.4, 0.8, 1.2, 2.0], "hardness": [730.0, 690.0, 560.0, 430.0, 380.0]}
CORE = {"depth": [0.0], "hardness": [380.0], "inclusion": 30.0}
RESIDUAL = {"depth": [0.0, 0.4, 0.9, 1.4, 2.5], "xx": [-300.0, -350.0, -150.0, 40.0, 60.0]}


def rolled_stress() -> list[dict[str, object]]:
    """Return the residual stress over p0 that frictionless rolling leaves, by p0/k and depth."""
    rows = []
    for ratio in (3.2, 3.5, 4.0):
        line = hertz_line(114e3, 10.0, pressure=300.0 * ratio)
        depths = np.array([0.4, 0.5, 0.6, 0.7, 0.8, 1.0, 1.2])
        xx, yy = RollingMarch(line, 0.3).residual(depths * line.a, 300.0) / line.p0
        for depth, along, across in zip(depths, xx, yy, strict=True):
            rows.append({"p0_k": ratio, "z_a": depth, "xx": along, "yy": across})
    return rows


def roller(**tables: object) -> Scene:
    """Return a roller of 30 mm on a ring, p0 = 2 GPa, friction 0.05 in full slip."""
    body = {"A": STEEL | {"radius_x": 15.0}, "B": STEEL | {"radius_x": 60.0}}
    return Scene(
        body=body,
        load={"pressure": 2000.0},
        friction={"mu": 0.05},
        creepage={"longitudinal": 0.05},
        subsurface={"planes": ["y=0"], "bodies": ["A"]},
        **tables,
    )


def case_hardening() -> list[dict[str, object]]:
    """Return utilisation and load factors of the roller by criterion and material."""
    hard = CASE | {"inclusion": 30.0}
    peened = {"A": RESIDUAL | {"yy": RESIDUAL["xx"]}}
    materials = {
        "core hardness throughout": (CORE, None),
        "hardness over the depth": (hard, None),
        "and residual stress": (hard, peened),
    }
    rows = []
    for criterion in ("dang-van", "crossland", "findley", "orthogonal-shear"):
        for name, (strength, residual) in materials.items():
            table = {"criterion": criterion, "bodies": ["A"], "A": strength, "elements": 40}
            table |= {} if criterion == "orthogonal-shear" else {"sensitivity": 0.3}
            history = roll(roller(fatigue=table, residual=residual))
            rows.append(
                {
                    "criterion": criterion,
                    "material": name,
                    "utilisation": history["utilisation"][-1, 0],
                    "depth": history["utilisation_at"][-1, 0, 2],
                    "shakedown": history["shakedown_lower"][-1, 0],
                    "von_mises": history["von_mises_max"][-1, 0],
                }
            )
    return rows


if __name__ == "__main__":
    for name, table in (("steel_rolled", rolled_stress()), ("steel_case", case_hardening())):
        write(name, table)
        show(name, table)
