"""Curves over the course of one or several histories: forces, contact, wear, stress, energy."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from tractive_sam.description import format_with_unit, math_label
from tractive_sam.plot.contact_view import Need, has_course, is_worn
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.options import current_options
from tractive_sam.plot.registry import history_figure
from tractive_sam.plot.stress import SURFACE_NOTE
from tractive_sam.plot.style import (
    LOOK,
    MICRON,
    Scale,
    apply_style,
    history_title,
    label_course,
    new_axes,
    new_figure,
    set_title,
)
from tractive_sam.results import BODIES, History, Quantity


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
    # The largest stress at a surface is one element wide and jumps between records: no line.
    for kind, style in (("interior", {}), ("surface", {"linestyle": "", "marker": "."})):
        column = history.of_role(f"stress_{kind}")
        for body in history.bodies:
            look: dict[str, Any] = {
                "color": LOOK.bodies[body],
                "label": f"{body}, {kind}",
            } | style
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
    axes.set_ylabel(math_label(history.columns[name]) + of_body)
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


Points = tuple[ArrayLike, ArrayLike]
"""Abscissae and ordinates of points."""


@apply_style
def compare(
    histories: Mapping[str, History], name: str, reference: Mapping[str, Points] | None = None
) -> Figure:
    """Draw a column of several histories over the course, also a user-defined one.

    Parameters
    ----------
    histories : mapping of str to History
        Histories by their label in the legend.
    name : str
        Name of a column with one number a record, for example "Qx_over_P" or "p_max".
    reference : mapping of str to pair of array_like, optional
        Values of other models or of measurements by their label: coordinates, and values in the
        unit of the column.

    Raises
    ------
    ValueError
        If there is no history, a history lacks the column, the coordinates of the histories differ,
        or the column is per length in some of them, as in line contacts.

    Examples
    --------
    >>> plot.compare({"twin discs": history}, "Qx_over_P")
    <Figure size ...>
    """
    if not histories:
        raise ValueError("nothing to draw: at least one history is needed")
    common = set.intersection(*(set(history.of_dims()) for history in histories.values()))
    if name not in common:
        raise ValueError(f"name: one of {', '.join(sorted(common))} is needed, not {name!r}")
    quantity, factor = _common_quantity(name, histories), 1.0
    label = format_with_unit(quantity.long_name, quantity.unit)
    if name == "wear_max":
        factor, label = MICRON, rf"{quantity.long_name} ($\mathrm{{\mu m}}$)"
    figure, axes = new_axes()
    for title, history in histories.items():
        coordinates = history[history.coordinate.name]
        axes.plot(coordinates, factor * history[name], label=title, clip_on=False)
    for title, (places, values) in (reference or {}).items():
        axes.plot(places, factor * np.asarray(values), "--", color=LOOK.grey, label=title)
    label_course(axes, *histories.values())
    axes.set_ylabel(label, wrap=True)
    axes.legend(loc="best")
    return figure


def _common_quantity(name: str, histories: Mapping[str, History]) -> Quantity:
    """Return the column of this name; ValueError if histories differ in it or their coordinate."""
    coordinates = {history.coordinate.name for history in histories.values()}
    if len(coordinates) > 1:
        different = " and ".join(sorted(coordinates))
        raise ValueError(f"histories along one coordinate are needed, not along {different}")
    first, *conflicting = {history.columns[name] for history in histories.values()}
    if conflicting:
        raise ValueError(
            f"{name} of line contacts is per length, and of other contacts it is not; compare "
            "histories of one kind"
        )
    return first


_SHIFTS = ("shift_x", "shift_y")


@history_figure("hysteresis", columns=_SHIFTS, cure="[transient]", shown=has_course)
def hysteresis(history: History) -> Figure:
    """Force ratio of body A over the shift of A over B, along the axis of the larger shift.

    The area of a closed loop is the work of friction.

    Raises
    ------
    ValueError
        If the history has no [transient].

    Examples
    --------
    >>> plot.hysteresis(ts.roll(ts.Scene.builtin("fretting")))
    <Figure size ...>
    """
    axis = max("xy", key=lambda axis: np.ptp(history[f"shift_{axis}"]))
    shift, force = history.columns[f"shift_{axis}"], f"Q{axis}_over_P"
    figure, axes = course_axes(history, "force over shift of A over B")
    axes.autoscale()  # along the shift, not the course
    axes.plot(MICRON * history[shift.name], history[force], color=LOOK.blue)
    axes.plot(MICRON * history[shift.name][:1], history[force][:1], "o", color=LOOK.blue)
    axes.set_xlabel(rf"shift ${shift.symbol}$ ($\mathrm{{\mu m}}$)")
    axes.set_ylabel(f"${history.columns[force].symbol}$")
    return figure


@history_figure(
    "energies",
    columns=["elastic_energy", "step_work", "step_friction"],
    cure="[transient]",
    shown=has_course,
)
def energies(history: History) -> Figure:
    """Work supplied and friction work since the start, and elastic energy gained, over the course.

    Raises
    ------
    ValueError
        If the history has no [transient].

    Examples
    --------
    >>> plot.energies(ts.roll(ts.Scene.builtin("fretting")))
    <Figure size ...>
    """
    figure, axes = course_axes(history, "work since the start, and elastic energy")
    course, stored = history[history.coordinate.name], history["elastic_energy"]
    work = np.cumsum(np.append(0.0, history["step_work"][1:]))
    friction = np.cumsum(np.append(0.0, history["step_friction"][1:]))
    axes.plot(course, work, color=LOOK.blue, label="work supplied")
    axes.plot(course, friction, color=LOOK.vermillion, label="friction")
    axes.plot(course, stored - stored[0], "k--", label="elastic energy gained")
    axes.set_ylabel(f"energy ({history.columns['step_work'].unit})")
    axes.legend(loc="best")
    return figure


@history_figure("stick", columns=["stick_fraction", *_SHIFTS], cure="[transient]", shown=has_course)
def stick_course(history: History) -> Figure:
    """Share of the contact that sticks, over the course.

    Raises
    ------
    ValueError
        If the history has no [transient].

    Examples
    --------
    >>> plot.stick_course(ts.roll(ts.Scene.builtin("fretting")))
    <Figure size ...>
    """
    figure, axes = course_axes(history, "share of the contact that sticks")
    draw_column(axes, history, "stick_fraction", color=LOOK.blue)
    axes.set(ylim=(-0.02, 1.02), ylabel="share that sticks")
    return figure


def _track_axes(history: History) -> tuple[Figure, Axes, np.ndarray, np.ndarray]:
    """Return figure, axes, track positions (mm) and wear depths of both bodies together (um).

    The places have the shape (n,), the depths of both bodies together the shape (n, n_y).
    """
    places, depth = history.worn_track
    figure, axes = course_axes(history, "wear of both bodies along the track")
    axes.set(xlim=(places[0], places[-1]), xlabel="place on the bodies (mm)")
    return figure, axes, places, MICRON * depth


def _worn_row(history: History) -> Figure:
    """Draw the depth worn along the track of a line contact."""
    figure, axes, places, depth = _track_axes(history)
    axes.plot(places, depth[:, 0], color=LOOK.blue)
    axes.set(ylim=(0.0, None), ylabel=r"wear depth $w$ ($\mathrm{\mu m}$)")
    return figure


@history_figure(
    "worn-track",
    line=_worn_row,
    columns=["step_worn"],
    needs=[
        Need(
            lambda history: history.coordinate.unit == "mm",
            "a track: a rolling distance, which a [transient] of shifts does not have",
        )
    ],
    cure="[transient] and [wear]",
    shown=is_worn,
)
def worn_track(history: History) -> Figure:
    """Depth worn along the track, of both bodies together, in coordinates of the bodies.

    Raises
    ------
    ValueError
        If the history has no [transient] that rolls, with [wear].

    Examples
    --------
    >>> slipping = ts.Scene.builtin("traction-control").replace(wear={"coefficient": 1e-4})
    >>> plot.worn_track(ts.roll(slipping))
    <Figure size ...>
    """
    figure, axes, places, depth = _track_axes(history)
    worn = np.abs(history.y[(depth > 0.0).any(axis=0)])
    look: dict[str, Any] = {"cmap": LOOK.wear, "vmin": 0.0, "shading": "nearest"}
    mesh = axes.pcolormesh(places, history.y, depth.T, **look)
    figure.colorbar(mesh, ax=axes, label=r"wear depth $w$ ($\mathrm{\mu m}$)")
    axes.set_ylabel("$y$ (mm)")
    if worn.size:
        side = min(1.2 * worn.max(), history.grid.half_length[1])
        axes.set_ylim(-side, side)
    return figure
