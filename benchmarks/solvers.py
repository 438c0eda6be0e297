"""What each method costs on the tangential problem of the scene `spheres`, over meshes.

All start cold from the same pressure and stop at a residual of 1e-8; Uzawa's method takes the
upwind slip as in the paper, Newton's both. Newton's method includes its
coarser meshes; their applications count by their share of the elements, and are listed as they are
beside it.
"""

import numpy as np
from matplotlib.figure import Figure
from timing import RESULTS, seconds, show, write

from tractive_sam.contact import Model, equilibrium
from tractive_sam.contact.in_sequence import solve_normal
from tractive_sam.operators.fft import transform
from tractive_sam.scene import Scene
from tractive_sam.solvers.anderson import anderson
from tractive_sam.solvers.fixed_point import ANDERSON_STEP, UZAWA_STEP, TangentialMap
from tractive_sam.solvers.nested import nested_tangential
from tractive_sam.solvers.newton import newton
from tractive_sam.solvers.problem import TangentialProblem
from tractive_sam.solvers.uzawa import uzawa

TOLERANCE = 1e-8
MESHES = (31, 45, 61, 91, 127, 181, 255, 361)
UZAWA_UP_TO = 181
# The Fortran program CONTACT on the same scene and meshes, one core of the same kind.
CONTACT_SECONDS = {91: 0.6, 181: 5.4, 361: 48.0}


def problem_on(n: int, slip: str = "auto") -> TangentialProblem:
    """The tangential problem on n x n elements."""
    scene = Scene.builtin("spheres").with_set(
        [f"grid.elements=[{n}, {n}]", f'solver.slip="{slip}"']
    )
    model = Model(scene)
    normal = solve_normal(model, model.undeformed_gap / model.units.gap, None, 1e-10)
    pressure = normal.pressure
    i = np.flatnonzero(pressure.any(axis=1))
    box = slice(i[0] - 1, i[-1] + 2), slice(i[0], i[-1] + 1)
    half_space = model.half_space_of(pressure[box].shape)
    return TangentialProblem(
        half_space, model.scaled_rigid_slip[:, *box], pressure[box], normal.gap[box]
    )


def by_newton(problem):
    return nested_tangential(problem, TOLERANCE, newton)


def by_newton_cold(problem):
    return newton(problem, TOLERANCE)


def by_anderson(problem):
    return anderson(TangentialMap(problem, ANDERSON_STEP), TOLERANCE, np.zeros_like(problem.rigid))


def by_uzawa(problem):
    return uzawa(TangentialMap(problem, UZAWA_STEP), TOLERANCE, np.zeros_like(problem.rigid))


METHODS = {
    "newton": (by_newton, "auto"),
    "newton, upwind": (by_newton, "upwind"),
    "newton, one mesh": (by_newton_cold, "auto"),
    "anderson": (by_anderson, "auto"),
    "uzawa": (by_uzawa, "upwind"),
}


def raw_applications(problem) -> int:
    """Applications on all meshes of the nested method, each counted as one."""
    spaces, space = [problem.half_space], problem.half_space
    while min(space.mesh.shape) > 24:
        space = space.coarsened
        spaces.append(space)
    before = sum(s.slip.applications for s in spaces)
    by_newton(problem)
    return sum(s.slip.applications for s in spaces) - before


def transform_pair(problem) -> float:
    """Seconds of the bare forward and backward FFT of one application."""
    plan = transform(2, problem.bound.shape, problem.half_space.mesh.padded)
    fields = np.ones(problem.rigid.shape)

    def pair():
        plan.forward(fields)
        plan.backward()

    return seconds(pair, 0.3, 50)


def main():
    rows = []
    for n in MESHES:
        problems = {slip: problem_on(n, slip) for slip in ("auto", "upwind")}
        pair = transform_pair(problems["auto"])
        for name, (solve, slip) in METHODS.items():
            problem = problems[slip]
            if (name == "uzawa" and n > UZAWA_UP_TO) or (name == "newton, one mesh" and n > 181):
                continue
            outcome = solve(problem)
            assert outcome.converged, (name, n, outcome.status)
            cost = outcome.cost
            took = seconds(lambda s=solve, p=problem: s(p))
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
                    "Qx/muP": outcome.traction[0].sum() / problem.bound.sum(),
                }
            )
    show("Tangential problem of `spheres`, cold, to 1e-8", rows)
    newton_rows = [r for r in rows if r["method"] == "newton"]
    growth = np.polyfit(
        np.log([r["n"] for r in newton_rows]), np.log([r["applications"] for r in newton_rows]), 1
    )[0]
    print(f"\nnewton: applications grow like n^{growth:.2f}")
    print(f"written: {write('solvers', rows)}, {draw(rows)}")
    whole_scene()


def whole_scene():
    """A steady solve from scene to contact, normal problem included."""
    rows = []
    for n in (91, 181, 361):
        scene = Scene.builtin("spheres").with_set([f"grid.elements=[{n}, {n}]"])
        model = Model(scene)
        took = seconds(lambda m=model: equilibrium(m))
        rows.append({"n": n, "seconds": took, "CONTACT/this": CONTACT_SECONDS[n] / took})
    show("Normal and tangential problem together", rows)


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
    main()
