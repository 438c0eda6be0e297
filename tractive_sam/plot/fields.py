"""Fields of contacts: pressure, traction, stick and slip, wear, temperature; an animation.

Each function takes a `ContactView`, a solved `State`, or a `History` and one of its `saved` values,
also by the name of its coordinate: ``revolution=2`` (the last by default). For line contacts,
functions of x replace the maps of pressure and traction.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Patch
from PIL import Image

from tractive_sam import interrupt
from tractive_sam.description import format_place, math_label
from tractive_sam.output_file import write_file
from tractive_sam.plot.contact_map import (
    SINGLE_ROW,
    WIDE,
    ContactMap,
    ContactView,
    MapFrame,
    MapLayout,
    Need,
    Source,
    add_axes,
    check_touching,
    has_contacts,
    has_traction,
    has_worn_contacts,
    new_map_figure,
    select_evenly,
)
from tractive_sam.plot.figure import (
    LOOK,
    MICRON,
    Figure,
    Scale,
    apply_style,
    history_title,
    new_axes,
    new_figure,
    record_colours,
    set_title,
)
from tractive_sam.plot.registry import contact_figure, history_figure
from tractive_sam.results import BODIES, History
from tractive_sam.schema import required


@contact_figure("traction-sections", needs=[WIDE], shown=has_traction)
def traction_sections(view: ContactView, offset: float = 0.75) -> Figure:
    """Tractions on body A along y = 0 and y = 0.75 half widths, between their bounds.

    The second line is at y = 0.75 a, or 0.75 b if the half width b is less than a or more than
    three times a. Lines outside of the contact are omitted.
    The bounds are the largest values of one component: the extent of the friction
    ellipse in x and in y. Both components together are smaller.

    Examples
    --------
    >>> plot.traction_sections(contact)
    <Figure size ...>
    """
    scale = view.scale
    half, symbol = scale.a, scale.a_symbol
    if not offset * scale.a < scale.b < 3.0 * scale.a:
        half, symbol = scale.b, scale.b_symbol
    at = f"{offset}\\,{symbol}$" if scale.relative else f"{offset * half:.3g}$ mm"
    lines = {"$y = 0$": 0.0, f"$y = {at}": offset * half}
    pressure = view.contact.pressure
    lines = {name: y for name, y in lines.items() if _along_line(view, pressure, y).any()} or {
        "row of the largest pressure": float(view.y[pressure.max(axis=0).argmax()])
    }
    figure = new_figure(1.8 if len(lines) > 1 else 1.2, 0.6)
    panels = figure.subplots(1, len(lines), sharex=True, sharey=True, squeeze=False)[0]
    for axes, (name, y) in zip(panels, lines.items(), strict=True):
        draw_tractions(axes, view, y)
        axes.set_title(name, loc="center")
    panels[0].set_ylabel(scale.pressure_label("p"))
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside right center")
    figure.supxlabel(scale.length_label("x") + view.edge_note, fontsize="medium")
    set_title(figure, view.describe("tractions on A"))
    return figure


def draw_tractions(
    axes: Axes, view: ContactView, y: float, *, margin: float = 0.08, negligible: float = 1e-3
) -> None:
    """Draw the tractions of a contact along a line of constant y, between their bounds.

    Parameters
    ----------
    axes : Axes
        Axes over x.
    view : ContactView
        The contact.
    y : float
        Position of the line, mm.
    margin : float
        Margin before and behind the contact, in half widths a.
    negligible : float
        Smallest component that is drawn, relative to the largest traction.
    """
    x, contact = view.x_over_a, view.contact
    axes.axhline(0.0, color=LOOK.grey, linewidth=0.6)
    largest = np.abs(contact.traction).max(axis=(1, 2))
    significant = largest > negligible * largest.max()
    pressure = _along_line(view, contact.pressure, y)
    same = np.isclose(*view.bound_ratios)
    for k, (name, color) in enumerate((("x", LOOK.blue), ("y", LOOK.vermillion))):
        bound = view.bound_ratios[k] * pressure
        if same and k == 0:
            label = r"$\pm\mu\,p_n$" if view.isotropic else "largest value of one component"
            _draw_bounds(axes, x, bound, LOOK.grey, label)
        elif not same and significant[k]:
            _draw_bounds(axes, x, bound, color, f"bound of $p_{name}$")
        if significant[k]:
            traction = _along_line(view, contact.traction[k], y)
            axes.plot(x, traction, color=color, label=f"$p_{name}$")
    inside = x[contact.touching.any(axis=1)]
    axes.set_xlim(inside.min() - margin, inside.max() + margin)


def _draw_bounds(axes: Axes, x: np.ndarray, bound: np.ndarray, color: str, label: str) -> None:
    """Fill the range between a traction bound (n_x,) and its negative."""
    axes.fill_between(x, -bound, bound, color=color, alpha=0.1, linewidth=0)
    axes.plot(x, bound, color=color, linewidth=0.7, linestyle="--", label=label)
    axes.plot(x, -bound, color=color, linewidth=0.7, linestyle="--")


def _along_line(view: ContactView, values: np.ndarray, y: float) -> np.ndarray:
    """Return values (n_x,) along a line of constant y, over the scale's pressure."""
    return np.array([np.interp(y, view.y, row) for row in values]) / view.scale.pressure


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


@contact_figure(
    "pressure-along-roller",
    needs=[
        WIDE,
        Need(
            lambda view: view.contact.scene.gap is not None and view.contact.scene.body.has_roller,
            "a roller: add body.A.profile to the scene",
        ),
    ],
)
def pressure_along_roller(view: ContactView) -> Figure:
    """Peak pressure and load per length over the position along a roller.

    Raises
    ------
    ValueError
        If no body has a profile.

    Examples
    --------
    >>> steel, inf = {"young": 208e3, "poisson": 0.3}, float("inf")
    >>> roller = steel | {"radius_x": 6.0, "radius_y": inf, "width": 12.0, "profile": "logarithmic"}
    >>> ring = steel | {"radius_x": 40.0, "radius_y": inf}
    >>> load = {"normal": 1e4, "tilt": 0.5}
    >>> tilted = ts.solve(ts.Scene(body={"A": roller, "B": ring}, load=load))
    >>> plot.pressure_along_roller(tilted)
    <Figure size ...>
    """
    contact = view.contact
    title = f"pressure along the roller; tilt {contact.tilt:.3g} mrad"
    figure, axes = new_axes(1.2, 0.7, view.describe(title))
    per_length = contact.pressure.sum(axis=0) * contact.grid.dx
    axes.plot(view.y, contact.pressure.max(axis=0), color=LOOK.blue, label="peak pressure (MPa)")
    axes.plot(view.y, per_length, color=LOOK.vermillion, label="load per length (N/mm)")
    axes.set(xlabel="$y$ (mm)", ylabel="MPa, N/mm")
    axes.set_ylim(bottom=0.0)
    axes.legend(loc="best")
    return figure


@contact_figure(
    "conformal-patch",
    needs=[
        Need(
            lambda view: not view.contact.scene.patch.is_flat,
            "a curved patch: add [conformal] to the scene",
        ),
    ],
)
def conformal_patch(view: ContactView) -> Figure:
    """Peak pressure and largest traction of a curved patch over the angle around its axis.

    Raises
    ------
    ValueError
        If the patch is flat.

    Examples
    --------
    >>> plot.conformal_patch(ts.solve(ts.Scene.builtin("ball-in-groove")))
    <Figure size ...>
    """
    contact = view.contact
    patch = required(contact.scene.conformal, "conformal").patch(contact.scene)
    figure, axes = new_axes(1.2, 0.7, view.describe("pressure over the angle"))
    along, axis = (1, contact.grid.x) if patch.line else (0, contact.grid.y)
    degrees = np.degrees(axis / patch.radius)
    pressure = contact.pressure.max(axis=along)
    axes.plot(degrees, pressure, color=LOOK.blue, label="peak pressure")
    if contact.traction.any():
        traction = np.hypot(*contact.traction).max(axis=along)
        axes.plot(degrees, traction, color=LOOK.vermillion, label="largest traction")
    axes.set(xlabel="angle from the middle of the patch (degrees)", ylabel="MPa")
    axes.set_ylim(bottom=0.0)
    axes.legend(loc="best")
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
    for at, shade in zip(places, record_colours(len(places)), strict=True):
        pressure = history.field("pressure", at)[:, 0]
        label = format_place(history.coordinate, at)
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


@contact_figure("pressure", line=line_pressure)
def pressure(view: ContactView) -> Figure:
    """Map of the contact pressure p_n.

    Examples
    --------
    >>> plot.pressure(contact)
    <Figure size ...>
    """
    figure, chart = ContactMap.single(view, "contact pressure")
    mesh = chart.fill(view.contact.pressure / view.scale.pressure, cmap=LOOK.pressure, vmin=0.0)
    chart.add_colour_bar(mesh, f"contact pressure {view.scale.pressure_label('p_n')}")
    return figure


@contact_figure("traction", line=line_traction, shown=has_traction)
def traction(view: ContactView) -> Figure:
    """Map of the traction ||p_t||_mu on body A, its directions, and the edge of stick.

    With isotropic friction this is |p_t|/mu.

    Examples
    --------
    >>> plot.traction(contact)
    <Figure size ...>
    """
    figure, chart = ContactMap.single(view, "traction on A, dashed: end of stick")
    mesh = chart.fill(view.contact.utilisation / view.scale.pressure, cmap=LOOK.traction, vmin=0.0)
    chart.draw_stick_edge()
    chart.draw_arrows(view.contact.traction, view.contact.touching, color="white")
    symbol = r"|p_t|/\mu" if view.isotropic else r"\|p_t\|_\mu"
    chart.add_colour_bar(mesh, f"traction over friction {view.scale.pressure_label(symbol)}")
    return figure


@contact_figure("stick-slip", needs=[WIDE], shown=has_traction)
def stick_slip_map(view: ContactView) -> Figure:
    """Map of the zones of stick and slip, and the directions of the slip of A over B.

    The percentages count all elements. The steps of the leading edge, which slip because the
    traction bound nearly vanishes there, have the colour of the zone behind them.

    Examples
    --------
    >>> plot.stick_slip_map(history, revolution=0)
    <Figure size ...>
    """
    figure, chart = ContactMap.single(view, "stick, and slip of A over B")
    chart.fill_zones(LOOK.sky, LOOK.orange)
    chart.draw_arrows(view.contact.slip, view.slip_zone, color="black")
    sliding = np.count_nonzero(view.contact.sliding) / np.count_nonzero(view.contact.touching)
    stick = Patch(color=LOOK.sky, label=f"stick, {1 - sliding:.0%}")
    slip = Patch(color=LOOK.orange, label=f"slip, {sliding:.0%}")
    place: dict[str, Any] = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.02)}
    chart.axes.legend(handles=[stick, slip], handlelength=1.0, **place)
    return figure


@contact_figure("wear", needs=[WIDE], shown=lambda view: bool(view.contact.wear.any()))
def wear_map(view: ContactView) -> Figure:
    """Map of the wear depth of both bodies together, in the contact.

    Examples
    --------
    >>> plot.wear_map(history)
    <Figure size ...>
    """
    figure, chart = ContactMap.single(view, "wear of both bodies together")
    mesh = chart.fill_up_to_edge(MICRON * view.contact.wear, cmap=LOOK.wear)
    chart.add_colour_bar(mesh, r"wear depth $w$ ($\mathrm{\mu m}$)")
    return figure


@contact_figure(
    "{field}",
    needs=[WIDE],
    each=lambda view: [{"field": k} for k in (view.history.user_fields if view.history else ())],
)
def _observed_field(view: ContactView, field: str) -> Figure:
    """Map of a field that an observer of the scene computes, for example of a displacement."""
    history = required(view.history, "history")
    quantity = history.user_fields[field]
    figure, chart = ContactMap.single(view, quantity.long_name)
    label = f"{field} ({quantity.unit})"
    chart.fill_surface(history.field(field, view.at), label, cmap=LOOK.pressure)
    return figure


@history_figure("wear-profiles", needs=[WIDE], shown=has_worn_contacts)
def wear_depth_profiles(history: History) -> Figure:
    """Wear depth of both bodies together across the track, at up to eight stored revolutions.

    Examples
    --------
    >>> plot.wear_depth_profiles(history)
    <Figure size ...>
    """
    figure, axes = lateral_axes(history, "wear of both bodies together")
    depth = _profiles_by_coordinate(history, "wear_profile")
    _draw_records(axes, history, lambda at: MICRON * depth[at])
    axes.invert_yaxis()
    axes.set_ylabel(r"wear depth $w$ ($\mathrm{\mu m}$)")
    return figure


def _measured_body(history: History) -> str:
    """Return the body to which a measured gap belongs; empty if there is none."""
    gap = history.scene.gap
    if gap is None or np.isnan(history["measured_profile"]).any():  # a file without it
        return ""
    return gap.body or "A"


def _is_worn_evenly(history: History) -> bool:
    """Return whether several contacts are stored and wear is equal around the circumference."""
    worn = (history["wear_profile"] > 0.0).any()
    evenly = np.isfinite(history["wear_per_revolution"]).any()
    return has_worn_contacts(history) and bool(worn and evenly)


@history_figure(
    "worn-profiles",
    needs=[
        WIDE,
        Need(
            lambda history: (history["wear_profile"] > 0.0).any() or bool(_measured_body(history)),
            "wear, or a measured [gap]",
        ),
    ],
    shown=_is_worn_evenly,
)
def worn_profiles(history: History, margin: float = 0.15) -> Figure:
    """Undeformed cross sections of both bodies across the track, at up to eight revolutions.

    A is above B, and they touch before they wear. The heights contain the radii R_y, the wear depth
    of each body, and a measured [gap] at x = 0: on its body, or else on A. They are exaggerated.

    Parameters
    ----------
    history : History
        History with wear or a measured gap.
    margin : float
        Margin on each side of the worn track, over its half width.

    Raises
    ------
    ValueError
        If nothing is worn or measured.

    Examples
    --------
    >>> plot.worn_profiles(history)
    <Figure size ...>
    """
    worn_at = history.y[(history["wear_profile"] > 0.0).any(axis=0)]
    figure, axes = lateral_axes(history, "sections of the bodies")
    y = history.y / Scale.from_history(history).across
    # Of unworn bodies twice the half width of the contact is shown.
    half = np.abs(worn_at).max() if worn_at.size else 2.0 * history["half_width_y"].max()
    shown = np.abs(history.y) <= (1.0 + margin) * half
    surfaces = {body: _surface_heights(history, body) for body in BODIES}
    _draw_records(axes, history, *(surfaces[body].__getitem__ for body in BODIES))
    last = history.saved[-1].item()
    selected = [heights[at] for heights in surfaces.values() for at in (0, last) if at in heights]
    heights = np.array(selected)[:, shown]
    space = 0.12 * np.ptp(heights)
    ends = {"A": heights.max() + space, "B": heights.min() - space}
    for body, end in ends.items():
        look: dict[str, Any] = {"color": LOOK.grey, "alpha": 0.12, "linewidth": 0.0}
        axes.fill_between(y, surfaces[body][last], end, **look)
        name = f"{body}, with the measured profile" if body == _measured_body(history) else body
        place, align = (0.96, "top") if body == "A" else (0.04, "bottom")
        axes.text(0.02, place, name, transform=axes.transAxes, fontsize="large", va=align)
    axes.set(xlim=(y[shown].min(), y[shown].max()), ylim=(ends["B"], ends["A"]))
    axes.set_ylabel(r"height $z$ ($\mathrm{\mu m}$)")
    return figure


@history_figure(
    "profiles", needs=[WIDE], columns=["measured_profile"], shown=lambda history: len(history) == 1
)
def _measured_profiles(history: History) -> Figure:
    """Cross sections of both bodies across the track, with the measured profile."""
    return worn_profiles(history)


def _surface_heights(history: History, body: str) -> dict[float, np.ndarray]:
    """Return heights (n_y,) of a body's surface, micrometres, by the coordinate of each record."""
    upwards = 1.0 if body == "A" else -1.0
    crowns = {b: history.y**2 / (2.0 * getattr(history.scene.body, b).radius_y) for b in BODIES}
    crown = crowns[body]
    if body == _measured_body(history):
        measured = _profiles_by_coordinate(history, "measured_profile")[history.saved[-1].item()]
        crown = crown + measured - (measured + sum(crowns.values())).min()  # as they touch
    depth = _profiles_by_coordinate(history, f"wear_profile_{body}")
    return {at: upwards * MICRON * (crown + worn) for at, worn in depth.items()}


@history_figure("pressure-profiles", line=line_pressures, shown=has_contacts)
def pressure_profiles(history: History) -> Figure:
    """Largest pressure over x at each y, for up to eight of the stored revolutions.

    Examples
    --------
    >>> plot.pressure_profiles(history)
    <Figure size ...>
    """
    figure, axes = lateral_axes(history, "peak pressure in each row")
    scale = Scale.from_history(history)
    _draw_records(
        axes, history, lambda at: history.field("pressure", at).max(axis=0) / scale.pressure
    )
    axes.set(ylim=(0.0, None), ylabel=scale.pressure_label(r"\max_x\, p_n"))
    return figure


def lateral_axes(history: History, quantity: str) -> tuple[Figure, Axes]:
    """Return a figure and its axes over y, the position across the track."""
    scale = Scale.from_history(history)
    figure, axes = new_axes(1.25, 0.7, history_title(history, quantity, scale.note))
    axes.set_xlabel(scale.length_label("y", across=True))
    return figure, axes


def _profiles_by_coordinate(history: History, name: str) -> dict[float, np.ndarray]:
    """Return the values (n_y,) of a profile column by the coordinate of each record."""
    return dict(zip(history[history.coordinate.name].tolist(), history[name], strict=True))


def _draw_records(axes: Axes, history: History, *functions: Callable[[float], np.ndarray]) -> None:
    """Draw functions of the coordinate over y at up to eight stored records, later ones darker."""
    y = history.y / Scale.from_history(history).across
    places = select_evenly(history.saved).tolist()
    for at, shade in zip(places, record_colours(len(places)), strict=True):
        lines = axes.plot(y, np.transpose([function(at) for function in functions]), color=shade)
        lines[0].set_label(format_place(history.coordinate, at))
    axes.set_xlim(y.min(), y.max())
    if len(places) > 1:
        title = math_label(history.coordinate)
        axes.figure.legend(title=title, loc="outside right center")


@history_figure("pressure-over-{coordinate}", needs=[WIDE], shown=has_contacts)
def pressure_over_revolutions(history: History) -> Figure:
    """Maps of the contact pressure p_n/p_0, one for each of up to six stored revolutions.

    Examples
    --------
    >>> plot.pressure_over_revolutions(history)
    <Figure size ...>
    """

    def pressure(view: ContactView) -> np.ndarray:
        return view.contact.pressure / view.scale.pressure

    charts, highest = _map_row(history, "contact pressure", pressure)
    for chart in charts:
        mesh = chart.fill(pressure(chart.view), cmap=LOOK.pressure, vmin=0.0, vmax=highest)
    label = f"contact pressure {chart.view.scale.pressure_label('p_n')}"
    chart.add_colour_bar(mesh, label)
    return chart.figure


@history_figure(
    "slip-over-{coordinate}",
    needs=[WIDE],
    # All stored contacts roll, or all shift: their slips have one unit.
    shown=lambda history: (
        has_contacts(history)
        and len({history.scene.schedule.shifts_at(place) for place in history.saved}) == 1
    ),
)
def slip_over_revolutions(history: History) -> Figure:
    """Maps of the slip |s|/V (|s| in shifts) and the edge of stick, for up to six revolutions.

    Examples
    --------
    >>> plot.slip_over_revolutions(history)
    <Figure size ...>
    """

    def slip(view: ContactView) -> np.ndarray:
        return np.hypot(*view.contact.slip)

    shifts = all(map(history.scene.schedule.shifts_at, history.saved))
    quantity, symbol = (
        ("slip of the step", "$|s|$ (mm)") if shifts else ("slip over speed", "$|s|/V$")
    )
    charts, highest = _map_row(history, quantity, slip)
    for chart in charts:
        mesh = chart.fill_up_to_edge(slip(chart.view), cmap=LOOK.slip, vmin=0.0, vmax=highest)
        chart.draw_stick_edge()
    chart.add_colour_bar(mesh, f"{quantity} {symbol}")
    return chart.figure


@history_figure(
    "wear-over-{coordinate}",
    needs=[WIDE],
    shown=lambda history: has_worn_contacts(history) and has_contacts(history),
)
def wear_over_revolutions(history: History) -> Figure:
    """Maps of the wear depth of both bodies together, for up to six of the stored revolutions.

    Examples
    --------
    >>> plot.wear_over_revolutions(history)
    <Figure size ...>
    """

    def wear(view: ContactView) -> np.ndarray:
        return MICRON * view.contact.wear

    charts, highest = _map_row(history, "wear depth", wear)
    for chart in charts:
        mesh = chart.fill_up_to_edge(wear(chart.view), cmap=LOOK.wear, vmin=0.0, vmax=highest)
    chart.add_colour_bar(mesh, r"wear depth $w$ ($\mathrm{\mu m}$)")
    return chart.figure


def _map_row(
    history: History, quantity: str, values: Callable[[ContactView], np.ndarray], count: int = 6
) -> tuple[list[ContactMap], float]:
    """Return maps of at most `count` stored contacts, and the largest value in them."""
    views = [ContactView.from_source(history, at) for at in select_evenly(history.saved, count)]
    views = [view for view in views if view.contact.touching.any()] or views
    _, charts = ContactMap.row(views, quantity)
    return charts, float(max(values(view)[view.contact.touching].max() for view in views))


_TEMPERATURE = r"temperature $T$ ($^\circ$C)"


def _surface_temperature(view: ContactView) -> Mapping[str, np.ndarray]:
    """Return the temperature of the surface of each body; figures that need it check it."""
    return required(view.contact.heat, "heat").temperature


def _temperature_over_x(view: ContactView) -> Figure:
    """Draw the temperature of both surfaces of a line contact."""
    figure, axes = rolling_axes("surface temperature", view)
    for body, style in (("A", "-"), ("B", "--")):
        values = _surface_temperature(view)[body][:, 0]
        axes.plot(view.x_over_a, values, style, label=f"body {body}")
    axes.set_ylabel(_TEMPERATURE)
    axes.legend()
    return figure


@contact_figure(
    "temperature",
    line=_temperature_over_x,
    needs=[
        Need(
            lambda view: view.contact.heat,
            "the temperature of a contact: add [heat] to the scene, and store the fields of "
            "the record",
        )
    ],
)
def temperature(view: ContactView) -> Figure:
    """Temperature of the surfaces: a map of A, or both surfaces of a line contact over x.

    Raises
    ------
    ValueError
        If the scene has no [heat].

    Examples
    --------
    >>> plot.temperature(ts.solve(ts.Scene.builtin("hot-discs")))
    <Figure size ...>
    """
    figure, chart = ContactMap.single(view, "surface temperature of A")
    chart.fill_surface(_surface_temperature(view)["A"], _TEMPERATURE, cmap=LOOK.slip)
    return figure


def _friction_in_use(view: ContactView) -> tuple[np.ndarray, str]:
    """Return the traction over the bound of static friction, and its label."""
    contact = view.contact
    used = np.divide(contact.utilisation, np.where(contact.touching, contact.pressure, 1.0))
    return used, r"$|p_t|/(\mu p_n)$" if view.isotropic else r"$\|p_t\|_\mu/p_n$"


def _friction_over_x(view: ContactView) -> Figure:
    """Draw the local coefficient of friction in use, in a line contact."""
    used, label = _friction_in_use(view)
    figure, axes = rolling_axes("friction in use", view)
    axes.plot(view.x_over_a, np.where(view.contact.touching, used, np.nan)[:, 0])
    axes.set(ylabel=label, ylim=(0.0, 1.05))
    return figure


@contact_figure("friction", line=_friction_over_x, shown=lambda view: view.contact.friction_varies)
def friction(view: ContactView) -> Figure:
    """Local coefficient of friction in use over the static one, ||p_t||_mu/p_n.

    In slip this is the factor by which speed, temperature and strength reduce friction.

    Examples
    --------
    >>> plot.friction(ts.solve(ts.Scene.builtin("hot-discs")))
    <Figure size ...>
    """
    used, label = _friction_in_use(view)
    figure, chart = ContactMap.single(view, "friction in use, dashed: end of stick")
    mesh = chart.fill_up_to_edge(used, cmap=LOOK.slip, vmin=0.0, vmax=1.0)
    chart.draw_stick_edge()
    chart.add_colour_bar(mesh, f"friction {label}")
    return figure


@apply_style
def animate(history: History, path: str | PathLike[str], rate: float = 2.0) -> Path:
    """Draw pressure and wear, or traction of a [transient], as an animated GIF; return its path.

    For a [transient] it shows the traction and the edge of stick at the stored distances.

    Parameters
    ----------
    history : History
        History to draw; its fields are read record by record.
    path : path-like
        File to write; a name that ends in ".gif".
    rate : float
        Records per second.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    ValueError
        If the name has another ending, fewer than two records are stored, or the bodies touch
        along a line, which has no map.

    Examples
    --------
    >>> plot.animate(history, "discs.gif").name
    'discs.gif'
    """
    path = Path(path)
    if path.suffix.lower() != ".gif":
        raise ValueError(f'path: a name that ends in ".gif"; not {path.name!r}')
    WIDE.check(history)
    if len(history.saved) < 2:
        raise ValueError(
            "an animation needs at least two stored records, there is "
            f"{len(history.saved)}: list more in {history.scene.schedule.save_key}"
        )
    envelope = _envelope(history)
    frame = MapFrame.from_contacts(envelope, width=0.6 * LOOK.width)
    # In a history in steps the edge of stick moves while A is shifted over B.
    track, draw = (0.0, _draw_traction) if "shift_x" in history.columns else (1.6, _draw_wear)
    layout = MapLayout.current()
    width = layout.row_width(frame, 1) + track + 0.2
    figure = new_map_figure(width, frame, history.title, positions=True)
    pictures = []
    # Once saved, a figure without a layout takes the layout of the settings.
    with mpl.rc_context({"figure.constrained_layout.use": False}):
        for view in _views(history):
            for axes in list(figure.axes):
                axes.remove()
            chart = ContactMap(figure, layout.left, view, frame)
            chart.axes.set_title(view.position, loc="center")
            draw(chart, envelope)
            pixels = BytesIO()
            figure.savefig(pixels, format="png", dpi=110)
            pictures.append(Image.open(pixels).convert("RGB"))
    memory, duration = BytesIO(), int(1000 / rate)
    first, *further = pictures
    first.save(memory, "gif", save_all=True, append_images=further, duration=duration, loop=0)
    return write_file(path, memory.getbuffer())


def _views(history: History, max_frames: int = 100) -> Iterator[ContactView]:
    """Yield at most `max_frames` stored contacts, evenly spaced over the records."""
    for at in select_evenly(history.saved, max_frames):
        interrupt.raise_if_interrupted()
        yield ContactView.from_source(history, at)


def _envelope(history: History) -> ContactView:
    """Return the first contact with each element's largest pressure and wear over all records."""
    views = _views(history)
    envelope = next(views)
    for view in views:
        pressure = np.maximum(envelope.contact.pressure, view.contact.pressure)
        wear = np.maximum(envelope.contact.wear, view.contact.wear)
        contact = replace(envelope.contact, pressure=pressure, wear=wear)
        envelope = replace(envelope, contact=contact)
    return envelope


def _draw_wear(chart: ContactMap, envelope: ContactView) -> None:
    """Draw one frame: the pressure map, and the wear depth over y next to it."""
    view, frame, layout = chart.view, chart.frame, MapLayout.current()
    p = view.scale.pressure
    highest = envelope.contact.pressure.max() / p
    mesh = chart.fill(view.contact.pressure / p, cmap=LOOK.pressure, vmin=0.0, vmax=highest)
    chart.add_colour_bar(mesh, f"contact pressure {view.scale.pressure_label('p_n')}")
    right = layout.left + frame.width + layout.right
    track = add_axes(chart.figure, right, layout.bottom, 1.6, frame.height)
    track.plot(MICRON * view.contact.wear[0], view.y_over_a, color=LOOK.blue)
    deepest = 1.05 * MICRON * envelope.contact.wear.max() or 1.0
    track.set(xlim=(0.0, deepest), ylim=(frame.bottom, frame.top), xlabel=r"$w$ ($\mathrm{\mu m}$)")
    track.yaxis.set_major_locator(chart.axes.yaxis.get_major_locator())
    track.tick_params(labelleft=False)


def _draw_traction(chart: ContactMap, envelope: ContactView) -> None:
    """Draw one frame: the traction map with the edge of stick.

    The colours end at the largest contact pressure of all records: no traction is larger.
    """
    view = chart.view
    p = view.scale.pressure
    highest = envelope.contact.pressure.max() / p
    mesh = chart.fill(view.contact.utilisation / p, cmap=LOOK.traction, vmin=0.0, vmax=highest)
    if view.contact.touching.any():
        chart.draw_stick_edge()
        chart.draw_arrows(view.contact.traction, view.contact.touching, color="white")
    symbol = r"|p_t|/\mu" if view.isotropic else r"\|p_t\|_\mu"
    chart.add_colour_bar(mesh, f"traction over friction {view.scale.pressure_label(symbol)}")
