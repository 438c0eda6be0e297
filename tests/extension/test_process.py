"""A process of another package, in one file with public names, is rolled, stored and resumed."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import tractive_sam as ts
from tractive_sam.cli import app

SOURCE = Path(__file__).with_name("indexing_drive.py")
SPHERES = ts.Scene.builtin("spheres").replace(subsurface=None)
SCENE = SPHERES.replace(
    grid={"half_length": [4.1, 4.1], "elements": [15, 15]},
    creepage={"longitudinal": -2e-3},
    wear={"coefficient": 1e-2},
    process={"name": "indexing_drive:IndexingDrive", "end": 4, "passes": 3},
)


@pytest.fixture(autouse=True)
def package(tmp_path, monkeypatch):
    """Install the module of the process, and remove it from this interpreter afterwards."""
    folder = tmp_path / "installed"
    about = folder / "indexing_drive-1.0.dist-info"
    about.mkdir(parents=True)
    (folder / SOURCE.name).write_text(SOURCE.read_text())
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: indexing-drive\nVersion: 1.0\n")
    entry = "[tractive_sam.laws]\ndrive = indexing_drive:IndexingDrive\n"
    (about / "entry_points.txt").write_text(entry)
    monkeypatch.syspath_prepend(folder)
    yield folder
    sys.modules.pop("indexing_drive", None)


def test_strokes_wear_the_track_and_turn_the_force():
    history = ts.roll(SCENE)
    assert history.status == "done"
    assert history.coordinate.name == "stroke"
    np.testing.assert_array_equal(history["stroke"], range(5))
    assert (np.diff(history["track_depth"]) > 0.0).all()
    assert (np.sign(history["Qx"][1:]) == [1, -1, 1, -1]).all()
    # Bodies without friction of the stroke before: a stroke is the mirror image of one back, but
    # for what one stroke wears of the approach, 1e-2 of it.
    np.testing.assert_allclose(history["Qx"][1], -history["Qx"][2], rtol=1e-2)


def test_each_stroke_wears_what_its_work_of_friction_wears():
    """A column of the package that the process records enters the balances of the package."""
    history = ts.roll(SCENE)
    # Work of friction and wear use one slip: only the solver's residual differs.
    np.testing.assert_allclose(history.wear_balance[1:], 1.0, rtol=1e-6)
    # A stroke has three passes, and its wear is in the contact of the next one.
    around = 2.0 * np.pi * SCENE.body.A.radius_x  # equal for both bodies
    section = np.diff(history["worn_volume"].sum(axis=1)) / around
    np.testing.assert_allclose(section[1:], 3.0 * history["worn_area"][1:-1], rtol=1e-9)


def test_a_course_has_the_name_of_the_coordinate():
    (axes,) = ts.plot.forces(ts.roll(SCENE)).axes
    assert axes.get_xlabel() == "strokes"


def test_its_bodies_do_not_start_a_run_of_revolutions():
    worn = ts.roll(SCENE)
    revolving = SCENE.replace(process=None, **{"wear.revolutions": 2})
    with pytest.raises(ts.ResultsError, match="process"):
        ts.roll(revolving, start=worn)


def test_a_resumed_run_is_the_uninterrupted_one(tmp_path):
    whole, path = ts.roll(SCENE), tmp_path / "a.h5"
    ts.roll(SCENE.replace(**{"process.end": 2}), path)
    history = ts.roll(SCENE, path, resume=True)
    for name in ("stroke", "track_depth", "Qx", "p_max"):
        np.testing.assert_array_equal(history[name], whole[name])
    np.testing.assert_array_equal(history.field("pressure"), whole.field("pressure"))


@pytest.mark.slow
@pytest.mark.usefixtures("empty_pictures")
def test_every_command_accepts_the_process(tmp_path, monkeypatch):
    """The package is not imported before, and not in the folder of the scene."""
    monkeypatch.chdir(tmp_path)
    sys.modules.pop("indexing_drive", None)

    def call(command):
        done = CliRunner().invoke(app, command.split())
        assert done.exit_code == 0, done.output
        return done.stdout

    Path("drive.toml").write_text(SCENE.to_toml())
    assert "Rolls forth in odd strokes" in call("explain drive.toml")
    call("run drive.toml -o a.h5 --set process.end=2")
    call("run drive.toml -o a.h5 --resume")
    assert json.loads(call("show a.h5 --json"))["stroke"] == [0, 1, 2, 3, 4]
    assert "track_depth" in call("show a.h5")
    names = {Path(line).stem for line in call("plot a.h5 -o figures --dpi 40").split()}
    assert names >= {"pressure-0", "pressure-4", "forces", "worn-mass"}
    call("report a.h5 -o a.html")
    assert "track_depth" in Path("a.html").read_text()


@pytest.mark.slow
def test_a_file_is_read_where_the_package_is_not_installed(tmp_path):
    ts.roll(SCENE, tmp_path / "a.h5")
    sys.modules.pop("indexing_drive", None)
    code = "import sys, tractive_sam as ts; h = ts.open_history('a.h5'); print(h['stroke'].sum())"
    done = subprocess.run(
        [sys.executable, "-c", code + "; assert 'indexing_drive' not in sys.modules"],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(Path(ts.__file__).parents[1])},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout == "10\n", done.stderr


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"process.name": "indexing_drive:Stroke"}, "process.name"),
        ({"process.name": "not_installed:Drive"}, "process.name"),
        ({"process.strokes": 3}, "process.strokes"),
        ({"fatigue": {"shear_yield": 300.0}}, "fatigue"),
        ({"transient": {"distance": [0, 1]}}, "transient"),
        ({"wear.revolutions": 9}, "wear.revolutions"),
        ({"process.save": [0, 9]}, "process.save"),
    ],
)
def test_what_it_cannot_take_names_the_key(changes, key):
    with pytest.raises(ts.SceneError) as caught:
        ts.roll(SCENE.replace(**changes))
    assert key in {fault.key for fault in caught.value.faults}
