"""Convergence of peak values: recorded values and other evaluations.

- Cylinders at rest (Hertz) with different pressure elements: constant ones, as in the package;
  bilinear ones; and constant ones, with the outermost elements cut at the contact edge.
- Spheres in full slip: stress at the trailing edge (Hamilton 1983), at the element centres, between
  them, and extrapolated to the edge.
- Cylinders in partial slip (Carter 1926): the largest stress of body B, which occurs at the stick
  edge.
- Cylinders in partial slip: the largest traction, of an element and extrapolated to the stick edge,
  at which the traction reaches its bound; and the stick fraction, from a count of elements and from
  the extrapolated edge.
- The peak Hertzian pressure, of an element and by parabolas through its neighbours or through their
  squares, for several positions of the contact centre within an element.
- Worn discs from N = 2,500 to 15,000: the scatter of the pressure about a smooth course and the
  error of this course; of an element, by parabolas, as a mean of three rows at the edge, and
  extrapolated to the edge from eight rows inside.

Errors are relative. They are the largest errors for several positions of the edge or of the centre
within an element. For the discs, they are the largest distance from the smooth course and the
change of its mean to the finest mesh.

Page: docs/validation.md
"""

from itertools import product

import numpy as np
from discs import discs, timed
from timing import show, write

import tractive_sam as ts
from tractive_sam.contact import Model, equilibrium
from tractive_sam.mechanics.criteria import von_mises
from tractive_sam.operators import Lattice, surface_stress
from tractive_sam.reference import (
    circle_pressure_stress,
    circle_shear_stress,
    line_pressure_stress,
    line_shear_stress,
)
from tractive_sam.results import State
from tractive_sam.results.state import distance_to_edge, distances_to_edges
from tractive_sam.run import read_measured_gap
from tractive_sam.subsurface import stress_maximum, stress_volume
from tractive_sam.subsurface.sources import SIGNS
from tractive_sam.subsurface.stress_fields import LoadedBodies

ACROSS = (16, 24, 32, 48, 64, 96)
SHIFTS = (0.0, 0.3, 0.6)
"""Factors by which the contact is wider, so that its edge moves within the elements."""

MESHES = ((21, 61), (29, 85), (41, 121))
WORN = 2500


def on_mesh(scene: ts.Scene, across: float, odd: bool = True) -> State:
    """Return the contact with a number of elements across, on a mesh with an odd or even number."""
    hertz = scene.hertz
    elements = 2 * int(across / 2 + 3) + odd
    half_length = hertz.a * elements / across
    if scene.line:
        grid = {"grid.half_length": half_length, "grid.elements": elements}
    else:
        grid = {"grid.half_length": [half_length] * 2, "grid.elements": [elements] * 2}
    scene = scene.replace(**grid)
    return equilibrium(Model(scene, read_measured_gap(scene)))


def surfaces(contact: State, body: str) -> dict[str, float]:
    """Return the largest stress at a surface by each evaluation."""
    ((_, at_centres),) = stress_volume(contact, [0.0], body)
    load, grid = LoadedBodies.from_contact(contact, (body,)), contact.grid
    lattice, loaded_body = Lattice(grid.elements, grid.dx, grid.dy), load.bodies[0]
    (stress,) = surface_stress(lattice, loaded_body, load.tractions, (SIGNS[body],))
    between = von_mises(stress)
    touching = contact.touching[1:] & contact.touching[:-1]
    if not grid.line:
        touching = touching[:, 1:] & touching[:, :-1]
    return {
        "element centres": float(von_mises(at_centres).max()),
        "between elements": float(between[touching].max()),
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
    # Carter: the shear of full slip minus an ellipse over the stick zone at the leading edge; the
    # ellipse is scaled equally in length and height.
    share = 1.0 - abs(scene.creepage.longitudinal) * hertz.radius / (mu * hertz.a)
    x = np.concatenate((np.linspace(-1.0, 1.0, 40001), [1.0 - 2.0 * share]))
    stress = line_pressure_stress(x, 0.0 * x, 1.0, 1.0, nu)
    stress -= line_shear_stress(x, 0.0 * x, 1.0, mu, nu)
    stress += line_shear_stress(x - (1.0 - share), 0.0 * x, share, mu * share, nu)
    return compared("cylinders, partial slip", scene, "B", float(von_mises(stress).max()))


def compared(case: str, scene: ts.Scene, body: str, truth: float) -> list[dict]:
    """Return a row for every mesh and evaluation: the largest error of slightly wider contacts."""
    rows = []
    for across in ACROSS:
        contacts = [on_mesh(scene, across + shift) for shift in SHIFTS]
        surfaces_by_mesh = [surfaces(contact, body) for contact in contacts]
        for estimate in surfaces_by_mesh[0]:
            errors = [
                estimates[estimate] / scene.hertz.p0 / truth - 1.0 for estimates in surfaces_by_mesh
            ]
            rows.append(row(case, "von Mises, surface", estimate, across, max(errors, key=abs)))
    return rows


def row(case: str, quantity: str, estimate: str, across: int, error: float) -> dict:
    return {
        "case": case,
        "quantity": quantity,
        "estimate": estimate,
        "across": across,
        "error": error,
    }


def largest_traction() -> list[dict]:
    """Evaluate Carter's cylinders at an eighth to a half of the creepage of full slip."""
    scene, rows = ts.Scene.builtin("cylinders"), []
    hertz, mu = scene.hertz, scene.friction.mu[0]
    for across in ACROSS:
        errors = {}
        for share in (0.125, 0.25, 0.375, 0.5):
            creepage = -share * mu * hertz.a / hertz.radius
            end = 1.0 - 2.0 * (1.0 - share)  # of stick, over a
            truth = mu * hertz.p0 * np.sqrt(1.0 - end**2)
            for shift in SHIFTS:
                contact = on_mesh(
                    scene.replace(**{"creepage.longitudinal": creepage}), across + shift
                )
                for estimate, value in of_traction(contact, mu).items():
                    relative_errors = errors.setdefault(("largest traction", estimate), [])
                    relative_errors.append(value / truth - 1.0)
                counted = np.count_nonzero(contact.sticking) / np.count_nonzero(contact.touching)
                for estimate, value in (
                    ("element count", counted),
                    ("recorded", contact.stick_fraction),
                ):
                    errors.setdefault(("stick fraction", estimate), []).append(
                        value / (1.0 - share) - 1.0
                    )
        rows += [
            row(
                "cylinders, partial slip", quantity, estimate, across, max(relative_errors, key=abs)
            )
            for (quantity, estimate), relative_errors in errors.items()
        ]
    return rows


def of_traction(contact: State, mu: float) -> dict[str, float]:
    """Return the largest traction of a line that sticks at its leading edge, by each evaluation."""
    p, q = contact.pressure[:, 0], np.abs(contact.traction[0, :, 0])
    lacks = np.where(contact.sticking[:, 0], np.maximum(mu * p - q, 0.0), 0.0)
    before = distance_to_edge(lacks[::-1, None])[::-1, 0]
    first = np.flatnonzero(np.isfinite(before))[0]
    end = first - before[first]  # in elements
    touching = np.flatnonzero(p > 0.0)
    near = touching[np.argsort(np.abs(touching - end))[:3]]
    square = np.polynomial.Polynomial.fit(near, p[near] ** 2, 2)(end)
    return {"element": q.max(), "extrapolated to the stick edge": mu * np.sqrt(max(square, 0.0))}


def hertz_peak() -> list[dict]:
    """Evaluate the peak pressure for several positions of the contact centre within an element."""
    scene = ts.Scene.builtin("spheres").with_set(["creepage.longitudinal=0"])
    radius, p0, rows = scene.body.radii[0], scene.hertz.p0, []
    for across in ACROSS:
        errors: dict[str, list[float]] = {}
        side = 2.0 * scene.hertz.a / across
        wide = side * (across / 2 + 4)
        for x, y in ((0.0, 0.0), (0.25, 0.0), (0.25, 0.25), (0.5, 0.0), (0.5, 0.5)):
            ends = np.array([-wide, wide])
            lean = -(x * ends[:, None] + y * ends[None, :]) * side / radius
            gap = ts.Gap(x=ends, y=ends, separation=lean - lean.min())
            contact = on_mesh(scene.replace(gap=gap), across)
            for estimate, of in (
                ("element (recorded)", np.max),
                ("parabolas", top),
                ("parabolas of squares", roots),
            ):
                errors.setdefault(estimate, []).append(of(contact.pressure) / p0 - 1.0)
        for estimate, relative_errors in errors.items():
            rows.append(
                row("spheres, Hertz", "p_max", estimate, across, max(relative_errors, key=abs))
            )
    return rows


def top(p: np.ndarray) -> float:
    """Return the maximum of parabolas in x and y through the largest value and its neighbours."""
    i, j = np.unravel_index(np.argmax(p), p.shape)
    value = p[i, j]
    for before, after in ((p[i - 1, j], p[i + 1, j]), (p[i, j - 1], p[i, j + 1])):
        bend = before - 2.0 * p[i, j] + after
        if bend < 0.0:
            value -= (after - before) ** 2 / (8.0 * bend)
    return float(value)


def roots(p: np.ndarray) -> float:
    """Return the maximum of parabolas through the squares, which are exact in Hertzian contacts."""
    return top(p**2) ** 0.5


def three_rows(p: np.ndarray) -> float:
    """Return the largest mean of three rows of elements."""
    return float(((p[:, :-2] + p[:, 1:-1] + p[:, 2:]) / 3.0).max())


def to_the_rim(p: np.ndarray) -> float:
    """Extrapolate linearly to the edge through eight rows, without the two outermost rows."""
    course = p.max(axis=0)
    rows = np.flatnonzero(course > 0.0)
    steps = np.arange(2.0, 10.0)
    lines = (
        np.polynomial.Polynomial.fit(steps, course[end[2:10]], 1) for end in (rows, rows[::-1])
    )
    return float(max(course[rows[2:-2]].max(), *(line(-0.5) for line in lines)))


def worn_discs() -> list[dict]:
    """Return the course of the pressure at the edge, and of `p_95`, for several meshes."""
    late = list(range(WORN, 15001, 500))
    estimates = {
        ("p_max", "element (recorded)"): lambda state: state.p_max,
        ("p_max", "parabolas"): lambda state: top(state.pressure),
        ("p_max", "three rows"): lambda state: three_rows(state.pressure),
        ("p_max", "extrapolated to the edge"): lambda state: to_the_rim(state.pressure),
        ("p_95", "recorded"): lambda state: state.p_95,
    }
    courses: dict[tuple[str, str], dict] = {estimate: {} for estimate in estimates}
    for mesh in MESHES:
        scene = discs(15000, f"grid.elements={list(mesh)}").replace(**{"wear.save": late})
        history, _ = timed(scene)
        states = [history.state(revolution) for revolution in late]
        for estimate, of in estimates.items():
            courses[estimate][mesh] = np.array([of(state) for state in states])
    rows, over = [], np.log(late)
    for (quantity, estimate), course in courses.items():
        smooth = {
            mesh: np.polynomial.Polynomial.fit(over, values, 4)(over)
            for mesh, values in course.items()
        }
        for mesh, values in course.items():
            zigzag = float(np.abs(values / smooth[mesh] - 1.0).max())
            error = float((smooth[mesh] / smooth[MESHES[-1]] - 1.0).mean())
            rows.append(row("worn discs, scatter", quantity, estimate, mesh[0], zigzag))
            rows.append(
                row("worn discs, relative to the finest mesh", quantity, estimate, mesh[0], error)
            )
    return rows


def elements_of_pressure() -> list[dict]:
    """Solve Hertz's line contact with a = p0 = 1 by other elements, with a dense matrix."""
    rows = []
    for across in ACROSS:
        errors: dict[tuple[str, str], list[float]] = {}
        for shift, middle in product(SHIFTS, (0.0, 0.2, 0.4)):
            side = 2.0 / (across + shift)
            count = int(across / 2 + 3)
            x = (np.arange(-count, count + 1) + middle) * side
            t = x[:, None] - x
            constant = _integral(t - side / 2) - _integral(t + side / 2)
            hats = (2.0 * _twice(t) - _twice(t - side) - _twice(t + side)) / side
            sides = np.full(x.size, side)
            plain = _line_contact(constant, x, sides)
            pressures = {"constant": plain, "bilinear": _line_contact(hats, x, sides)}
            ahead, behind = distances_to_edges(plain[:, None])
            touching = np.flatnonzero(plain > 0.0)
            ends = (
                x[touching[0]] - side * behind[touching[0], 0],
                (x[touching[-1]] + side * ahead[touching[-1], 0]),
            )
            low, high = np.maximum(x - side / 2, ends[0]), np.minimum(x + side / 2, ends[1])
            remaining = high - low > 1e-9
            low, high = low[remaining], high[remaining]
            cut, at = np.zeros(x.size), (low + high) / 2
            matrix = _integral(at[:, None] - high) - _integral(at[:, None] - low)
            cut[remaining] = _line_contact(matrix, at, high - low)
            pressures["cut at the contact edge"] = cut
            for kind, p in pressures.items():
                k = int(np.argmax(p))
                parabola = p[k] - (p[k + 1] - p[k - 1]) ** 2 / 8 / (p[k - 1] - 2 * p[k] + p[k + 1])
                errors.setdefault((kind, "element"), []).append(p[k] - 1.0)
                errors.setdefault((kind, "parabola"), []).append(parabola - 1.0)
        rows += [
            row(
                "cylinders, Hertz",
                "p_max",
                f"{kind}, {estimate}",
                across,
                max(relative_errors, key=abs),
            )
            for (kind, estimate), relative_errors in errors.items()
        ]
    return rows


def _integral(t: np.ndarray) -> np.ndarray:
    """Return the integral of the logarithm over pi, for the displacement of an element."""
    return (t * np.log(np.abs(np.where(t == 0.0, 1.0, t))) - t) / np.pi


def _twice(t: np.ndarray) -> np.ndarray:
    """Return the second integral of the logarithm over pi, for the displacement of a hat."""
    return (t**2 / 2.0 * np.log(np.abs(np.where(t == 0.0, 1.0, t))) - 0.75 * t**2) / np.pi


def _line_contact(matrix: np.ndarray, x: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Return the pressures of a parabola x²/2 with an approach of pi/2, for a = p0 = 1."""
    touching = np.abs(x) < 1.2
    while True:
        k = np.flatnonzero(touching)
        system = np.block([[matrix[np.ix_(k, k)], -np.ones((k.size, 1))], [weights[k], 0.0]])
        *inside, approach = np.linalg.solve(system, np.append(-(x[k] ** 2) / 2, np.pi / 2))
        p = np.zeros(x.size)
        p[k] = inside
        gap = matrix @ p + x**2 / 2 - approach
        updated = (p > 0.0) | (~touching & (gap < 0.0))
        if (updated == touching).all():
            return p
        touching = updated


def main():
    rows = [
        *elements_of_pressure(),
        *hertz_peak(),
        *largest_traction(),
        *rolling_cylinders(),
        *sliding_spheres(),
        *worn_discs(),
    ]
    table = []
    for case, quantity, estimate in dict.fromkeys(
        (r["case"], r["quantity"], r["estimate"]) for r in rows
    ):
        selected = [
            r
            for r in rows
            if (r["case"], r["quantity"], r["estimate"]) == (case, quantity, estimate)
        ]
        line = {"case": case, "quantity": quantity, "estimate": estimate, "order": ""}
        errors = np.abs([r["error"] for r in selected])
        if case not in ("worn discs, scatter", "worn discs, relative to the finest mesh"):
            slope = np.polyfit(np.log([r["across"] for r in selected]), np.log(errors), 1)[0]
            line["order"] = float(-slope)
        table.append(line | {f"{k + 1}": r["error"] for k, r in enumerate(selected)})
    columns = list(max(table, key=len))
    show(
        f"Errors; columns: {ACROSS} elements across, for the discs {MESHES}",
        [{column: line.get(column, "") for column in columns} for line in table],
    )
    print(f"written: {write('peaks', rows)}")


if __name__ == "__main__":
    main()
