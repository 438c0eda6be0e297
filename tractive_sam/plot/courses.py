"""Numbers over the course: forces, the size and pressure of the contact, wear, stress."""

from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes

from tractive_sam.plot.conditions import in_course, worn
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.registry import history_figure
from tractive_sam.plot.scale import Scale
from tractive_sam.plot.stress import NOTE
from tractive_sam.plot.style import BLUE, VERMILLION, WIDTH, along, set_title, told_of
from tractive_sam.results import BODIES, History

NO_MAXIMUM = "Where a line ends, no maximum is deeper than two elements any more."

COLOURS = {"A": BLUE, "B": VERMILLION}
"""Of the bodies."""


@history_figure("forces", columns=["Qx_over_P", "Qy_over_P"], shown=in_course)
def forces(history: History) -> Figure:
    """Forces on body A over the normal load, over the course.

    Examples
    --------
    >>> plot.forces(history)
    <Figure size ...>
    """
    figure, axes = over_course(history, "forces on A")
    for name, label in (("Qx_over_P", "$Q_x/P$"), ("Qy_over_P", "$Q_y/P$")):
        _course(axes, history, history[name], label)
    axes.set_ylabel("force / normal load")
    axes.legend(loc="best")
    return figure


@history_figure("widths", columns=["half_width_x", "p_max"], shown=in_course)
def widths(history: History) -> Figure:
    """Half widths of the contact and its pressure, over the course.

    The pressure is the one that 5 % of the load exceeds: the largest one jumps with every
    element that comes into contact. Files of former versions have the largest one only.

    Examples
    --------
    >>> plot.widths(history)
    <Figure size ...>
    """
    scale = Scale.of_history(history)
    told = f"size and pressure of the contact; {replace(scale, drawn_in='hertz').told}"
    figure, axes = over_course(history, told)
    p, halves = scale.p_symbol, {"x": (scale.a, scale.a_symbol), "y": (scale.b, scale.b_symbol)}
    for axis, (half, symbol) in halves.items():
        if np.isfinite(half):  # in y of a line contact it is infinite
            label = f"half width in ${axis}$ / ${symbol}$"
            _course(axes, history, history[f"half_width_{axis}"] / half, label)
    told, pressure = f"pressure that 5 % of the load exceeds / ${p}$", history["p_95"]
    if np.isnan(pressure).all():
        told, pressure = f"peak contact pressure / ${p}$", history["p_max"]
    _course(axes, history, pressure / scale.p, told)
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel("relative to the unworn contact")
    axes.legend(loc="best")
    return figure


@history_figure("wear-depth", shown=lambda history: in_course(history) and worn(history))
def wear_depth(history: History) -> Figure:
    """Largest wear depth of both bodies together, over the course.

    Examples
    --------
    >>> plot.wear_depth(history)
    <Figure size ...>
    """
    figure, axes = over_course(history, "wear of both bodies together")
    _course(axes, history, 1e3 * history["wear_max"], "")
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel(r"largest wear depth ($\mathrm{\mu m}$)")
    return figure


@history_figure(
    "worn-mass",
    columns=["worn_volume", "worn_mass"],
    cure="[wear], or the radius_x of a body,",
    shown=in_course,
)
def worn_mass(history: History) -> Figure:
    """Volume and mass worn off each body since it was new, over the course.

    Raises
    ------
    ValueError
        If nothing wears, or both bodies are flat.

    Examples
    --------
    >>> plot.worn_mass(history)
    <Figure size ...>
    """
    figure = Figure(figsize=(WIDTH, WIDTH))
    panels = figure.subplots(2, sharex=True)
    for axes, name in zip(panels, ("worn_volume", "worn_mass"), strict=True):
        for body, values in zip(BODIES, history[name].T, strict=True):
            if not np.isfinite(values).any():
                continue
            look = {"color": COLOURS[body], "linestyle": {"A": "-", "B": "--"}[body]}
            _course(axes, history, values, f"body {body}", **look)
        axes.set_ylim(bottom=0.0)
        unit = history.columns[name].unit.replace("mm3", "mm³").replace("mm2", "mm²")
        axes.set_ylabel(f"{name.replace('_', ' ')} ({unit})")
    panels[0].legend(loc="best")
    along(panels[1], history)
    set_title(figure, told_of(history, "wear of each body"))
    return figure


@history_figure(
    "creepages", columns=["creepage_found"], cure="load.force_x or load.force_y", shown=in_course
)
def creepages(history: History) -> Figure:
    """Creepages that prescribed forces take, over the course.

    Raises
    ------
    ValueError
        If no force is prescribed.

    Examples
    --------
    >>> plot.creepages(ts.roll(scene.with_set(["load.force_x=0.05"])))
    <Figure size ...>
    """
    figure, axes = over_course(history, "creepage that the forces take")
    for label, values in zip((r"$\xi_x$", r"$\xi_y$"), history["creepage_found"].T, strict=True):
        if np.isfinite(values).any():
            _course(axes, history, values, label)
    axes.set_ylabel("creepage found")
    axes.legend(loc="best")
    return figure


@history_figure("{stress_max}", columns=["stress_max"], cure="[subsurface]", shown=in_course)
def stress_course(history: History) -> Figure:
    """Largest stress of each body, inside and at its surface, over the course.

    By the criterion that it was rolled with. A body that wears may have no maximum inside any more:
    its line then ends.

    Raises
    ------
    ValueError
        If no stress was computed.

    Examples
    --------
    >>> plot.stress_course(history)
    <Figure size ...>
    """
    scale = Scale.of_history(history)
    figure, axes = over_course(history, "largest stress in each body", scale.told)
    for kind, style in (("interior", "-"), ("surface", "--")):
        column = history.of_role(f"stress_{kind}")
        for body in history.bodies:
            values = history[column.name][:, BODIES.index(body)]
            look = {"color": COLOURS[body], "linestyle": style}
            _course(axes, history, values / scale.pressure, f"{body}, {kind}", **look)
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel(scale.of_pressure(column.symbol))
    axes.legend(loc="lower right", ncols=2)
    ends = np.isnan(history[history.of_role("stress_interior").name]).any()
    figure.supxlabel(f"{NOTE} {NO_MAXIMUM}" if ends else NOTE, fontsize=9, wrap=True)
    return figure


def over_course(history: History, told: str, scale: str = "") -> tuple[Figure, Axes]:
    """A figure and its axes over the course of a history."""
    figure = Figure(figsize=(WIDTH, 0.66 * WIDTH))
    axes = figure.add_subplot()
    along(axes, history)
    set_title(figure, told_of(history, told, scale))
    return figure, axes


def _course(axes: Axes, history: History, values: np.ndarray, label: str, **style) -> None:
    (line,) = axes.plot(history[history.coordinate.name], values, label=label, **style)
    line.set_clip_on(False)
