"""Figures of transients: the loop of force and shift, energy, and the course of stick and slip."""

import numpy as np
from matplotlib.axes import Axes

from tractive_sam.plot.conditions import Need, in_course, worn
from tractive_sam.plot.courses import over_course
from tractive_sam.plot.drawn import Drawn
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.frame import Frame
from tractive_sam.plot.map import LEFT, Map
from tractive_sam.plot.registry import history_figure
from tractive_sam.plot.style import BLUE, MICRON, TRACTION, VERMILLION, WEAR
from tractive_sam.results import History

SHIFTS = ("shift_x", "shift_y")
"""Columns of a history in steps, in which A is shifted over B."""

_ROLLS = Need(
    lambda history: history.coordinate.unit == "mm",
    "a track: a distance rolled, which a [transient] of shifts has not",
)


@history_figure("hysteresis", columns=SHIFTS, cure="[transient]", shown=in_course)
def hysteresis(history: History) -> Figure:
    """Force on body A over the shift of A over B, along the axis of the larger shift.

    The area of a closed loop is the work of friction.

    Raises
    ------
    ValueError
        If the history is not of a [transient].

    Examples
    --------
    >>> plot.hysteresis(ts.roll(ts.Scene.builtin("fretting")))
    <Figure size ...>
    """
    axis = max("xy", key=lambda one: np.ptp(history[f"shift_{one}"]))
    shift = history.columns[f"shift_{axis}"]
    figure, axes = over_course(history, "force over shift of A over B")
    axes.autoscale()  # along the shift, not the course
    axes.plot(1e3 * history[shift.name], history[f"Q{axis}_over_P"], color=BLUE)
    axes.plot(1e3 * history[shift.name][:1], history[f"Q{axis}_over_P"][:1], "o", color=BLUE)
    axes.set_xlabel(rf"shift ${shift.symbol}$ ($\mathrm{{\mu m}}$)")
    axes.set_ylabel(f"${history.columns[f'Q{axis}_over_P'].symbol}$")
    return figure


@history_figure(
    "energies",
    columns=["elastic_energy", "step_work", "step_friction"],
    cure="[transient]",
    shown=in_course,
)
def energies(history: History) -> Figure:
    """Work supplied and taken by friction since the start, and the elastic energy, over the course.

    Raises
    ------
    ValueError
        If the history is not of a [transient].

    Examples
    --------
    >>> plot.energies(ts.roll(ts.Scene.builtin("fretting")))
    <Figure size ...>
    """
    figure, axes = over_course(history, "work since the start, and elastic energy")
    at, stored = history[history.coordinate.name], history["elastic_energy"]
    work = np.cumsum(np.append(0.0, history["step_work"][1:]))
    friction = np.cumsum(np.append(0.0, history["step_friction"][1:]))
    for values, label, style in (
        (work, "work supplied", {"color": BLUE}),
        (friction, "friction", {"color": VERMILLION}),
        (stored - stored[0], "elastic energy gained", {"color": "black", "linestyle": "--"}),
    ):
        axes.plot(at, values, label=label, **style)
    axes.set_ylabel(f"energy ({history.columns['step_work'].unit})")
    axes.legend(loc="best")
    return figure


@history_figure("stick", columns=["stick_fraction", *SHIFTS], cure="[transient]", shown=in_course)
def stick_course(history: History) -> Figure:
    """Share of the contact that sticks, over the course.

    Raises
    ------
    ValueError
        If the history is not of a [transient].

    Examples
    --------
    >>> plot.stick_course(ts.roll(ts.Scene.builtin("fretting")))
    <Figure size ...>
    """
    figure, axes = over_course(history, "share of the contact that sticks")
    axes.plot(history[history.coordinate.name], history["stick_fraction"], color=BLUE)
    axes.set(ylim=(-0.02, 1.02), ylabel="share that sticks")
    return figure


_DEPTH = r"wear depth $w$ ($\mathrm{\mu m}$)"


def _over_track(history: History) -> tuple[Figure, Axes, np.ndarray, np.ndarray]:
    """Return axes over the track, its places (mm) and the depths worn there (micrometres)."""
    places, depth = history.worn_track
    figure, axes = over_course(history, "wear of both bodies along the track")
    axes.set(xlim=(places[0], places[-1]), xlabel="place on the bodies (mm)")
    return figure, axes, places, MICRON * depth


def _worn_row(history: History) -> Figure:
    """Depth worn along the track of a line contact."""
    figure, axes, places, depth = _over_track(history)
    axes.plot(places, depth[:, 0], color=BLUE)
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel(_DEPTH)
    return figure


@history_figure(
    "worn-track",
    line=_worn_row,
    columns=["step_worn"],
    needs=[_ROLLS],
    cure="[transient] and [wear]",
    shown=worn,
)
def worn_track(history: History) -> Figure:
    """Depth worn along the track, of both bodies together, in coordinates of the bodies.

    Raises
    ------
    ValueError
        If the history is not of a [transient] that rolls, with [wear].

    Examples
    --------
    >>> slipping = ts.Scene.builtin("traction-control").replace(wear={"coefficient": 1e-4})
    >>> plot.worn_track(ts.roll(slipping))
    <Figure size ...>
    """
    figure, axes, places, depth = _over_track(history)
    worn = np.abs(history.y[(depth > 0.0).any(axis=0)])
    mesh = axes.pcolormesh(places, history.y, depth.T, cmap=WEAR, vmin=0.0, shading="nearest")
    figure.colorbar(mesh, ax=axes, label=_DEPTH)
    axes.set_ylabel("$y$ (mm)")
    if worn.size:
        side = min(1.2 * worn.max(), history.grid.half_length[1])
        axes.set_ylim(-side, side)
    return figure


def traction_picture(figure: Figure, frame: Frame, state: Drawn, envelope: Drawn) -> None:
    """One picture of an animation: the traction and the moving edge of stick.

    The colours end at the peak contact pressure at any time: there friction carries no more.
    """
    for axes in list(figure.axes):
        axes.remove()
    chart = Map(figure, LEFT, state, frame)
    chart.axes.set_title(state.place, loc="center")
    shares = state.contact.utilisation / state.scale.pressure
    highest = envelope.contact.pressure.max() / state.scale.pressure
    mesh = chart.fill(shares, cmap=TRACTION, vmin=0.0, vmax=highest)
    if state.contact.touching.any():
        chart.stick_edge(colors="white", linewidths=1.2, linestyles="--")
        chart.arrows(state.contact.traction, state.contact.touching, color="white")
    symbol = r"|p_t|/\mu" if state.isotropic else r"\|p_t\|_\mu"
    chart.colour_bar(mesh, f"traction over friction {state.scale.of_pressure(symbol)}")
