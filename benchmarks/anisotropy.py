"""Contacts of anisotropic bodies: errors against closed forms, cost, and hard stiffnesses.

- A rigid ball on crystals and fibres: errors of size, pressure and approach against Willis's
  integrals, over meshes.
- Rolling of equal crystals on meshes, against a finer one.
- CPU time and applications of solutions of 181 x 181 elements over those of isotropic bodies of
  unlike material, for 20 random crystals and fibres in random directions, with equal shares of the
  creepage of full slip: `python benchmarks/anisotropy.py cost`.
- Random stiffnesses with ratios up to 1000 on 15 x 15 elements against dense equations, whose
  coefficients are integrals over the angle with Stroh's eigenvectors:
  `python benchmarks/anisotropy.py hard [NUMBER]`.

Page: docs/theory/elasticity.md
"""

import sys
import warnings

import numpy as np
from timing import seconds, show, write

import tractive_sam as ts
from tractive_sam.contact import Model

IRON = {"C11": 231.4e3, "C12": 134.7e3, "C44": 116.4e3}
ON_110 = {"normal": (1.0, 1.0, 0.0), "along": (0.0, 0.0, 1.0)}
ON_111 = {"normal": (1.0, 1.0, 1.0), "along": (1.0, -1.0, 0.0)}
FIBRES = {"C11": 140e3, "C44": 3.5e3, "C55": 5e3, "C66": 5e3, "C22": 10e3, "C33": 10e3}
FIBRES |= dict.fromkeys(("C12", "C13", "C23"), 4e3)
RIGID = {"young": 1e15, "poisson": 0.3, "radius_x": 10.0, "radius_y": 10.0}
FLAT = {"radius_x": np.inf, "radius_y": np.inf}
STEEL = {"young": 208e3, "poisson": 0.3}
CREEPAGE = {"longitudinal": -3e-4, "lateral": 2e-4, "spin": 1e-4}
NAMES = {
    "iron (001)": IRON,
    "iron (110)": IRON | ON_110,
    "iron (111)": IRON | ON_111,
    "silicon (001)": {"crystal": "silicon"},
    "fibres along x": FIBRES,
    "fibres at 30 degrees": FIBRES | {"phi1": 30.0},
}


def on_mesh(scene, n):
    """The scene on n x n elements over 1.15 times the half axes."""
    h = scene.hertz
    return scene.replace(grid={"half_length": (1.15 * h.a, 1.15 * h.b), "elements": (n, n)})


def balls():
    for name, stiffness in NAMES.items():
        bodies = {"A": RIGID, "B": FLAT | {"stiffness": stiffness}}
        scene = ts.Scene(body=bodies, load={"normal": 100.0})
        h = scene.hertz
        for n in (64, 128, 256):
            contact = ts.solve(on_mesh(scene, n))
            p, x, y = contact.pressure, contact.grid.x[:, None], contact.grid.y
            a, b = (np.sqrt(5.0 * (p * s**2).sum() / p.sum()) for s in (x, y))
            yield {
                "body": name,
                "elements": n,
                "a": a / h.a - 1.0,
                "b": b / h.b - 1.0,
                "p0": contact.p_max / h.p0 - 1.0,
                "approach": contact.approach / h.approach - 1.0,
            }


def pair(A, B=None):
    """Spheres of two bodies that roll."""
    round_ = {"radius_x": 20.0, "radius_y": 20.0}
    bodies = {"A": round_ | A, "B": round_ | (A if B is None else B)}
    return ts.Scene(body=bodies, load={"normal": 100.0}, friction={"mu": 0.3}, creepage=CREEPAGE)


def rolling():
    for name, stiffness in NAMES.items():
        scene = pair({"stiffness": stiffness})
        fine = ts.solve(on_mesh(scene, 257))
        for n in (33, 65, 129):
            contact = ts.solve(on_mesh(scene, n))
            errors = {k: getattr(contact, k) - getattr(fine, k) for k in ("Qx", "Qy")}
            yield {"body": name, "elements": n} | {k: v / 30.0 for k, v in errors.items()}


def at_share(scene, share):
    """The scene on 181 x 181 elements with a share of the creepage of full slip."""
    scene = on_mesh(scene, 181)
    S = ts.Laws.of(scene).elasticity.opening(np.array([[1.0], [0.0]]), 1.0, 1.0)[0, 0, 0]
    full = 0.3 * scene.hertz.a / 20.0 * S
    creepage = {"longitudinal": -share * full, "lateral": 0.4 * share * full}
    return scene.replace(creepage=creepage)


def cost(number=20):
    rng, crystals = np.random.default_rng(7), sorted(ts.Stiffness.crystals)
    for k in range(number):
        angles = dict(zip(("phi1", "Phi", "phi2"), rng.uniform(0.0, 180.0, 3), strict=True))
        name = "fibres" if k % 4 == 3 else str(rng.choice(crystals))
        body = {"stiffness": (FIBRES if name == "fibres" else {"crystal": name}) | angles}
        other, share = STEEL if k % 2 else body, rng.uniform(0.2, 1.2)
        row = {"body": name, "other": "steel" if other is STEEL else "the same", "share": share}
        times, counts = [], []
        for bodies in ((body, other), ({"young": 70e3, "poisson": 0.33}, STEEL)):
            scene = at_share(pair(*bodies), share)
            times.append(seconds(lambda scene=scene: ts.solve(scene)))
            counts.append(ts.solve(scene).cost.applications)
        yield row | {
            "time over isotropic": times[0] / times[1],
            "applications over isotropic": counts[0] / counts[1],
        }


def dense_matrix(law, shape, dx, dy, count=20_000):
    """Normal displacement by pressure, by rays through each element: no Fourier series."""
    angle = (np.arange(count) + 0.5) * 2.0 * np.pi / count
    zz = sum(
        body.response(angle + 0.5 * np.pi)[:, 2, 2].real
        if isinstance(body, ts.AnisotropicMaterial)
        else body.compliances[0]
        for body in (law.A, law.B)
    )
    (nx, ny), table = shape, {}
    for i in range(nx):
        for j in range(1 - ny, ny):
            ends = [
                np.sort(((at - 0.5) * d / s, (at + 0.5) * d / s), axis=0)
                for at, d, s in ((i, dx, np.cos(angle)), (j, dy, np.sin(angle)))
            ]
            near = np.maximum(0.0, np.maximum(ends[0][0], ends[1][0]))
            length = np.maximum(0.0, np.minimum(ends[0][1], ends[1][1]) - near)
            table[i, j] = table[-i, -j] = (zz * length).sum() / count
    places = [(i, j) for i in range(nx) for j in range(ny)]
    return np.array([[table[i - k, j - m] for k, m in places] for i, j in places])


def dense_pressure(matrix, gap, load, area):
    """Return the pressure of a contact by dense equations on the touching elements."""
    touching = np.ones(gap.size, bool)
    for _ in range(200):
        m = touching.sum()
        system = np.zeros((m + 1, m + 1))
        system[:m, :m] = matrix[np.ix_(touching, touching)]
        system[:m, m], system[m, :m] = -1.0, area
        *pressure, approach = np.linalg.solve(system, np.append(-gap[touching], load))
        full = np.zeros(gap.size)
        full[touching] = pressure
        clearance = matrix @ full + gap - approach
        new = np.where(touching, full > 0.0, clearance < -1e-12 * abs(approach))
        if (new == touching).all():
            return full
        touching = new
    raise RuntimeError("dense solution not found")


def random_stiffness(rng):
    """A stable stiffness: without symmetry, or fibres in any direction."""
    ratio = 10.0 ** rng.uniform(0.0, 3.0)
    angles = dict(zip(("phi1", "Phi", "phi2"), rng.uniform(0.0, 180.0, 3), strict=True))
    if rng.random() < 0.5:
        vectors = np.linalg.qr(rng.normal(size=(6, 6)))[0]
        C = 1e4 * vectors @ np.diag(ratio ** rng.uniform(0.0, 1.0, 6)) @ vectors.T
        names = ((i, j) for i in range(6) for j in range(i, 6))
        return ratio, {f"C{i + 1}{j + 1}": float(C[i, j]) for i, j in names}
    return ratio, FIBRES | {"C11": 10e3 * (1.0 + ratio)} | angles


def hard(number):
    rng = np.random.default_rng(1)
    for k in range(number):
        ratio, stiffness = random_stiffness(rng)
        other = {"stiffness": random_stiffness(rng)[1]} if k % 2 else STEEL
        row = {"k": k, "ratio": ratio, "outcome": "converged", "pressure": "", "Qx/P": ""}
        try:
            scene = on_mesh(pair({"stiffness": stiffness}, other), 15)
            S = ts.Laws.of(scene).elasticity.opening(np.array([[1.0], [0.0]]), 1.0, 1.0)[0, 0, 0]
            full = 0.3 * scene.hertz.a / 20.0 * S
            creepage = {"longitudinal": -full * rng.uniform(0.2, 3.0)}
            contact = ts.solve(scene.replace(creepage=creepage))
        except (ts.NotConverged, ts.SceneError) as error:
            yield row | {"outcome": str(error)[:70]}
            continue
        smooth = ts.solve(scene.replace(friction=None, creepage=None))
        grid, model = contact.grid, Model(scene)
        matrix = dense_matrix(ts.Laws.of(scene).elasticity, grid.elements, grid.dx, grid.dy)
        gap, load = model.undeformed_gap.ravel(), scene.load.normal
        pressure = dense_pressure(matrix, gap, load, grid.element_area)
        yield row | {
            "pressure": abs(smooth.pressure.ravel() - pressure).max() / pressure.max(),
            "Qx/P": contact.Qx / contact.P,
        }


def main():
    warnings.simplefilter("ignore", ts.SceneWarning)
    if sys.argv[1:2] == ["hard"]:
        rows = list(hard(int((sys.argv[2:] or ["100"])[0])))
        show("Random stiffnesses on 15 x 15 elements against dense equations", rows)
        write("anisotropy_hard", rows)
        return
    for name, compute in (("balls", balls), ("rolling", rolling), ("cost", cost)):
        if sys.argv[1:] not in ([], [name]):
            continue
        rows = list(compute())
        show(name, rows)
        write(f"anisotropy_{name}", rows)


if __name__ == "__main__":
    main()
