"""Error of Q_x against time on the scene `spheres`, for every method over meshes.

Each method is stopped at a ladder of residuals on each mesh. The reference is the value at h = 0
that benchmarks/validation.py extrapolates from 33 meshes; its own uncertainty is shaded. Uzawa's
method takes the upwind slip as in the paper, Newton's both.
"""

import numpy as np
from matplotlib.figure import Figure
from solvers import by_newton, problem_on
from timing import RESULTS, seconds, show, write

from tractive_sam.solvers.anderson import anderson
from tractive_sam.solvers.fixed_point import ANDERSON_STEP, UZAWA_STEP, TangentialMap
from tractive_sam.solvers.nested import nested_tangential
from tractive_sam.solvers.newton import newton
from tractive_sam.solvers.uzawa import uzawa

REFERENCE, UNCERTAINTY = 0.64585, 0.00001
"""Qx/muP at h = 0, as printed by benchmarks/validation.py."""
CONTACT = {91: (0.6, 0.6505), 181: (5.4, 0.6479), 361: (48.0, 0.6469)}
"""Seconds and Qx/muP of the Fortran program CONTACT."""


def newton_to(problem, tolerance):
    return nested_tangential(problem, tolerance, newton)


def anderson_to(problem, tolerance):
    start = np.zeros_like(problem.rigid)
    return anderson(TangentialMap(problem, ANDERSON_STEP), tolerance, start)


def uzawa_to(problem, tolerance):
    return uzawa(TangentialMap(problem, UZAWA_STEP), tolerance, np.zeros_like(problem.rigid))


RUNS = {
    "newton": (newton_to, "auto", (31, 61, 91, 181, 361)),
    "newton, upwind": (newton_to, "upwind", (31, 61, 91, 181, 361)),
    "anderson": (anderson_to, "auto", (31, 61, 91, 181)),
    "uzawa": (uzawa_to, "upwind", (31, 61, 91)),
}
TOLERANCES = (1e-3, 1e-4, 1e-6, 1e-8)
ENOUGH = 1e-4
"""Residual below which the error is that of the mesh."""


def main():
    rows = []
    for method, (solve, slip, meshes) in RUNS.items():
        for n in meshes:
            problem = problem_on(n, slip)
            by_newton(problem)
            for tolerance in TOLERANCES:
                outcome = solve(problem, tolerance)
                took = seconds(lambda s=solve, p=problem, t=tolerance: s(p, t), budget=1.0)
                q = outcome.traction[0].sum() / problem.bound.sum()
                rows.append(
                    {
                        "method": method,
                        "slip": slip,
                        "n": n,
                        "tolerance": tolerance,
                        "applications": round(outcome.cost.applications, 1),
                        "seconds": took,
                        "Qx/muP": q,
                        "error": abs(q / REFERENCE - 1),
                    }
                )
    show("Error of Q_x against time on `spheres`", rows)
    print(f"written: {write('accuracy', rows)}, {draw(rows)}")


def draw(rows):
    figure = Figure(figsize=(6.4, 4.0), layout="constrained")
    axes = figure.subplots()
    for method, color in zip(RUNS, ("C0", "C2", "C1", "C3"), strict=True):
        mine = [r for r in rows if r["method"] == method]
        axes.loglog(
            [r["seconds"] for r in mine], [r["error"] for r in mine], ".", color=color, alpha=0.35
        )
        enough = [r for r in mine if r["tolerance"] == ENOUGH]
        axes.loglog(
            [r["seconds"] for r in enough],
            [r["error"] for r in enough],
            "o-",
            color=color,
            label=f"{method}, to {ENOUGH:g}",
        )
        for r in enough:
            at = (r["seconds"], r["error"])
            axes.annotate(
                f"{r['n']}²", at, (4, 4), textcoords="offset points", fontsize=8, color=color
            )
    axes.loglog(
        [t for t, _ in CONTACT.values()],
        [abs(q / REFERENCE - 1) for _, q in CONTACT.values()],
        "k^:",
        label="CONTACT, 91², 181², 361²",
    )
    axes.axhspan(1e-6, UNCERTAINTY / REFERENCE, color="0.92", zorder=0)
    axes.text(
        2e-3, 0.9 * UNCERTAINTY / REFERENCE, "uncertainty of the reference", fontsize=8, va="top"
    )
    axes.set(xlabel="seconds, one thread", ylabel=r"relative error of $Q_x$", ylim=(1e-5, 4e-2))
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    path = RESULTS / "accuracy.png"
    figure.savefig(path, dpi=150)
    return path


if __name__ == "__main__":
    main()
