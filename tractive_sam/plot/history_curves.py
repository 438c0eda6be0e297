"""Curves over the course: forces, size and pressure of the contact, wear, stress."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from tractive_sam.description import format_with_unit, math_label
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.needs import has_course, is_worn
from tractive_sam.plot.options import current_options
from tractive_sam.plot.registry import history_figure
from tractive_sam.plot.scale import Scale
from tractive_sam.plot.stress import SURFACE_NOTE
from tractive_sam.plot.style import (
    LOOK,
    MICRON,
    history_title,
    label_course,
    new_axes,
    new_figure,
    set_title,
)
from tractive_sam.results import BODIES, History


@history_figure("forces", columns=["Qx_over_P", "Qy_over_P"], shown=has_course)
def forces(history: History) -> Figure:
    """Forces on body A over the normal load, over the course.

    Examples
    --------
    >>> plot.forces(history)
    <Figure size ...>
    """
    figure, axes = course_axes(history, "forces on A")
    for name, label in (("Qx_over_P", "$Q_x/P$"), ("Qy_over_P", "$Q_y/P$")):
        draw_column(axes, history, name, label=label)
    axes.set_ylabel("force / normal load")
    axes.legend(loc="best")
    return figure


@history_figure("widths", columns=["half_width_x", "p_max"], shown=has_course)
def widths(history: History) -> Figure:
    """Half widths and pressure of the contact, relative to the unworn contact, over the course.

    The pressure is the one exceeded by 5 % of the load: the largest one jumps with every element
    that comes into contact. Files of former versions have the largest one only.

    Examples
    --------
    >>> plot.widths(history)
    <Figure size ...>
    """
    scale = Scale.from_history(history)
    figure, axes = course_axes(history, f"size and pressure of the contact; {scale.describe()}")
    halves = {"x": (scale.a, scale.a_symbol), "y": (scale.b, scale.b_symbol)}
    for axis, (half, symbol) in halves.items():
        if np.isfinite(half):  # infinite in y of a line contact
            label = f"half width in ${axis}$ / ${symbol}$"
            draw_column(axes, history, f"half_width_{axis}", divisor=half, label=label)
    name, label = "p_95", "pressure exceeded by 5 % of the load"
    if np.isnan(history[name]).all():
        name, label = "p_max", "peak contact pressure"
    draw_column(axes, history, name, divisor=scale.p, label=f"{label} / ${scale.p_symbol}$")
    highest = 1.1 * float(axes.dataLim.ymax)  # constant curves are not on the frame
    axes.set(ylim=(0.0, highest), ylabel="relative to the unworn contact")
    axes.legend(loc="best")
    return figure


@history_figure("wear-depth", shown=lambda history: has_course(history) and is_worn(history))
def wear_depth(history: History) -> Figure:
    """Largest wear depth of both bodies together, over the course.

    Examples
    --------
    >>> plot.wear_depth(history)
    <Figure size ...>
    """
    figure, axes = course_axes(history, "wear of both bodies together")
    draw_column(axes, history, "wear_max", divisor=1.0 / MICRON)
    axes.set(ylim=(0.0, None), ylabel=r"largest wear depth ($\mathrm{\mu m}$)")
    return figure


@history_figure(
    "worn-mass",
    columns=["worn_volume", "worn_mass"],
    cure="[wear], or the radius_x of a body,",
    shown=has_course,
)
def worn_mass(history: History) -> Figure:
    """Worn volume and mass of each body since it was new, over the course.

    Raises
    ------
    ValueError
        If nothing wears, or both bodies are flat.

    Examples
    --------
    >>> plot.worn_mass(history)
    <Figure size ...>
    """
    figure = new_figure(1.0, 1.0)
    panels = figure.subplots(2, sharex=True)
    for axes, name in zip(panels, ("worn_volume", "worn_mass"), strict=True):
        for k, body in enumerate(BODIES):
            if np.isfinite(history[name][:, k]).any():
                look: dict[str, Any] = {
                    "color": LOOK.bodies[body],
                    "linestyle": "-" if body == "A" else "--",
                }
                draw_column(axes, history, name, body, label=f"body {body}", **look)
        axes.set_ylim(bottom=0.0)
        axes.set_ylabel(format_with_unit(name.replace("_", " "), history.columns[name].unit))
    panels[0].legend(loc="best")
    label_course(panels[1], history)
    set_title(figure, history_title(history, "wear of each body"))
    return figure


@history_figure(
    "creepages", columns=["creepage_found"], cure="load.force_x or load.force_y", shown=has_course
)
def creepages(history: History) -> Figure:
    """Creepages that transmit the prescribed forces, over the course.

    Raises
    ------
    ValueError
        If no force is prescribed.

    Examples
    --------
    >>> plot.creepages(ts.roll(scene.with_set(["load.force_x=0.05"])))
    <Figure size ...>
    """
    figure, axes = course_axes(history, "creepage that transmits the forces")
    for label, values in zip((r"$\xi_x$", r"$\xi_y$"), history["creepage_found"].T, strict=True):
        if np.isfinite(values).any():
            axes.plot(history[history.coordinate.name], values, label=label, clip_on=False)
    axes.set_ylabel("creepage found")
    axes.legend(loc="best")
    return figure


@history_figure("{stress_max}", columns=["stress_max"], cure="[subsurface]", shown=has_course)
def stress_course(history: History) -> Figure:
    """Largest stress of each body, inside and at its surface, over the course.

    The stress is judged by the criterion of the computation. A body that wears may lose its
    maximum inside: its line then ends.

    Raises
    ------
    ValueError
        If no stress was computed.

    Examples
    --------
    >>> plot.stress_course(history)
    <Figure size ...>
    """
    scale = Scale.from_history(history)
    figure, axes = course_axes(history, "largest stress in each body", scale.note)
    for kind, style in (("interior", "-"), ("surface", "--")):
        column = history.of_role(f"stress_{kind}")
        for body in history.bodies:
            look: dict[str, Any] = {
                "color": LOOK.bodies[body],
                "linestyle": style,
                "label": f"{body}, {kind}",
            }
            draw_column(axes, history, column.name, body, divisor=scale.pressure, **look)
    axes.set(ylim=(0.0, None), ylabel=scale.pressure_label(column.symbol))
    axes.legend(loc="lower right", ncols=2)
    note = SURFACE_NOTE
    if np.isnan(history[history.of_role("stress_interior").name]).any():
        note += " A line ends if no maximum is deeper than two elements."
    figure.supxlabel(note, fontsize="small", wrap=True)
    return figure


def _measured_columns(history: History) -> list[dict[str, str]]:
    """Return the arguments {"column": ...} of the figures of each measured column."""
    measured = current_options().measured
    return [] if measured is None else [{"column": name} for name in measured.compared(history)]


@history_figure("measured-{column}", each=_measured_columns)
def measured_column(history: History, column: str) -> Figure:
    """Measured points, and the computed values over the course.

    Parameters
    ----------
    history : History
        History with the column.
    column : str
        Name of the column, with its body, as in the measured points.

    Examples
    --------
    >>> weighed = {"revolution": np.array([0.0, 2.0]), "worn_mass B": np.array([0.0, 1e-4])}
    >>> measured = plot.Measurements(weighed)
    >>> names = [path.name for path in plot.save_all(history, "figures", measured=measured)]
    >>> "measured-worn-mass-B.png" in names
    True
    """
    name, _, body = column.partition(" ")
    of_body = f" of body {body}" if body else ""
    figure, axes = course_axes(history, f"measured and computed {name.replace('_', ' ')}{of_body}")
    draw_column(axes, history, name, body, label="computed")
    axes.set_ylabel(math_label(history.columns[name]))
    return figure


def course_axes(history: History, quantity: str, scale: str = "") -> tuple[Figure, Axes]:
    """Return a figure and its axes over the course of a history."""
    figure, axes = new_axes(title=history_title(history, quantity, scale))
    label_course(axes, history)
    return figure, axes


def draw_column(
    axes: Axes, history: History, name: str, body: str = "", *, divisor: float = 1.0, **style: Any
) -> None:
    """Draw a column over the course, with measured points of its name.

    Parameters
    ----------
    axes : Axes
        Axes over the course.
    history : History
        History with the column.
    name, body : str
        Name of the column, and the body if it has a value for each.
    divisor : float
        Divisor of the values.
    **style
        Style of the line.
    """
    values = (history[name][:, BODIES.index(body)] if body else history[name]) / divisor
    places, finite = history[history.coordinate.name], np.isfinite(values)
    if not (finite[1:] & finite[:-1]).any():  # single records, as those with stored fields
        places, values, style = places[finite], values[finite], {"marker": "o", **style}
    (line,) = axes.plot(places, values, clip_on=False, **style)
    if measured := current_options().measured:
        column = f"{name} {body}".strip()
        measured.draw(axes, history, column, divisor, color=line.get_color())
        if axes.get_legend_handles_labels()[1]:
            axes.legend(loc="best")
