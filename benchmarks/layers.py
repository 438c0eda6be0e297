"""Contacts of coated bodies: errors against integral equations, cost, and hard scenes.

- A rigid sphere on a coating (a Fredholm equation): pressure at the vertex and approach.
- Two cylinders with equal coatings that roll (Carter) or are pushed (Cattaneo), by singular
  integral equations: force at a given creepage, stick area under a given force.
- CPU time of solutions of 181 x 181 elements over those of homogeneous bodies, and of influence
  coefficients over those by integrals over the waves (`ts.SpectralHalfSpaces`).
- Random coatings on 15 x 15 elements against dense equations, whose coefficients are integrals over
  the waves: `python benchmarks/layers.py hard [NUMBER]`.

Page: docs/theory/elasticity.md
"""

import sys
import warnings
from dataclasses import dataclass
from functools import cached_property
from time import process_time

import numpy as np
from scipy.interpolate import CubicSpline
from timing import seconds, show, write

import tractive_sam as ts
from tractive_sam.contact import Model
from tractive_sam.mechanics.layers import _image_coefficients
from tractive_sam.schema import PlausibilityWarning

RIGID = {"young": 1e6, "poisson": 0.3, "radius_x": 10.0, "radius_y": 10.0}
FLAT = {"young": 1.0, "poisson": 0.3, "radius_x": np.inf, "radius_y": np.inf}
BARE = ts.Scene(body={"A": FLAT, "B": RIGID}, load={"normal": 1e-3})
CYLINDER = {"young": 208e3, "poisson": 0.3, "radius_x": 20.0, "radius_y": np.inf}
LINE = ts.Scene(body={"A": CYLINDER, "B": CYLINDER}, load={"normal": 500.0}, friction={"mu": 0.3})

SPHERES = (
    (50.0, 0.3, 0.1, 0.785337, 1.076377, 0.923226),
    (10.0, 0.3, 0.164908, 0.824542, 1.095082, 0.925010),
    (4.0, 0.3, 0.39299, 0.78597, 1.32209, 0.87609),
    (0.25, 0.3, 0.69288, 1.38577, 0.57218, 1.41400),
    (0.1, 0.3, 0.902162, 1.804324, 0.345989, 2.107547),
    (0.01, 0.5, 3.887021, 3.887021, 0.070088, 8.551049),
)
"""E1/E2, nu1, thickness, contact radius, pressure at the vertex and approach, over Hertz's."""

LINES = (
    (4.0, 0.384794, 0.769587, 1.145711, 0.5, 0.707373, 0.265256, 0.772559),
    (0.25, 0.750484, 1.500967, 0.708136, 0.5, 0.783519, 0.738475, 0.748506),
    (2.0, 0.798985, 0.798985, 1.225118, 0.5, 0.736199, 0.420084, 0.746148),
    (10.0, 0.162633, 0.813167, 1.060912, 0.5, 0.669920, 0.149971, 0.745581),
    (0.1, 1.078674, 2.157348, 0.500931, 0.5, 0.795309, 0.834631, 0.750758),
)
"""E1/E2, thickness, half width, pressure, stick share c/a, Carter's Q and xi, Cattaneo's Q."""


def spheres():
    for ratio, poisson, thickness, a, pressure, approach in SPHERES:
        hertz = BARE.hertz
        layer = {"thickness": thickness * hertz.a, "young": ratio, "poisson": poisson}
        for n in (64, 128, 256):
            grid = {"elements": (n, n), "half_length": (1.05 * a * hertz.a,) * 2}
            contact = ts.solve(BARE.replace(**{"body.A.layer": [layer], "grid": grid}))
            yield {
                "E1/E2": ratio,
                "h/a_H": thickness,
                "elements": n,
                "pressure": contact.pressure[n // 2, n // 2] / hertz.p0 / pressure - 1.0,
                "approach": contact.approach / hertz.approach / approach - 1.0,
            }


def lines():
    for ratio, thickness, a, pressure, stick, carter, creepage, cattaneo in LINES:
        hertz = LINE.hertz
        layer = [{"thickness": thickness * hertz.a, "young": ratio * 208e3, "poisson": 0.3}]
        for n in (128, 256, 512):
            grid = {"elements": (n,), "half_length": (1.06 * a * hertz.a,)}
            scene = LINE.replace(**{"body.A.layer": layer, "body.B.layer": layer, "grid": grid})
            xi = -creepage * 0.3 * a * hertz.a / 10.0
            rolling = ts.solve(scene.replace(**{"creepage.longitudinal": xi}))
            load = {"force_x": [0.0, cattaneo * 150.0]}
            stage = {"motion": "shift", "distance": [0, 1], "load": load}
            pushed = ts.roll(scene.replace(transient={"stage": [stage]})).state(1.0)
            yield {
                "E1/E2": ratio,
                "h/a_H": thickness,
                "elements": n,
                "half width": rolling.half_width_x / hertz.a / a - 1.0,
                "pressure": rolling.p_max / hertz.p0 / pressure - 1.0,
                "Carter force": rolling.Qx / 150.0 / carter - 1.0,
                "Cattaneo stick": pushed.stick_fraction - stick,
            }


def cost():
    roller = ts.Scene.builtin("coated-roller").replace(**{"creepage.longitudinal": -2e-3})
    grid = {"elements": (181, 181), "half_length": (0.76, 2.3)}
    for name, changes in (("rolling", {}), ("at rest", {"friction": None, "creepage": None})):
        coated = roller.replace(grid=grid, **changes)
        body = {"body.A.layer": None, "body.A.young": 5.6e3, "body.A.poisson": 0.4}
        plain = coated.replace(**body)
        times = {}
        for kind, scene in (("coated", coated), ("other", plain)):
            solved = ts.solve(scene)
            times[kind] = {
                "solution, s": seconds(lambda s=scene: ts.solve(s)),
                "applications": solved.cost.applications,
            }
        for key in times["coated"]:
            yield cost_row(f"{name}: {key}", *(values[key] for values in times.values()))
    model = Model(coated)
    lattice, layers = model.operators.lattice, model.elasticity
    waves = ByQuadrature(layers.A.base, layers.B, layers.A.layers[0].thickness, layers.A)
    offsets = lattice.padded[0] // 2 + 1, lattice.padded[1] // 2 + 1

    def tables(bodies):
        _image_coefficients.cache_clear()
        for component in ("xx", "xy", "yy", "zz", "xz", "yz"):
            bodies.coefficients(component, offsets, lattice.dx, lattice.dy)

    each = [seconds(lambda bodies=bodies: tables(bodies)) for bodies in (layers, waves)]
    yield cost_row("coefficients, s", *each)


def cost_row(name, coated, other):
    return {"quantity": name, "coated": coated, "other": other, "ratio": coated / other}


@dataclass(frozen=True)
class ByQuadrature(ts.SpectralHalfSpaces):
    """Integrals over the waves, which share only the response with the package's law."""

    body: ts.LayeredBody

    @cached_property
    def spline(self):
        """The response by the logarithm of the wave number, interpolated."""
        log_k = np.linspace(-20.0, 20.0, 8001) - np.log(self.length)
        return CubicSpline(log_k, self.body.response(np.exp(log_k)).T)

    @property
    def surface(self):
        return ts.HalfSpaces(self.body.layers[0].material, self.B)

    def opening(self, normal, dx, dy):
        return ts.LinearHalfSpaces(self.body, self.B).opening(normal, dx, dy)

    def spectrum(self, component, kx, ky):
        k = np.hypot(kx, ky)
        of_A = np.moveaxis(self.spline(np.log(k)), -1, 0)
        of_B = np.array((1.0, 1.0, 1.0, -1.0)) * self.B.compliances
        zz, along, across, lift = of_A + of_B[:, None, None]
        return {
            "zz": zz / k,
            "xx": (across + (along - across) * (kx / k) ** 2) / k,
            "yy": (across + (along - across) * (ky / k) ** 2) / k,
            "xy": (along - across) * kx * ky / k**3,
            "xz": 1j * lift * kx / k**2,
            "yz": 1j * lift * ky / k**2,
        }[component]


def dense_pressure(table, gap, load, area):
    """Return pressure and approach of a contact by dense equations on the touching elements."""
    nx, ny = gap.shape
    i, j = (index.ravel() for index in np.indices(gap.shape))
    matrix = table[abs(i[:, None] - i), abs(j[:, None] - j)]
    gap, touching = gap.ravel(), np.ones(nx * ny, bool)
    for _ in range(200):
        m = touching.sum()
        system = np.zeros((m + 1, m + 1))
        system[:m, :m] = matrix[np.ix_(touching, touching)]
        system[:m, m], system[m, :m] = -1.0, area
        *pressure, approach = np.linalg.solve(system, np.append(-gap[touching], load))
        full = np.zeros(nx * ny)
        full[touching] = pressure
        clearance = matrix @ full + gap - approach
        new = np.where(touching, full > 0.0, clearance < -1e-12 * abs(approach))
        if (new == touching).all():
            return full.reshape(nx, ny), approach
        touching = new
    raise RuntimeError("dense solution not found")


def hard(number):
    rng = np.random.default_rng(1)
    steel = {"young": 1e3, "radius_x": 10.0, "radius_y": 10.0}
    for k in range(number):
        nu, nu_A, nu_B = rng.choice([0.1, 0.3, 0.45, 0.499], 3)
        ratio, h = 10.0 ** rng.uniform(-3, 3), 10.0 ** rng.uniform(-3, 2)
        bodies = {
            "A": steel | {"poisson": nu_A},
            "B": steel | {"poisson": nu_B, "radius_y": np.inf, "young": 10.0 ** rng.uniform(2, 4)},
        }
        bare = ts.Scene(body=bodies, load={"normal": 1.0}, friction={"mu": 0.3})
        layer = {"thickness": h * bare.hertz.a, "young": ratio * 1e3, "poisson": nu}
        coated = bare.replace(**{"body.A.layer": [layer]})
        estimate = coated.hertz
        bound = 0.3 * estimate.p0 / bare.material.shear
        scene = coated.replace(
            grid={"elements": (15, 15)},
            **{"creepage.longitudinal": -bound * rng.uniform(0.1, 2.0)},
        )
        began = process_time()
        row = {"k": k, "E1/E2": ratio, "h/a_H": h, "nu1": nu}
        try:
            contact = ts.solve(scene)
        except ts.NotConverged as error:
            yield row | {"outcome": str(error)[:60], "pressure": "", "approach": "", "force": ""}
            continue
        took = process_time() - began
        response = scene.body.A.response
        waves = ByQuadrature(response.base, scene.body.B.material, layer["thickness"], response)
        laws = ts.Laws.of(scene).replace(elasticity=waves)
        grid = {"elements": contact.grid.elements, "half_length": contact.grid.half_length}
        fixed = scene.replace(grid=grid)
        other = ts.solve(fixed, laws=laws, throw=False)
        frictionless = ts.solve(fixed.replace(friction=None, creepage=None))
        model, grid = Model(fixed), contact.grid
        table = waves.coefficients("zz", grid.elements, grid.dx, grid.dy)
        load, area = scene.load.normal, contact.grid.element_area
        pressure, approach = dense_pressure(table, model.undeformed_gap, load, area)
        yield row | {
            "outcome": f"{took:.2f} s",
            "pressure": abs(frictionless.pressure - pressure).max() / pressure.max(),
            "approach": abs(frictionless.approach / approach - 1.0),
            "force": abs(contact.Qx / other.Qx - 1.0) if other.converged else "",
        }


def main():
    warnings.simplefilter("ignore", PlausibilityWarning)
    warnings.simplefilter("ignore", ts.SceneWarning)
    if sys.argv[1:2] == ["hard"]:
        rows = list(hard(int((sys.argv[2:] or ["100"])[0])))
        show("Random coatings on 15 x 15 elements against dense equations", rows)
        write("layers_hard", rows)
        return
    for name, compute in (("layers", spheres), ("layers_line", lines), ("layers_cost", cost)):
        rows = list(compute())
        show(name, rows)
        write(name, rows)


if __name__ == "__main__":
    main()
