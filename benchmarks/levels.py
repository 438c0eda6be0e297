"""Levels of the model: what each costs and what it gets wrong, in eight contacts.

    python benchmarks/levels.py

Page: docs/benchmarks.md
"""

import math
import warnings

from matplotlib.figure import Figure
from timing import RESULTS, show, write
from work_precision import CONTACT

import tractive_sam as ts
from tractive_sam.levels import Levels

TOLERANCE = 3e-4
"""Relative error of the refined contacts."""

STEEL = {"young": 208e3, "poisson": 0.3}


def make_scenes() -> dict[str, ts.Scene]:
    """Return a scene for each panel."""
    circle = ts.Scene(
        body={
            "A": STEEL | {"radius_x": 50.0, "radius_y": 50.0},
            "B": STEEL | {"radius_x": 50.0, "radius_y": 50.0},
        },
        load={"pressure": 1200.0},
        creepage={"longitudinal": -2e-3},
        friction={"mu": 0.3},
    )
    spin = {"longitudinal": -1e-3, "spin": 8e-3}
    aluminium = {"body.A.young": 70e3, "body.A.poisson": 0.33}
    return {
        "spheres of the paper": ts.Scene.builtin("spheres").replace(grid=None, subsurface=None),
        "circle, creepage": circle,
        "circle, creepage and spin": circle.replace(creepage=spin),
        "circle, full slip": circle.replace(creepage={"longitudinal": -2e-2}),
        "ellipse 1 : 7, creepage": circle.replace(
            **{"body.A.radius_y": 1000.0, "body.B.radius_y": 1000.0}
        ),
        "aluminium on steel": circle.replace(**aluminium),
        "cylinders": circle.replace(**{"body.A.radius_y": math.inf, "body.B.radius_y": math.inf}),
        "friction along and across .4, .2": circle.replace(friction={"mu": (0.4, 0.2)}),
    }


def draw(found: dict[str, Levels]) -> None:
    """Draw the error over the time of each scene's levels."""
    names = list(dict.fromkeys(
        level.name for levels in found.values() for level in levels.levels
        if not level.name.startswith("mesh")
    ))  # fmt: skip
    figure = Figure(figsize=(13.0, 6.4), layout="constrained")
    for axes, (title, levels) in zip(
        figure.subplots(2, 4, sharex=True, sharey=True).flat, found.items(), strict=True
    ):
        least = 100.0 * levels.uncertainty
        meshes = [level for level in levels.levels if level.name.startswith("mesh")]
        axes.plot(
            [1e3 * level.seconds for level in meshes],
            [max(100.0 * level.error, least) for level in meshes],
            "ks-", ms=4, label="meshes, 11 to 91 elements across",
        )  # fmt: skip
        for level in levels.levels:
            if level.name in names and not level.missing:
                colour = f"C{names.index(level.name)}"
                error = max(100.0 * level.error, least)
                axes.plot(1e3 * level.seconds, error, "o", color=colour)
        axes.axhspan(1e-4, least, color="0.9", zorder=0)
        axes.set(xscale="log", yscale="log", title=title, ylim=(2e-3, 400.0))
        axes.grid(alpha=0.3)
    spheres, axes = found["spheres of the paper"].reference, figure.axes[0]
    ratio = spheres.Qx / (spheres.scene.friction.mu[0] * spheres.P)
    times, forces = zip(*CONTACT.values(), strict=True)
    errors = [100.0 * abs(force / ratio - 1.0) for force in forces]
    contact = axes.plot(
        [1e3 * time for time in times], errors, "k*-", label="CONTACT, 91², 181², 361²"
    )
    for axes in figure.axes[4:]:
        axes.set_xlabel("CPU time of one contact (ms)")
    for axes in figure.axes[::4]:
        axes.set_ylabel("error (%)")
    handles = [figure.axes[0].lines[0], *contact]
    for k, name in enumerate(names):
        handles += figure.axes[0].plot([], [], "o", color=f"C{k}", label=name)
    figure.legend(handles=handles, loc="outside lower center", ncols=2)
    figure.savefig(RESULTS / "levels.png", dpi=110)


def main() -> None:
    """Compare the levels of all scenes, and write table and figure."""
    warnings.simplefilter("ignore", ts.SceneWarning)
    found, rows = {}, []
    for name, scene in make_scenes().items():
        found[name] = ts.compare_levels(scene, TOLERANCE)
        rows += (
            {
                "scene": name,
                "level": level.name,
                "ms": 1e3 * level.seconds,
                "force error": level.force,
                "p_max error": level.pressure,
                "error of the reference": found[name].uncertainty,
            }
            for level in found[name].levels
            if not level.missing
        )
    show("Levels of the model", rows)
    print(write("levels", rows))
    draw(found)


if __name__ == "__main__":
    main()
