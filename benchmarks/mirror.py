"""Is the solution of dissimilar bodies the same as that of its mirror image in y?

The mirror image has the other sign of lateral creepage, spin and the angle of friction; its fields
are those of the scene in the opposite order of the rows. Two families, on small meshes:

* *creepages*: 57 random creepages and spins of one geometry;
* *scenes*: 200 random dissimilar scenes of other geometries, materials, friction, meshes and both
  slip schemes; every fifth one is a short transient, whose last step is compared.

Differences are the largest ones of pressure and tractions over the peaks of both, and of the forces
over mu P and the spin moment over mu P and the half length. `open` counts elements with a pressure
whose gap is not closed to the tolerance. `restart` is the largest difference of tractions between
the scene solved from nothing and the same scene started from the solution under 2 % more load, of
steady contacts. Applications are those of the elastic operator, from nothing.

    python benchmarks/mirror.py [--creepages 57] [--scenes 200]
"""

import argparse
import warnings

import numpy as np
from timing import show, write

import tractive_sam as ts
from tractive_sam.contact import Model, equilibrium

TOLERANCE = 1e-10
"""Of the solver: differences are some ten times the residual."""

ODD = (("creepage", "lateral"), ("creepage", "spin"), ("friction", "angle"))
"""Keys whose sign the mirror changes."""


def creepage_scene(seed: int) -> dict:
    """Return the tables of one of the random creepages of one geometry."""
    rng = np.random.default_rng(seed)
    a = {"young": 208e3, "poisson": 0.3, "radius_x": 30.0, "radius_y": 40.0}
    b = {"young": 400e3, "poisson": 0.24, "radius_x": 50.0, "radius_y": 25.0}
    return {
        "body": {"A": a, "B": b},
        "load": {"normal": 300.0},
        "creepage": {
            "longitudinal": rng.normal() * 1e-3,
            "lateral": rng.normal() * 1e-3,
            "spin": rng.normal() * 5e-3,
        },
        "friction": {"mu": [0.4, 0.25], "angle": rng.uniform(-45.0, 45.0)},
        "grid": {"half_length": [0.68, 0.62], "elements": [25, 25]},
        "solver": {"tolerance": TOLERANCE},
    }


def random_scene(seed: int) -> dict:
    """Return the tables of a random dissimilar scene."""
    rng = np.random.default_rng(10_000 + seed)
    body = {
        name: {
            "young": 2e5 * np.exp(rng.uniform(-2.0, 2.0)),
            "poisson": rng.uniform(0.0, 0.45),
            "radius_x": rng.uniform(10.0, 60.0),
            "radius_y": rng.uniform(10.0, 60.0),
        }
        for name in "AB"
    }
    mu = rng.uniform(0.1, 0.6)
    tables = {
        "body": body,
        "load": {"normal": rng.uniform(50.0, 500.0)},
        "friction": {
            "mu": [mu, mu * rng.uniform(0.4, 1.0)],
            "angle": rng.uniform(-90.0, 90.0),
        },
    }
    hertz = ts.Scene(**tables).hertz
    full = mu * hertz.approach / hertz.mean_semi_axis
    tables["creepage"] = {
        "longitudinal": full * rng.normal(),
        "lateral": full * rng.normal(),
        "spin": full * rng.normal() / hertz.mean_semi_axis * rng.integers(0, 2),
    }
    tables["grid"] = {
        "half_length": [1.25 * hertz.a, 1.25 * hertz.b],
        "elements": [int(n) for n in rng.integers(13, 30, 2)],
    }
    tables["solver"] = {"tolerance": TOLERANCE, "slip": ("auto", "upwind")[seed % 2]}
    if seed % 5 == 4:
        tables["transient"] = {"distance": [0.0, 0.3 * hertz.a]}
    return tables


def mirrored(tables: dict) -> dict:
    """Return the tables of the mirror image."""
    image = {name: dict(table) for name, table in tables.items()}
    for table, key in ODD:
        image[table][key] = -image[table][key]
    return image


def solve(tables: dict) -> tuple[ts.State, float]:
    """Return the contact of a scene, the last one of a transient, and the applications it took."""
    scene = ts.Scene(**tables)
    if scene.transient is None:
        contact = ts.solve(scene, throw=False)
        return contact, contact.cost.applications
    history = ts.roll(scene, progress=False)
    return history.state(), float(history["operator_applications"].sum())


def still_open(contact: ts.State) -> int:
    """Return how many elements have a pressure and a gap that is not closed."""
    closed = 1e3 * TOLERANCE * contact.approach
    return int(np.count_nonzero((contact.pressure > 0.0) & (np.abs(contact.gap) > closed)))


def restarted(contact: ts.State) -> ts.State:
    """Return the same contact, solved from the solution under 2 % more load."""
    if contact.scene.transient is not None:
        return contact
    more = contact.scene.replace(**{"load.normal": 1.02 * contact.P})
    nearby = ts.solve(more, throw=False)
    return equilibrium(Model(contact.scene, grid=contact.grid), start=nearby)


def compared(family: str, seed: int, tables: dict) -> dict:
    """Return a row of the results: a scene beside its mirror image."""
    contact, applications = solve(tables)
    image, _ = solve(mirrored(tables))
    again = restarted(contact)
    sign = np.array([1.0, -1.0])[:, None, None]
    peak = np.abs(contact.traction).max()
    traction = np.abs(contact.traction - sign * image.traction[:, :, ::-1]).max()
    restart = np.abs(contact.traction - again.traction).max()
    pressure = np.abs(contact.pressure - image.pressure[:, ::-1]).max()
    unit = contact.scene.friction.mu[0] * contact.P
    forces = contact.Qx - image.Qx, contact.Qy + image.Qy
    lever = contact.grid.half_length[1]
    return {
        "family": family,
        "seed": seed,
        "slip": contact.scene.solver.slip,
        "elements": "x".join(map(str, contact.grid.elements)),
        "converged": contact.converged and image.converged,
        "open": still_open(contact) + still_open(image),
        "touching": int(contact.touching.sum()),
        "touching_image": int(image.touching.sum()),
        "pressure": float(pressure / contact.p_max),
        "traction": float(traction / peak),
        "restart": float(restart / peak),
        "forces": float(np.abs(forces).max() / unit),
        "moment": float(abs(contact.Mz + image.Mz) / (unit * lever)),
        "applications": applications,
    }


def summary(rows: list[dict]) -> list[dict]:
    """Return the largest differences of each family."""
    out, sizes = [], ("pressure", "traction", "restart", "forces", "moment")
    for family in dict.fromkeys(row["family"] for row in rows):
        of = [row for row in rows if row["family"] == family]
        out.append(
            {
                "family": family,
                "scenes": len(of),
                "converged": sum(row["converged"] for row in of),
                "with open elements": sum(row["open"] > 0 for row in of),
                "differ by over 1e-8": sum(max(row[k] for k in sizes[:3]) > 1e-8 for row in of),
                **{k: max(row[k] for row in of) for k in sizes},
                "applications": float(np.mean([row["applications"] for row in of])),
            }
        )
    return out


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--creepages", type=int, default=57)
    parser.add_argument("--scenes", type=int, default=200)
    parser.add_argument("--name", default="mirror", help="of the file of results")
    given = parser.parse_args()
    warnings.simplefilter("ignore", ts.SceneWarning)
    rows = [compared("creepages", k, creepage_scene(k)) for k in range(given.creepages)]
    rows += [compared("scenes", k, random_scene(k)) for k in range(given.scenes)]
    show("A scene beside its mirror image in y, largest differences", summary(rows))
    print(f"written: {write(given.name, rows)}")


if __name__ == "__main__":
    main()
