"""Do the error bars of [accuracy] hold? Random scenes, each compared with a much finer mesh.

The scenes form a Latin hypercube: aspect ratios from 0.2 to 5, creepages and spin in any direction
from stick to full slip, friction from 0.05 to 1 with a ratio of 1 to 4 at any angle, and Poisson's
ratios from 0 to 0.49. In two scenes of three, the moduli of the bodies differ by up to a factor of
ten. Every fourth scene has different bodies and a thousandth to a hundredth of the creepage of full
slip; in half of these, this is spin alone. Every scene is solved to a tolerance, and again on a
mesh with up to 4 x 4 elements for each element of the first mesh.

    python benchmarks/error_bars.py [--scenes 100] [--tolerance 3e-3] [--seed 2]

Page: docs/theory/accuracy.md
"""

import argparse
import math
import warnings
from time import perf_counter

import numpy as np
from scipy.optimize import brentq
from scipy.stats import qmc
from timing import show, write

import tractive_sam as ts
from tractive_sam.contact import Model, solve_on_fitted_mesh
from tractive_sam.run.error_bars import Levels, set_tolerances
from tractive_sam.subsurface import maxima_by_body

LOAD, STEEL = 1000.0, 208e3
FINER, MAX_ELEMENTS = 4, 150_000
"""Number of levels by which the second mesh is finer, unless it would have more elements than
this.
"""

NAMES = ("Qx", "Qy", "Mz", "approach", "p_max")


def random_scenes(count: int, seed: int) -> list[ts.Scene]:
    """Yield the scenes of the hypercube."""
    rows = qmc.LatinHypercube(11, rng=seed).random(count)
    return [_scene(*row, gentle=k % 4 == 3, spin=k % 8 == 7) for k, row in enumerate(rows)]


def _scene(
    aspect, mu, ratio, angle, nu_A, nu_B, moduli, strength, pole, around, equal, gentle, spin
) -> ts.Scene:
    same = equal < 1 / 3 and not gentle
    friction = 0.05 * 20.0**mu
    steel = {"young": STEEL, "poisson": 0.49 * nu_A}
    lower = steel if same else {"young": STEEL * 10.0 ** (2 * moduli - 1), "poisson": 0.49 * nu_B}
    flat = {"radius_x": math.inf, "radius_y": math.inf}

    def scene(log_radius: float, **creepage) -> ts.Scene:
        return ts.Scene(
            body={
                "A": steel | {"radius_x": 100.0 * 10.0**log_radius, "radius_y": 100.0},
                "B": lower | flat,
            },
            load={"normal": LOAD},
            creepage=creepage,
            friction={"mu": (friction, friction / 4.0**ratio), "angle": 360.0 * angle - 180.0},
            subsurface={"planes": ("y=0",)},
        )

    def misses(log_radius: float) -> float:
        hertz = scene(log_radius).hertz
        return math.log(hertz.a / hertz.b) - (2.0 * aspect - 1.0) * math.log(5.0)

    log_radius = brentq(misses, -3.0, 3.0)
    hertz = scene(log_radius).hertz
    size = math.sqrt(hertz.a * hertz.b)
    # Kalker's creepage, from a thirtieth to ten times that at which all slips.
    full = 3.0 * friction * LOAD / (4.0 * size**2 * scene(log_radius).material.shear)
    creepage = full * 10.0 ** (strength - 3.0 if gentle else 2.5 * strength - 1.5)
    height, turn = 1.0 if spin else 2.0 * pole - 1.0, 2.0 * math.pi * around
    level = creepage * math.sqrt(1.0 - height**2)
    return scene(
        log_radius,
        longitudinal=level * math.cos(turn),
        lateral=level * math.sin(turn),
        spin=creepage * height / size,
    )


def judged(scene: ts.Scene, tolerance: float, gentle: bool) -> list[dict]:
    """Return a row for every quantity of a scene: value, error bar, error, and its verdict."""
    scene = scene.replace(**{"accuracy.tolerance": tolerance})
    began = perf_counter()
    contact = ts.solve(scene, throw=False)
    seconds = perf_counter() - began
    assert contact.error_bars, contact.message
    levels = Levels(scene, None)
    level = levels.find_level(contact.grid)
    finer = level + FINER
    while math.prod(levels.grid(finer).elements) > MAX_ELEMENTS and finer > level + 2:
        finer -= 1
    _, (fine,) = solve_on_fitted_mesh(Model(set_tolerances(scene), None, levels.grid(finer)))
    force = float(np.hypot(*contact.traction).sum() * contact.grid.element_area)
    arm = math.sqrt(contact.half_width_x * contact.half_width_y)
    scales = {"Qx": force, "Qy": force, "Mz": force * arm}
    bars = dict(contact.error_bars)
    pairs = [(name, getattr(contact, name), getattr(fine, name)) for name in NAMES]
    here, finer_maxima = maxima_by_body(contact), maxima_by_body(fine)
    pairs += [(f"von_mises_max {b}", here[b].value, finer_maxima[b].value) for b in "AB"]
    bars |= {f"von_mises_max {b}": bars["von_mises_max"][b] for b in "AB"}
    rows = []
    for name, value, truth in pairs:
        bar, scale = bars[name], scales.get(name, abs(value))
        error = abs(value - truth)
        rows.append(
            {
                "quantity": name,
                "elements": "x".join(map(str, contact.grid.elements)),
                "levels finer": finer - level,
                "K": scene.material.coupling,
                "gentle": gentle,
                "value": value,
                "relative bar": bar / scale,
                "relative error": error / scale,
                "holds": error <= bar,
                "seconds": seconds,
            }
        )
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=100)
    parser.add_argument("--tolerance", type=float, default=3e-3)
    parser.add_argument("--seed", type=int, default=2)
    options = parser.parse_args()
    warnings.simplefilter("ignore", ts.SceneWarning)
    rows = []
    for k, scene in enumerate(random_scenes(options.scenes, options.seed)):
        rows += [{"scene": k, **row} for row in judged(scene, options.tolerance, k % 4 == 3)]
        print(f"\r{k + 1} of {options.scenes} scenes", end="", flush=True)
    print()
    write("error_bars", rows)
    table = []
    for name in dict.fromkeys(row["quantity"] for row in rows):
        of = [row for row in rows if row["quantity"] == name]
        bars, errors = (np.array([row[f"relative {k}"] for row in of]) for k in ("bar", "error"))
        table.append(
            {
                "quantity": name,
                "bar holds": f"{np.mean([row['holds'] for row in of]):.0%}",
                "bar within tolerance": f"{np.mean(bars <= options.tolerance):.0%}",
                "median bar": float(np.median(bars)),
                "bar over error, median": float(np.median(bars / np.maximum(errors, 1e-12))),
            }
        )
    show(f"{options.scenes} random scenes, tolerance {options.tolerance:g}", table)


if __name__ == "__main__":
    main()
