"""Figures of line contacts: functions of x, which replace the maps of other contacts."""

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes

from tractive_sam.description import math_label
from tractive_sam.plot.contact_view import ContactView, Source, select_evenly
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.needs import SINGLE_ROW, check_touching, has_traction
from tractive_sam.plot.registry import contact_figure
from tractive_sam.plot.scale import Scale
from tractive_sam.plot.style import LOOK, apply_style, history_title, new_axes, set_title
from tractive_sam.plot.traction_lines import draw_tractions
from tractive_sam.results import History


@apply_style
def line_pressure(source: Source, at: float | None = None, **named: float) -> Figure:
    """Pressure p_n of a line contact over x, and the pressure by Hertz of the unworn bodies.

    Examples
    --------
    >>> cylinders = ts.solve(ts.Scene.builtin("cylinders"))
    >>> plot.line_pressure(cylinders)
    <Figure size ...>
    """
    view = ContactView.from_source(source, at, **named)
    figure, axes = rolling_axes("contact pressure", view)
    x, scale = view.x_over_a, view.scale
    if scale.hertz:
        square = np.maximum(1.0 - (view.x / scale.a) ** 2, 0.0)
        look: dict[str, Any] = {
            "color": LOOK.grey,
            "linewidth": 0.9,
            "linestyle": "--",
            "label": "Hertz, unworn",
        }
        axes.plot(x, np.sqrt(square) * scale.p / scale.pressure, **look)
    pressure = view.contact.pressure[:, 0] / scale.pressure
    axes.plot(x, pressure, color=LOOK.blue, label="$p_n$")
    axes.set(ylim=(0.0, None), ylabel=scale.pressure_label("p_n"))
    figure.legend(loc="outside right center")
    return figure


@apply_style
def line_traction(source: Source, at: float | None = None, **named: float) -> Figure:
    """Tractions on body A in a line contact over x, between their bounds.

    Examples
    --------
    >>> plot.line_traction(ts.solve(ts.Scene.builtin("cylinders")))
    <Figure size ...>
    """
    view = ContactView.from_source(source, at, **named)
    figure, axes = rolling_axes("tractions on A", view)
    draw_tractions(axes, view, 0.0)
    axes.set_ylabel(view.scale.pressure_label("p"))
    figure.legend(loc="outside right center")
    return figure


@contact_figure("slip", needs=[SINGLE_ROW], shown=has_traction)
def line_slip(view: ContactView) -> Figure:
    """Slip of A over B in a line contact over x: over rolling speed, or in a shift's step.

    Examples
    --------
    >>> plot.line_slip(ts.solve(ts.Scene.builtin("cylinders")))
    <Figure size ...>
    """
    figure, axes = rolling_axes("slip of A over B", view)
    axes.axhline(0.0, color=LOOK.grey, linewidth=0.6)
    inside, shifts = view.contact.touching[:, 0], view.shifts
    divisor, colours = "" if shifts else "/V", (LOOK.blue, LOOK.vermillion)
    for name, slip, color in zip("xy", view.contact.slip[..., 0], colours, strict=True):
        if np.any(slip):
            label = f"$s_{name}{divisor}$"
            axes.plot(view.x_over_a[inside], slip[inside], color=color, label=label)
    axes.set_ylabel("slip of the step (mm)" if shifts else "slip / rolling speed")
    figure.legend(loc="outside right center")
    return figure


@apply_style
def line_pressures(history: History) -> Figure:
    """Pressure of a line contact over x, at up to eight of the stored revolutions.

    Examples
    --------
    >>> plot.line_pressures(ts.roll(ts.Scene.builtin("cylinders")))
    <Figure size ...>
    """
    scale = Scale.from_history(history)
    views = [ContactView.from_source(history, at) for at in history.saved]
    figure, axes = rolling_axes("", *views)
    places = select_evenly(history.saved)
    shades = colormaps["viridis_r"](np.linspace(0.08, 1.0, len(places)))
    for at, shade in zip(places, shades, strict=True):
        pressure = history.field("pressure", at)[:, 0]
        label = format(at, history.coordinate.format)
        axes.plot(history.x / scale.length, pressure / scale.pressure, color=shade, label=label)
    axes.set(ylim=(0.0, None), ylabel=scale.pressure_label("p_n"))
    set_title(figure, history_title(history, "contact pressure", scale.note))
    figure.legend(title=math_label(history.coordinate), loc="outside right center")
    return figure


def rolling_axes(quantity: str, *views: ContactView, margin: float = 0.08) -> tuple[Figure, Axes]:
    """Return a figure and its axes over x around the contacts, with a margin in half widths a."""
    SINGLE_ROW.check(views[0])
    check_touching(views)
    inside = np.concatenate([view.x_over_a[view.contact.touching[:, 0]] for view in views])
    figure, axes = new_axes(1.25, 0.7, views[0].describe(quantity))
    axes.set_xlim(inside.min() - margin, inside.max() + margin)
    axes.set_xlabel(views[0].scale.length_label("x") + views[0].edge_note)
    return figure, axes
