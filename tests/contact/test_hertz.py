"""The normal contact against Hertz."""

import numpy as np
import pytest

from tests.scenes import steady


def test_error_falls_with_the_mesh():
    """Mean error of pressure, relative to p0: the staircase edge makes it first order."""
    errors = []
    for n in (31, 61, 121):
        contact = steady("spheres", "friction.mu=0.001", elements=n)
        hertz = contact.scene.hertz
        truth = hertz.pressure(contact.grid.x[:, None], contact.grid.y[None, :])
        errors.append(np.abs(contact.pressure - truth).mean() / hertz.p0)
    assert errors[0] > 1.6 * errors[1] > 1.6 * 1.6 * errors[2]
    assert errors[-1] < 2e-3


def test_peak_size_and_approach():
    contact = steady("spheres")
    hertz = contact.scene.hertz
    assert pytest.approx(hertz.load, rel=1e-12) == contact.P
    # 78 elements across: the pressure is right to h², lengths to half an element.
    assert contact.p_max == pytest.approx(hertz.p0, rel=2e-4)
    assert contact.approach == pytest.approx(hertz.approach, rel=2e-4)
    assert contact.half_width_x == pytest.approx(hertz.a, abs=contact.grid.dx)


def test_ellipse_of_the_discs():
    contact = steady("twin-discs")
    hertz = contact.scene.hertz
    assert contact.p_max == pytest.approx(hertz.p0, rel=1e-3)
    assert contact.half_width_x == pytest.approx(hertz.a, abs=contact.grid.dx)
    assert contact.half_width_y == pytest.approx(hertz.b, abs=contact.grid.dy)


def test_load_and_approach_are_equivalent():
    loaded = steady("spheres", elements=31)
    approached = steady("spheres", f"load.approach={loaded.approach!r}", elements=31)
    np.testing.assert_allclose(approached.pressure, loaded.pressure, atol=1e-6 * loaded.p_max)
    assert approached.approach == loaded.approach


@pytest.mark.filterwarnings("ignore:grid.elements")
def test_contact_shrinks_to_a_few_elements_and_to_one():
    for load, most in ((1e-3, 140), (1e-7, 9)):
        contact = steady("spheres", f"load.normal={load}", elements=31)
        # One element bears its load, but is not a contact that the mesh resolves.
        resolved = min(contact.elements_across) >= 3
        assert contact.status == ("converged" if resolved else "not resolved"), contact.message
        assert contact.residual <= contact.scene.solver.tolerance
        assert 0 < np.count_nonzero(contact.touching) <= most
        assert pytest.approx(load, rel=1e-12) == contact.P


def test_off_the_grid_is_said():
    contact = steady(
        "spheres", "load.normal=0.47", "grid.half_length=[3.6, 3.5002]", "grid.elements=[21, 21]"
    )
    assert not contact.converged
    assert "grid.half_length" in contact.message


def test_scaling_of_load_and_radius():
    """p0 ~ P^(1/3) R^(-2/3), a ~ (P R)^(1/3): equal numbers on a mesh that scales along."""
    one = steady("spheres", elements=31)
    k = 2.0
    two = steady(
        "spheres",
        *(f"body.{b}.radius_{c}={k * 337.5}" for b in "AB" for c in "xy"),
        f"load.normal={k**2 * 0.4705}",
        f"grid.half_length=[{k * 4.08}, {k * 4.08}]",
        "grid.elements=[31, 31]",
    )
    np.testing.assert_allclose(two.pressure, one.pressure, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(two.traction, one.traction, rtol=1e-6, atol=1e-9)


def test_units_do_not_matter():
    """mm, N, MPa against m, N, Pa: equal results after equal numbers of iterations."""
    mm = steady("spheres", "creepage.spin=0.001", elements=31)
    metre = steady(
        "spheres",
        *(f"body.{b}.radius_{c}=0.3375" for b in "AB" for c in "xy"),
        *(f"body.{b}.shear=1e6" for b in "AB"),
        "creepage.spin=1.0",
        "grid.half_length=[4.08e-3, 4.08e-3]",
        "grid.elements=[31, 31]",
    )
    assert metre.cost == mm.cost
    np.testing.assert_allclose(metre.pressure, 1e6 * mm.pressure, rtol=1e-9, atol=1e-6)
    np.testing.assert_allclose(metre.traction, 1e6 * mm.traction, rtol=1e-7, atol=1e-3)


@pytest.mark.parametrize(("name", "share"), [("spheres", 0.95 ** (1 / 3)), ("cylinders", 0.99923)])
def test_pressure_above_which_a_twentieth_of_the_load_is_carried(name, share):
    """Of an ellipsoid the load above t p0 is 1 - t³; of a half ellipse (2/pi)(x t + asin x)."""
    contact = steady(name)
    assert contact.p_95 / contact.scene.hertz.p0 == pytest.approx(share, abs=2e-3)
