"""Figures of studies: what is drawn along their axes."""

import numpy as np
import pytest

from tests.plot.rendering import render
from tractive_sam import plot

XI = np.array([-0.004, -0.003, -0.001])
FORCE = plot.Variable("Qx_over_P", np.array([0.3, 0.25, 0.1]), unit="1")


@pytest.mark.parametrize("name", ["creepage.longitudinal", "duty[0].creepage.lateral"])
def test_forces_rise_with_creepage_from_the_origin_to_the_right(name):
    (axes,) = render(plot.study_curves(plot.Variable(name, XI), FORCE)).axes
    (curve,) = axes.lines
    np.testing.assert_allclose(curve.get_xdata(), [0.1, 0.3, 0.4])  # per cent
    assert np.all(np.diff(curve.get_ydata()) > 0.0)
    assert axes.get_xlim()[0] <= 0.0
    assert axes.get_ylim()[0] <= 0.0
    assert axes.get_xlabel().startswith(r"$-$$\xi_")
    assert "(%)" in axes.get_xlabel()


def test_pressure_over_creepage_does_not_shrink_to_a_line():
    pressure = plot.Variable("p_max", np.array([1000.0, 1001.0, 1002.0]), unit="MPa")
    (axes,) = render(plot.study_curves(plot.Variable("creepage.longitudinal", XI), pressure)).axes
    assert axes.get_ylim()[0] > 999.0


def test_other_creepages_are_reported_alike():
    load = plot.Variable("load.normal", np.array([100.0, 200.0]))
    xi = plot.Variable("creepage.longitudinal", XI)
    force = plot.Variable("Qx_over_P", np.tile(FORCE.values, (2, 1)))
    curves = render(plot.study_curves(load, force, xi))
    legend = curves.axes[0].get_legend()
    assert [one.get_text() for one in legend.get_texts()] == ["0.4", "0.3", "0.1"]
    axes, _ = render(plot.study_map(load, xi, force)).axes
    assert [one.get_text() for one in axes.get_yticklabels()] == ["0.1", "0.3", "0.4"]
    assert legend.get_title().get_text() == axes.get_ylabel() == xi.label


def test_courses_of_creepage_keep_their_words():
    course = plot.Variable("creepage.longitudinal", np.array(["0 to -0.001", "0 to -0.002"]))
    assert course.label == r"$\xi_x$"
    assert course.texts == ["0 to -0.001", "0 to -0.002"]


def test_the_distribution_of_samples_rises_to_its_percentiles():
    values = np.append(np.linspace(1.0, 2.0, 101)[::-1], np.nan)  # a failed sample
    quantiles = np.array([[1.05, 1.5], [-np.inf, 1.4], [1.1, 1.6]])
    axes = plot.sample_distribution(values, np.array([5.0, 50.0]), quantiles, "p (MPa)").axes[0]
    x, shares = axes.lines[0].get_data()
    np.testing.assert_allclose(np.interp([1.25, 1.5], x, shares), [25.25, 50.0], atol=0.1)
    ends = [segment[:, 0] for segment in axes.collections[0].get_segments()]
    np.testing.assert_allclose(ends, [[1.0, 1.1], [1.4, 1.6]])  # cut off at the samples
    arrows = {line.get_marker(): line.get_xdata() for line in axes.lines}
    np.testing.assert_allclose(arrows["<"], [1.0])
    assert not arrows[">"].size
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("p (MPa)", "share of samples below (%)")


def test_a_key_with_its_largest_value_at_the_median_is_not_the_last_cause():
    ends = np.array([[0.5, 0.98], [0.5, 1.02]])
    figure = plot.scatter_causes(["y", "z"], ends, 1.0, ["y"], {"linear": np.ones(1)}, "u")
    assert [text.get_text() for text in figure.axes[0].get_yticklabels()] == ["z", "y"]  # upwards
