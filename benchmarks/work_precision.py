"""Error against work: for every method, slip scheme and mesh, on seven scenes.

The errors are for Q_x, the largest traction, the largest von Mises stress in body A and the wear
depth after 1,000 revolutions. They are given against applications of the elastic operators and
against time. Each reference is the second-order result on the finest mesh. Its uncertainty, shaded
in the figure, is the difference from the upwind results extrapolated from their finest meshes
(linearly in the element size).

    python benchmarks/work_precision.py [--scenes spheres twin-discs]

Page: docs/benchmarks.md
"""

import argparse
import math
import warnings
from functools import cache

import numpy as np
from matplotlib.figure import Figure
from timing import RESULTS, process_time, seconds, show, write

import tractive_sam as ts
from tractive_sam.contact import Model, choose_grid, equilibrium
from tractive_sam.rolling import steps
from tractive_sam.subsurface import stress_maximum

REVOLUTIONS = 1000
RESIDUAL, FINE_RESIDUAL = 1e-5, 1e-7
"""Residual of the contacts, far below the error of any mesh here, and of the references."""

LIMIT_MESHES = (96, 112, 128, 160, 192)
WORN_LIMIT_MESHES = (40, 48, 64)
"""Elements across the contact for the reference and its uncertainty, for contacts and for runs."""

METHODS = {
    # name: solver settings, elements across the contact, and when rolled, and line
    "newton": ({"method": "newton"}, (16, 24, 32, 48, 64, 96), (16, 24, 32), "C0o-"),
    "newton, upwind": (
        {"method": "newton", "slip": "upwind"},
        (16, 24, 32, 48, 64, 96),
        (16, 24, 32),
        "C2s-",
    ),
    "anderson": ({"method": "anderson"}, (16, 24, 32, 48, 64), (16, 24), "C1v--"),
    "anderson, upwind": (
        {"method": "anderson", "slip": "upwind"},
        (16, 24, 32, 48, 64),
        (16, 24),
        "C4^--",
    ),
    "uzawa": ({"method": "uzawa"}, (16, 24), (), "C5<:"),
    "uzawa, upwind (the paper)": (
        {"method": "uzawa", "slip": "upwind"},
        (16, 24, 32, 48),
        (16,),
        "C3>:",
    ),
}

CONTACT = {91: (0.6, 0.6505), 181: (5.4, 0.6479), 361: (48.0, 0.6469)}
"""Seconds and Qx/muP of the Fortran program CONTACT on `spheres` (tests/data/reference.json)."""

QUANTITIES = {
    "Qx": r"$Q_x$",
    "peak traction": "largest traction",
    "von Mises": "largest von Mises stress, A",
    "depth": f"wear depth, N = {REVOLUTIONS}",
}

STEEL = {"young": 208e3, "poisson": 0.3}
WEAR = {"intensity": 2e-6, "revolutions": REVOLUTIONS, "save": (0, REVOLUTIONS)}


def _ellipse() -> ts.Scene:
    """Return an ellipse of a/b = 0.5 with spin and creepage."""
    return ts.Scene(
        title="Spinning ellipse",
        body={
            "A": STEEL | {"radius_x": 30.0, "radius_y": 86.0},
            "B": STEEL | {"radius_x": math.inf, "radius_y": math.inf},
        },
        load={"normal": 300.0},
        creepage={"longitudinal": -0.002, "spin": 0.006},
        friction={"mu": 0.4},
        wear=WEAR,
    )


@cache
def scenes() -> dict[str, ts.Scene]:
    unmeshed = {"grid": None, "subsurface": None}
    discs = ts.Scene.builtin("twin-discs").replace(
        **unmeshed, **{"wear.revolutions": REVOLUTIONS, "wear.save": (0, REVOLUTIONS)}
    )
    spheres = ts.Scene.builtin("spheres").replace(**unmeshed, wear=WEAR | {"intensity": 1e-2})
    dissimilar = _ellipse().replace(
        title="Steel on glass", **{"body.B.young": 70e3, "body.B.poisson": 0.22}
    )
    both = {"longitudinal": -0.001, "lateral": 0.0007}
    # A hundredth and less of the creepage of full slip.
    creeping, spinning = {"longitudinal": -3e-5, "lateral": 1e-5}, {"spin": 3e-5}
    return {
        "spheres": spheres,
        "spinning-ellipse": _ellipse(),
        "dissimilar": dissimilar,
        "dissimilar-combined": dissimilar.replace(title="Steel on glass, x and y", creepage=both),
        "dissimilar-creeping": dissimilar.replace(title="Steel on glass, slow", creepage=creeping),
        "dissimilar-spinning": dissimilar.replace(title="Steel on glass, spin", creepage=spinning),
        "twin-discs": discs,
    }


def solved(scene: ts.Scene, across: int):
    """Solve the unworn bodies with a number of elements across the shorter axis of the contact."""
    steady = scene.replace(wear=None)  # the mesh of a scene without wear is smaller
    return equilibrium(Model(scene, None, choose_grid(steady, finer=across / 64)))


def measured(contact) -> dict[str, float]:
    return {
        "Qx": contact.Qx,
        "peak traction": float(np.hypot(*contact.traction).max()),
        "von Mises": stress_maximum(contact, "A").value,
    }


def rolled(scene: ts.Scene, across: int) -> tuple[float, float, float]:
    """Return the depth after all revolutions, the applications and the seconds."""
    model = Model(scene, None, choose_grid(scene, finer=across / 64))
    began, applications = process_time(), 0.0
    for passage in steps(model):
        applications += passage.contact.cost.applications
    assert passage.revolution == REVOLUTIONS, passage.contact.message
    return float(passage.contact.wear.max()), applications, process_time() - began


def limits(scene: ts.Scene) -> dict[str, tuple[float, float]]:
    """Return value and uncertainty of every quantity, from two slip schemes."""
    best = scene.replace(**{"solver.tolerance": FINE_RESIDUAL, "wear.tolerance": 3e-4})
    upwind = best.replace(**{"solver.slip": "upwind"})
    here = measured(solved(best, LIMIT_MESHES[-1]))
    ladder = [measured(solved(upwind, across)) for across in LIMIT_MESHES]
    by_quantity = {
        name: _with_doubt(value, LIMIT_MESHES, [values[name] for values in ladder])
        for name, value in here.items()
    }
    worn = [rolled(upwind, across)[0] for across in WORN_LIMIT_MESHES]
    depth = rolled(best, WORN_LIMIT_MESHES[-1])[0]
    return by_quantity | {"depth": _with_doubt(depth, WORN_LIMIT_MESHES, worn)}


def _with_doubt(value: float, meshes, upwind: list[float]) -> tuple[float, float]:
    """Return a value and its difference from the linear extrapolation of upwind results."""
    return value, abs(np.polyfit(1.0 / np.array(meshes), upwind, 1)[1] - value)


def rows_of(name: str, scene: ts.Scene) -> list[dict]:
    limits_by_quantity = limits(scene)
    rows = []

    def add(method, across, quantity, value, applications, took):
        limit, uncertain = limits_by_quantity[quantity]
        rows.append(
            {
                "scene": name,
                "method": method,
                "elements across": across,
                "quantity": quantity,
                "value": value,
                "error": abs(value / limit - 1.0),
                "uncertainty": uncertain / abs(limit),
                "applications": round(applications, 1),
                "seconds": took,
            }
        )

    for method, (solver, meshes, worn_meshes, _) in METHODS.items():
        settings = {f"solver.{key}": value for key, value in solver.items()}
        variant = scene.replace(**settings, **{"solver.tolerance": RESIDUAL})
        for across in meshes:
            contact = solved(variant, across)
            if not contact.converged:
                print(f"{name}, {method}, {across}: {contact.message}")
                continue
            took = seconds(lambda s=variant, a=across: solved(s, a), budget=0.3)
            for quantity, value in measured(contact).items():
                add(method, across, quantity, value, contact.cost.applications, took)
        for across in worn_meshes:
            add(method, across, "depth", *rolled(variant, across))
        print(f"{name}: {method} done", flush=True)
    return rows


def draw(name: str, rows: list[dict]):
    figure = Figure(figsize=(13.0, 6.2), layout="constrained")
    axes = figure.subplots(2, len(QUANTITIES), sharey="col")
    for column, (quantity, label) in enumerate(QUANTITIES.items()):
        of = [r for r in rows if r["quantity"] == quantity]
        for row, work in enumerate(("applications", "seconds")):
            panel = axes[row][column]
            for method, (*_, line) in METHODS.items():
                mine = [r for r in of if r["method"] == method]
                work_done = [r[work] for r in mine]
                panel.loglog(work_done, [r["error"] for r in mine], line, label=method, ms=4)
            if quantity == "Qx" and name == "spheres" and work == "seconds":
                limit = next(r["value"] / (1 + r["error"]) for r in of)
                load = scenes()[name].load.normal * scenes()[name].friction.mu[0]
                errors = [abs(q * load / limit - 1) for _, q in CONTACT.values()]
                times = [t for t, _ in CONTACT.values()]
                panel.loglog(times, errors, "k*-", label="CONTACT, 91², 181², 361²")
            panel.axhspan(1e-9, of[0]["uncertainty"], color="0.9", zorder=0)
            low = min([r["error"] for r in of] + [of[0]["uncertainty"]])
            panel.set_ylim(bottom=max(0.5 * low, 1e-7))
            panel.grid(alpha=0.3)
            panel.xaxis.set_minor_formatter("")
            panel.set_xlabel("seconds, one core" if work == "seconds" else "operator applications")
        axes[0][column].set_title(label, fontsize=10)
        axes[0][column].tick_params(labelleft=True)
    for row in axes:
        row[0].set_ylabel("relative error")
    handles, labels = axes[1][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, fontsize=9)
    figure.suptitle(scenes()[name].title or name)
    path = RESULTS / f"work_precision_{name}.png"
    figure.savefig(path, dpi=110)
    return path


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", nargs="+", default=list(scenes()), choices=list(scenes()))
    warnings.simplefilter("ignore", ts.SceneWarning)
    rows = []
    for name in parser.parse_args().scenes:
        scene_rows = rows_of(name, scenes()[name])
        rows += scene_rows
        steady = [r for r in scene_rows if r["quantity"] == "Qx"]
        show(f"Error of Q_x, {name}", steady)
        print(f"written: {write('work_precision', rows)}, {draw(name, scene_rows)}", flush=True)


if __name__ == "__main__":
    main()
