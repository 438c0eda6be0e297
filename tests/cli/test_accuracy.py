"""An accuracy in place of a mesh, through the program."""

import json

import pytest

COARSE = ("--set", "accuracy.tolerance=0.02")


@pytest.mark.slow
def test_run_show_and_explain(call, folder):
    stress = ("--set", 'subsurface.planes=["y=0"]')
    result = call("run", "spheres", *COARSE, *stress, "-o", "spheres.h5")
    assert result.exit_code == 0, result.stderr
    assert "±" in result.stdout
    reported = json.loads(call("show", "spheres.h5", "--json").stdout)
    assert 0.0 < reported["Qx_error"][0] < 0.02
    assert set(reported["von_mises_max_error"]) == {"A", "B"}
    explained = call("explain", "spheres", *COARSE).stdout
    assert "Qx of the unworn bodies" in explained
    assert "found by refinement" in explained


def test_what_is_not_reached_is_reported(call, folder):
    fewest = ("--set", "accuracy.tolerance=1e-5", "--set", "accuracy.elements=1000")
    result = call("run", "spheres", *fewest, "-o", "spheres.h5")
    assert result.exit_code == 3
    assert "raise one of them" in result.stderr
    assert "error bars" in result.stderr


@pytest.mark.parametrize("text", ["0", "1", "nan", '"fine"'])
def test_faulty_tolerances(call, text):
    result = call("run", "spheres", "--set", f"accuracy.tolerance={text}")
    assert result.exit_code == 2
    assert "accuracy.tolerance" in result.stderr


def test_either_a_grid_or_an_accuracy(call, folder):
    both = (*COARSE, "--set", "grid.half_length=[4, 4]", "--set", "grid.elements=[21, 21]")
    result = call("run", "spheres", *both)
    assert result.exit_code == 2
    assert "only one of grid and accuracy" in result.stderr
