"""Derivatives of a contact by the Newton matrix, compared with differences and a closed form.

- Spheres on 91 x 91 elements: the number of operator applications of the solution, of the Jacobian,
  and of central differences with respect to all six parameters. For the differences, each contact
  starts from the solution and is solved to its residual. The script also gives the difference
  between the Jacobian and the central differences, per relative change of a parameter (for a
  parameter of zero, per change of 1e-3), divided by the largest change in a row.
- Cylinders: the slope of Carter's curve of force against creepage, for several meshes, and the
  largest relative error at ten creepages. Between two of these creepages, elements change from
  stick to slip.

Page: docs/howto/jacobian.md
"""

import numpy as np
from timing import show, write

import tractive_sam as ts
from tractive_sam.reference import Carter

STEP, ZERO = 1e-5, 1e-3
TOLERANCE = 1e-10
"""Small enough that the residuals hardly affect the differences."""

COMBINED = {"creepage.longitudinal": -2e-3, "creepage.lateral": 1e-3, "creepage.spin": 7e-4}
TURNED = {"friction.mu": (0.5, 0.25), "friction.angle": 30.0}
SCENES = {
    "longitudinal": {},
    "combined, orthotropic": COMBINED | TURNED,
    "combined, orthotropic, upwind": COMBINED | TURNED | {"solver.slip": "upwind"},
    "combined, orthotropic, dissimilar": COMBINED | TURNED | {"body.B.shear": 4.0},
}
KEYS = {
    "xi_x": "creepage.longitudinal",
    "xi_y": "creepage.lateral",
    "spin": "creepage.spin",
    "P": "load.normal",
}


def moved(scene: ts.Scene, parameter: str, step: float) -> tuple[ts.Scene, float]:
    """Return the scene with a parameter changed by a fraction of its value, and the change."""
    if parameter.startswith("mu"):
        mu, k = list(scene.friction.mu), int(parameter[2]) - 1
        change = step * mu[k]
        mu[k] += change
        return scene.replace(**{"friction.mu": tuple(mu)}), change
    table, key = KEYS[parameter].split(".")
    value = getattr(getattr(scene, table), key)
    change = step * (abs(value) or ZERO)
    return scene.replace(**{KEYS[parameter]: value + change}), change


def compared(name: str) -> dict:
    """Compare the Jacobian of a scene with central differences."""
    scene = ts.Scene.builtin("spheres").replace(**SCENES[name], **{"solver.tolerance": TOLERANCE})
    contact = ts.solve(scene, jacobian=True)
    jacobian = contact.jacobian
    applications, differences, sizes = 0.0, [], []
    for parameter in jacobian.parameter.values:
        ends = []
        for step in (STEP, -STEP):
            near, change = moved(scene, parameter, step)
            end = ts.solve(near, start=contact)
            applications += end.cost.applications
            ends.append(np.array([getattr(end, row) for row in jacobian.result.values]))
        differences.append(0.5 * (ends[0] - ends[1]) / STEP)
        sizes.append(-change / STEP)
    expected = np.stack(differences, axis=1)
    apart = np.abs(jacobian.values * sizes - expected).max(axis=1)
    size = np.abs(expected).max(axis=1)
    return {
        "scene": name,
        "solve": contact.cost.applications,
        "jacobian": jacobian.attrs["operator_applications"],
        "differences": applications,
        "apart": float((apart[size > 0.0] / size[size > 0.0]).max()),
    }


def slopes(n: int) -> dict:
    """Return errors of the slope of Carter's curve and of the force, on n elements across."""
    scene = ts.Scene.builtin("cylinders")
    grid = {"grid.half_length": scene.hertz.a * (n + 4) / n, "grid.elements": n + 4}
    mu, load = scene.friction.mu[0], scene.load.normal
    errors = []
    full = mu * scene.hertz.a / scene.body.radii[0]  # creepage from which nothing sticks
    for xi in -full * np.linspace(0.5, 0.6, 10):
        contact = ts.solve(scene.replace(**grid, **{"creepage.longitudinal": xi}), jacobian=True)
        ahead, behind = (Carter(scene.hertz, mu, xi * (1.0 + h)) for h in (1e-6, -1e-6))
        slope = mu * load * (ahead.force_ratio - behind.force_ratio) / (2e-6 * xi)
        force = mu * load * Carter(scene.hertz, mu, xi).force_ratio
        derivative = contact.jacobian.loc["Qx", "xi_x"].item()
        errors.append((abs(derivative / slope) - 1.0, abs(contact.Qx / force) - 1.0))
    slope, force = np.abs(errors).max(axis=0)
    return {"n": n, "slope": slope, "force": force}


def main() -> None:
    """Print and write the tables."""
    rows = [compared(name) for name in SCENES]
    show("Applications of operators, and difference between Jacobian and central differences", rows)
    print(write("jacobian", rows))
    rows = [slopes(n) for n in (64, 128, 256, 512, 1024)]
    show("Carter's curve: relative errors of its slope, and of the force", rows)
    print(write("jacobian_carter", rows))


if __name__ == "__main__":
    main()
