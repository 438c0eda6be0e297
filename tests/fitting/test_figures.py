"""Figures of a fit: what is drawn between measured points, and axes over decades."""

import numpy as np
import pytest

import tractive_sam as ts
from tests.fitting.conftest import creep_data
from tractive_sam import plot
from tractive_sam.fitting import fit_figures


@pytest.fixture(scope="module")
def found(spheres):
    data = creep_data(spheres, {"friction.mu": 0.35})
    design = {"scene": spheres, "free": ["friction.mu"], "data": [data], "mesh_check": False}
    return ts.fit(design | {"intervals": "profile", "curve": 9})


@pytest.mark.slow
def test_model_is_computed_between_measured_points(found, spheres):
    _, x, predicted, deviation = found.dataset["curve"].values.T
    assert 4 <= x.size <= 9
    assert not set(x) & set(found.dataset["abscissa"].values)
    scene = found.scene.replace(**{"creepage.longitudinal": x[0]})
    expected = ts.solve(scene)
    # each contact is solved to the tolerance of the scene, from another first guess
    assert predicted[0] == pytest.approx(expected.Qx / expected.P, rel=1e-6)
    assert deviation.min() > 0.0
    (axes, _) = next(fit_figures(found)).draw().axes
    assert axes.lines[0].get_xdata().size == 4 + x.size


def test_profile_likelihood_reaches_its_limit(found):
    names = [drawing.name for drawing in fit_figures(found)]
    assert names == ["data0-Qx_over_P", "likelihood-friction.mu"]
    values, rise = found.dataset["likelihood"].values[:, 1:].T
    for end in found.interval("friction.mu"):
        at_end = rise[np.abs(values - end).argmin()]
        assert at_end == pytest.approx(3.84, rel=0.05)  # ends are found to 2 % of the root


def curve(points):
    x = plot.Variable("revolution", np.array([1.0, 2.0, 3.0]))
    ones = np.ones(3)
    points = np.array(points)
    return plot.FittedCurve(x, plot.Variable("Qx", points), 0.1 * ones, points, 0.01 * ones, ones)


def test_values_over_decades_have_a_logarithmic_axis():
    scales = [plot.fitted_curve(curve(p)).axes[0].get_yscale()
              for p in ([1.0, 2.0, 3.0], [1.0, 9.0, 90.0], [-1.0, 9.0, 90.0])]  # fmt: skip
    assert scales == ["linear", "log", "linear"]


def test_error_bars_of_a_factor_are_equally_long_on_a_logarithmic_axis(spheres):
    noise = {"factor": 2.0}
    data = creep_data(spheres, {"friction.mu": 0.35}, noise=noise)
    design = {"scene": spheres, "free": ["friction.mu"], "data": [data], "mesh_check": False}
    figure = next(fit_figures(ts.fit(design | {"curve": 0}))).draw()
    (bars,) = figure.axes[0].containers
    ends = np.array([segment[:, 1] for segment in bars[2][0].get_segments()])
    values = data["values"]["Qx_over_P"]
    np.testing.assert_allclose(ends, np.stack([values / 2.0, values * 2.0], axis=1))


def test_every_residual_is_within_its_panel():
    one = curve([1.0, 2.0, 3.0])
    one.residual[1] = 7.0
    low, high = plot.fitted_curve(one).axes[1].get_ylim()
    assert low < -7.0
    assert high > 7.0


def test_ellipses_end_at_the_bounds_of_their_parameters():
    values, deviations, correlation = np.array([0.1, 1.0]), np.array([0.2, 0.5]), np.eye(2)
    limits = np.array([0.0, -np.inf]), np.array([0.3, np.inf])
    figure = plot.confidence_ellipses(["a", "b"], values, deviations, correlation, limits=limits)
    x, y = np.concatenate([line.get_xydata() for line in figure.axes[0].lines]).T
    assert (x.min(), x.max()) == (0.0, 0.3)
    assert y.min() < 0.0


def test_ellipses_state_how_many_parameters_they_leave_out():
    names = [f"p{k}" for k in range(6)]
    for count, texts in ((5, [""]), (6, ["5 of 6\nparameters"])):
        sizes = np.ones(count), np.ones(count)
        figure = plot.confidence_ellipses(names[:count], *sizes, np.eye(count))
        legends = [axes.get_legend() for axes in figure.axes]
        assert [one.get_title().get_text() for one in legends if one] == texts
