"""Pressure along a roller: profiles and tilt.

A steel roller of 12 mm width and 6 mm radius on a ring of 40 mm radius carries 10 kN. The script
computes the peak pressure over that of the nominal line contact, its share away from the ends, and
the moment of the pressure.

    python benchmarks/roller.py

Page: docs/howto/roller.md
"""

import numpy as np
from timing import show, write

from tractive_sam.mechanics import hertz_line
from tractive_sam.run import solve
from tractive_sam.scene import Scene

INF, LOAD, WIDTH = float("inf"), 10e3, 12.0
STEEL = {"young": 208e3, "poisson": 0.3, "radius_y": INF}
PROFILES = {
    "logarithmic (Lundberg)": {"form": "logarithmic"},
    "logarithmic, drop = 0.012": {"form": "logarithmic", "drop": 0.012},
    "crowned, radius = 1500": {"form": "crowned", "radius": 1500.0},
    "crowned, flat = 8, drop = 0.012": {"form": "crowned", "flat": 8.0, "drop": 0.012},
}


def pressures() -> list[dict[str, object]]:
    """Return pressure and moment by profile and tilt."""
    rows = []
    for name, profile in PROFILES.items():
        for tilt in (0.0, 0.5, 1.0):
            roller = STEEL | {"radius_x": 6.0, "width": WIDTH, "profile": profile}
            body = {"A": roller, "B": STEEL | {"radius_x": 40.0}}
            scene = Scene(body=body, load={"normal": LOAD, "tilt": tilt})
            line = hertz_line(
                scene.material.plane_strain_modulus, scene.body.radii[0], LOAD / WIDTH
            )
            contact = solve(scene)
            peak = contact.pressure.max(axis=0)[np.abs(contact.grid.y) < 0.4 * WIDTH] / line.p0
            rows.append(
                {
                    "profile": name,
                    "tilt": tilt,
                    "least": peak.min(),
                    "most": peak.max(),
                    "largest": contact.p_max / line.p0,
                    "moment": round(contact.Mx, 3) + 0.0,
                }
            )
    return rows


if __name__ == "__main__":
    table = pressures()
    write("roller", table)
    show("roller", table)
