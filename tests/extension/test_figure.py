"""A figure of another package: of a user-defined column, saved, on the page, and of the command
line."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import tractive_sam as ts

MEAN = ts.Quantity(
    "p_mean",
    "MPa",
    "mean contact pressure",
    lambda contact: contact.pressure[contact.touching].mean(),
)


@ts.plot.history_figure("mean-pressure", columns=["p_mean"])
def mean_pressure(history):
    """Mean contact pressure, over the course.

    What follows is no part of the caption.
    """
    figure = ts.plot.Figure()
    axes = figure.add_subplot(ylabel="mean contact pressure (MPa)")
    axes.plot(history[history.coordinate.name], history["p_mean"])
    return figure


RECORDED = ts.plot.Need(lambda state: "p_mean" in state.columns, "the column p_mean")


@ts.plot.contact_figure("pressure-over-mean", needs=[RECORDED])
def pressure_over_mean(state):
    """Pressure in the middle row of elements, over its mean."""
    pressure = state.contact.pressure
    figure = ts.plot.Figure()
    figure.add_subplot().plot(state.x, pressure[:, len(state.y) // 2] / MEAN.of(state.contact))
    return figure


OWN = {"pressure-over-mean-0", "pressure-over-mean-4", "mean-pressure"}
DISCS = ts.Scene.builtin("twin-discs").with_set(
    ["grid.elements=[15, 31]", "wear.revolutions=4", "wear.save=[0, 4]"]
)
DISCS = DISCS.replace(subsurface=None)


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("figure") / "discs.h5"
    ts.roll(DISCS, path, columns=[MEAN])
    return path


@pytest.fixture(scope="module")
def history(path):
    return ts.open_history(path)


def test_it_is_among_the_figures_of_a_history_that_has_its_column(history):
    found = {one.name: one for one in ts.plot.list_figures(history)}
    assert set(found) >= OWN
    assert found["mean-pressure"].caption == "Mean contact pressure, over the course."
    (line,) = found["mean-pressure"].draw().axes[0].lines
    np.testing.assert_array_equal(line.get_ydata(), history["p_mean"])
    plain = {one.name for one in ts.plot.list_figures(ts.roll(DISCS))}
    assert plain == set(found) - OWN


def test_a_call_where_it_does_not_apply_says_what_is_needed():
    plain = ts.roll(DISCS)
    for draw in (mean_pressure, pressure_over_mean):
        with pytest.raises(ValueError, match=rf"{draw.__name__}.*p_mean"):
            draw(plain)


def test_each_block_of_a_duty_cycle_has_it():
    blocks = ({"revolutions": 1}, {"revolutions": 1, "load": {"normal": 300.0}})
    cycle = ts.roll(DISCS.replace(duty=blocks), columns=[MEAN])
    assert "mean-pressure" not in {one.name for one in ts.plot.list_figures(cycle)}
    (line,) = mean_pressure(cycle.block(1)).axes[0].lines
    np.testing.assert_array_equal(line.get_ydata(), cycle["block_p_mean"][:, 1])
    assert "mean-pressure" in {one.name for one in ts.plot.list_figures(cycle.block(1))}


@pytest.mark.slow
def test_the_report_shows_it(history, tmp_path):
    pytest.importorskip("plotly", reason="plotly is of the extra report")
    page = ts.report(history, tmp_path / "discs.html").read_text("utf-8")
    assert page.count("Mean contact pressure, over the course.</figcaption><img ") == 1
    assert page.count("Pressure in the middle row of elements, over its mean.") == 2


@pytest.mark.slow
def test_the_command_line_finds_it_installed(path, tmp_path):
    about = tmp_path / "installed" / "means-1.0.dist-info"
    about.mkdir(parents=True)
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: means\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(f"[tractive_sam.figures]\nmeans = {__name__}\n")
    folders = os.pathsep.join(map(str, (about.parent, Path(__file__).parents[2])))
    command = [sys.executable, "-m", "tractive_sam", "plot", str(path), "--dpi", "20"]
    environment = os.environ | {"PYTHONPATH": folders}
    subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, check=True)
    assert {one.stem for one in (tmp_path / "discs-figures").iterdir()} >= OWN


@pytest.mark.parametrize("name", ["", "../elsewhere", "a b", ".hidden"])
def test_what_is_no_name_of_a_file_is_refused(name):
    with pytest.raises(ValueError, match="name"):
        ts.plot.history_figure(name)(mean_pressure)


def test_a_figure_without_caption_and_a_name_that_is_taken_are_refused():
    def forces(history):
        raise AssertionError(history)

    with pytest.raises(ValueError, match=r"other.*caption"):
        ts.plot.history_figure("other")(forces)
    forces.__doc__ = "Forces, drawn otherwise."
    with pytest.raises(ValueError, match="forces"):
        ts.plot.history_figure("forces")(forces)
