"""How fast peak values converge, each as it is recorded and by other ways to the same quantity.

- spheres in full slip: stress at the trailing edge (Hamilton 1983): at centres of elements,
  between them, and taken on to the edge;
- cylinders in partial slip (Carter 1926), where the largest stress of body B is where stick ends;
- the peak contact pressure of Hertz, of an element and by a parabola through its neighbours, with
  the middle of the contact on a centre of an element, and on a corner of four;
- worn discs: how far pressures zigzag about a smooth course from N = 2,500 to 15,000.

Errors are relative; for the discs they are the largest distance from the smooth course, and the
change of the last value to the finest mesh.
"""

import numpy as np
from discs import discs, timed
from timing import show, write

import tractive_sam as ts
from tractive_sam.contact import Model, State, equilibrium
from tractive_sam.mechanics.invariants import von_mises
from tractive_sam.operators import Lattice, surface_stress
from tractive_sam.reference import (
    circle_pressure_stress,
    circle_shear_stress,
    line_pressure_stress,
    line_shear_stress,
)
from tractive_sam.subsurface import stress_maximum, stress_volume
from tractive_sam.subsurface.loaded import LoadedBodies

ACROSS = (16, 24, 32, 48, 64, 96)
SHIFTS = (0.0, 0.3, 0.6)
"""By which elements the contact is wider, so that its edge falls elsewhere in them."""

MESHES = ((21, 61), (29, 85), (41, 121))
WORN = 2500


def on_mesh(scene: ts.Scene, across: float, odd: bool = True) -> State:
    """The contact with so many elements across, on a mesh of an odd number of them or not."""
    hertz = scene.hertz
    elements = 2 * int(across / 2 + 3) + odd
    half_length = hertz.a * elements / across
    if scene.line:
        grid = {"grid.half_length": half_length, "grid.elements": elements}
    else:
        grid = {"grid.half_length": [half_length] * 2, "grid.elements": [elements] * 2}
    return equilibrium(Model(scene.replace(**grid)))


def surfaces(contact: State, body: str) -> dict[str, float]:
    """The largest stress at a surface by each way."""
    ((_, at_centres),) = stress_volume(contact, [0.0], body)
    load, grid = LoadedBodies.of(contact, (body,)), contact.grid
    lattice, alone = Lattice(grid.elements, grid.dx, grid.dy), load.bodies[0]
    between = von_mises(surface_stress(lattice, alone, load.tractions[0]))
    touching = contact.touching[1:] & contact.touching[:-1]
    if not grid.line:
        touching = touching[:, 1:] & touching[:, :-1]
    return {
        "centres": float(von_mises(at_centres).max()),
        "between": float(between[touching].max()),
        "recorded": stress_maximum(contact, body).surface,
    }


def sliding_spheres() -> list[dict]:
    scene = ts.Scene.builtin("spheres").with_set(["creepage.longitudinal=-0.1"])
    mu, nu = scene.friction.mu[0], scene.material.poisson
    at = -1.0, 0.0, 0.0
    edge = circle_pressure_stress(*at, 1.0, 1.0, nu) + circle_shear_stress(*at, 1.0, mu, nu)
    return compared("spheres, full slip", scene, "A", float(von_mises(edge)))


def rolling_cylinders() -> list[dict]:
    scene = ts.Scene.builtin("cylinders")
    hertz, mu, nu = scene.hertz, scene.friction.mu[0], scene.material.poisson
    # Carter: the shear of full slip less that of an ellipse over the stick zone, which is at the
    # leading edge and as much smaller as it is lower.
    share = 1.0 - abs(scene.creepage.longitudinal) * hertz.radius / (mu * hertz.a)
    x = np.concatenate((np.linspace(-1.0, 1.0, 40001), [1.0 - 2.0 * share]))
    stress = line_pressure_stress(x, 0.0 * x, 1.0, 1.0, nu)
    stress -= line_shear_stress(x, 0.0 * x, 1.0, mu, nu)
    stress += line_shear_stress(x - (1.0 - share), 0.0 * x, share, mu * share, nu)
    return compared("cylinders, partial slip", scene, "B", float(von_mises(stress).max()))


def compared(case: str, scene: ts.Scene, body: str, truth: float) -> list[dict]:
    """A row for every mesh and way: the largest error of contacts a little wider."""
    rows = []
    for across in ACROSS:
        contacts = [on_mesh(scene, across + shift) for shift in SHIFTS]
        found = [surfaces(contact, body) for contact in contacts]
        for way in found[0]:
            errors = [one[way] / scene.hertz.p0 / truth - 1.0 for one in found]
            rows.append(row(case, "von Mises, surface", way, across, max(errors, key=abs)))
    return rows


def row(case: str, quantity: str, way: str, across: int, error: float) -> dict:
    return {"case": case, "quantity": quantity, "way": way, "across": across, "error": error}


def hertz_peak() -> list[dict]:
    scene = ts.Scene.builtin("spheres").with_set(["creepage.longitudinal=0"])
    rows = []
    for across in ACROSS:
        for odd, middle in ((True, "centre"), (False, "corner")):
            contact = on_mesh(scene, across, odd)
            p0, case = scene.hertz.p0, f"Hertz, middle on a {middle}"
            for way, value in (("element (recorded)", contact.p_max), ("parabola", top(contact))):
                rows.append(row(case, "p_max", way, across, value / p0 - 1.0))
    return rows


def top(contact: State) -> float:
    """The top of parabolas in x and y through the peak contact pressure and its neighbours."""
    p = contact.pressure
    i, j = np.unravel_index(np.argmax(p), p.shape)
    value = p[i, j]
    for before, after in ((p[i - 1, j], p[i + 1, j]), (p[i, j - 1], p[i, j + 1])):
        bend = before - 2.0 * p[i, j] + after
        value -= (after - before) ** 2 / (8.0 * bend)
    return float(value)


def worn_discs() -> list[dict]:
    histories = {mesh: timed(discs(15000, f"grid.elements={list(mesh)}"))[0] for mesh in MESHES}
    finest, rows = histories[MESHES[-1]], []
    for mesh, history in histories.items():
        late = history["revolution"] > WORN
        course = np.log(history["revolution"][late])
        for name in ("p_max", "p_95"):
            values = history[name][late]
            smooth = np.polynomial.Polynomial.fit(course, values, 4)(course)
            case = "worn discs"
            zigzag = float(np.abs(values / smooth - 1.0).max())
            rows.append(row(case, name, "zigzag", mesh[0], zigzag))
            rows.append(
                row(case, name, "last, to the finest", mesh[0], values[-1] / finest[name][-1] - 1.0)
            )
    return rows


def main():
    rows = [*sliding_spheres(), *rolling_cylinders(), *hertz_peak(), *worn_discs()]
    table = []
    for case, quantity, way in dict.fromkeys((r["case"], r["quantity"], r["way"]) for r in rows):
        own = [r for r in rows if (r["case"], r["quantity"], r["way"]) == (case, quantity, way)]
        line = {"case": case, "quantity": quantity, "way": way, "order": ""}
        errors = np.abs([r["error"] for r in own])
        if way not in ("zigzag", "last, to the finest"):
            slope = np.polyfit(np.log([r["across"] for r in own]), np.log(errors), 1)[0]
            line["order"] = float(-slope)
        table.append(line | {f"{k + 1}": r["error"] for k, r in enumerate(own)})
    columns = list(max(table, key=len))
    show(
        f"Errors; columns are {ACROSS} elements across, of the discs {MESHES}",
        [{column: line.get(column, "") for column in columns} for line in table],
    )
    print(f"written: {write('peaks', rows)}")


if __name__ == "__main__":
    main()
