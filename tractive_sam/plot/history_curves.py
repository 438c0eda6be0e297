"""Curves over the course of histories, and the wear of load blocks and its regimes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

import tractive_sam as ts
from tractive_sam import mechanics  # its laws load the compiler when first used
from tractive_sam.description import format_with_unit, math_label
from tractive_sam.plot.contact_map import Need, has_course, is_worn
from tractive_sam.plot.fields import lateral_axes
from tractive_sam.plot.figure import (
    LOOK,
    MICRON,
    Figure,
    Scale,
    apply_style,
    current_options,
    format_title,
    history_title,
    label_course,
    line_colours,
    new_axes,
    new_figure,
    set_title,
)
from tractive_sam.plot.registry import history_figure
from tractive_sam.plot.stress import SURFACE_NOTE
from tractive_sam.results import BODIES, PARTS, SHARE, History, Quantity, State


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
    if "step_bulk" in history.columns:
        inside = history["step_bulk"].sum(axis=1)
        axes.plot(course, np.cumsum(inside), color=LOOK.green, label="inside the bodies")
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


_BLOCK_COLUMNS = (PARTS.name, SHARE.name)

_WORN = Need(lambda history: history[PARTS.name].any(), "wear, and there is none")


@history_figure("worn-by-block", columns=_BLOCK_COLUMNS, needs=[_WORN], cure="[[duty]]")
def worn_by_block(history: History) -> Figure:
    """Wear depth across the track at the end, divided among the blocks of a duty cycle.

    Raises
    ------
    ValueError
        If there are no blocks, or nothing is worn.

    Examples
    --------
    >>> spectrum = discs.replace(duty=({"revolutions": 1}, {"revolutions": 1, "shift_y": 0.2}))
    >>> plot.worn_by_block(ts.roll(spectrum))
    <Figure size ...>
    """
    figure, axes = lateral_axes(history, "wear of both bodies by block")
    axes.set_prop_cycle(color=line_colours(len(history.block_names)))
    y, depth = history.y / Scale.from_history(history).across, np.zeros(len(history.y))
    parts = history[PARTS.name][-1].sum(axis=1)
    for name, part in zip(history.block_names, parts, strict=True):
        below = depth + MICRON * part
        axes.fill_between(y, depth, below, label=name, alpha=0.8, linewidth=0.4)
        depth = below
    axes.plot(y, depth, color="black", linewidth=0.8)
    axes.invert_yaxis()
    axes.set(xlim=(y.min(), y.max()), ylabel=r"wear depth $w$ ($\mathrm{\mu m}$)")
    _add_legend(figure)
    return figure


@history_figure("block-shares", columns=_BLOCK_COLUMNS, needs=[_WORN], cure="[[duty]]")
def block_shares(history: History) -> Figure:
    """Share of each block of a duty cycle in the worn section, over the revolutions.

    Raises
    ------
    ValueError
        If there are no blocks, or nothing is worn.

    Examples
    --------
    >>> spectrum = discs.replace(duty=({"revolutions": 1}, {"revolutions": 1, "shift_y": 0.2}))
    >>> plot.block_shares(ts.roll(spectrum))
    <Figure size ...>
    """
    figure, axes = new_axes(
        title=history_title(history, "wear of both bodies by block"), width=1.25
    )
    worn = history["block_share"].sum(axis=1) > 0.0
    places, shares = history[history.coordinate.name][worn], history["block_share"][worn]
    label_course(axes, history)
    axes.set_prop_cycle(color=line_colours(len(history.block_names)))
    axes.stackplot(places, 100.0 * shares.T, labels=history.block_names, alpha=0.8)
    axes.set(ylim=(0.0, 100.0), ylabel="share of the worn section (%)")
    _add_legend(figure)
    return figure


def _has_wear_regimes(history: History) -> bool:
    """Return whether stored wear comes from separate laws of the bodies, or from several blocks."""
    scene = history.scene
    if "wear" in history.law_records or not scene.has("wear") or not len(history.saved):
        return False
    if not history["wear_profile"].any():
        return False
    return bool(history.block_names) or not scene.has("wear.together")


@history_figure("wear-regimes", shown=_has_wear_regimes)
def wear_regimes(source: History | State, laws: ts.Laws | None = None) -> Figure:
    """Rate of wear of the elements over their frictional work, T-gamma/A.

    A history shows its last stored contact, a duty cycle the last one of each block. A dot is an
    element that wears; a line is the law, if it has regimes of work.

    Parameters
    ----------
    source : History or State
        History or contact with wear.
    laws : Laws, optional
        Laws of the computation, if they differ from the scene's.

    Raises
    ------
    ValueError
        If nothing wears.

    Examples
    --------
    >>> contact = ts.roll(discs.with_set(["wear.law=usfd"])).state(2)
    >>> plot.wear_regimes(contact)
    <Figure size ...>
    """
    title = format_title(source.scene.title, "wear of each body over the work of each element")
    figure, axes = new_axes(1.25, 0.8, title)
    contacts = _last_contacts(source)
    axes.set_prop_cycle(color=line_colours(2 * len(contacts)))
    highest = max(float(_frictional_work(contact).max()) for contact in contacts.values())
    # Four decades of work, and beyond the largest one.
    limits = 1e-4 * highest, 2.0 * highest
    shown = [
        _draw_elements(axes, name, contact, laws, limits[0]) for name, contact in contacts.items()
    ]
    if not any(shown):
        raise ValueError("nothing to draw: no element wears; use a contact with slip and wear")
    axes.set(xscale="log", yscale="log", xlim=limits)
    _draw_laws(axes, next(iter(contacts.values())), laws, limits)
    axes.set_xlabel(r"frictional work $T\gamma/A$ (N/mm$^2$)")
    axes.set_ylabel(r"wear rate ($\mathrm{\mu g}$/(m mm$^2$))")
    _add_legend(figure)
    return figure


def _add_legend(figure: Figure, rows: int = 12) -> None:
    """Add a legend next to the axes, in columns of at most `rows` entries."""
    entries = sum(len(axes.get_legend_handles_labels()[1]) for axes in figure.axes)
    columns = -(-entries // rows)
    width, height = figure.get_size_inches().tolist()
    legend = figure.legend(loc="outside right center", ncols=columns, columnspacing=1.0)
    if columns > 1:  # the figure becomes wider
        legend_width = legend.get_window_extent().width / figure.dpi
        figure.set_size_inches(width + legend_width * (1.0 - 1.0 / columns), height)


def _last_contacts(source: History | State) -> dict[str, State]:
    """Return the last stored contact of each block by name ("" without blocks)."""
    if isinstance(source, State):
        return {"": source}
    blocks = {name: source.block(k) for k, name in enumerate(source.block_names)}
    return {name: history.state() for name, history in (blocks or {"": source}).items()}


def _wear_law(contact: State, laws: ts.Laws | None, *, warm: bool) -> ts.WearLaw | None:
    """Return the wear law of a contact, at its temperature if `warm`; None without wear."""
    # Loads compilers, which no other figure needs.
    from tractive_sam.contact import Laws, Model, wear_law_at  # noqa: PLC0415

    laws = laws or Laws.of_contact(contact, ("wear",))
    model = Model(contact.scene, grid=contact.grid, laws=laws)
    return wear_law_at(model, contact) if warm else model.wear_law


def _wear_rates(contact: State, laws: ts.Laws | None) -> dict[str, np.ndarray]:
    """Return wear rates (n_x, n_y) of each body that wears, µg/(m mm²); empty without wear."""
    law = _wear_law(contact, laws, warm=True)
    fields = contact.pressure, contact.traction, contact.slip
    if law is None or not contact.touching.any():
        return {}
    if isinstance(law, mechanics.PerBody):
        separate = {body: getattr(law, body) for body in BODIES}
        rates = {body: part.rate(*fields) for body, part in separate.items() if part is not None}
    else:
        share, of_bodies = contact.scene.wear_share, law.shares(*fields)
        if of_bodies is not None:
            share = dict(zip(BODIES, of_bodies, strict=True))
        rates = {body: share[body] * law.rate(*fields) for body in BODIES}
    # 1e3 µg/(m mm²) for 1 kg/m³ and a depth equal to the sliding distance.
    density = {body: getattr(contact.scene.body, body).density for body in rates}
    return {body: 1e3 * density[body] * rate for body, rate in rates.items()}


def _frictional_work(contact: State) -> np.ndarray:
    """Return the frictional work of the elements over their area, N/mm², shape (n_x, n_y)."""
    return np.maximum(-(contact.traction * contact.slip).sum(axis=0), 0.0)


def _draw_elements(
    axes: Axes, name: str, contact: State, laws: ts.Laws | None, lowest: float
) -> bool:
    """Draw wear rate over work of a contact's elements; return whether any element wears."""
    work, rates = _frictional_work(contact), _wear_rates(contact, laws)
    alike = len(rates) == 2 and np.allclose(rates["A"], rates["B"], rtol=1e-9)
    has_elements = False
    for body, marker in (("A", "o"), ("B", "^")):
        rate = rates.get(body, np.zeros_like(work))
        wears = (rate > 0.0) & (work > lowest)
        if wears.any() and not (alike and body == "B"):
            label = ", ".join(filter(None, (name, "A and B" if alike else body)))
            axes.plot(work[wears], rate[wears], marker, markersize=3, alpha=0.6, label=label)
            has_elements = True
    return has_elements


def _draw_laws(
    axes: Axes, contact: State, laws: ts.Laws | None, limits: tuple[float, float]
) -> None:
    """Draw the wear laws that have regimes over work, with the limits of their regimes."""
    law, wear = _wear_law(contact, laws, warm=False), contact.scene.wear
    label = "law, without heat" if wear is not None and wear.temperature else "law"
    lines: list[object] = []
    for body in BODIES:
        regimes = getattr(getattr(law, body, None), "regimes", None)
        if regimes is None or getattr(getattr(law, body), "element_area", None) or regimes in lines:
            continue
        lines.append(regimes)
        work = np.geomspace(*limits, 400)
        axes.plot(work, regimes(work)[0], color=LOOK.grey, linewidth=1.0, zorder=0, label=label)
        for start in regimes.starts[1:]:
            if start < limits[1]:
                axes.axvline(start, color=LOOK.grey, linewidth=0.6, linestyle=":", zorder=0)
