"""A measured separation added to the separation of the radii."""

import numpy as np
import pytest

from tests.scenes import steady
from tractive_sam.contact import Model, equilibrium
from tractive_sam.run import solve
from tractive_sam.scene import Scene
from tractive_sam.schema import SceneError, SceneWarning


def with_gap(x, y, separation, **changes):
    tables = Scene.builtin("spheres").entries()
    tables["grid"]["elements"] = (31, 31)
    tables |= {"gap": {"x": x, "y": y, "separation": separation}} | changes
    scene = Scene(**tables)
    return equilibrium(Model(scene, (scene.gap.x, scene.gap.y, scene.gap.separation)))


def test_a_flat_gap_changes_nothing():
    plain = steady("spheres", elements=31)
    flat = with_gap([-5.0, 5.0], [-5.0, 5.0], np.full((2, 2), 0.3))
    np.testing.assert_allclose(flat.pressure, plain.pressure, atol=1e-9)
    # The approach counts from the first touch.
    assert flat.approach == pytest.approx(plain.approach, rel=1e-9)


def test_a_profile_may_be_reported_for_the_mesh_only():
    plain = steady("spheres", elements=31)
    x = np.linspace(-6.0, 6.0, 33)
    flat = with_gap(x, [-9.0, 9.0], np.full((33, 2), 0.3))
    np.testing.assert_allclose(flat.pressure, plain.pressure, atol=1e-9)  # tolerance of the solver
    waves = 1e-3 * np.sin(9.0 * x)[:, None] * np.ones(2)
    rolling = Scene.builtin("spheres").replace(gap={"x": x, "y": [-9.0, 9.0], "separation": waves})
    with pytest.warns(SceneWarning, match="creepage|roll"):
        solve(rolling, throw=False)


def test_a_gap_can_stand_for_the_radii():
    plain = steady("spheres", elements=31)
    x = np.linspace(-4.5, 4.5, 301)
    tables = Scene.builtin("spheres").entries()["body"]
    flat = {n: b | {"radius_x": float("inf"), "radius_y": float("inf")} for n, b in tables.items()}
    shape = (x[:, None] ** 2 + x[None, :] ** 2) / 337.5
    gap = with_gap(x, x, shape, body=flat)
    # The interpolation is exact for parabolas: two solves to 1e-8.
    np.testing.assert_allclose(gap.pressure, plain.pressure, atol=1e-6 * plain.p_max)
    assert gap.Qx == pytest.approx(plain.Qx, rel=1e-6)


@pytest.mark.parametrize("approach", [0.0, -0.01, 0.01])
def test_a_separation_may_interfere(approach):
    """With gap.datum the approach is counted from the zero of the separation."""
    tables = Scene.builtin("spheres").entries()["body"]
    flat = {n: b | {"radius_x": float("inf"), "radius_y": float("inf")} for n, b in tables.items()}
    x = np.linspace(-4.5, 4.5, 301)
    plain = steady("spheres", elements=31)
    shape = (x[:, None] ** 2 + x[None, :] ** 2) / 337.5 - (plain.approach - approach)
    gap = {"x": x, "y": x, "separation": shape, "datum": "separation"}
    found = with_gap(x, x, shape, body=flat, gap=gap, load={"approach": approach})
    # Two solves to 1e-8; the error of the approach is the larger one.
    np.testing.assert_allclose(found.pressure, plain.pressure, atol=1e-6 * plain.p_max)
    # The solver has it in its own unit.
    assert found.approach == pytest.approx(approach, rel=4e-16)
    with pytest.raises(SceneError, match=r"load\.approach"):
        with_gap(x, x, shape, body=flat, load={"approach": -abs(approach)})


def test_a_coarse_profile_makes_no_facets():
    """Three points over the semi-axis are enough for the bodies of Hertz."""
    tables = Scene.builtin("spheres").entries()["body"]
    flat = {n: b | {"radius_x": float("inf"), "radius_y": float("inf")} for n, b in tables.items()}
    x = np.linspace(-5.0, 5.0, 10)
    plain = steady("spheres", elements=31)
    gap = with_gap(x, x, (x[:, None] ** 2 + x[None, :] ** 2) / 337.5, body=flat)
    np.testing.assert_allclose(gap.pressure, plain.pressure, atol=1e-6 * plain.p_max)


def test_a_step_in_a_profile_does_not_ring():
    x = np.linspace(-5.0, 5.0, 41)
    step = np.where(x > 0.1, 1.0, 0.0)[:, None] * np.ones(41)
    pressed = Scene.builtin("spheres").replace(creepage=None)  # in rolling it would stand still
    added = Model(pressed, (x, x, step)).undeformed_gap - Model(pressed).undeformed_gap
    # On flats beside a step the slopes of Akima's formula vanish; rounding is left.
    assert added.min() > -1e-12
    assert added.max() < 1.0 + 1e-12


def test_points_that_make_no_curve_are_joined_by_lines():
    x = np.array([-5.0, 5.0])
    tilted = Model(Scene.builtin("spheres"), (x, x, np.array([[0.0, 0.0], [1.0, 1.0]])))
    plain = Model(Scene.builtin("spheres"))
    slope = np.diff(tilted.undeformed_gap - plain.undeformed_gap, axis=0) / plain.grid.dx
    np.testing.assert_allclose(slope, 0.1, rtol=1e-9)


def test_two_bumps_make_two_contacts():
    x = np.linspace(-4.5, 4.5, 91)
    valley = 0.05 * np.exp(-(x**2))[None, :] * np.ones((91, 1))
    contact = with_gap(x, x, valley)
    row = contact.touching[15]
    edges = np.flatnonzero(np.diff(row.astype(int)) == 1)
    assert len(edges) == 2
    assert contact.converged
