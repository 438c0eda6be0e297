"""An observer of another package, in one file with public names, follows any process."""

import json
import sys
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import tractive_sam as ts
from tractive_sam.cli import app

SOURCE = Path(__file__).with_name("friction_energy.py")
NAME = "friction_energy:FrictionEnergy"
SPHERES = ts.Scene.builtin("spheres").replace(
    subsurface=None,
    grid={"half_length": [4.1, 4.1], "elements": [15, 15]},
    creepage={"longitudinal": -2e-3},
    observer=[{"name": NAME, "length": 100.0}],
)
BLOCKS = [{"revolutions": 1}, {"revolutions": 2, "load": {"normal": 0.5 * SPHERES.load.normal}}]
WORN = SPHERES.replace(wear={"coefficient": 1e-2, "revolutions": 6, "save": [0, 3, 6]})
SCENES = {
    "worn": WORN,
    "duty": WORN.replace(duty=BLOCKS),
    "transient": SPHERES.replace(
        observer=[{"name": NAME}], transient={"distance": [0.0, 1.5, 3.0], "start": "steady"}
    ),
    "shift": SPHERES.replace(
        creepage=None,
        observer=[{"name": NAME}],
        transient={
            "start": "shift",
            "distance": [0.0, 1.0, 2.0],
            "step": 0.5,
            "creepage.longitudinal": [0.0, 0.01, 0.0],
        },
    ),
}
SHORTER = {
    "worn": {"wear.revolutions": 3, "wear.save": [0, 3]},
    "duty": {"wear.revolutions": 3, "wear.save": [0, 3]},
}


@pytest.fixture(autouse=True)
def package(tmp_path, monkeypatch):
    """Install the module of the observer, and remove it from this interpreter afterwards."""
    folder = tmp_path / "installed"
    about = folder / "friction_energy-1.0.dist-info"
    about.mkdir(parents=True)
    (folder / SOURCE.name).write_text(SOURCE.read_text())
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: friction-energy\nVersion: 1.0\n")
    entry = "[tractive_sam.figures]\nenergy = friction_energy\n[tractive_sam.laws]\n"
    entry += f"energy = {NAME}\n"
    (about / "entry_points.txt").write_text(entry)
    monkeypatch.syspath_prepend(folder)
    yield folder
    sys.modules.pop("friction_energy", None)


@pytest.fixture
def kind(package):
    """The class of the observer."""
    return import_module("friction_energy").FrictionEnergy


def command(*words):
    """Run a command of the program in this process and return what it prints."""
    done = CliRunner().invoke(app, [str(word) for word in words])
    assert done.exit_code == 0, done.output
    return done.stdout


@pytest.mark.parametrize("name", ["worn", "duty", "transient"])
def test_its_energy_is_the_work_of_friction(name):
    """By the trapezoidal rule, as the observer takes it; only the summation differs."""
    history = ts.roll(SCENES[name])
    place = history[history.coordinate.name]
    length = SCENES[name].observer[0].name.parameters.get("length", 1.0)
    total = history["energy_profile"].sum(axis=1) * history.grid.dy
    power = history["dissipation"]
    if name == "transient":  # the package takes another mean over a step
        np.testing.assert_allclose(total[-1], np.nansum(history["step_friction"]), rtol=0.02)
        return
    steps = 0.5 * (power[1:] + power[:-1]) * np.diff(place) * length
    np.testing.assert_allclose(np.diff(total), steps, rtol=1e-9)


@pytest.mark.parametrize(
    "name",
    [
        "worn",
        "transient",
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("duty", "shift")),
    ],
)
def test_a_resumed_run_is_the_uninterrupted_one(name, tmp_path):
    scene, path = SCENES[name], tmp_path / "a.h5"
    whole = ts.roll(scene)

    def stop(record):
        if record.at >= 0.5 * scene.schedule.end:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ts.roll(scene, path, progress=stop)
    history = ts.roll(scene, path, resume=True)
    # Arrays from a file lie otherwise in memory, so that sums and transforms round otherwise. A
    # transient continues from another guess, as the last extrapolation is not stored: it agrees
    # within the tolerance of the contacts.
    rounding = 1e-8 if scene.transient else 1e-13
    for column in ("energy_max", "energy_profile", "Qx"):
        atol = rounding * np.abs(whole[column]).max()
        np.testing.assert_allclose(history[column], whole[column], rtol=rounding, atol=atol)
    energy = whole.field("energy")
    np.testing.assert_allclose(
        history.field("energy"), energy, rtol=0, atol=rounding * energy.max()
    )
    assert history.user_fields["energy"].unit == "mJ/mm2"
    with pytest.warns(DeprecationWarning, match="user_fields"):
        assert history.own_fields is history.user_fields
    assert whole["energy_max"][-1] > 0.0


def test_it_is_given_to_roll_as_well(kind):
    bare = WORN.replace(observer=None)
    history, named = ts.roll(bare, observers=[kind(length=100.0)]), ts.roll(WORN)
    np.testing.assert_array_equal(history["energy_max"], named["energy_max"])


def test_a_mesh_that_grows_keeps_what_was_observed(tmp_path):
    """The worn contact grows beyond its mesh, in memory as in a file."""
    small = WORN.replace(grid={"elements": [15, 15]}, wear=WORN.wear).replace(
        **{"wear.coefficient": 3.0, "wear.revolutions": 12, "wear.save": [0, 12]}
    )
    history = ts.roll(small, tmp_path / "a.h5")
    assert history.status == "done"
    assert history.field("energy", revolution=0).shape == history.grid.elements
    np.testing.assert_array_equal(history["energy_max"], ts.roll(small)["energy_max"])


@pytest.mark.slow
def test_every_command_takes_it(tmp_path, monkeypatch, empty_pictures):
    monkeypatch.chdir(tmp_path)
    Path("a.toml").write_text(WORN.to_toml())
    assert "Energy of friction per area" in command("explain", "a.toml")
    command("run", "a.toml", "-o", "a.h5")
    shown = json.loads(command("show", "a.h5", "--json"))
    assert shown["energy_max"][-1] > shown["energy_max"][1] > shown["energy_max"][0] == 0.0
    assert "energy_max" in command("show", "a.h5")
    figures = command("plot", "a.h5", "-o", "figures")
    assert "friction-energy" in {Path(line).stem for line in figures.split()}
    command("report", "a.h5", "-o", "a.html")
    assert "Energy of friction per width across the track" in Path("a.html").read_text()


def test_a_file_is_read_where_the_package_is_not_installed(package, tmp_path, monkeypatch):
    ts.roll(WORN, tmp_path / "a.h5")
    monkeypatch.setattr(sys, "path", [entry for entry in sys.path if entry != str(package)])
    del sys.modules["friction_energy"]
    history = ts.open_history(tmp_path / "a.h5")
    assert history.field("energy").max() == history["energy_max"][-1]
    assert history.to_xarray()["energy"].attrs["units"] == "mJ/mm2"
    assert "friction_energy" not in sys.modules


@pytest.mark.parametrize(
    ("observer", "key"),
    [
        ([{"name": "friction_energy:energy"}], "observer[0].name"),
        ([{"name": "not_installed:Energy"}], "observer[0].name"),
        ([{"name": NAME, "width": 3}], "observer[0].width"),
        ([{"name": NAME, "length": "long"}], "observer[0].length"),
        ([{"name": NAME}, {"name": NAME}], "observer[1].name"),
    ],
)
def test_what_it_cannot_take_names_the_key(observer, key):
    with pytest.raises(ts.SceneError) as caught:
        ts.roll(WORN.replace(observer=observer))
    assert key in {fault.key for fault in caught.value.faults}


def test_names_that_are_taken_are_refused(kind):
    class Again(kind):
        columns = (ts.Quantity("Qx", "N", "a force"),)

    with pytest.raises(ValueError, match="Qx"):
        ts.roll(WORN.replace(observer=None), observers=[Again()])
    with pytest.raises(ValueError, match="friction_energy"):
        ts.roll(WORN, observers=[kind()])
    with pytest.raises(TypeError, match="observers"):
        ts.roll(WORN, observers=[kind])


def test_a_file_of_a_run_without_it_is_not_resumed_with_it(kind, tmp_path):
    bare, path = WORN.replace(observer=None), tmp_path / "a.h5"
    ts.roll(bare.replace(**SHORTER["worn"]), path)
    with pytest.raises(ts.ResultsError, match="friction_energy"):
        ts.roll(bare, path, resume=True, observers=[kind()])
    with pytest.raises(ts.ResultsError, match="observer"):
        ts.roll(WORN, path, resume=True)
