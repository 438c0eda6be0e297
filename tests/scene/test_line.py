"""Line contacts: both bodies with ``radius_y = inf`` and no [gap]."""

import math

import numpy as np
import pytest

from tractive_sam.mechanics.hertz_contact import HertzLine
from tractive_sam.scene import Scene
from tractive_sam.schema import SceneError, SceneWarning

GAP = {"x": [0, 1], "y": [0, 1], "separation": [[0, 1], [1, 2]]}


@pytest.fixture
def line(tables):
    """Tables of a small valid line contact, free to be spoilt."""
    for body in tables["body"].values():
        body["radius_y"] = math.inf
    return tables


def faults_of(tables):
    with pytest.raises(SceneError) as caught:
        Scene(**tables)
    return {fault.key: fault.allowed for fault in caught.value.faults}


def test_unworn_contact(line):
    scene = Scene(**line)
    hertz = scene.hertz
    assert scene.line
    assert isinstance(hertz, HertzLine)
    assert hertz.load_per_length == 0.5
    assert hertz.b == math.inf
    # E* = 2 R p0 / a, and the mean pressure is pi/4 p0.
    assert 2 * 168.75 * hertz.p0 / hertz.a == pytest.approx(scene.material.E_star)
    assert hertz.p0 * math.pi / 4 * 2 * hertz.a == pytest.approx(0.5)


def test_units_per_length(line, tables):
    """Forces, areas and volumes of a line contact are over a length, mm."""
    per_length = Scene(**line).contact_type
    units = {"N": "N/mm", "N mm": "N mm/mm", "mg": "mg/mm", "mm3": "mm2", "mm2": "mm"}
    assert {unit: per_length.unit(unit) for unit in units} == units
    tables["body"]["B"]["radius_y"] = 1e6
    whole = Scene(**tables)
    assert {whole.contact_type.unit(unit) for unit in units} == set(units)
    assert whole.force_unit == "N"


def test_line_contact_has_no_spin(line):
    assert "spin" not in Scene(**line).contact_type.creepages


def test_one_crowned_body_makes_no_line(line):
    line["body"]["B"]["radius_y"] = 1e6
    assert not Scene(**line).line


def test_a_gap_gives_the_contact_a_width(line):
    scene = Scene(**line, gap=GAP)
    assert not scene.line
    assert scene.hertz is None


def test_nothing_touches_without_curvature_in_x(line):
    line["body"]["A"]["radius_x"] = line["body"]["B"]["radius_x"] = math.inf
    (key,) = faults_of(line)
    assert key == "body.A.radius_x, body.B.radius_x"


@pytest.mark.parametrize("one", [lambda number: number, lambda number: [number]])
def test_grid_of_one_direction(line, one):
    scene = Scene(**line, grid={"half_length": one(12.0), "elements": one(65)})
    assert scene.grid.half_length == (12.0,)
    assert scene.grid.elements == (65,)
    assert Scene.from_toml_text(scene.to_toml()) == scene


def test_grid_of_the_wrong_number_of_directions(line, tables):
    pairs = {"half_length": [12.0, 12.0], "elements": [65, 65]}
    faults = faults_of(line | {"grid": pairs})
    assert list(faults) == ["grid.half_length", "grid.elements"]
    assert all("one number" in allowed for allowed in faults.values())
    tables["body"]["A"]["radius_y"] = 100.0
    faults = faults_of(tables | {"grid": {"half_length": 12.0, "elements": 65}})
    assert list(faults) == ["grid.half_length", "grid.elements"]
    assert all("a pair of" in allowed for allowed in faults.values())


def test_grid_too_small_or_too_coarse(line):
    a = Scene(**line).hertz.a
    (words,) = faults_of(line | {"grid": {"half_length": 0.9 * a, "elements": 65}}).values()
    assert f"at least {a:.4g}"[:12] in words
    with pytest.warns(SceneWarning, match=r"grid\.elements.*\b10\b"):
        Scene(**line, grid={"half_length": 1.2 * a, "elements": 5})


def test_what_plane_strain_excludes(line):
    line["load"] = {"approach": 0.01}
    line["creepage"] = {"spin": 0.1, "lateral": 0.001}
    line["subsurface"] = {"planes": ["y=0", "x=0.5b", "z=0.5a"]}
    faults = faults_of(line)
    assert list(faults) == ["load.approach", "creepage.spin", "subsurface.planes"]
    assert "load.normal, in N/mm" in faults["load.approach"]
    assert "finite radius_y" in faults["creepage.spin"]


def test_friction_is_counted_per_length(line):
    line["load"]["force_x"] = 0.3
    (allowed,) = faults_of(line).values()
    assert "0.2 N/mm" in allowed


def test_what_is_given_by_settings():
    scene = Scene.builtin("cylinders").with_set(["grid.half_length=0.5", "grid.elements=101"])
    assert scene.grid.elements == (101,)
    with pytest.raises(SceneError, match=r"creepage\.spin"):
        scene.with_set(["creepage.spin=0.1"])


def test_approach_of_hertz():
    """Displacement at the middle of Hertz's pressure, zero at the distance R from each load."""
    hertz = Scene.builtin("cylinders").hertz
    e_star = 2 * hertz.radius * hertz.p0 / hertz.a
    # x = a sin t takes the root out of the pressure; midpoints step over the logarithm.
    t = (np.arange(20000) + 0.5) * math.pi / 20000 - math.pi / 2
    integrand = hertz.p0 * np.cos(t) ** 2 * hertz.a * np.log(np.abs(np.sin(t)) * hertz.a / 25.0)
    truth = -2 / (math.pi * e_star) * integrand.mean() * math.pi
    # At the singularity the rule misses ln 2 times half a step, 1e-5 of the total.
    assert hertz.approach == pytest.approx(truth, rel=1e-4)
