"""Content says what was computed: files of a scene that change between two uses.

For each kind of file and each way in which a scene is used again, the result belongs to the new
content, or an error names the file. No result mixes two contents.
"""

import pickle

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.rail import Profile, builtin_profile, write_profile
from tractive_sam.store import ResultsError
from tractive_sam.tables.solving import Job, solve_jobs

STEEL = {"young": 208e3, "poisson": 0.3}


def write_rail(path, bump=0.0):
    """Write the 60E1 rail with a bump of a few tenths of a millimetre on its top."""
    new = builtin_profile("60E1")
    lift = np.array([[0.0, -1.0]]) * bump * np.exp(-(((new.points[:, :1] - 5.0) / 8.0) ** 2))
    write_profile(Profile.from_nodes(new.points + lift, new.tangents), path, "rail")


def write_wheel(path, bump=0.0):
    new = builtin_profile("S1002")
    write_profile(Profile.from_nodes(new.points * (1.0, 1.0 + bump), new.tangents), path, "wheel")


def write_sections(path, bump=0.0):
    write_rail(path.with_name("end.prr"))
    write_rail(path.with_name("middle.prr"), bump)
    names = ("end.prr", "middle.prr", "end.prr")
    rows = [f"{x} '{name}'" for x, name in zip((-20.0, 0.0, 20.0), names, strict=True)]
    path.write_text("\n".join(["0 1", "3", "0 0 0", "1", *rows]))


def write_gap(path, bump=0.0):
    """Write a wave across the track; `bump` makes it higher."""
    y = np.linspace(-2.0, 2.0, 41)
    table = np.column_stack((y, (2e-4 + 1e-3 * bump) * (1.0 + np.cos(3.0 * y))))
    np.savetxt(path, table, delimiter=",", header="y,separation", comments="")


def write_travelling(path, bump=0.0):
    rows = [(x, y, -1e-3 * bump * (x == 0.1)) for x in (-9.0, 0.1, 9.0) for y in (-9.0, 9.0)]
    np.savetxt(path, rows, delimiter=",", header="x,y,separation", comments="")


def on_rails(**profiles):
    grid = {"elements": [11, 11], "half_length": [9.0, 16.0]}
    tables = {"body": {"A": STEEL, "B": STEEL}, "friction": {"mu": 0.3}, "grid": grid}
    wheelset = {"normal_load": 80e3, "y": 0.5, "roll": 0.0, "pitch": 0.0}
    about = {"wheel": {"profile": "S1002"}, "rail": {"profile": "60E1"}, "wheelset": wheelset}
    return ts.Scene(**tables | about | profiles)


def spheres(**tables):
    bodies = {body: STEEL | {"radius_x": 30.0, "radius_y": 30.0} for body in "AB"}
    about = {"body": bodies, "load": {"normal": 300.0}, "friction": {"mu": 0.3}}
    about["creepage"] = {"longitudinal": -1e-3}
    about["grid"] = {"half_length": [0.5, 0.5], "elements": [19, 19]}
    return ts.Scene(**about | tables)


# Kind: name of the file, function that writes it, scene, key, the file that changes
KINDS = {
    "gap": ("g.csv", write_gap, lambda p: spheres(gap={"file": p}), "gap.file", "g.csv"),
    "wheel": (
        "w.prw", write_wheel, lambda p: on_rails(wheel={"profile": p}), "wheel.profile", "w.prw"
    ),
    "rail": ("r.prr", write_rail, lambda p: on_rails(rail={"profile": p}), "rail.profile", "r.prr"),
    "sections": (
        "n.slcs",
        write_sections,
        lambda p: on_rails(rail={"profile": p}),
        "rail.profile",
        "middle.prr",
    ),
    "travelling profile": (
        "t.csv",
        write_travelling,
        lambda p: spheres(
            transient={"distance": [0.0, 0.2], "profile": {"B": {"file": p}}, "step": 0.1}
        ),
        "transient.profile.B.file",
        "t.csv",
    ),
}  # fmt: skip


SLOW = "sections", "wheel"


@pytest.fixture(
    params=[pytest.param(name, marks=[pytest.mark.slow] if name in SLOW else []) for name in KINDS]
)
def kind(request, tmp_path):
    """Return (scene, function that changes its file, key, changed file)."""
    name, write, make, key, changed = KINDS[request.param]
    path = tmp_path / name
    write(path)
    return make(path), lambda: write(path, 0.3), key, changed


def last_peak(history):
    return history["p_max"][-1]


def roll(scene, *arguments, **options):
    return ts.roll(scene, *arguments, progress=False, **options)


def test_a_run_reads_the_file_again(kind):
    scene, change, *_ = kind
    before = last_peak(roll(scene))
    assert last_peak(roll(scene)) == before
    change()
    after = last_peak(roll(scene))
    assert after == last_peak(roll(ts.Scene.from_toml_text(scene.to_toml()))) != before


def test_the_fingerprint_is_that_of_the_content(kind):
    scene, change, *_ = kind
    change()
    changed = scene.with_current_files()
    assert changed.fingerprint() != scene.fingerprint()
    assert changed != scene
    assert changed.with_current_files() is changed


def test_resuming_refuses_another_content_and_names_the_file(kind, tmp_path):
    scene, change, key, name = kind
    path = tmp_path / "run.h5"
    before = last_peak(roll(scene, path))
    roll(scene, path, resume=True)
    change()
    for again in (scene, ts.Scene.from_toml_text(scene.to_toml())):
        with pytest.raises(ResultsError, match=rf"{key}: .*{name} has changed") as raised:
            roll(again, path, resume=True)
        assert " now" not in str(raised.value)  # no entries that follow from the file
    assert last_peak(ts.open_history(path)) == before


def test_a_results_file_needs_no_other_file(kind, tmp_path):
    """Opened elsewhere, without the file or beside another content, it has the computed one."""
    scene, change, key, _ = kind
    path = tmp_path / "run.h5"
    before = roll(scene, path)
    change()
    stored = ts.open_history(path).scene
    for file in tmp_path.glob("*[!5]"):
        file.unlink()
    moved = path.rename(tmp_path / "moved.h5")
    opened = ts.open_history(moved)
    assert opened.scene == stored
    assert opened.scene.fingerprint() == scene.fingerprint()
    assert last_peak(roll(opened.scene.replace(title="again"))) == last_peak(before)
    if key == "rail.profile":
        rail, computed = opened.scene.rail.curve, scene.rail.curve
        np.testing.assert_array_equal(rail.points, computed.points)
        assert last_peak(roll(opened.scene, tmp_path / "second.h5")) == last_peak(before)
        np.testing.assert_array_equal(
            ts.open_history(tmp_path / "second.h5").scene.rail.curve.points, computed.points
        )


def test_resuming_without_the_file_takes_the_stored_content(kind, tmp_path):
    scene, _, key, _ = kind
    path = tmp_path / "run.h5"
    before = last_peak(roll(scene, path))
    for file in tmp_path.glob("*[!5]"):
        file.unlink()
    with pytest.raises(ts.SceneError, match=key):
        roll(scene)
    with pytest.warns(ts.SceneWarning, match=r"does not exist: its content"):
        history = roll(scene, path, resume=True)
    assert last_peak(history) == before


def test_a_study_computes_the_changed_scenes(kind, tmp_path):
    scene, change, *_ = kind
    axis = {"key": "friction.mu", "values": [0.2, 0.3]}
    study = ts.Study(scene=scene, axis=[axis], keep="scalars")
    first = ts.study(study, tmp_path / "S", workers=0)
    change()
    second = ts.study(study, tmp_path / "S", workers=0)
    assert second.complete
    for row, old in zip(second.rows, first.rows, strict=True):
        assert row.last["p_max"] != old.last["p_max"]
        # Neighbours start from each other: equal to the tolerance of the solver.
        assert row.last["p_max"] == pytest.approx(last_peak(roll(row.case.scene)), rel=1e-6)


def test_a_study_that_has_begun_does_not_mix_contents(kind):
    """A worker has the geometry of wheel and rail already, and reads the other files itself."""
    scene, change, _, name = kind
    axis = {"key": "friction.mu", "values": [0.2, 0.3]}
    case = ts.studies.cases(ts.Study(scene=scene, axis=[axis]))[0].scene
    peak, sent = last_peak(roll(case)), pickle.dumps(case)
    change()
    assert last_peak(roll(case)) == peak  # read once
    if "wheel_rail" in vars(case):
        assert last_peak(roll(pickle.loads(sent))) == peak
    else:
        with pytest.raises(ts.SceneError, match=f"{name}, which has changed"):
            roll(pickle.loads(sent))


def test_a_table_that_has_begun_refuses_a_changed_file(kind):
    scene, change, _, name = kind
    if scene.transient is not None:
        pytest.skip("a table has no transients")
    design = ts.TableDesign(scene=scene, elements=15, tolerance=0.2)
    files, jobs = tuple(design.files.items()), [Job((), (-0.3, 0.1, 0.0), False)]
    before = solve_jobs(design.to_toml(), jobs, files).solutions[0].force[0]
    change()
    with pytest.raises(ts.SceneError, match=f"{name}, which has changed"):
        solve_jobs(design.to_toml(), [Job((), (-0.3, 0.1, 0.1), False)], (*files, ("other", "")))
    now = tuple(ts.TableDesign.from_toml_text(design.to_toml()).files.items())
    assert solve_jobs(design.to_toml(), jobs, now).solutions[0].force[0] != before


@pytest.mark.slow
def test_a_fit_refuses_another_content_and_names_the_file(kind, tmp_path):
    scene, change, _, name = kind
    if scene.transient is not None:
        pytest.skip("a transient prescribes no creepages to vary")
    values = {"friction.mu": [0.2, 0.3], "p_max": [1000.0, 1000.0]}
    data = {"values": values, "vary": "friction.mu", "observe": "p_max", "noise": 0.1}
    tables = {
        "scene": scene,
        "free": ["body.A.young"],
        "data": [data],
        "mesh_check": False,
        "iterations": 1,
        "curve": 0,
    }
    tables["intervals"] = "linear"
    design, path = {"fit": tables}, tmp_path / "fit.nc"
    first = ts.fit(design, path)
    assert ts.fit(design, path).chi2 == first.chi2
    change()
    with pytest.raises(ResultsError, match=f"{name} has changed"):
        ts.fit(design, path)
    assert ts.fit(design, path, overwrite=True).chi2 != first.chi2


def write_loads(path, bump=0.0):
    rows = [f"{load * (1.0 + bump)},-0.004" for load in (150.0, 200.0, 260.0)]
    path.write_text("\n".join(["normal,longitudinal", *rows, ""]))


@pytest.fixture
def loaded(tmp_path):
    """Return twin discs under a measured load history, and its file."""
    path = tmp_path / "loads.csv"
    write_loads(path)
    scene = ts.Scene.builtin("twin-discs").replace(subsurface=None)
    table = {"file": str(path), "levels": 2}
    wear = {"wear.revolutions": 6, "wear.save": [0]}
    return scene.replace(load_history=table, **{"grid.elements": (13, 27)}, **wear), path


def test_resuming_refuses_another_load_history_and_names_the_file(loaded, tmp_path):
    scene, path = loaded
    results = tmp_path / "run.h5"
    before = last_peak(roll(scene, results))
    write_loads(path, 0.1)
    assert last_peak(roll(scene, results, resume=True)) == before  # the blocks of the scene
    again = ts.Scene.from_toml_text(scene.replace(duty=None, load_history=None).to_toml())
    again = again.replace(load_history={"file": str(path), "levels": 2})
    with pytest.raises(ResultsError, match=r"load_history\.file: .*loads\.csv") as raised:
        roll(again, results, resume=True)
    assert "duty" not in str(raised.value)  # blocks follow from the file
    assert last_peak(roll(again)) != before


def test_a_results_file_of_a_load_history_needs_no_other_file(loaded, tmp_path):
    scene, path = loaded
    results = tmp_path / "run.h5"
    before = last_peak(roll(scene, results))
    path.unlink()
    opened = ts.open_history(results)
    assert opened.scene.fingerprint() == scene.fingerprint()
    assert last_peak(roll(opened.scene, results, resume=True)) == before
    assert last_peak(roll(opened.scene)) == before


def test_a_study_computes_another_load_history(loaded, tmp_path):
    scene, path = loaded
    tables = "\n".join(["[load_history]", f"file = '{path}'", "levels = 2", ""])
    text = scene.replace(duty=None, load_history=None).to_toml() + tables
    axis = {"key": "friction.mu", "values": [[0.2, 0.2], [0.3, 0.3]]}
    peaks = []
    for bump in (0.0, 0.1):
        write_loads(path, bump)
        study = ts.Study(scene=ts.Scene.from_toml_text(text), axis=[axis], keep="scalars")
        rows = ts.study(study, tmp_path / "S", workers=0).rows
        peaks.append([row.last["P"] for row in rows])
    np.testing.assert_allclose(np.divide(*peaks), 1.0 / 1.1)
