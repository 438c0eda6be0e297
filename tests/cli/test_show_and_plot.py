import csv
import io
import json
import subprocess
import sys
from pathlib import Path
from typing import get_args

import pytest
from typer.testing import CliRunner

import tractive_sam as ts
from tractive_sam import plot
from tractive_sam.cli import app
from tractive_sam.cli.show import Format
from tractive_sam.results.grid import Grid
from tractive_sam.scene import Scene
from tractive_sam.store import HistoryWriter, open_history


def test_show(call, stored):
    result = call("show", stored)
    assert result.exit_code == 0
    for text in (
        "Stored [not markup]",
        "done",
        "as asked",
        "30, 2 with fields",
        "20 of 30 records",
    ):
        assert text in result.stdout
    assert "Qx_over_P" in result.stdout


def test_show_json(call, stored):
    result = call("show", stored, "--json")
    assert json.loads(result.stdout) == open_history(stored).to_dict()
    assert not result.stderr


def test_show_csv(call, stored):
    history = open_history(stored)
    result = call("show", stored, "--csv")
    head, *rows = list(csv.reader(io.StringIO(result.stdout)))
    assert head == list(history.numbers())
    assert len(rows) == len(history)
    assert [float(row[head.index("Qx")]) for row in rows] == history["Qx"].tolist()
    assert call("show", stored, "--csv", "--json").exit_code == 2


def test_show_and_plot_of_an_empty_history(call, folder):
    HistoryWriter("empty.h5", Scene.builtin("spheres"), Grid((1.0, 1.0), (9, 9)))
    result = call("show", "empty.h5")
    assert result.exit_code == 0
    assert "running" in result.stdout
    assert call("show", "empty.h5", "--json").exit_code == 0
    result = call("plot", "empty.h5")
    assert result.exit_code == 2
    assert "no record to draw" in result.stderr


@pytest.mark.parametrize("command", ["show", "plot"])
def test_unreadable_results(call, folder, command):
    assert call(command, "missing.h5").exit_code == 2
    (folder / "text.h5").write_text("text")
    result = call(command, "text.h5")
    assert result.exit_code == 2
    assert "is not an HDF5 file" in result.stderr


@pytest.mark.usefixtures("empty_pictures")
def test_plot(call, stored, folder):
    result = call("plot", stored, "--animate")
    assert result.exit_code == 0
    files = {path.name for path in (folder / "stored-figures").iterdir()}
    assert {"pressure-29.png", "forces.png", "evolution.gif"} <= files
    assert len(result.stdout.splitlines()) == len(files)


def test_plot_elsewhere_in_another_format(call, stored, monkeypatch):
    requested = []
    monkeypatch.setattr(plot, "save_all", lambda *to, **look: requested.append(to[1:]) or ["a.svg"])
    assert call("plot", stored, "-o", "here", "--format", "svg").stdout == "a.svg\n"
    assert requested == [(Path("here"), "svg")]


def test_plot_that_cannot_be_written(call, stored):
    result = call("plot", stored, "-o", stored)
    assert result.exit_code == 2
    assert "cannot be written" in result.stderr


def test_a_block_that_is_not_there_is_no_fault_of_the_figures(call, stored, monkeypatch):
    assert call("plot", stored, "--block", "light").exit_code == 2

    def wrong(*args, **options):
        raise KeyError("a fault of the program")

    monkeypatch.setattr(plot, "save_all", wrong)
    assert isinstance(CliRunner().invoke(app, ["plot", str(stored)]).exception, KeyError)


@pytest.mark.slow
@pytest.mark.parametrize("arguments", [("show", "stored.h5"), ("show", "stored.h5", "--json")])
def test_a_reader_that_leaves_is_no_fault(stored, arguments):
    """As `head` does: no traceback, no word, and the status of the command."""
    program = [sys.executable, "-m", "tractive_sam", *arguments]
    with subprocess.Popen(program, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        process.stdout.close()
        assert process.stderr.read() == b""
    assert process.returncode == 0


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_an_output_that_is_lost_is_reported(stored):
    with open("/dev/full", "w") as full:
        program = [sys.executable, "-m", "tractive_sam", "show", "stored.h5"]
        result = subprocess.run(program, stdout=full, stderr=subprocess.PIPE, check=False)
    assert result.returncode == 3
    assert result.stderr.startswith(b"error: the output is lost")


def test_formats_are_those_of_the_figures():
    assert get_args(Format) == plot.FORMATS


def test_show_reports_wear_both_what_was_requested_and_what_balances(call, folder):
    small = ["grid.elements=[13, 29]", "wear.revolutions=1", "wear.save=[1]"]
    ts.roll(ts.Scene.builtin("twin-discs-isotropic").with_set(small), "worn.h5")
    reported = call("show", "worn.h5").stdout
    assert "k = 0.002 mm3/(N m)" in reported
    assert "wear balance" in reported


def test_records_show_the_smooth_pressure_with_the_peak(call, stored):
    shown = call("show", stored).stdout
    heads = next(line for line in shown.splitlines() if "p_95" in line)
    assert heads.index("p_max") < heads.index("p_95")


@pytest.mark.parametrize("source", ["x", None, Scene.builtin("spheres")])
def test_figures_of_what_is_neither_contact_nor_history(source):
    with pytest.raises(TypeError, match=r"contact.*history"):
        plot.traction(source)
