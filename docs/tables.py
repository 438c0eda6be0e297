"""Markdown tables from rows or from the CSV file of a benchmark."""

import csv
from collections.abc import Callable, Iterable
from pathlib import Path

RESULTS = Path(__file__).parents[1] / "benchmarks" / "results"

Row = dict[str, str]


def format_table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Return a Markdown table."""
    head = list(head)
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(map(_cell, line)) + " |" for line in lines) + "\n"


def _cell(text: str) -> str:
    return str(text).replace("|", r"\|").replace("\n", " ")


def read_rows(file: str, select: Callable[[Row], bool] = lambda row: True) -> list[Row]:
    """Return the selected rows of a CSV file of the benchmarks."""
    with (RESULTS / file).open(newline="", encoding="utf-8") as source:
        return [row for row in csv.DictReader(source) if select(row)]


def format_columns(
    rows: Iterable[Row], columns: dict[str, tuple[str, Callable[[str], str]]]
) -> str:
    """Return a Markdown table; `columns` maps a heading to a key of a row and its formatter."""
    written = ([form(row[key]) for key, form in columns.values()] for row in rows)
    return format_table(columns, written)


def number(form: str, times: float = 1.0) -> Callable[[str], str]:
    """Return a formatter of numbers, for example with ".3g", times a factor; "" remains ""."""
    return lambda text: f"{times * float(text):{form}}" if text else ""
