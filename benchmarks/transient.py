"""Transient rolling: convergence, cost and accuracy of the steps.

- `courses`: 200 random courses on a small mesh, of load or approach, creepages or forces, spin,
  friction and profiles, with jumps, separated bodies, shifts, dissimilar bodies and orthotropic
  friction: status and operator applications per step;
- `killed`: 40 of these courses, stopped after a random record and resumed: difference between the
  two histories, divided by the largest value;
- `steps`: applications and convolutions per step on 91 x 91 elements, for several courses;
- `cost`: applications, convolutions and time per step for several meshes, the time divided by the
  time of one application of the tangential operator, and a chart of them;
- `order`: error of Q_x after a step of creepage, for several meshes and step lengths, relative to
  an extrapolation;
- `wear`: wear of a constant course compared with a steady revolution, for several meshes; an
  oscillating ball compared with the closed form, for several meshes and steps.

    python benchmarks/transient.py [courses killed steps cost order wear]

Page: docs/theory/transient.md
"""

import sys
import tempfile
import warnings
from contextlib import suppress
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from timing import RESULTS, seconds, show, write

import tractive_sam as ts
from tractive_sam.contact import Model

SPHERES = ts.Scene.builtin("spheres").replace(subsurface=None, creepage=None)
P, MU, A = SPHERES.normal_load, SPHERES.friction.mu[0], SPHERES.hertz.a
COURSES, KILLED = 200, 40
CONTACT_MILLISECONDS = {45: 11.5, 91: 70.8}
"""Time per step of the Fortran program CONTACT (its method TangCG, to 1e-6), on an equal core."""


def random_scene(seed: int, n: int = 19) -> ts.Scene:  # noqa: PLR0912 - each may be or not
    """Return a scene with random courses."""
    draw = np.random.default_rng(seed)
    changes: dict = {"grid.elements": (n, n), "grid.half_length": (5.0, 5.0)}
    if draw.random() < 0.3:
        changes |= {"friction.mu": (0.4, draw.uniform(0.1, 0.4))}
        changes |= {"friction.angle": draw.uniform(-90.0, 90.0)}
    if draw.random() < 0.3:
        changes["body.B.shear"] = draw.uniform(1.5, 10.0)
    changes["solver.slip"] = "upwind" if draw.random() < 0.2 else "auto"
    table: dict = {"start": str(draw.choice(["rest", "rest", "steady", "shift"]))}
    count = int(draw.integers(2, 5))
    knots = np.cumsum(np.append(0.0, draw.uniform(0.1, 4.0, count - 1)))
    if count > 2 and draw.random() < 0.3:
        knots[2] = knots[1]
        knots[3:] += 0.5
    knots = np.sort(knots)
    if knots[-1] == knots[0]:
        knots[-1] += 1.0
    table["distance"] = knots.tolist()

    def course(low: float, high: float) -> list[float]:
        return draw.uniform(low, high, count).tolist()

    weakest, lightest = min(changes.get("friction.mu", (MU,))), 0.7 * P
    unit = 3e-3 if table["start"] != "shift" else 2e-2
    parts = draw.random() < 0.15
    if parts:
        changes["load"] = {"approach": 0.07}
        table["load.approach"] = [0.07, *draw.uniform(-0.02, 0.09, count - 1).tolist()]
    elif draw.random() < 0.4:
        table["load.normal"] = course(lightest, 1.3 * P)
    if draw.random() < 0.4 and not parts:
        limit = 0.6 * 0.7 * weakest * lightest
        table["load.force_x"] = course(-limit, limit)
    else:
        table["creepage.longitudinal"] = course(-unit, unit)
    if draw.random() < 0.5:
        table["creepage.lateral"] = course(-unit, unit)
    if draw.random() < 0.3 and "load.force_x" not in table:
        table["creepage.spin"] = course(-unit / A, unit / A)
    if draw.random() < 0.3:
        table["friction.mu"] = (
            course(0.7 * 0.4, 0.4) if "friction.mu" in changes else course(0.7 * MU, MU)
        )
    if draw.random() < 0.2:
        x = np.linspace(-6.0, 20.0, 131)
        wave = 1e-3 * np.sin(2.0 * np.pi * x / draw.uniform(3.0, 8.0))
        separation = np.stack((wave, wave), axis=1)
        table["profile.B"] = {"x": x, "y": [-9.0, 9.0], "separation": separation}
    if draw.random() < 0.3:
        changes["wear"] = {"intensity": 10.0 ** draw.uniform(-6.0, -3.0)}
    if draw.random() < 0.4:
        table["stepping"] = "adaptive"
    elif draw.random() < 0.4 and table["start"] != "shift":
        table["step"] = draw.uniform(0.2, 1.5)
    return SPHERES.replace(**changes, transient=table)


def courses() -> None:
    """Compute random courses."""
    rows = []
    for seed in range(COURSES):
        history = ts.roll(random_scene(seed))
        rows.append(
            {
                "seed": seed,
                "status": history.status,
                "steps": len(history),
                "applications": float(np.median(history["operator_applications"])),
                "message": "" if history.status == "done" else history.message,
            }
        )
    write("transient_courses", rows)
    done = [row for row in rows if row["status"] == "done"]
    print(f"{len(done)} of {len(rows)} converged, {sum(row['steps'] for row in rows)} steps")
    if bad := [row for row in rows if row["status"] != "done"]:
        show("not converged", bad)


class KilledError(Exception):
    """Stops a run."""


def killed() -> None:
    """Stop and resume random courses."""
    rows = []
    for seed in range(KILLED):
        scene = random_scene(seed)
        uninterrupted = ts.roll(scene)
        last = int(np.random.default_rng(1000 + seed).integers(1, len(uninterrupted) + 1))
        done = []

        def stop(record: object, done: list = done, last: int = last) -> None:
            done.append(record)
            if len(done) == last:
                raise KilledError

        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "killed.h5"
            with suppress(KilledError):
                ts.roll(scene, path, progress=stop)
            history = ts.roll(scene, path, resume=True)
        apart = 0.0
        same = len(history) == len(uninterrupted)
        for name in ("distance", "P", "Qx", "Qy", "approach", "elastic_energy") if same else ():
            size = np.abs(uninterrupted[name]).max() or 1.0
            if name == "Qy":
                size = max(size, np.abs(uninterrupted["Qx"]).max())
            apart = max(apart, float(np.abs(history[name] - uninterrupted[name]).max() / size))
        rows.append(
            {
                "seed": seed,
                "stopped": last,
                "steps": len(uninterrupted),
                "same": same,
                "apart": apart,
            }
        )
    write("transient_killed", rows)
    print(
        f"{sum(row['same'] for row in rows)} of {len(rows)} identical, "
        f"largest difference {max(row['apart'] for row in rows):.1e}"
    )
    if bad := [row for row in rows if not row["same"] or row["apart"] > 1e-6]:
        show("not identical", bad)


def steps() -> None:
    """Measure applications and convolutions per step on 91 x 91 elements.

    Convolutions include the preconditioners; the counts do not depend on the machine.
    """
    dx, rows = 2.0 * 4.08 / 91, []
    wave = 0.5 * MU * P * np.sin(0.1 * np.pi * np.arange(41))
    x = np.linspace(-12.0, 16.0, 400)
    bump = 1e-3 * np.sin(np.pi * x / 3.0)
    profile = {"x": x, "y": [-9.0, 9.0], "separation": np.stack((bump, bump), axis=1)}
    creeping = {"creepage.longitudinal": [-0.003] * 2}
    cases = {
        "creepage, from rest": ({}, creeping),
        "creepage, changed while rolling": (
            {},
            {"start": "steady", "creepage.longitudinal": [-0.001, -0.003, -0.003]},
        ),
        "creepage and spin": (
            {},
            {"creepage.longitudinal": [-0.001] * 2, "creepage.spin": [0.002 / A] * 2},
        ),
        "orthotropic": ({"friction.mu": (0.4, 0.2), "friction.angle": 30.0}, creeping),
        "dissimilar": ({"body.B.shear": 3.0}, creeping),
        "constant force after a shift": ({}, {"load.force_x": [0.657 * MU * P] * 2}),
        "oscillating force": ({}, {"load.force_x": wave.tolist()}),
        "increasing load": ({}, creeping | {"load.normal": [0.7 * P, 1.3 * P]}),
        "creepage, from rest, with wear": ({"wear": {"intensity": 1e-4}}, creeping),
        "travelling profile": ({}, creeping | {"profile.B": profile}),
    }
    for slip in ("auto", "upwind"):
        for name, (changes, table) in cases.items():
            count = max(len(v) for k, v in table.items() if k.startswith(("load", "creep")))
            knots = np.linspace(0.0, 40.0 * dx, count)
            if count == 3:
                knots[1] = 0.0
            scene = SPHERES.replace(
                transient=table | {"distance": knots.tolist()},
                **changes,
                **{"grid.elements": (91, 91), "solver.slip": slip},
            )
            history = ts.roll(scene)
            taken = history["operator_applications"][1:]
            rows.append(
                {
                    "course": name,
                    "slip": slip,
                    "steps": len(taken),
                    "median": float(np.median(taken)),
                    "most": float(taken.max()),
                    "convolutions": float(np.median(history["convolutions"][1:])),
                }
            )
    write("transient_steps", rows)
    show("applications per step", rows)


def cost() -> None:
    """Measure work and time per step for several meshes: constant creepage from rest, to 1e-6."""
    count, rows = 40, []
    for n in (31, 45, 61, 91, 127, 181):
        scene = SPHERES.replace(
            transient={"distance": [0, count * 8.16 / n], "creepage.longitudinal": [-0.003] * 2},
            **{"grid.elements": (n, n), "solver.tolerance": 1e-6},
        )
        history = ts.roll(scene)
        operator, fields = Model(scene).operators.tangential, np.ones((2, n, n))
        step = seconds(lambda scene=scene: ts.roll(scene), 4.0) / count
        application = seconds(lambda apply=operator, fields=fields: apply(fields), 0.5, 100)
        rows.append(
            {
                "elements": f"{n} x {n}",
                "applications": float(np.mean(history["operator_applications"][1:])),
                "convolutions": float(np.mean(history["convolutions"][1:])),
                "milliseconds": 1e3 * step,
                "over_application": step / application,
            }
        )
    write("transient_cost", rows)
    show("work and time per step", rows)
    print(f"written: {draw_cost(rows)}")


def draw_cost(rows: list[dict]) -> Path:
    """Draw work and time per step over the number of elements a side; return the file."""
    figure = Figure(figsize=(9, 3.8), layout="constrained")
    work, time = figure.subplots(1, 2)
    n = [int(row["elements"].split()[0]) for row in rows]
    for axes, names in ((work, ("applications", "convolutions")), (time, ("milliseconds",))):
        for name in names:
            label = "tractive_sam" if axes is time else name
            axes.loglog(n, [row[name] for row in rows], "o-", label=label)
    time.loglog(*zip(*CONTACT_MILLISECONDS.items(), strict=True), "k^:", label="CONTACT")
    work.set(ylabel="applications and convolutions per step", ylim=(1.0, 100.0))
    time.set(ylabel="milliseconds per step, one thread", ylim=(1.0, 100.0))
    for axes in (work, time):
        axes.set_xticks(n, [str(size) for size in n])
        axes.minorticks_off()
        axes.set_xlabel("elements a side")
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8)
    path = RESULTS / "transient_cost.png"
    figure.savefig(path, dpi=150)
    return path


def order() -> None:
    """Measure errors for several meshes and step lengths."""

    def force(n: int, step: float | None, slip: str) -> float:
        table = {"distance": [0, 3.0], "creepage.longitudinal": [0, -0.004], "start": "rest"}
        if step is not None:
            table["step"] = step
        scene = SPHERES.replace(transient=table, **{"grid.elements": (n, n), "solver.slip": slip})
        return ts.roll(scene)["Qx"][-1] / (MU * P)

    cases = [("mesh", slip, n, None) for slip in ("auto", "upwind") for n in (17, 34, 68, 136)]
    cases += [("step", "auto", 85, 3.0 / 2**k) for k in range(6)]
    rows = [
        {"over": over, "slip": slip, "n": n, "step": step or "", "Qx": force(n, step, slip)}
        for over, slip, n, step in cases
    ]
    write("transient_order", rows)
    show("Q_x/(mu P) after 3 mm", rows)


def wear() -> None:
    """Measure errors of the depth, divided by the largest depth, of a pass and of fretting."""
    intensity, rows = 1e-3, []
    once = {"revolutions": 1, "turns": "equal", "stepping": "every-revolution"}
    for slip in ("auto", "upwind"):
        for n in (23, 45, 91):
            changes = {"grid.elements": (n, n), "solver.slip": slip}
            creepage, end = -0.0031, round(0.93 * n) * 8.16 / n
            table = {"distance": [0, end], "creepage.longitudinal": [creepage] * 2}
            worn = SPHERES.replace(
                wear={"intensity": intensity}, transient=table | {"start": "steady"}, **changes
            )
            steady = SPHERES.replace(
                wear=once | {"intensity": intensity},
                creepage={"longitudinal": creepage},
                **changes,
            )
            depth = ts.roll(worn)["wear_profile"][-1]
            revolution = ts.roll(steady)["wear_profile"][1]
            error = np.abs(depth - revolution).max() / revolution.max()
            rows.append({"case": "pass", "slip": slip, "n": n, "steps": "", "error": error})
    # Johnson 1985, eq. 3.91: the displacement of both bodies by full traction mu p in x.
    G, nu, p0 = 1.0, 0.28, SPHERES.hertz.p0
    stroke = 1.5 * (2.0 - nu) * MU * P / (G * A)
    table = {"distance": [0, 1, 2, 3], "creepage.longitudinal": [0, stroke, -stroke, stroke]}
    for slip in ("auto", "upwind"):
        for n, steps in ((31, 5), (61, 5), (61, 20), (121, 5)):
            scene = SPHERES.replace(
                wear={"intensity": intensity},
                transient=table | {"start": "shift", "step": 1.0 / steps},
                **{"grid.elements": (n, n), "solver.slip": slip},
            )
            history = ts.roll(scene)
            x, y = history.x[:, None], history.y[None, :]
            u = 4.0 * (2.0 - nu) * A**2 - (4.0 - 3.0 * nu) * x**2 - (4.0 - nu) * y**2
            slipped = 5.0 * (stroke - np.pi * MU * p0 / (16.0 * G * A) * u)
            hertz = np.sqrt(np.maximum(1.0 - (x**2 + y**2) / A**2, 0.0))
            exact, inside = intensity * p0 * hertz * slipped, np.hypot(x, y) < 0.9 * A
            error = np.abs(history.field("wear") - exact)[inside].max() / exact.max()
            rows.append({"case": "fretting", "slip": slip, "n": n, "steps": steps, "error": error})
    write("transient_wear", rows)
    show("error of the depth", rows)


if __name__ == "__main__":
    warnings.simplefilter("ignore", ts.SceneWarning)
    parts = {"courses": courses, "killed": killed, "steps": steps, "cost": cost}
    parts |= {"order": order, "wear": wear}
    for name in sys.argv[1:] or parts:
        parts[name]()
