"""A quantity over the axes of a study: curves, maps and scattered samples."""

from collections.abc import Mapping
from dataclasses import dataclass
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from tractive_sam.description import format_with_unit
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.style import LOOK, apply_style, new_figure, set_title

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
    elif x.numeric:
        axes.xaxis.set_major_locator(MaxNLocator(5))
    if not y.numeric:
        axes.set_yticks(y.places, [fill(text, y.longest // 3) for text in y.values])
    if not x.numeric:
        letters = max(x.longest // x.values.size, x.longest // 6)
        axes.set_xticks(x.places, [fill(text, letters) for text in x.values])
