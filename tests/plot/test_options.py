"""Titles, widths and measured points of figures, and former names."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.image import imread

from tests.plot import strip_theory as strips
from tractive_sam import plot
from tractive_sam.plot.figure import change_options


@pytest.mark.slow
def test_figures_have_the_width_of_a_column(tmp_path):
    curves, one = strips.history(stored=()), strips.history(stored=(0,))
    maps = replace(one, values={name: rows[:1] for name, rows in one.values.items()})
    options = {"dpi": 100, "width": 84.0, "titles": False}
    paths = [
        *plot.save_all(curves, tmp_path / "curves", **options),
        *plot.save_all(maps, tmp_path / "maps", **options),
    ]
    widths = {path.stem: imread(path).shape[1] for path in paths}
    assert widths
    # 84 mm at 100 dots an inch, rounded to dots.
    assert list(widths.values()) == pytest.approx([84.0 / 25.4 * 100] * len(widths), abs=2)


def test_titles_are_optional():
    assert plot.pressure(strips.contact()).get_suptitle()
    with change_options(titles=False):
        assert not plot.pressure(strips.contact()).get_suptitle()
        assert not plot.forces(strips.history()).get_suptitle()


def test_measured_points_are_compared_with_their_column(tmp_path):
    history = strips.history()
    file = tmp_path / "measured.csv"
    course, force = history["revolution"], history["Qx_over_P"]
    lines = [f"{at},{value + 0.01}" for at, value in zip(course, force, strict=True)]
    file.write_text("\n".join(["revolution,Qx_over_P", *lines, f"{course[0]},"]))
    measured = plot.Measurements.from_file(file)
    measured.check(history)
    with change_options(measured=measured):
        (axes,) = plot.forces(history).axes
    (label,) = (text for text in axes.get_legend_handles_labels()[1] if "measured" in text)
    assert float(label.split()[-1]) == pytest.approx(0.01, rel=1e-2)


def test_every_measured_column_has_a_figure(tmp_path):
    """Also one that no other figure draws, or of a history with one record."""
    history = strips.history()
    course = history["revolution"]
    measured = plot.Measurements({"revolution": course, "t_gamma": history["t_gamma"] + 2.0})
    with change_options(measured=measured):
        (drawing,) = (one for one in plot.list_figures(history) if "measured" in one.name)
        (axes,) = drawing.draw().axes
    assert drawing.name == "measured-t-gamma"
    assert any("rms of differences 2" in text for text in axes.get_legend_handles_labels()[1])
    assert not any("measured" in one.name for one in plot.list_figures(history))


@pytest.mark.parametrize(
    ("content", "named"),
    [("", "m.csv"), ("revolution\n", "m.csv"), ("revolution,p_max\n1,a\n", "p_max")],
)
def test_files_that_are_no_table_are_refused(content, named, tmp_path):
    (tmp_path / "m.csv").write_text(content)
    with pytest.raises(ValueError, match=named):
        plot.Measurements.from_file(tmp_path / "m.csv")


@pytest.mark.parametrize("names", [("p_max",), ("revolution", "p_mox")])
def test_columns_that_a_history_lacks_are_refused(names):
    measured = plot.Measurements(dict.fromkeys(names, np.zeros(2)))
    with pytest.raises(ValueError, match="revolution" if len(names) == 1 else "p_mox"):
        measured.check(strips.history())


def test_earlier_names_warn():
    with pytest.warns(DeprecationWarning, match="list_figures"):
        assert plot.figures_of is plot.list_figures
    view = plot.ContactView.from_source(strips.contact())
    with pytest.warns(DeprecationWarning, match="position"):
        assert view.place == view.position
