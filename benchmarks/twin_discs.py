"""The twin discs of the paper over 15,000 revolutions, compared with the paper and other models.

- findings: beta = 0, 45, 90 degrees (paper, section 8.2 and appendix C, Figs. 16-18);
- every revolution: jumps compared with a computation of every revolution: 300 revolutions of new
  discs, 300 revolutions of discs worn at N = 4,000, and all 15,000 if `benchmarks/references`
  contains them;
- mesh: the state at N = 15,000 for several meshes;
- GIWM: `twin-discs-isotropic` compared with the global incremental wear model (paper, Fig. 15,
  Table 1).

For the convergence with the tolerance and the time of the paper's scheme, see `wear.py`.

Page: docs/validation.md
"""

import shutil
import tempfile
from pathlib import Path

import numpy as np
from discs import EVERY, SAVED, discs, errors, roughness, stored_reference, timed
from matplotlib.figure import Figure
from timing import RESULTS, show, write

import tractive_sam as ts
from tractive_sam import plot
from tractive_sam.mechanics.frame import full_slip_force
from tractive_sam.reference import giwm

ANGLES = (0.0, 45.0, 90.0)
MESHES = ((21, 61), (29, 85), (41, 121), (57, 169), (81, 241))
RESTART, MORE = 4000, 300


def findings() -> None:
    """Return the state of the discs at the revolutions that the paper shows."""
    rows, histories = [], {}
    for angle in ANGLES:
        history, seconds = timed(discs(SAVED[-1], angle=angle))
        histories[angle] = history
        limit = full_slip_force(1.0, (0.6, 0.3), np.deg2rad(angle), (-1.0, 0.0))[0]
        balance = history.energy_balance - 1.0
        # i1/mu1 = i2/mu2: the worn cross section follows the frictional work at any angle.
        worn = history["worn_area"][1:] / (2e-6 / 0.6 * history["work_supplied"][1:]) - 1.0
        print(
            f"beta = {angle:g}: {history.totals['contact_solves']:.0f} contact solves, "
            f"{seconds:.1f} s; energy law: slip {np.abs(balance).max():.1e}, "
            f"worn section {np.abs(worn).max():.1e}"
        )
        for revolution in SAVED:
            i = int(np.flatnonzero(history["revolution"] == revolution)[0])
            slip = history.field("slip_x", revolution), history.field("slip_y", revolution)
            touching = history.field("pressure", revolution) > 0.0
            rows.append(
                {
                    "beta": angle,
                    "revolution": revolution,
                    "a": float(history["half_width_x"][i]),
                    "b": float(history["half_width_y"][i]),
                    "wear_max": float(history["wear_max"][i]),
                    "p_max": float(history["p_max"][i]),
                    "y of p_max / b": abs(
                        float(history["p_max_at"][i][1] / history["half_width_y"][i])
                    ),
                    "Qx/P": float(history["Qx_over_P"][i]),
                    "Qx/full slip": float(history["Qx_over_P"][i] / limit),
                    "Qy/P": float(history["Qy_over_P"][i]),
                    "stick": float(history["stick_fraction"][i]),
                    "largest slip": float(np.hypot(*slip)[touching].max()),
                    "energy law": float(balance[i]),
                    "ripple": roughness(history.field("pressure", revolution)),
                }
            )
    show("Twin discs, orthotropic", rows)
    write("twin_discs", rows)
    _check(rows)
    _draw(histories)


def _check(rows: list[dict]) -> None:
    """Check each finding of the paper."""
    courses = {angle: [row for row in rows if row["beta"] == angle] for angle in ANGLES}
    last = {angle: course[-1] for angle, course in courses.items()}

    def grows(name: str, sign: int = 1) -> bool:
        values = [sign * np.diff([row[name] for row in course]) for course in courses.values()]
        return all((column >= 0).all() and column.sum() > 0 for column in values)

    findings = {
        "a falls with N": grows("a", -1),
        "b rises with N": grows("b"),
        "wear is deepest at beta = 0": last[0.0]["wear_max"]
        > max(last[45.0]["wear_max"], last[90.0]["wear_max"]),
        "the contact is widest at beta = 0": last[0.0]["b"] > max(last[45.0]["b"], last[90.0]["b"]),
        "p_max is at y = 0 at N = 0": all(
            course[0]["y of p_max / b"] < 0.05 for course in courses.values()
        ),
        **{
            f"p_max is at the rim at N = 15000, beta = {angle:g}": row["y of p_max / b"] > 0.9
            for angle, row in last.items()
        },
        "Q_x rises with N towards full slip": grows("Qx/full slip"),
        "slip is largest at beta = 0": last[0.0]["largest slip"]
        > max(last[45.0]["largest slip"], last[90.0]["largest slip"]),
    }
    print("\nThe paper's findings")
    for finding, holds in findings.items():
        print(f"{'yes' if holds else 'NO':>4}  {finding}")


def _draw(histories: dict[float, ts.History]) -> None:
    figure = Figure(figsize=(9.6, 5.6), layout="constrained")
    axes = figure.subplots(2, 3)
    names = {
        "wear_max": ("depth, µm", 1e3),
        "Qx_over_P": ("$Q_x/P$", 1.0),
        "half_width_x": ("half width in x, mm", 1.0),
        "half_width_y": ("half width in y, mm", 1.0),
        "p_95": ("$p_{95}$, MPa", 1.0),
    }
    for angle, history in histories.items():
        label = rf"$\beta = {angle:g}°$"
        for ax, (name, (_, unit)) in zip(axes.flat, names.items(), strict=False):
            ax.plot(history["revolution"], unit * history[name], label=label)
        axes.flat[5].plot(history.y, 1e3 * history["wear_profile"][-1], label=label)
    for ax, (name, _) in zip(axes.flat, names.values(), strict=False):
        ax.set(xlabel="revolutions", ylabel=name, xlim=(0, SAVED[-1]))
        ax.xaxis.set_major_formatter("{x:,.0f}")
        ax.set_xticks(range(0, SAVED[-1] + 1, 5000))
    axes.flat[5].set(xlabel="y, mm", ylabel="depth at N = 15,000, µm")
    axes.flat[5].invert_yaxis()
    axes.flat[0].legend()
    figure.savefig(RESULTS / "twin_discs.png", dpi=150)
    plot.worn_profiles(histories[0.0]).savefig(RESULTS / "twin_discs_profiles.png", dpi=150)


def every_revolution() -> None:
    """Compare jumps with every revolution, for new and for worn discs."""
    rows = []
    for angle in ANGLES:
        cold, _ = timed(discs(MORE, angle=angle))
        every, _ = timed(discs(MORE, EVERY, angle=angle))
        rows.append(_compare(angle, f"0 to {MORE}", cold, every, MORE))
        with tempfile.TemporaryDirectory() as folder:
            jumped, single_steps = Path(folder) / "jumps.h5", Path(folder) / "every.h5"
            ts.roll(discs(RESTART, angle=angle), jumped)
            shutil.copy(jumped, single_steps)
            last = RESTART + MORE
            on = ts.roll(discs(last, angle=angle), jumped, resume=True)
            every = ts.roll(discs(last, EVERY, angle=angle), single_steps, resume=True)
            rows.append(_compare(angle, f"{RESTART} to {last}", on, every, last))
        reference = stored_reference(angle)
        if reference is not None:
            history, _ = timed(discs(SAVED[-1], angle=angle))
            reached = [N for N in SAVED if MORE < N <= reference["revolution"][-1]]
            rows += [_compare(angle, f"0 to {N}", history, reference, N) for N in reached]
    show("Jumps compared with every revolution", rows)
    write("twin_discs_every_revolution", rows)


def _compare(angle: float, between: str, history, every, revolution: int) -> dict:
    relative_errors = errors(history, every, revolution)
    return {"beta": angle, "revolutions": between} | {
        f"{name} error": error for name, error in relative_errors.items()
    }


def mesh_convergence() -> None:
    """Compare meshes at N = 15,000, beta = 0; the error of the tolerance is much smaller."""
    rows = []
    for mesh in MESHES:
        settings = f"grid.elements={list(mesh)}", "wear.tolerance=2e-4"
        history, seconds = timed(discs(SAVED[-1], *settings))
        revolution = history["revolution"]
        settled = revolution >= SAVED[-1] // 2
        rows.append(
            {
                "mesh": f"{mesh[0]} x {mesh[1]}",
                "solves": int(history.totals["contact_solves"]),
                "seconds": round(seconds, 1),
                "Qx/P at 0": float(history["Qx_over_P"][0]),
                "wear_max": float(history["wear_max"][-1]),
                "Qx/P": float(history["Qx_over_P"][-1]),
                "b": float(history["half_width_y"][-1]),
                "pressure at y = 0": float(history.field("pressure")[:, mesh[1] // 2].max()),
                "p_max": float(history["p_max"][-1]),
                "largest p_max since 7500": float(history["p_max"][settled].max()),
                "energy law": float(np.abs(history.energy_balance - 1.0).max()),
            }
        )
    show("Convergence with the mesh, beta = 0, N = 15,000", rows)
    write("twin_discs_mesh", rows)


def wear_models() -> None:
    """Compare the largest depth with the global incremental wear model."""
    scene = ts.Scene.builtin("twin-discs-isotropic")
    history, seconds = timed(scene)
    print(f"\nisotropic: {history.totals['contact_solves']:.0f} contact solves, {seconds:.1f} s")
    hertz, body = scene.hertz, scene.body
    course = giwm(
        scene.load.normal,
        scene.material.E_star,
        (body.A.radius_x, body.B.radius_x),
        body.radii[1],
        (hertz.a, hertz.b),
        scene.creepage.longitudinal,
        scene.wear.intensity[0],
        scene.wear.revolutions,
    )
    rows = []
    for revolution in (1, *SAVED[1:]):
        i = int(np.flatnonzero(history["revolution"] == revolution)[0])
        depth, b = float(history["wear_max"][i]), float(history["half_width_y"][i])
        rows.append(
            {
                "revolution": revolution,
                "depth": depth,
                "GIWM depth": float(course.depth[revolution]),
                "depth/GIWM": depth / float(course.depth[revolution]),
                "b": b,
                "GIWM b": float(course.b[revolution]),
                "Qx/mu P": float(history["Qx_over_P"][i] / 0.6),
            }
        )
    show("Twin discs, isotropic, compared with GIWM", rows)
    write("twin_discs_giwm", rows)
    figure = Figure(figsize=(5.4, 3.6), layout="constrained")
    axes = figure.subplots()
    axes.plot(history["revolution"], 1e3 * history["wear_max"], label="tractive_sam")
    axes.plot(1e3 * course.depth, "--", label="GIWM")
    axes.set(xlabel="revolutions", ylabel="largest depth, µm", xlim=(0, SAVED[-1]), ylim=(0, None))
    axes.xaxis.set_major_formatter("{x:,.0f}")
    axes.legend()
    figure.savefig(RESULTS / "twin_discs_giwm.png", dpi=150)


if __name__ == "__main__":
    timed(discs(5))  # compiles and plans
    findings()
    every_revolution()
    mesh_convergence()
    wear_models()
