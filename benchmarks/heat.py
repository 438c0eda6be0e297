"""Cost of the flash temperature relative to its contact, all in one run.

The scene is the fast discs, which mostly slide. Times are for one core, relative to the solution of
the contact without an initial guess to the tolerance of the scene. They are given for the heat
partition between equal and different bodies, and for the tables of coefficients, which the first
contact on a mesh at a speed requires. For friction that depends on temperature, the number of
operator applications is given relative to constant friction.

The second table compares friction that depends on temperature with published results of CONTACT
(examples m3_tempdep and conv_temp of its test bank) and, with a memory, with a march from the
leading edge, row by row. CONTACT's temperature counts the heat of an element in that element twice,
and its memory lets the friction change with the speed MEM_S0 in place of the sliding speed. The
table lists the results with and without both changes.

    python benchmarks/heat.py [contact]

Page: docs/theory/heat.md
"""

import sys
from unittest import mock

import numpy as np
from timing import seconds, show, write

import tractive_sam as ts
from tractive_sam import operators
from tractive_sam.contact import Model, equilibrium
from tractive_sam.contact.heat import surface_heat, temperatures_of
from tractive_sam.scene import Scene

ELEMENTS = (31, 61, 121, 241)
SPEEDS = {20.0: 0.2, 20e3: 200.0}
"""Rolling speeds, mm/s, and the approximate Peclet number V a/(2 kappa)."""

CERAMIC = {"conductivity": 3.0, "density": 6000.0, "heat_capacity": 500.0}
FALLS = [[60.0, 1.0], [160.0, 0.6]]


def row(elements: int, speed: float) -> dict:
    """Return the costs for one mesh and one speed."""
    discs = Scene.builtin("hot-discs")
    a, b = discs.hertz.a, discs.hertz.b
    grid = {"half_length": (1.1 * a, 1.1 * b), "elements": (elements, elements)}
    keys = {"grid": grid, "creepage.speed": speed, "creepage.longitudinal": -0.004}
    warm = discs.replace(**keys, **{"friction.temperature": FALLS})
    hot = warm.replace(**{"friction.temperature": None})
    unlike = hot.replace(**{"body.B.thermal": CERAMIC})
    cold = Model(hot.replace(**{"heat": None, "body.A.thermal": None, "body.B.thermal": None}))
    contact = equilibrium(cold)
    solve = seconds(lambda: equilibrium(cold))

    def kernels() -> None:
        surface_heat.cache_clear()
        for thermal in unlike.thermal.values():
            surface_heat(contact.grid, speed, thermal.diffusivity, thermal.conductivity)

    timings = {"elements": elements, "peclet": SPEEDS[speed], "contact_seconds": solve}
    timings["kernels"] = seconds(kernels) / solve
    for name, scene in (("alike", hot), ("unlike", unlike)):
        model = Model(scene)
        timings[name] = seconds(lambda model=model: temperatures_of(model, contact)) / solve
    answering = equilibrium(Model(warm))
    timings["slips"] = 1.0 - answering.stick_fraction
    timings["hottest"] = answering.heat.temperature_max
    timings["answering"] = answering.cost.applications / contact.cost.applications
    return timings


STEEL = {"conductivity": 50.0, "density": 7850.0, "heat_capacity": 450.0}
SPEED, SLIDES, DX = 30e3, 0.03333, 0.2
"""Rolling speed, mm/s, creepage, and element size in x, mm, of CONTACT's example."""

PRINTED = (
    ("mu falls with T", [[0.0, 1.0], [400.0, 0.4]], 0.0, 0.8660, 137.5),
    ("mu rises with T", [[0.0, 1.0], [400.0, 1.6]], 0.0, 1.178, 208.9),
    ("mu falls with T, with memory", [[100.0, 1.0], [130.0, 0.4]], 1e-4, 0.8833, 128.9),
)
"""Case, factors over temperature, memory, mm, and CONTACT's F_x/(mu P) and largest temperature."""


def example(factors: list, memory: float) -> ts.Scene:
    """Return the scene of CONTACT's example: steel bodies that slide throughout the contact."""
    body = {"shear": 82e3, "poisson": 0.28, "thermal": STEEL}
    curvatures = 0.001015, 0.0004215  # 1/mm, of B1 x^2 + B2 y^2
    radius_x, radius_y = (0.5 / curvature for curvature in curvatures)
    return ts.Scene(
        body={
            "A": body | {"radius_x": radius_x, "radius_y": radius_y},
            "B": body | {"radius_x": np.inf, "radius_y": np.inf},
        },
        load={"normal": 1e5},
        creepage={"longitudinal": -SLIDES, "speed": SPEED},
        friction={"mu": 0.3, "temperature": factors, "memory": memory},
        heat={"bulk": 0.0},
        grid={"half_length": (21.6, 11.25), "elements": (216, 45), "centre": (13.7, 0.0)},
        solver={"slip": "upwind"},
    )


def march(contact: ts.State, doubled: float, kept: float | None = None) -> tuple[float, float]:
    """Return F_x/(mu P) and the largest temperature by a march along each row of elements.

    Each row conducts heat downwards only. The heat of an element in itself counts `doubled` times;
    `kept` is the part of the friction ahead that remains in an element, by default by the sliding.
    """
    friction, thermal = contact.scene.friction, contact.scene.thermal["A"]
    degrees, factors = np.transpose(friction.temperature)
    roots = np.sqrt(np.maximum(np.arange(-0.5, contact.pressure.shape[0]), 0.0))
    own = np.diff(roots)
    own[0] *= doubled
    effusivity = thermal.conductivity / np.sqrt(thermal.diffusivity)
    slip = np.hypot(*contact.slip)[::-1]
    flux = SPEED * slip * contact.pressure[::-1]
    rise = flux * np.sqrt(DX / (np.pi * SPEED)) / effusivity
    force = hottest = 0.0
    for pressure, slid, warm in zip(contact.pressure[::-1].T, slip.T * DX, rise.T, strict=True):
        ratio, ratios = 0.3, np.zeros(pressure.size)
        for i in np.flatnonzero(pressure):
            keep = 1.0 / (1.0 + slid[i] / friction.memory) if kept is None else kept
            ahead, before = ratio, (ratios * warm)[:i] @ own[i:0:-1]
            for _ in range(200):  # a contraction, by the heat of the element itself
                now = before + ratio * warm[i] * own[0]
                target = 0.3 * np.interp(now, degrees, factors)
                ratio = 0.5 * (ratio + keep * ahead + (1.0 - keep) * target)
            ratios[i], hottest = ratio, max(hottest, now)
        force += ratios @ pressure * contact.grid.element_area
    return force / (0.3 * contact.P), hottest


def compare() -> list[dict]:
    """Return forces and temperatures of CONTACT's example: here, by the march, and as printed."""
    exact = operators.heat.temperature_coefficients

    def doubled(x: np.ndarray, y: np.ndarray, *given: float) -> np.ndarray:
        table = exact(x, y, *given)
        table[np.argmin(np.abs(x)), np.argmin(np.abs(y))] *= 2.0
        return table

    rows = []
    for case, factors, memory, force, hottest in PRINTED:
        contact = ts.solve(example(factors, memory))
        line = {"case": case, "force": contact.Qx / (0.3 * contact.P)}
        line["hottest"] = contact.heat.temperature_max
        if memory:
            line["march_force"], line["march_hottest"] = march(contact, 1.0)
        surface_heat.cache_clear()
        # CONTACT's memory changes by MEM_S0 = 1 mm/s: over a thousandth of the sliding distance.
        lasting = 1e3 * memory * (SLIDES * SPEED / 1e3)
        with mock.patch.object(operators.heat, "temperature_coefficients", doubled):
            changed = ts.solve(example(factors, lasting))
        line["changed_force"] = changed.Qx / (0.3 * changed.P)
        line["changed_hottest"] = changed.heat.temperature_max
        if memory:
            kept = memory / (memory + DX / SPEED * 1.0)
            line["changed_force"], line["changed_hottest"] = march(changed, 2.0, kept)
        surface_heat.cache_clear()
        rows.append(line | {"contact_force": force, "contact_hottest": hottest})
    keys = dict.fromkeys(key for line in rows for key in line)
    return [{key: line.get(key, "") for key in keys} for line in rows]


def main() -> None:
    """Print and write the costs for all meshes and speeds, and the comparison with CONTACT."""
    rows = compare()
    show("F_x/(mu P) and largest temperature of CONTACT's examples", rows)
    print(write("heat_contact", rows))
    if "contact" in sys.argv:
        return
    rows = [row(elements, speed) for speed in SPEEDS for elements in ELEMENTS]
    show("Times relative to the contact; applications if friction depends on temperature", rows)
    print(write("heat", rows))


if __name__ == "__main__":
    main()
