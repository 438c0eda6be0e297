"""Random scenes with friction that falls with sliding: solved scenes and their cost.

Each scene is solved with its law and with constant friction as at rest, on one mesh, without an
initial guess, to 1e-8. A scene is rejected with a message if a prescribed force exceeds the maximum
of its traction curve or the limit of friction. Costs are applications of operators; applications on
coarser meshes count in proportion to their elements.

With --discs, the scenes are twin discs with layers and laws so steep that many have no unique
solution: their cost is bounded.

    python benchmarks/falling.py [--scenes 200] [--first 0]
    python benchmarks/falling.py --discs [--scenes 80] [--first 0]

Page: docs/validation.md
"""

import argparse
import math
import warnings

import numpy as np
from timing import show, write

from tractive_sam.contact import Model, equilibrium
from tractive_sam.scene import Scene

ELEMENTS = 31
LAW = ("law", "kinetic", "half_speed", "memory")


def falling_scene(seed: int) -> Scene:
    """Return a scene with a falling law; it depends only on the seed.

    Aspect ratios are 0.2-5, mu is 0.1-0.6 and falls to 0.2-0.95 of its value at sliding speeds of
    10 mm/s to 10 m/s, V is 0.1-100 m/s, and creepage is 0.03-30 times full slip. Half of the scenes
    have spin, are orthotropic, or have a layer or a memory; a third have a strength or dissimilar
    bodies; a tenth have a prescribed force.
    """
    rng = np.random.default_rng(seed)

    def log_uniform(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    steel = {"young": 208e3, "poisson": 0.3, "radius_x": 200.0, "radius_y": 200.0}
    body_B = {"young": 208e3, "poisson": 0.3, "radius_x": math.inf}
    body_B["radius_y"] = 200.0 * log_uniform(0.1, 10.0) if rng.random() < 0.7 else math.inf
    if rng.random() < 1 / 3:
        body_B["young"] *= log_uniform(0.1, 1.0)
    mu = log_uniform(0.1, 0.6)
    static = (mu, mu * (log_uniform(0.3, 1.0) if rng.random() < 0.5 else 1.0))
    share = rng.uniform(0.2, 0.95)
    friction = {
        "law": "exponential" if rng.random() < 0.7 else "rational",
        "static": static,
        "kinetic": tuple(share * coefficient for coefficient in static),
        "half_speed": log_uniform(10.0, 1e4),
        "angle": float(rng.uniform(0.0, 90.0)),
    }
    if rng.random() < 0.5:
        friction["memory"] = log_uniform(1e-4, 1e-1)
    scene = Scene(
        body={"A": steel, "B": body_B},
        load={"normal": log_uniform(100.0, 1e4)},
        creepage={"speed": log_uniform(100.0, 1e5)},
        friction={"mu": mu},
    )
    a, b, p0 = scene.hertz.a, scene.hertz.b, scene.hertz.p0
    full = 4.0 * mu * p0 / 80e3
    if rng.random() < 0.5:
        friction["layer"] = log_uniform(1e-3, 1.0) * a / 80e3
        full *= 1.0 + 80e3 * friction["layer"] / a
    if rng.random() < 1 / 3:
        friction["strength"] = rng.uniform(0.3, 1.0) * mu * p0
    size, direction = full * log_uniform(0.03, 30.0), rng.uniform(0.0, 2.0 * math.pi)
    creepage = {"longitudinal": size * math.cos(direction), "lateral": size * math.sin(direction)}
    if rng.random() < 0.5:
        creepage["spin"] = full * rng.uniform(-1.0, 1.0) / math.sqrt(a * b)
    changes = {f"creepage.{key}": min(max(value, -0.1), 0.1) for key, value in creepage.items()}
    if rng.random() < 0.1:
        del changes["creepage.longitudinal"]
        changes["load.force_x"] = rng.uniform(0.1, 0.9) * min(static) * scene.load.normal
    margin = 1.3
    grid = {"half_length": (margin * a, margin * b), "elements": (ELEMENTS, ELEMENTS)}
    return scene.replace(friction=friction, grid=grid, **changes)


def steep_scene(seed: int) -> Scene:
    """Return twin discs with a steep law on a coarse mesh; they depend only on the seed.

    mu is 0.3-0.9 and falls to 0.01-0.63 of it at sliding speeds of 0.1-60 mm/s, V is 1.2 m/s,
    creepage is 0.1-3 %, and a layer is 0-1e-4 mm/MPa.
    """
    rng = np.random.default_rng(seed)
    static, elements = rng.uniform(0.3, 0.9), int(rng.choice([25, 31, 37]))
    friction = {
        "law": str(rng.choice(["rational", "exponential"])),
        "static": static,
        "kinetic": static * 10.0 ** rng.uniform(-2.0, -0.2),
        "half_speed": 10.0 ** rng.uniform(-1.0, 1.8),
        "layer": float(rng.choice([0.0, 5e-6, 2e-5, 5e-5, 1e-4])),
    }
    disc = {"radius_x": 23.5, "young": 206e3, "poisson": 0.3}
    return Scene(
        body={"A": disc | {"radius_y": 50.0}, "B": disc | {"radius_y": math.inf}},
        load={"normal": 800.0},
        creepage={"longitudinal": -(10.0 ** rng.uniform(-3.0, -1.5)), "speed": 1200.0},
        friction=friction,
        grid={"half_length": (0.35, 0.91), "elements": (elements - 6, elements)},
    )


def solve_steep(seeds: range) -> None:
    """Solve steep scenes; print how many converge, and the largest number of applications."""
    results = []
    for seed in seeds:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            results.append(solved(steep_scene(seed)))
    costs = [cost for _, cost, _ in results]
    summary = {
        "scenes": len(results),
        "converged": [outcome for outcome, *_ in results].count("converged"),
        "median applications": float(np.median(costs)),
        "most applications": max(costs),
    }
    show("Twin discs with steep laws", [summary])


def constant(scene: Scene) -> Scene:
    """Return the scene with constant friction as at rest."""
    changes = {f"friction.{key}": None for key in LAW}
    return scene.replace(**changes | {"friction.mu": scene.friction.mu, "friction.static": None})


def solved(scene: Scene) -> tuple[str, float, str]:
    """Return the outcome of a solution, its applications and the note of the contact."""
    contact = equilibrium(Model(scene))
    outcome = "converged" if contact.converged else "not converged"
    if any(why in contact.note for why in ("top of the traction curve", "what friction can carry")):
        outcome = "refused"
    return outcome, contact.cost.applications, contact.note


def main() -> None:
    """Solve all scenes; print their outcomes and costs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=200)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--discs", action="store_true")
    options = parser.parse_args()
    if options.discs:
        solve_steep(range(options.first, options.first + options.scenes))
        return
    rows = []
    for seed in range(options.first, options.first + options.scenes):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            scene = falling_scene(seed)
            outcome, cost, note = solved(scene)
            constant_outcome, cost_rest, _ = solved(constant(scene))
        steep = any("friction.law" in str(warning.message) for warning in caught)
        rows.append(
            {
                "seed": seed,
                "ended": outcome,
                "constant_ended": constant_outcome,
                "too_steep": steep,
                "applications": round(cost, 1),
                "constant": round(cost_rest, 1),
                "ratio": round(cost / cost_rest, 3),
            }
        )
        if outcome == "not converged":
            print(seed, note)
    write("falling", rows)
    ended = [row["ended"] for row in rows]
    both = [row for row in rows if row["ended"] == row["constant_ended"] == "converged"]
    ratios = np.array([row["ratio"] for row in both])
    gentle = np.array([row["ratio"] for row in both if not row["too_steep"]])
    summary = {
        "scenes": len(rows),
        "converged": ended.count("converged"),
        "refused": ended.count("refused"),
        "not converged": ended.count("not converged"),
        "too steep": sum(row["too_steep"] for row in rows),
        "median ratio": float(np.median(ratios)),
        "90 %": float(np.quantile(ratios, 0.9)),
        "median of gentle": float(np.median(gentle)),
    }
    show("Applications with a falling law / applications with constant friction", [summary])


if __name__ == "__main__":
    main()
