"""What rolling does to the material: shakedown, utilisation, damage, and wear against fatigue."""

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh

from tractive_sam.plot.conditions import WIDE, Need, in_course
from tractive_sam.plot.courses import COLOURS
from tractive_sam.plot.drawn import chosen
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.registry import history_figure
from tractive_sam.plot.scale import Scale
from tractive_sam.plot.style import (
    BLUE,
    GREY,
    MICRON,
    ORANGE,
    STRESS,
    VERMILLION,
    WEAR,
    WIDTH,
    along,
    place,
    set_title,
    told_of,
)
from tractive_sam.results import BODIES, BodyFatigue, History

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
"""Of a line contact in full slip with nu = 0.3, by von Mises: friction, p0/k at first yield, and
that up to which shakedown is certain inside and at the surface; of its closed form."""

PANELS = 4
"""Maps of a figure; of more revolutions some are left out."""

DECADES = 6.0
"""Of damage that are shown."""

FINE = 120
"""Depths at which a utilisation is drawn."""

_COMPUTED = Need(
    lambda history: any(name in history.columns for name in _COURSES),
    "damage or shakedown: add fatigue.limit or fatigue.shear_yield to the scene",
)

_WEARS = Need(lambda history: "worn_volume" in history.columns, "wear: add [wear] to the scene")


def _of_bodies(history: History) -> list[dict[str, str]]:
    return [{"body": body} for body in history.cycles]


def _damaged(history: History) -> list[dict[str, str]]:
    return [{"body": b} for b in history.cycles if history.fatigue(b).damage_max[0] > 0.0]


@history_figure("shakedown-map", columns=["shakedown_lower"], cure="fatigue.shear_yield")
def shakedown_map(history: History) -> Figure:
    """The place of a roll on the shakedown map, with its own bounds beside those of a line contact.

    Peak contact pressure over k, and tangential over normal force. Triangles are where the last
    record's own stress puts the bounds, all tractions grown alike.

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
    fatigue = history.scene.fatigue
    k = fatigue.shear_yield_stress
    figure = Figure(figsize=(1.15 * WIDTH, 0.85 * WIDTH))
    axes = figure.add_subplot()
    mu, first, inside, surface = LINE_CONTACT.T
    axes.plot(mu, first, color=GREY, linestyle=":", label="first yield, line contact")
    axes.plot(mu, np.minimum(inside, surface), color=GREY, label="certain, line contact")
    label = r"$1/\mu$, plane Tresca at the surface"
    classic = np.linspace(1.0 / 8.0, mu[-1], 200)
    axes.plot(classic, 1.0 / classic, color=GREY, linestyle="--", label=label)
    force = np.hypot(history["Qx_over_P"], history["Qy_over_P"])
    load = history["p_max"] / k
    axes.plot(force, load, color="black", linewidth=0.8)
    for row, (fill, name) in {0: ("white", "first"), len(history) - 1: ("black", "last")}.items():
        told = f"{name} record" if len(history) > 1 else "this contact"
        axes.plot(force[row], load[row], "o", color="black", markerfacecolor=fill, label=told)
    for column, marker, told in (
        ("shakedown_lower", "^", "certain up to"),
        ("shakedown_upper", "v", "impossible above"),
    ):
        for body in fatigue.bodies:
            factor = history[column][-1, BODIES.index(body)]
            look = {"color": COLOURS[body], "marker": marker, "linestyle": "none"}
            axes.plot(force[-1], factor * load[-1], label=f"{told}, {body}", **look)
    highest = np.nanmax([*load, *(history["shakedown_upper"][-1] * load[-1]), 4.2])
    axes.set(xlim=(0.0, max(0.6, 1.1 * force.max())), ylim=(0.0, 1.1 * highest))
    axes.set_xlabel("tangential force / normal load")
    axes.set_ylabel(r"$p_\mathrm{max}/k$")
    figure.legend(loc="outside right center")
    set_title(figure, told_of(history, f"shakedown; k = {k:.4g} MPa"))
    return figure


@history_figure("utilisation-{body}", columns=["damage"], cure="fatigue.limit", each=_of_bodies)
def utilisation(history: History, body: str = "A", at: float | None = None, **named) -> Figure:
    """Utilisation of a body over its section, below the surface as it is.

    Parameters
    ----------
    history : History
        Of a scene with the limit of a criterion.
    body : "A" or "B"
        The body.
    at : float, optional
        As of `History.field`; the last by default.

    Raises
    ------
    LookupError
        If it was not kept.
    ValueError
        If there is no limit.

    Examples
    --------
    >>> asked = {"limit": 250.0, "sensitivity": 0.3, "bodies": ["A"]}
    >>> tired = ts.roll(discs.replace(subsurface=None, fatigue=asked))
    >>> plot.utilisation(tired, "A")
    <Figure size ...>
    """
    found, scale = history.fatigue(body, at, **named), Scale.of_history(history)
    told = place(history.coordinate, history.saved[history.row_of(at, **named)])
    figure, (axes,) = _sections(history, f"utilisation of body {body}, {told}", 1)
    # Between its depths it goes with their root.
    depth = found.depth[-1] * np.linspace(0.0, 1.0, FINE) ** 2
    roots = np.sqrt(depth), np.sqrt(found.depth)
    values = np.stack([np.interp(*roots, row) for row in found.utilisation])
    where = _across(axes, found, scale), depth / scale.length
    mesh = _fill(axes, *where, values, cmap=STRESS)
    top = found.largest()
    axes.plot(top.at[1] / scale.across, top.at[2] / scale.length, "o", **_MARK)
    if values.max() > 1.0 > values.min():
        level = np.broadcast_to(values.T, (depth.size, where[0].size))
        axes.contour(*where, level, levels=[1.0], colors="white", linewidths=1.0)
    figure.colorbar(mesh, ax=axes, label="equivalent stress / limit")
    _note(figure, history, body)
    return figure


@history_figure("damage-{body}", columns=["damage"], cure="fatigue.limit", each=_damaged)
def damage(history: History, body: str = "A") -> Figure:
    """Damage of a body in its material, below the unworn surface, at the stored revolutions.

    With the worn surface: what is above it is gone. The scale is logarithmic.

    Raises
    ------
    LookupError
        If it was not kept.
    ValueError
        If there is no limit, or no damage.

    Examples
    --------
    >>> asked = {"limit": 250.0, "sensitivity": 0.3, "bodies": ["A"]}
    >>> tired = ts.roll(discs.replace(subsurface=None, fatigue=asked))
    >>> plot.damage(tired, "A")
    <Figure size ...>
    """
    scale = Scale.of_history(history)
    places = [at for at in history.saved.tolist() if history.fatigue(body, at).damage_max[0] > 0.0]
    if not places:
        raise ValueError("nothing to draw: nothing has been rolled, and no damage is done")
    places = chosen(np.array(places), PANELS).tolist()
    bodies = [history.fatigue(body, at) for at in places]
    figure, charts = _sections(history, f"damage of body {body}, log scale", len(places))
    highest = np.log10(max(one.damage_max[0] for one in bodies))
    for axes, one, at in zip(charts, bodies, places, strict=True):
        left = one.zeta >= one.worn[:, None]
        shown = np.log10(np.maximum(one.damage, 10.0 ** (highest - 2.0 * DECADES)))
        shown = np.where(left, shown, np.nan)
        y = _across(axes, one, scale)
        look = {"cmap": WEAR, "vmin": highest - DECADES, "vmax": highest}
        mesh = _fill(axes, y, one.zeta / scale.length, shown, **look)
        worn = np.broadcast_to(one.worn / scale.length, y.shape)
        axes.plot(y, worn, color=VERMILLION, linewidth=1.2)
        _, top = one.damage_max
        axes.plot(top[1] / scale.across, top[2] / scale.length, "o", **_MARK)
        axes.set_title(place(history.coordinate, at))
    for axes in charts[1:]:
        axes.set_ylabel("")
        axes.tick_params(labelleft=False)
    figure.colorbar(mesh, ax=charts, label=r"$\log_{10} D$", extend="min")
    _note(figure, history, body)
    return figure


@history_figure("fatigue-course", needs=[_COMPUTED], shown=in_course)
def fatigue_course(history: History) -> Figure:
    """Largest damage of each body, and load factors of shakedown, over the course.

    Whichever of both there is.

    Raises
    ------
    ValueError
        If there is neither.

    Examples
    --------
    >>> asked = {"limit": 250.0, "sensitivity": 0.3, "bodies": ["A"]}
    >>> tired = ts.roll(discs.replace(subsurface=None, fatigue=asked))
    >>> plot.fatigue_course(tired)
    <Figure size ...>
    """
    draws = [draw for name, draw in _COURSES.items() if name in history.columns]
    figure = Figure(figsize=(WIDTH, 0.5 * WIDTH * len(draws) + 0.4))
    panels = figure.subplots(len(draws), sharex=True, squeeze=False)[:, 0]
    for axes, draw in zip(panels, draws, strict=True):
        draw(axes, history)
        axes.legend(loc="best", fontsize=9, ncols=2)
    along(panels[-1], history)
    set_title(figure, told_of(history, "fatigue of each body"))
    return figure


@history_figure(
    "wear-against-fatigue-{body}",
    columns=["damage"],
    cure="fatigue.limit",
    needs=[WIDE, _WEARS],
    each=_of_bodies,
)
def wear_against_fatigue(history: History, body: str = "A") -> Figure:
    """Wear of a revolution across the track, and the wear that balances fatigue.

    Where wear is slower, cracks start. By the last record.

    Raises
    ------
    ValueError
        If there is no limit, or nothing wears.

    Examples
    --------
    >>> asked = {"limit": 250.0, "sensitivity": 0.3, "bodies": ["A"]}
    >>> tired = ts.roll(discs.replace(subsurface=None, fatigue=asked))
    >>> plot.wear_against_fatigue(tired, "A")
    <Figure size ...>
    """
    rate = _wear_rate(history, body)
    balance = history[f"balancing_wear_{body}"][_solved(history)[-1]]
    scale = Scale.of_history(history)
    figure = Figure(figsize=(1.1 * WIDTH, 0.7 * WIDTH))
    axes = figure.add_subplot()
    y, nano = history.y / scale.across, 1e3 * MICRON
    axes.semilogy(y, _positive(nano * rate), color=BLUE, label="wear")
    axes.semilogy(y, _positive(nano * balance), color=VERMILLION, label="balances fatigue")
    highest = nano * max(np.nanmax(rate), np.nanmax(balance))
    axes.set_ylim(1e-4 * highest, 3.0 * highest)
    seen = (rate > 0.0) | (balance > 1e-4 * balance.max())
    if seen.any():
        reach = 1.1 * np.abs(y[seen]).max()
        axes.set_xlim(-reach, reach)
    slower = (rate < balance) & (nano * balance > 1e-4 * highest)
    axes.fill_between(
        y, _positive(nano * rate), nano * balance, where=slower, color=ORANGE, alpha=0.3
    )
    axes.set_xlabel(scale.of_length("y", across=True))
    axes.set_ylabel("depth per revolution (nm)")
    axes.legend(loc="best")
    set_title(figure, told_of(history, f"wear and fatigue of body {body}", scale.told))
    return figure


_MARK = {"markerfacecolor": "white", "markeredgecolor": "black", "markersize": 5.5, "zorder": 5}


def _note(figure: Figure, history: History, body: str) -> None:
    """Tell of stress that the material cannot see."""
    if "shakedown_lower" not in history.columns:
        return
    if np.nanmin(history["shakedown_lower"][:, BODIES.index(body)]) < 1.0:
        text = "Above the shakedown limit: elastic stress is not what the material sees."
        figure.supxlabel(text, fontsize=9)


def _wear_rate(history: History, body: str) -> np.ndarray:
    """Depth that a revolution wears off a body by the last two records, mm."""
    rows = _solved(history)
    depth, N = history[f"wear_profile_{body}"][rows], history[history.coordinate.name][rows]
    if len(N) < 2:
        return np.zeros(history.y.size)
    return np.maximum(depth[-1] - depth[-2], 0.0) / (N[-1] - N[-2])


def _solved(history: History) -> np.ndarray:
    """Rows of the records whose contact was solved: a last one that was not has no damage."""
    return np.flatnonzero(history["converged"])


def _positive(values: np.ndarray) -> np.ndarray:
    return np.where(values > 0.0, values, np.nan)


def _sections(history: History, told: str, count: int) -> tuple[Figure, list[Axes]]:
    """Panels over (y, depth) side by side."""
    figure = Figure(figsize=((0.75 + 0.45 * count) * WIDTH, 0.75 * WIDTH))
    charts = list(figure.subplots(1, count, squeeze=False, sharey=True)[0])
    scale = Scale.of_history(history)
    charts[0].set_ylabel("depth " + scale.of_length("z"))
    set_title(figure, told_of(history, told, scale.told))
    return figure, charts


def _fill(axes: Axes, y: np.ndarray, depth: np.ndarray, values: np.ndarray, **look) -> QuadMesh:
    """Colour values of shape (n_y, depths), or (1, depths) where they are equal at all y."""
    look["shading"] = "gouraud" if np.isfinite(values).all() else "nearest"
    values = np.broadcast_to(values.T, (depth.size, y.size))
    return axes.pcolormesh(y, depth, values, rasterized=True, **look)


def _across(axes: Axes, one: BodyFatigue, scale: Scale) -> np.ndarray:
    """Show the stressed part of the section, depth downwards, and return y on its axis.

    A line contact is equal at all y: its section has two places.
    """
    axes.set_ylim(one.depth[-1] / scale.length, 0.0)
    if one.y.size == 1:
        axes.set_xlabel("line contact")
        axes.tick_params(labelbottom=False, bottom=False)
        return np.array([-0.5, 0.5])
    stressed = one.utilisation.max(axis=1) > 0.05 * one.utilisation.max()
    reach = min(1.15 * np.abs(one.y[stressed]).max(), one.y[-1]) / scale.across
    axes.set_xlim(-reach, reach)
    axes.set_xlabel(scale.of_length("y", across=True))
    return one.y / scale.across


def _damage_course(axes: Axes, history: History) -> None:
    N, highest = history[history.coordinate.name], np.nanmax(history["damage"])
    for k, body in _bodies(history):
        axes.plot(N, history["damage"][:, k], color=COLOURS[body], label=f"body {body}")
        started = history["initiation"][-1, k]
        if np.isfinite(started):
            axes.axvline(started, color=COLOURS[body], linestyle=":", linewidth=1.0)
    if highest > 0.3:
        axes.axhline(1.0, color=GREY, linewidth=0.8)
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel("largest damage $D$")


def _utilisation_course(axes: Axes, history: History) -> None:
    _each(axes, history, lambda kind: f"utilisation_{kind}")
    axes.set_ylabel("utilisation")


def _shakedown_course(axes: Axes, history: History) -> None:
    _each(axes, history, lambda kind: f"shakedown_{kind}")
    axes.axhline(1.0, color=GREY, linewidth=0.8)
    axes.set_ylabel("certain up to (load factor)")


_COURSES: dict[str, Callable[[Axes, History], None]] = {
    "damage": _damage_course,
    "utilisation": _utilisation_course,
    "shakedown_lower": _shakedown_course,
}


def _each(axes: Axes, history: History, column: Callable[[str], str]) -> None:
    N = history[history.coordinate.name]
    for kind, style in (("interior", "-"), ("surface", "--")):
        for k, body in _bodies(history):
            look = {"color": COLOURS[body], "linestyle": style, "label": f"{body}, {kind}"}
            axes.plot(N, history[column(kind)][:, k], **look)
    axes.set_ylim(bottom=0.0)


def _bodies(history: History) -> list[tuple[int, str]]:
    return [(BODIES.index(body), body) for body in history.scene.fatigue.bodies]
