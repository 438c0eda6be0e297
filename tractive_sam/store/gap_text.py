"""Reads tables of numbers as instruments and spreadsheets write them."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tractive_sam.store.errors import GapError

LONGEST = 1_000_000
"""Characters of a line that a table may have."""

_SPACED = re.compile(r"\d\s+[-+.\d]")  # a number, space, and the next one
_BEFORE_UNIT = re.compile(r"\s+(?=[\[(])")
_NAME = re.compile(r"""\s*["']?([^\W\d_]+)[\s_]*[\[(]?\s*(nm|[uµμ]m|mm|m)?\s*[\])]?["']?\s*""")


@dataclass(frozen=True)
class TextTable:
    """Rows of cells, with the names of its columns and their units where a header tells them.

    Attributes
    ----------
    cells : list of list of str
        All rows of the same length, numbers with decimal points; without the header of columns.
    names : tuple of str
        In lower case; empty without a header.
    units : tuple of str
        Of each column, empty where the header tells none.
    """

    cells: list[list[str]]
    names: tuple[str, ...] = ()
    units: tuple[str, ...] = ()

    @property
    def numbers(self) -> np.ndarray:
        """All cells as numbers, shape (rows, columns)."""
        return np.array(self.cells, float)


def read_text(path: Path) -> TextTable:
    """Read a table, by the separator and the decimal sign that its lines have.

    Raises
    ------
    GapError
        If it has no rows, or rows of different lengths.
    """
    text = path.read_text(encoding="utf-8-sig")
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    if any(len(line) > LONGEST for line in lines):
        raise GapError(path, f"a line longer than {LONGEST} characters", "a line for each row")
    rows = [line for line in lines if line[0] not in "#%"]
    if not rows:
        raise GapError(path, "no rows", "a row of numbers for each point")
    split = _splitter(rows[-1])
    cells = [split(line) for line in rows]
    header = _header(cells[0])
    if header:
        cells = cells[1:]
        if not cells:
            raise GapError(path, "no rows below the header", "a row of numbers for each point")
    elif rows[0] != lines[0]:  # the last comment before the numbers may be the header
        header = _header(split(lines[lines.index(rows[0]) - 1].lstrip("#% ")))
        header = header if len(header) == len(cells[0]) else []
    widths = {len(row) for row in cells} | ({len(header)} if header else set())
    if len(widths) > 1:
        raise GapError(path, f"rows of {sorted(widths)} entries", "rows of the same length")
    names, units = zip(*header, strict=True) if header else ((), ())
    return TextTable(cells, names, units)


def is_number(cell: str) -> bool:
    """Whether a cell holds a number."""
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _splitter(line: str) -> Callable[[str], list[str]]:
    """Splits lines like this one, a row of numbers, into cells with decimal points."""
    for separator in (";", "\t"):
        if separator in line:
            return lambda row: [one.strip().replace(",", ".") for one in row.split(separator)]
    if _SPACED.search(line):
        if re.search(r"\d,\d", line) and "." not in line:
            return lambda row: [one.replace(",", ".") for one in _BEFORE_UNIT.sub("", row).split()]
        return lambda row: _BEFORE_UNIT.sub("", row).split()
    return lambda row: [one.strip() for one in row.split(",")]


def _header(cells: list[str]) -> list[tuple[str, str]]:
    """Name and unit of each column, if these cells are such; the unit may be unknown."""
    found = [_NAME.fullmatch(one) for one in cells]
    if not found or not all(found):
        return []
    return [(one[1].lower(), re.sub("[µμ]", "u", one[2] or "")) for one in found]
