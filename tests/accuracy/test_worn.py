"""Rolling to an accuracy: meshes judged by coarser rolls, streamed, resumed."""

import numpy as np
import pytest

import tractive_sam as ts

pytestmark = pytest.mark.slow  # scenes are rolled on several meshes


@pytest.fixture(scope="module")
def scene():
    return ts.Scene.builtin("twin-discs").replace(
        **{
            "accuracy.tolerance": 2e-2,
            "friction.angle": 0.0,
            "subsurface": None,
            "wear.revolutions": 400,
            "wear.save": (0, 100, 400),
        }
    )


@pytest.fixture(scope="module")
def history(scene, tmp_path_factory):
    return ts.roll(scene, tmp_path_factory.mktemp("worn") / "discs.h5")


def test_depth_and_forces_are_within_the_tolerance(history):
    assert history.finished
    force = abs(history["Qx"])  # one direction: the integral of the traction itself
    assert (history["Qx_error"] <= 2e-2 * force).all()
    worn = history["revolution"] > 0
    assert (history["wear_max_error"][worn] <= 2e-2 * history["wear_max"][worn]).all()
    assert (history["P_error"] <= 1e-9 * history["P"]).all()  # it is given


def test_bars_hold_against_a_finer_mesh_and_smaller_jumps(scene, history):
    finer = scene.replace(**{"accuracy": None, "wear.tolerance": 2e-4})  # the usual, finer mesh
    other = ts.roll(finer)
    for name in ("Qx", "wear_max"):
        error = abs(history[name][-1] - other[name][-1])
        assert error <= history[f"{name}_error"][-1]


def test_a_file_that_ended_early_is_rolled_on_with_its_bars(scene, history, tmp_path):
    path = tmp_path / "discs.h5"
    ts.roll(scene.replace(**{"wear.revolutions": 100, "wear.save": (0, 100)}), path)
    resumed = ts.roll(scene, path, resume=True)
    assert resumed.finished
    assert np.isfinite(resumed["Qx_error"]).all()
    # Another course of jumps, and the mesh of the shorter roll.
    assert resumed["wear_max"][-1] == pytest.approx(
        history["wear_max"][-1],
        abs=history["wear_max_error"][-1] + resumed["wear_max_error"][-1],
    )


def test_a_mesh_too_coarse_for_the_wear_is_reported(scene, tmp_path):
    path = tmp_path / "discs.h5"
    coarse = scene.replace(**{"accuracy.tolerance": 1e-4, "accuracy.elements": 1000})
    history = ts.roll(coarse, path)
    assert history.status == "inaccurate"
    assert history["revolution"][-1] == 400
    assert "accuracy.elements" in history.message
    assert history["relative_error"][-1] > 1e-4
    again = ts.roll(coarse, path, resume=True)
    assert again.status == "inaccurate"
    assert "accuracy.elements" in again.message
    assert len(again) == len(history)


def test_what_was_missed_before_an_interruption_is_not_forgotten(scene, tmp_path):
    path = tmp_path / "discs.h5"
    coarse = scene.replace(**{"accuracy.tolerance": 1e-4, "accuracy.elements": 1000})

    def stop(record):
        if record.revolution >= 100:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ts.roll(coarse, path, progress=stop)
    history = ts.roll(coarse.replace(**{"wear.save": (100,)}), path, resume=True)
    assert history.status == "inaccurate"
    assert history["revolution"][-1] == 400
    assert "revolution 100" in history.message


def test_new_bodies_are_not_solved_again(tmp_path, monkeypatch):
    path = tmp_path / "spheres.h5"
    scene = ts.Scene.builtin("spheres").replace(
        **{"accuracy.tolerance": 1e-5, "accuracy.elements": 1000, "subsurface": None}
    )
    before = ts.roll(scene, path)
    monkeypatch.setattr("tractive_sam.run.refined_runs.refine_unworn", None)
    after = ts.roll(scene, path, resume=True)
    assert before.status == after.status == "inaccurate"
    assert after.to_dict() | {"message": ""} == before.to_dict() | {"message": ""}
