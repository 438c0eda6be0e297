"""Error bars: of known errors, of real contacts against much finer meshes, and their limits."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tractive_sam as ts
from tractive_sam.contact import Model, solve_on_fitted_mesh
from tractive_sam.run.error_bars import (
    BodyColumn,
    BodyStress,
    Levels,
    Sample,
    error_bars,
    relative_error_bars,
)
from tractive_sam.subsurface import maxima_by_body

pytestmark = pytest.mark.slow  # meshes far finer than requested

INSIDE, SURFACE = (BodyStress("von_mises_max", "A", surface) for surface in (False, True))

NAMES = ("P", "Qx", "Qy", "Mz", "xi_x", "xi_y", "approach", "p_max", "wear_max")


@given(
    limit=st.floats(0.1, 10.0),
    constant=st.floats(-0.5, 0.5),
    order=st.floats(1.0, 2.0),
)
def test_errors_of_first_to_second_order_are_within(limit, constant, order):
    """A safety of 3 covers the factor 1/(2^(p/2) - 1) <= 2.42 from difference to error."""
    meshes = []
    for h in (2.0, math.sqrt(2.0), 1.0):
        value = limit + constant * h**order
        meshes.append(
            Sample(dict.fromkeys(NAMES, value), dict.fromkeys(NAMES, limit), residual=0.0)
        )
    bars = relative_error_bars(*meshes)
    rounding = 1e-14 * limit
    for name in NAMES:
        assert abs(meshes[-1].values[name] - limit) <= bars[name] * limit + rounding


@given(limit=st.floats(0.1, 10.0), constant=st.floats(-0.5, 0.5), order=st.floats(0.5, 2.0))
def test_surface_stress_of_half_an_order_is_within(limit, constant, order):
    """A safety of 6 at surfaces covers 1/(2^(p/2) - 1) <= 5.29."""
    values = [limit + constant * h**order for h in (2.0, math.sqrt(2.0), 1.0)]
    scales = dict.fromkeys(NAMES, 1.0) | {SURFACE: limit}
    meshes = [Sample(dict.fromkeys(NAMES, 1.0) | {SURFACE: v}, scales, 0.0) for v in values]
    bar = relative_error_bars(*meshes)[SURFACE]
    assert abs(values[-1] - limit) <= bar * limit + 1e-14 * limit


@pytest.mark.parametrize(("order", "limitless"), [(-0.5, True), (-0.25, True), (0.5, False)])
def test_a_peak_without_limit_has_no_finite_bar(order, limitless):
    """At a step the pressure grows as h^(-1/2)."""
    values = [1.0 + math.copysign(1.0, -order) * h**order for h in (2.0, math.sqrt(2.0), 1.0)]
    scales = dict.fromkeys((*NAMES, SURFACE), 1.0)
    fine = dict.fromkeys(scales, 1.0)
    meshes = [Sample(fine | {"p_max": value}, scales, 0.0) for value in values]
    bars = relative_error_bars(*meshes)
    assert math.isinf(bars["p_max"]) == math.isinf(bars[SURFACE]) == limitless


def test_where_there_was_no_inner_maximum_none_is_compared():
    values = {INSIDE: 962.0, SURFACE: 1250.0}
    scales = dict.fromkeys(NAMES, 1.0) | dict.fromkeys(values, 1250.0)
    fine = Sample(dict.fromkeys(NAMES, 1.0) | values, scales, 0.0)
    none = Sample(fine.values | {INSIDE: 0.0}, scales, 0.0)
    assert error_bars(relative_error_bars(none, fine, fine), fine)["von_mises_max"] == {"A": 0.0}


def test_a_chance_agreement_of_two_meshes_is_not_trusted():
    scales = dict.fromkeys(NAMES, 1.0)
    coarse, fine = (Sample(dict.fromkeys(NAMES, value), scales, 0.0) for value in (1.1, 1.0))
    assert relative_error_bars(coarse, fine, fine)["Qx"] > 0.1


def test_what_is_seen_of_one_force_is_expected_of_all():
    scales = dict.fromkeys(NAMES, 1.0)
    values = dict.fromkeys(NAMES, 1.0)
    coarse, fine = Sample(values | {"Qx": 1.1}, scales, 0.0), Sample(values, scales, 0.0)
    bars = relative_error_bars(coarse, coarse, fine)
    assert 0.0 < bars["Qy"] < bars["Qx"]
    assert bars["approach"] == 0.0


@pytest.mark.parametrize("criterion", ["dang-van", "crossland"])
def test_the_points_of_a_path_count_in_the_bar_of_utilisation(criterion):
    """All meshes have as many points far from the contact: their differences do not show it."""
    material = {"limit": 250.0, "sensitivity": 0.333, "criterion": criterion, "bodies": ["A"]}
    grid = {"half_length": (0.32, 0.9), "elements": (25, 25)}
    scene = ts.Scene.builtin("twin-discs").replace(wear=None, subsurface=None, grid=grid)
    scene = scene.replace(fatigue=material | {"elements": 8})
    contact = ts.solve(scene)
    one = Sample.from_contact(contact, {}, ts.fatigue(contact))
    largest = ts.fatigue(contact)["A"].utilisation_max
    bar = error_bars(relative_error_bars(one, one, one), one)["utilisation"]["A"]
    least = ts.Laws.of(scene).fatigue.path_error * largest
    assert bar >= (1.0 - 1e-12) * least > 0.0  # of rounding


def test_the_points_of_a_path_count_in_the_bar_of_the_stressed_volume():
    """By the power of the stress in the integral, 31/3."""
    material = {"criterion": "orthogonal-shear", "limit": 1.0, "bodies": ["A"], "elements": 8}
    grid = {"half_length": (0.32, 0.9), "elements": (25, 25)}
    scene = ts.Scene.builtin("twin-discs").replace(wear=None, subsurface=None, grid=grid)
    contact = ts.solve(scene.replace(fatigue=material | {"volume": {}}))
    one = Sample.from_contact(contact, {}, ts.fatigue(contact))
    bar = relative_error_bars(one, one, one)[BodyColumn("stressed_volume", "A")]
    # Rounding of two integrals, over the difference of both.
    error = ts.Laws.of(contact.scene).fatigue.path_error
    assert bar == pytest.approx((1.0 + error) ** (31.0 / 3.0) - 1.0, rel=1e-6)


SCENES = {
    "spheres": {},
    "spheres-orthotropic": {"creepage.spin": 0.003},
    "twin-discs": {"body.B.young": 70e3, "body.B.poisson": 0.2, "wear": None},
    "cylinders": {},
}


@pytest.mark.parametrize("name", SCENES)
def test_bars_hold_against_a_much_finer_mesh(name):
    planes = {"subsurface": {"planes": ("y=0",)}}
    scene = ts.Scene.builtin(name).replace(**{"accuracy.tolerance": 5e-3, **planes, **SCENES[name]})
    contact = ts.solve(scene)
    levels = Levels(scene, None)
    finer = levels.grid(levels.find_level(contact.grid) + 3)  # 2.8 times finer in every direction
    _, (fine,) = solve_on_fitted_mesh(Model(scene, None, finer))
    for quantity in ("Qx", "Qy", "Mz", "approach", "p_max"):
        error = abs(getattr(contact, quantity) - getattr(fine, quantity))
        assert error <= contact.error_bars[quantity], quantity
    here, there = maxima_by_body(contact), maxima_by_body(fine)
    for body in "AB":
        error = abs(here[body].value - there[body].value)
        assert error <= contact.error_bars["von_mises_max"][body]


def test_forces_are_within_the_tolerance():
    scene = ts.Scene.builtin("spheres").replace(**{"accuracy.tolerance": 1e-3})
    contact = ts.solve(scene)
    force = np.hypot(*contact.traction).sum() * contact.grid.element_area
    assert contact.error_bars["Qx"] <= 1e-3 * force
    assert contact.error_bars["p_max"] <= 1e-3 * contact.p_max
    # They are given, and met to the residual.
    assert contact.error_bars["P"] == pytest.approx(abs(contact.P - 0.4705), abs=1e-12)
    assert contact.error_bars["xi_x"] == 0.0


def test_a_creepage_that_is_found_has_a_bar():
    scene = ts.Scene.builtin("spheres").replace(**{"accuracy.tolerance": 1e-2, "load.force_x": 0.1})
    contact = ts.solve(scene)
    assert 0.0 < contact.error_bars["xi_x"] <= 1e-2 * abs(contact.xi_x)
    assert contact.error_bars["Qx"] == abs(contact.Qx - 0.1)


def test_a_tolerance_out_of_reach_is_reported_with_the_cure():
    scene = ts.Scene.builtin("spheres").replace(
        **{"accuracy.tolerance": 1e-5, "accuracy.elements": 2000}
    )
    with pytest.raises(ts.NotConverged, match=r"accuracy\.elements") as caught:
        ts.solve(scene)
    assert math.prod(caught.value.contact.grid.elements) <= 2000
    assert caught.value.contact.error_bars["Qx"] > 0.0
    history = ts.roll(scene)
    assert history.status == "inaccurate"
    assert not history.finished
    assert history["Qx_error"][0] == caught.value.contact.error_bars["Qx"]


def test_every_level_is_recognised_by_its_mesh():
    levels = Levels(ts.Scene.builtin("twin-discs").replace(**{"accuracy.tolerance": 0.01}), None)
    for level in (-4, -1, 0, 3):
        assert levels.find_level(levels.grid(level)) == level
    with pytest.raises(LookupError):
        levels.find_level(Levels(ts.Scene.builtin("spheres"), None).grid(0))


def test_tractions_tiny_against_the_pressure_take_no_finer_mesh():
    """Bodies of moduli that differ by 1e-6, and a creepage of 1e-7: some 1e-5 of the pressure."""
    scene = ts.Scene.builtin("spheres").replace(
        **{"body.B.shear": 1.000001, "creepage.longitudinal": -1e-7},
        **{"accuracy.tolerance": 1e-2, "grid": None, "subsurface": None},
    )
    contact = ts.solve(scene)
    usual = Model(scene).grid
    assert math.prod(contact.grid.elements) <= 2 * math.prod(usual.elements)


def test_error_bars_of_the_life_of_a_volume_hold_what_a_finer_mesh_finds():
    """And are infinite with friction: the integral has no limit at the surface."""
    requested = {"criterion": "orthogonal-shear", "limit": 1.0, "volume": {"constant": 1e-34}}
    discs = ts.Scene.builtin("twin-discs").replace(
        grid=None, subsurface=None, wear=None, fatigue=requested
    )
    smooth = discs.replace(friction=None, creepage=None)
    reported = ts.roll(smooth.replace(accuracy={"tolerance": 0.05}))
    half = tuple(1.05 * one for one in reported.grid.half_length)
    finer = ts.roll(smooth.replace(grid={"half_length": half, "elements": (101, 101)}))
    for name in ("stressed_volume", "volume_life"):
        missed, bar = np.abs(reported[name][0] - finer[name][0]), reported[f"{name}_error"][0]
        assert (missed < bar).all()
        assert (bar < 0.5 * reported[name][0]).all()
    rough = ts.roll(discs.replace(accuracy={"tolerance": 0.05}))
    hinges = rough["volume_at_top"][0] > 0.9
    assert hinges.any()
    assert np.isinf(rough["volume_life_error"][0][hinges]).all()


def test_error_bars_of_fatigue_hold_what_a_finer_mesh_finds():
    material = {"shear_yield": 300.0, "sensitivity": 0.333, "limit": 250.0, "elements": 12}
    discs = ts.Scene.builtin("twin-discs").replace(grid=None, subsurface=None, fatigue=material)
    reported = ts.roll(discs.replace(wear=None, accuracy={"tolerance": 0.05}))
    assert np.prod(reported.grid.elements) < 40**2
    half = tuple(1.05 * one for one in reported.grid.half_length)
    mesh = {"half_length": half, "elements": (101, 101)}
    finer = ts.roll(discs.replace(wear=None, grid=mesh))
    for name in ("utilisation", "shakedown_lower", "shakedown_upper", "fatigue_life"):
        bar = reported[f"{name}_error"][0]
        assert (np.abs(reported[name][0] - finer[name][0]) < bar).all()
        power = 10.0 if name == "fatigue_life" else 1.0  # of the Woehler line
        assert (
            bar < ((1.0 - 0.15) ** -power - 1.0) * reported[name][0]
        ).all()  # found 0.04 to 0.09
    worn = {"wear.revolutions": 4, "wear.save": (4,), "accuracy": {"tolerance": 0.1}}
    assert (ts.roll(discs.replace(**worn))["damage_error"][-1] > 0.0).all()
