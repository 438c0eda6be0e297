"""Conservation of every process, and the laws of random wheel scenes.

Each row is a process and a quantity that is conserved, with the largest relative error over all of
its records and its stated tolerance:

- energy: dissipated over supplied work; in transients with the elastic energy;
- wear: the worn section or volume over that of the frictional work;
- heat: the heat into both bodies over the frictional work;
- load, moment: the vertical force of all patches over the load, and the moment of both wheels about
  a free axle over that of full sliding.

``wheels [SEED ...]`` computes 30 random wheel scenes for each seed: positions, loads, profiles at 1
to 20 points per mm, worn profiles. The load is shared, the mirrored wheelset has the same contacts,
and material is conserved.

Page: docs/validation.md
"""

import sys
import warnings
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from timing import show, write

import tractive_sam as ts
from tractive_sam.rail import builtin_profile

STEEL = {"young": 210e3, "poisson": 0.28}
MESH = {"grid.elements": [25, 25], "grid.half_length": None}


def error_of(balance: np.ndarray) -> float:
    """Return the largest difference of a balance from 1 over the records that have one."""
    finite = balance[np.isfinite(balance)]
    return float(np.abs(finite - 1.0).max())


def roll(name: str, **changes: object) -> ts.History:
    """Roll a built-in scene with changes, a double underscore for the point of a key."""
    entries = {key.replace("__", "."): value for key, value in changes.items()}
    return ts.roll(ts.Scene.builtin(name).replace(**entries), progress=False)


def measure_processes() -> list[dict[str, object]]:
    """Return a row for each process and balance."""
    rows = []

    def add(process: str, balance: str, error: float, tolerance: float) -> None:
        rows.append(
            {"process": process, "balance": balance, "error": error, "tolerance": tolerance}
        )

    for title, name in (
        ("steady rolling", "spheres"),
        ("steady rolling, orthotropic", "spheres-orthotropic"),
        ("steady rolling, unlike bodies", "spheres-dissimilar"),
        ("steady rolling, falling friction", "locomotive"),
        ("line contact", "cylinders"),
    ):
        scene = ts.Scene.builtin(name).replace(subsurface=None, fatigue=None)
        history = ts.roll(scene, progress=False)
        add(title, "energy", error_of(history.energy_balance), 1e-6)
    for title, name in (("orthotropic", "twin-discs"), ("isotropic", "twin-discs-isotropic")):
        history = roll(
            name, wear__revolutions=500, wear__save=(0, 500), subsurface=None, fatigue=None
        )
        add(f"steady wear, {title}", "energy", error_of(history.energy_balance), 1e-6)
        add(f"steady wear, {title}", "wear", error_of(history.wear_balance), 1e-3)
    blocks = ({"revolutions": 60}, {"revolutions": 40, "load": {"normal": 450.0}})
    history = roll(
        *("twin-discs-isotropic",),
        **{"wear__revolutions": 500, "wear__save": (0, 500), "duty": blocks},
        subsurface=None,
        fatigue=None,
    )
    for k in range(2):
        add(f"duty, block {k + 1}", "energy", error_of(history.block(k).energy_balance), 1e-6)
    passes = history["worn_area"][-1]
    work = sum(share * history.block(k)["dissipation"][-1] for k, share in enumerate((0.6, 0.4)))
    per_work = history.scene.wear.per_work(history.scene.friction.mu)[0]
    add("duty, cycle", "wear", abs(passes / (per_work * work) - 1.0), 1e-3)
    history = roll("traction-control", subsurface=None, fatigue=None)
    add("transient", "energy", error_of(history.energy_balance), 1e-6)
    history = roll("fretting", subsurface=None, fatigue=None)
    add("shift", "energy", error_of(history.energy_balance), 1e-6)
    course = {
        **{"distance": (0.0, 2.0), "creepage.longitudinal": (-0.003, -0.003)},
        "save": (0.0, 2.0),
    }
    wear = {"coefficient": 1e-4}
    history = roll("spheres", transient=course, wear=wear, subsurface=None, grid__elements=[25, 25])
    add("transient with wear", "energy", error_of(history.energy_balance), 1e-6)
    add("transient with wear", "wear", error_of(history.wear_balance[1:]), 1e-3)
    contact = ts.solve(ts.Scene.builtin("hot-discs").replace(subsurface=None, fatigue=None))
    flux = sum(contact.heat.flux[body].sum() for body in "AB") * contact.grid.element_area
    friction = contact.dissipation * contact.scene.creepage.speed
    add("heat", "heat", abs(flux / friction - 1.0), 1e-6)
    for name in ("wheel-rail", "wheel-flange"):
        history = roll(name)
        angle = np.radians(history["contact_angle"])
        carried = (history["P"] * np.cos(angle) - history["Qy"] * np.sin(angle)).sum()
        add(name, "energy", error_of(history.energy_balance), 1e-6)
        add(name, "load", abs(carried / history.scene.wheelset.load - 1.0), 1e-6)
    moments = 0.0
    for side in ("right", "left"):
        scene = ts.Scene.builtin("wheel-rail").replace(**{"wheelset.side": side})
        patch, contact = scene.wheel_rail.patches[0], ts.solve(scene)
        moments += patch.moment_about_axle((contact.Qx, contact.Qy), contact.Mz)
    add("wheel-rail", "moment", abs(moments) / (2.0 * 0.3 * 80e3 * 460.0), 3e-6)
    history = roll("wheel-wear", wear__revolutions=5000, wear__save=(0, 5000))
    for k, block in enumerate(history.scene.duty):
        error = error_of(history.block(k).energy_balance)
        add(f"worn profiles, {block.name}", "energy", error, 1e-6)
    add("worn profiles", "wear", error_of(history.wear_balance), 1e-3)
    for title, y in (("tread", 0.0), ("flange", 6.5)):
        for points in (20, 5, 2, 1):
            error = error_of(wear_profiles(y, points).wear_balance)
            add(f"worn {title}, {points} points per mm", "wear", error, 1e-3)
    return rows


def wear_profiles(y: float, points: int, revolutions: int = 500) -> ts.History:
    """Wear profiles that are read at a number of points per mm; at y = 6.5 mm, on the flange."""
    with TemporaryDirectory() as folder:
        profiles = {}
        for kind, name in (("wheel", "S1002"), ("rail", "60E1")):
            profile = builtin_profile(name)
            path = Path(folder) / f"{kind}.txt"
            np.savetxt(path, profile.at(np.arange(0.37 / points, profile.s[-1], 1.0 / points)))
            profiles[kind] = {"profile": str(path)}
        scene = ts.Scene(
            body={"A": STEEL, "B": STEEL},
            friction={"mu": 0.3},
            wheelset={"y": y, "load": 60e3},
            wear={"coefficient": 2e-5, "revolutions": revolutions},
            grid={"elements": [21, 25]},
            **profiles,
        )
        return ts.roll(scene, progress=False)


def random_profile(generator: np.random.Generator, kind: str, name: str, folder: Path) -> str:
    """Write a built-in profile, worn by a smooth random depth, at 1 to 20 points per mm."""
    profile = builtin_profile(name)
    if generator.random() < 0.5:
        place, width = generator.uniform(0.3, 0.7) * profile.s[-1], generator.uniform(5.0, 20.0)
        depth = generator.uniform(0.0, 0.2) * np.exp(-(((profile.s - place) / width) ** 2))
        profile = profile.worn(depth, 1.0 if kind == "wheel" else -1.0)
    spacing = 1.0 / generator.uniform(1.0, 20.0)
    s = np.arange(generator.uniform(0.0, spacing), profile.s[-1], spacing)
    path = folder / f"{kind}-{generator.integers(10**9)}.txt"
    np.savetxt(path, profile.at(s))
    return str(path)


def measure_wheels(seeds: tuple[int, ...], number: int = 30) -> list[dict[str, object]]:
    """Return the largest errors of random wheel scenes by law, `number` scenes for each seed."""
    refused, unsolved = 0, 0
    errors: dict[str, list[float]] = {"load": [], "mirror": [], "energy": [], "wear": []}
    with TemporaryDirectory() as folder:
        for generator in (g for g in map(np.random.default_rng, seeds) for _ in range(number)):
            place = {
                **{"y": generator.uniform(-6.0, 7.0), "yaw": generator.uniform(-8.0, 8.0)},
                **{"load": float(10.0 ** generator.uniform(4.0, 5.1)), "side": "right"},
                "pitch": ["free", "rolling-radius", 0.0][generator.integers(3)],
            }
            try:
                scene = ts.Scene(
                    body={"A": STEEL, "B": STEEL},
                    friction={"mu": generator.uniform(0.1, 0.5)},
                    wheel={"profile": random_profile(generator, "wheel", "S1002", Path(folder))},
                    rail={"profile": random_profile(generator, "rail", "60E1", Path(folder))},
                    grid={"elements": [15, 19]},
                    wheelset=place,
                )
            except ts.SceneError:
                refused += 1
                continue
            left = {"y": -place["y"], "yaw": -place["yaw"], "side": "left"}
            mirror = scene.replace(**{f"wheelset.{key}": value for key, value in left.items()})
            history, mirrored = (ts.roll(one, progress=False) for one in (scene, mirror))
            if not (history.finished and mirrored.finished):
                unsolved += 1
                continue
            angle = np.radians(history["contact_angle"])
            carried = history["P"] * np.cos(angle) - history["Qy"] * np.sin(angle)
            errors["load"].append(abs(carried.sum() / place["load"] - 1.0))
            errors["energy"].append(error_of(history.energy_balance))
            forces = np.stack([history[name] for name in ("P", "Qx", "Qy", "p_max", "approach")])
            images = np.stack([mirrored[name] for name in ("P", "Qx", "Qy", "p_max", "approach")])
            errors["mirror"].append(
                float((abs(images - forces) / abs(forces).max(axis=1)[:, None]).max())
            )
            wear = {"coefficient": 2e-5, "revolutions": 20, "stepping": "saved"}
            worn = ts.roll(scene.replace(wear=wear), progress=False)
            if worn.finished:
                errors["wear"].append(abs(worn.wear_balance[-1] - 1.0))
            else:
                unsolved += 1
    print(
        f"{number * len(seeds)} scenes: {refused} refused (derailed, too deep), {unsolved} unsolved"
    )
    tolerances = {"load": 1e-6, "mirror": 1e-9, "energy": 1e-3, "wear": 1e-3}
    return [
        {
            **{"law": law, "scenes": len(values), "largest error": max(values)},
            **{"tolerance": tolerances[law], "above": sum(v > tolerances[law] for v in values)},
        }
        for law, values in errors.items()
    ]


if __name__ == "__main__":
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ts.SceneWarning)
        if "wheels" in sys.argv:
            seeds = tuple(int(argument) for argument in sys.argv[1:] if argument.isdigit())
            rows = measure_wheels(seeds or tuple(range(1, 11)))
            write("conservation_wheels", rows)
        else:
            rows = measure_processes()
            write("conservation", rows)
    show("Conservation", rows)
