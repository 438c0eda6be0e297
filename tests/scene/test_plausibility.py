"""Entries that look as if they were meant in another unit are reported, and computed as given."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.results import caveats
from tractive_sam.scene.plausibility import RULES, Reading
from tractive_sam.schema import PlausibilityWarning

DISCS = ts.Scene.builtin("twin-discs").replace(subsurface=None, grid=None)


FALLING = [
    "friction={law='rational', static=0.4, kinetic=0.2, half_speed=50}",
    "creepage.speed=1e3",
]
SMALL = [f"body.{body}.radius_x=0.03" for body in "AB"]


@pytest.mark.parametrize(
    ("settings", "key"),
    [
        (["body.A.young=210"], r"body\.A"),
        (["body.B.young=208e9", "load.normal=1"], r"body\.B"),
        (["load.pressure=11e3"], "p0"),
        (["creepage.longitudinal=-0.5"], r"creepage\.longitudinal"),
        (["creepage.lateral=1.0"], r"creepage\.lateral"),
        (["friction.mu=30"], r"friction\.mu"),
        (["wear.intensity=1e-4"], "wear"),
        (["wear.coefficient=2"], "wear"),
        (["load.pressure=1"], r"load\.pressure: p0"),
        (["load.normal=1e-4"], r"load\.normal: p0"),
        (["load.normal=0.3"], r"load\.normal: under 0.3 N.*kN"),
        (["load.approach=1e-7"], r"load\.approach: p0"),
        (["body.A.density=7.85"], r"body\.A\.density"),
        (["wear.coefficient=1e-13"], r"wear\.coefficient: k"),
        (["wear.coefficient={A=1e-4, B=1e-14}"], r"wear\.coefficient\.B: k"),
        (["wear.intensity=1e-14"], r"wear\.intensity: k"),
        ([*SMALL, "load.pressure=300"], r"body\.A\.radius_x"),
        (["body.B.young=2.1e8"], r"body\.B: E"),
        (["creepage.speed=1.2"], r"creepage\.speed: 1.2 mm/s"),
        ([*FALLING, "friction.half_speed=0.1"], r"friction\.half_speed: 0.1 mm/s"),
        (["body.A.width=0.1"], r"describe a crown by \[gap\]"),
    ],
)
def test_what_looks_like_another_unit(settings, key):
    with pytest.warns(PlausibilityWarning, match=key):
        DISCS.with_set(settings)


def test_a_modulus_in_another_unit_is_reported_with_the_grid_it_does_not_fit():
    grid = ["grid.half_length=[0.5, 0.8]", "grid.elements=[31, 31]"]
    with pytest.raises(ts.SceneError) as caught:
        DISCS.with_set(["body.A.young=208", "body.B.young=208", *grid])
    assert all("GPa" in fault.allowed for fault in caught.value.faults)
    with pytest.raises(ts.SceneError) as caught:
        DISCS.with_set(["load.normal=1e7", *grid])
    assert all("p0" in fault.allowed for fault in caught.value.faults)


def test_what_a_course_stands_for_is_reported():
    scene = ts.Scene.builtin("traction-control")
    with pytest.warns(PlausibilityWarning, match=r"creepage\.longitudinal"):
        scene.with_set(["creepage.longitudinal=-0.01"])
    with warnings.catch_warnings():  # as the course begins
        warnings.simplefilter("error", PlausibilityWarning)
        scene.with_set(["creepage.longitudinal=0.0"])


def test_creepage_without_friction():
    with pytest.warns(PlausibilityWarning, match=r"creepage\.longitudinal.*\[friction\]"):
        DISCS.replace(friction=None, wear=None)


@pytest.mark.parametrize("name", ts.builtin_names())
def test_built_in_scenes_are_plausible(name):
    with warnings.catch_warnings():
        warnings.simplefilter("error", PlausibilityWarning)
        ts.Scene.builtin(name)


@pytest.mark.parametrize(
    "settings",
    [
        ["body.A.young=3.0", "body.A.poisson=0.49", "load.normal=0.01"],  # rubber
        ["body.A.young=70e3"],
        ["creepage.longitudinal=-0.1"],
        ["friction.mu=[1.5, 0.8]"],
        ["wear.coefficient=2e-3"],
        ["wear.coefficient=0"],
        ["body.B.young=1e15"],  # rigid
        ["body.A.density=120.0"],
        ["body.A.radius_x=0.5", "body.B.radius_x=0.5", "load.pressure=500"],
        ["load.pressure=20"],
    ],
)
def test_the_usual_needs_no_word(settings):
    with warnings.catch_warnings():
        warnings.simplefilter("error", PlausibilityWarning)
        DISCS.with_set(settings)


def test_every_rule_judges_by_its_bounds():
    """Its bounds are plausible, and what is just beyond them is not."""
    assert len({rule.name for rule in RULES}) == len(RULES)
    for rule in (replace(rule, note="") for rule in RULES):
        bounds = [one for one in (rule.above, rule.below) if np.isfinite(one)]
        assert bounds
        assert rule.reason
        assert not [*rule.judge(Reading("key", value) for value in bounds)]
        beyond = [np.nextafter(rule.above, np.inf), np.nextafter(rule.below, -np.inf)]
        implausible = [Reading("key", value) for value in beyond if abs(value) < 1e300]
        assert len([*rule.judge(implausible)]) == len(bounds)


def test_a_course_is_judged_by_its_largest_load():
    """It may begin and end without load."""
    scene = ts.Scene.builtin("traction-control")
    course = {"distance": (0.0, 1.0, 2.0), "load": {"normal": (1e-6, 300.0, 1e-6)}}
    quiet = {"creepage": {}, "transient": course, "wear": None}
    assert not notes_of(lambda: scene.replace(**quiet))
    light = course | {"load": {"normal": (1e-6, 1e-4, 1e-6)}}
    (note,) = notes_of(lambda: scene.replace(**quiet | {"transient": light}))
    assert note.startswith("transient.load.normal")


def notes_of(make):
    """Plausibility notes of a call."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("ignore")
        warnings.simplefilter("always", PlausibilityWarning)
        make()
    return [str(one.message) for one in caught]


def test_a_computed_pressure_that_no_material_withstands():
    """A gap with heights in another unit; the pressure by Hertz is plausible."""
    y = np.linspace(-0.9, 0.9, 121)
    gap = {"y": y, "separation": 1e-3 * np.cos(2 * np.pi * y / 0.1)}
    grid = {"half_length": (0.45, 0.8), "elements": (31, 161)}
    scene = DISCS.replace(gap=gap, grid=grid, wear=None)
    assert not notes_of(lambda: ts.solve(scene))
    rough = scene.replace(gap={"y": y, "separation": 0.05 * np.cos(2 * np.pi * y / 0.1)})
    (note,) = notes_of(lambda: ts.solve(rough))
    assert note.startswith("p_max")
    with pytest.warns(PlausibilityWarning, match="p_max") as caught:
        history = ts.roll(rough)
    assert len([one for one in caught if "p_max" in str(one.message)]) == 1
    assert "p_max" in caveats(history)
    # Once only: if the scene has a note about its load, the result needs none.
    heavy = DISCS.replace(wear=None, **{"load.pressure": 11e3})
    assert not notes_of(lambda: ts.solve(heavy))


X = np.linspace(-0.5, 0.5, 201)
Y = np.linspace(-0.9, 0.9, 201)
WAVE = 1e-3  # mm


def reported(x, y, *settings, **tables):
    """Warnings about a gap that is the sum of one along x and one along y."""
    gap = {"x": X, "y": Y, "separation": np.add.outer(x, y)}
    grid = {"half_length": (0.45, 0.8), "elements": (31, 41)}
    requested = DISCS.replace(gap=gap, grid=grid, wear=None, **tables).with_set(settings)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        ts.solve(requested, throw=False)
    return [str(one.message) for one in caught]


def test_a_gap_finer_than_the_mesh():
    fine = WAVE * np.cos(2 * np.pi * Y / 0.03)
    (text,) = reported(0 * X, fine)
    assert "gap" in text
    # 201 samples over 1.8 mm, and a mesh of 1.6 mm; along x nothing varies.
    assert "[31, 179]" in text
    assert not reported(0 * X, WAVE * np.cos(2 * np.pi * Y / 0.8))  # resolved by the mesh
    assert not reported(0 * X, Y**2 / 100)  # a form, sampled finely


def test_a_gap_that_stands_still_while_the_bodies_roll():
    waves = WAVE * np.cos(2 * np.pi * X / 0.3)
    (text,) = reported(waves, 0 * Y)
    assert "along x" in text
    assert not reported(waves, 0 * Y, friction=None, creepage=None)  # nothing rolls
    assert not reported(X**2 / 80, Y**2 / 100)  # the form of a body that turns


def test_a_warning_is_at_the_line_that_requested():
    with pytest.warns(PlausibilityWarning) as reported:
        DISCS.with_set(["friction.mu=30"])
    assert [one.filename for one in reported] == [__file__]
    gap = ts.Gap(x=[-9.0, 9.0], y=[-0.1, 0.0, 0.1], separation=[[0.0, 1e-3, 0.0]] * 2)
    single = DISCS.replace(gap=gap, wear=None, **{"grid.elements": (9, 9)})
    with pytest.warns(ts.SceneWarning, match="gap") as reported:
        ts.solve(single)
    assert {one.filename for one in reported} == {__file__}
