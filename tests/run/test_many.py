"""Many similar contacts: equal to single solves, labelled, and invalid arguments."""

import itertools

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.run.many import neighbouring_places

pytest.importorskip("xarray", reason="xarray is of the extra study")

XI = "creepage.longitudinal"


@pytest.fixture(scope="module")
def scene():
    return ts.Scene.builtin("spheres").with_set(["grid.elements=[15, 15]"])


def test_is_what_solve_finds_one_by_one(scene):
    over = {"friction.mu": [0.2, 0.4], XI: [-1e-3, -3e-3], "creepage.spin": [0.0, 1e-3]}
    found = ts.solve_many(scene, over)
    assert found["Qx"].dims == tuple(over)
    assert found["Qx"].attrs["units"] == "N"
    assert found["converged"].all()
    assert (found["status"] == "converged").all()
    for values in itertools.product(*over.values()):
        case = dict(zip(over, values, strict=True))
        single, here = ts.solve(scene.replace(**case)), found.sel(case)
        for name in ("P", "Qx", "Qy", "Mz", "approach", "xi_x", "spin"):
            # What the tolerance of the scene, 1e-8, leaves of a solution.
            assert here[name].item() == pytest.approx(getattr(single, name), abs=1e-7, rel=1e-6)


def test_keys_may_vary_together(scene):
    rows = [(0.3, -1e-3), (0.45, -2e-3), (0.4, -2e-3)]
    over = {("load.normal", XI): rows, "friction.mu": [0.2, 0.4]}
    found = ts.solve_many(scene, over)
    assert dict(found.sizes) == {"case": 3, "friction.mu": 2}
    np.testing.assert_array_equal(found[XI], [xi for _, xi in rows])
    single = ts.solve(scene.replace(**{"load.normal": 0.4, XI: -2e-3, "friction.mu": 0.4}))
    assert found["Qx"][2, 1].item() == pytest.approx(single.Qx, rel=1e-6)  # solver.tolerance
    creepages = {(XI, "creepage.spin"): [(-1e-3, 0.0), (-2e-3, 1e-3)]}
    assert ts.solve_many(scene, creepages)["converged"].all()
    with pytest.raises(ts.SceneError, match=r"load\.normal.*\b2\b"):
        ts.solve_many(scene, {("load.normal", XI): [(0.3,)]})


def test_blocks_are_left_out(scene):
    cycle = scene.replace(fatigue={"shear_yield": 1.0}, duty=[{"revolutions": 1}] * 2)
    assert ts.solve_many(cycle, {XI: [-1e-3]})["converged"].all()


def test_where_there_may_be_several_solutions_each_begins_from_none(scene):
    law = {"law": "exponential", "static": 0.4, "kinetic": 0.2, "half_speed": 5.0}
    falling = scene.replace(friction=law, **{"creepage.speed": 1000.0})
    over = {XI: [-1e-3, -3e-3, -1e-2]}
    found = ts.solve_many(falling, over)
    single = [ts.solve(falling.replace(**{XI: value})).Qx for value in over[XI]]
    assert found["Qx"].values.tolist() == single


def test_costs_no_more_than_single_ones(scene):
    values = np.linspace(-1e-3, -3e-3, 9)
    found = ts.solve_many(scene, {XI: values})
    single = sum(ts.solve(scene.replace(**{XI: v})).cost.applications for v in values)
    assert found["operator_applications"].sum() < single


def test_jacobian(scene):
    found = ts.solve_many(scene, {XI: [-1e-3, -2e-3]}, jacobian=True)["jacobian"]
    single = ts.solve(scene.replace(**{XI: -2e-3}), jacobian=True).jacobian
    here = found.sel({XI: -2e-3}).values
    # An element on the verge of slip may be reported otherwise from another start.
    np.testing.assert_allclose(here, single.values, atol=1e-5 * np.abs(single.values).max())


def test_prescribed_force_is_replaced_by_a_creepage(scene):
    forced = scene.with_set(["load.force_x=0.05"])
    assert np.isfinite(ts.solve_many(forced, {XI: [-1e-3]})["Qx"]).all()


def test_a_case_that_fails_is_reported_and_no_number(scene):
    approached = scene.with_set(["load.approach=0.036"])
    found = ts.solve_many(approached, {"load.force_x": [0.01, 0.4]})  # more than friction carries
    carried, slid = (found.sel({"load.force_x": q}) for q in (0.01, 0.4))
    assert carried["converged"]
    assert not slid["converged"]
    assert np.isnan(slid["Qx"])
    assert slid["status"] != "converged"
    assert str(slid["message"].values)


@pytest.mark.parametrize(
    ("over", "key"),
    [
        ({}, "over"),
        ({"friction.angel": [0.0]}, "friction.angel"),
        ({XI: []}, XI),
        ({XI: "-1e-3"}, XI),
        ({XI: [-1e-3, "fast"]}, XI),
        ({XI: [float("nan")]}, XI),
        ({"friction.mu": [-0.2]}, "friction.mu"),
    ],
)
def test_faults_name_the_key(scene, over, key):
    with pytest.raises(ts.SceneError, match=key):
        ts.solve_many(scene, over)


@pytest.mark.parametrize(
    ("over", "reported", "not_told"),
    [
        ({"load.normal": [0.3, 900.0]}, ["grid.half_length", "load.normal = 900"], ["0.3"]),
        ({"load.normal": [900.0], "friction.mu": [0.2, 0.3]}, ["load.normal = 900"], []),
        ({"load.normal": [0.3], "friction.mu": [0.2, -1.0]}, ["friction.mu: given -1"], ["load"]),
        (
            {"load.normal": [0.2, 0.5], "grid.half_length": [(4.5, 4.5), (3.0, 3.0)]},
            ["(3.0, 3.0) with load.normal = 0.5"],
            ["0.2"],
        ),
    ],
)
def test_faults_name_the_values_that_led_to_them(scene, over, reported, not_told):
    with pytest.raises(ts.SceneError) as refused:
        ts.solve_many(scene, over)
    assert all(one in str(refused.value) for one in reported)
    assert not any(one in str(refused.value) for one in not_told)


def test_accuracy_is_refused(scene):
    accurate = scene.replace(grid=None, accuracy={"tolerance": 0.1})
    with pytest.raises(ValueError, match="accuracy"):
        ts.solve_many(accurate, {XI: [-1e-3]})


@pytest.mark.parametrize("shape", [(), (1,), (3,), (2, 3), (3, 1, 2), (2, 3, 2, 2)])
def test_path_meets_all_and_steps_to_neighbours(shape):
    places = list(neighbouring_places(shape))
    assert sorted(places) == sorted(itertools.product(*map(range, shape)))
    for here, there in itertools.pairwise(places):
        assert np.abs(np.subtract(here, there)).sum() == 1
