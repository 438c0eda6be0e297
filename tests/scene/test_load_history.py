"""Blocks of a measured load history."""

import re

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.scene import describe_load
from tractive_sam.schema import PlausibilityWarning

RANDOM = np.random.default_rng(5)
MEASURED = {
    "normal": RANDOM.uniform(100.0, 500.0, 400),
    "longitudinal": -RANDOM.uniform(1e-3, 5e-3, 400),
    "revolutions": RANDOM.integers(1, 20, 400),
}


def test_revolutions_and_means_are_kept():
    binned = ts.blocks_of(MEASURED, levels=5)
    assert len(binned.blocks) <= 25
    n = np.array([one.revolutions for one in binned.blocks])
    load = np.array([one.load.normal for one in binned.blocks])
    assert n.sum() == MEASURED["revolutions"].sum()
    mean = np.average(MEASURED["normal"], weights=MEASURED["revolutions"])
    assert n @ load / n.sum() == pytest.approx(mean, rel=1e-12)


def test_the_error_falls_with_the_levels():
    """Half a level at most; in a level of even spread 1/sqrt(12) of it."""
    errors = [ts.blocks_of(MEASURED, levels=n).error["normal"] for n in (2, 4, 8, 16)]
    ratios = np.divide(errors[:-1], errors[1:])
    np.testing.assert_allclose(ratios, 2.0, rtol=0.3)  # of 400 rows, fewer in a level
    work = [ts.blocks_of(MEASURED, levels=n).work_error for n in (1, 16)]
    assert work[1] < work[0] < 0.05
    assert ts.blocks_of(MEASURED, levels=1000).work_error < 1e-5


@pytest.mark.parametrize(
    "columns", [["pressure", "longitudinal"], ["approach"], ["normal", "force_x"], ["force_y"]]
)
def test_the_work_is_unknown_where_load_or_creepage_is(columns):
    two = {name: [1.0, 3.0] for name in columns}
    assert ts.blocks_of(two, levels=1).work_error is None


def test_the_work_of_loads_and_creepages():
    """1 x 0.001 and 3 x 0.003 have the mean 0.005; their means are 2 and 0.002."""
    two = {"normal": [1.0, 3.0], "longitudinal": [-0.001, -0.003]}
    assert ts.blocks_of(two, levels=1).work_error == pytest.approx(1.0 - 0.004 / 0.005, rel=1e-12)
    one = {"normal": [1.0, 3.0]}
    assert ts.blocks_of(one, levels=1).work_error == 0.0


def test_a_scene_whose_work_is_unknown(loads):
    loads.write_text("pressure,longitudinal\n900,-0.001\n1100,-0.01\n")
    scene = DISCS.replace(load_history={"file": str(loads), "levels": 1})
    assert scene.load_history.work_error is None
    assert "load x creepage" not in describe_load(scene)["load history"]
    assert ts.Scene.from_toml_text(scene.to_toml()) == scene


def test_a_file_is_its_table(tmp_path):
    path = tmp_path / "measured.csv"
    rows = zip(*(values.tolist() for values in MEASURED.values()), strict=True)
    path.write_text("\n".join([",".join(MEASURED), *(",".join(map(repr, r)) for r in rows)]))
    assert ts.blocks_of(path).blocks == ts.blocks_of(MEASURED).blocks


@pytest.mark.parametrize(
    ("measured", "levels", "key"),
    [
        ({"weight": [1.0]}, 2, "weight"),
        ({"normal": [1.0, 2.0], "spin": [1.0]}, 2, "columns"),
        ({"normal": []}, 2, "columns"),
        ({"normal": [np.nan]}, 2, "columns"),
        ({"normal": ["a"]}, 2, "columns"),
        ({"revolutions": [1]}, 2, "columns"),
        ({"normal": [1.0], "revolutions": [0]}, 2, "revolutions"),
        ({"normal": [1.0, 2.0], "revolutions": [1, 1.4]}, 2, "revolutions"),
        ({"normal": [1.0], "revolutions": [1e300]}, 2, "revolutions"),
        ({"normal": [1.0]}, 0, "levels"),
        ("none.csv", 2, "measured"),
    ],
)
def test_what_is_wrong_is_reported(measured, levels, key):
    with pytest.raises(ts.SceneError) as caught:
        ts.blocks_of(measured, levels)
    assert [fault.key for fault in caught.value.faults] == [key]


DISCS = ts.Scene.builtin("twin-discs").replace(subsurface=None)
ROWS = (
    "normal,longitudinal,revolutions\n300,-0.005,40\n310,-0.004,30\n450,-0.005,20\n440,-0.001,10\n"
)


@pytest.fixture
def loads(tmp_path):
    path = tmp_path / "loads.csv"
    path.write_text(ROWS)
    return path


def test_a_scene_reads_its_history(loads):
    text = DISCS.to_toml() + '\n[load_history]\nfile = "loads.csv"\nlevels = 2\n'
    (loads.parent / "scene.toml").write_text(text)
    scene = ts.Scene.from_toml(loads.parent / "scene.toml")
    binned = ts.blocks_of(loads, levels=2)
    assert scene.duty == binned.blocks
    assert (scene.load_history.error, scene.load_history.rows) == (binned.error, 4)
    other = scene.with_set(["load_history.levels=1"])
    assert [one.revolutions for one in other.duty] == [100]
    assert other == DISCS.with_set([f"load_history.file={loads}", "load_history.levels=1"])
    assert "4 rows of loads.csv" in describe_load(scene)["load history"]


def test_its_text_holds_the_blocks(loads):
    """A results file needs the measured one no more."""
    scene = DISCS.replace(load_history={"file": str(loads), "levels": 2})
    loads.unlink()
    again = ts.Scene.from_toml_text(scene.to_toml())
    assert again == scene
    assert hash(again) == hash(scene)
    assert again.fingerprint() == scene.replace(duty=scene.duty).fingerprint()
    assert scene.replace(duty=scene.duty).load_history is None
    assert not scene.replace(load_history=None).duty
    assert not scene.without_blocks.duty
    assert scene.blocks[0].load_history is None
    longer = scene.replace(**{"wear.revolutions": 2000})
    assert longer.duty == scene.duty
    with pytest.raises(ts.SceneError, match=r"load_history\.file: .*existing"):  # rows are needed
        scene.with_set(["load_history.levels=1"])


def test_levels_that_change_the_work_are_noted(loads):
    with pytest.warns(PlausibilityWarning, match="creepage"):
        DISCS.replace(load_history={"file": str(loads), "levels": 1})


@pytest.mark.parametrize(
    ("given", "key"),
    [
        ({"levels": 2}, "load_history.file"),
        ({"file": "none.csv"}, "load_history.file"),
        ({"file": "loads.xlsx"}, "load_history.file"),
        ({"file": "{loads}", "levels": 0}, "load_history.levels"),
        ({"file": "{loads}", "binning": "rainflow"}, "load_history.binning"),
        ({"file": "{loads}", "work_error": 0.1}, "load_history.work_error"),
        ("loads.csv", "load_history.file"),
    ],
)
def test_faults_of_the_table_are_listed_with_others(loads, given, key):
    if isinstance(given, dict) and "file" in given:
        given = given | {"file": given["file"].format(loads=loads)}
    with pytest.raises(ts.SceneError) as caught:
        DISCS.replace(load_history=given, **{"load.normal": -1.0})
    assert {key, "load.normal"} <= {fault.key for fault in caught.value.faults}


@pytest.mark.parametrize(
    ("rows", "reported"),
    [
        ("", "no rows"),
        ("normal\n", "no rows"),
        ("normal\n300\nabc\n", "line 3"),
        ("normal;revolutions\n300;1.000,5\n", "line 2"),
        ("normal,revolutions\n300,1\n310\n", "line 3"),
        ("normal, normal\n300,310\n", "each column once"),
    ],
)
def test_a_line_that_cannot_be_read_is_reported(loads, rows, reported):
    loads.write_text(rows)
    with pytest.raises(ts.SceneError, match=rf"load_history\.file.*loads\.csv.*{reported}"):
        DISCS.replace(load_history={"file": str(loads)})


def test_a_unit_is_converted_and_a_time_is_named(loads):
    table = {"file": str(loads), "levels": 2}
    scene = DISCS.replace(load_history=table)
    cells = [line.split(",") for line in ROWS.splitlines()[1:]]
    rows = [f"{k};{float(n) / 1e3:g};{100 * float(c):g};{r}" for k, (n, c, r) in enumerate(cells)]
    head = "Time [s];normal [kN];longitudinal [%];revolutions"
    loads.write_text("\n".join([head, *rows]).replace(".", ","))
    with pytest.warns(ts.SceneWarning, match="loads.csv that are not read: Time"):
        again = DISCS.replace(load_history=table)
    for block, other in zip(again.duty, scene.duty, strict=True):
        assert block.load.normal == pytest.approx(other.load.normal, rel=1e-12)
        slip = other.creepage.longitudinal
        assert block.creepage.longitudinal == pytest.approx(slip, rel=1e-12)


def test_a_row_without_contact_is_named(loads):
    loads.write_text(ROWS.replace("450", "0"))
    with pytest.raises(ts.SceneError, match=r"normal = 0 in loads\.csv, line 4.*remove these rows"):
        DISCS.replace(load_history={"file": str(loads)})


def test_equal_notes_on_blocks_are_one_note(loads):
    """All blocks have creepages of tens of per cent."""
    loads.write_text(ROWS.replace("-0.00", "-0."))
    with pytest.warns(PlausibilityWarning) as notes:
        DISCS.replace(load_history={"file": str(loads), "levels": 4})
    assert sum("creepage.longitudinal" in str(note.message) for note in notes) == 1


def test_one_of_blocks_and_a_history(loads):
    with pytest.raises(ts.SceneError) as caught:
        DISCS.replace(duty=[{"revolutions": 1}], load_history={"file": str(loads)})
    assert [fault.key for fault in caught.value.faults] == ["load_history.file"]
    with pytest.raises(ts.SceneError):
        DISCS.with_set([f"load_history.file={loads}", "duty=[{revolutions=1}]"])
    with pytest.raises(ts.SceneError) as caught:
        DISCS.with_set([f"duty.file={loads}"])
    assert [fault.key for fault in caught.value.faults] == ["duty"]


def test_rainflow_is_refused_with_its_reason():
    with pytest.raises(ts.SceneError) as caught:
        ts.blocks_of(MEASURED, binning="rainflow")
    assert [fault.key for fault in caught.value.faults] == ["binning"]


@pytest.mark.filterwarnings("ignore::tractive_sam.schema.PlausibilityWarning")  # of few levels
def test_a_study_over_the_levels(loads):
    text = (
        'scene = "twin-discs"\nwithout = ["subsurface"]\n'
        'set = ["load_history.file=loads.csv"]\n'
        '[[axis]]\nkey = "load_history.levels"\nvalues = [1, 2]\n'
    )
    (loads.parent / "study.toml").write_text(text)
    study = ts.Study.from_toml(loads.parent / "study.toml")
    assert study.scene.load_history.file == loads


@pytest.mark.parametrize(
    ("values", "found"),
    [
        ([300, 310, 9999, 305, 9999, 320], "line 4, loads.csv, line 6, a mark of missing"),
        ([300, 310, 7000, 305, 330, 320], "line 4, more than 20 times the median"),
        ([0.3, 0.31, 0.29, 0.33, 0.3, 0.3], "kN"),
        ([300, 310, 320, 305, 330, "\n310", 300, 320], "empty line at line 8"),
        ([300, 310, "# second\n320", 305, 330, 310, 300, 320], "a comment at line 5"),
        ([300, "310 # per wheel", 300], "line 3 'per wheel'"),
        ([300, "310 # tare: 50 N", 300], "line 3 'tare: 50 N'"),
        ([300, "310 # forces per wheelset (2 wheels)", 300], "2 wheels"),
    ],
)
def test_implausible_rows_of_a_history_are_named(tmp_path, values, found):
    path = tmp_path / "loads.csv"
    path.write_text("\n".join(map(str, ("normal", *values))) + "\n")
    with pytest.warns(ts.SceneWarning, match=re.escape(found)):
        ts.blocks_of(path)


def test_a_time_that_begins_again_is_named(tmp_path):
    path = tmp_path / "loads.csv"
    rows = [f"{k % 6};{300 + k}" for k in range(12)]
    path.write_text("\n".join(("time [s];normal [N]", *rows)) + "\n")
    with pytest.warns(ts.SceneWarning) as notes:
        ts.blocks_of(path)
    assert any("a fall of the time at line 8" in str(note.message) for note in notes)


@pytest.mark.filterwarnings("ignore::tractive_sam.schema.PlausibilityWarning")  # of small loads
def test_loads_far_below_the_load_of_the_scene_are_named(loads):
    """Loads in kN, far below those of the scene, but possible in N."""
    loads.write_text("normal\n1.5\n1.6\n1.4\n")
    with pytest.warns(ts.SceneWarning, match=r"1 % of load\.normal"):
        DISCS.replace(load_history={"file": str(loads)})
