"""Figures of studies, tables of creep forces and fits: results over parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import cycle
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike

from tractive_sam.description import ShortArrays, format_with_unit
from tractive_sam.lookup import CreepTable
from tractive_sam.plot.figure import LOOK, Figure, apply_style, new_axes, new_figure, set_title

LABELS = {
    "Qx": "$Q_x$",
    "Qy": "$Q_y$",
    "Mz": "$M_z$",
    "Qx_over_P": "$Q_x/P$",
    "Qy_over_P": "$Q_y/P$",
    "p_max": "peak contact pressure",
    "p_95": "pressure exceeded by 5 % of the load",
    "wear_max": "largest wear depth",
    "creepage.longitudinal": r"$\xi_x$",
    "creepage.lateral": r"$\xi_y$",
    "creepage.spin": r"$\phi$",
    "friction.mu": r"$\mu$",
    "friction.angle": r"$\beta$",
    "load.normal": "$P$",
    "load.pressure": "$p_0$",
}
"""Symbols and short names of quantities and keys of a scene. Units belong to the variable, as they
differ between line contacts and others."""


@dataclass(frozen=True, eq=False)
class Variable:
    """Values along one axis of a figure of a study, with meaning and unit.

    Creepages are drawn with the sign of the force and in per cent, so that curves rise to the
    right.

    Attributes
    ----------
    name : str
        Name of the quantity, or key of the scene.
    values : ndarray
        Numbers, or texts, which are drawn at equal distances.
    meaning : str
        Label of a variable that is not among `LABELS`.
    unit : str
        Unit, unless it is part of the meaning; "1" stands for none.
    longest : int
        Most letters of a line of its label.

    Examples
    --------
    >>> mu = plot.Variable("friction.mu", np.array([0.1, 0.3, 0.9]))
    >>> mu.numeric, mu.logarithmic
    (True, False)
    """

    name: str
    values: np.ndarray
    meaning: str = ""
    unit: str = ""
    longest: int = 40

    @property
    def label(self) -> str:
        """Label of the axis."""
        block, bracket, key = self.name.rpartition("].")
        label = LABELS.get(key) or self.meaning or self.name
        unit = self.unit
        if self.is_creepage:
            label, unit = f"$-${label}", "%"
        if bracket and key in LABELS:
            label = f"{label} of {block}]"
        return fill(format_with_unit(label, unit), self.longest)

    @property
    def is_creepage(self) -> bool:
        """Whether the variable is a longitudinal or lateral creepage with numeric values."""
        creepages = ("creepage.longitudinal", "creepage.lateral")
        return self.numeric and self.name.rpartition("].")[2] in creepages

    @property
    def numeric(self) -> bool:
        """Whether the values are numbers."""
        return self.values.dtype.kind in "iuf"

    @property
    def places(self) -> np.ndarray:
        """Positions of values on the axis: numbers, indices of texts, or -100 times creepages."""
        if not self.numeric:
            return np.arange(self.values.size) * 1.0
        return 0.0 - 100.0 * self.values if self.is_creepage else self.values.astype(float)

    @property
    def texts(self) -> list[str]:
        """Values as texts, in the unit of the axis."""
        if self.numeric:
            return [f"{place:.6g}" for place in self.places]
        return list(map(str, self.values))

    @property
    def logarithmic(self) -> bool:
        """Whether the values are spaced logarithmically, over at least a decade."""
        places = np.sort(self.places)
        if places.size < 3 or places[0] <= 0.0 or places[-1] < 10.0 * places[0]:
            return False
        steps = places[1:] / places[:-1]
        return bool(np.allclose(steps, steps[0], rtol=1e-3))


@apply_style
def study_curves(
    x: Variable, y: Variable, over: Variable | None = None, *, title: str = "", most: int = 10
) -> Figure:
    """Draw a quantity over one key, one curve for each of up to ten values of another key.

    Parameters
    ----------
    x : Variable
        The key, n values.
    y : Variable
        The quantity, shape (n,), or (n, m) with `over`; nan if it is unknown.
    over : Variable, optional
        The other key, m values.
    title : str
        Title of the figure.
    most : int
        Most curves that are drawn.

    Examples
    --------
    >>> mu = plot.Variable("friction.mu", np.array([0.1, 0.2, 0.4]))
    >>> force = plot.Variable("Qx_over_P", np.array([0.1, 0.19, 0.31]))
    >>> plot.study_curves(mu, force)
    <Figure size ...>
    """
    figure = new_figure(1.0, 0.72)
    axes = figure.add_subplot()
    columns = {"": y.values}
    if over is not None:
        shown = np.unique(np.linspace(0, over.values.size - 1, most).astype(int))
        columns = {over.texts[k]: y.values[:, k] for k in shown}
    order = np.argsort(x.places)
    if over is not None:  # colours are ordered, as the values are
        axes.set_prop_cycle(color=colormaps[LOOK.pressure](np.linspace(0.0, 0.9, len(columns))))
    for name, column in columns.items():
        axes.plot(x.places[order], column[order], "o-", label=name, markersize=3.5)
    if over is not None:
        axes.legend(title=over.label)
    _label_axes(axes, x, y)
    forces = ("Qx", "Qy", "Qx_over_P", "Qy_over_P")
    if x.is_creepage and y.name in forces and not x.logarithmic:  # with the origin
        axes.update_datalim([(0.0, 0.0)])
        axes.autoscale_view()
    set_title(figure, title)
    return figure


@apply_style
def study_map(x: Variable, y: Variable, quantity: Variable, *, title: str = "") -> Figure:
    """Draw a quantity over two keys of a scene; cases without a value are grey.

    A key with at most six values has equal fields, each at its value.

    Parameters
    ----------
    x, y : Variable
        The keys, n and m values.
    quantity : Variable
        The quantity, shape (n, m).
    title : str
        Title of the figure.

    Examples
    --------
    >>> mu = plot.Variable("friction.mu", np.array([0.2, 0.4]))
    >>> beta = plot.Variable("friction.angle", np.array([0, 45, 90]))
    >>> force = plot.Variable("Qx_over_P", np.array([[0.19, 0.18, 0.17], [0.31, 0.29, 0.27]]))
    >>> plot.study_map(mu, beta, force)
    <Figure size ...>
    """
    figure = new_figure(1.0, 0.8)
    axes = figure.add_subplot(facecolor="#DDDDDD")
    across, along = np.argsort(x.places), np.argsort(y.places)
    values = np.ma.masked_invalid(quantity.values[np.ix_(across, along)].T)
    x, y = _as_fields(x), _as_fields(y)
    across = x.places[across] if x.numeric else np.arange(across.size)
    along = y.places[along] if y.numeric else np.arange(along.size)
    mesh = axes.pcolormesh(across, along, values, shading="nearest", **_choose_colours(values))
    figure.colorbar(mesh, label=quantity.label)
    _label_axes(axes, x, y)
    set_title(figure, title)
    return figure


@apply_style
def study_samples(variables: Mapping[str, Variable], y: Variable, *, title: str = "") -> Figure:
    """Draw a quantity over each key of a Latin hypercube, one point a sample.

    Examples
    --------
    >>> mu = plot.Variable("friction.mu", np.array([0.13, 0.2, 0.38]))
    >>> force = plot.Variable("Qx_over_P", np.array([0.13, 0.18, 0.3]))
    >>> plot.study_samples({"friction.mu": mu}, force)
    <Figure size ...>
    """
    count = len(variables)
    figure = new_figure(0.7 * min(count, 3), 0.6 * -(-count // 3))
    panels = figure.subplots(-(-count // 3), min(count, 3), sharey=True, squeeze=False)
    for axes in panels.flat[count:]:
        axes.set_axis_off()
    for axes, variable in zip(panels.flat, variables.values(), strict=False):
        axes.plot(variable.places, y.values, "o", markersize=3, color=LOOK.grey)
        _label_axes(axes, variable, y)
        axes.set_xlabel(fill(variable.label, 22), loc="left")  # a power of ten is at the right
    for axes in panels[:, 1:].flat:
        axes.set_ylabel("")
    set_title(figure, title)
    return figure


def _choose_colours(values: np.ma.MaskedArray, negligible: float = 0.02) -> dict[str, Any]:
    """Return colour map and limits for values; white is zero if both signs matter."""
    largest = float(np.abs(values).max()) if values.count() else 0.0
    if values.count() and min(-values.min(), values.max()) > negligible * largest:
        return {"cmap": LOOK.signed, "vmin": -largest, "vmax": largest}
    return {"cmap": LOOK.pressure}


def _as_fields(variable: Variable, few: int = 6) -> Variable:
    """Return a variable with few values as texts, so that nothing is drawn between them."""
    if not variable.numeric or variable.values.size > few:
        return variable
    order = np.argsort(variable.places)
    return Variable("", np.array(variable.texts)[order], variable.label)


def _label_axes(axes: Axes, x: Variable, y: Variable) -> None:
    """Set the labels and ticks of axes from two variables."""
    axes.set(xlabel=x.label, ylabel=y.label)
    if x.logarithmic:
        axes.set_xscale("log")
        if x.values.size <= 6:  # labels between the powers of ten would overlap
            axes.set_xticks(x.places, x.texts)
            axes.xaxis.set_minor_formatter("")
    elif x.numeric:
        axes.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    if not y.numeric:
        axes.set_yticks(y.places, [fill(text, y.longest // 3) for text in y.values])
    if not x.numeric:
        letters = max(x.longest // x.values.size, x.longest // 6)
        axes.set_xticks(x.places, [fill(text, letters) for text in x.values])


MARKERS = "so^Dv"
"""Markers of computed points, in their order."""

Points = tuple[ArrayLike, ArrayLike]
"""Abscissae and ordinates of points."""


@apply_style
def creep_force_curve(
    computed: Mapping[str, Points],
    reference: Mapping[str, Points] | None = None,
    *,
    theory: bool = True,
) -> Figure:
    """Draw scaled creep-force curves of a circular contact, with reference and theory curves.

    Parameters
    ----------
    computed : mapping of str to pair of array_like
        Creep parameters (`reference.creep_parameter`) and forces Q/(mu P), by the label of a
        series.
    reference : mapping of str to pair of array_like, optional
        Points of other programs or of measurements.
    theory : bool
        Whether to draw the curves of Vermeulen & Johnson and of Kalker's simplified theory.

    Examples
    --------
    >>> plot.creep_force_curve({"computed": ([0.2, 0.5], [0.43, 0.82])})
    <Figure size ...>
    """
    reference = reference or {}
    figure, axes = new_axes(1.0, 0.72)
    for marker, (name, (xi, force)) in zip(cycle(MARKERS), computed.items(), strict=False):
        axes.plot(xi, force, marker, label=name, markerfacecolor="none", markeredgewidth=1.2)
    for marker, (name, (xi, force)) in zip(cycle("x+*"), reference.items(), strict=False):
        axes.plot(xi, force, marker, label=name, color=LOOK.grey)
    if theory:
        # Other figures need no reference solutions, whose interpolation takes long to load.
        from tractive_sam.reference import kalker_simplified, vermeulen_johnson  # noqa: PLC0415

        ends = [float(np.max(xi)) for xi, _ in (*computed.values(), *reference.values())]
        xi, grey = np.linspace(0.0, max(1.0, *ends), 201), LOOK.grey
        axes.plot(xi, vermeulen_johnson(xi), "--", color=grey, label="Vermeulen & Johnson (1964)")
        axes.plot(xi, kalker_simplified(xi), "-", color=grey, label="Kalker (1967), simplified")
    axes.set(xlabel=r"$-\xi_x\,16\,G a_0^2\,/\,3\mu P(4-3\nu)$", ylabel=r"$Q/(\mu P)$")
    axes.set_xlim(left=0.0)
    axes.legend(loc="lower right")
    return figure


@apply_style
def traction_curve(computed: Mapping[str, Points], printed: Points | None = None) -> Figure:
    """Draw Q_x/P over creepage with each falling curve's maximum, and printed values of CONTACT.

    Parameters
    ----------
    computed : mapping of str to pair of array_like
        Creepages and Q_x/P, by the label of a curve.
    printed : pair of array_like, optional
        Points of another program.

    Examples
    --------
    >>> curve = ([0.0, 0.01, 0.016, 0.05], [0.0, 0.301, 0.312, 0.285])
    >>> plot.traction_curve({"falling": curve})
    <Figure size ...>
    """
    figure, axes = new_axes(1.0, 0.72)
    highest = 0.0
    for marker, (name, (xi, force)) in zip(cycle(MARKERS), computed.items(), strict=False):
        percent, ratio = 100.0 * np.asarray(xi), np.asarray(force)
        (line,) = axes.plot(percent, ratio, marker + "-", ms=3, label=name)
        top = int(np.argmax(ratio))
        highest = max(highest, float(ratio[top]))
        if ratio[top] > 1.001 * ratio[-1]:
            label = f"top {ratio[top]:.3f} at {percent[top]:.2g} %"
            look: dict[str, Any] = {"textcoords": "offset points", "color": line.get_color()}
            axes.annotate(label, (percent[top], ratio[top]), (8, -34), **look)
    if printed is not None:
        style: dict[str, Any] = {
            "color": LOOK.grey,
            "mec": LOOK.vermillion,
            "label": "CONTACT 25.1, printed",
        }
        axes.plot(100.0 * np.asarray(printed[0]), np.asarray(printed[1]), "x", ms=6, **style)
    axes.set(xlabel=r"creepage $|\xi_x|$ (%)", ylabel=r"$Q_x/P$", xlim=(0.0, None))
    axes.set_ylim(bottom=0.0, top=1.12 * highest)
    axes.legend(loc="lower right")
    return figure


@apply_style
def table_errors(table: CreepTable, *, smallest: float = 1e-6) -> Figure:
    """Draw the errors at the check points against the reported errors, and their distribution.

    Parameters
    ----------
    table : CreepTable
        A table with check points in its file.
    smallest : float
        Smallest error that is drawn; smaller ones are drawn there.

    Raises
    ------
    ValueError
        If the file of the table has no check points.

    Examples
    --------
    >>> plot.table_errors(ts.open_table("steel"))
    <Figure size ...>
    """
    about = table.about
    if "check_errors" not in about:
        raise ValueError("the file of the table has no check points; build the table again")
    errors, reported = (np.maximum(about[key], smallest) for key in ("check_errors", "check_told"))
    tolerance = float(about["tolerance"])
    figure = new_figure(1.7, 0.75)
    left, right = figure.subplots(1, 2)
    names = ("$Q_x$", "$Q_y$", "$M_z/c$")
    for name, error, bar in zip(names, errors.T, reported.T, strict=True):
        left.plot(bar, error, "o", markersize=2.5, label=name)
        share = np.arange(1, len(error) + 1) / len(error)
        right.plot(np.sort(error), share, label=name)
    low, high = smallest, 2.0 * max(reported.max(), errors.max(), tolerance)
    left.plot([low, high], [low, high], color=LOOK.grey, linewidth=0.8)
    left.set(xscale="log", yscale="log", xlim=(min(3e-4, reported.min()), high), ylim=(low, high),
             xlabel=r"reported error, over $\mu P$", ylabel=r"error, over $\mu P$")  # fmt: skip
    right.axvline(tolerance, color=LOOK.grey, linewidth=0.8)
    right.set(xscale="log", xlim=(low, high), ylim=(0.0, 1.0), ylabel="share of points")
    right.set_xlabel(r"error, over $\mu P$ (line: tolerance)")
    right.legend(loc="upper left")
    inside = f"{len(errors)} check points, {about['held_out_inside']:.1%} within"
    set_title(figure, f"{table.title or 'a table'}: {inside} the reported error")
    return figure


@apply_style
def error_over_time(
    points: Mapping[str, tuple[float, float]], uncertainty: float, *, title: str = ""
) -> Figure:
    """Draw the error of levels of a model over their time: what more time buys.

    Parameters
    ----------
    points : mapping of str to (float, float)
        CPU time, s, and relative error of each level, by its name; those named "mesh ..." are
        joined by a line.
    uncertainty : float
        Relative error of the reference: smaller errors are drawn there, in the shaded range.
    title : str
        Title of the figure.

    Examples
    --------
    >>> plot.error_over_time({"closed form": (1e-5, 0.03), "mesh of 9 x 9": (3e-3, 4e-3)}, 1e-4)
    <Figure size ...>
    """
    figure, axes = new_axes(1.25, 0.75, title)
    smallest = max(uncertainty, 1e-6)
    meshes = {name: point for name, point in points.items() if name.startswith("mesh")}
    for name, (seconds, error) in points.items():
        if name not in meshes:
            axes.plot(1e3 * seconds, 100.0 * max(error, smallest), "o", label=name)
    if meshes:
        seconds, errors = np.array([*meshes.values()]).T
        sizes = [name.removeprefix("mesh of ") for name in meshes]
        axes.plot(1e3 * seconds, 100.0 * np.maximum(errors, smallest), "s-", color=LOOK.blue,
                  label=f"meshes, {sizes[0]} to {sizes[-1]}")  # fmt: skip
    axes.set(xscale="log", yscale="log", xlabel="CPU time (ms)", ylabel="error (%)")
    axes.axhspan(axes.get_ylim()[0], 100.0 * smallest, color=LOOK.grey, alpha=0.2, zorder=0)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.18), fontsize="small")
    return figure


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
    size = 1.5 if many else 2.5  # error bars of 2 % are as long
    upper.plot(x, model, color=LOOK.blue, zorder=3 if many else 2, label="model")
    upper.errorbar(places, points, curve.noise, fmt="o", color=LOOK.vermillion, markersize=size,
                   elinewidth=0.8, capsize=0 if many else 2, label="measured")  # fmt: skip
    upper.set_ylabel(curve.observed.label)
    upper.legend()
    lower.axhspan(-1.96, 1.96, color=LOOK.grey, alpha=0.15, linewidth=0)
    lower.axhline(0.0, color=LOOK.grey, linewidth=0.8)
    lower.plot(places, curve.residual, "o", color=LOOK.vermillion, markersize=size)
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

    Predictions are linear in the values, as for linearised intervals: the axes are linear. Above
    each of several panels is the correlation.

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
            is_last, is_first = row == count - 1, column == 0
            axes.locator_params(nbins=5)
            if count > 3:  # numbers at the outer axes only, for all panels of a row or a column
                axes.locator_params(nbins=2)
                axes.tick_params(labelbottom=is_last, labelleft=is_first)
                axes.xaxis.offsetText.set_visible(is_last)
                axes.yaxis.offsetText.set_visible(is_first)
                axes.set_title(f"{correlation[column, row]:.2f}", loc="right", fontsize=7, pad=2.0)
            if is_last:
                # Among small panels, the power of ten is on a line between numbers and label.
                many = count > 3
                name = names[column].replace(".", ".\n") if many else names[column]
                axes.set_xlabel(name, labelpad=12.0 if many else None)
            if is_first:
                axes.set_ylabel(names[row] if count <= 3 else names[row].replace(".", ".\n"))
    handles, labels = panels[0, 0].get_legend_handles_labels()
    if count > 2:
        left_out = f"{count} of {len(names)}\nparameters" if count < len(names) else None
        panels[0, -1].legend(handles, labels, loc="center", title=left_out)
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


@apply_style
def scatter_causes(
    keys: Sequence[str],
    ends: np.ndarray,
    nominal: float,
    causes: Sequence[str],
    shares: Mapping[str, np.ndarray],
    label: str,
    *,
    title: str = "",
) -> Figure:
    """Draw how far uncertain keys move an outcome (tornado), and the share of each cause.

    Parameters
    ----------
    keys : sequence of str
        The d uncertain keys.
    ends : ndarray, shape (2, d)
        The outcome at the low and the high end of each key; nan if it is unknown.
    nominal : float
        The outcome with all keys at their medians.
    causes : sequence of str
        The c independent causes.
    shares : mapping of str to ndarray
        Shares of the variance by the name of the index: shape (c,), or (3, c) with the low and high
        ends of their intervals.
    label : str
        Label of the outcome, with its unit.
    title : str
        Title of the figure.

    Examples
    --------
    >>> ends, shares = np.array([[0.9, 1.2], [1.1, 0.8]]), {"total": np.array([0.2, 0.8])}
    >>> names = ["load.normal", "friction.mu"]
    >>> plot.scatter_causes(names, ends, 1.0, names, shares, "wear (mm)")
    <Figure size ...>
    """
    figure = new_figure(1.7, 0.38 + 0.08 * max(len(keys), len(causes)))
    left, right = figure.subplots(1, 2)
    order = np.argsort(np.nan_to_num(np.abs(ends - nominal)).max(axis=0))
    names = "key at 5 %", "key at 95 %"
    sides = zip(ends[:, order], names, (LOOK.grey, LOOK.green), strict=True)
    for values, name, colour in sides:
        left.barh(range(len(keys)), values - nominal, left=nominal, color=colour, label=name)
    left.axvline(nominal, color=LOOK.vermillion, linewidth=0.8)
    left.set_yticks(range(len(keys)), [keys[k] for k in order])
    left.set_title(fill(label, 40), loc="center", fontsize="medium")
    left.xaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
    ranks = np.argsort(np.atleast_2d(list(shares.values())[-1])[0])
    for number, (name, values) in enumerate(shares.items()):
        value, *ends_of_bar = np.atleast_2d(values)[:, ranks]
        low, high = ends_of_bar or (value, value)
        height = 0.8 / len(shares)
        places = np.arange(len(causes)) + (number - 0.5 * (len(shares) - 1)) * height
        reach = np.maximum([value - low, high - value], 0.0)
        right.barh(places, value, height, xerr=reach, label=name, error_kw={"elinewidth": 0.8})
    right.set_yticks(range(len(causes)), [fill(causes[k], 30) for k in ranks])
    right.set_xlabel("share of the variance")
    figure.legend(loc="outside lower center", ncols=4)
    set_title(figure, title)
    return figure


@apply_style
def sample_distribution(
    values: np.ndarray,
    percentiles: np.ndarray,
    quantiles: np.ndarray,
    label: str,
    *,
    title: str = "",
) -> Figure:
    """Draw the share of samples below each value, and percentiles with their intervals.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Values of the samples; those that are not finite are left out.
    percentiles : ndarray, shape (k,)
        The percentiles, 0 to 100.
    quantiles : ndarray, shape (3, k)
        Their values, and the low and high ends of their intervals; ends beyond the samples are
        arrows at the outermost samples.
    label : str
        Label of the quantity, with its unit.
    title : str
        Title of the figure.

    Examples
    --------
    >>> quantiles = np.array([[1.0, 1.5], [0.9, 1.4], [1.1, np.inf]])
    >>> plot.sample_distribution(np.linspace(0.8, 1.6, 16), np.array([50, 95]), quantiles, "wear")
    <Figure size ...>
    """
    figure, axes = new_axes(1.0, 0.72)
    rising = np.sort(values[np.isfinite(values)])
    shares = 100.0 * (np.arange(rising.size) + 0.5) / rising.size
    axes.step(rising, shares, where="mid", color=LOOK.grey, label="samples")
    middle, low, high = np.clip(quantiles, rising[0], rising[-1])
    reach = np.maximum([middle - low, high - middle], 0.0)
    look: dict[str, Any] = {"color": LOOK.vermillion, "capsize": 2.0, "zorder": 3}
    axes.errorbar(middle, percentiles, xerr=reach, fmt="o", label="percentiles", **look)
    for end, limits, marker in ((low, quantiles[1], "<"), (high, quantiles[2], ">")):
        beyond = limits != end
        axes.plot(end[beyond], percentiles[beyond], marker, color=LOOK.vermillion, zorder=3)
    if _spans_decades(rising):
        axes.set_xscale("log")
    axes.set(ylim=(0.0, 100.0), xlabel=fill(label, 40), ylabel="share of samples below (%)")
    axes.legend(loc="best")
    set_title(figure, title)
    return figure


@apply_style
def percentile_band(
    places: np.ndarray,
    percentiles: np.ndarray,
    values: np.ndarray,
    label: str,
    *,
    along: str = "revolution",
    title: str = "",
) -> Figure:
    """Draw percentiles of a quantity over revolutions or distances as a band.

    Parameters
    ----------
    places : ndarray, shape (n,)
        Revolutions or distances.
    percentiles : ndarray, shape (k,)
        The percentiles, 0 to 100.
    values : ndarray, shape (n, k)
        Their values.
    label : str
        Label of the quantity, with its unit.
    along : str
        Label of the places, with their unit.
    title : str
        Title of the figure.

    Examples
    --------
    >>> values = np.array([[1.0, 1.2, 1.5], [1.9, 2.2, 2.9]])
    >>> plot.percentile_band(np.array([100, 200]), np.array([5, 50, 95]), values, "depth (mm)")
    <Figure size ...>
    """
    figure, axes = new_axes(1.0, 0.72)
    order, across = np.argsort(places), np.argsort(percentiles)
    x, rising = places[order], values[np.ix_(order, across)]
    axes.fill_between(x, rising[:, 0], rising[:, -1], color=LOOK.blue, alpha=0.2, linewidth=0)
    for curve, percent in zip(rising.T, percentiles[across], strict=True):
        axes.plot(x, curve, "o-", markersize=3, label=f"{percent:g} %")
    axes.set(xlabel=along, ylabel=fill(label, 40))
    axes.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    axes.legend()
    set_title(figure, title)
    return figure


@apply_style
def design_search(
    outcomes: Mapping[str, np.ndarray], limits: Mapping[str, float], *, title: str = ""
) -> Figure:
    """Draw the outcomes of the points of a search, with their limits.

    Parameters
    ----------
    outcomes : mapping of str to ndarray
        Values of each outcome at the points in their order, by label; nan: not computed.
    limits : mapping of str to float
        Limits by the label of their outcome.
    title : str
        Title of the figure.

    Examples
    --------
    >>> wear = np.array([3.0, 2.1, 1.7, 1.6])
    >>> plot.design_search({"wear_max": wear}, {"wear_max": 1.5})
    <Figure size ...>
    """
    count = len(outcomes)
    figure = new_figure(1.0, 0.25 + 0.3 * count)
    panels = figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
    for axes, (name, values) in zip(panels, outcomes.items(), strict=True):
        axes.plot(np.arange(1, values.size + 1), values, "o-", markersize=3)
        if name in limits:
            axes.axhline(limits[name], color=LOOK.vermillion, linestyle="--", label="limit")
            axes.legend()
        axes.set_ylabel(fill(name, 14, break_long_words=False))
    panels[-1].set_xlabel("point of the search")
    panels[-1].xaxis.set_major_locator(MaxNLocator(6, integer=True, steps=[1, 2, 5, 10]))
    set_title(figure, title)
    return figure


@apply_style
def pareto_front(outcomes: Mapping[str, np.ndarray], *, title: str = "") -> Figure:
    """Draw the designs that are best in one of two aims for a given value of the other.

    Parameters
    ----------
    outcomes : mapping of str to ndarray
        Values of both aims, by label.
    title : str
        Title of the figure.

    Examples
    --------
    >>> wear, pressure = np.array([1.0, 1.3, 2.0]), np.array([900.0, 800.0, 750.0])
    >>> plot.pareto_front({"wear_max": wear, "p_max": pressure})
    <Figure size ...>
    """
    figure, axes = new_axes(1.0, 0.72)
    (x_name, x), (y_name, y) = outcomes.items()
    axes.plot(x, y, "o-", markersize=4)
    axes.set(xlabel=x_name, ylabel=y_name)
    axes.locator_params(nbins=5)
    set_title(figure, title)
    return figure
