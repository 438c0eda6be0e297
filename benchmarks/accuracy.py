"""Error of Q_x against time on the scene `spheres`, for every method over meshes.

Each method is stopped at a ladder of residuals on each mesh. The reference is the value at h = 0
that benchmarks/validation.py extrapolates from 33 meshes; its own uncertainty is shaded.
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

REFERENCE, UNCERTAINTY = 0.6458, 0.0003
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
    "newton": (newton_to, (31, 61, 91, 181, 361)),
    "anderson": (anderson_to, (31, 61, 91, 181)),
    "uzawa": (uzawa_to, (31, 61, 91)),
}
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-6)


def main():
    rows = []
    for method, (solve, meshes) in RUNS.items():
        for n in meshes:
            problem = problem_on(n)
            by_newton(problem)
            for tolerance in TOLERANCES:
                outcome = solve(problem, tolerance)
                took = seconds(lambda s=solve, p=problem, t=tolerance: s(p, t), budget=1.0)
                q = outcome.traction[0].sum() / problem.bound.sum()
                rows.append(
                    {
                        "method": method,
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
    figure = Figure(figsize=(6.4, 4.2), layout="constrained")
    axes = figure.subplots()
    for (method, (_, meshes)), color in zip(RUNS.items(), ("C0", "C1", "C3"), strict=True):
        for n in meshes:
            mine = [r for r in rows if r["method"] == method and r["n"] == n]
            label = method if n == meshes[0] else None
            axes.loglog(
                [r["seconds"] for r in mine],
                [r["error"] for r in mine],
                "o-",
                color=color,
                ms=4,
                lw=1,
                label=label,
            )
            axes.annotate(
                f"{n}²",
                (mine[-1]["seconds"], mine[-1]["error"]),
                fontsize=7,
                xytext=(3, 3),
                textcoords="offset points",
                color=color,
            )
    axes.loglog(
        [t for t, _ in CONTACT.values()],
        [abs(q / REFERENCE - 1) for _, q in CONTACT.values()],
        "k^:",
        label="CONTACT (91², 181², 361²)",
    )
    axes.axhspan(1e-5, UNCERTAINTY / REFERENCE, color="0.9", zorder=0)
    axes.text(
        axes.get_xlim()[0] * 1.2,
        UNCERTAINTY / REFERENCE * 0.6,
        "uncertainty of the reference",
        fontsize=8,
        color="0.4",
        va="top",
    )
    axes.set(xlabel="seconds, one thread", ylabel=r"relative error of $Q_x$", ylim=(1e-4, 1))
    axes.grid(alpha=0.3, which="both")
    axes.legend()
    path = RESULTS / "accuracy.png"
    figure.savefig(path, dpi=150)
    return path


if __name__ == "__main__":
    main()
