"""Fits: measured values with the model, residuals, and confidence ellipses."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tractive_sam.description import ShortArrays
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.study import Variable
from tractive_sam.plot.style import LOOK, apply_style, new_axes, new_figure, set_title


@dataclass(frozen=True, eq=False, repr=False)
class FittedCurve(ShortArrays):
    """Measured values of one observation beside the fitted model, to be drawn.

    Attributes
    ----------
    x : Variable
        The quantity that varies, n values.
    observed : Variable
        Measured values.
    noise, predicted, band, residual : ndarray, shape (n,)
        Standard deviation of the measurement, prediction, its standard deviation due to the
        parameters, and residual over the noise. A noise of shape (2, n) has the lengths of the
        error bars downwards and upwards.
    between : ndarray, shape (3, m), optional
        Further values of x with the prediction and its standard deviation there.

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
    between: np.ndarray | None = None

    @property
    def line(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Ascending abscissas of the model, its predictions, and their standard deviations."""
        x, predicted, band = self.x.places, self.predicted, self.band
        if self.between is not None:
            values, more, spread = self.between
            x = np.append(x, replace(self.x, values=values).places)
            predicted, band = np.append(predicted, more), np.append(band, spread)
        order = np.argsort(x)
        return x[order], predicted[order], band[order]


@apply_style
def fitted_curve(curve: FittedCurve, *, title: str = "") -> Figure:
    """Draw measured values with error bars, the model with its band of 95 %, and residuals.

    Axes are logarithmic if all values are positive and span a factor of 30.

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
    places, points = curve.x.places, curve.observed.values
    x, model, band = curve.line
    reach = 1.96 * band
    upper.fill_between(x, model - reach, model + reach, color=LOOK.blue, alpha=0.2, linewidth=0,
                       label="model, 95 %")  # fmt: skip
    many = places.size > 40
    size = 2.0 if many else 4.0
    upper.plot(x, model, color=LOOK.blue, zorder=3 if many else 2, label="model")
    upper.errorbar(places, points, curve.noise, fmt="s", color=LOOK.vermillion,
                   markersize=size, elinewidth=0.8, capsize=2, label="measured")  # fmt: skip
    upper.set_ylabel(curve.observed.label)
    upper.legend()
    lower.axhspan(-1.96, 1.96, color=LOOK.grey, alpha=0.15, linewidth=0)
    lower.axhline(0.0, color=LOOK.grey, linewidth=0.8)
    lower.plot(places, curve.residual, "s", color=LOOK.vermillion, markersize=size)
    limit = max(2.5, 1.2 * np.abs(curve.residual).max())
    lower.set(xlabel=curve.x.label, ylabel="residual / noise", ylim=(-limit, limit))
    if _spans_decades(places):
        lower.set_xscale("log")
    if _spans_decades(points - np.atleast_2d(curve.noise)[0]):
        upper.set_yscale("log")
    figure.align_ylabels()
    set_title(figure, title)
    return figure


def _spans_decades(values: np.ndarray) -> bool:
    """Return whether all values are positive, and the largest is 30 times the smallest."""
    return bool(values.min() > 0.0 and values.max() > 30.0 * values.min())


@apply_style
def profile_likelihood(
    name: str, values: np.ndarray, rise: np.ndarray, limit: float, *, title: str = ""
) -> Figure:
    """Draw the rise of chi-square over a parameter, and the limit that sets its interval.

    Parameters
    ----------
    name : str
        The parameter.
    values, rise : ndarray, shape (n,)
        Values of the parameter in rising order, and the rise of chi-square with all others fitted.
    limit : float
        Rise at the ends of the interval.

    Examples
    --------
    >>> rise = np.array([3.8, 0.0, 3.9])
    >>> plot.profile_likelihood("friction.mu", np.array([0.43, 0.46, 0.49]), rise, 3.84)
    <Figure size ...>
    """
    figure, axes = new_axes(title=title)
    # Signed roots of the rise are nearly straight: their squares give the curve between points.
    roots = np.sqrt(rise) * np.where(np.arange(rise.size) < rise.argmin(), -1.0, 1.0)
    x = np.linspace(values[0], values[-1], 101)
    axes.plot(x, np.square(np.interp(x, values, roots)), color=LOOK.blue)
    axes.plot(values, rise, "o", color=LOOK.blue, markersize=4)
    axes.axhline(limit, color=LOOK.grey, linewidth=0.8, linestyle="--")
    axes.annotate(f"interval ends at {limit:.3g}", (0.5, limit), (0, -4), ha="center", va="top",
                  xycoords=("axes fraction", "data"), textcoords="offset points",
                  fontsize=9)  # fmt: skip
    axes.set(xlabel=name, ylabel="rise of chi-square", ylim=(0.0, 1.15 * max(limit, rise.max())))
    return figure


@apply_style
def confidence_ellipses(
    names: Sequence[str],
    values: np.ndarray,
    deviations: np.ndarray,
    correlation: np.ndarray,
    *,
    title: str = "",
    limits: tuple[np.ndarray, np.ndarray] | None = None,
    most: int = 5,
) -> Figure:
    """Draw the 68 and 95 % ellipses of each pair of fitted parameters, up to the fifth one.

    Predictions are linear in the values, as for linearised intervals: the axes are linear.

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
    limits : tuple of ndarray, shape (n,), optional
        Lower and upper bounds of the values, at which ellipses end.
    most : int
        Most parameters that are drawn.

    Examples
    --------
    >>> correlation = np.array([[1.0, 0.2], [0.2, 1.0]])
    >>> sizes = np.array([0.4, 1e-6]), np.array([0.02, 2e-7])
    >>> plot.confidence_ellipses(["friction.mu", "friction.layer"], *sizes, correlation)
    <Figure size ...>
    """
    count, infinite = min(len(names), most), np.full(len(names), np.inf)
    side = max(1.0, 0.45 * (count - 1))
    figure = new_figure(side, 0.8 * side)
    panels = figure.subplots(count - 1, count - 1, squeeze=False)
    for row in range(1, count):
        for column in range(count - 1):
            axes = panels[row - 1, column]
            if column >= row:
                axes.set_axis_off()
                continue
            pair = [column, row]
            _ellipses(axes, values[pair], deviations[pair], float(correlation[column, row]),
                      [limit[pair, None] for limit in limits or (-infinite, infinite)])  # fmt: skip
            axes.locator_params(nbins=5)
            if row == count - 1:
                axes.set_xlabel(names[column])
            if column == 0:
                axes.set_ylabel(names[row])
    handles, labels = panels[0, 0].get_legend_handles_labels()
    if count > 2:
        panels[0, -1].legend(handles, labels, loc="center")
    else:  # an ellipse leaves these corners empty
        corner = "upper left" if correlation[0, 1] >= 0.0 else "upper right"
        panels[0, 0].legend(loc=corner, fontsize=9, borderaxespad=0.2)
    set_title(figure, title)
    return figure


def _ellipses(
    axes: Any, centre: np.ndarray, deviations: np.ndarray, correlation: float, limits: Any
) -> None:
    """Draw the 68 and 95 % ellipses of two parameters, within limits of shape (2, 1)."""
    matrix = np.array([[1.0, correlation], [correlation, 1.0]])
    sizes, vectors = np.linalg.eigh(matrix)
    # Radii of the circles that hold 68 and 95 % of a normal distribution of two variables.
    for share, radius in {0.68: 1.51, 0.95: 2.45}.items():
        turn = np.linspace(0.0, 2.0 * np.pi, 181)
        circle = radius * np.sqrt(np.maximum(sizes, 0.0))[:, None] * [np.cos(turn), np.sin(turn)]
        ring = centre[:, None] + deviations[:, None] * (vectors @ circle)
        x, y = np.clip(ring, *limits)
        axes.plot(x, y, color=LOOK.blue, linewidth=1.4 if share < 0.9 else 0.8,
                  label=f"{share:.0%}")  # fmt: skip
    axes.plot(*centre, "+", color=LOOK.vermillion, label="estimate")
    axes.set_title(f"correlation {correlation:.2f}", loc="right", fontsize=9)
