"""Cost of the flash temperature relative to its contact, all in one run.

The scene is the fast discs, which mostly slide. Times are for one core, relative to the solution of
the contact without an initial guess to the tolerance of the scene. They are given for the heat
partition between equal and different bodies, and for the tables of coefficients, which the first
contact on a mesh at a speed requires. For friction that depends on temperature, the number of
operator applications is given relative to constant friction.

    python benchmarks/heat.py

Page: docs/theory/heat.md
"""

from timing import seconds, show, write

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


def main() -> None:
    """Print and write the costs for all meshes and speeds."""
    rows = [row(elements, speed) for speed in SPEEDS for elements in ELEMENTS]
    show("Times relative to the contact; applications if friction depends on temperature", rows)
    print(write("heat", rows))


if __name__ == "__main__":
    main()
