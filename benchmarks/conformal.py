"""Contacts that curve with their bodies, compared with integral equations and another program.

A disc in a bore is compared with the solution of its integral equation. Balls of 10 mm in grooves
of 10.25 to 10.02 mm radius roll under 10 kN, with R_x = 420 mm, G = 80 GPa, nu = 0.28, mu = 0.3 and
no longitudinal force, on the meshes of CONTACT's example `groove_li` (E. Vollebregt, CONTACT,
open-source version, testbank/examples_conformal). The values of CONTACT are those that it prints:
for half-spaces, and for the first-order correction of their influence by Blanco-Lorenzo et al.

    python benchmarks/conformal.py

Page: docs/howto/conformal.md
"""

import math

from timing import show, write

from tractive_sam.contact import Laws
from tractive_sam.mechanics import HalfSpaces
from tractive_sam.run import solve
from tractive_sam.scene import Scene

INF = float("inf")
# Half angle, load over E* clearance, and pressure over E* clearance / R.
PLANE = (
    (5.0, 0.006006, 0.043856),
    (10.0, 0.024325, 0.089067),
    (20.0, 0.102379, 0.189646),
    (30.0, 0.251777, 0.317312),
    (45.0, 0.708436, 0.624919),
    (60.0, 1.874059, 1.333808),
)
# Radius of the groove, elements, and as printed by CONTACT for half-spaces and with the correction:
# largest pressure, sum of the pressure, and angular velocity over V/R_x, less 1.
GROOVES = (
    (10.25, (95, 37), (530.2, 9915.0, 2.301e-4), (520.6, 9956.0, 2.366e-4)),
    (10.10, (89, 51), (409.3, 9931.0, 4.411e-4), (397.6, 9967.0, 4.667e-4)),
    (10.05, (83, 63), (348.7, 10010.0, 6.495e-4), (336.1, 10050.0, 6.975e-4)),
    (10.02, (79, 81), (296.8, 10260.0, 9.761e-4), (283.6, 10340.0, 1.0744e-3)),
)


def bores() -> list[dict[str, object]]:
    """Return half angle and pressure of a disc in a bore, and of Hertz, over the exact ones."""
    radius, clearance, e_star = 10.0, 1e-4, 208e3 / 1.82
    rows = []
    for degrees, load, peak in PLANE:
        steel = {"young": 208e3, "poisson": 0.3, "radius_y": INF}
        body = {
            "A": steel | {"radius_x": radius - 0.5 * clearance},
            "B": steel | {"radius_x": -radius - 0.5 * clearance},
        }
        grid = {"half_length": [1.3 * math.radians(degrees) * radius], "elements": [401]}
        normal = {"normal": load * e_star * clearance}
        contact = solve(Scene(body=body, load=normal, conformal={}, grid=grid))
        half = math.radians(degrees)
        rows.append(
            {
                "degrees": degrees,
                "angle": contact.half_width_x / (radius * half) - 1.0,
                "peak": contact.p_max / (peak * e_star * clearance / radius) - 1.0,
                "hertz_load": 0.25 * math.pi * half**2 / load - 1.0,
                "hertz_peak": 0.5 * half / peak - 1.0,
            }
        )
    return rows


def grooves() -> list[dict[str, object]]:
    """Return pressure, its sum and the free creepage of balls in grooves, and those of CONTACT."""
    rows = []
    for groove, elements, *printed in GROOVES:
        steel = {"shear": 80e3, "poisson": 0.28}
        ball = steel | {"radius_x": 420.0, "radius_y": 10.0}
        nx, ny = elements
        scene = Scene(
            body={"A": ball, "B": steel | {"radius_x": INF, "radius_y": -groove}},
            load={"normal": 1e4, "force_x": 0.0},
            friction={"mu": 0.3},
            conformal={},
            grid={"half_length": [0.5 * nx * 0.095833, 0.125 * ny], "elements": [nx, ny]},
        )
        laws = Laws.of(scene)
        flat = laws.replace(elasticity=HalfSpaces(**scene.materials))
        for response, law, values in zip(
            ("half-spaces", "cylinder and hole"), (flat, laws), printed, strict=True
        ):
            contact = solve(scene, laws=law)
            rows.append(
                {
                    "groove": groove,
                    "response": response,
                    "half_angle": math.degrees(contact.half_width_y / (0.5 * (10.0 + groove))),
                    "p_max": contact.p_max,
                    "p_max_contact": values[0],
                    "P": contact.P,
                    "P_contact": values[1],
                    "creepage": -contact.xi_x,
                    "creepage_contact": values[2],
                }
            )
    return rows


if __name__ == "__main__":
    for name, rows in (("conformal_bores", bores()), ("conformal_grooves", grooves())):
        write(name, rows)
        show(name, rows)
