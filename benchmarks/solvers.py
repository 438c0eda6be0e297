"""Cost of each method for the tangential problem of the scene `spheres`, for several meshes.

All methods start without an initial guess, with a given pressure, and stop at a residual of 1e-8.
Uzawa's method uses the upwind slip, as in the paper; Newton's method uses both schemes.
Applications of Newton's method on coarser meshes count in proportion to their elements; they are
also listed without this weight. `steady` measures complete solutions, with the normal problem, and
divides their time by the time of one application of the tangential operator. `growth` repeats this
for other scenes: how does the work grow with the mesh?

    python benchmarks/solvers.py [methods steady growth]

Page: docs/benchmarks.md
"""

import sys

import numpy as np
from matplotlib.figure import Figure
from timing import RESULTS, seconds, show, write

from tractive_sam.compute.fft import transform
from tractive_sam.contact import Model, equilibrium
from tractive_sam.scene import Scene
from tractive_sam.solvers import Anderson, Nested, Problem, Uzawa
from tractive_sam.solvers.ladder import FIXED_PRESSURE, NORMAL
from tractive_sam.solvers.nested import rectangle

TOLERANCE = 1e-8
MESHES = (31, 45, 61, 91, 127, 181, 255, 361)
UZAWA_UP_TO = 181
# The Fortran program CONTACT for this scene and these meshes, on an equal core.
CONTACT_SECONDS = {91: 0.6, 181: 5.4, 361: 48.0}


def problem_on(n: int, slip: str = "auto") -> Problem:
    """Return the tangential problem on n x n elements."""
    scene = Scene.builtin("spheres").with_set(
        [f"grid.elements=[{n}, {n}]", f'solver.slip="{slip}"']
    )
    model = Model(scene)
    problem = model.problem(model.undeformed_gap / model.units.gap)
    normal = NORMAL.solve(problem.normal, 1e-10)
    box = rectangle(normal.pressure > 0.0, problem.operators.lattice)
    return problem.with_pressure(normal.pressure, normal.gap).within(box)


METHODS = {
    "newton": (Nested(FIXED_PRESSURE), "auto"),
    "newton, upwind": (Nested(FIXED_PRESSURE), "upwind"),
    "newton, one mesh": (FIXED_PRESSURE, "auto"),
    "anderson": (Anderson(), "auto"),
    "uzawa": (Uzawa(), "upwind"),
}


def raw_applications(problem) -> int:
    """Return the applications on all meshes of the nested method, without weights."""
    spaces, space = [problem.operators], problem.operators
    while min(space.lattice.shape) > 24:
        space = space.coarsened
        spaces.append(space)
    before = sum(s.slip.applications for s in spaces)
    Nested(FIXED_PRESSURE).solve(problem, TOLERANCE)
    return sum(s.slip.applications for s in spaces) - before


def transform_pair(problem) -> float:
    """Return the seconds of the bare forward and inverse FFT of one application."""
    plan = transform(2, problem.normal.pressure.shape, problem.operators.lattice.padded)
    fields = np.ones(problem.rigid.shape)

    def pair():
        plan.forward(fields)
        plan.backward()

    return seconds(pair, 0.3, 50)


def compare_methods():
    """Measure each method for the tangential problem."""
    rows = []
    for n in MESHES:
        problems = {slip: problem_on(n, slip) for slip in ("auto", "upwind")}
        pair = transform_pair(problems["auto"])
        for name, (solver, slip) in METHODS.items():
            problem = problems[slip]
            if (name == "uzawa" and n > UZAWA_UP_TO) or (name == "newton, one mesh" and n > 181):
                continue
            outcome = solver.solve(problem, TOLERANCE)
            assert outcome.converged, (name, n, outcome.status)
            cost = outcome.cost
            took = seconds(lambda s=solver, p=problem: s.solve(p, TOLERANCE))
            rows.append(
                {
                    "n": n,
                    "method": name,
                    "slip": slip,
                    "applications": round(cost.applications, 1),
                    "on all meshes": raw_applications(problem) if name == "newton" else "",
                    "preconditioner": round(cost.preconditioner, 1),
                    "seconds": took,
                    "over its FFTs": took / (pair * (cost.applications + cost.preconditioner)),
                    "CONTACT/this": CONTACT_SECONDS[n] / took if n in CONTACT_SECONDS else "",
                    "Qx/muP": outcome.traction[0].sum() / problem.normal.pressure.sum(),
                }
            )
    show("Tangential problem of `spheres`, without initial guess, to 1e-8", rows)
    newton_rows = [r for r in rows if r["method"] == "newton"]
    growth = np.polyfit(
        np.log([r["n"] for r in newton_rows]), np.log([r["applications"] for r in newton_rows]), 1
    )[0]
    print(f"\nnewton: applications grow like n^{growth:.2f}")
    print(f"written: {write('solvers', rows)}, {draw(rows)}")


SCENES = {
    "spheres": {},
    "with spin": {"creepage.spin": 0.0005},
    "dissimilar bodies": {"body.B.shear": 3.0},
    "orthotropic friction": {"friction.mu": (0.4, 0.2), "friction.angle": 30.0},
    "falling friction": {
        "friction.mu": None,
        "friction.static": 0.4013,
        "friction.kinetic": 0.3,
        "friction.half_speed": 3.0,
        "friction.law": "exponential",
        "creepage.speed": 1000.0,
    },
}


def measure_solution(n: int, changes: dict) -> dict:
    """Return the work and time of a steady solution on n x n elements of `spheres`, changed."""
    mesh = {"grid.elements": (n, n), "solver.tolerance": TOLERANCE}
    model = Model(Scene.builtin("spheres").replace(**changes, **mesh))
    contact = equilibrium(model)
    assert contact.converged, (n, changes, contact.status)
    operator, fields = model.operators.tangential, np.ones((2, n, n))
    operator(fields)  # plans its transforms
    application = seconds(lambda: operator(fields), 1.0, 50)
    took = seconds(lambda: equilibrium(model))
    return {
        "elements": f"{n} x {n}",
        "applications": contact.cost.applications,
        "preconditioner": contact.cost.preconditioner,
        "convolutions": contact.cost.convolutions,
        "seconds": took,
        "over_application": took / application,
    }


def measure_steady_solves():
    """Measure steady solutions from scene to contact, including the normal problem."""
    rows = []
    for n in (91, 181, 361, 512, 1024):
        row = measure_solution(n, {})
        faster = CONTACT_SECONDS[n] / row["seconds"] if n in CONTACT_SECONDS else ""
        rows.append(row | {"CONTACT/this": faster})
    show("Normal and tangential problem together, to 1e-8", rows)
    print(f"written: {write('solvers_steady', rows)}")


def measure_growth():
    """Measure the same for scenes of several kinds."""
    rows = [
        {"scene": name} | measure_solution(n, changes)
        for name, changes in SCENES.items()
        for n in (45, 91, 181, 361)
    ]
    show("Growth of the work with the mesh, to 1e-8", rows)
    print(f"written: {write('solvers_growth', rows)}")


def draw(rows):
    figure = Figure(figsize=(9, 3.8), layout="constrained")
    work, time = figure.subplots(1, 2)
    for name in METHODS:
        mine = [r for r in rows if r["method"] == name]
        n = [r["n"] for r in mine]
        work.loglog(n, [r["applications"] for r in mine], "o-", label=name)
        time.loglog(n, [r["seconds"] for r in mine], "o-", label=name)
    time.loglog(list(CONTACT_SECONDS), list(CONTACT_SECONDS.values()), "k^:", label="CONTACT")
    work.set(xlabel="elements a side", ylabel="applications of the slip operator")
    time.set(xlabel="elements a side", ylabel="seconds, one thread")
    for axes in (work, time):
        axes.set_xticks(MESHES[::2], [str(n) for n in MESHES[::2]])
        axes.minorticks_off()
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8)
    path = RESULTS / "solvers.png"
    figure.savefig(path, dpi=150)
    return path


if __name__ == "__main__":
    parts = {
        "methods": compare_methods,
        "steady": measure_steady_solves,
        "growth": measure_growth,
    }
    for name in sys.argv[1:] or parts:
        parts[name]()
