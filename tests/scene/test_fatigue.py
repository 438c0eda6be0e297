"""What is wrong with a [fatigue] table is reported with its key and the cure."""

import pytest

import tractive_sam as ts
from tractive_sam.schema import PlausibilityWarning

WHOLE = {"shear_yield": 300.0, "criterion": "dang-van", "sensitivity": 0.333, "limit": 250.0}


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"shear_yield": None, "limit": None}, "limit"),
        ({"yield_strength": 500.0}, "shear_yield"),
        ({"shear_yield": -1.0}, "shear_yield"),
        ({"sensitivity": None}, "sensitivity"),
        ({"sensitivity": -0.1}, "sensitivity"),
        ({"sensitivity": 1.5}, "sensitivity"),
        ({"criterion": "crossland", "sensitivity": 1.3}, "sensitivity"),
        ({"criterion": "findley", "sensitivity": 12.0}, "sensitivity"),
        ({"criterion": "orthogonal-shear"}, "sensitivity"),
        ({"criterion": "fatemi-socie", "shear_yield": None}, "yield_strength"),
        ({"criterion": "tresca"}, "criterion"),
        ({"criterion": "package.module:Law", "sensitivity": None, "limit": None}, "limit"),
        ({"exponent": 1e3}, "exponent"),
        ({"cycles": 0.0}, "cycles"),
        ({"elements": 3}, "elements"),
        ({"bodies": ["A", "A"]}, "bodies"),
        ({"bodies": []}, "bodies"),
        ({"depth": 0.0}, "depth"),
    ],
)
def test_a_fault(changes, key):
    given = {name: value for name, value in (WHOLE | changes).items() if value is not None}
    with pytest.raises(ts.SceneError) as error:
        ts.Fatigue(**given)
    assert key in [fault.key for fault in error.value.faults]


def test_pressure_beyond_all_shakedown_is_improbable():
    discs = ts.Scene.builtin("twin-discs")
    with pytest.warns(PlausibilityWarning, match="fatigue"):
        discs.replace(fatigue={"shear_yield": 200.0})


def test_one_yield_stress_stands_for_both():
    shear, tension = ts.Fatigue(shear_yield=300.0), ts.Fatigue(yield_strength=300.0 * 3**0.5)
    assert shear.yield_stress == pytest.approx(tension.yield_stress)
    assert shear.shear_yield_stress == pytest.approx(tension.shear_yield_stress)


def test_one_yield_stress_takes_the_place_of_the_other():
    scene = ts.Scene.builtin("spheres").replace(fatigue=WHOLE)
    changed = scene.with_set(["fatigue.yield_strength=500"])
    assert changed.fatigue.shear_yield is None
