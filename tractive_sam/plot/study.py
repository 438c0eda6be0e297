"""A quantity over what varies in a study: curves, maps and scattered samples."""

from collections.abc import Mapping
from dataclasses import dataclass
from textwrap import fill

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from tractive_sam.plot.figure import Figure
from tractive_sam.plot.style import GREY, PRESSURE, SIGNED, WIDTH, set_title, styled

MOST_CURVES = 10
"""In one figure."""

ONE_SIGN = 0.02
"""Share of the largest value up to which those of the other sign do not count."""

FEW = 6
"""Values of an axis up to which a map has a row for each, as high as the next: between them nothing
is known."""

TICKS = 5
"""Numbers along an axis, for which there is room."""

LETTERS = 40
"""Of a label before it goes on in the next line."""

LABELS = {
    "Qx": "$Q_x$",
    "Qy": "$Q_y$",
    "Mz": "$M_z$",
    "Qx_over_P": "$Q_x/P$",
    "Qy_over_P": "$Q_y/P$",
    "p_max": "peak contact pressure",
    "p_95": "pressure that 5 % of the load exceeds",
    "wear_max": "largest wear depth",
    "creepage.longitudinal": r"$\xi_x$",
    "creepage.lateral": r"$\xi_y$",
    "creepage.spin": r"$\phi$",
    "friction.mu": r"$\mu$",
    "friction.angle": r"$\beta$",
    "load.normal": "$P$",
    "load.pressure": "$p_0$",
}
"""What the field calls quantities and entries of a scene; units, which differ between line contacts
and others, come with the variable."""

CREEPAGES = ("creepage.longitudinal", "creepage.lateral")
"""Drawn as the field does, in per cent and with the sign of the force: curves rise to the right."""

FORCES = ("Qx", "Qy", "Qx_over_P", "Qy_over_P")
"""Curves of which over a creepage show the origin."""


@dataclass(frozen=True, eq=False)
class Variable:
    """What is drawn along an axis of a figure; creepages as -xi, in per cent.

    Attributes
    ----------
    name : str
        Name of the quantity, or key of the entry of the scene.
    values : ndarray
        Numbers, or texts, which are drawn at equal distances.
    meaning : str
        What to call it where it is not among `LABELS`.
    unit : str
        Unit, unless the meaning tells it; "1" stands for none.

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

    @property
    def label(self) -> str:
        """What to write along the axis."""
        within, bracket, entry = self.name.rpartition("].")
        label = LABELS.get(entry) or self.meaning or self.name
        unit = self.unit
        if self.creepage:
            label, unit = f"$-${label}", "%"
        if bracket and entry in LABELS:
            label = f"{label} of {within}]"
        return fill(label if unit in ("", "1") else f"{label} ({unit})", LETTERS)

    @property
    def creepage(self) -> bool:
        """Whether it has numbers of a translational creepage."""
        return self.numeric and self.name.rpartition("].")[2] in CREEPAGES

    @property
    def numeric(self) -> bool:
        """Whether it has numbers."""
        return self.values.dtype.kind in "iuf"

    @property
    def places(self) -> np.ndarray:
        """Where along the axis, in its unit."""
        if not self.numeric:
            return np.arange(self.values.size) * 1.0
        return 0.0 - 100.0 * self.values if self.creepage else self.values.astype(float)

    @property
    def told(self) -> list[str]:
        """Its values in words, in the unit of its axis."""
        return (
            [f"{one:.6g}" for one in self.places] if self.numeric else list(map(str, self.values))
        )

    @property
    def logarithmic(self) -> bool:
        """Whether it is spaced so, over a decade at least."""
        places = np.sort(self.places)
        if places.size < 3 or places[0] <= 0.0 or places[-1] < 10.0 * places[0]:
            return False
        steps = places[1:] / places[:-1]
        return bool(np.allclose(steps, steps[0], rtol=1e-3))


@styled
def study_curves(
    x: Variable, y: Variable, over: Variable | None = None, *, title: str = ""
) -> Figure:
    """A quantity over one entry of a scene, one curve for each value of another.

    Parameters
    ----------
    x : Variable
        The entry, n values.
    y : Variable
        The quantity, shape (n,), or (n, m) with `over`; nan where it is not known.
    over : Variable, optional
        The other entry, m values; at most `MOST_CURVES` of them are drawn.
    title : str
        Title of the figure.

    Examples
    --------
    >>> mu = plot.Variable("friction.mu", np.array([0.1, 0.2, 0.4]))
    >>> force = plot.Variable("Qx_over_P", np.array([0.1, 0.19, 0.31]))
    >>> plot.study_curves(mu, force)
    <Figure size ...>
    """
    figure = Figure(figsize=(WIDTH, 0.72 * WIDTH))
    axes = figure.add_subplot()
    columns = {"": y.values}
    if over is not None:
        shown = np.unique(np.linspace(0, over.values.size - 1, MOST_CURVES).astype(int))
        columns = {over.told[k]: y.values[:, k] for k in shown}
    order = np.argsort(x.places)
    if over is not None:  # its values have an order, and so have the colours
        axes.set_prop_cycle(color=colormaps[PRESSURE](np.linspace(0.0, 0.9, len(columns))))
    for name, column in columns.items():
        axes.plot(x.places[order], column[order], "o-", label=name, markersize=3.5)
    if over is not None:
        axes.legend(title=over.label)
    _label(axes, x, y)
    if x.creepage and y.name in FORCES and not x.logarithmic:
        axes.update_datalim([(0.0, 0.0)])
        axes.autoscale_view()
    set_title(figure, title)
    return figure


@styled
def study_map(x: Variable, y: Variable, quantity: Variable, *, title: str = "") -> Figure:
    """A quantity over two entries of a scene; cases where it is not known are left grey.

    An entry of at most six values has equal fields, each under its value.

    Parameters
    ----------
    x, y : Variable
        The entries, n and m values.
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
    figure = Figure(figsize=(WIDTH, 0.8 * WIDTH))
    axes = figure.add_subplot(facecolor="#DDDDDD")
    across, along = np.argsort(x.places), np.argsort(y.places)
    values = np.ma.masked_invalid(quantity.values[np.ix_(across, along)].T)
    x, y = _in_fields(x), _in_fields(y)
    across = x.places[across] if x.numeric else np.arange(across.size)
    along = y.places[along] if y.numeric else np.arange(along.size)
    mesh = axes.pcolormesh(across, along, values, shading="nearest", **_colours(values))
    figure.colorbar(mesh, label=quantity.label)
    _label(axes, x, y)
    set_title(figure, title)
    return figure


@styled
def study_samples(variables: Mapping[str, Variable], y: Variable, *, title: str = "") -> Figure:
    """A quantity over each entry of a Latin hypercube, one point a sample.

    Examples
    --------
    >>> mu = plot.Variable("friction.mu", np.array([0.13, 0.2, 0.38]))
    >>> force = plot.Variable("Qx_over_P", np.array([0.13, 0.18, 0.3]))
    >>> plot.study_samples({"friction.mu": mu}, force)
    <Figure size ...>
    """
    count = len(variables)
    figure = Figure(figsize=(WIDTH * min(count, 3) * 0.7, 0.6 * WIDTH * -(-count // 3)))
    panels = figure.subplots(-(-count // 3), min(count, 3), sharey=True, squeeze=False)
    for axes in panels.flat[count:]:
        axes.set_axis_off()
    for axes, variable in zip(panels.flat, variables.values(), strict=False):
        axes.plot(variable.places, y.values, "o", markersize=3, color=GREY)
        _label(axes, variable, y)
    for axes in panels[:, 1:].flat:
        axes.set_ylabel("")
    set_title(figure, title)
    return figure


def _colours(values: np.ma.MaskedArray) -> dict:
    """White at zero where both signs matter."""
    largest = float(np.abs(values).max()) if values.count() else 0.0
    if values.count() and min(-values.min(), values.max()) > ONE_SIGN * largest:
        return {"cmap": SIGNED, "vmin": -largest, "vmax": largest}
    return {"cmap": PRESSURE}


def _in_fields(variable: Variable) -> Variable:
    """The variable in ascending order, as texts where it has few values."""
    if not variable.numeric or variable.values.size > FEW:
        return variable
    order = np.argsort(variable.places)
    return Variable("", np.array(variable.told)[order], variable.label)


def _label(axes: Axes, x: Variable, y: Variable) -> None:
    axes.set(xlabel=x.label, ylabel=y.label)
    if x.logarithmic:
        axes.set_xscale("log")
    elif x.numeric:
        axes.xaxis.set_major_locator(MaxNLocator(TICKS))
    if not y.numeric:
        axes.set_yticks(y.places, [fill(one, LETTERS // 3) for one in y.values])
    if not x.numeric:
        letters = max(LETTERS // x.values.size, LETTERS // 6)
        axes.set_xticks(x.places, [fill(one, letters) for one in x.values])
