"""Results as tables for people."""

import math
from typing import TYPE_CHECKING

from rich import box
from rich.table import Table

from tractive_sam.results import describe_history, numbers
from tractive_sam.scene import describe_load

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping

    from tractive_sam.results import History, Quantity

COURSE = (
    ("Qx_over_P", "Qx/P", 1, "z.4f"),
    ("Qy_over_P", "Qy/P", 1, "z.4f"),
    ("p_max", "p_max\nMPa", 1, ".4g"),
    ("p_95", "p_95\nMPa", 1, ".4g"),
    ("half_width_x", "half x\nmm", 1, ".4g"),
    ("half_width_y", "half y\nmm", 1, ".4g"),
    ("wear_max", "wear\nµm", 1e3, ".4g"),
    ("stick_fraction", "stick\n%", 100, ".1f"),
    ("residual", "residual", 1, ".0e"),
)
"""What is told of every record, after the coordinate: name, heading, factor and format."""

MOVED = (
    ("shift_x", "shift x\nµm", 1e3, ".4g"),
    ("shift_y", "shift y\nµm", 1e3, ".4g"),
    ("friction_work", "friction\nN mm", 1, ".4g"),
)
"""The same of transients, in place of half widths."""

FOUND = (("xi_x", "xi_x", 1, ".3e"), ("xi_y", "xi_y", 1, ".3e"))
"""The same of creepages, where forces are prescribed."""

STEPPING = {
    "operator_applications", "convolutions", "jump", "converged", "solves", "seconds",
    "next_step", "stretch",
}  # fmt: skip
"""Columns of a record that say how it was computed: the totals tell it, and --json and --csv."""

MAIN = (
    "P", "Qx", "Qy", "Mz", "Qx_over_P", "worn_mass", "fatigue_life", "shift_x", "friction_work",
    "p_max", "p_95", "half_width_x", "half_width_y", "stick_fraction", "wear_max",
    "temperature_max", "stress_max", "von_mises_max", "utilisation", "xi_x", "xi_y",
)  # fmt: skip
"""Main results of a run, in their order: forces, wear or life, contact, stress."""

MOST_ROWS = 20


def course(columns: "Collection[str]") -> tuple[tuple[str, str, float, str], ...]:
    """Return what to print of every record with such columns, as `COURSE`."""
    if "shift_x" not in columns:
        return COURSE
    kept = [one for one in COURSE if not one[0].startswith("half_width")]
    return (*kept[:3], *MOVED, *kept[3:])


def about(history: "History") -> Table:
    """Return what was computed, and how it ended."""
    rows = {"scene": history.title, "status": history.status, "message": history.message}
    return _rows(rows | describe_history(history))


def load(history: "History") -> Table:
    """Return the load and the wear of the scene, in the units of its keys and in others."""
    return _rows(describe_load(history.scene))


def _rows(rows: "Mapping[str, str]") -> Table:
    """Return a table of labels and texts."""
    table = Table.grid(padding=(0, 2))
    for label, text in rows.items():
        table.add_row(label, text)
    return table


def last_record(history: "History", solver: bool = False) -> Table:
    """Return the last record, one quantity a row; those of `STEPPING` only with `solver`."""
    return _quantities(row for row in numbers(history, -1) if solver or row[0] not in STEPPING)


def main_results(history: "History", most: int = 15) -> Table:
    """Return the main results of the last record, those of `MAIN` that are not zero.

    Parameters
    ----------
    history : History
        At least one record.
    most : int
        Most rows: they fit a terminal of 24 lines together with the load.
    """
    found = [row for row in numbers(history, -1) if row[1] not in ("0", "nan", "none")]
    ordered = [row for name in MAIN for row in found if row[0].split()[0] == name]
    table = _quantities(ordered[:most])
    table.caption = "run --verbose prints all quantities, show FILE those of every record"
    return table


def _quantities(rows: "Iterable[tuple[str, str, Quantity]]") -> Table:
    """Return a table of quantities: name, number, unit and meaning."""
    table = Table(box=box.SIMPLE_HEAD, show_header=False)
    table.add_column(style="bold")
    table.add_column(justify="right")
    table.add_column()
    table.add_column(style="dim")
    for name, text, one in rows:
        table.add_row(name, text, "" if one.unit == "1" else one.unit, one.long_name)
    return table


def records(history: "History") -> Table:
    """Records about equally far apart along the course, one a row."""
    count = len(history)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    along = history.coordinate
    heading = (along.symbol or along.name) + ("" if along.unit == "1" else f"\n{along.unit}")
    takes = "creepage_found" in history.columns and any(map(math.isfinite, history["xi_x"]))
    found = FOUND if takes else ()
    told = course(history.columns)
    told = ((along.name, heading, 1, along.format), *told[:2], *found, *told[2:])
    for _, heading, _, _ in told:
        table.add_column(heading, justify="right", no_wrap=True)
    shown = _apart(history[along.name].tolist())
    for row in shown:
        table.add_row(*(format(history[name][row] * f, form) for name, _, f, form in told))
    if len(shown) < count:
        table.caption = f"{len(shown)} of {count} records; show --json tells all"
    return table


def _apart(places: list[float]) -> list[int]:
    """At most `MOST_ROWS` ascending places, those nearest to equal distances."""
    if len(places) <= MOST_ROWS:
        return list(range(len(places)))
    first, last = places[0], places[-1]
    aims = (first + k * (last - first) / (MOST_ROWS - 1) for k in range(MOST_ROWS))
    return sorted({min(range(len(places)), key=lambda n: abs(places[n] - aim)) for aim in aims})
