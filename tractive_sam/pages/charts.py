"""Which columns of a history are drawn together over its course."""

from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np

from tractive_sam.description import format_unit, html_symbol
from tractive_sam.markup import Html, as_html, fill
from tractive_sam.pages.arrays import packed
from tractive_sam.results import BODIES, COORDINATE, LABELS, PREFIX, History, Quantity

TOGETHER = (
    ("Forces over the normal load", ("Qx_over_P", "Qy_over_P")),
    ("Contact pressure", ("p_max", "p_95")),
    ("Half widths of the contact", ("half_width_x", "half_width_y")),
    ("Largest wear depth", ("wear_max",)),
    ("Worn mass", ("worn_mass",)),
    ("Worn volume", ("worn_volume",)),
    ("Largest stress", ("stress_interior", "stress_surface")),
    ("Creepages found", ("creepage_found",)),
    ("Tangential forces", ("Qx", "Qy")),
    ("Work per distance rolled", ("work_supplied", "dissipation", "t_gamma")),
)
"""Titles, and names or roles of columns in one chart. Every other column has one of its own."""

HIDDEN = {"stress_max", "stress_max_at", "stress_max_error", COORDINATE}
"""Roles that are drawn otherwise, or not."""

BOOKKEEPING = {
    "residual",
    "operator_applications",
    "convolutions",
    "jump",
    "converged",
    "solves",
    "seconds",
}
"""Columns of how it was computed: at the end."""

ROUNDING = 1e-9
"""Change over the largest value below which nothing changes."""

NOISE = 1e-6
"""Change of a force over the load, likewise: what solvers leave open."""


def charts(history: History) -> list[dict[str, Any]]:
    """Charts over the course: titles, units, and lines with their numbers.

    Columns that do not change are left out: the table of numbers has them. Of a duty cycle a chart
    has a column of the cycle and the same of its blocks.
    """
    if len(history) < 2:
        return []
    free = {
        name: one
        for name, one in history.columns.items()
        if _of_cycle(history, one).role not in HIDDEN and not name.endswith("_error")
        if not {"y", "position"} & set(one.dims)
    }
    groups: list[tuple[str, dict[str, Quantity]]] = []
    for name in [name for name in free if PREFIX + name in free]:
        pair = {key: free.pop(key) for key in (name, PREFIX + name)}
        groups.append((_title(pair[name]), pair))
    for title, keys in TOGETHER:
        names = [name for name, one in free.items() if name in keys or one.role in keys]
        groups.append((title, {name: free.pop(name) for name in names}))
    groups += [(_title(one), {name: one}) for name, one in free.items()]
    drawn = [_chart(history, title, list(group.values())) for title, group in groups]
    return sorted((one for one in drawn if one["lines"]), key=lambda one: one["aside"])


def _noise(history: History, name: str) -> float:
    """By how much forces and moments change that are zero but for what the solver leaves."""
    load = NOISE * float(np.nanmax(history["P"]))
    arm = float(np.nanmax(history["half_width_x"]))
    of = {"Qx": load, "Qy": load, "Mz": load * arm, "Qx_over_P": NOISE, "Qy_over_P": NOISE}
    return of.get(name.removeprefix(PREFIX), 0.0)


def _of_cycle(history: History, one: Quantity) -> Quantity:
    """The column of the cycle where it is one of its blocks."""
    return history.columns.get(one.name.removeprefix(PREFIX), one)


def jumps(position: np.ndarray, travel: float = 3.0) -> bool:
    """Return whether a position goes to and fro: it is that of neighbouring peaks by turns.

    Parameters
    ----------
    position : ndarray, shape (n,)
        Positions along the course, finite.
    travel : float
        Path over range from which it does; 1 of a position that moves one way, 2 of one that
        returns.
    """
    return bool(np.abs(np.diff(position)).sum() > travel * np.ptp(position))


def _title(one: Quantity) -> str:
    return one.long_name[:1].upper() + one.long_name[1:]


def _chart(history: History, title: str, group: list[Quantity]) -> dict[str, Any]:
    """One chart: its title, the label of its axis, its lines, and whether it is set aside."""
    units = [format_unit(one.unit) for one in group]
    label = as_html(", ".join(dict.fromkeys(filter(None, units))))
    names = {_of_cycle(history, one).name for one in group}
    if len(names) == 1 and (symbol := html_symbol(group[0].symbol)):
        label = fill("$symbol ($label)", symbol=symbol, label=label) if label else symbol
    return {
        "title": as_html(title),
        "label": label,
        "lines": [line for one in group for line in _lines(history, one, len(group))],
        "aside": names <= BOOKKEEPING and bool(group),
    }


def _lines(history: History, one: Quantity, several: int) -> Iterator[dict[str, Any]]:
    """The numbers of a column that change, a line for each body and axis."""
    values, noise = history[one.name], _noise(history, one.name)
    labels = {**LABELS, "block": history.block_names}
    for place in product(*(labels[dim] for dim in one.dims)):
        place_of = zip(one.dims, place, strict=True)
        at: Any = (..., *(labels[dim].index(k) for dim, k in place_of))
        line = values[at].astype(float)
        known = line[np.isfinite(line)]
        if known.size < 2 or np.ptp(known) <= max(noise, ROUNDING * np.abs(known).max()):
            continue
        if one.name.removeprefix(PREFIX).endswith("_at") and jumps(known):
            continue
        name = html_symbol(one.symbol) or as_html(one.name)
        kind = one.role.removeprefix("stress_") if one.role.startswith("stress_") else ""
        named = [as_html(f"body {k}" if k in BODIES else k) for k in place]
        if PREFIX + one.name in history.columns:
            named = [Html("cycle"), *named]
        elif kind:
            named.append(as_html(kind))
        elif "block" not in one.dims and (several > 1 or not place):
            named = [name, *named]
        drawn = {"name": Html(", ".join(named)), "values": packed(line)}
        bars = history.values.get(f"{one.name}_error")
        if bars is not None and np.isfinite(bars[at]).any():
            drawn["bars"] = packed(bars[at])
        yield drawn
