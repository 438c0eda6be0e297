"""Convergence of the forces under the default slip, and under the paper's."""

import numpy as np
import pytest

from tests.scenes import steady
from tractive_sam.contact import Model, equilibrium
from tractive_sam.reference import Carter
from tractive_sam.scene import Scene

MU_P = 0.4013 * 0.4705
LIMIT = 0.64585
"""Q_x/(mu P) of `spheres`: 33 meshes up to 361², to 1e-5 (benchmarks/validation.py)."""

SIDES = np.linspace(1.06, 1.18, 9)


def share(n, *settings):
    return steady("spheres", *settings, elements=n).Qx / MU_P


def test_error_on_the_usual_meshes():
    """Upwind: 1.6e-2 and 7e-3."""
    assert share(45) == pytest.approx(LIMIT, rel=3e-4)
    assert share(91) == pytest.approx(LIMIT, rel=1e-4)


def test_second_order_in_partial_slip():
    """Over many meshes, as the place of the edges within the elements adds noise.

    Far below 1e-4 a first-order remainder shows, a hundredth of the upwind error, from oblique
    edges: their steps are longer than an element.
    """
    n = np.arange(15, 62, 2)
    errors = [abs(share(k) / LIMIT - 1) for k in n]
    assert -np.polyfit(np.log(n), np.log(errors), 1)[0] > 1.8


@pytest.mark.slow
def test_second_order_against_carter():
    """On a line the edges of the elements are nowhere oblique, and the order is clean."""
    scene, n = Scene.builtin("cylinders"), np.arange(21, 122, 4)
    truth = Carter(scene.hertz, 0.3, scene.creepage.longitudinal).force_ratio
    errors = []
    for k in n:
        contact = equilibrium(Model(scene.with_set([*half_length(scene), f"grid.elements={k}"])))
        errors.append(abs(contact.Qx / (0.3 * contact.P) / truth - 1))
    assert max(errors[-5:]) < 1e-4
    assert -np.polyfit(np.log(n), np.log(errors), 1)[0] > 1.8


def half_length(scene):
    return (f"grid.half_length={1.15 * scene.hertz.a}",)


@pytest.mark.slow
def test_both_tend_to_it():
    """The paper's scheme is of first order: extrapolated linearly, less the noise, it agrees."""
    n = np.arange(61, 182, 20)
    values = [share(k, 'solver.slip="upwind"') for k in n]
    limit = np.polyfit(1.0 / n, values, 1)[1]
    # Noise of 2e-4 a mesh, amplified by the extrapolation.
    assert limit == pytest.approx(LIMIT, abs=4e-4)


SPIN = ("creepage.longitudinal=-0.0015", "creepage.lateral=0.0007", "creepage.spin=0.0005")


@pytest.mark.slow
def test_the_first_order_part_of_spin_is_that_of_poissons_ratio():
    """Forces by spin as means over nine meshes of slightly different sides (docs/theory/slip.md).

    Without Poisson's ratio the differences of halved elements fall to a quarter, measured 0.19;
    with it they fall slowly, measured 0.97.
    """
    spheres = Scene.builtin("spheres")
    for poisson, least, most in ((0.0, 0.0, 0.35), (0.45, 0.4, 1.2)):
        keys = {"body.A.poisson": poisson, "body.B.poisson": poisson}
        scene, means = spheres.replace(**keys), []
        a = scene.hertz.a
        keys = {"creepage.longitudinal": 0.0, "creepage.spin": 2.16e-3 / (1.0 - poisson) / a}
        for n in (31, 61, 121):
            grids = [{"half_length": (h * a,) * 2, "elements": (n, n)} for h in SIDES]
            contacts = [equilibrium(Model(scene.replace(grid=grid, **keys))) for grid in grids]
            means.append(np.mean([contact.Qy / contact.P for contact in contacts]))
        differences = np.diff(means)
        assert least < differences[1] / differences[0] < most
        assert abs(differences[1]) < 3e-4 * abs(means[-1])


@pytest.mark.parametrize("wide", [1.0, 2.8])
def test_spin_and_lateral_creepage(wide):
    """If slip turns, its direction and the rigid slip must belong to the right points."""
    radii = [f"body.{b}.radius_y={337.5 * wide}" for b in "AB"]
    half_length = 4.2 * wide ** (-1 / 6), 4.2 * wide**0.55
    mesh = (*radii, *SPIN, f"grid.half_length={list(half_length)}")

    def forces(n, slip):
        c = steady("spheres", *mesh, f'solver.slip="{slip}"', f"grid.elements=[{n}, {n}]")
        return np.array([c.Qx, c.Qy, c.Mz / c.scene.hertz.a]) / MU_P

    fine = forces(121, "auto")
    coarse, upwind = (np.abs(forces(31, slip) - fine) for slip in ("auto", "upwind"))
    assert coarse.max() < 2e-3
    assert np.linalg.norm(coarse) < 0.2 * np.linalg.norm(upwind)


@pytest.mark.parametrize("elements", [(61, 17), (17, 61)])
def test_oblong_elements(elements):
    """Sides 1:4 and 4:1: no worse than the longer side."""
    contact = steady("spheres", f"grid.elements={list(elements)}")
    assert contact.converged
    assert contact.Qx / MU_P == pytest.approx(LIMIT, rel=3e-3)


def test_slip_along_the_traction_loses_its_power_on_finer_meshes():
    """Unlike bodies, little friction one way: the slip turns round within the slip zone."""
    scene = Scene.builtin("spheres").replace(
        **{"grid": None, "body.B.shear": 0.1, "body.B.poisson": 0.1, "creepage.lateral": 0.001},
        **{"friction.mu": (0.3, 0.03), "friction.angle": 40.0},
    )
    half_length = (1.2 * scene.hertz.a, 1.2 * scene.hertz.b)
    wrong = []
    for n in (25, 100):
        grid = {"grid.half_length": half_length, "grid.elements": (n, n)}
        contact = equilibrium(Model(scene.replace(**grid)))
        power = (contact.traction * contact.slip).sum(axis=0)
        along = contact.sliding & (power > 0.0)
        assert along.any()
        wrong.append(power[along].sum() / -power.sum())
    assert wrong[1] < wrong[0] / 8.0  # between first and second order: single elements are noise
