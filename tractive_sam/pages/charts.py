"""Charts of the columns of a history over its course."""

from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np

from tractive_sam.description import format_unit, html_symbol
from tractive_sam.markup import Html, as_html, fill
from tractive_sam.pages.arrays import pack_array
from tractive_sam.plot import Measurements
from tractive_sam.results import BODIES, COORDINATE, LABELS, PREFIX, History, Quantity

HIDDEN = {"stress_max", "stress_max_at", "stress_max_error", COORDINATE}
"""Roles that have no chart."""


def charts(history: History, measured: Measurements | None = None) -> list[dict[str, Any]]:
    """Return charts of a history's columns that change or were measured, as JSON data.

    Columns that neither change nor were measured are omitted: the table of numbers contains them.
    For a duty cycle a chart has the columns of the cycle and of its blocks.
    """
    # Titles, and names or roles of columns in one chart. Every other column has a separate chart.
    together = (
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
    if len(history) < 2 and measured is None:
        return []
    free = {
        name: column
        for name, column in history.columns.items()
        if _of_cycle(history, column).role not in HIDDEN and not column.error_of
        if not (column.is_profile or "position" in column.dims)
    }
    groups: list[tuple[str, dict[str, Quantity]]] = []
    for name in [name for name in free if PREFIX + name in free]:
        pair = {key: free.pop(key) for key in (name, PREFIX + name)}
        groups.append((chart_title(pair[name]), pair))
    for title, keys in together:
        names = [name for name, column in free.items() if name in keys or column.role in keys]
        groups.append((title, {name: free.pop(name) for name in names}))
    groups += [(chart_title(column), {name: column}) for name, column in free.items()]
    listed = [_chart(history, title, list(group.values()), measured) for title, group in groups]
    return sorted((chart for chart in listed if chart["lines"]), key=lambda chart: chart["aside"])


def _noise(history: History, name: str, share: float = 1e-6) -> float:
    """Return the change of a force or moment that solver errors may cause; 0 of other columns."""
    load = share * float(np.nanmax(history["P"]))
    arm = float(np.nanmax(history["half_width_x"]))
    ratios = {"Qx_over_P": share, "Qy_over_P": share}
    return ({"Qx": load, "Qy": load, "Mz": load * arm} | ratios).get(name.removeprefix(PREFIX), 0.0)


def _of_cycle(history: History, column: Quantity) -> Quantity:
    """Return the cycle's column for a block column (name with a prefix), or the column itself."""
    return history.columns.get(column.name.removeprefix(PREFIX), column)


def jumps(position: np.ndarray, travel: float = 3.0) -> bool:
    """Return whether a position alternates: its path exceeds `travel` times its range.

    Parameters
    ----------
    position : ndarray, shape (n,)
        Positions along the course, finite.
    travel : float
        Path over range from which it alternates; the ratio is 1 for a monotonic motion, and 2 if
        it returns.
    """
    return bool(np.abs(np.diff(position)).sum() > travel * np.ptp(position))


def chart_title(quantity: Quantity) -> str:
    """Return the long name of a quantity up to a semicolon, with a capital: its chart's title."""
    name = quantity.long_name.partition(";")[0]
    return name[:1].upper() + name[1:]


def _chart(
    history: History, title: str, group: list[Quantity], measured: Measurements | None
) -> dict[str, Any]:
    """Return one chart as JSON data: title, label of the axis, lines, and whether it comes last."""
    # Columns of the solver; their charts are the last ones.
    solver = {
        "residual", "operator_applications", "convolutions", "over_application", "jump",
        "converged", "solves", "seconds",
    }  # fmt: skip
    units = [format_unit(column.unit) for column in group]
    label = as_html(", ".join(dict.fromkeys(filter(None, units))))
    names = {_of_cycle(history, column).name for column in group}
    if len(names) == 1 and (symbol := html_symbol(group[0].symbol)):
        label = fill("$symbol ($label)", symbol=symbol, label=label) if label else symbol
    return {
        "title": as_html(title),
        "label": label,
        "lines": [
            line for column in group for line in _lines(history, column, len(group), measured)
        ],
        "aside": names <= solver and bool(group),
    }


def _lines(
    history: History, quantity: Quantity, several: int, measured: Measurements | None
) -> Iterator[dict[str, Any]]:
    """Yield the lines of a column in a chart, one a body and axis; constant columns have none."""
    values, noise = history[quantity.name], _noise(history, quantity.name)
    labels = {**LABELS, "block": history.block_names}
    for place in product(*(labels[dim] for dim in quantity.dims)):
        place_of = zip(quantity.dims, place, strict=True)
        at: Any = (..., *(labels[dim].index(k) for dim, k in place_of))
        line = values[at].astype(float)
        finite = line[np.isfinite(line)]
        column = " ".join((quantity.name, *place))
        compared = measured is not None and column in measured.columns
        constant = finite.size < 2 or np.ptp(finite) <= max(noise, 1e-9 * np.abs(finite).max())
        if constant and not compared:
            continue
        if quantity.place_of and jumps(finite):
            continue
        name = html_symbol(quantity.symbol) or as_html(quantity.name)
        kind = quantity.role.removeprefix("stress_") if quantity.role.startswith("stress_") else ""
        named = [as_html(f"body {k}" if k in BODIES else k) for k in place]
        if PREFIX + quantity.name in history.columns:
            named = [Html("cycle"), *named]
        elif kind:
            named.append(as_html(kind))
        elif "block" not in quantity.dims and (several > 1 or not place):
            named = [name, *named]
        chart_line = {"name": Html(", ".join(named)), "values": pack_array(line)}
        bars = history.values.get(f"{quantity.name}_error")
        if bars is not None and np.isfinite(bars[at]).any():
            chart_line["bars"] = pack_array(bars[at])
        if measured is not None and compared:
            places, points, text = measured.compare(history, column)
            packed = {"x": pack_array(places), "y": pack_array(points)}
            chart_line["measured"] = packed | {"name": as_html(text)}
        yield chart_line
