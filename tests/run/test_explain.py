"""What a scene is said to take is what it is, and what it takes."""

from itertools import pairwise

import pytest

import tractive_sam as ts
from tractive_sam.contact import Model
from tractive_sam.description import format_duration
from tractive_sam.run import memory
from tractive_sam.run.explain import (
    expected_applications,
    expected_records,
    explain,
    seconds_per_application,
)

SMALL = "grid.elements=[15, 15]"


def reported(scene):
    """Answers by section and by what is requested."""
    return {section.title: dict(section.rows) for section in explain(scene)}


def spheres(*settings):
    return ts.Scene.builtin("spheres").with_set([SMALL, *settings])


@pytest.mark.parametrize("name", ts.builtin_names())
def test_every_scene_is_explained_in_words(name):
    scene = ts.Scene.builtin(name)
    sections = reported(scene)
    given = [t for t in ("transient", "fatigue") if getattr(scene, t) is not None]
    before, after = (given[:1], given[1:]) if "transient" in given else ([], given)
    parts = [*map(str.capitalize, before), "Heat", *map(str.capitalize, after)]
    blocks = ["Load spectrum"] if scene.duty else []
    wanted = ["Bodies", "State", "Wear", *blocks, "Stress", *parts, "Mesh", "Work"]
    assert list(sections) == wanted
    assert all(
        answer and isinstance(answer, str) for s in sections.values() for answer in s.values()
    )


def test_it_prints_itself():
    found = explain(spheres())
    text = repr(found)
    for section in found:
        assert section.title in text.splitlines()
        for what, answer in section.rows:
            assert what in text
            assert answer in text


def test_what_is_left_out_is_said_with_the_key_that_adds_it():
    scene = spheres().replace(subsurface=None)
    assert "[wear]" in reported(scene)["Wear"]["wear"]
    assert "[subsurface]" in reported(scene)["Stress"]["stress"]
    assert "[heat]" in reported(scene)["Heat"]["heat"]
    rolling = reported(scene.replace(creepage=None))["State"]["tangential problem"]
    frictionless = reported(scene.replace(friction=None, creepage=None))["State"]
    assert "creepage" in rolling
    assert "friction" in frictionless["tangential problem"]
    assert "friction" not in frictionless


def test_forces_to_transmit_and_creepages_are_distinguished():
    given = reported(spheres("creepage.longitudinal=-0.002"))["State"]["rolling"]
    found = reported(spheres("load.force_x=0.1"))["State"]["rolling"]
    assert "xi_x = -0.002" in given
    assert "Q_x = 0.1 N" in found


def test_friction_and_wear_laws():
    discs = reported(ts.Scene.builtin("twin-discs").with_set(["grid.elements=[15, 31]"]))
    assert "(0.6, 0.3) at 45 degrees" in discs["State"]["friction"]
    assert "(2e-06, 1e-06)" in discs["Wear"]["wear"]
    assert "Archard" in discs["Wear"]["law"]
    assert "15000" in discs["Wear"]["revolutions"]


def test_dissimilar_bodies_are_coupled():
    assert reported(spheres())["State"]["coupling"].startswith("none")
    scene = ts.Scene.builtin("spheres-dissimilar")
    assert not reported(scene)["State"]["coupling"].startswith("none")


def test_the_mesh_is_given_chosen_or_found():
    assert reported(spheres())["Mesh"]["mesh"].startswith("15 x 15 elements, given")
    assert "chosen" in reported(spheres().replace(grid=None))["Mesh"]["mesh"]
    sections = reported(spheres().replace(**{"grid": None, "accuracy.tolerance": 0.05}))
    assert "found" in sections["Mesh"]["mesh"]
    assert "+-" in sections["Accuracy"]["Qx of the unworn bodies"]


def test_memory_follows_the_elements():
    # Of large meshes, which all hold as many vectors, and those of an equally coarse mesh.
    room = [
        memory.contact_bytes(Model(spheres(f"grid.elements=[{n}, {n}]")))
        for n in (256, 512, 1024, 2048)
    ]
    added = [fine - coarse for coarse, fine in pairwise(room)]
    for coarse, fine in pairwise(added):
        assert fine / coarse == pytest.approx(4.0, rel=0.1)  # sizes of transforms are rounded up


def test_records_of_steppings():
    discs = ts.Scene.builtin("twin-discs").with_set(["wear.revolutions=1000"])
    each = discs.with_set(["wear.stepping=every-revolution"])
    sharper = discs.with_set(["wear.tolerance=1e-5"])
    assert expected_records(Model(spheres())) == 1
    assert expected_records(Model(each)) == 1 + 1000
    assert expected_records(Model(discs)) < expected_records(Model(sharper)) <= 1 + 1000


ROLLED = {
    "spheres": (SMALL,),
    "fretting": ("grid.elements=[15, 15]",),
    "traction-control": ("grid.elements=[15, 15]",),
    "twin-discs": ("grid.elements=[21, 61]", "wear.revolutions=1000", "wear.save=[0, 1000]"),
}
"""Scenes on meshes on which they take less than a second."""


@pytest.mark.parametrize("name", ROLLED)
def test_records_and_applications_are_of_the_order_of_those_of_a_roll(name):
    scene = ts.Scene.builtin(name).replace(subsurface=None).with_set(ROLLED[name])
    model, history = Model(scene), ts.roll(scene)
    # Between two built-in scenes of one kind the work per record differs by a factor of 1.5.
    assert 0.5 <= expected_records(model) / len(history) <= 2.0
    assert 0.5 <= expected_applications(model) / history["operator_applications"].sum() <= 2.0


def test_a_transform_is_timed():
    assert 0.0 < seconds_per_application(Model(spheres())) < 1.0  # of 32 x 32: microseconds


def test_durations_are_given_in_growing_units():
    assert [format_duration(s).split()[-1] for s in (30.0, 600.0, 9000.0)] == ["s", "min", "h"]
    assert format_duration(0.1) == format_duration(0.9) != format_duration(1.1)


def test_fatigue_is_reported_and_takes_time():
    requested = {"shear_yield": 300.0, "sensitivity": 0.3, "limit": 250.0}
    plain = spheres()
    tired = plain.replace(fatigue=requested)
    section = reported(tired)["Fatigue"]
    assert "300" in section["shakedown"]
    assert "Dang Van" in section["criterion"]
    assert (
        "limit"
        in reported(plain.replace(fatigue={"shear_yield": 300.0}))["Fatigue"][
            "utilisation and damage"
        ]
    )
    planes = tired.replace(**{"fatigue.criterion": "findley"})
    counts = [expected_applications(Model(scene)) for scene in (plain, tired, planes)]
    assert counts == sorted(counts)
    assert memory.scene_bytes(Model(tired)) > memory.scene_bytes(Model(plain))
