"""Equal loads and wear in all units of common use."""

import math

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.mechanics.hertz_contact import hertz, hertz_line
from tractive_sam.scene import describe_load

DISCS = ts.Scene.builtin("twin-discs").with_set(
    ["grid.half_length=[0.35, 0.9]", "grid.elements=[15, 25]", "wear.revolutions=1"]
)
OF_EACH = {"A": 1e-3, "B": 3e-3}


def faults(scene, *settings):
    with pytest.raises(ts.SceneError) as caught:
        scene.with_set(settings)
    return {fault.key: fault.allowed for fault in caught.value.faults}


@pytest.mark.parametrize("radii", [(10.0, 10.0), (3.0, 80.0), (80.0, 3.0)])
def test_load_of_a_peak_pressure(radii):
    found = hertz(1e5, *radii, pressure=1500.0)
    again = hertz(1e5, *radii, load=found.load)
    assert found.p0 == 1500.0
    # The closed forms reversed, to rounding.
    for name in ("a", "b", "p0", "approach"):
        assert getattr(found, name) == pytest.approx(getattr(again, name), rel=1e-13)


def test_load_of_a_peak_pressure_along_a_line():
    found = hertz_line(1e5, 10.0, pressure=500.0)
    assert hertz_line(1e5, 10.0, found.load).p0 == pytest.approx(500.0, rel=1e-14)  # rounding


@pytest.mark.parametrize("name", ["spheres", "cylinders"])
def test_a_scene_by_its_pressure_is_that_by_its_load(name):
    by_load = ts.Scene.builtin(name).replace(
        subsurface=None, grid=None, **{"load.normal": 0.5, "load.approach": None}
    )
    by_pressure = by_load.with_set([f"load.pressure={by_load.hertz.p0!r}"])
    assert by_pressure.load.normal is None
    assert by_pressure.normal_load == pytest.approx(0.5, rel=1e-13)  # rounding
    assert ts.Scene.from_toml_text(by_pressure.to_toml()) == by_pressure
    assert by_pressure.with_set(["load.normal=0.5"]) == by_load
    contact = ts.solve(by_pressure.replace(creepage=None, friction=None))
    assert pytest.approx(0.5, rel=1e-7) == contact.P  # the tolerance of the contact conditions


def test_friction_bounds_the_force_under_a_pressure():
    sphere = ts.Scene.builtin("spheres")
    by_pressure = sphere.with_set([f"load.pressure={sphere.hertz.p0}"])
    assert faults(by_pressure, "load.force_x=1e3").keys() == {"load.force_x"}


def test_a_pressure_is_of_the_radii_only():
    gap = {"x": [-5, 5], "y": [-5, 5], "separation": [[0, 0], [0, 0]]}
    with pytest.raises(ts.SceneError, match=r"load\.normal") as caught:
        DISCS.replace(gap=gap, **{"load.pressure": 900.0})
    assert [fault.key for fault in caught.value.faults] == ["load.pressure"]
    assert "pressure" in faults(DISCS, "load.normal=1", "load.pressure=1")["load.normal"]


@pytest.mark.parametrize(
    ("coefficient", "intensities"),
    [(2e-3, (2e-6, 2e-6)), ((2e-3, 1e-3), (2e-6, 1e-6)), (OF_EACH, (4e-6, 4e-6))],
)
def test_coefficients_are_intensities(coefficient, intensities):
    scene = DISCS.replace(**{"wear.coefficient": coefficient})
    assert scene.wear.intensity is None
    assert scene.wear.intensities == pytest.approx(intensities, rel=1e-14)  # rounding
    assert ts.Scene.from_toml_text(scene.to_toml()) == scene
    assert hash(ts.Scene.from_toml_text(scene.to_toml()).wear) == hash(scene.wear)
    assert scene.with_set(["wear.intensity=[2e-6, 1e-6]"]) == DISCS


def test_the_same_wear_by_either_key():
    by_intensity = ts.roll(DISCS)
    by_coefficient = ts.roll(DISCS.with_set(["wear.coefficient=[2e-3, 1e-3]"]))
    for name in ("wear_profile", "Qx"):  # but for rounding
        np.testing.assert_allclose(by_intensity[name], by_coefficient[name], rtol=1e-9)


def test_a_coefficient_of_each_body_shares_the_depth():
    harder = DISCS.with_set(["body.A.hardness=7e3", "body.B.hardness=3e3"])
    scene = harder.with_set(["wear.coefficient.A=1e-3", "wear.coefficient.B=3e-3"])
    assert scene.wear_share == {"A": 0.25, "B": 0.75}
    history = ts.roll(scene)
    np.testing.assert_allclose(history["wear_profile_B"], 3 * history["wear_profile_A"], rtol=1e-12)
    both = faults(scene, "body.A.hardness=1", "body.B.hardness=1")
    assert both.keys() == {"body.A.hardness, body.B.hardness"}
    nothing = DISCS.replace(**{"wear.coefficient": {"A": 0, "B": 0}})
    assert sum(nothing.wear_share.values()) == 1.0


def test_one_coefficient_or_one_intensity():
    both = "wear.intensity=1e-6", "wear.coefficient=1e-3"
    assert faults(DISCS, *both).keys() == {"wear.intensity"}
    assert faults(DISCS, "wear.coefficient.A=1e-3").keys() == {"wear.coefficient.B"}
    assert "A = ..., B = ..." in faults(DISCS, "wear.coefficient=-1")["wear.coefficient"]
    with pytest.raises(ts.SceneError, match="intensity"):
        ts.Wear(revolutions=5)


def test_hardness_of_both_bodies_or_none():
    assert faults(DISCS, "body.B.hardness=7e3").keys() == {"body.A.hardness"}
    assert DISCS.wear_share == {"A": 0.5, "B": 0.5}


@pytest.mark.parametrize(
    "settings",
    [
        ["load.pressure=1000"],
        ["load.approach=0.005"],
        ["wear.coefficient=2e-3"],
        ["body.A.hardness=7e3", "body.B.hardness=3e3", "body.B.density=2700"],
        ["wear.coefficient.A=1e-3", "wear.coefficient.B=3e-3", "wear.turns=each"],
    ],
)
def test_load_and_wear_are_described_in_both_units(settings):
    scene = DISCS.with_set(settings)
    rows = describe_load(scene)
    assert f"p0 = {scene.hertz.p0:.6g} MPa" in rows["load"]
    assert f"P = {scene.hertz.load:.6g}" in rows["load"]
    assert "/MPa" in rows["wear"]
    assert "mm3/(N m)" in rows["wear"]
    assert "both" in rows["wear"]
    assert "N counts the revolutions of body A" in rows["turns"]
    assert math.isfinite(float(rows["wear depth"].split()[0]))
