import csv
import shutil
from pathlib import Path

import pytest

import tractive_sam as ts

SMALL = """
title = "Friction of small spheres"
scene = "spheres"
without = ["subsurface"]
set = ["grid.elements=[21, 21]"]

[[axis]]
key = "friction.mu"
values = [0.2, 0.4]
"""

FAILING = SMALL.replace("friction.mu", "load.force_x").replace(
    "[0.2, 0.4]", "[0.05, 0.4]"
).replace('"]\n\n', '", "load.approach=0.036"]\n\n')  # fmt: skip


@pytest.fixture
def file(folder):
    path = folder / "study.toml"
    path.write_text(SMALL)
    return path


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """Return the folder of a complete study, which tests copy."""
    folder = tmp_path_factory.mktemp("study")
    (folder / "study.toml").write_text(SMALL)
    ts.study(folder / "study.toml", folder / "done", workers=0)
    return folder / "done"


def test_study_and_its_table(call, file):
    result = call("study", file, "-o", "done", "--workers", "0")
    assert result.exit_code == 0, result.output
    assert "2 cases, 0 of them complete already" in result.stderr
    assert "2 of 2: case" in result.stderr
    assert "done: 2 of 2 cases complete; tractive-sam study-show done" in result.stderr
    again = call("study", file, "-o", "done", "--workers", "0")
    assert "2 cases, 2 of them complete already" in again.stderr
    shown = call("study-show", "done")
    assert shown.exit_code == 0
    assert "2 cases: 2 complete" in shown.stderr
    assert shown.stdout.count("complete") == 2
    assert "friction" in shown.stdout
    run = call("run", file)
    assert run.exit_code == 2
    assert f"tractive-sam study {file.name}" in run.stderr.replace(str(file), file.name)
    assert call("show", "done").stdout == shown.stdout
    Path("done").rename("done.nc")  # a folder with the ending of a file
    assert call("show", "done.nc").stdout == shown.stdout


def test_studies_of_transients_report_shifts_and_work(call, folder):
    lines = [
        'scene = "fretting"',
        'set = ["grid.elements=[17, 17]", "transient.distance=[0, 1]", '
        '"transient.load.force_x=[0, 45]", "transient.step=0.5"]',
        '[[axis]]\nkey = "friction.mu"\nvalues = [0.5, 0.6]',
    ]
    (folder / "loops.toml").write_text("\n".join(lines))
    assert call("study", "loops.toml", "-o", "loops", "--workers", 0).exit_code == 0
    result = call("study-show", "loops")
    assert "shift x" in result.stdout
    assert "friction" in result.stdout
    assert "half x" not in result.stdout
    file = next((folder / "loops").rglob("*.h5"))
    assert "shift x" in call("show", file).stdout


@pytest.mark.slow
def test_table_as_csv_dataset_and_figures(call, file, folder):
    call("study", file, "-o", "done", "--workers", "0")
    result = call("study-show", "done", "--csv", "a.csv", "--figures", "b", "--quantity", "Qx")
    assert result.stdout.split() == ["a.csv", "b/Qx-curve.png"]
    with (folder / "a.csv").open() as table:
        assert len(list(csv.DictReader(table))) == 2
    pytest.importorskip("h5netcdf", reason="h5netcdf is of the extra study")
    assert call("study-show", "done", "--netcdf", "a.nc").stdout.split() == ["a.nc"]
    assert (folder / "a.nc").exists()


def test_failed_case_is_reported(call, folder):
    (folder / "study.toml").write_text(FAILING)
    result = call("study", "study.toml", "-o", "done", "--workers", "0")
    assert result.exit_code == 3
    assert "case 1 (load.force_x = 0.4) failed: " in result.stderr
    assert "1 of 2 cases complete" in result.stderr
    assert "not all cases are complete" in result.stderr
    shown = call("study-show", "done")
    assert shown.exit_code == 0
    assert "case 1 (load.force_x = 0.4) failed: " in shown.stderr
    assert "1 complete, 1 failed" in shown.stderr


def test_explain(call, file, monkeypatch):
    result = call("explain", file, "--workers", "3")
    assert result.exit_code == 0
    for text in ("Friction of small spheres", "2 values: 0.2, 0.4", "2 cases", "with 3 workers"):
        assert text in result.stdout
    monkeypatch.setattr("tractive_sam.compute.cores", lambda: 7)
    assert "with 7 workers" in call("explain", file).stdout
    assert "note" not in call("explain", file).stderr  # it cannot be a table
    refused = call("explain", file, "--set", "load.normal=1")
    assert refused.exit_code == 2
    assert "write the setting into the file" in refused.stderr


@pytest.mark.parametrize(
    ("arguments", "reported"),
    [
        (["missing.toml", "-o", "done"], ["missing.toml", "no such file"]),
        (["study.toml"], ["Missing option"]),
        (["study.toml", "-o", "study.toml"], ["is not a folder"]),
        (["study.toml", "-o", "other"], ["contains other files"]),
        (["study.toml", "-o", "done", "--workers", "-1"], ["workers"]),
        (["study.toml", "-o", "done", "--workers", "1", "--scheduler", "x"], ["--workers"]),
        (["study.toml", "-o", "done", "--scheduler", "nonsense:x"], ["nonsense"]),
    ],
)
def test_bad_input(call, file, folder, arguments, reported):
    (folder / "other").mkdir()
    (folder / "other" / "precious.txt").write_text("gold")
    result = call("study", *arguments)
    assert result.exit_code == 2
    for text in reported:
        assert text in result.output


def test_notes_of_a_scene_are_printed_once(call, folder):
    """Also if the study could be a table, with a design that makes an equal scene."""
    scene = ts.Scene.builtin("spheres").replace(subsurface=None)
    with pytest.warns(ts.SceneWarning, match=r"grid\.elements"):
        coarse = scene.replace(grid={"half_length": [4.1, 4.1], "elements": [9, 9]})
    (folder / "coarse.toml").write_text(coarse.to_toml())
    axis = '[[axis]]\nkey = "friction.angle"\nvalues = [0, 45]\n'
    (folder / "coarse-study.toml").write_text(f'scene = "coarse.toml"\n{axis}')
    error = call("explain", "coarse-study.toml").stderr
    assert "tolerance" in error
    assert error.count("grid.elements") == 1


def test_a_scene_in_place_of_a_study(call, folder):
    (folder / "scene.toml").write_text(ts.Scene.builtin("spheres").to_toml())
    result = call("study", "scene.toml", "-o", "done")
    assert result.exit_code == 2
    assert "tractive-sam run" in result.stderr
    assert "1 fault" in result.stderr


def test_a_parameter_varies_only_next_to_its_law(call, folder):
    (folder / "study.toml").write_text(SMALL.replace("friction.mu", "friction.mew"))
    result = call("study", "study.toml", "-o", "done")
    assert result.exit_code == 2
    assert "friction.mew" in result.stderr
    assert "static, mu" in result.stderr  # the keys of the table
    assert not (folder / "done").exists()


def test_every_fault_of_a_study_is_reported(call, folder):
    wrong = SMALL.replace("friction.mu", "friction.um").replace('"spheres"', '"spheers"')
    (folder / "study.toml").write_text(wrong)
    result = call("study", "study.toml", "-o", "done")
    assert result.exit_code == 2
    assert "2 faults in the study" in result.stderr
    assert "axis[0].key: given 'friction.um'" in result.stderr
    assert "scene: given 'spheers'" in result.stderr
    assert not (folder / "done").exists()


@pytest.mark.parametrize(
    ("arguments", "reported"),
    [
        (["nowhere"], "is not the folder of a study"),
        (["done", "--figures", "b", "--quantity", "Qz"], "no quantity Qz"),
        (["done", "--figures", "b", "--at", "friction.mu=0.3"], "has no value 0.3"),
        (["done", "--figures", "b", "--at", "friction.mu"], "table.key=value"),
        (["done", "--csv", "no/folder/a.csv"], "cannot be written"),
    ],
)
def test_bad_show(call, folder, done, arguments, reported):
    shutil.copytree(done, folder / "done")
    result = call("study-show", *arguments)
    assert result.exit_code == 2
    assert reported in result.stderr
