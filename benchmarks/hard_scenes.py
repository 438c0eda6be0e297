"""Random hard scenes: which methods converge, and at what cost.

Half of the scenes have bodies of equal material, so that the tractions do not change the pressure;
the others have arbitrary materials. Each method solves to a residual of 1e-8 without an initial
guess. `uzawa` and `anderson` have `BUDGET` iterations for every correction of the load and do not
accept prescribed tangential forces. `alternating` solves the normal problem with the last tractions
and then the tangential problem with the new pressure; the coupled methods replace it. Costs are
applications of operators and of their approximate inverses.

Two further families, with a sixth as many scenes each, have dissimilar bodies throughout. Scenes of
the family *gentle* have creepage and spin of 0.1 to 1 % of full slip, or a combination of creepages
of any size. Scenes of the family *line* roll freely, or with hardly any force, at mu from 1e-4.

    python benchmarks/hard_scenes.py [--scenes 600] [--first 0] [--methods auto,newton]

Page: docs/validation.md
"""

import argparse
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from itertools import chain

import numpy as np
from timing import show, write

from tractive_sam.contact import Model, equilibrium
from tractive_sam.results.state import Status
from tractive_sam.run import read_measured_gap
from tractive_sam.scene import Scene
from tractive_sam.solvers import Anderson, ProblemSolver, Uzawa
from tractive_sam.solvers.ladder import METHODS as NAMED

BUDGET = 2_000
GAPS = ("smooth", "smooth", "rough", "worn", "steps")
DRIVES = ("creepage", "creepage", "spin", "both", "force")


def hard_scene(seed: int) -> tuple[Scene, dict]:
    """Return a hard scene and its parameters, which depend only on the seed.

    Aspect ratios a/b are 0.05-20, mu is 0.001-2, mu1/mu2 is up to 10 (every tenth up to 100),
    creepage and spin are 1e-8 to 100 times full slip, Poisson's ratios are 0-0.4999, and E_A/E_B is
    1e-3-1e3. Gaps are smooth, rough, worn or stepped, contacts have a few elements or more, and
    tangential forces may be prescribed.
    """
    rng = np.random.default_rng(seed)

    def log_uniform(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    aspect = log_uniform(0.05, 20.0)
    young, poisson = 2e5, rng.uniform(0.0, 0.4999, 2)
    ratio = log_uniform(1e-3, 1e3)
    if seed % 2 == 0:
        ratio, poisson[1] = 1.0, poisson[0]
    mu = log_uniform(1e-3, 2.0)
    orthotropy = 1.0
    if seed % 3:
        orthotropy = log_uniform(1.0, 100.0 if seed % 10 == 0 else 10.0)
    angle = rng.uniform(-180.0, 180.0)
    # b/a = (R_y/R_x)^(2/3), nearly.
    radii = {"radius_x": 10.0, "radius_y": 10.0 * aspect**-1.5}
    flat = {"radius_x": np.inf, "radius_y": np.inf}
    tables = {
        "title": f"hard scene {seed}",
        "body": {
            "A": {"young": young, "poisson": poisson[0]} | radii,
            "B": {"young": young * ratio, "poisson": poisson[1]} | flat,
        },
        # Of the order of 1e-4 to 1e-2 of the radius.
        "load": {"normal": 1.0},
        "friction": {"mu": (mu, mu / orthotropy), "angle": angle},
        "solver": {"tolerance": 1e-8},
    }
    unit_load = Scene(**tables).hertz
    smaller = min(unit_load.a, unit_load.b) / min(radii.values())
    tables["load"]["normal"] = (log_uniform(1e-4, 0.05) / smaller) ** 3
    hertz = Scene(**tables).hertz

    elements = rng.choice((25, 31, 35, 41), 2)
    few = rng.random() < 0.15
    margin = rng.uniform(4.0, 10.0) if few else rng.uniform(1.2, 1.6)
    gap = str(rng.choice(GAPS))
    if gap != "smooth":
        margin *= 1.5
    half_length = (margin * hertz.a, margin * hertz.b)
    tables["grid"] = {"half_length": half_length, "elements": tuple(int(n) for n in elements)}
    if gap != "smooth":
        tables["gap"] = _gap(rng, gap, half_length, hertz)

    # Full slip begins at about mu p0/G, and at as much spin times the semi-axis.
    full = mu * hertz.p0 / Scene(**tables).material.shear
    drive = str(rng.choice(DRIVES))
    amount = log_uniform(1e-8, 100.0 * max(full, 1e-8))
    turned = rng.uniform(0.0, 2.0 * np.pi)
    creepage = {"longitudinal": amount * np.cos(turned), "lateral": amount * np.sin(turned)}
    spin = log_uniform(1e-8, 100.0 * max(full, 1e-8)) / np.sqrt(hertz.a * hertz.b)
    if drive == "spin":
        creepage = {"spin": spin}
    elif drive == "both":
        creepage["spin"] = spin
    elif drive == "force":
        creepage = {}
        share = rng.uniform(0.01, 0.97)
        carried = share * tables["load"]["normal"] * mu / orthotropy
        tables["load"] |= {
            "force_x": carried * np.cos(turned),
            "force_y": carried * np.sin(turned),
        }
    tables["creepage"] = creepage
    scene = Scene(**tables)
    return scene, _parameters(scene, "hard", seed, gap, drive, few)


def gentle_scene(seed: int) -> tuple[Scene, dict]:
    """Return dissimilar bodies with small creepage, small spin or combined creepages."""
    rng = np.random.default_rng([seed, 1])
    aspect, mu = 10.0 ** rng.uniform(-0.7, 0.7), 10.0 ** rng.uniform(-2.0, 0.0)
    drive = ("creepage", "spin", "both")[seed % 3]
    scene = Scene(
        title=f"gentle scene {seed}",
        body={
            "A": {"young": 2e5, "poisson": rng.uniform(0.0, 0.49)}
            | {"radius_x": 10.0, "radius_y": 10.0 * aspect**-1.5},
            "B": {"young": 2e5 * 10.0 ** rng.uniform(-1.0, 1.0), "poisson": rng.uniform(0.0, 0.49)}
            | {"radius_x": np.inf, "radius_y": np.inf},
        },
        load={"normal": 10.0 * min(1.0, aspect**-3)},
        friction={"mu": (mu, mu * rng.uniform(0.25, 1.0)), "angle": rng.uniform(-180.0, 180.0)},
        solver={"tolerance": 1e-8},
    )
    hertz = scene.hertz
    full = mu * hertz.p0 / scene.material.shear
    small, turned = full * 10.0 ** rng.uniform(-3.0, -2.0), rng.uniform(0.0, 2.0 * np.pi)
    spin = small / np.sqrt(hertz.a * hertz.b)
    if drive == "both":
        small, spin = full * 10.0 ** rng.uniform(-1.0, 1.0), spin * 10.0 ** rng.uniform(1.0, 3.0)
    creepage = {"longitudinal": small * np.cos(turned), "lateral": small * np.sin(turned)}
    creepage = {"creepage": creepage, "spin": {"spin": spin}, "both": creepage | {"spin": spin}}
    grid = {"half_length": (1.2 * hertz.a, 1.2 * hertz.b), "elements": (41, 35)}
    scene = scene.replace(creepage=creepage[drive], grid=grid)
    return scene, _parameters(scene, "gentle", seed, "smooth", drive)


def line_scene(seed: int) -> tuple[Scene, dict]:
    """Return dissimilar cylinders that transmit almost no force, with little friction."""
    rng = np.random.default_rng([seed, 2])
    mu, poisson = 10.0 ** rng.uniform(-4.0, -1.0), rng.uniform(0.0, 0.45, 2)
    force = 0.0 if seed % 2 == 0 else mu * 100.0 * 10.0 ** rng.uniform(-6.0, -1.0)
    round_bar = {"radius_x": 50.0, "radius_y": np.inf}
    scene = Scene(
        title=f"line scene {seed}",
        body={
            "A": {"young": 7e4, "poisson": poisson[0]} | round_bar,
            "B": {"young": 7e4 * 10.0 ** rng.uniform(0.2, 1.5), "poisson": poisson[1]} | round_bar,
        },
        load={"normal": 100.0, "force_x": force},
        friction={"mu": mu},
        solver={"tolerance": 1e-8},
    )
    elements = int(rng.choice((33, 65, 129, 257, 589)))
    grid = {"half_length": 1.2 * scene.hertz.a, "elements": elements}
    scene = scene.replace(grid=grid)
    return scene, _parameters(scene, "line", seed, "smooth", "force")


FAMILIES = {"hard": hard_scene, "gentle": gentle_scene, "line": line_scene}


def _parameters(
    scene: Scene, family: str, seed: int, gap: str, drive: str, few: bool = False
) -> dict:
    body, material, hertz = scene.body, scene.material, scene.hertz
    slip = 0.0 if drive == "force" else _rigid(scene)
    mu, line = scene.friction.mu, family == "line"
    return {
        "family": family,
        "seed": seed,
        "gap": gap,
        "drive": drive,
        "a/b": 0.0 if line else hertz.a / hertz.b,
        "mu1": mu[0],
        "mu1/mu2": mu[0] / mu[1],
        "angle": scene.friction.angle,
        "K/G*": material.coupling / (1.0 - material.poisson),
        "nu_A": body.A.poisson,
        "nu_B": body.B.poisson,
        "E_B/E_A": body.B.young / body.A.young,
        "slip/full": slip / (mu[0] * hertz.p0 / material.shear),
        "few elements": few,
    }


def _rigid(scene: Scene) -> float:
    creepage, hertz = scene.creepage, scene.hertz
    spin = creepage.spin * np.sqrt(hertz.a * hertz.b)
    return float(np.linalg.norm([creepage.longitudinal, creepage.lateral, spin]))


def _gap(rng, kind: str, half_length, hertz) -> dict:
    """Return a separation with features of the size of the approach."""
    x, y = (np.linspace(-1.05 * length, 1.05 * length, 64) for length in half_length)
    X, Y = np.meshgrid(x / half_length[0], y / half_length[1], indexing="ij")
    height = hertz.approach * rng.uniform(0.1, 1.0)
    if kind == "rough":
        waves = rng.normal(0.0, 4.0, (40, 2)), rng.uniform(0.0, 2.0 * np.pi, 40)
        shape = sum(
            np.cos(np.pi * (k * X + m * Y) + phase) / np.sqrt(1.0 + k * k + m * m)
            for (k, m), phase in zip(*waves, strict=True)
        )
        shape = shape / np.abs(shape).max()
    elif kind == "worn":
        # A groove as a wheel wears it, with a ripple on its floor.
        width = rng.uniform(0.2, 0.6)
        floor = 1.0 + 0.2 * np.cos(2.0 * np.pi * rng.uniform(1.0, 8.0) * Y)
        shape = floor * np.maximum(1.0 - (Y / width) ** 2, 0.0)
    else:
        # Terraces, higher and lower, along a line at any angle.
        turned = rng.uniform(0.0, np.pi)
        along = X * np.cos(turned) + Y * np.sin(turned)
        edges = np.sort(rng.uniform(-0.8, 0.8, 4))
        shape = rng.uniform(-1.0, 1.0, 5)[np.searchsorted(edges, along)]
    return {"x": x, "y": y, "separation": height * shape}


def by_library(method: str, scene: Scene, model: Model):
    """Solve with the option `solver.method` of the package."""
    model = Model(scene.replace(**{"solver.method": method}), model.measured)
    contact = equilibrium(model, check_resolution=False)
    cost = contact.cost.applications + contact.cost.preconditioner
    # A contact that reaches the edge of the mesh is solved, for a body that ends there.
    solved = contact.status in (Status.CONVERGED, Status.OFF_GRID)
    reason = "" if solved else contact.message
    return solved, contact.residual, cost, " > ".join(contact.trace), reason


def by_projection(solver: ProblemSolver, scene: Scene, model: Model):
    """Solve for pressure and tractions together by the method of Uzawa or Anderson."""
    if len(model.forces):
        return None  # solves for given creepages only
    try:
        outcome = solver.solve(model.problem(model.undeformed_gap / model.units.gap), 1e-8)
    except FloatingPointError:
        return False, np.nan, np.nan, "", "not finite"
    reason = "" if outcome.converged else str(outcome.status)
    return outcome.converged, outcome.residual, outcome.cost.applications, "", reason


def alternating(scene: Scene, model: Model):
    """Solve the normal and the tangential problem alternately, each with the other's result."""
    gap = model.undeformed_gap / model.units.gap
    first, cost, error = None, 0.0, np.inf
    for _ in range(100):
        lift = 0.0
        if first is not None:
            tractions = np.concatenate((np.zeros((1, *gap.shape)), first.traction))
            lift = model.operators.coupled(tractions)[0]
        outcome = NAMED["auto"].alike.solve(model.problem(gap + lift), 1e-9, first)
        cost += outcome.cost.applications + outcome.cost.preconditioner
        if not outcome.converged:
            return False, error, cost, "", "normal or tangential problem not solved"
        if not model.elasticity.coupled:
            return True, outcome.residual, cost, "", ""
        if first is not None:
            here, before = (np.stack((o.pressure, *o.traction)) for o in (outcome, first))
            error = np.linalg.norm(here - before) / np.linalg.norm(here)
        first = outcome
        if error <= 1e-8:
            return True, error, cost, "", ""
        if cost > 3 * BUDGET:
            break
    return False, error, cost, "", "does not settle"


METHODS: dict[str, Callable] = {
    "uzawa": partial(by_projection, Uzawa(iterations=BUDGET)),
    "anderson": partial(by_projection, Anderson(iterations=BUDGET)),
    "alternating": alternating,
    "newton": partial(by_library, "newton"),
    "auto": partial(by_library, "auto"),
}


def campaign(family: str, seeds: range, methods: list[str]) -> Iterator[dict]:
    """Solve every scene of a family by every method, and return one row each."""
    for seed in seeds:
        scene, parameters = FAMILIES[family](seed)
        for name in methods:
            model = Model(scene, read_measured_gap(scene))
            solved = METHODS[name](scene, model)
            if solved is None:
                continue
            converged, residual, cost, trace, reason = solved
            yield parameters | {
                "method": name,
                "converged": converged,
                "residual": float(residual),
                "applications": float(cost),
                "trace": trace,
                "reason": reason,
            }


def summary(rows: list[dict], of: Callable[[dict], bool]) -> list[dict]:
    """Return the success and cost of each method for some of the scenes."""
    table = []
    for name in METHODS:
        mine = [row for row in rows if row["method"] == name and of(row)]
        if not mine:
            continue
        cost = [row["applications"] for row in mine if row["converged"]] or [np.nan]
        table.append(
            {
                "method": name,
                "scenes": len(mine),
                "converged": sum(row["converged"] for row in mine),
                "rate": f"{np.mean([row['converged'] for row in mine]):.1%}",
                "median cost": float(np.median(cost)),
                "90 %": float(np.quantile(cost, 0.9)),
                "largest": float(np.max(cost)),
            }
        )
    return table


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=600)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--methods", default=",".join(METHODS))
    parser.add_argument("--name", default="hard_scenes")
    options = parser.parse_args()
    warnings.simplefilter("ignore")  # of coarse meshes
    counts = {"hard": options.scenes, "gentle": options.scenes // 6, "line": options.scenes // 6}
    methods, rows = options.methods.split(","), []
    seeds = {name: range(options.first, options.first + count) for name, count in counts.items()}
    for row in chain(*(campaign(name, those, methods) for name, those in seeds.items())):
        rows.append(row)
        if row["method"] == "auto" and not row["converged"]:
            values = {k: v if isinstance(v, str | int) else f"{v:.3g}" for k, v in row.items()}
            print("auto failed:", values, flush=True)
    print(f"written: {write(options.name, rows)}")
    show("All scenes", summary(rows, lambda row: True))
    hard = [row for row in rows if row["family"] == "hard"]
    show("Hard scenes, equal material", summary(hard, lambda row: row["seed"] % 2 == 0))
    show("Hard scenes, dissimilar bodies", summary(hard, lambda row: row["seed"] % 2 == 1))
    for family in ("gentle", "line"):
        show(f"Family {family}", summary(rows, lambda row, name=family: row["family"] == name))
    traces = Counter(row["trace"] for row in rows if row["method"] == "auto")
    show("Steps of auto", [{"scenes": n, "trace": name} for name, n in traces.most_common()])


if __name__ == "__main__":
    main()
