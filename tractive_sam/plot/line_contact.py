"""Figures of line contacts: functions of x, in place of the maps of wider contacts."""

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes

from tractive_sam.plot.conditions import ONE_ROW, driven
from tractive_sam.plot.drawn import Drawn, Source, chosen
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.registry import contact_figure
from tractive_sam.plot.scale import Scale
from tractive_sam.plot.sections import MARGIN, section
from tractive_sam.plot.style import (
    BLUE,
    GREY,
    VERMILLION,
    WIDTH,
    set_title,
    styled,
    symbol_of,
    told_of,
)
from tractive_sam.results import History


@styled
def line_pressure(source: Source, at: float | None = None, **named: float) -> Figure:
    """Pressure of a line contact over x, beside that of Hertz.

    Examples
    --------
    >>> cylinders = ts.solve(ts.Scene.builtin("cylinders"))
    >>> plot.line_pressure(cylinders)
    <Figure size ...>
    """
    state = Drawn.of(source, at, **named)
    figure, axes = over_x("contact pressure", state)
    x, scale = state.x_over_a, state.scale
    if scale.hertz:
        depth = 1.0 - (state.x / scale.a) ** 2
        hertz = np.sqrt(np.maximum(depth, 0.0)) * scale.p / scale.pressure
        axes.plot(x, hertz, color=GREY, linewidth=0.9, linestyle="--", label="Hertz, unworn")
    axes.plot(x, state.contact.pressure[:, 0] / scale.pressure, color=BLUE, label="$p_n$")
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel(scale.of_pressure("p_n"))
    figure.legend(loc="outside right center")
    return figure


@styled
def line_traction(source: Source, at: float | None = None, **named: float) -> Figure:
    """Tractions on body A in a line contact over x, between what friction allows.

    Examples
    --------
    >>> plot.line_traction(ts.solve(ts.Scene.builtin("cylinders")))
    <Figure size ...>
    """
    state = Drawn.of(source, at, **named)
    figure, axes = over_x("tractions on A", state)
    section(axes, state, 0.0)
    axes.set_ylabel(state.scale.of_pressure("p"))
    figure.legend(loc="outside right center")
    return figure


@contact_figure("slip", needs=[ONE_ROW], shown=driven)
def line_slip(state: Drawn) -> Figure:
    """Slip of A over B in a line contact over x: over the rolling speed, or of a shift in the step.

    Examples
    --------
    >>> plot.line_slip(ts.solve(ts.Scene.builtin("cylinders")))
    <Figure size ...>
    """
    figure, axes = over_x("slip of A over B", state)
    axes.axhline(0.0, color=GREY, linewidth=0.6)
    inside, shifts = state.contact.touching[:, 0], state.contact.scene.schedule.shifts
    over = "" if shifts else "/V"
    for name, slip, color in zip("xy", state.contact.slip[..., 0], (BLUE, VERMILLION), strict=True):
        if np.any(slip):
            axes.plot(state.x_over_a[inside], slip[inside], color=color, label=f"$s_{name}{over}$")
    axes.set_ylabel("slip of the step (mm)" if shifts else "slip / rolling speed")
    figure.legend(loc="outside right center")
    return figure


@styled
def line_pressures(history: History) -> Figure:
    """Pressure of a line contact over x, at the stored revolutions.

    Examples
    --------
    >>> plot.line_pressures(ts.roll(ts.Scene.builtin("cylinders")))
    <Figure size ...>
    """
    scale = Scale.of_history(history)
    figure, axes = over_x("", *(Drawn.of(history, at) for at in history.saved))
    places = chosen(history.saved)
    shades = colormaps["viridis_r"](np.linspace(0.08, 1.0, len(places)))
    for at, shade in zip(places, shades, strict=True):
        pressure = history.field("pressure", at)[:, 0]
        label = format(at, history.coordinate.format)
        axes.plot(history.x / scale.length, pressure / scale.pressure, color=shade, label=label)
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel(scale.of_pressure("p_n"))
    set_title(figure, told_of(history, "contact pressure", scale.told))
    figure.legend(title=symbol_of(history.coordinate), loc="outside right center")
    return figure


def over_x(told: str, *states: Drawn) -> tuple[Figure, Axes]:
    """Axes over the contacts of all states."""
    ONE_ROW.check(states[0])
    if not any(state.contact.touching.any() for state in states):
        raise ValueError("nothing to draw: the bodies do not touch")
    inside = np.concatenate([s.x_over_a[s.contact.touching[:, 0]] for s in states])
    figure = Figure(figsize=(1.25 * WIDTH, 0.7 * WIDTH))
    axes = figure.add_subplot()
    axes.set_xlim(inside.min() - MARGIN, inside.max() + MARGIN)
    axes.set_xlabel(states[0].scale.of_length("x") + states[0].ahead)
    set_title(figure, states[0].told(told))
    return figure, axes
