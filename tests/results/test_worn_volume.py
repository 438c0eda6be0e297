"""Volume and mass worn off each body, and T-gamma, by laws that know nothing of elements."""

import math

import numpy as np
import pytest

import tractive_sam as ts

STEEL = {"young": 208e3, "poisson": 0.3, "radius_y": 65.0}


def discs(radius_B, *settings, **tables):
    """Discs on a coarse mesh; isotropic, so that the worn volume is i/mu of the work."""
    bodies = {"A": STEEL | {"radius_x": 30.0}, "B": STEEL | {"radius_x": radius_B}}
    wear = {"coefficient": 2e-3, "revolutions": 4, "save": [4], "turns": "each"}
    scene = ts.Scene(
        body=bodies,
        load={"normal": 300.0},
        creepage={"longitudinal": -0.003},
        friction={"mu": 0.4},
        wear=wear | {"stepping": "every-revolution"},
        grid={"half_length": (0.6, 0.9), "elements": (31, 31)},
    )
    return scene.replace(**tables).with_set(settings)


@pytest.mark.parametrize("radius_B", [30.0, 8.0, -90.0])
def test_bodies_that_roll_the_same_distance_wear_as_their_coefficients(radius_B):
    history = ts.roll(discs(radius_B, "wear.coefficient={A=1e-3, B=3e-3}"))
    A, B = history["worn_volume"].T
    assert A[0] == B[0] == 0.0
    np.testing.assert_allclose(B[1:], 3.0 * A[1:], rtol=1e-9)  # rounding
    # A has turned N times through the work of friction; i/mu of it is worn, 1 in 4 parts of A.
    distance = 2 * math.pi * 30.0
    work = np.cumsum(history["dissipation"][1:]) * distance
    np.testing.assert_allclose(A[1:], 1e-6 / 0.4 * work, rtol=5e-3)  # slip of a coarse mesh


def test_mass_is_by_the_density_of_each_body():
    history = ts.roll(discs(30.0, "body.B.density=2700"))
    volume, mass = history["worn_volume"][-1], history["worn_mass"][-1]
    np.testing.assert_allclose(mass / volume, [7.85, 2.7], rtol=1e-12)  # mg/mm³; rounding
    reported = history.to_dict()
    assert reported["worn_mass"]["B"][-1] == mass[1]
    assert reported["worn_volume"].keys() == {"A", "B"}


def test_a_flat_body_has_no_circumference():
    history = ts.roll(discs(math.inf))
    assert np.isnan(history["worn_volume"][:, 1]).all()
    assert history.to_dict()["worn_mass"]["B"] == [None] * len(history)
    assert (history["worn_volume"][1:, 0] > 0.0).all()


def test_jumps_wear_what_single_revolutions_do():
    settings = ["wear.revolutions=60", "wear.save=[60]"]
    one_by_one = ts.roll(discs(12.0, *settings))
    jumps = ts.roll(discs(12.0, *settings, "wear.stepping=adaptive"))
    assert len(jumps) < len(one_by_one)
    np.testing.assert_allclose(  # the tolerance of the stepping is 1e-3
        jumps["worn_volume"][-1], one_by_one["worn_volume"][-1], rtol=2e-3
    )


def test_along_a_line_it_is_per_length():
    line = {body: STEEL | {"radius_x": 30.0, "radius_y": math.inf} for body in "AB"}
    scene = discs(30.0, body=line, grid=None, **{"load.normal": 100.0})
    history = ts.roll(scene)
    depth = history["wear_profile_A"][-1].item()
    assert history.columns["worn_volume"].unit == "mm2"
    assert history.columns["worn_mass"].unit == "mg/mm"
    assert history.columns["area"].unit == "mm"
    assert history["worn_volume"][-1, 0] == pytest.approx(2 * math.pi * 30.0 * depth, rel=1e-12)


def test_t_gamma_is_the_work_supplied_to_equal_bodies():
    contact = ts.solve(discs(30.0, "creepage.spin=0.02", "creepage.lateral=1e-3"))
    assert contact.t_gamma == contact.work_supplied
    assert contact.t_gamma_over_area == contact.t_gamma / contact.area


def test_creepage_is_found_where_a_force_is_prescribed():
    scene = discs(30.0, "load.force_y=60")
    history = ts.roll(scene)
    given, found = history["creepage_found"].T
    assert np.isnan(given).all()
    np.testing.assert_array_equal(found, history["xi_y"])
    assert found[0] < 0.0 < history["Qy"][0]  # a negative creepage drives A
    assert "creepage_found" not in ts.roll(discs(30.0)).columns
