"""Bodies that relax in rolling: errors against solutions of integral equations, cost, hard scenes.

- A cylinder (an integral equation with two unknown edges, by quadrature) and a sphere (dense
  equations on up to 96 x 96 elements, extrapolated) with one term, without friction.
- Two cylinders of polyamide with a tangential force, against CONTACT (`examples/visc_cylindr.inp`
  of its sources; Wang & Knothe, J. Appl. Mech. 60 (1993) 310-317).
- CPU time of solutions of 181 x 181 elements over those of elastic bodies, on a mesh that was used
  before and on new ones: `python benchmarks/relaxation.py cost`.
- CPU time of transients over that of the forecast: `python benchmarks/relaxation.py steps`.
- Random terms on 15 x 15 elements against dense equations, solved by pivots:
  `python benchmarks/relaxation.py hard [NUMBER]`.

Page: docs/theory/elasticity.md
"""

import statistics
import sys
import warnings
from time import process_time

import numpy as np
from timing import seconds, show, write

import tractive_sam as ts
from tractive_sam.contact import Model
from tractive_sam.run.explain import expected_applications, seconds_per_application

# Bodies alike with E* = 1 MPa and R = 100 mm; the loads make the glassy half width 1 mm.
SPEED = 100.0
ROUND = {"young": 1.82, "poisson": 0.3, "radius_x": 200.0, "radius_y": 200.0}
LONG = ROUND | {"radius_y": np.inf}
LINE = ts.Scene(body={"A": LONG, "B": LONG}, load={"normal": np.pi / 400.0})
SPHERE = ts.Scene(body={"A": ROUND, "B": ROUND}, load={"normal": 4.0 / 300.0})

CYLINDERS = (
    (1.0, 0.02, 1.409214, 1.414187, 0.707134, 0.009894),
    (1.0, 0.2, 1.36443, 1.41176, 0.71031, 0.089440),
    (1.0, 1.0, 1.19235, 1.36980, 0.83189, 0.262159),
    (1.0, 5.0, 1.02281, 1.19598, 0.97909, 0.197942),
    (1.0, 50.0, 1.000453, 1.040733, 0.999564, 0.042780),
    (3.0, 0.5, 1.814310, 1.987019, 0.510098, 0.317047),
    (9.0, 1.0, 2.71802, 3.12836, 0.45655, 0.745958),
    (9.0, 5.0, 1.46932, 2.65611, 0.85860, 1.510026),
)
"""f, V tau, half width, leading edge, peak pressure, moment over load; over the glassy values."""

SPHERES = (
    (1.0, 0.02, 1.45, 0.6300, 1.5873, 0.0099),
    (1.0, 0.2, 1.45, 0.6337, 1.5807, 0.0850),
    (1.0, 1.0, 1.5, 0.762, 1.4859, 0.1992),
    (1.0, 5.0, 1.3, 0.931, 1.2253, 0.1084),
    (1.0, 50.0, 1.15, 0.992, 1.0417, 0.0151),
    (3.0, 0.5, 2.2, 0.4117, 2.4714, 0.2842),
    (9.0, 0.2, 2.7, 0.2160, 4.632, 0.1683),
    (9.0, 5.0, 2.2, 0.6735, 3.0722, 0.7460),
)
"""f, V tau, half length of the mesh, peak pressure, approach, moment over load."""

CONTACT = ((0.0, 60.32, 1.378), (0.009, 78.74, 1.365), (0.045, 84.72, 1.152), (2.0, 85.31, 0.9932))
"""tau, s, peak pressure, MPa, and creepage, %, by CONTACT."""


def rolling(scene, terms, half_length, elements, **changes):
    """A scene with terms (f, V tau) of both bodies, on a square mesh."""
    each = [{"ratio": ratio, "time": length / SPEED} for ratio, length in terms]
    count = 1 if scene.line else 2
    grid = {"half_length": (half_length,) * count, "elements": (elements,) * count}
    bodies = {f"body.{body}.relaxation": each for body in "AB"} if terms else {}
    creepage = {"creepage": {"speed": SPEED}} if terms else {}
    return scene.replace(**bodies, grid=grid, **(creepage | changes))


def cylinders():
    for ratio, length, a, lead, pressure, moment in CYLINDERS:
        for n in (64, 128, 256, 512):
            contact = ts.solve(rolling(LINE, [(ratio, length)], 1.05 * lead, n))
            yield {
                "f": ratio,
                "V tau/a": length,
                "elements": n,
                "half width": contact.half_width_x / a - 1.0,
                "pressure": contact.p_max / 0.005 / pressure - 1.0,
                "moment": contact.My / contact.P / moment - 1.0,
            }


def spheres():
    p0 = SPHERE.hertz.p0
    for ratio, length, half, pressure, approach, moment in SPHERES:
        for n in (64, 128):
            contact = ts.solve(rolling(SPHERE, [(ratio, length)], half, n))
            yield {
                "f": ratio,
                "V tau/a": length,
                "elements": n,
                "pressure": contact.p_max / p0 / pressure - 1.0,
                "approach": contact.approach / 0.01 / approach - 1.0,
                "moment": contact.My / contact.P / moment - 1.0,
            }


def polyamide():
    for time, pressure, creepage in CONTACT:
        body = {"shear": 1143.0, "poisson": 0.4, "radius_x": 100.0, "radius_y": np.inf}
        if time:
            body["relaxation"] = [{"ratio": 1.0, "time": time}]
        else:  # relaxed at once
            body["shear"] = 571.5
        scene = ts.Scene(
            body={"A": body, "B": body},
            load={"normal": 600.0, "force_x": 108.0},
            creepage={"speed": 1000.0},
            friction={"mu": 0.3},
            grid={"half_length": (7.92,), "elements": (99,)},
        )
        contact = ts.solve(scene)
        yield {
            "tau, s": time,
            "p_max": contact.p_max,
            "p_max, CONTACT": pressure,
            "creepage": -100.0 * contact.xi_x,
            "creepage, CONTACT": creepage,
        }


def first_seconds(scene, count=5):
    """Return the median CPU time of first solutions on meshes with other lengths of elements."""
    times = []
    for k in range(count):
        longer = scene.grid.half_length[0] * (1.0 + 1e-3 * (k + 1))
        mesh = {"half_length": (longer, scene.grid.half_length[1]), "elements": scene.grid.elements}
        new = scene.replace(grid=mesh)
        began = process_time()
        ts.solve(new)
        times.append(process_time() - began)
    return statistics.median(times)


def cost():
    creepage = {"speed": SPEED, "longitudinal": -5e-4, "lateral": 2e-4}
    moving = {"friction": {"mu": 0.3}, "creepage": creepage}
    for name, changes in (("without friction", {}), ("rolling", moving)):
        plain = rolling(SPHERE, [], 1.15, 181, **changes)
        base, first = seconds(lambda s=plain: ts.solve(s)), first_seconds(plain)
        for terms, half in (
            ([(1.0, 1.0)], 1.5),
            ([(9.0, 5.0)], 2.5),
            ([(1.0, 0.2), (0.5, 1.0), (0.5, 5.0)], 1.7),
        ):
            scene = rolling(SPHERE, terms, half, 181, **changes)
            took = seconds(lambda s=scene: ts.solve(s))
            yield {
                "scene": name,
                "terms": str(terms),
                "s": took,
                "elastic": base,
                "ratio": took / base,
                "first ratio": first_seconds(scene) / first,
            }


def steps(count=30):
    for base, elements in ((SPHERE, 61), (SPHERE, 121), (LINE, 400)):
        for bodies, terms in (
            ("AB", []),
            ("AB", [(1.0, 0.5)]),
            ("B", [(1.0, 0.5)]),
            ("AB", [(1.0, 0.5), (0.5, 5.0), (0.5, 0.1)]),
        ):
            each = [{"ratio": ratio, "time": length / SPEED} for ratio, length in terms]
            scene = rolling(base, [], 2.0, elements, friction={"mu": 0.3})
            load, dx = base.load.normal, 4.0 / elements
            course = {
                "distance": [0.0, count * dx],
                "load.normal": [0.8 * load, load],
                "creepage.longitudinal": [-2e-3, -2e-3],
                "start": "steady",
                "step": dx,
            }
            relaxing = {f"body.{body}.relaxation": each for body in bodies} if terms else {}
            scene = scene.replace(creepage={"speed": SPEED}, transient=course, **relaxing)
            model = Model(scene)
            forecast = expected_applications(model) * seconds_per_application(model)
            began = process_time()
            ts.roll(scene, progress=False)
            yield {
                "contact": "line" if base.line else "point",
                "elements": elements,
                "relaxing": bodies if terms else "none",
                "terms": len(terms),
                "forecast, s": forecast,
                "CPU over forecast": (process_time() - began) / forecast,
            }


def by_pivots(matrix, gap, load):
    """Pressure of an active set without wrong elements: all wrong ones change, at last one."""
    active, fewest, since = gap <= np.sort(gap)[gap.size // 3], gap.size + 1, 0
    while True:
        inner = np.flatnonzero(active)
        rows = np.zeros((inner.size + 1,) * 2)
        rows[:-1, :-1], rows[:-1, -1], rows[-1, :-1] = matrix[np.ix_(inner, inner)], -1.0, 1.0
        *pressure, approach = np.linalg.solve(rows, np.append(-gap[inner], load))
        full = np.zeros(gap.size)
        full[inner] = pressure
        wrong = np.where(active, full, gap + matrix @ full - approach) < -1e-13
        if not wrong.any():
            return full
        since = 0 if wrong.sum() < fewest else since + 1
        fewest = min(fewest, wrong.sum())
        changed = wrong if since < 8 else np.arange(gap.size) == np.flatnonzero(wrong)[-1]
        active = active ^ changed


def hard(number):
    rng = np.random.default_rng(1)
    for k in range(number):
        count = rng.integers(1, 3)
        terms = [(10.0 ** rng.uniform(-2, 2), 10.0 ** rng.uniform(-4, 4)) for _ in range(count)]
        scene = LINE if rng.random() < 0.3 else SPHERE
        soft = 1.0 + sum(ratio for ratio, _ in terms)
        half = soft ** (0.5 if scene.line else 1.0 / 3.0) * rng.uniform(0.6, 1.3) + 0.2
        scene = rolling(scene, terms, half, 15)
        contact, model = ts.solve(scene, throw=False), Model(scene)
        gap = (model.undeformed_gap / model.units.gap).ravel()
        matrix = model.operators.normal.as_matrix().reshape(gap.size, gap.size)
        exact = by_pivots(matrix, gap, model.load)
        error = abs(contact.pressure.ravel() / model.units.pressure - exact).max() / exact.max()
        yield {"k": k, "terms": str(terms), "outcome": contact.status.value, "pressure": error}


def main():
    warnings.simplefilter("ignore", ts.SceneWarning)
    if sys.argv[1:2] == ["hard"]:
        rows = list(hard(int((sys.argv[2:] or ["300"])[0])))
        write("relaxation_hard", rows)
        show("The largest errors", sorted(rows, key=lambda row: -row["pressure"])[:10])
        return
    for name, compute in (
        ("relaxation_line", cylinders),
        ("relaxation_sphere", spheres),
        ("relaxation_contact", polyamide),
        ("relaxation_cost", cost),
        ("relaxation_steps", steps),
    ):
        if sys.argv[1:] in ([], [name.removeprefix("relaxation_")]):
            rows = list(compute())
            show(name, rows)
            write(name, rows)


if __name__ == "__main__":
    main()
