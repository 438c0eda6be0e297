"""The package compared with closed forms, tables and an independent program.

The cases are Hertz's solution and the mesh convergence of Q_x for `spheres`, its creep-force curve,
orthotropic friction for all angles, and all published sets of `tractive-sam validate`. The values
of the program CONTACT are in tests/data/reference.json.

Page: docs/validation.md
"""

import json
import shutil
import tempfile
import warnings
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from timing import RESULTS, show, write

from tractive_sam.contact import Model, equilibrium
from tractive_sam.reference import kalker_simplified, vermeulen_johnson
from tractive_sam.scene import Scene
from tractive_sam.schema import PlausibilityWarning
from tractive_sam.validation import validate

REFERENCE = json.loads(
    (Path(__file__).parents[1] / "tests" / "data" / "reference.json").read_text()
)
MU = 0.4013


def solved(scene: Scene):
    contact = equilibrium(Model(scene))
    assert contact.converged, contact.message
    return contact


def spheres(*settings: str):
    return solved(Scene.builtin("spheres").with_set(settings))


def line_through(h, values):
    """Return the value at h = 0 of the line through (h, values), and its standard error."""
    (_, at_zero), covariance = np.polyfit(h, values, 1, cov=True)
    return at_zero, np.sqrt(covariance[1, 1])


def mesh_convergence():
    contact_program = REFERENCE["spheres"]["Qx_over_muP_CONTACT"]
    rows = []
    # Many meshes: the position of edges within elements adds noise to the second-order error.
    for n in range(41, 362, 10):
        contact = spheres(f"grid.elements=[{n}, {n}]")
        hertz, grid = contact.scene.hertz, contact.grid
        truth = hertz.pressure(grid.x[:, None], grid.y[None, :])
        rows.append(
            {
                "n": n,
                "dx/a": grid.dx / hertz.a,
                "p_max/p0 - 1": contact.p_max / hertz.p0 - 1,
                "a/a_Hertz - 1": contact.half_width_x / hertz.a - 1,
                "approach error": contact.approach / hertz.approach - 1,
                "mean |p - Hertz|/p0": np.abs(contact.pressure - truth).mean() / hertz.p0,
                "Qx/muP": contact.Qx / (MU * contact.P),
                "CONTACT": contact_program.get(str(n), ""),
            }
        )
    show("`spheres` on several meshes", rows)
    h, q = (np.array([r[k] for r in rows]) for k in ("dx/a", "Qx/muP"))
    fine = h < 0.035
    limit, error = line_through(h[fine] ** 2, q[fine])
    wide, _ = line_through(h**2, q)
    spread = max(2 * error, abs(limit - wide))
    print(
        f"\nQx/muP at h = 0: {limit:.5f} +- {spread:.5f}"
        f" (fit of {fine.sum()} meshes; of all: {wide:.5f})"
    )
    print("the paper at 91 x 91: 0.657; CONTACT at 361 x 361: 0.6469")
    write("spheres_convergence", rows)


def creep_force_curve():
    rows = []
    for reference in REFERENCE["creep_force_curve_spheres"]["rows"]:
        xi = reference["xi"]
        creepage = -xi * 3 * MU * 0.4705 * (4 - 3 * 0.28) / (16 * 3.499981**2)
        values = {}
        for n in (61, 91, 181, 361):
            c = spheres(f"creepage.longitudinal={creepage!r}", f"grid.elements=[{n}, {n}]")
            values[n] = c.Qx / (MU * c.P)
        rows.append(
            {
                "xi~": xi,
                "n = 61": values[61],
                "CONTACT n = 61": reference["n61"],
                "n = 91": values[91],
                "CONTACT n = 91": reference["n91"],
                "extrapolated": (4 * values[361] - values[181]) / 3,
                "CONTACT extrapolated": reference["mesh_limit"],
                "Vermeulen-Johnson": float(vermeulen_johnson(xi)),
                "Kalker (42)": float(kalker_simplified(xi)),
            }
        )
    show("Creep-force curve of `spheres`, Q_x/(mu P)", rows)
    write("creep_force_curve", rows)
    figure = Figure(figsize=(5.4, 3.8), layout="constrained")
    axes = figure.subplots()
    xi = np.linspace(0, 1.5, 200)
    axes.plot(xi, vermeulen_johnson(xi), "--", color="0.5", label="Vermeulen-Johnson")
    axes.plot(xi, kalker_simplified(xi), ":", color="0.2", label="Kalker, eq. (42)")
    x = [r["xi~"] for r in rows]
    axes.plot(x, [r["extrapolated"] for r in rows], "o", mfc="none", label="tractive_sam, h = 0")
    axes.plot(x, [r["CONTACT extrapolated"] for r in rows], "x", label="CONTACT, h = 0")
    axes.set(xlabel=r"creepage $\tilde\xi$", ylabel=r"$Q_x/\mu P$", xlim=(0, 1.5), ylim=(0, 1.05))
    axes.legend()
    axes.grid(alpha=0.3)
    figure.savefig(RESULTS / "creep_force_curve.png", dpi=150)


def published_sets():
    """Compute all published sets, as `tractive-sam validate` does."""
    with tempfile.TemporaryDirectory() as folder:
        outcomes = validate(folder)
        shutil.copy(Path(folder) / "comparisons.csv", RESULTS / "published_sets.csv")
    values = [one for outcome in outcomes for one in outcome.comparisons]
    agree = sum(one.agrees for one in values)
    print(f"{len(outcomes)} published sets: {agree} of {len(values)} values agree")


def orthotropic_angles():
    rows = []
    for angle in range(0, 181, 15):
        settings = [f"friction.angle={angle}"]
        scene = Scene.builtin("spheres-orthotropic").with_set(settings)
        partial = solved(scene)
        full = solved(scene.with_set(["creepage.longitudinal=-10.0"]))
        c, s = np.cos(np.deg2rad(angle)), np.sin(np.deg2rad(angle))
        effective = np.hypot(0.4 * c, 0.2 * s)
        rows.append(
            {
                "beta": angle,
                "Qx/P": partial.Qx / partial.P,
                "Qy/P": partial.Qy / partial.P,
                "stick": partial.stick_fraction,
                "full slip Qx/P": full.Qx / full.P,
                "closed form x": effective,
                "full slip Qy/P": full.Qy / full.P,
                "closed form y": (0.4**2 - 0.2**2) * s * c / effective,
            }
        )
    show("`spheres-orthotropic` against the angle of the tribological axes", rows)
    write("orthotropic_angles", rows)
    figure = Figure(figsize=(5.4, 3.8), layout="constrained")
    axes = figure.subplots()
    beta = [r["beta"] for r in rows]
    for name, color in (("x", "C0"), ("y", "C3")):
        axes.plot(beta, [r[f"closed form {name}"] for r in rows], "--", color=color, lw=1)
        axes.plot(
            beta,
            [r[f"full slip Q{name}/P"] for r in rows],
            "o",
            mfc="none",
            color=color,
            label=f"$Q_{name}/P$, full slip (line: closed form)",
        )
        axes.plot(
            beta,
            [r[f"Q{name}/P"] for r in rows],
            "s-",
            color=color,
            label=rf"$Q_{name}/P$, $\xi_x = -0.0031$",
        )
    axes.set(xlabel=r"$\beta$, degrees", ylabel="force / load", xticks=range(0, 181, 30))
    axes.legend(fontsize=8)
    axes.grid(alpha=0.3)
    figure.savefig(RESULTS / "orthotropic_angles.png", dpi=150)


if __name__ == "__main__":
    warnings.simplefilter("error")
    warnings.simplefilter("ignore", PlausibilityWarning)  # of creepages far beyond full slip
    mesh_convergence()
    creep_force_curve()
    orthotropic_angles()
    published_sets()
