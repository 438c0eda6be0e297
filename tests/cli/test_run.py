import io
import sys
from pathlib import Path
from types import SimpleNamespace

import numba
import numpy as np
import pytest
from typer.testing import CliRunner

from tractive_sam.cli import app
from tractive_sam.cli.output import report_compiling
from tractive_sam.cli.scene_input import complete_keys, complete_scenes
from tractive_sam.input_file import read_piped
from tractive_sam.kernels.compiled import _Compiler
from tractive_sam.rolling.observers import LargestStress
from tractive_sam.scene import Scene
from tractive_sam.store import open_history


def test_builtin_scene_for_real(call):
    result = call("run", "spheres", "--set", "grid.elements=[25, 25]", "-o", "round.h5")
    assert result.exit_code == 0, result.output
    history = open_history("round.h5")
    assert history.finished
    assert history["Qx_over_P"][-1] == pytest.approx(0.262, abs=0.01)
    assert "Qx_over_P" in result.stdout
    assert "round.h5: done" in result.stderr


def test_scene_file_and_default_output(call, roll, folder):
    (folder / "scenes").mkdir()
    (folder / "scenes" / "mine.toml").write_text(Scene.builtin("spheres").to_toml())
    assert call("run", "scenes/mine.toml").exit_code == 0
    (_, path, overwrite) = roll.calls[0]
    assert (path, overwrite) == (Path("mine.h5"), True)
    assert (folder / "mine.h5").exists()


def test_settings(call, roll):
    call("run", "spheres", "--set", "load.approach=0.07", "--set", "friction.mu=[0.4, 0.2]")
    scene = roll.calls[0][0]
    assert (scene.load.normal, scene.load.approach) == (None, 0.07)
    assert scene.friction.mu == (0.4, 0.2)


def test_earlier_results_are_kept_unless_requested(call, roll, folder):
    assert call("run", "spheres").exit_code == 0
    before = (folder / "spheres.h5").read_bytes()
    for others in ([], ["--set", "load.normal=0.3"], ["--resume", "--overwrite"]):
        result = call("run", "spheres", *others)
        assert result.exit_code == 2
        assert "--overwrite" in result.stderr
        assert ("load.normal" in result.stderr) == ("load.normal=0.3" in others)
    assert (folder / "spheres.h5").read_bytes() == before
    assert len(roll.calls) == 1
    assert call("run", "spheres", "--set", "load.normal=0.3", "--overwrite").exit_code == 0
    assert open_history("spheres.h5").scene.load.normal == 0.3


@pytest.mark.parametrize("ending", [("stalled", "try solver.method"), None])
def test_an_unfinished_run_is_resumed_or_begun_again_as_requested(call, roll, ending):
    roll.ending, roll.error = ending, None if ending else KeyboardInterrupt()
    assert call("run", "twin-discs").exit_code == 3
    result = call("run", "twin-discs")
    assert result.exit_code == 2
    assert "--resume" in result.stderr
    assert "--overwrite" in result.stderr


def test_more_revolutions_are_for_resuming(call, roll, stored):
    shorter = ["twin-discs", "-o", "discs.h5", "--set"]
    roll(Scene.builtin("twin-discs").with_set(["wear.revolutions=2"]), Path("discs.h5"))
    assert "--resume" not in call("run", *shorter, "wear.revolutions=2").stderr
    assert "--resume" in call("run", *shorter, "wear.revolutions=9999").stderr


def test_files_of_others_are_never_replaced(call, roll, folder):
    (folder / "precious.h5").write_text("gold")
    for options in ([], ["--overwrite"]):
        result = call("run", "spheres", "-o", "precious.h5", *options)
        assert result.exit_code == 2
        assert "precious.h5 would be overwritten" in result.stderr
        assert (folder / "precious.h5").read_text() == "gold"


@pytest.mark.parametrize(
    ("arguments", "reported"),
    [
        (["nonsense"], ["'nonsense'", "spheres", "twin-discs"]),
        (["missing.toml"], ["missing.toml", "no such file"]),
        (["spheres", "--set", "load.normal=-1"], ["load.normal", "-1", "above 0"]),
        (["spheres", "--set", "no equals sign"], ["no equals sign", "table.key=value"]),
        (["spheres", "--set", "lod.normal=1"], ["lod", "load"]),
        (["spheres", "--set", "gap.file=no.csv"], ["gap.file", "existing file"]),
        (["spheres", "-o", "no/folder/x.h5"], ["no/folder is not a folder"]),
        ([], ["Missing argument"]),
        (["spheres", "--unknown"], ["No such option"]),
    ],
)
def test_bad_input(call, roll, arguments, reported):
    result = call("run", *arguments)
    assert result.exit_code == 2
    for text in reported:
        assert text in result.stderr
    assert not result.stdout


def test_every_fault_is_listed(call):
    result = call("run", "spheres", "--set", "load.normal=-1", "--set", "friction.mu=a")
    assert result.exit_code == 2
    assert "2 faults" in result.stderr
    assert "load.normal: given -1" in result.stderr
    assert "friction.mu: given 'a'" in result.stderr


def test_gap_that_cannot_be_read_is_a_fault_of_the_scene(call, folder):
    (folder / "gap.csv").write_text("x,y,separation\n0,0,0\n")
    result = call("run", "spheres", "--set", "gap.file=gap.csv")
    assert result.exit_code == 2
    assert "gap.file: given" in result.stderr


def test_not_converged(call, roll):
    roll.ending = ("stalled", "revolution 2: try solver.method")
    result = call("run", "spheres")
    assert result.exit_code == 3
    assert "stalled; revolution 2: try solver.method" in result.stderr


@pytest.mark.parametrize("error", [KeyboardInterrupt(), OSError("disk full")])
def test_stopped_early(call, roll, error):
    roll.error = error
    result = call("run", "spheres")
    assert result.exit_code == 3
    assert "spheres.h5" in result.stderr
    assert open_history("spheres.h5").status == "stopped early"


def test_memory_that_does_not_suffice(call, roll):
    roll.error = MemoryError()
    result = call("run", "spheres")
    assert result.exit_code == 3
    assert "--resume" in result.stderr
    assert len(open_history("spheres.h5")) == 3


def test_memory_that_does_not_suffice_for_a_record(call, monkeypatch):
    def fill_memory(*_arguments):
        raise MemoryError

    monkeypatch.setattr("tractive_sam.contact.Model.undeformed_gap", property(fill_memory))
    result = call("run", "spheres")
    assert result.exit_code == 2
    assert "coarser [grid]" in result.stderr


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["spheres", "twin-discs"])
def test_a_contact_is_kept_if_the_memory_does_not_suffice_for_its_stress(call, monkeypatch, scene):
    """What was computed is stored, and resumed to the results of an uninterrupted run."""
    grid = "grid.elements=[21, 21]"
    settings = ["--set", grid] + ["--set", "wear.revolutions=20"] * (scene == "twin-discs")
    call("run", scene, *settings, "-o", "whole.h5")
    whole = open_history("whole.h5")
    kept = len(whole) - 1  # records with stress
    computed = LargestStress.record_block
    calls = []

    def run_out_of_memory(observer, block):
        calls.append(block)
        if len(calls) > kept:
            raise MemoryError
        return computed(observer, block)

    with monkeypatch.context() as patched:
        patched.setattr(LargestStress, "record_block", run_out_of_memory)
        result = call("run", scene, *settings, "-o", "part.h5")
    assert result.exit_code == 3
    part = open_history("part.h5")
    assert (part.status, len(part)) == ("stopped early", kept + 1)
    assert part["P"].tolist() == whole["P"].tolist()
    if not kept:
        np.testing.assert_array_equal(part.field("pressure"), whole.field("pressure"))
    assert call("run", scene, *settings, "-o", "part.h5", "--resume").exit_code == 0
    resumed = open_history("part.h5")
    assert resumed.finished
    for name in ("P", "Qx", *(name for name in whole.columns if name.startswith("von_mises"))):
        np.testing.assert_array_equal(resumed[name], whole[name])


def test_warning_is_a_note_of_one_line_about_the_final_scene(call, roll):
    result = call("run", "spheres", "--set", "grid.elements=[7, 7]")
    assert result.exit_code == 0
    notes = [line for line in result.stderr.splitlines() if line.startswith("note: grid")]
    assert len(notes) == 1
    assert "grid.elements" in notes[0]


def test_a_contact_of_one_element_is_no_result(call):
    """Its note, once, says what is probably meant."""
    grid = ["grid.half_length=[4, 4]", "grid.elements=[31, 31]"]
    settings = ["load.pressure=1", "wear.revolutions=1", *grid]
    result = call("run", "twin-discs", *(part for one in settings for part in ("--set", one)))
    assert result.exit_code == 3
    assert "not resolved" in result.stderr
    assert len([one for one in result.stderr.splitlines() if "load.pressure" in one]) == 1


def test_progress_on_a_terminal(call, roll, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    result = call("run", "twin-discs")
    assert result.exit_code == 0
    assert "of 15000, wear" in result.stderr


def test_no_progress_elsewhere(call, roll):
    lines = call("run", "twin-discs").stderr.splitlines()
    assert [line for line in lines if not line.startswith("note: ")] == [
        "twin-discs.h5: done; conditions hold"
    ]


def test_main_results_come_first_and_all_on_demand(call, roll):
    short, long = (
        call("run", "twin-discs", "--overwrite", *more).stdout for more in ([], ["--verbose"])
    )
    first = [line.split()[0] for line in short.splitlines() if line.strip()]
    assert first[:2] == ["P", "Qx"]
    assert first.index("p_max") < 15  # no longer than a screen, with the load below
    assert first.index("load") <= 16  # 15 rows and a caption
    assert "operator_applications" not in short
    assert "operator_applications" in long


def test_a_quiet_run_prints_errors_only(call, roll):
    done = call("run", "twin-discs", "--quiet", "--set", "grid.elements=[7, 7]")
    assert (done.exit_code, done.output) == (0, "")
    roll.ending = ("stalled", "try solver.method")
    failed = call("run", "twin-discs", "-q", "--overwrite")
    assert failed.exit_code == 3
    assert [line.split(":")[0] for line in failed.stderr.splitlines()] == ["error"]
    assert "note: " in call("run", "spheres", "--set", "grid.elements=[7, 7]").stderr  # not quiet


def test_a_scene_from_the_standard_input(roll):
    text = Scene.builtin("spheres").to_toml()
    ended = CliRunner().invoke(app, ["run", "-", "-o", "piped.h5"], input=text)
    assert ended.exit_code == 0, ended.output
    assert roll.calls[0][0] == Scene.builtin("spheres")
    unnamed = CliRunner().invoke(app, ["run", "-"], input=text)
    assert (unnamed.exit_code, "-o FILE.h5" in unnamed.stderr) == (2, True)


def test_a_standard_input_without_end_is_refused(monkeypatch):
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(b"#" * 1000)))
    with pytest.raises(OSError, match="999 bytes"):
        read_piped(999)


@pytest.mark.parametrize("content", [b"\xff\xfe", b"no TOML", b""])
def test_a_standard_input_that_is_no_scene(content):
    ended = CliRunner().invoke(app, ["run", "-", "-o", "x.h5"], input=content)
    assert ended.exit_code == 2
    assert isinstance(ended.exception, SystemExit)


def test_a_results_file_is_no_scene(call, stored):
    result = call("run", "stored.h5")
    assert result.exit_code == 2
    for command in ("show", "plot", "report", "--start"):
        assert command in result.stderr


def test_a_note_is_printed_once_also_where_a_block_has_it_too(call):
    blocks = "duty=[{revolutions=5000}, {revolutions=5000, load={normal=200.0}}]"
    settings = ("--set", "grid.elements=[7, 7]", "--set", blocks)
    lines = call("explain", "twin-discs", *settings).stderr.splitlines()
    notes = [one.removeprefix("note: ").removeprefix("duty: ") for one in lines if "note" in one]
    assert any(one.startswith("grid.elements") for one in notes)
    assert len(set(notes)) == len(notes)


@pytest.mark.parametrize(
    ("setting", "nearest"),
    [("fatigue.criterion=dangvan", "dang-van"), ("solver.method=Newtn", "newton")],
)
def test_a_misspelt_value_has_its_nearest_one(call, setting, nearest):
    result = call("run", "spheres", "--set", setting)
    assert result.exit_code == 2
    assert f'"{nearest}", perhaps?' in result.stderr
    assert "perhaps" not in call("run", "spheres", "--set", "solver.method=xyz").stderr


def test_completion_of_scenes_and_keys(folder):
    (folder / "spare.toml").write_text("")
    (folder / "spoils").mkdir()
    assert "twin-discs" in complete_scenes("twin")
    assert complete_scenes("sp")[-2:] == ["spare.toml", "spoils/"]
    assert complete_keys("load.n") == ["load.normal="]
    assert {"title=", "body.A.young=", "body.B.young="} <= set(complete_keys(""))


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_compiling_is_reported_without_a_terminal(capsys):
    with report_compiling():
        for number in (1, 2):
            _Compiler.notify(number, 7)
    (line,) = capsys.readouterr().err.splitlines()
    assert "compiling kernels, once: 1 of at most 7" in line
