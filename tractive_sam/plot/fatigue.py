"""Fatigue of the material: shakedown, utilisation, damage, and wear against fatigue."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh

from tractive_sam.description import math_value
from tractive_sam.plot.contact_map import WIDE, Need, has_course, select_evenly, share_y_axis
from tractive_sam.plot.figure import (
    LOOK,
    MICRON,
    Figure,
    Scale,
    history_title,
    label_course,
    new_axes,
    new_figure,
    set_title,
)
from tractive_sam.plot.history_curves import draw_column
from tractive_sam.plot.registry import history_figure
from tractive_sam.results import BODIES, BodyFatigue, History
from tractive_sam.schema import required

LINE_CONTACT = np.array(
    [
        (0.00, 3.107, 4.000, 8.660),
        (0.05, 3.096, 3.772, 7.734),
        (0.10, 3.063, 3.564, 6.342),
        (0.15, 3.010, 3.375, 5.104),
        (0.20, 2.936, 3.202, 4.177),
        (0.25, 2.843, 3.044, 3.499),
        (0.30, 2.598, 2.900, 2.997),
        (0.35, 2.342, 2.767, 2.615),
        (0.40, 2.123, 2.644, 2.316),
        (0.45, 1.937, 2.531, 2.077),
        (0.50, 1.777, 2.426, 1.882),
        (0.60, 1.521, 2.209, 1.583),
    ]
)
"""A line contact in full slip with nu = 0.3, by von Mises, from its closed form: friction, p0/k at
first yield, and p0/k up to which shakedown is certain inside and at the surface."""

_COMPUTED = Need(
    lambda history: any(name in history.columns for name in _COURSES),
    "damage or shakedown: add fatigue.limit or fatigue.shear_yield to the scene",
)

_WEARS = Need(lambda history: "worn_volume" in history.columns, "wear: add [wear] to the scene")


def _each_body(history: History) -> list[dict[str, str]]:
    """Return the arguments {"body": ...} of the figures of each body with fatigue."""
    return [{"body": body} for body in history.cycles]


@history_figure("shakedown-map", columns=["shakedown_lower"], cure="fatigue.shear_yield")
def shakedown_map(history: History) -> Figure:
    """Shakedown map: p_max/k over the tangential force ratio of the records, with limits.

    Peak contact pressure over k, and tangential over normal force. Triangles are the limits
    computed from the stress of the last record, for tractions that increase in proportion.

    Raises
    ------
    ValueError
        If there is no yield stress.

    Examples
    --------
    >>> tired = scene.replace(fatigue={"shear_yield": 300.0, "bodies": ["A"]})
    >>> plot.shakedown_map(ts.roll(tired))
    <Figure size ...>
    """
    k = required(history.scene.fatigue, "fatigue").shear_yield_stress
    figure, axes = new_axes(1.15, 0.85, history_title(history, f"shakedown; k = {k:.4g} MPa"))
    mu, first, inside, surface = LINE_CONTACT.T
    axes.plot(mu, first, color=LOOK.grey, linestyle=":", label="first yield, line contact")
    axes.plot(mu, np.minimum(inside, surface), color=LOOK.grey, label="certain, line contact")
    label = r"$1/\mu$, plane Tresca at the surface"
    classic = np.linspace(1.0 / 8.0, mu[-1], 200)
    axes.plot(classic, 1.0 / classic, color=LOOK.grey, linestyle="--", label=label)
    force = np.hypot(history["Qx_over_P"], history["Qy_over_P"])
    load = history["p_max"] / k
    axes.plot(force, load, color="black", linewidth=0.8)
    records = {len(history) - 1: ("last record" if has_course(history) else "this contact", 4.5)}
    if has_course(history):
        records = {0: ("first record", 8.0)} | records
    for row, (label, size) in records.items():  # the first one encloses the last one
        look: dict[str, Any] = {"color": "black", "markersize": size}
        look["markerfacecolor"] = "none" if size > 5.0 else "black"
        axes.plot(force[row], load[row], "o", label=label, **look)
    _draw_limits(axes, history, force[-1], load[-1])
    highest = np.nanmax([*load, *(history["shakedown_upper"][-1] * load[-1]), 4.2])
    axes.set(xlim=(0.0, max(0.6, 1.1 * force.max())), ylim=(0.0, 1.1 * highest))
    axes.set(xlabel="tangential force / normal load", ylabel=r"$p_\mathrm{max}/k$")
    figure.legend(loc="outside right center")
    return figure


def _draw_limits(axes: Axes, history: History, force: float, load: float) -> None:
    """Draw the last record's shakedown limits of both bodies as triangles, larger ones for B."""
    limits = (
        ("shakedown_lower", "^", "certain up to"),
        ("shakedown_upper", "v", "impossible above"),
    )
    for column, marker, label in limits:
        for k, body in _fatigue_bodies(history):
            color = LOOK.bodies[body]
            look: dict[str, Any] = {"color": color, "markersize": 4.5}
            if body == "B":
                look |= {"markersize": 9.0, "markerfacecolor": "none"}
            limit = history[column][-1, k] * load
            axes.plot(force, limit, marker, linestyle="none", label=f"{label}, {body}", **look)


@history_figure("utilisation-{body}", columns=["damage"], cure="fatigue.limit", each=_each_body)
def utilisation(history: History, body: str = "A", at: float | None = None, **named) -> Figure:
    """Map of a body's utilisation, equivalent stress over limit, over y and depth.

    Parameters
    ----------
    history : History
        History of a scene with a fatigue limit.
    body : "A" or "B"
        The body.
    at : float, optional
        One of the saved values, as for `History.field`; the last by default.

    Raises
    ------
    LookupError
        If the record was not stored.
    ValueError
        If there is no limit.

    Examples
    --------
    >>> limit = {"limit": 250.0, "sensitivity": 0.3, "bodies": ["A"]}
    >>> tired = ts.roll(discs.replace(subsurface=None, fatigue=limit))
    >>> plot.utilisation(tired, "A")
    <Figure size ...>
    """
    fatigue, scale = history.fatigue(body, at, **named), Scale.from_history(history)
    position = math_value(history.coordinate, history.saved[history.row_of(at, **named)])
    figure, (axes,) = _new_sections(history, f"utilisation of body {body}, {position}", 1)
    # Between its depths it is interpolated over their root, at 120 depths.
    depth = fatigue.depth[-1] * np.linspace(0.0, 1.0, 120) ** 2
    roots = np.sqrt(depth), np.sqrt(fatigue.depth)
    values = np.stack([np.interp(*roots, row) for row in fatigue.utilisation])
    y, z = _set_section(axes, fatigue, scale), depth / scale.length
    mesh = _draw_values(axes, y, z, values, cmap=LOOK.stress)
    top = fatigue.largest()
    axes.plot(top.at[1] / scale.across, top.at[2] / scale.length, "o", **_MARK)
    if values.max() > 1.0 > values.min():
        level = np.broadcast_to(values.T, (depth.size, y.size))
        axes.contour(y, z, level, levels=[1.0], colors="white", linewidths=1.0)
    figure.colorbar(mesh, ax=axes, label="equivalent stress / limit")
    _add_shakedown_note(figure, history, body)
    return figure


@history_figure(
    "damage-{body}",
    columns=["damage"],
    cure="fatigue.limit",
    each=lambda history: [
        {"body": b} for b in history.cycles if history.fatigue(b).damage_max[0] > 0.0
    ],
)
def damage(history: History, body: str = "A", *, most: int = 4, decades: float = 6.0) -> Figure:
    """Maps of a body's damage over y and depth, for up to four stored records with damage.

    A line is the worn surface: the material above it is removed. The scale is logarithmic.

    Parameters
    ----------
    history : History
        History of a scene with a fatigue limit.
    body : "A" or "B"
        The body.
    most : int
        Most panels; of more records some are omitted.
    decades : float
        Decades of damage that the colours show.

    Raises
    ------
    LookupError
        If no record was stored.
    ValueError
        If there is no limit, or no damage.

    Examples
    --------
    >>> limit = {"limit": 250.0, "sensitivity": 0.3, "bodies": ["A"]}
    >>> tired = ts.roll(discs.replace(subsurface=None, fatigue=limit))
    >>> plot.damage(tired, "A")
    <Figure size ...>
    """
    scale = Scale.from_history(history)
    places = [at for at in history.saved.tolist() if history.fatigue(body, at).damage_max[0] > 0.0]
    if not places:
        raise ValueError("nothing to draw: without revolutions there is no damage")
    places = select_evenly(np.array(places), most).tolist()
    records = [history.fatigue(body, at) for at in places]
    figure, charts = _new_sections(history, f"damage of body {body}, log scale", len(places))
    highest = np.log10(max(fatigue.damage_max[0] for fatigue in records))
    for axes, fatigue, at in zip(charts, records, places, strict=True):
        remains = fatigue.zeta >= fatigue.worn[:, None]
        values = np.log10(np.maximum(fatigue.damage, 10.0 ** (highest - 2.0 * decades)))
        y = _set_section(axes, fatigue, scale)
        look: dict[str, Any] = {"cmap": LOOK.wear, "vmin": highest - decades, "vmax": highest}
        depth = fatigue.zeta / scale.length
        mesh = _draw_values(axes, y, depth, np.where(remains, values, np.nan), **look)
        worn = np.broadcast_to(fatigue.worn / scale.length, y.shape)
        axes.plot(y, worn, color=LOOK.vermillion, linewidth=1.2)
        _, top = fatigue.damage_max
        axes.plot(top[1] / scale.across, top[2] / scale.length, "o", **_MARK)
        axes.set_title(math_value(history.coordinate, at))
    share_y_axis(charts)
    figure.colorbar(mesh, ax=charts, label=r"$\log_{10} D$", extend="min")
    _add_shakedown_note(figure, history, body)
    return figure


@history_figure(
    "over-depth-{body}",
    needs=[
        Need(
            lambda history: bool(history.scene.steel),
            "values over the depth: add [residual.A], or [fatigue.A] with hardness, to the scene",
        )
    ],
    each=lambda history: [{"body": body} for body in history.scene.steel],
)
def over_depth(history: History, body: str = "A", at: float | None = None, **named) -> Figure:
    """Utilisation, residual stress and strength of a body over the depth below its unworn surface.

    The utilisation is that of the row with the largest one, in a stored record; without a limit
    the panel is missing.

    Parameters
    ----------
    history : History
        History of a scene with [residual], or with strength over the depth.
    body : "A" or "B"
        The body.
    at : float, optional
        One of the saved values, as for `History.field`; the last by default.

    Raises
    ------
    LookupError
        If the record was not stored.
    ValueError
        If the scene has neither residual stress nor strength of the body over the depth.

    Examples
    --------
    >>> case = {"depth": [0.0, 0.5, 1.0], "hardness": [720.0, 600.0, 380.0], "inclusion": 30.0}
    >>> table = {"sensitivity": 0.3, "A": case, "bodies": ["A"]}
    >>> peened = {"A": {"depth": [0.0, 0.3], "xx": [-400.0, 0.0], "yy": [-400.0, 0.0]}}
    >>> hard = ts.roll(discs.replace(subsurface=None, fatigue=table, residual=peened))
    >>> plot.over_depth(hard, "A")
    <Figure size ...>
    """
    scale, steel = Scale.from_history(history), history.scene.steel.get(body)
    if steel is None:
        raise ValueError(f"body {body} has neither residual stress nor strength over the depth")
    deepest = max(float(depth[-1]) for depth, _ in steel.curves.values())
    cycle = history.fatigue(body, at, **named) if body in history.cycles else None
    has_limit = cycle is not None and bool(np.isfinite(cycle.utilisation).any())
    if cycle is not None and has_limit:
        row = int(cycle.utilisation.max(axis=1).argmax())
        below = cycle.depth + (cycle.worn[row] if cycle.worn.size else 0.0)
        deepest = float(below[-1])
    zeta = np.linspace(0.0, deepest, 400)
    groups = {
        "residual stress (MPa)": {"xx": r"$\rho_{xx}$", "yy": r"$\rho_{yy}$"},
        "hardness (HV)": {"hardness": "hardness"},
        "strength (MPa)": {"limit": "fatigue limit", "shear_yield": "yield stress in shear $k$"},
    }
    columns = {k: names for k, names in groups.items() if names.keys() & steel.curves.keys()}
    figure = new_figure(0.55 * (len(columns) + has_limit) + 0.2, 0.85)
    panels = list(figure.subplots(1, len(columns) + has_limit, squeeze=False, sharey=True)[0])
    set_title(figure, history_title(history, f"body {body} over its depth", scale.note))
    panels[0].set_ylabel("depth below the unworn surface " + scale.length_label("z"))
    if cycle is not None and has_limit:
        used = panels.pop(0)
        used.plot(cycle.utilisation[row], below / scale.length, color="black")
        used.set_xlabel("utilisation")
        used.set_xlim(left=0.0)
    colors = LOOK.blue, LOOK.vermillion
    for axes, (label, names) in zip(panels, columns.items(), strict=True):
        for (name, text), color in zip(names.items(), colors, strict=False):
            if (values := steel.at(name, zeta)) is not None:
                axes.plot(values, zeta / scale.length, color=color, label=text)
        axes.set_xlabel(label)
        if len(names) > 1:
            axes.legend(loc="best", fontsize="small")
    (panels or [used])[0].set_ylim(deepest / scale.length, 0.0)
    return figure


@history_figure("fatigue-course", needs=[_COMPUTED], shown=has_course)
def fatigue_course(history: History) -> Figure:
    """Panels of computed damage, utilisation and shakedown factors of each body, over the course.

    Raises
    ------
    ValueError
        If the history has neither.

    Examples
    --------
    >>> limit = {"limit": 250.0, "sensitivity": 0.3, "bodies": ["A"]}
    >>> tired = ts.roll(discs.replace(subsurface=None, fatigue=limit))
    >>> plot.fatigue_course(tired)
    <Figure size ...>
    """
    draws = [draw for name, draw in _COURSES.items() if name in history.columns]
    figure = new_figure(1.0, 0.5 * len(draws) + 0.08)
    panels = figure.subplots(len(draws), sharex=True, squeeze=False)[:, 0]
    for axes, draw in zip(panels, draws, strict=True):
        draw(axes, history)
        axes.legend(loc="best", fontsize="small", ncols=2)
    label_course(panels[-1], history)
    set_title(figure, history_title(history, "fatigue of each body"))
    return figure


@history_figure(
    "wear-against-fatigue-{body}",
    columns=["damage"],
    cure="fatigue.limit",
    needs=[WIDE, _WEARS],
    each=_each_body,
)
def wear_against_fatigue(history: History, body: str = "A") -> Figure:
    """Wear of a revolution across the track, and the wear rate that balances fatigue.

    Cracks initiate in tracks with slower wear. Both follow from the last record.

    Raises
    ------
    ValueError
        If there is no limit, or nothing wears.

    Examples
    --------
    >>> limit = {"limit": 250.0, "sensitivity": 0.3, "bodies": ["A"]}
    >>> tired = ts.roll(discs.replace(subsurface=None, fatigue=limit))
    >>> plot.wear_against_fatigue(tired, "A")
    <Figure size ...>
    """
    nano, scale = 1e3 * MICRON, Scale.from_history(history)
    rate = nano * _wear_rate(history, body)
    balance = nano * history[f"balancing_wear_{body}"][_solved_rows(history)[-1]]
    title = history_title(history, f"wear and fatigue of body {body}", scale.note)
    figure, axes = new_axes(1.1, 0.7, title)
    y = history.y / scale.across
    worn, balancing = (np.where(values > 0.0, values, np.nan) for values in (rate, balance))
    axes.semilogy(y, worn, color=LOOK.blue, label="wear")
    axes.semilogy(y, balancing, color=LOOK.vermillion, label="balances fatigue")
    highest = max(np.nanmax(rate), np.nanmax(balance))
    axes.set_ylim(1e-4 * highest, 3.0 * highest)
    visible = (rate > 0.0) | (balance > 1e-4 * balance.max())
    if visible.any():
        reach = 1.1 * np.abs(y[visible]).max()
        axes.set_xlim(-reach, reach)
    slower = (rate < balance) & (balance > 1e-4 * highest)
    axes.fill_between(y, worn, balance, where=slower, color=LOOK.orange, alpha=0.3)
    axes.set(xlabel=scale.length_label("y", across=True), ylabel="depth per revolution (nm)")
    axes.legend(loc="best")
    return figure


_MARK: dict[str, Any] = {
    "markerfacecolor": "white", "markeredgecolor": "black", "markersize": 5.5, "zorder": 5
}  # fmt: skip


def _add_shakedown_note(figure: Figure, history: History, body: str) -> None:
    """Add a note to a figure if the stress exceeds the shakedown limit."""
    if "shakedown_lower" not in history.columns:
        return
    if np.nanmin(history["shakedown_lower"][:, BODIES.index(body)]) < 1.0:
        text = "Above the shakedown limit the stress in the material is not elastic."
        figure.supxlabel(text, fontsize="small")


def _wear_rate(history: History, body: str) -> np.ndarray:
    """Return wear depth per revolution between the last two solved records, mm, (n_y,); else 0."""
    rows = _solved_rows(history)
    depth, N = history[f"wear_profile_{body}"][rows], history[history.coordinate.name][rows]
    if len(N) < 2:
        return np.zeros(history.y.size)
    return np.maximum(depth[-1] - depth[-2], 0.0) / (N[-1] - N[-2])


def _solved_rows(history: History) -> np.ndarray:
    """Return the indices of the records with a solved contact."""
    return np.flatnonzero(history["converged"])


def _new_sections(history: History, quantity: str, count: int) -> tuple[Figure, list[Axes]]:
    """Return a figure with `count` panels over (y, depth) side by side, and the panels."""
    figure = new_figure(0.75 + 0.45 * count, 0.75)
    charts = list(figure.subplots(1, count, squeeze=False, sharey=True)[0])
    scale = Scale.from_history(history)
    charts[0].set_ylabel("depth " + scale.length_label("z"))
    set_title(figure, history_title(history, quantity, scale.note))
    return figure, charts


def _draw_values(
    axes: Axes, y: np.ndarray, depth: np.ndarray, values: np.ndarray, **style: Any
) -> QuadMesh:
    """Colour a section (y, depth) by values of shape (n_y, depths); return the mesh."""
    style["shading"] = "gouraud" if np.isfinite(values).all() else "nearest"
    values = np.broadcast_to(values.T, (depth.size, y.size))
    return axes.pcolormesh(y, depth, values, rasterized=True, **style)


def _set_section(axes: Axes, fatigue: BodyFatigue, scale: Scale) -> np.ndarray:
    """Set limits and x label of axes for the stressed section of a body; return y as drawn.

    A line contact is equal at all y: its section has two places.
    """
    axes.set_ylim(fatigue.depth[-1] / scale.length, 0.0)
    if fatigue.y.size == 1:
        axes.set_xlabel("line contact")
        axes.tick_params(labelbottom=False, bottom=False)
        return np.array([-0.5, 0.5])
    stressed = fatigue.utilisation.max(axis=1) > 0.05 * fatigue.utilisation.max()
    reach = min(1.15 * np.abs(fatigue.y[stressed]).max(), fatigue.y[-1]) / scale.across
    axes.set(xlim=(-reach, reach), xlabel=scale.length_label("y", across=True))
    return fatigue.y / scale.across


def _draw_damage(axes: Axes, history: History) -> None:
    """Draw the largest damage of each body over the course, and crack initiation."""
    highest = np.nanmax(history["damage"])
    for k, body in _fatigue_bodies(history):
        draw_column(axes, history, "damage", body, color=LOOK.bodies[body], label=f"body {body}")
        initiation = history["initiation"][-1, k]
        if np.isfinite(initiation):
            axes.axvline(initiation, color=LOOK.bodies[body], linestyle=":", linewidth=1.0)
    if highest > 0.3:
        axes.axhline(1.0, color=LOOK.grey, linewidth=0.8)
    axes.set(ylim=(0.0, None), ylabel="largest damage $D$")


def _draw_interior_and_surface(
    axes: Axes, history: History, name: str, label: str, limit: float | None = None
) -> None:
    """Draw a column of each body over the course: solid inside, dashed at the surface."""
    for kind, style in (("interior", "-"), ("surface", "--")):
        for _, body in _fatigue_bodies(history):
            line = f"{body}, {kind}"
            look: dict[str, Any] = {"color": LOOK.bodies[body], "linestyle": style}
            draw_column(axes, history, f"{name}_{kind}", body, label=line, **look)
    axes.set_ylim(bottom=0.0)
    if limit is not None:
        axes.axhline(limit, color=LOOK.grey, linewidth=0.8)
    axes.set_ylabel(label)


_COURSES: dict[str, Callable[[Axes, History], None]] = {
    "damage": _draw_damage,
    "utilisation": partial(_draw_interior_and_surface, name="utilisation", label="utilisation"),
    "shakedown_lower": partial(
        _draw_interior_and_surface,
        name="shakedown",
        label="certain up to (load factor)",
        limit=1.0,
    ),
}


def _fatigue_bodies(history: History) -> list[tuple[int, str]]:
    """Return (index, name) of each body of [fatigue]."""
    return [
        (BODIES.index(body), body) for body in required(history.scene.fatigue, "fatigue").bodies
    ]
