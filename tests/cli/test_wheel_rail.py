import json
import os
import subprocess
import sys

import numpy as np
import pytest

from tractive_sam.rail import ConicityCheck

SMALL = ("--set", "grid.elements=[15, 15]")


@pytest.mark.slow
def test_locus_writes_a_table_and_figures(call, folder):
    result = call("locus", "wheel-rail", "-o", "l.csv", "--reach", 4, "--positions", 9)
    assert result.exit_code == 0
    assert "equivalent conicity at 3 mm" in result.output
    table = np.genfromtxt(folder / "l.csv", delimiter=",", names=True)
    assert {*np.linspace(-4.0, 4.0, 9)} < {*table["y"]}  # and the sides of jumps
    assert table["radius_difference"] == pytest.approx(-table["radius_difference"][::-1], abs=1e-8)
    assert {file.name for file in folder.glob("*.png")} == {
        "l-points.png",
        "l-radii.png",
        "l-conicity.png",
    }


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("spheres",), "wheelset"),
        (("wheel-rail", "--amplitude", 7, "--positions", 5), "amplitude"),
        (("wheel-rail", "--reach", 90), "contact"),
        (("wheel-rail", "--set", "wheel.profile=S1003"), "S1002"),
    ],
)
def test_faults_of_a_locus(call, arguments, text):
    result = call("locus", *arguments, "-o", "l.csv")
    assert result.exit_code == 2
    assert text in result.output


@pytest.mark.slow
def test_a_check_writes_a_table_and_a_figure(call, folder):
    result = call("locus", "--check", "EN15302", "-o", "c.csv", "--width", "84mm")
    assert result.exit_code == 0
    text = " ".join(result.output.split())
    assert "592 of 594 conicities are within the tolerance, 2 differ with a reason" in text
    assert "from 0.0250 to 0.0257" in text  # roll
    table = np.genfromtxt(folder / "c.csv", delimiter=",", names=True)
    assert [(table["case"] == k).sum() for k in (1, 9)] == [66 + 59, 66 + 58]
    assert (table["agrees"] == 0.0).sum() == 2
    assert (folder / "c-check.png").exists()


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("--check", "EN13674"), "allowed: EN15302"),
        (("wheel-rail", "--check", "EN15302"), "omit SCENE"),
        (("--check", "EN15302", "--set", "wheelset.y=1.0"), "omit SCENE"),
        (("-o", "l.csv"), "SCENE is missing"),
        (("wheel-rail",), "--output is missing"),
    ],
)
def test_faults_of_a_check(call, arguments, text):
    result = call("locus", *arguments)
    assert result.exit_code == 2
    assert text in " ".join(result.output.split())


def test_a_check_that_differs_ends_with_status_3(call, monkeypatch):
    values = (np.array([number]) for number in (2.0, 0.1, 0.01, 0.2))
    wrong = ConicityCheck("E1: x", "from profiles", *values, ("",))
    monkeypatch.setattr("tractive_sam.validation.check_locus", lambda standard: [wrong])
    result = call("locus", "--check", "EN15302")
    assert result.exit_code == 3
    assert "differs" in result.output


@pytest.mark.slow
def test_wear_writes_profiles(call, folder):
    settings = ("--set", "wear.revolutions=1000", *SMALL)
    result = call("wear", "wheel-wear", *settings, "-o", "worn")
    assert result.exit_code == 0
    names = {file.name for file in (folder / "worn").iterdir()}
    assert names == {"wear.h5", "wheel-1000.prw", "rail-1000.prr", "wear.csv", "profiles.png"}
    worn = ("--set", "wheel.profile=worn/wheel-1000.prw", *SMALL)
    assert call("run", "wheel-rail", *worn, "-o", "a.h5").exit_code == 0


def test_wear_needs_its_tables(call, folder):
    result = call("wear", "wheel-rail", "-o", "worn")
    assert result.exit_code == 2
    assert "wear" in result.output
    assert not (folder / "worn").exists()


@pytest.mark.slow
def test_worn_profiles_have_figures_and_a_report(call, folder):
    settings = ("--set", "wear.revolutions=5000", *SMALL)
    assert call("explain", "wheel-wear", *settings).exit_code == 0
    assert call("run", "wheel-wear", *settings, "-o", "a.h5").exit_code == 0
    shown = json.loads(call("show", "a.h5", "--json").stdout)
    assert shown["status"] == "done"
    assert shown["worn_section"]["B"][-1] > 0.0
    assert call("plot", "a.h5", "-o", "figures").exit_code == 0
    figures = {file.name for file in (folder / "figures").iterdir()}
    assert {"wheel-rail-profiles.png", "worn-sections.png"} <= figures
    assert call("report", "a.h5", "-o", "a.html").exit_code == 0
    assert call("wear", "a.h5", "-o", "worn").exit_code == 0
    assert (folder / "worn" / "wheel-5000.prw").exists()
    assert call("run", "wheel-wear", *settings, "-o", "a.h5", "--resume").exit_code == 0


@pytest.mark.slow
def test_results_of_a_wheel_have_its_columns(call):
    assert call("run", "wheel-rail", *SMALL, "-o", "a.h5").exit_code == 0
    shown = json.loads(call("show", "a.h5", "--json").stdout)
    assert shown["patches"] == [1]
    again = call("run", "wheel-rail", *SMALL, "-o", "a.h5")
    assert again.exit_code == 2
    assert "complete" in again.output  # although a wheel may have more patches
    assert shown["contact_angle"][0] < 0.0
    assert call("plot", "a.h5", "-o", "figures").exit_code == 0
    assert call("explain", "wheel-flange").exit_code == 0


def test_a_figure_that_fails_does_not_end_a_command(call, folder, monkeypatch):
    def fail(*_):
        raise ValueError("no curve")

    monkeypatch.setattr("tractive_sam.plot.radius_difference", fail)
    result = call("locus", "wheel-rail", "-o", "l.csv", "--reach", 1, "--positions", 3)
    assert result.exit_code == 2  # the amplitude of 3 mm leaves the positions
    arguments = ("--reach", 4, "--positions", 3)
    result = call("locus", "wheel-rail", "-o", "l.csv", *arguments)
    assert result.exit_code == 0
    assert "l-radii.png is omitted: no curve" in " ".join(result.output.split())
    names = {file.name for file in folder.iterdir()}
    assert names == {"l.csv", "l-points.png", "l-conicity.png"}


@pytest.mark.slow
def test_figures_need_no_backend(folder):
    code = "from tractive_sam.cli.program import run_program; run_program()"
    arguments = ["locus", "wheel-rail", "-o", "l.csv", "--reach", "4", "--positions", "3"]
    environment = {**os.environ, "MPLBACKEND": "Qt4Agg"}
    command = [sys.executable, "-c", code, *arguments]
    subprocess.run(command, check=True, env=environment, cwd=folder, capture_output=True)
    assert (folder / "l-conicity.png").exists()
