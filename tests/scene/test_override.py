from contextlib import suppress

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tractive_sam.scene import BlockLoad, Friction, Scene, Wear
from tractive_sam.schema import SceneError


def test_values_as_in_toml(spheres):
    scene = spheres.with_set(
        ["load.normal=0.6", "friction.mu = [0.4, 0.3]", "title=rolling on", "solver.method=newton"]
    )
    assert scene.load.normal == 0.6
    assert scene.friction.mu == (0.4, 0.3)
    assert scene.title == "rolling on"
    assert scene.solver.method == "newton"
    assert spheres.load.normal == 0.5


def test_absent_table_is_made(spheres):
    scene = spheres.with_set(["wear.intensity=1e-6", "wear.revolutions=10", "creepage.spin=0.1"])
    assert scene.wear == Wear(intensity=1e-6, revolutions=10)
    assert scene.creepage.spin == 0.1


ALTERNATIVES = [
    ("body.A.young", "body.A.shear"),
    ("body.B.shear", "body.B.young"),
    ("load.approach", "load.normal"),
    ("load.force_x", "creepage.longitudinal"),
    ("creepage.lateral", "load.force_y"),
]


def test_a_grid_is_replaced_by_an_accuracy_and_back(spheres):
    there = spheres.with_set(["grid.half_length=[4, 4]", "grid.elements=[21, 21]"])
    fine = there.with_set(["accuracy.tolerance=1e-3"])
    assert fine.grid is None
    back = fine.with_set(["grid.half_length=[4, 4]", "grid.elements=[21, 21]"])
    assert back.accuracy is None
    assert back == there


@pytest.mark.parametrize(("key", "rival"), [*ALTERNATIVES, *(pair[::-1] for pair in ALTERNATIVES)])
def test_alternative_is_removed(spheres, key, rival):
    def given(scene, name):
        *path, last = name.split(".")
        entries = scene.entries()
        for part in path:
            entries = entries.get(part, {})
        return last in entries

    there = spheres.with_set([f"{rival}=0.01"])
    back = there.with_set([f"{key}=0.02"])
    assert given(there, rival)
    assert not given(back, rival)
    assert given(back, key)


def test_alternatives_of_a_wheel_on_a_rail():
    scene = Scene.builtin("wheel-rail")
    other = scene.with_set(["rail.origin=[750.0, 0.0]", "wheelset.normal_load=7e4"])
    assert "gauge" not in other.entries()["rail"]
    assert "load" not in other.entries()["wheelset"]
    assert other.with_set(["rail.gauge=1435.0", "wheelset.load=80e3"]) == scene


def test_both_alternatives_set_at_once_are_a_fault(spheres):
    with pytest.raises(SceneError, match=r"load\.(normal|approach)"):
        spheres.with_set(["load.normal=1", "load.approach=1"])


def test_removing_an_entry_keeps_its_alternative(spheres):
    assert spheres.replace(**{"load.approach": None}) == spheres


def test_whole_tables(spheres):
    worn = spheres.replace(wear=Wear(intensity=1e-6, revolutions=3), friction=Friction(mu=0.1))
    assert worn.wear.revolutions == 3
    assert worn.friction.mu == (0.1, 0.1)
    assert worn.replace(wear=None, friction={"mu": [0.4, 0.2]}) == spheres
    assert worn.replace(
        wear={"intensity": 1, "revolutions": 1}, **{"wear.revolutions": 2}
    ).wear.save == (0, 2)


WORN = ["wear.intensity=1e-6", "wear.revolutions=1000", "wear.save=[0, 50, 100, 1000]"]


@pytest.mark.parametrize(
    ("last", "save"),
    [(70, (0, 50, 70)), (50, (0, 50)), (2000, (0, 50, 100, 1000)), (1000, (0, 50, 100, 1000))],
)
def test_fewer_revolutions_shorten_the_saves(spheres, last, save):
    scene = spheres.with_set(WORN).with_set([f"wear.revolutions={last}"])
    assert scene.wear.save == save


def test_default_saves_follow_the_revolutions(spheres):
    scene = spheres.with_set(WORN[:2]).with_set(["wear.revolutions=2000"])
    assert scene.wear.save == (0, 2000)


def test_explicit_saves_are_not_shortened(spheres):
    with pytest.raises(SceneError) as caught:
        spheres.with_set(WORN).with_set(["wear.revolutions=70", "wear.save=[0, 100]"])
    assert [fault.key for fault in caught.value.faults] == ["wear.save"]


@pytest.mark.parametrize("wrong", ["-5", "0", "fast", "true", "1.5"])
def test_wrong_revolutions_are_one_fault(spheres, wrong):
    with pytest.raises(SceneError) as caught:
        spheres.with_set(WORN).with_set([f"wear.revolutions={wrong}"])
    assert [fault.key for fault in caught.value.faults] == ["wear.revolutions"]


@pytest.mark.parametrize(
    ("setting", "key"),
    [
        ("load.norml=1", "load.norml"),
        ("laod.normal=1", "laod"),
        ("load=1", "load"),
        ("title.sub=1", "title"),
        ("load.normal.x=1", "load.normal.x"),
        ("load.normal", "'load.normal'"),
        ("=1", "'=1'"),
    ],
)
def test_faulty_setting(spheres, setting, key):
    with pytest.raises(SceneError) as caught:
        spheres.with_set([setting])
    assert caught.value.faults[0].key == key


BLOCKS = ({"revolutions": 1, "load": {"normal": 0.4}}, {"revolutions": 2})


@pytest.fixture
def spectrum(spheres):
    return spheres.with_set(WORN).replace(duty=BLOCKS)


def test_an_entry_of_a_block_by_its_place(spectrum):
    changed = spectrum.with_set(["duty[0].load.normal=0.6", "duty[1].friction.mu=0.2"])
    assert [block.changes for block in changed.duty] == [
        {"load.normal": 0.6},
        {"friction.mu": (0.2, 0.2)},
    ]
    assert [block.revolutions for block in changed.duty] == [1, 2]
    assert spectrum.duty[0].load.normal == 0.4  # the old one is left as it is


def test_an_alternative_in_a_block_removes_its_rival_there(spectrum):
    changed = spectrum.replace(**{"duty[0].load.pressure": 900.0})
    assert changed.duty[0].changes == {"load.pressure": 900.0}
    assert changed.load.normal == spectrum.load.normal


@pytest.mark.parametrize(
    "key",
    [
        *("duty[2].load.normal", "duty.load.normal", "load[0].normal", "title[0]", "0"),
        *("duty[0][0]", "duty.0.load.normal"),
    ],
)
def test_a_place_that_is_not_there(spectrum, key):
    with pytest.raises(SceneError) as caught:
        spectrum.replace(**{key: 1.0})
    assert [fault.key for fault in caught.value.faults] == [key]


def test_an_entry_of_a_block_is_described():
    assert Scene.find_field("duty[3].load.normal") is BlockLoad.model_fields["normal"]


@pytest.mark.parametrize("key", ["duty.load", "0", "load[0].normal", "duty[0].laod", "title[0].x"])
def test_what_no_scene_has_is_not_described(key):
    with pytest.raises(SceneError) as caught:
        Scene.find_field(key)
    assert [fault.key for fault in caught.value.faults] == [key]


def test_all_faulty_settings_at_once(spheres):
    with pytest.raises(SceneError) as caught:
        spheres.with_set(["nonsense", "more", "load.normal=1"])
    assert len(caught.value.faults) == 2


KEYS = st.sampled_from(
    [
        "load",
        "load.normal",
        "creepage",
        "load.force_x",
        "wear",
        "wear.revolutions",
        "wear.save",
        "gap.x",
        "",
    ]
)
VALUES = st.sampled_from(["1", "[1, 2]", "{a = 1}", "x", "", "{revolutions = 1, save = [5]}", "-3"])


@pytest.mark.slow
@settings(max_examples=50)
@given(st.lists(st.tuples(KEYS, VALUES).map("=".join) | st.text(max_size=8), max_size=4))
def test_any_settings_give_a_scene_or_faults(listed):
    with suppress(SceneError):
        Scene.builtin("spheres").with_set(listed)
