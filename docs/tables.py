"""Tables in Markdown, from rows or from a CSV file of a benchmark."""

import csv
from collections.abc import Callable, Iterable
from pathlib import Path

RESULTS = Path(__file__).parents[1] / "benchmarks" / "results"

Row = dict[str, str]


def markdown(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A table."""
    head = list(head)
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(map(_cell, line)) + " |" for line in lines) + "\n"


def _cell(text: str) -> str:
    return str(text).replace("|", r"\|").replace("\n", " ")


def rows_of(file: str, where: Callable[[Row], bool] = lambda row: True) -> list[Row]:
    """Rows of a CSV file of the benchmarks."""
    with (RESULTS / file).open(newline="", encoding="utf-8") as source:
        return [row for row in csv.DictReader(source) if where(row)]


def of_columns(rows: Iterable[Row], columns: dict[str, tuple[str, Callable[[str], str]]]) -> str:
    """A table: heading -> (entry of a row, how it is written)."""
    written = ([form(row[name]) for name, form in columns.values()] for row in rows)
    return markdown(columns, written)


def number(form: str, times: float = 1.0) -> Callable[[str], str]:
    """Writes a number in a format, as ".3g", times a factor; nothing where there is none."""
    return lambda text: f"{times * float(text):{form}}" if text else ""
