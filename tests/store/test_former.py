"""Results files of former formats open, are shown, and are rolled on.

They were written by the versions that had these formats: `spheres` with 11 x 11 elements, and the
twin discs with 15 x 25 for 12 revolutions, once to the end and once until the process was killed.
"""

import gzip
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

from tractive_sam.cli.program import app
from tractive_sam.results.state import FIELDS
from tractive_sam.run.pipeline import roll
from tractive_sam.scene import Scene
from tractive_sam.store import open_history
from tractive_sam.store.opening import FORMAT_VERSION

AS_WRITTEN = (
    "grid.half_length=[0.35, 0.9]",
    "grid.elements=[15, 25]",
    "wear.revolutions=12",
    "wear.save=[0, 3, 12]",
    "subsurface.elements=4",
)

DATA = Path(__file__).parents[1] / "data"


def former(name, folder):
    path = folder / f"{name}.h5"
    path.write_bytes(gzip.decompress((DATA / f"{name}-format-1.h5.gz").read_bytes()))
    return path


@pytest.mark.parametrize("name", ["spheres", "twin-discs", "twin-discs-killed"])
def test_opens_and_shows(tmp_path, name):
    path = former(name, tmp_path)
    history = open_history(path)
    assert len(history) == {"spheres": 1, "twin-discs": 7, "twin-discs-killed": 5}[name]
    assert history.versions["tractive-sam"] == "0.1.0"
    assert history.bodies == ("A", "B")
    assert np.isfinite(history["Qx"]).all()
    for revolution in history.field_revolutions:
        assert np.isfinite(history.field("pressure", revolution)).all()
        assert np.isfinite(history.stress("A", "y=0", revolution).von_mises).all()
    shown = CliRunner().invoke(app, ["show", str(path)])
    assert shown.exit_code == 0
    assert history.title in shown.stdout


def test_a_scene_means_what_it_meant(tmp_path):
    """Today, bodies of unequal radii would return unequally often."""
    path = former("twin-discs", tmp_path)
    assert open_history(path).scene.wear.turns == "equal"
    same = Scene.builtin("twin-discs").with_set(AS_WRITTEN)
    assert roll(same, path, resume=True).finished


OPENS = """
import sys
from tractive_sam.store import DamagedError, open_history
for path in sys.argv[1:]:
    try:
        open_history(path)
    except DamagedError:
        print("reported")
"""


def test_a_damaged_heap_of_texts_is_reported(tmp_path):
    """HDF5 itself may hang: a separate process reads the file."""
    path = former("spheres", tmp_path)
    content, files = path.read_bytes(), []
    at = content.find(b"GCOL")
    while at >= 0:
        files.append(tmp_path / f"{at}.h5")
        files[-1].write_bytes(content[: at + 16] + bytes(4080) + content[at + 4096 :])
        at = content.find(b"GCOL", at + 1)
    command = [sys.executable, "-c", OPENS, *files]
    requested = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    assert requested.stdout.split() == ["reported"] * len(files)
    assert files


@pytest.mark.slow
@pytest.mark.parametrize(("name", "kept"), [("twin-discs", 7), ("twin-discs-killed", 5)])
def test_is_rolled_on_in_the_new_format(tmp_path, name, kept):
    path = former(name, tmp_path)
    before = open_history(path)
    fields = {r: before.field("wear", r) for r in before.field_revolutions}
    stress = before.stress("B", "x=0", 3).von_mises
    further = ["wear.revolutions=14", "wear.save=[0, 3, 12, 14]"]
    scene = before.scene.with_set(further)
    history = roll(scene, path, resume=True)
    assert history.finished
    assert history["revolution"][-1] == 14
    assert history.field_revolutions.tolist() == [0, 3, 12, 14]
    assert history.provenance[0] == before.provenance[0]
    for column in before.of_dims():
        np.testing.assert_array_equal(history[column][:kept], before[column])
    for revolution, field in fields.items():
        np.testing.assert_array_equal(history.field("wear", revolution), field)
    np.testing.assert_array_equal(history.stress("B", "x=0", 3).von_mises, stress)
    with h5py.File(path) as file:
        assert file.attrs["format_version"] == FORMAT_VERSION
        assert all(file["fields"][name].fletcher32 for name in FIELDS)
    # Compared with a roll of today from unworn bodies: a former version wore most revolutions, and
    # its wear on so coarse a mesh differed by some tenths of a per cent.
    wanted = roll(scene)
    np.testing.assert_allclose(history["Qx"][-1], wanted["Qx"][-1], rtol=1e-4)
    np.testing.assert_allclose(history["wear_max"][-1], wanted["wear_max"][-1], rtol=1e-2)
