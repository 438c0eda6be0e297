"""The [transient] table: ways to write it, and what is wrong with it."""

import pytest

import tractive_sam as ts

SPHERES = ts.Scene.builtin("spheres").replace(creepage=None)
TABLE = """
[transient]
distance = [0.0, 1.0, 1.0, 5.0]
start = "steady"
save = [0.5, 5.0]
{creepage}
"""
QUOTED = '"creepage.longitudinal" = [0.0, -0.003, -0.003, 0.0]'
DOTTED = "creepage.longitudinal = [0.0, -0.003, -0.003, 0.0]"
OWN = "[transient.creepage]\nlongitudinal = [0.0, -0.003, -0.003, 0.0]"


@pytest.mark.parametrize("creepage", [QUOTED, DOTTED, OWN])
def test_a_course_is_written_in_any_form(creepage):
    scene = ts.Scene.from_toml_text(SPHERES.to_toml() + TABLE.format(creepage=creepage))
    assert scene.transient.courses == {"creepage.longitudinal": (0.0, -0.003, -0.003, 0.0)}
    assert scene.transient.save == (0.5, 5.0)
    assert ts.Scene.from_toml_text(scene.to_toml()) == scene


FORCED = {"distance": [0.0, 1.0], "load.force_x": [0.0, 0.1]}
GOOD = {"distance": [0.0, 1.0, 2.0], "creepage.longitudinal": [0.0, -1e-3, 0.0]}


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"transient.distance": [0.0, 2.0, 1.0]}, "transient.distance"),
        ({"transient.distance": [0.0, 0.0, 0.0]}, "transient.distance"),
        ({"transient.creepage.longitudinal": [0.0, 1.0]}, "transient.creepage.longitudinal"),
        ({"transient.load.normal": [0.4, 0.0, 0.4]}, "transient.load.normal"),
        ({"transient.load.approach": [0.1, 0.1, 0.1]}, "transient.load.approach"),
        ({"transient.load.force_x": [0.0, 0.1, 0.1]}, "transient.creepage.longitudinal"),
        ({"transient.step": 8.0}, "transient.step"),
        ({"transient": FORCED | {"load.force_x": [0.0, 0.2]}}, "transient.load.force_x"),
        ({"transient": FORCED | {"load.normal": [0.4705, 0.2]}}, "transient.load.force_x"),
        ({"transient": FORCED | {"friction.mu": [0.4, 0.1]}}, "transient.load.force_x"),
        (
            {"transient": FORCED | {"load.force_y": [0.0, 0.17]}},
            "transient.load.force_x, transient.load.force_y",
        ),
        (
            {"load.force_y": 0.1, "transient": {"distance": [0, 1], "load.normal": [0.4, 0.2]}},
            "load.force_y",
        ),
        ({"transient.save": [3.0]}, "transient.save"),
        ({"transient.save": [1.0, 0.5]}, "transient.save"),
        ({"transient.start": "anywhere"}, "transient.start"),
        ({"transient.tolerance": 1.0}, "transient.tolerance"),
        ({"wear": {"intensity": 1e-6, "revolutions": 2}}, "wear.revolutions"),
        ({"wear": {"intensity": 1e-6, "turns": "equal"}}, "wear.turns"),
        ({"wear": {"law": "brr"}}, "wear.law"),
        ({"wear": {"law": "usfd", "by": "contact"}}, "wear.law"),
        ({"wear": {"law": "usfd"}, "transient.start": "shift"}, "wear.law"),
        (
            {"wear": {"intensity": 1e-6}, "transient.distance": [0.0, 1.0, 2500.0]},
            "transient.distance",
        ),
        ({"wear": {"intensity": 1e-6}, "transient": None}, "wear.revolutions"),
        ({"friction": None}, "transient"),
        ({"grid": None, "accuracy": {"tolerance": 1e-2}}, "accuracy"),
        ({"solver.method": "uzawa"}, "solver.method"),
        ({"friction.layer": 1e-4}, "friction.layer"),
    ],
)
def test_faults_name_the_key(changes, key):
    scene = SPHERES.replace(transient=GOOD)
    with pytest.raises(ts.SceneError) as error:
        scene.replace(**changes)
    assert key in [fault.key for fault in error.value.faults]


def test_what_only_counts_has_no_unit():
    fretting = ts.Scene.builtin("fretting")
    alike = {"transient.distance": [0, 1], "transient.load.force_x": [0, 9], "transient.step": 1}
    history = ts.roll(fretting.replace(**alike, **{"grid.elements": (15, 15)}))
    assert {history.columns[name].unit for name in ("distance", "next_step")} == {"1"}


def test_scenes_without_it_have_nothing_of_it():
    history = ts.roll(SPHERES.replace(**{"grid.elements": (15, 15), "subsurface": None}))
    assert "revolution" in history.columns
    assert not {"distance", "shift_x", "step_work", "elastic_energy"} & set(history.columns)
