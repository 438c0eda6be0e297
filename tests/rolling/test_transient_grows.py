"""The mesh of a transient becomes wider, and the way continues as if it had always been so wide."""

import numpy as np
import pytest

import tractive_sam as ts
from tests.scenes import interrupted
from tractive_sam.contact import Model
from tractive_sam.results import Grid
from tractive_sam.rolling import steps
from tractive_sam.store import ResultsError

SPHERES = ts.Scene.builtin("spheres").replace(subsurface=None, creepage=None)
DISSIMILAR = ts.Scene.builtin("spheres-dissimilar").replace(subsurface=None, creepage=None)
N = 15


def rising(scene, **changes):
    """A load that takes the contact beyond a mesh that is wide enough at first."""
    # In full elements: depth that leaves the mesh in parts of one is less exact at its end.
    load, length = scene.normal_load, 9 * narrow(scene).dx
    course = {
        "distance": [0.0, length, 2.0 * length],
        "load.normal": [0.3 * load, 0.3 * load, load],
        "creepage.longitudinal": [-0.002] * 3,
    }
    return scene.replace(transient=course, grid=None, **changes)


def narrow(scene):
    half = 0.8 * scene.hertz.a
    return Grid((half, half), (N, N))


PRESSED = {
    "distance": [0.0, 2.0],
    "load.normal": [0.3 * SPHERES.normal_load, SPHERES.normal_load],
    "load.force_x": [0.0, 0.1 * SPHERES.normal_load],
    "start": "shift",
}
COURSES = {
    "alike": rising(SPHERES),
    "dissimilar": rising(DISSIMILAR),
    "worn": rising(SPHERES, wear={"intensity": 1e-3}),
    "fretting": SPHERES.replace(transient=PRESSED, grid=None, wear={"intensity": 1e-3}),
}


@pytest.mark.slow
@pytest.mark.parametrize("scene", COURSES.values(), ids=COURSES)
def test_it_is_as_on_the_wide_mesh_from_the_beginning(scene):
    found = list(steps(Model(scene, grid=narrow(scene))))
    wide = found[-1].contact.grid
    assert found[0].contact.grid.elements == (N, N) < wide.elements
    wanted = list(steps(Model(scene, grid=wide)))
    assert len(found) == len(wanted)
    p0, deepest = scene.hertz.p0, max(wanted[-1].deepest, 1e-12)
    for now, then in zip(found, wanted, strict=True):
        contact = now.contact.on(wide)
        # Each is solved to 1e-8 of all tractions; two meshes agree to some 1e-7.
        np.testing.assert_allclose(contact.pressure, then.contact.pressure, atol=1e-6 * p0)
        np.testing.assert_allclose(contact.traction, then.contact.traction, atol=1e-6 * p0)
        assert now.friction == pytest.approx(then.friction, rel=1e-6, abs=1e-12)
        # The depth behind the first mesh was not stored.
        worn, wanted_there = (one.result.on(wide).worn for one in (now, then))
        first = slice((wide.elements[0] - N) // 2, (wide.elements[0] + N) // 2)
        np.testing.assert_allclose(worn[:, first], wanted_there[:, first], atol=1e-6 * deepest)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["alike", "worn"])
def test_a_file_becomes_wider_and_is_continued(tmp_path, monkeypatch, name):
    scene = COURSES[name]
    monkeypatch.setattr("tractive_sam.contact.model.choose_grid", lambda *_, **__: narrow(scene))
    whole = ts.roll(scene)
    assert whole.status == "done"
    interrupted(scene, tmp_path / "a.h5", len(whole) - 3)
    history = ts.roll(scene, tmp_path / "a.h5", resume=True)
    assert history.status == "done"
    assert history.grid == whole.grid != narrow(scene)
    for column in ("Qx", "approach", "elastic_energy", "friction_work"):
        size = np.abs(whole[column]).max()
        np.testing.assert_allclose(history[column], whole[column], atol=1e-6 * size)  # as above


@pytest.mark.slow
def test_off_its_grid_it_continues_upon_a_wider_one(tmp_path):
    path, scene = tmp_path / "a.h5", COURSES["worn"]
    half = (1.01 * scene.hertz.a,) * 2
    given = scene.replace(grid={"half_length": half, "elements": (N, N)})
    stopped = ts.roll(given, path)
    assert stopped.status == "off grid"
    wide = {"half_length": tuple(25 / N * one for one in half), "elements": (25, 25)}
    history = ts.roll(given.replace(grid=wide), path, resume=True)
    wanted = ts.roll(given.replace(grid=wide))
    assert history.status == "done"
    assert history.grid == wanted.grid
    np.testing.assert_array_equal(history["distance"], wanted["distance"])
    for column in ("Qx", "worn_volume", "wear_max"):
        size = np.abs(wanted[column]).max()
        np.testing.assert_allclose(history[column], wanted[column], atol=1e-6 * size)  # as above


@pytest.mark.parametrize("grid", [{"elements": (19, 19)}, {"half_length": (3.9, 3.9)}])
def test_another_mesh_is_refused(tmp_path, grid):
    path, scene = tmp_path / "a.h5", COURSES["alike"]
    given = scene.replace(grid={"half_length": (4.0, 4.0), "elements": (N, N)})
    interrupted(given, path, 3)
    changed = given.replace(**{f"grid.{key}": value for key, value in grid.items()})
    with pytest.raises(ResultsError, match="elements"):
        ts.roll(changed, path, resume=True)
