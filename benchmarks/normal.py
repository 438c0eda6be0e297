"""The normal problem of `spheres` over meshes, compared with Tamaas' Polonsky-Keer solver.

Tamaas (pip install .[benchmarks]) solves with its non-periodic operator `dcfft`; its tolerance is
lowered until the natural residual of its pressure, computed here, meets the tolerance of this
package.

Page: docs/benchmarks.md
"""

import numpy as np
from timing import seconds, show, write

from tractive_sam.compute.fft import transform
from tractive_sam.contact import Model
from tractive_sam.scene import Scene
from tractive_sam.solvers import NormalProblem
from tractive_sam.solvers.krylov import natural_residual
from tractive_sam.solvers.ladder import NORMAL

TOLERANCE = 1e-8
MESHES = (91, 128, 181, 256, 361, 512, 1024)
# The Fortran program CONTACT for this scene, on an equal core.
CONTACT_SECONDS = {91: 0.016, 181: 0.066, 361: 0.79}


def problem_on(n: int) -> tuple[Model, NormalProblem]:
    model = Model(Scene.builtin("spheres").with_set([f"grid.elements=[{n}, {n}]"]))
    gap = model.undeformed_gap / model.units.gap
    return model, NormalProblem(model.operators, gap, model.load)


def tamaas_run(model: Model):
    """(seconds, iterations, residual, peak) of Tamaas at the loosest tolerance that meets ours."""
    import tamaas as tm  # noqa: PLC0415

    tm.set_log_level(tm.LogLevel.error)
    grid, material = model.grid, model.scene.material
    size = [2 * h for h in grid.half_length]
    area = size[0] * size[1]
    surface = -model.undeformed_gap
    for tolerance in 10.0 ** -np.arange(6, 15):
        solver_model = tm.ModelFactory.createModel(
            tm.model_type.basic_2d, size, list(grid.elements)
        )
        solver_model.nu = material.poisson
        solver_model.E = material.E_star * (1 - material.poisson**2)
        tm.ModelFactory.registerNonPeriodic(solver_model, "dcfft")

        def run(m=solver_model, t=tolerance):
            solver = tm.PolonskyKeerRey(m, surface, t)
            solver.setIntegralOperator("dcfft")
            m.traction[:] = 0.0
            solver.solve(model.scene.load.normal / area)
            return solver

        run()
        pressure = np.array(solver_model.traction).reshape(grid.elements) / model.units.pressure
        lift = model.operators.normal(pressure[None])[0]
        gap = model.undeformed_gap / model.units.gap + lift
        residual = natural_residual(
            pressure, gap - gap[pressure > 0].mean(), model.operators.lattice
        )
        if residual <= TOLERANCE:
            return seconds(run), residual, pressure.max()
    return None


def main():
    try:
        import tamaas  # noqa: F401, PLC0415

        with_tamaas = True
    except ImportError:
        with_tamaas = False
        print("Tamaas is not installed (pip install .[benchmarks]): its columns stay empty")
    rows = []
    for n in MESHES:
        model, problem = problem_on(n)
        outcome = NORMAL.solve(problem, TOLERANCE)
        assert outcome.converged
        took = seconds(lambda p=problem: NORMAL.solve(p, TOLERANCE))
        plan, fields = transform(1, (n, n), problem.operators.lattice.padded), np.ones((1, n, n))

        def pair(plan=plan, fields=fields):
            plan.forward(fields)
            plan.backward()

        work = outcome.cost.applications + outcome.cost.preconditioner
        row = {
            "n": n,
            "applications": round(outcome.cost.applications, 1),
            "preconditioner": round(outcome.cost.preconditioner, 1),
            "seconds": took,
            "over its FFTs": took / (work * seconds(pair, 0.3, 50)),
            "p_max/p0 - 1": float(outcome.pressure.max()) - 1.0,
            "CONTACT/this": CONTACT_SECONDS[n] / took if n in CONTACT_SECONDS else "",
            "Tamaas seconds": "",
            "Tamaas/this": "",
        }
        if with_tamaas and n <= 1024:
            tamaas_result = tamaas_run(model)
            if tamaas_result is not None:
                row |= {"Tamaas seconds": tamaas_result[0], "Tamaas/this": tamaas_result[0] / took}
        rows.append(row)
    show("Normal problem of `spheres`, without initial guess, to 1e-8", rows)
    print(f"written: {write('normal', rows)}")


if __name__ == "__main__":
    main()
