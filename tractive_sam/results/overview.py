"""Text tables of a history: its records, and the quantities of its last record."""

import math
from collections.abc import Collection, Iterable
from dataclasses import dataclass

from tractive_sam.description import TextTable
from tractive_sam.results.describe import format_values
from tractive_sam.results.history_data import HistoryData
from tractive_sam.results.quantity import Quantity


@dataclass(frozen=True)
class Column:
    """A column of the printed table of records: quantity, heading, number format and factor.

    Attributes
    ----------
    name : str
        Column of the history.
    heading : str
        Heading, with the unit in the second line.
    format : str
        Format of its numbers.
    factor : float
        Factor of the numbers.
    """

    name: str
    heading: str
    format: str = ".4g"
    factor: float = 1

    def format_value(self, value: float) -> str:
        """Return a value of the quantity as text, times the factor of the column."""
        value *= self.factor
        return format(int(value) if self.format == "d" else value, self.format)


def select_columns(columns: Collection[str], creepages: bool = False) -> list[Column]:
    """Return the columns of the printed table of records, by the columns that a history has.

    Parameters
    ----------
    columns : collection of str
        Columns of the history; shifts of a transient replace the half widths, and patches of a
        wheel have their place and forces.
    creepages : bool
        Whether to print the creepages, which follow from prescribed forces.
    """
    # Columns of the table of records, in groups.
    ends = (
        Column("wear_max", "wear\nµm", factor=1e3),
        Column("stick_fraction", "stick\n%", ".1f", 100),
        Column("residual", "residual", ".0e"),
    )
    shifts = (
        Column("shift_x", "shift x\nµm", factor=1e3),
        Column("shift_y", "shift y\nµm", factor=1e3),
        Column("friction_work", "friction\nN mm"),
    )
    widths = (Column("half_width_x", "half x\nmm"), Column("half_width_y", "half y\nmm"))
    pressures = (Column("p_max", "p_max\nMPa"), Column("p_95", "p_95\nMPa"))
    creepage_columns = (Column("xi_x", "xi_x", ".3e"), Column("xi_y", "xi_y", ".3e"))
    forces = (Column("Qx_over_P", "Qx/P", "z.4f"), Column("Qy_over_P", "Qy/P", "z.4f"))
    shown_creepages = creepage_columns if creepages else ()
    if "shift_x" in columns:
        return [*forces, *shown_creepages, pressures[0], *shifts, pressures[1], *ends]
    if "contact_angle" in columns:
        patch = (Column("contact_y", "y\nmm", ".5g"), Column("contact_angle", "angle\ndeg", ".2f"))
        newtons = (Column(name, f"{name}\nN", "z.0f") for name in ("P", "Qx", "Qy"))
        return [*patch, *newtons, pressures[0], *widths, *ends]
    return [*forces, *shown_creepages, *pressures, *widths, *ends]


def last_record(history: HistoryData, solver: bool = False) -> TextTable:
    """Return the table of the last record, one quantity a row.

    Parameters
    ----------
    history : History
        At least one record.
    solver : bool
        Whether to include the quantities of the solver, which the totals summarize.
    """
    hidden: set[str] = set() if solver else {
        "operator_applications", "convolutions", "over_application", "jump", "converged", "solves",
        "seconds", "next_step", "stretch",
    }  # fmt: skip
    return _quantity_table(row for row in format_values(history, -1) if row[0] not in hidden)


def main_results(history: HistoryData, max_rows: int = 15) -> TextTable:
    """Return the table of the main results of the last record that are not zero.

    Parameters
    ----------
    history : History
        At least one record.
    max_rows : int
        Most rows: they fit a terminal of 24 lines together with the load.
    """
    order = (
        "contact_y", "P", "Qx", "Qy", "Mz", "Qx_over_P", "worn_mass", "fatigue_life", "shift_x",
        "friction_work", "p_max", "p_95", "half_width_x", "half_width_y", "stick_fraction",
        "wear_max", "temperature_max", "stress_max", "von_mises_max", "utilisation", "xi_x", "xi_y",
    )  # fmt: skip
    rows = [row for row in format_values(history, -1) if row[1] not in ("0", "nan", "none")]
    main = [row for name in order for row in rows if row[2].name == name]
    caption = "run --verbose prints all quantities, show FILE all of every record"
    return _quantity_table(main[:max_rows], caption)


def _quantity_table(rows: Iterable[tuple[str, str, Quantity]], caption: str = "") -> TextTable:
    """Return the table of quantities: name, value, unit and meaning."""
    cells = [[name, text, _unit_of(column), column.long_name] for name, text, column in rows]
    return TextTable(cells, numbers=frozenset({1}), caption=caption)


def record_table(history: HistoryData, max_rows: int = 20) -> TextTable:
    """Return the table of at most `max_rows` records, at about equal distances."""
    count, coordinate = len(history), history.coordinate
    heading = "\n".join(filter(None, (coordinate.symbol or coordinate.name, _unit_of(coordinate))))
    has_creepages = "creepage_found" in history.columns and any(map(math.isfinite, history["xi_x"]))
    columns = select_columns(history.columns, creepages=has_creepages)
    columns = [Column(coordinate.name, heading, coordinate.format), *columns]
    shown = _select_spaced(history[coordinate.name].tolist(), max_rows)
    return TextTable(
        [[column.format_value(history[column.name][row]) for column in columns] for row in shown],
        tuple(column.heading for column in columns),
        frozenset(range(len(columns))),
        f"{len(shown)} of {count} records; show --json prints all" if len(shown) < count else "",
    )


def _unit_of(quantity: Quantity) -> str:
    """Return the unit of a quantity, or "" if it is dimensionless."""
    return "" if quantity.unit == "1" else quantity.unit


def _select_spaced(places: list[float], count: int) -> list[int]:
    """Return the indices of at most `count` of ascending values, at about equal distances."""
    if len(places) <= count:
        return list(range(len(places)))
    first, last = places[0], places[-1]
    aims = (first + k * (last - first) / (count - 1) for k in range(count))
    return sorted({min(range(len(places)), key=lambda n: abs(places[n] - aim)) for aim in aims})
