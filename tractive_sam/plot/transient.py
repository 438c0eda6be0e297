"""Figures of transients: the loop of force and shift, energy, stick, and the worn track."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from tractive_sam.plot.figure import Figure
from tractive_sam.plot.history_curves import course_axes, draw_column
from tractive_sam.plot.needs import Need, has_course, is_worn
from tractive_sam.plot.registry import history_figure
from tractive_sam.plot.style import LOOK, MICRON
from tractive_sam.results import History

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
