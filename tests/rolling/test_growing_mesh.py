"""The mesh follows the contact."""

from itertools import pairwise

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.contact import Model, mesh
from tractive_sam.results.grid import Grid
from tractive_sam.rolling import steps
from tractive_sam.rolling.passage import first_passage
from tractive_sam.run.pipeline import roll
from tractive_sam.scene import Scene
from tractive_sam.schema import SceneError
from tractive_sam.store import ResultsError

WEARING = Scene.builtin("twin-discs").with_set(
    ["wear.revolutions=1500", "wear.save=[0, 1500]", "wear.tolerance=1e-2"]
)
NARROW = Grid((0.35, 0.54), (15, 15))
WIDE = Grid((0.35, 0.9), (15, 25))


def without_grid(scene):
    return scene.replace(grid=None, subsurface=None)


@pytest.fixture(scope="module")
def grown():
    model = Model(without_grid(WEARING), grid=NARROW)
    return list(steps(model, first_passage(model)))


def test_grows_sideways_only(grown):
    grids = [passage.contact.grid for passage in grown]
    assert grids[0] == NARROW
    assert grids[-1].elements[0] == 15
    assert grids[-1].elements[1] > 15
    for grid in grids:
        assert (grid.dx, grid.dy) == pytest.approx((NARROW.dx, NARROW.dy), rel=1e-12)
    assert all(passage.contact.converged for passage in grown)


def test_growing_changes_nothing(grown):
    """The wear equals the wear on a mesh that was wide enough from the start, to the tolerance."""
    wide = Model(without_grid(WEARING), grid=WIDE)
    there = list(steps(wide, first_passage(wide)))[-1].contact
    here = grown[-1].contact
    short = (WIDE.elements[1] - here.grid.elements[1]) // 2
    there_wear = there.wear[0] if short <= 0 else there.wear[0, short:-short]
    assert here.wear.max() == pytest.approx(there.wear.max(), rel=2e-3)
    assert np.abs(here.wear[0] - there_wear).max() < 1e-2 * there.wear.max()


def test_wear_stays_where_it_was(grown):
    """Nothing is interpolated: a widened profile only gains rows that are not worn yet."""
    for before, now in pairwise(grown):
        more = now.contact.grid.elements[1] - before.contact.grid.elements[1]
        if more:
            entering = now.entering
            assert not entering[: more // 2].any()
            assert not entering[-(more // 2) :].any()


def test_hot_discs_grow_too():
    scene = Scene.builtin("hot-discs").replace(
        grid=None, wear={"intensity": 2e-5, "revolutions": 3, "save": (3,)}
    )
    half = 1.16 * scene.hertz.a, 1.16 * scene.hertz.b
    last = list(steps(Model(scene, grid=Grid(half, (15, 15)))))[-1]
    assert last.contact.converged
    assert last.contact.grid.elements[1] > 15
    wanted = list(steps(Model(scene, grid=last.contact.grid)))[-1].contact
    # Three passes, each solved to 1e-8 of all tractions and to 1e-6 of the temperature.
    assert last.contact.wear.max() == pytest.approx(wanted.wear.max(), rel=1e-5)


@pytest.mark.slow
def test_elements_only_are_laid_over_the_domain_that_is_chosen(tmp_path):
    scene = without_grid(WEARING)
    worn = {"wear.revolutions": 6000, "wear.save": (6000,)}
    given = scene.replace(**{"grid.elements": (15, 23)}, **worn)
    at_first = mesh.choose_grid(given)
    assert at_first.elements == (15, 23)
    assert at_first.half_length == pytest.approx(mesh.choose_grid(scene).half_length, rel=0.1)
    history = roll(given, tmp_path / "a.h5")
    assert history.finished
    assert len(history.y) > 23  # it grows with the contact
    further = given.with_set(["wear.revolutions=6001", "wear.save=[6001]"])
    assert roll(further, tmp_path / "a.h5", resume=True).finished
    other = further.with_set(["grid.elements=[17,23]", "wear.revolutions=6002", "wear.save=[6002]"])
    with pytest.raises(ResultsError, match="elements"):
        roll(other, tmp_path / "a.h5", resume=True)


def test_a_domain_only_has_elements_as_a_scene_without_grid():
    scene = without_grid(WEARING)
    chosen = mesh.choose_grid(scene)
    given = scene.replace(**{"grid.half_length": [2.0 * one for one in chosen.half_length]})
    found = mesh.choose_grid(given)
    assert found.half_length == given.grid.half_length
    # Their number is odd: elements are smaller by that.
    side = found.dx, found.dy
    assert side == pytest.approx((chosen.dx, chosen.dy), rel=2.0 / min(chosen.elements))
    cylinders = Scene.builtin("cylinders").replace(grid=None)
    row = mesh.choose_grid(cylinders)
    wider = mesh.choose_grid(cylinders.replace(**{"grid.half_length": 2.0 * row.half_length[0]}))
    assert wider.elements[1] == 1
    assert wider.dx == pytest.approx(row.dx, rel=2.0 / row.elements[0])


@pytest.mark.slow
def test_a_domain_only_continues(tmp_path):
    short = {"wear.revolutions": 2, "wear.save": (2,), "grid.half_length": (0.35, 1.4)}
    scene = without_grid(WEARING).replace(**short, **{"solver.tolerance": 1e-6})
    before = roll(scene, tmp_path / "a.h5")
    assert before.grid.half_length == (0.35, 1.4)
    wider = {"wear.revolutions": 3, "wear.save": (3,), "grid.half_length": (0.4, 1.4)}
    after = roll(scene.replace(**wider), tmp_path / "a.h5", resume=True)
    assert after.finished
    assert after.grid.half_length[0] >= 0.4
    assert after.grid.dx == pytest.approx(before.grid.dx, rel=1e-12)  # equal elements


@pytest.mark.parametrize("grid", [None, {"elements": (15, 31)}])
def test_a_profile_of_flat_bodies_needs_a_domain(grid):
    y = np.linspace(-3.0, 3.0, 31)
    profile = {"gap": {"y": y, "separation": 0.02 * y**2}, "grid": grid, "wear": None}
    radii = {f"body.{body}.radius_{axis}": np.inf for body in "AB" for axis in "xy"}
    with pytest.raises(SceneError) as caught:
        ts.solve(without_grid(WEARING).replace(**profile, **radii))
    assert [fault.key for fault in caught.value.faults] == ["grid.half_length"]


def test_a_grid_of_nothing_is_refused():
    with pytest.raises(SceneError) as caught:
        without_grid(WEARING).replace(grid={})
    assert [fault.key for fault in caught.value.faults] == ["grid.half_length"]


@pytest.mark.slow
def test_history_is_on_the_last_mesh(tmp_path, monkeypatch):
    monkeypatch.setattr(mesh, "ACROSS", 12)
    scene = without_grid(WEARING)
    stored, kept = roll(scene, tmp_path / "a.h5"), roll(scene)
    assert stored.finished
    assert len(stored.y) > mesh.choose_grid(scene).elements[1]
    assert stored["wear_profile"].shape == (len(stored), len(stored.y))
    np.testing.assert_array_equal(stored["wear_profile"], kept["wear_profile"])
    np.testing.assert_array_equal(stored.field("pressure", 0), kept.field("pressure", 0))


def test_a_guess_on_another_mesh_is_refused(grown):
    with pytest.raises(ValueError, match=r"15.*25"):
        grown[0].contact.on(Grid((0.35, 0.7), (15, 25)))
