"""Rolling contact: Kalker's creep coefficients, and what the program CONTACT prints.

CONTACT is the independent program of Kalker and Vollebregt (github.com/eve70a/CONTACT). Its scheme
of slip is of first order; contacts that are compared with its numbers have its meshes and its
scheme ("upwind"), so that the digits can agree although both are far from the limit of fine meshes.
"""

import dataclasses
import math
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

import tractive_sam as ts
from tractive_sam.mechanics import HalfSpaces
from tractive_sam.reference import creep_coefficients
from tractive_sam.validation.closed_forms import (
    FLAT,
    LOAD,
    MU,
    SPHERES,
    STEEL,
    free_rolling,
    hertz_of,
    radii_of_ellipse,
)
from tractive_sam.validation.comparison import Comparison, PublishedSet, compare

UPWIND = {"solver.slip": "upwind"}


def kalker(ratio: float) -> Iterator[Comparison]:
    """Creep coefficients of an ellipse a/b, without slip, extrapolated over two meshes."""
    for poisson in (0.0, 0.25, 0.5):
        coarse, fine = (np.array(_coefficients(ratio, poisson, n)) for n in (90, 180))
        known = creep_coefficients(ratio, poisson)
        for name, published, value in zip(known._fields, known, 2.0 * fine - coarse, strict=True):
            # Three digits are printed; the error of the edge falls with the size of the elements.
            text = f"{published:.{2 - math.floor(math.log10(published))}f}"
            yield compare(f"{name}, nu = {poisson:g}", text, value, 4e-3)


def _coefficients(a_over_b: float, poisson: float, across: int) -> tuple[float, ...]:
    """Return C11, C22, C23 and C33 on a mesh, corrected for the area of its contact; G = 1."""
    a, b, p0 = 1.0, 1.0 / a_over_b, 1e-3
    radius_x, radius_y = radii_of_ellipse(a, b, p0, 1.0 / (1.0 - poisson))
    body = {"shear": 1.0, "poisson": poisson, "radius_x": 2 * radius_x, "radius_y": 2 * radius_y}
    grid = {"half_length": (1.1 * a, 1.1 * b), "elements": (int(1.1 * across),) * 2}
    scene = ts.Scene(
        body={"A": body, "B": body},
        load={"normal": 2.0 / 3.0 * math.pi * a * b * p0},
        friction={"mu": 1000.0},
        grid=grid,
    )
    long, wide, turn = (
        ts.solve(scene.replace(creepage={name: 1e-9}))
        for name in ("longitudinal", "lateral", "spin")
    )
    size = math.sqrt(np.count_nonzero(long.touching) * long.grid.element_area / math.pi)
    return (
        -long.Qx / (size**2 * long.xi_x),
        -wide.Qy / (size**2 * wide.xi_y),
        -turn.Qy / (size**3 * turn.spin),
        -turn.Mz / (size**4 * turn.spin),
    )


def meshes() -> Iterator[Comparison]:
    """Force of spheres on meshes of n x n elements."""
    for n, printed in (
        (21, "0.6628"),
        (41, "0.6549"),
        (91, "0.6505"),
        (181, "0.6479"),
        (361, "0.6469"),
    ):
        grid = {"grid.elements": (n, n), "grid.half_length": (4.08, 4.08)}
        contact = ts.solve(SPHERES.replace(**UPWIND, **grid))
        yield compare(f"Q_x/(mu P), {n} x {n}", printed, contact.Qx / (MU * LOAD))


CURVE = (
    (0.02, "0.0503", "0.0500", "0.0498"),
    (0.1, "0.2369", "0.2348", "0.2340"),
    (0.2, "0.4364", "0.4331", "0.4317"),
    (0.3, "0.6017", "0.5969", "0.5951"),
    (0.4, "0.7348", "0.7285", "0.7262"),
    (0.5, "0.8371", "0.8301", "0.8276"),
    (0.6, "0.9115", "0.9041", "0.9022"),
    (0.7, "0.9593", "0.9544", "0.9530"),
    (0.8, "0.9864", "0.9840", "0.9831"),
    (0.9, "0.9978", "0.9968", "0.9966"),
    (1.0, "0.9992", "0.9991", "0.9991"),
    (1.5, "0.9996", "0.9996", "0.9996"),
)
"""Creep parameter (eq. (40) of the paper), and Q_x/(mu P) on 31, 61 and 91 elements across."""


def creep_force(xi: float, *printed: str) -> Iterator[Comparison]:
    """Force of spheres at a creep parameter on three meshes."""
    creepage = -xi * 3.0 * MU * LOAD * (4.0 - 3.0 * 0.28) / (16.0 * 3.499981**2)
    for n, value in zip((31, 61, 91), printed, strict=True):
        mesh = {"grid.elements": (n, n), "grid.half_length": (4.08, 4.08)}
        scene = SPHERES.replace(**UPWIND, **mesh, **{"creepage.longitudinal": creepage})
        yield compare(f"Q_x/(mu P), {n} x {n}", value, ts.solve(scene).Qx / (MU * LOAD), 1e-4)


def _on_plane(
    body: dict[str, float],
    normal: float,
    creepage: float,
    speed: float,
    friction: dict[str, Any],
    grid: dict[str, Any],
) -> ts.Scene:
    """Return a scene of a steel body on a plane, with the scheme of CONTACT."""
    return ts.Scene(
        body={"A": STEEL | body, "B": STEEL | FLAT},
        load={"normal": normal},
        creepage={"longitudinal": creepage, "speed": speed},
        friction=friction,
        grid=grid,
        solver={"slip": "upwind"},
    )


FALLING: dict[str, Any] = {
    "law": "exponential",
    "static": 0.3,
    "kinetic": 0.18,
    "half_speed": 100.0,
}


def friction_laws() -> Iterator[Comparison]:
    """Steel sphere on a plane with Coulomb's law, an interfacial layer, and falling friction."""
    sphere, grid = (
        {"radius_x": 460.0, "radius_y": 460.0},
        {"half_length": (6.95, 6.95), "elements": (91, 91)},
    )
    laws: dict[str, tuple[dict[str, Any], str]] = {
        "Coulomb": ({"mu": 0.3}, "0.79888"),
        "layer, h/G3 = 1e-5 mm/MPa": ({"mu": 0.3, "layer": 1e-5}, "0.70528"),
        "exponential law": (FALLING, "0.74737"),
    }
    for name, (friction, printed) in laws.items():
        contact = ts.solve(_on_plane(sphere, 70e3, -0.002, 20e3, friction, grid))
        yield compare(f"Q_x/(0.3 P), {name}", printed, contact.Qx / (0.3 * 70e3))


def strength() -> Iterator[Comparison]:
    """Cylinder with friction 0.5 below a shear strength of 35 MPa, on three meshes."""
    body = {"radius_x": 500.0, "radius_y": math.inf}
    for dx, elements, half, printed in (
        (0.08, 30, 1.2, "0.5959"),
        (0.04, 55, 1.1, "0.5896"),
        (0.02, 105, 1.05, "0.5864"),
    ):
        friction, grid = {"mu": 0.5, "strength": 35.0}, {"half_length": half, "elements": elements}
        contact = ts.solve(_on_plane(body, 178.9, -4e-4, 3e4, friction, grid))
        # 178.9 N/mm has four digits.
        yield compare(f"Q_x/(0.5 P), dx = {dx} mm", printed, contact.Qx / (0.5 * 178.9), 1e-4)


def locomotive() -> Iterator[Comparison]:
    """Traction curve of a locomotive: exponential law with memory, and an interfacial layer."""
    scene = ts.Scene.builtin("locomotive")
    half = 1.1 * hertz_of(scene).a, 1.1 * hertz_of(scene).b
    scene = scene.replace(grid={"half_length": half, "elements": (48, 44)}, **UPWIND)
    for creepage, printed in (
        (1e-5, "65.81"),
        (0.001, "6425"),
        (0.005, "24750"),
        (0.010, "32110"),
        (0.016, "33260"),
        (0.050, "30360"),
        (0.25, "20020"),
    ):
        force = ts.solve(scene.replace(**{"creepage.longitudinal": -creepage})).Qx
        digits = printed if "." in printed or printed == "6425" else f"{float(printed):.3e}"
        yield compare(f"Q_x, N, creepage {creepage:g}", digits, force, 1e-4)


@dataclasses.dataclass(frozen=True)
class Strip(HalfSpaces):
    """A row of elements of 200 mm: the strip that CONTACT takes for a cylinder."""

    def coefficients(
        self, component: str, offsets: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray:
        """Return the influence coefficients of the strip on itself; see `HalfSpaces`."""
        table = np.zeros(offsets)
        table[:, 0] = super().coefficients(component, (offsets[0], 1), dx, 200.0)[:, 0]
        return table


def two_solutions() -> Iterator[Comparison]:
    """Cylinder at 45 m/s with falling friction: the solution from rest."""
    body = {"radius_x": 460.0, "radius_y": math.inf}
    grid = {"half_length": 4.65, "elements": 93}
    scene = _on_plane(body, 3111.08, -0.9999e-3, 45e3, FALLING, grid)
    laws = ts.Laws.of(scene).replace(elasticity=Strip(*scene.materials.values()))
    contact = ts.solve(scene, laws=laws)
    yield compare("Q_x/(0.3 P)", "0.5941", contact.Qx / (0.3 * contact.P), 1e-4)
    yield compare("sliding elements", "36", contact.sliding.sum())
    yield compare("elements in contact", "81", contact.touching.sum())


def change_of_creepage() -> Iterator[Comparison]:
    """Transient of spheres after the creepage changes from -0.001 to -0.003."""
    for n, printed in (
        (91, ("0.261486", "0.268602", "0.275641", "0.282597")),
        (45, ("0.271339", "0.285490", "0.299349", "0.312910")),
    ):
        course = {
            "distance": [0.0, 0.0, 5 * 8.16 / n],
            "start": "steady",
            "creepage.longitudinal": [-0.001, -0.003, -0.003],
        }
        mesh = {"grid.elements": (n, n), "grid.half_length": (4.08, 4.08)}
        history = ts.roll(SPHERES.replace(transient=course, **UPWIND, **mesh))
        share = history["Qx"] / (MU * LOAD)
        for step, value in enumerate(printed, start=1):
            yield compare(f"Q_x/(mu P), {n} x {n}, step {step}", value, share[step], 1e-6)


def shift_and_roll() -> Iterator[Comparison]:
    """Transient of spheres: a shift to 0.657 mu P, then rolling under this force."""
    course = {"distance": [0, 14], "load.force_x": [0.657 * MU * LOAD] * 2}
    grid = {"half_length": (4.125, 4.125), "elements": (33, 33)}
    history = ts.roll(SPHERES.replace(transient=course, creepage=None, grid=grid, **UPWIND))
    yield compare("shift, mm", "1.774e-2", -history["shift_x"][0], 2e-4)
    for step, printed in (
        (1, "1.824"),
        (7, "2.334"),
        (12, "2.968"),
        (14, "3.403"),
        (17, "3.241"),
        (29, "3.093"),
        (56, "3.101"),
    ):
        creepage = -1e3 * history["creepage_found"][step, 0]
        yield compare(f"1000 |xi_x|, step {step}", printed, creepage, 2e-4)


def relaxation() -> Iterator[Comparison]:
    """Pressed and driven cylinders of polyamide, whose moduli relax to a half."""
    for time, pressure, creepage in (
        (0.009, "78.74", "1.365"),
        (0.045, "84.72", "1.152"),
        (2.0, "85.31", "0.9932"),
    ):
        terms = [{"ratio": 1.0, "time": time}]
        body = {"shear": 1143.0, "poisson": 0.4, "radius_x": 100.0, "relaxation": terms}
        scene = ts.Scene(
            body={"A": {**body, "radius_y": math.inf}, "B": {**body, "radius_y": math.inf}},
            load={"normal": 600.0, "force_x": 108.0},
            creepage={"speed": 1000.0},
            friction={"mu": 0.3},
            grid={"half_length": (7.92,), "elements": (99,)},
        )
        contact = ts.solve(scene)
        yield compare(f"p_max, MPa, tau = {time:g} s", pressure, contact.p_max, 2e-4)
        yield compare(f"100 |xi_x|, tau = {time:g} s", creepage, -100.0 * contact.xi_x, 0.02)


CONTACT, ITERATION = "CONTACT, revision 2707", "the iteration of CONTACT: 0.01 %"

KALKER = (
    "Kalker computed his table numerically. On meshes of 90 to 240 elements across, the computed "
    "values vary by 0.3 %."
)

SETS = (
    *(
        PublishedSet(
            f"Creep coefficients, a/b = {ratio:.4g}",
            "Kalker 1990, Three-Dimensional Elastic Bodies in Rolling Contact, Table E.3",
            partial(kalker, ratio),
            "0.4 % of the mesh: 90 and 180 elements across, extrapolated",
            KALKER,
            quick=ratio in (0.3, 1.0),
        )
        for ratio in (*np.arange(1, 11) / 10.0, *10.0 / np.arange(9, 0, -1))
    ),
    PublishedSet("Spheres on five meshes", CONTACT, meshes, quick=False),
    *(
        PublishedSet(
            f"Spheres, creep parameter {xi:g}",
            CONTACT,
            partial(creep_force, xi, *printed),
            ITERATION,
        )
        for xi, *printed in CURVE
    ),
    PublishedSet("Steel sphere with three friction laws", CONTACT, friction_laws),
    PublishedSet("Traction limited by shear strength", CONTACT, strength, "digits of the load"),
    PublishedSet("Locomotive", f"{CONTACT}; Polach 2005", locomotive, "digits of the load"),
    PublishedSet("Falling friction at 45 m/s", CONTACT, two_solutions, "digits of the load"),
    PublishedSet(
        "Free rolling of unlike cylinders, mu = 0.05",
        CONTACT,
        partial(free_rolling, 0.05, "4.29e-4", 5e-3),
        "first order of CONTACT's scheme: 0.5 %",
    ),
    PublishedSet(
        "Free rolling of unlike cylinders, mu = 10",
        CONTACT,
        partial(free_rolling, 10.0, "3.59e-4", 3e-2),
        "first order of CONTACT's scheme: 3 %, as hardly anything slips",
    ),
    PublishedSet(
        "Cylinders of polyamide that relax",
        f"{CONTACT}, example visc_cylindr",
        relaxation,
        "pressure: 0.02 %; creepage: first order of CONTACT's scheme, 2 %. For relaxed bodies it "
        "prints 1.378, where Carter's solution is 1.3966",
    ),
    PublishedSet(
        "Spheres after a change of creepage", CONTACT, change_of_creepage, "the solver's tolerance"
    ),
    PublishedSet(
        "Spheres shifted, then rolling under a force",
        CONTACT,
        shift_and_roll,
        "the solver's tolerance: 0.02 %",
        quick=False,
    ),
)
