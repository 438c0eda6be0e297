"""Fits: measured values with the model, residuals, and confidence ellipses."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tractive_sam.description import ShortArrays
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.study import Variable
from tractive_sam.plot.style import LOOK, apply_style, new_figure, set_title


@dataclass(frozen=True, eq=False, repr=False)
class FittedCurve(ShortArrays):
    """Measured values of one observation, and the fitted model.

    Attributes
    ----------
    x : Variable
        What varies, n values.
    observed : Variable
        Measured values.
    noise, predicted, band, residual : ndarray, shape (n,)
        Standard deviation of the measurement, prediction, its standard deviation by that of the
        parameters, and residual over the noise.

    Examples
    --------
    >>> x = plot.Variable("revolution", np.array([1e3, 1e4]))
    >>> worn = plot.Variable("worn_mass A", np.array([0.3, 2.9]), "worn mass of A", "mg")
    >>> ones = np.ones(2)
    >>> curve = plot.FittedCurve(x, worn, 0.1 * ones, np.array([0.29, 3.0]), 0.05 * ones, ones)
    """

    x: Variable
    observed: Variable
    noise: np.ndarray
    predicted: np.ndarray
    band: np.ndarray
    residual: np.ndarray


@apply_style
def fitted_curve(curve: FittedCurve, *, title: str = "") -> Figure:
    """Measured values with error bars, the model with its band of 95 %, and residuals.

    Examples
    --------
    >>> x = plot.Variable("revolution", np.array([1e3, 1e4]))
    >>> worn = plot.Variable("worn_mass A", np.array([0.3, 2.9]), "worn mass of A", "mg")
    >>> ones = np.ones(2)
    >>> curve = plot.FittedCurve(x, worn, 0.1 * ones, np.array([0.29, 3.0]), 0.05 * ones, ones)
    >>> plot.fitted_curve(curve)
    <Figure size ...>
    """
    figure = new_figure(1.0, 0.95)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1))
    order = np.argsort(curve.x.places)
    x = curve.x.places[order]
    model, reach = curve.predicted[order], 1.96 * curve.band[order]
    upper.fill_between(x, model - reach, model + reach, color=LOOK.blue, alpha=0.2, linewidth=0,
                       label="95 % of the model")  # fmt: skip
    marker = "-" if x.size > 40 else "o-"
    upper.plot(x, model, marker, color=LOOK.blue, markersize=3, label="model")
    size = 2.0 if x.size > 40 else 4.0
    points = curve.observed.values[order]
    upper.errorbar(x, points, curve.noise[order], fmt="s", color=LOOK.vermillion,
                   markersize=size, elinewidth=0.8, capsize=2, label="measured")  # fmt: skip
    upper.set_ylabel(curve.observed.label)
    upper.legend()
    lower.axhspan(-1.96, 1.96, color=LOOK.grey, alpha=0.15, linewidth=0)
    lower.axhline(0.0, color=LOOK.grey, linewidth=0.8)
    lower.plot(x, curve.residual[order], "s", color=LOOK.vermillion, markersize=size)
    lower.set(xlabel=curve.x.label, ylabel="residual\nover noise")
    if curve.x.logarithmic:
        lower.set_xscale("log")
    set_title(figure, title)
    return figure


@apply_style
def confidence_ellipses(
    names: Sequence[str],
    values: np.ndarray,
    deviations: np.ndarray,
    correlation: np.ndarray,
    *,
    title: str = "",
    most: int = 5,
) -> Figure:
    """Ellipses that hold 68 and 95 % of each pair of fitted parameters.

    Parameters
    ----------
    names : sequence of str
        Keys of n parameters, at least two.
    values, deviations : ndarray, shape (n,)
        Estimates and standard deviations.
    correlation : ndarray, shape (n, n)
        Correlation.
    title : str
        Title of the figure.
    most : int
        Most parameters that are drawn.

    Examples
    --------
    >>> correlation = np.array([[1.0, 0.2], [0.2, 1.0]])
    >>> sizes = np.array([0.4, 1e-6]), np.array([0.02, 2e-7])
    >>> plot.confidence_ellipses(["friction.mu", "friction.layer"], *sizes, correlation)
    <Figure size ...>
    """
    count = min(len(names), most)
    side = max(1.0, 0.45 * (count - 1))
    figure = new_figure(side, 0.8 * side)
    panels = figure.subplots(count - 1, count - 1, squeeze=False)
    for row in range(1, count):
        for column in range(count - 1):
            axes = panels[row - 1, column]
            if column >= row:
                axes.set_axis_off()
                continue
            _ellipses(axes, values[[column, row]], deviations[[column, row]],
                      float(correlation[column, row]))  # fmt: skip
            if row == count - 1:
                axes.set_xlabel(names[column])
            if column == 0:
                axes.set_ylabel(names[row])
    set_title(figure, title)
    return figure


def _ellipses(axes, centre: np.ndarray, deviations: np.ndarray, correlation: float) -> None:
    """Draw the ellipses of two parameters."""
    matrix = np.array([[1.0, correlation], [correlation, 1.0]])
    sizes, vectors = np.linalg.eigh(matrix)
    # Radii of the circles that hold 68 and 95 % of a normal distribution of two variables.
    for share, radius in {0.68: 1.51, 0.95: 2.45}.items():
        turn = np.linspace(0.0, 2.0 * np.pi, 181)
        circle = radius * np.sqrt(np.maximum(sizes, 0.0))[:, None] * [np.cos(turn), np.sin(turn)]
        x, y = centre[:, None] + deviations[:, None] * (vectors @ circle)
        axes.plot(x, y, color=LOOK.blue, linewidth=1.4 if share < 0.9 else 0.8)
    axes.plot(*centre, "+", color=LOOK.vermillion)
    axes.annotate(f"{correlation:.2f}", (0.04, 0.9), xycoords="axes fraction", fontsize=9)
