"""Both built-in line contacts through the program."""

import json
from pathlib import Path

import h5py
import pytest


@pytest.mark.slow
@pytest.mark.parametrize("name", ["cylinders", "cylinders-dissimilar"])
def test_run_show_plot_and_explain(call, folder, name):
    grid = ("--set", "grid.half_length=0.45", "--set", "grid.elements=65")
    result = call("run", name, *grid, "-o", "line.h5")
    assert result.exit_code == 0, result.stderr
    assert "N/mm" in result.stdout
    reported = json.loads(call("show", "line.h5", "--json").stdout)
    assert reported["b0"] is None
    assert reported["half_width_y"] == [None]
    assert "per length" in call("show", "line.h5").stdout
    with h5py.File("line.h5") as file:
        assert file["history/Qx"].attrs["units"] == "N/mm"
        assert file["fields/pressure"].shape == (1, 65, 1)
    result = call("plot", "line.h5")
    assert result.exit_code == 0
    figures = {Path(line).stem for line in result.stdout.splitlines()}
    assert figures >= {"pressure", "traction", "slip"}
    explained = call("explain", name, *grid).stdout
    assert "plane strain" in explained
    assert "65 elements, given" in explained


def test_faults(call):
    result = call("run", "cylinders", "--set", "creepage.spin=0.1", "--set", "load.approach=0.1")
    assert result.exit_code == 2
    assert "creepage.spin" in result.stderr
    assert "load.approach" in result.stderr
