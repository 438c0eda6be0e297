"""When does falling friction have several solutions, and does the warning then appear?

Random line contacts with an exponential law are solved from rest and from high speed. More
solutions are sought from both: the traction of one element near the stick-slip boundary is changed
by 5 or 15 %, and Newton's method starts from there. `steepness` is a property of the solution; if
it is at least 1, the package warns. Random steps of a transient from steady rolling are then also
solved from rest and from high speed.

    python benchmarks/branches.py [--scenes 30] [--steps 60]

Page: docs/theory/friction.md
"""

import argparse
import math
import re
import warnings
from dataclasses import replace

import numpy as np
from timing import show, write

import tractive_sam as ts
from tractive_sam.contact import Model, StepInput, Stepper, equilibrium
from tractive_sam.contact.steady import dimensionless_start
from tractive_sam.solvers import steepness


def line_scene(seed: int, slip: str, start: str) -> ts.Scene:
    """Return a random line contact with 31 to 91 elements and a half speed of 1 to 8 mm/s."""
    rng = np.random.default_rng(seed)
    half_speed = float(np.exp(rng.uniform(0.0, math.log(8.0))))
    steel = {"shear": 82e3, "poisson": 0.28, "radius_x": 1000.0, "radius_y": math.inf}
    law = {"law": "exponential", "static": 0.3, "kinetic": rng.uniform(0.1, 0.25)}
    return ts.Scene(
        body={"A": steel, "B": steel},
        load={"normal": 178.9},
        creepage={"longitudinal": -rng.uniform(0.5e-4, 3e-4), "speed": 45e3},
        friction=law | {"half_speed": half_speed, "start": start},
        solver={"slip": slip, "tolerance": 1e-10},
        grid={"half_length": 1.1, "elements": int(rng.choice([31, 45, 61, 91]))},
    )


def steepness_of(contact: ts.State) -> float:
    """Return the steepness of a solution."""
    model = Model(contact.scene, grid=contact.grid)
    problem, start = (
        model.problem(model.undeformed_gap / model.units.gap),
        dimensionless_start(model, contact),
    )
    problem = problem.with_pressure(start.pressure, contact.gap / model.units.gap)
    slip = problem.rigid + problem.response(start.traction)
    return steepness(problem, start.pressure, problem.normal.gap, start.traction, slip)


def forces(contact: ts.State) -> set[float]:
    """Return Q_x/P of the solutions that are found from a given solution."""
    share = np.hypot(*contact.traction) / np.maximum(contact.pressure, 1e-9)
    border = np.flatnonzero(contact.sliding[1:, 0] != contact.sliding[:-1, 0])
    near = {k for at in border for k in range(max(at - 2, 0), at + 4)} or {int(share.argmax())}
    values = {round(contact.Qx / contact.P, 6)}
    for k in sorted(near):
        for factor in (0.85, 0.95, 1.05, 1.15):
            traction = contact.traction.copy()
            traction[:, k] *= factor
            model = Model(contact.scene, grid=contact.grid)
            perturbed = equilibrium(model, start=replace(contact, traction=traction))
            if perturbed.converged:
                values.add(round(perturbed.Qx / perturbed.P, 6))
    return values


def step_row(seed: int, slip: str, load: float = 178.9) -> dict | None:
    """Solve a step from rest and from high speed; None if a solution or the state before it fails.

    The half speed is 3 to 10,000 mm/s, half of the laws have a memory, and creepages change by up
    to a factor of three, after up to two other steps.
    """
    rng = np.random.default_rng(seed)
    speeds = {"half_speed": float(np.exp(rng.uniform(1.0, 9.0)))}
    speeds["memory"] = float(rng.choice([0.0, np.exp(rng.uniform(-9.0, -5.0))]))
    scene = line_scene(seed, slip, "rest")
    scene = scene.replace(**{f"friction.{key}": value for key, value in speeds.items()})
    creepage, model = 3.0 * scene.creepage.longitudinal, Model(scene)
    courses = creepage * rng.uniform(0.3, 2.0, int(rng.integers(1, 4)))
    lengths = rng.choice([0.5, 1.0, 1.0, 2.0], len(courses)) * model.grid.dx
    before = Stepper(model).at_rest(
        ts.solve(scene.replace(**{"creepage.longitudinal": creepage}), throw=False)
    )
    both, steep = [], []
    for start in ("rest", "sliding"):
        result, last_stepper = before, Stepper(Model(scene.replace(**{"friction.start": start})))
        for k, (xi, length) in enumerate(zip(courses, lengths, strict=True), 1):
            stepper = last_stepper if k == len(courses) else Stepper(model)
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always", ts.SceneWarning)
                result = stepper.step(result, StepInput(float(length), (float(xi), 0.0, 0.0), load))
            if not result.contact.converged:
                return None
        texts = (str(warning.message) for warning in caught)
        steep += [
            float(match[1])
            for text in texts
            if (match := re.search(r"falls (\S+) (?:or more )?times", text))
        ]
        both.append(result.contact.traction)
    apart = float(np.abs(both[1] - both[0]).max() / np.abs(both[0]).max())
    row = {"slip": slip, "seed": seed, **speeds, "steepness": max(steep, default=0.0)}
    return row | {"warns": bool(steep), "apart": apart, "several": apart > 1e-5}


def show_steps(count: int) -> None:
    """Print how many steps with and without the warning have two solutions."""
    rows = [step_row(seed, slip) for slip in ("upwind", "auto") for seed in range(count)]
    rows, table = [row for row in rows if row], []
    for slip in ("upwind", "auto"):
        for warned in (False, True):
            of = [r for r in rows if r["slip"] == slip and r["warns"] == warned]
            several = sum(row["several"] for row in of)
            table.append({"slip": slip, "warns": warned, "solved": len(of), "several": several})
    show("Solved steps of a transient, and steps with two solutions", table)
    print(f"written: {write('branches-steps', rows)}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=30)
    parser.add_argument("--steps", type=int, default=60)
    scenes, steps = (getattr(parser.parse_args(), key) for key in ("scenes", "steps"))
    warnings.simplefilter("ignore", ts.SceneWarning)
    rows = []
    for slip in ("upwind", "auto"):
        for seed in range(scenes):
            both = [
                ts.solve(line_scene(seed, slip, start), throw=False)
                for start in ("rest", "sliding")
            ]
            if not all(contact.converged for contact in both):
                continue
            for start, contact in zip(("rest", "sliding"), both, strict=True):
                values = forces(contact) | {round(contact.Qx / contact.P, 6) for contact in both}
                steep = steepness_of(contact)
                row = {"slip": slip, "seed": seed, "start": start, "steepness": steep}
                rows.append(row | {"solutions": len(values), "spread": max(values) - min(values)})
    table = []
    for slip in ("upwind", "auto"):
        for warned in (False, True):
            of = [r for r in rows if r["slip"] == slip and (r["steepness"] >= 1.0) == warned]
            several = sum(row["solutions"] > 1 for row in of)
            table.append({"slip": slip, "warns": warned, "solved": len(of), "several": several})
    show("Solved contacts, and contacts with several solutions", table)
    print(f"written: {write('branches', rows)}")
    show_steps(steps)


if __name__ == "__main__":
    main()
