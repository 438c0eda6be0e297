"""How many runs does a design need?

Page: docs/howto/design.md

Designs of twin discs that wear: least wear, or least wear and most traction, within limits of the
peak pressure, the traction and the worn mass. Derivatives are differences: each costs a run for
each key.

    python benchmarks/design.py
"""

import warnings

from timing import show, write

import tractive_sam as ts

warnings.simplefilter("ignore", ts.SceneWarning)  # coarse meshes are meant

DISCS = (
    ts.Scene.builtin("twin-discs")
    .replace(
        subsurface=None,
        grid=None,
        wear={"coefficient": {"A": 1.3e-4, "B": 2.2e-4}, "revolutions": 20,
              "save": (0, 1, 5, 20), "stepping": "saved", "turns": "equal"},
    )
    .replace(**{"grid.elements": (15, 31)})
)  # fmt: skip
"""Twin discs on a coarse mesh, with few steps."""

KEYS = {
    "body.A.radius_y": (20.0, 60.0),
    "creepage.longitudinal": (-0.01, -0.002),
    "body.A.radius_x": (25.0, 40.0),
    "body.B.radius_x": (25.0, 40.0),
    "load.normal": (200.0, 400.0),
    "friction.angle": (0.0, 90.0),
}
"""Free keys and their bounds."""

LIMITS = [
    {"observe": "p_max", "at_most": 1000.0},
    {"observe": "Qx_over_P", "at_least": 0.25},
    {"observe": "worn_mass A", "at_most": 0.01},
]


def row_of(name: str, keys: int, limits: int, **aims: str) -> dict[str, object]:
    """Return the cost and the gain of a design with the first keys and limits."""
    free = [{"key": k, "lower": low, "upper": up} for k, (low, up) in [*KEYS.items()][:keys]]
    table = {"scene": DISCS, "free": free, "limit": LIMITS[:limits], "mesh_check": False} | aims
    found = ts.design(table)
    before, after = (float(found.numbers(end)[0]) for end in ("before", "after"))
    return {
        "design": name,
        "keys": keys,
        "limits": limits,
        "points": len(found.numbers("search")),
        "rolls": int(found.summary()["cost"].split(", ")[1].split()[0]),
        "change %": 100.0 * (after / before - 1.0),
        "active": int((found.numbers("margin") < 0.01).sum()),
        "status": found.status,
    }


if __name__ == "__main__":
    rows = [
        row_of("least wear", 2, 2, minimise="wear_max"),
        row_of("least wear", 6, 3, minimise="wear_max"),
        row_of("front of wear and traction", 2, 1, minimise="wear_max", maximise="Qx_over_P"),
    ]
    write("design", rows)
    show("Designs of twin discs", rows)
