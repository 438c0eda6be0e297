"""A roll that was interrupted continues as if it had not been."""

import os
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

from tests.scenes import interrupted
from tractive_sam.cli.program import app
from tractive_sam.run.pipeline import roll
from tractive_sam.scene import Scene
from tractive_sam.store import ResultsError, open_history
from tractive_sam.store.layout import set_scene

COARSE = (
    "grid.half_length=[0.35, 0.9]",
    "grid.elements=[15, 25]",
    "wear.revolutions=600",
    "wear.save=[0, 50, 600]",
    "subsurface.elements=4",
    'subsurface.planes=["y=0", "x=0", "z=0.5a"]',
)


def coarse(*settings):
    return Scene.builtin("twin-discs").with_set([*COARSE, *settings])


def assert_same(history, wanted, exact=True):
    """Check that records, fields and stress are equal; exactly within one process."""
    # Plans of transforms may differ between processes, and with them the last digits, which grow
    # to what the tolerance of the solver leaves open.
    close = {"rtol": 0.0} if exact else {"rtol": 1e-6, "atol": 1e-9}
    for name in set(history.of_dims()) - {
        "seconds",
        "residual",
        "operator_applications",
        "convolutions",
        "over_application",
    }:
        np.testing.assert_allclose(history[name], wanted[name], **close, err_msg=name)
    np.testing.assert_allclose(history["wear_profile_A"], wanted["wear_profile_A"], **close)
    np.testing.assert_allclose(history["von_mises_max"], wanted["von_mises_max"], **close)
    np.testing.assert_array_equal(history.field_revolutions, wanted.field_revolutions)
    np.testing.assert_allclose(history.field("pressure"), wanted.field("pressure"), **close)
    assert history.planes == wanted.planes
    for body, plane in history.planes:
        now, then = history.stress(body, plane), wanted.stress(body, plane)
        np.testing.assert_allclose(now.von_mises, then.von_mises, **close)


@pytest.fixture(scope="module")
def whole():
    return roll(coarse())


@pytest.mark.slow
@pytest.mark.parametrize("after", [1, 2, 5])
def test_continues_as_if_nothing_had_happened(tmp_path, whole, after):
    interrupted(coarse(), tmp_path / "a.h5", after)
    assert len(open_history(tmp_path / "a.h5")) == after
    assert_same(roll(coarse(), tmp_path / "a.h5", resume=True), whole)


def test_one_revolution_after_another(tmp_path):
    scene = coarse("wear.revolutions=6", "wear.save=[6]", 'wear.stepping="every-revolution"')
    interrupted(scene, tmp_path / "a.h5", 4)
    assert_same(roll(scene, tmp_path / "a.h5", resume=True), roll(scene))


@pytest.mark.slow
def test_finished_roll_is_rolled_further(tmp_path):
    path, short = tmp_path / "a.h5", coarse("wear.revolutions=50", "wear.save=[0, 50]")
    before = roll(short, path)
    again = roll(short, path, resume=True)
    assert again.to_dict() == before.to_dict()
    further = coarse("wear.revolutions=52", "wear.save=[51]", 'wear.stepping="every-revolution"')
    history = roll(further, path, resume=True)
    assert history.finished
    assert history["revolution"][-3:].tolist() == [50, 51, 52]
    assert history.field_revolutions.tolist() == [0, 50, 51]
    assert history.scene == further
    with pytest.raises(ResultsError, match="52"):
        roll(short, path, resume=True)


def test_nothing_to_resume_is_a_new_roll(tmp_path):
    short = coarse("wear.revolutions=1", "wear.save=[1]")
    assert len(roll(short, tmp_path / "a.h5", resume=True)) == 2


def test_another_scene_is_refused(worn_once):
    path, short = worn_once
    before = open_history(path)
    with pytest.raises(ResultsError, match=r"load\.normal.*300\.0.*200\.0"):
        roll(short.with_set(["load.normal=200.0"]), path, resume=True)
    with pytest.raises(ResultsError, match=r"grid|elements"):
        roll(short.with_set(["grid.elements=[15, 27]"]), path, resume=True)
    assert open_history(path).to_dict() == before.to_dict()


@pytest.mark.slow
def test_a_roll_off_its_grid_continues_upon_the_one_that_is_reported(tmp_path):
    scene = coarse("wear.intensity=2e-6", "wear.revolutions=20000", "wear.save=[20000]")
    path = tmp_path / "a.h5"
    before = roll(scene, path)
    assert before.status == "off grid"
    reported = re.findall(r"grid\.\w+=\[[^]]*\]", before.message)
    with pytest.raises(ResultsError) as refused:
        roll(scene.with_set(["grid.elements=[99, 99]"]), path, resume=True)
    assert len(re.findall(r"grid\.\w+=\[[^]]*\]", str(refused.value))) == 2
    after = roll(scene.with_set(reported), path, resume=True)
    assert len(after) > len(before)


@pytest.mark.slow
def test_what_holds_anyway_may_be_reported(tmp_path):
    path, short = tmp_path / "a.h5", coarse("wear.revolutions=1", "wear.save=[1]")
    entries = short.entries()
    del entries["friction"]["angle"]
    straight = Scene(**entries)
    roll(straight, path)
    reported = straight.replace(**{"friction.angle": 0.0, "creepage.lateral": 0.0})
    assert roll(reported, path, resume=True).finished


@pytest.fixture(scope="module")
def worn_once(tmp_path_factory):
    """Return the path of a results file of one revolution, which tests copy, and its scene."""
    path = tmp_path_factory.mktemp("worn") / "a.h5"
    short = coarse("wear.revolutions=1", "wear.save=[1]")
    roll(short, path)
    return path, short


@pytest.mark.parametrize(("name", "value"), [("jump", 0.5), ("jump", np.nan), ("approach", np.inf)])
def test_a_record_that_cannot_be_is_reported(worn_once, tmp_path, name, value):
    stored, short = worn_once
    path = Path(shutil.copy(stored, tmp_path))
    with h5py.File(path, "r+") as file:
        file["history"][name][-1] = value
    with pytest.raises(ResultsError, match=f"damaged.*{name}"):
        roll(short.with_set(["wear.revolutions=2"]), path, resume=True)


def test_a_mesh_of_another_version_is_reported(tmp_path):
    path = tmp_path / "a.h5"
    scene = coarse("wear.revolutions=1", "wear.save=[1]")
    roll(scene, path)
    requested = scene.replace(grid=None, accuracy={"tolerance": 0.1})
    with h5py.File(path, "r+") as file:
        set_scene(file, requested)
    with pytest.raises(ResultsError, match="mesh"):
        roll(requested, path, resume=True)


@pytest.mark.slow
def test_versions_that_rolled_are_reported_with_where_they_began(tmp_path, monkeypatch):
    path, short = tmp_path / "a.h5", coarse("wear.revolutions=1", "wear.save=[1]")
    before = roll(short, path)
    assert before.provenance == ((0, before.versions),)
    longer = short.with_set(["wear.revolutions=2"])
    other = dict(before.versions) | {"numpy": "99.0"}
    monkeypatch.setattr("tractive_sam.store.layout.versions", lambda: other)
    history = roll(longer, path, resume=True)
    assert history.provenance == ((0, before.versions), (2, other))
    again = roll(longer.with_set(["wear.revolutions=3"]), path, resume=True)
    assert again.provenance == history.provenance
    shown = CliRunner().invoke(app, ["show", str(path)])
    assert "from revolution 2" in shown.stdout
    assert "numpy 99.0" in shown.stdout


@pytest.mark.slow
def test_mesh_that_became_too_small_is_widened(tmp_path):
    """The run stops and names the cure; with it, the run continues from the last record."""
    path = tmp_path / "a.h5"
    narrow = coarse("grid.half_length=[0.35, 0.54]", "grid.elements=[15, 15]")
    history = roll(narrow, path)
    assert history.status == "off grid"
    assert "grid.half_length" in history.message
    before = len(history)
    assert history["converged"].tolist() == [1.0] * (before - 1) + [0.0]
    history = roll(coarse(), path, resume=True)
    assert history.finished
    assert (history["converged"] == 1.0).all()
    assert history["wear_profile"].shape == (len(history), 25)
    np.testing.assert_allclose(history["wear_max"][-1], roll(coarse())["wear_max"][-1], rtol=5e-3)


@pytest.mark.slow
def test_nothing_of_the_revolution_that_failed_is_kept(tmp_path):
    """Widened and continued, a roll equals a roll on the wide mesh from the beginning."""
    path, settings = tmp_path / "a.h5", ("wear.revolutions=40", 'wear.stepping="every-revolution"')
    fast = ("wear.intensity=2e-5", "wear.save=[40]", *settings)
    narrow = coarse("grid.half_length=[0.35, 0.54]", "grid.elements=[15, 15]", *fast)
    assert roll(narrow, path).status == "off grid"
    history, wanted = roll(coarse(*fast), path, resume=True), roll(coarse(*fast))
    assert history["revolution"].tolist() == wanted["revolution"].tolist()
    # The wear of a revolution counted twice would be some percent.
    np.testing.assert_allclose(history["wear_max"], wanted["wear_max"], rtol=1e-6)


@pytest.mark.slow
def test_a_gap_given_as_arrays_is_resumed(tmp_path):
    x = np.linspace(-2.0, 2.0, 5)
    scene = coarse("wear.revolutions=60", "wear.save=[60]").replace(
        gap={"x": x, "y": x, "separation": 1e-6 * (x[:, None] + x) ** 2}
    )
    interrupted(scene, tmp_path / "a.h5", 3)
    assert_same(roll(scene, tmp_path / "a.h5", resume=True), roll(scene))
    other = scene.replace(gap={"x": x, "y": x, "separation": np.zeros((5, 5))})
    with pytest.raises(ResultsError, match=r"gap\.separation"):
        roll(other, tmp_path / "a.h5", resume=True)


def test_another_mesh_over_a_measured_gap_is_refused(tmp_path):
    x = np.linspace(-0.5, 0.5, 21)
    flat = {"young": 2e5, "poisson": 0.3, "radius_x": np.inf, "radius_y": np.inf}
    scene = coarse("wear.revolutions=1", "wear.save=[1]", 'wear.turns="equal"').replace(
        body={"A": flat, "B": flat},
        gap={"x": x, "y": x, "separation": 0.04 * (x[:, None] ** 2 + x**2)},
        grid={"elements": (21, 21)},
        subsurface=None,
    )
    path = tmp_path / "a.h5"
    roll(scene, path)
    with pytest.raises(ResultsError, match="21 x 21"):
        roll(scene.with_set(["grid.elements=[25, 25]"]), path, resume=True)
    assert roll(scene.with_set(["wear.revolutions=2"]), path, resume=True).finished


def test_what_cannot_be_written_is_reported_before_anything_is_solved(tmp_path, monkeypatch):
    monkeypatch.setattr("tractive_sam.rolling.revolutions.solve_on_fitted_mesh", None)
    with pytest.raises(ResultsError, match="none"):
        roll(coarse(), tmp_path / "none" / "a.h5")
    (tmp_path / "a.h5").write_text("something else")
    with pytest.raises(ResultsError, match=r"a\.h5"):
        roll(coarse(), tmp_path / "a.h5", overwrite=True)


KILLED_BY_ITSELF = """
import os, signal, sys
import tractive_sam as ts

left = int(sys.argv[1])

def progress(record):
    global left
    left -= 1
    if not left:
        os.kill(os.getpid(), signal.SIGKILL)

ts.roll(ts.Scene.from_toml("scene.toml"), "a.h5", resume=True, progress=progress)
"""


@pytest.mark.slow
def test_killed_runs_continue(tmp_path, whole):
    """A real run that ends without a word: its file opens, holds a true history, and continues."""
    (tmp_path / "scene.toml").write_text(coarse().to_toml())
    found = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    path, command = tmp_path / "a.h5", [sys.executable, "-c", KILLED_BY_ITSELF, "3"]
    run = subprocess.run(command, cwd=tmp_path, env=found, check=False)
    assert run.returncode == -signal.SIGKILL
    history = open_history(path)
    held = len(history)
    assert held >= 1
    np.testing.assert_array_equal(history["revolution"], whole["revolution"][:held])
    np.testing.assert_allclose(history["Qx"], whole["Qx"][:held], rtol=1e-6)
    assert_same(roll(coarse(), path, resume=True), whole, exact=False)


def test_resuming_takes_a_file():
    with pytest.raises(ValueError, match=r"resume.*path"):
        roll(coarse(), resume=True)
