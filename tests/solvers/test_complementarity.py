"""Complementarity of dissimilar bodies: pressure only where the gap is closed, zero elsewhere.

It decides which elements lead, slip, touch and wear; so mirror images must agree.
"""

import copy

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.contact import Model, equilibrium
from tractive_sam.contact.steady import dimensionless_start
from tractive_sam.solvers.newton import Iterate

TOLERANCE = 1e-9
SCENE = {
    "body": {
        "A": {"young": 208e3, "poisson": 0.3, "radius_x": 30.0, "radius_y": 40.0},
        "B": {"young": 400e3, "poisson": 0.24, "radius_x": 50.0, "radius_y": 25.0},
    },
    "load": {"normal": 300.0},
    "creepage": {"longitudinal": 3.069e-4, "lateral": 9.803e-4, "spin": 6.8188e-3},
    "friction": {"mu": [0.4, 0.25], "angle": 14.61},
    "grid": {"half_length": [0.68, 0.62], "elements": [25, 25]},
    "solver": {"tolerance": TOLERANCE},
}
FORCE = {"load": {"force_x": -30.0}, "creepage": {"lateral": 2e-4, "spin": 3e-3}}
FALLING = {"friction": {"law": "exponential", "static": 0.4, "kinetic": 0.3, "half_speed": 300.0}}
FALLING["creepage"] = SCENE["creepage"] | {"speed": 2e4}
COURSE = {"distance": [0.0, 0.5], "load": {"normal": [300.0, 200.0]}}
CHANGES = {
    "auto": {},
    "rough": {"solver": {"tolerance": 1e-6}},
    "upwind": {"solver": {"slip": "upwind"}},
    "newton": {"solver": {"method": "newton"}},
    "anderson": {"solver": {"method": "anderson"}},
    "nested": {"grid": {"elements": [50, 50]}},
    "force": FORCE,
    "falling": FALLING,
    "transient": {"transient": COURSE},
}


def tables(change, sign=1.0):
    """Return the tables of a scene; of its mirror image in y for a negative sign."""
    out = copy.deepcopy(SCENE)
    for name, table in copy.deepcopy(change).items():
        if name in ("creepage", "friction"):
            out[name] = table
        else:
            out[name] = out.get(name, {}) | table
    for table, key in (("creepage", "lateral"), ("creepage", "spin"), ("friction", "angle")):
        if key in out[table]:
            out[table][key] *= sign
    return out


def solve(change, sign=1.0):
    scene = ts.Scene(**tables(change, sign))
    if scene.transient is None:
        return ts.solve(scene)
    return ts.roll(scene, progress=False).state()


def check_closed(contact):
    tolerance = contact.scene.solver.tolerance
    open_by = np.abs(contact.gap[contact.pressure > 0.0]).max()
    # The residual is relative to the norm of all pressures, some 20 times a mean one.
    assert open_by <= 100.0 * tolerance * contact.approach
    assert contact.gap[contact.pressure == 0.0].min() >= -100.0 * tolerance * contact.approach


@pytest.mark.slow
@pytest.mark.parametrize("name", CHANGES)
def test_pressure_needs_a_closed_gap_and_mirror_images_agree(name):
    contact, image = solve(CHANGES[name]), solve(CHANGES[name], -1.0)
    check_closed(contact)
    check_closed(image)
    np.testing.assert_array_equal(contact.touching, image.touching[:, ::-1])
    # A hundred residuals: one step of Newton's method multiplies them by the condition.
    atol = 100.0 * contact.scene.solver.tolerance
    np.testing.assert_allclose(
        contact.pressure, image.pressure[:, ::-1], rtol=0.0, atol=atol * contact.p_max
    )
    sign = np.array([1.0, -1.0])[:, None, None]
    np.testing.assert_allclose(
        contact.traction, sign * image.traction[..., ::-1], rtol=0.0, atol=atol * contact.p_max
    )


def test_the_solution_does_not_depend_on_the_initial_guess():
    contact = solve({})
    nearby = solve({"load": {"normal": 310.0}})
    again = equilibrium(Model(contact.scene, grid=contact.grid), start=nearby)
    check_closed(again)
    np.testing.assert_array_equal(again.touching, contact.touching)
    # A hundred residuals, as between mirror images.
    atol = 100.0 * TOLERANCE * contact.p_max
    np.testing.assert_allclose(again.traction, contact.traction, rtol=0.0, atol=atol)


def test_a_pressure_left_on_an_open_gap_makes_no_leading_element():
    contact = solve({})
    model = Model(contact.scene, grid=contact.grid)
    problem = model.problem(model.undeformed_gap / model.units.gap)
    start = dimensionless_start(model, contact)
    left = np.where(start.pressure > 0.0, start.pressure, 1e-14)
    iterates = [
        Iterate(problem, p, start.traction, start.approach, np.zeros(0))
        for p in (start.pressure, left)
    ]
    clean, unclean = iterates
    assert clean.is_admissible
    assert not unclean.is_admissible
    assert (unclean.seen.stiffness > 0.0).sum() == (clean.seen.stiffness > 0.0).sum()
    assert unclean.residual == pytest.approx(clean.residual, abs=TOLERANCE)  # no separate residual
    assert unclean.within_bound(problem).is_admissible
