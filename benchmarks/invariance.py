"""Are results independent of the description of a scene? Random small scenes.

Each scene is computed in its original form, and

- mirrored in y; with exchanged bodies; with other units of length and stress; with exchanged
  friction axes: these changes do not alter the discrete problem, so results differ by tolerance and
  rounding;
- with half the step, for a transient: results differ by the error of the step;
- with other stored records, for a transient or a run: adaptive jumps then differ, transients do
  not.

A difference is the largest difference of a group of quantities, divided by a natural scale:
friction times load for forces, friction times the largest pressure for tractions, and the largest
value for other quantities. Scenes with a difference above its bound are listed, and the script then
ends with status 1.

The rows of an interrupted run are in `results/invariance.part.csv`; the command continues this run.

    python benchmarks/invariance.py [--scenes 400] [--seed 1] [--kinds steady,heat]

Page: docs/validation.md
"""

import argparse
import csv
import math
import re
import sys
import warnings
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import numpy as np
from error_bars import random_scenes
from falling import falling_scene
from hard_scenes import _gap, gentle_scene, hard_scene, line_scene
from scene_changes import CHANGES, SAVE, STEP, Change, Outcome
from timing import RESULTS, show, write
from transient import random_scene as transient_scene

import tractive_sam as ts

TOLERANCE = 1e-10


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Return a random number with a uniform logarithm between two limits."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def meshed(
    scene: ts.Scene, rng: np.random.Generator, fewest: int = 12, largest: int = 26
) -> ts.Scene:
    """Return a scene on a small mesh, with a small tolerance."""
    half = scene.grid.half_length if scene.grid else None
    hertz = scene.hertz
    if half is None:
        half = (1.3 * hertz.a, 1.3 * hertz.b)
    elements = tuple(int(n) for n in rng.integers(fewest, largest, len(half)))
    grid = {"half_length": half, "elements": elements}
    return scene.replace(grid=grid, **{"solver.tolerance": TOLERANCE})


def moderate(rng: np.random.Generator, **tables) -> ts.Scene:
    """Return a scene of the hypercube of `error_bars`, with curvature shared by both bodies."""
    scene = random_scenes(1, int(rng.integers(2**31)))[0]
    bodies = scene.entries()["body"]
    share = float(rng.choice([1.0, 0.5, 0.4, 0.7, 1.25]))
    for key in ("radius_x", "radius_y"):
        radius = bodies["A"][key]
        bodies["A"][key] = radius / share
        bodies["B"][key] = radius / (1.0 - share) if share != 1.0 else math.inf
    return meshed(scene.replace(body=bodies, subsurface=None, **tables), rng)


def steady(rng: np.random.Generator) -> ts.Scene:
    """Return a scene with creepages and spin; one scene in three has subsurface stress."""
    scene = moderate(rng)
    if rng.random() < 1 / 3:
        planes = ("y=0", "x=0.5a", "y=0.3b")
        scene = scene.replace(subsurface={"planes": planes, "elements": 6})
    return scene


def gentle(rng: np.random.Generator) -> ts.Scene:
    """Return dissimilar bodies at small creepage."""
    return meshed(gentle_scene(int(rng.integers(10**6)))[0], rng)


def hard(rng: np.random.Generator) -> ts.Scene:
    """Return extremes of geometry, moduli and friction; gaps are rough, worn or stepped."""
    return meshed(hard_scene(int(rng.integers(10**6)))[0], rng)


def forced(rng: np.random.Generator) -> ts.Scene:
    """Return a scene with one or two prescribed tangential forces."""
    scene = moderate(rng)
    limit = 0.9 * min(scene.friction.mu) * scene.load.normal
    turned, which = rng.uniform(0.0, 2.0 * np.pi), rng.integers(3)
    forces = {"force_x": limit * np.cos(turned), "force_y": limit * np.sin(turned)}
    creepage = scene.creepage.entries()
    for k, (force, key) in enumerate((("force_x", "longitudinal"), ("force_y", "lateral"))):
        if which == k:
            del forces[force]
        else:
            creepage.pop(key, None)
    return scene.replace(load={"normal": scene.load.normal} | forces, creepage=creepage)


def gap(rng: np.random.Generator) -> ts.Scene:
    """Return a scene with a measured gap that is rough, worn or stepped."""
    scene = moderate(rng)
    half = tuple(1.3 * length for length in scene.grid.half_length)
    kind = str(rng.choice(["rough", "worn", "steps"]))
    shape = _gap(rng, kind, half, scene.hertz)
    shape["separation"] = 0.3 * shape["separation"]
    return scene.replace(gap=shape, **{"grid.half_length": half})


def line(rng: np.random.Generator) -> ts.Scene:
    """Return dissimilar cylinders with a prescribed force or creepage; half of them wear."""
    scene = meshed(line_scene(int(rng.integers(10**6)))[0], rng, 15, 60)
    full = scene.friction.mu[0] * scene.hertz.p0 / scene.material.shear
    if rng.random() < 0.5:
        changes = {"load.force_x": None, "creepage.longitudinal": full * rng.uniform(-1.5, 1.5)}
        scene = scene.replace(**changes)
    if rng.random() < 0.5:
        scene = scene.replace(wear=wear_table(rng, scene, revolutions=6))
    return scene


def falling(rng: np.random.Generator) -> ts.Scene:
    """Return a scene with falling friction, memory, layer and strength."""
    scene = meshed(falling_scene(int(rng.integers(10**6))), rng)
    return scene.replace(**{"friction.start": str(rng.choice(["rest", "sliding"]))})


def thermal(rng: np.random.Generator) -> dict:
    """Return random thermal properties of a body."""
    return {
        "conductivity": log_uniform(rng, 5.0, 200.0),
        "density": log_uniform(rng, 2e3, 8e3),
        "heat_capacity": log_uniform(rng, 300.0, 1000.0),
    }


def heat(rng: np.random.Generator) -> ts.Scene:
    """Return a scene with flash temperature, and with friction and wear that depend on it."""
    scene = moderate(rng)
    bodies = scene.entries()["body"]
    for body in bodies.values():
        body["thermal"] = thermal(rng)
    changes: dict = {"body": bodies, "creepage.speed": log_uniform(rng, 100.0, 3e4)}
    changes["heat"] = {"bulk": {"A": rng.uniform(0.0, 80.0), "B": rng.uniform(0.0, 80.0)}}
    warmer = ((20.0, 1.0), (rng.uniform(100.0, 600.0), rng.uniform(0.3, 0.9)))
    if rng.random() < 0.5:
        changes["friction.temperature"] = warmer
    if rng.random() < 0.5:
        changes["wear"] = wear_table(rng, scene, 4) | {"temperature": warmer}
    return scene.replace(**changes)


def wear_table(rng: np.random.Generator, scene: ts.Scene, revolutions: int) -> dict:
    """Return a random wear law that removes a few per cent of the approach."""
    mu, hertz = max(scene.friction.mu), scene.hertz
    creep = max(abs(scene.creepage.longitudinal), abs(scene.creepage.lateral))
    creep = max(creep, abs(scene.creepage.spin) * hertz.a, mu * hertz.p0 / scene.material.shear)
    approach = hertz.a**2 / scene.body.radii[0]
    rate = 0.1 * approach / (2.0 * hertz.a * creep * hertz.p0 * revolutions) * rng.uniform(0.2, 1.0)
    rate_A, rate_B = rate, rate * rng.uniform(0.2, 1.0)
    work = mu * hertz.p0 * creep
    table: dict = {"revolutions": revolutions, "save": (0, revolutions)}
    table["turns"] = str(rng.choice(["each", "each", "equal"]))
    law = rng.integers(6)
    if law == 0:
        table["intensity"] = (rate_A, rate_B)
    elif law == 1:
        table["coefficient"] = {"A": 1e3 * rate_A, "B": 1e3 * rate_B}
    elif law == 2:
        table |= {"law": "energy", "coefficient": (1e3 * rate_A / mu, 1e3 * rate_B / mu)}
    elif law == 3:
        mass = 7.85e3 * rate * hertz.p0 * creep
        points = ((0.3 * work, 0.1 * mass), (work, mass), (2.0 * work, 1.5 * mass))
        table["law"] = {"table": points} if rng.random() < 0.5 else {"A": "table", "B": "archard"}
        if "A" in table["law"]:
            table["law"]["table"] = points
            table["coefficient"] = {"B": 1e3 * rate_B}
    else:
        table["intensity"] = rate_A
    return table


def wear(rng: np.random.Generator) -> ts.Scene:
    """Return a scene with wear in every revolution, with a random law."""
    scene = moderate(rng)
    bodies = scene.entries()["body"]
    bodies["A"]["hardness"], bodies["B"]["hardness"] = rng.uniform(0.3, 3.0, 2)
    table = wear_table(rng, scene, int(rng.integers(4, 9)))
    return scene.replace(body=bodies, wear=table | {"stepping": "every-revolution"})


def adaptive(rng: np.random.Generator) -> ts.Scene:
    """Return a scene with wear in adaptive jumps over many revolutions."""
    scene = wear(rng)
    table = wear_table(rng, scene, int(rng.integers(100, 400)))
    return scene.replace(wear=table)


def duty(rng: np.random.Generator) -> ts.Scene:
    """Return blocks with different loads, creepages, friction and positions; some have fatigue."""
    scene = wear(rng)
    count, cycles = int(rng.integers(2, 4)), int(rng.integers(2, 5))
    blocks = []
    for _ in range(count):
        block: dict = {"revolutions": int(rng.integers(1, 4))}
        if rng.random() < 0.6:
            block["load"] = {"normal": scene.load.normal * rng.uniform(0.6, 1.1)}
        block["creepage"] = {
            key: getattr(scene.creepage, key) * rng.uniform(-1.0, 1.5)
            for key in ("longitudinal", "lateral", "spin")
            if rng.random() < 0.5
        }
        if rng.random() < 0.3:
            block["friction"] = {"angle": rng.uniform(-90.0, 90.0)}
        block["shift_y"] = scene.hertz.b * rng.uniform(-0.5, 0.5)
        blocks.append(block)
    total = cycles * sum(block["revolutions"] for block in blocks)
    table = wear_table(rng, scene, total)
    if rng.random() < 0.5:
        table["stepping"] = "every-revolution"
    half = scene.grid.half_length
    changes = {"duty": blocks, "wear": table, "grid.half_length": (half[0], 1.5 * half[1])}
    if rng.random() < 0.4:
        changes["fatigue"] = fatigue_table(rng, scene)
    return scene.replace(**changes)


def fatigue_table(rng: np.random.Generator, scene: ts.Scene) -> dict:
    """Return a random criterion, with yield stress and limit near the stress of the contact."""
    p0 = scene.hertz.p0
    criteria = {"dang-van": 0.3, "crossland": 0.3, "findley": 0.4, "fatemi-socie": 0.5}
    table: dict = {"shear_yield": 0.25 * p0, "limit": 0.2 * p0, "exponent": rng.uniform(3.0, 8.0)}
    table |= {"elements": 8, "cycles": 1e4}
    criterion = str(rng.choice([*criteria, "orthogonal-shear"]))
    if criterion in criteria:
        table["sensitivity"] = criteria[criterion]
    return table | {"criterion": criterion}


def fatigue(rng: np.random.Generator) -> ts.Scene:
    """Return a scene with shakedown, utilisation and damage; half of the scenes have wear."""
    scene = wear(rng) if rng.random() < 0.5 else moderate(rng)
    elements = tuple(min(n, 17) for n in scene.grid.elements)
    return scene.replace(fatigue=fatigue_table(rng, scene), **{"grid.elements": elements})


def transient(rng: np.random.Generator) -> ts.Scene:
    """Return courses that roll, from rest or from steady rolling, with profiles and wear."""
    return courses(rng, rolls=True)


def shift(rng: np.random.Generator) -> ts.Scene:
    """Return courses of shifts."""
    return courses(rng, rolls=False)


def courses(rng: np.random.Generator, rolls: bool) -> ts.Scene:
    """Return a scene of `transient` with a course that is at most a few contact lengths long."""
    while True:
        scene = transient_scene(int(rng.integers(10**6)), int(rng.integers(11, 16)))
        if scene.schedule.shifts != rolls:
            return scene.replace(**{"solver.tolerance": TOLERANCE})


def layered(rng: np.random.Generator) -> ts.Scene:
    """Return bodies with layers, graded or with compliant interfaces; some wear."""
    scene = steady(rng)
    bodies = scene.entries()["body"]
    for name in str(rng.choice(["A", "B", "AB"])):
        bodies[name]["layer"] = [
            layer(rng, scene) for _ in range(int(rng.integers(1, 3)))
        ]  # fmt: skip
    changes: dict = {"body": bodies}
    if rng.random() < 0.3:
        changes["wear"] = wear_table(rng, scene, 3)
    return _widened(scene.replace(**changes))


def layer(rng: np.random.Generator, scene: ts.Scene) -> dict:
    """Return a random layer, stiffer or softer than the body."""
    size = scene.hertz.a
    table = {
        "thickness": size * log_uniform(rng, 0.1, 2.0),
        "shear": scene.material.shear * log_uniform(rng, 0.3, 4.0),
        "poisson": rng.uniform(0.1, 0.45),
    }
    kind = rng.integers(4)
    if kind == 0:
        table["gradient"] = "exponential"
    elif kind == 1:
        for key in ("shear_compliance", "normal_compliance"):
            table[key] = 0.1 * size / scene.material.shear * rng.random()
    return table


def relaxing(rng: np.random.Generator) -> ts.Scene:
    """Return bodies that relax; some have layers."""
    scene = layered(rng) if rng.random() < 0.3 else moderate(rng)
    bodies, speed = scene.entries()["body"], log_uniform(rng, 10.0, 1e4)
    for name in str(rng.choice(["A", "B", "AB"])):
        bodies[name]["relaxation"] = [
            {
                "ratio": log_uniform(rng, 0.1, 3.0),
                "time": scene.hertz.a / speed * log_uniform(rng, 0.1, 10.0),
            }
            for _ in range(int(rng.integers(1, 3)))
        ]
    return _widened(scene.replace(**{"body": bodies, "creepage.speed": speed}))


def anisotropic(rng: np.random.Generator) -> ts.Scene:
    """Return bodies of any anisotropy, with 21 constants."""
    scene = moderate(rng)
    bodies = scene.entries()["body"]
    for name in str(rng.choice(["A", "B", "AB"])):
        for key in ("young", "shear", "poisson"):
            bodies[name].pop(key, None)
        shear, share = scene.material.shear, 0.6 * rng.random()
        isotropic = np.diag([2.0, 2.0, 2.0, 1.0, 1.0, 1.0])
        isotropic[:3, :3] += 1.0
        root = rng.normal(size=(6, 6))
        constants = shear * ((1.0 - share) * isotropic + share * root @ root.T / 6.0)
        bodies[name]["stiffness"] = {
            f"C{i + 1}{j + 1}": float(constants[i, j]) for i in range(6) for j in range(i, 6)
        }
    return _widened(scene.replace(body=bodies))


def roller(rng: np.random.Generator) -> ts.Scene:
    """Return a roller with a profile and free ends against a cylinder."""
    width, radius = rng.uniform(3.0, 8.0), rng.uniform(4.0, 20.0)
    forms = [
        {"form": "logarithmic"},
        {"form": "crowned", "radius": 600.0, "flat": 0.4 * width},
        {"form": "crowned", "radius": 400.0, "chamfer": 0.05 * width},
    ]
    steel = {"young": 208e3, "poisson": rng.uniform(0.0, 0.45)}
    profile = forms[int(rng.integers(3))]
    bodies = {
        "A": steel
        | {"radius_x": radius, "radius_y": math.inf, "width": width}
        | {"profile": profile},
        "B": steel | {"radius_x": rng.uniform(10.0, 50.0), "radius_y": math.inf},
    }
    if rng.random() < 0.7:
        bodies["A"]["ends"] = str(rng.choice(["free", "quick"]))
    creepage = {"longitudinal": rng.uniform(-0.004, 0.004), "lateral": rng.uniform(-0.002, 0.002)}
    return ts.Scene(
        title="roller",
        body=bodies,
        load={"normal": 300.0 * width * rng.uniform(0.3, 1.5)},
        creepage=creepage,
        friction={"mu": (0.3, 0.2), "angle": rng.uniform(-60.0, 60.0)},
        grid={"elements": (int(rng.integers(11, 20)), int(rng.integers(21, 40)))},
        solver={"tolerance": TOLERANCE},
    )


def conformal(rng: np.random.Generator) -> ts.Scene:
    """Return a ball in a groove at an angle, which spins and rolls."""
    ball, groove = ts.Scene.builtin("ball-in-groove"), rng.uniform(1.03, 1.3)
    changes = {
        "body.B.radius_y": -5.0 * groove,
        "body.B.radius_x": rng.uniform(8.0, 50.0),
        "body.B.poisson": rng.uniform(0.1, 0.45),
        "conformal": {"angle": rng.uniform(-50.0, 50.0)},
        "load.normal": log_uniform(rng, 100.0, 2000.0),
        "creepage.longitudinal": rng.uniform(-0.002, 0.002),
        "creepage.lateral": rng.uniform(-0.001, 0.001),
        "creepage.spin": rng.uniform(-0.001, 0.001),
        "friction": {"mu": (0.3, 0.2), "angle": rng.uniform(-60.0, 60.0)},
        "grid": {"elements": (int(rng.integers(9, 15)), int(rng.integers(13, 25)))},
        "solver.tolerance": TOLERANCE,
    }
    return ball.replace(**changes)


def included(rng: np.random.Generator) -> ts.Scene:
    """Return bodies with inclusions near each other; some lift the surface."""
    scene = moderate(rng)
    size = scene.hertz.a
    inclusions = []
    for body in str(rng.choice(["A", "B", "AB", "BB"])):
        radii = size * rng.uniform(0.05, 0.15, 3)
        x, y = size * rng.uniform(-0.3, 0.3, 2)
        table: dict = {
            "body": body,
            "at": (x, y, size * rng.uniform(0.3, 0.8)),
            "radii": tuple(radii.tolist()),
            "cells": 5,
        }
        table["young"] = 2.6 * scene.material.shear * rng.uniform(0.0, 3.0)
        table["poisson"] = rng.uniform(0.1, 0.4)
        if rng.random() < 0.5:
            table["eigenstrain"] = (1e-3 * rng.normal(size=6)).tolist()
        table["lifts"] = bool(rng.random() < 0.5)
        inclusions.append(table)
    return scene.replace(inclusion=inclusions)


def _widened(scene: ts.Scene) -> ts.Scene:
    """Return a scene with a mesh for a contact that is larger than that of the bare bodies."""
    half = scene.grid.half_length
    return scene.replace(**{"grid.half_length": tuple(1.5 * length for length in half)})


KINDS: dict[str, Callable[[np.random.Generator], ts.Scene]] = {
    kind.__name__: kind
    for kind in (
        *(steady, gentle, hard, forced, gap, line, falling, heat),
        *(wear, adaptive, duty, fatigue, transient, shift),
        *(layered, relaxing, anisotropic, roller, conformal, included),
    )
}


GROUPS = {
    "load, forces": r"P|F[yz]|Q[xy](_over_P)?",
    "moment": "M[xyz]|tilt|end_load",
    "creepages": r"xi_[xy]|spin|creepage_found|shift_[xy]|turn",
    "pressure": r"pressure|p_max|p_95|approach",
    "tractions": r"traction_([xy]|bound)",
    "slip": r"slip_[xy]",
    "gap": r"gap",
    "contact": r"half_width_[xy]|area|stick_fraction|sliding",
    "work": r"(bulk_)?dissipation|work_supplied|t_gamma.*|step_(work|bulk)|.*friction(_work)?"
    r"|elastic_energy",
    "wear": r"wear(_max|_profile.*|_per_revolution)?|entering_profile|worn_by|measured_profile",
    "worn volume": r"worn_.*|step_worn|share",
    "stress": r"von_mises.*|interface_.*|inclusion_(?!it|co).*",
    "fatigue": r"shakedown.*|utilisation.*|damage|initiation|fatigue_life|fi_surf|balancing.*"
    r"|wear_margin",
    "temperature": r"temperature.*|heat.*",
}


def group_of(name: str) -> str | None:
    """Return the group of a quantity; None if the quantity is not compared."""
    plain = name.removeprefix("block_")
    return next((group for group, names in GROUPS.items() if re.fullmatch(names, plain)), None)


def natural_scale(name: str, outcome: Outcome) -> float:
    """Return the scale by which the difference of a quantity is divided."""

    def largest(*quantities: str) -> float:
        values = np.concatenate([np.ravel(outcome.values[quantity]) for quantity in quantities])
        return float(np.max(np.abs(values), where=np.isfinite(values), initial=0.0))

    friction = max(outcome.scene.friction.mu) if outcome.scene.friction else 0.0
    size = math.sqrt(largest("half_width_x") * (largest("half_width_y") or largest("half_width_x")))
    slips = max(largest("xi_x", "xi_y", "slip_x", "slip_y"), largest("spin") * size)
    if outcome.scene.schedule.shifts:  # if all elements stick, slip is rounding error
        slips = max(slips, largest("shift_x", "shift_y"))
    force = friction * largest("P")
    scales = {
        **dict.fromkeys(("Qx", "Qy"), force),
        **dict.fromkeys(("Qx_over_P", "Qy_over_P"), friction),
        "Mz": force * size,
        **dict.fromkeys(("Mx", "My"), largest("P") * max(size, largest("half_width_y"))),
        **dict.fromkeys(("Fy", "Fz"), largest("P")),
        **dict.fromkeys(("traction_x", "traction_y"), friction * largest("pressure")),
        **dict.fromkeys(("slip_x", "slip_y", "xi_x", "xi_y", "creepage_found"), slips),
        "spin": slips / (size or 1.0),
        "gap": largest("approach"),
        **dict.fromkeys(("dissipation", "work_supplied", "t_gamma"), force * slips),
        "t_gamma_over_area": force * slips / (largest("area") or 1.0),
    }
    plain = name.removeprefix("block_")
    return scales[plain] if plain in scales else largest(name) * _stored(name, outcome)


def _stored(name: str, outcome: Outcome) -> float:
    """Return the ratio of stored energy to frictional work of a transient, if it exceeds one.

    The frictional work is the supplied work minus the stored energy. Most of the supplied work may
    be stored, and wear is proportional to the frictional work.
    """
    work = np.abs(outcome.values.get("friction_work", np.zeros(1))).max(initial=0.0)
    of_work = ("friction_work", "step_friction")
    if work <= 0.0 or (name not in of_work and group_of(name) not in ("wear", "worn volume")):
        return 1.0
    return max(1.0, float(outcome.values["elastic_energy"].max() / work))


OF_A_STEP = re.compile(
    r"step_.*|xi_[xy]|spin|creepage_found|slip_[xy]|sliding|dissipation|work_supplied|t_gamma.*"
)
"""Sums, means and states of a step of a transient, which depend on the length of the step."""


def differences(
    first_outcome: Outcome, second_outcome: Outcome
) -> Iterator[tuple[str, str, float]]:
    """Yield the largest scaled difference of each quantity at the common coordinates."""
    same_steps = len(first_outcome.at) == len(second_outcome.at) and np.allclose(
        first_outcome.at, second_outcome.at
    )
    steps_differ = first_outcome.scene.transient is not None and not same_steps
    for name, values in first_outcome.values.items():
        group = group_of(name)
        if group is None or name not in second_outcome.values or not values.size:
            continue
        if steps_differ and OF_A_STEP.fullmatch(name):
            continue
        first, second = first_outcome.rows(name), second_outcome.rows(name)
        near = np.isclose(first[:, None], second[None, :], rtol=1e-9, atol=1e-12 * np.ptp(first))
        mine, theirs = near.any(axis=1), near.any(axis=0)
        a = last_of(first[mine], values[mine])
        b = last_of(second[theirs], second_outcome.values[name][theirs])
        if a.shape != b.shape or (np.isfinite(a) != np.isfinite(b)).any():
            yield group, f"{name}: known in one of both only", math.inf
            continue
        comparable = np.isfinite(a)
        if name.startswith("slip_"):  # of an element on the edge only one may touch
            comparable &= touching(first_outcome, mine, first) & touching(
                second_outcome, theirs, second
            )
        apart = float(np.max(np.abs(a[comparable] - b[comparable]), initial=0.0))
        scale = natural_scale(name, first_outcome)
        yield group, name, apart / scale if scale else (math.inf if apart else 0.0)


def touching(outcome: Outcome, rows: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return the elements that are in contact in some rows of the fields."""
    return last_of(at[rows], outcome.values["pressure"][rows]) > 0.0


def last_of(at: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return the last row at each coordinate; a jump has two rows."""
    last = np.append(np.diff(at) > 1e-12 * np.ptp(at), True) if len(at) else []
    return values[np.asarray(last, bool)]


def bound_of(change: Change, scene: ts.Scene, group: str) -> float:
    """Return the largest allowed difference, relative to the natural scale."""
    fatigue, wear = scene.fatigue, scene.wear
    adaptive = wear is not None and scene.transient is None and wear.stepping == "adaptive"
    # A residual of 1e-10 times what the operators amplify it by.
    bound = 1e3 * TOLERANCE
    if adaptive:
        # Contacts are solved to a part of the error that a jump may have.
        bound = 0.1 * wear.tolerance
    if group == "stress":
        # The search inside the body takes elements together (`subsurface.sources`).
        bound = max(bound, 6e-4)
    if group == "fatigue" and fatigue is not None:
        # A critical plane is found to 1e-4, and life is a power of the stress.
        planes = fatigue.criterion in ("findley", "fatemi-socie")
        bound = (max(bound, 1e-4) if planes else bound) * fatigue.exponent
    if change is SAVE and adaptive:
        # Other jumps: each of both rolls is off by up to twice the tolerance; damage has its own.
        bound = max(bound, 4.0 * wear.tolerance)
        if group == "fatigue":
            bound = max(bound, fatigue.tolerance) * fatigue.exponent
    if change is STEP:
        bound = OF_STEPS[group]
    return bound


OF_STEPS = {
    **dict.fromkeys(("load, forces", "moment", "pressure", "gap", "creepages"), 0.05),
    **dict.fromkeys(("tractions", "contact", "work", "slip"), 0.25),
    "worn volume": 0.5,
    "wear": 1.0,
}
"""Bounds for half the step. Its error is of first order: most steps are one element long, which
is a tenth of the contact, and courses change over this length. The depth of a single row or
element changes most.
"""


def random_scene(kind: str, seed: int, number: int) -> ts.Scene:
    """Return a valid scene of a kind, which depends only on the seed and the number."""
    rng = np.random.default_rng([seed, number])
    while True:
        try:
            return KINDS[kind](rng)
        except (
            ts.SceneError
        ):  # for example a force beyond friction, or keys that exclude each other
            continue


def compared(scene: ts.Scene, changes: Iterable[Change] = CHANGES) -> Iterator[dict]:
    """Yield the largest difference of each group of quantities for each change, with its bound."""
    try:
        outcome = Outcome.of(scene)
    except ts.SceneError as refused:
        yield _row("as it is", "refused", str(refused).splitlines()[-1])
        return
    if outcome.status != "done":
        yield _row("as it is", "refused", outcome.status)
        return
    for change in changes:
        if not change.applies(scene):
            continue
        changed_outcome = change.back(Outcome.of(change.scene(scene)))
        if changed_outcome.status != outcome.status:
            yield _row(change.name, "status", changed_outcome.message, math.inf)
            continue
        worst: dict[str, tuple[float, str]] = defaultdict(lambda: (-1.0, ""))
        for group, name, apart in differences(outcome, changed_outcome):
            worst[group] = max(worst[group], (apart, name))
        for group, (apart, name) in worst.items():
            yield _row(change.name, group, name, apart, bound_of(change, scene, group))


def _row(change: str, group: str, name: str, difference: float = 0.0, bound: float = 0.0) -> dict:
    """Return the result of one comparison."""
    row = {"change": change, "group": group, "quantity": name}
    return row | {"difference": difference, "bound": bound, "holds": difference <= bound}


def campaign(count: int, seed: int, kinds: list[str], part: Path) -> list[dict]:
    """Return the rows of all scenes; rows in `part` are not computed again."""
    rows: list[dict] = []
    if part.exists():
        with part.open(newline="") as file:
            rows = [_read(row) for row in csv.DictReader(file)]
        last = max((row["scene"] for row in rows), default=-1)
        rows = [row for row in rows if row["scene"] < last]  # the last one may be cut
    for number in range(1 + max((row["scene"] for row in rows), default=-1), count):
        kind = kinds[number % len(kinds)]
        about = {"scene": number, "kind": kind}
        rows += [about | row for row in compared(random_scene(kind, seed, number))]
        write(part.stem, rows)
        print(f"\r{number + 1} of {count} scenes", end="", flush=True)
    print()
    return rows


def _read(row: dict[str, str]) -> dict:
    """Return a row of a file with its numbers."""
    numbers = {"scene": int(row["scene"])} | {k: float(row[k]) for k in ("difference", "bound")}
    return row | numbers | {"holds": row["holds"] == "True"}


def largest(rows: list[dict]) -> list[dict]:
    """Return the largest difference for each kind, change and group, with its source."""
    by_kind: dict[tuple, list[dict]] = defaultdict(list)
    for row in rows:
        if row["change"] != "as it is":
            by_kind[row["kind"], row["change"], row["group"]].append(row)
    table = []
    for of in by_kind.values():
        worst = max(of, key=lambda row: row["difference"] / (row["bound"] or 1.0))
        broken = sum(not row["holds"] for row in of)
        names = ("kind", "change", "group", "quantity", "difference", "bound", "scene")
        table.append({k: worst[k] for k in names} | {"scenes": len(of), "broken": broken})
    return table


def by_group(table: list[dict]) -> Iterator[dict]:
    """Return the largest differences over all kinds, with one column for each change."""
    for group in (*GROUPS, "status"):
        of = [row for row in table if row["group"] == group]
        columns = {}
        for change in CHANGES:
            values = [row["difference"] for row in of if row["change"] == change.name]
            columns[change.name] = max(values) if values else ""
        if of:
            yield {"quantity": group, **columns}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=400)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--name", default="invariance")
    settings = parser.parse_args()
    warnings.simplefilter("ignore")  # of coarse meshes
    part = RESULTS / f"{settings.name}.part.csv"
    rows = campaign(settings.scenes, settings.seed, settings.kinds.split(","), part)
    refused = Counter(row["kind"] for row in rows if row["group"] == "refused")
    scenes = Counter(row["kind"] for row in {row["scene"]: row for row in rows}.values())
    table = largest(rows)
    show("Scenes", [{"kind": k, "scenes": n, "refused": refused[k]} for k, n in scenes.items()])
    for kind in scenes:
        show(f"Largest differences: {kind}", by_group([r for r in table if r["kind"] == kind]))
    show("Largest differences: all kinds", by_group(table))
    print(f"written: {write(settings.name, table)}")
    part.unlink()
    if broken := [row for row in rows if not row["holds"]]:
        show("Above their bounds", broken)
        sys.exit(1)


if __name__ == "__main__":
    main()
