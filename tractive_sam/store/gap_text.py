"""Reads tables of numbers as instruments and spreadsheets write them."""

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tractive_sam import input_file
from tractive_sam.store.errors import GapError

LONGEST = 1_000_000
"""Characters of a line that a table may have."""

_SPACED = re.compile(r"\d\s+[-+.\w]")  # a number, space, and the next one
_BEFORE_UNIT = re.compile(r"\s+(?=[\[(])")
_NAME = re.compile(r"""\s*["']?([^\W\d_]+)[\s_]*[\[(]?\s*(nm|[uµμ]m|mm|m)?\s*[\])]?["']?\s*""")


@dataclass(frozen=True)
class TextTable:
    """Rows of cells, with the names of its columns and their units where a header tells them.

    Attributes
    ----------
    cells : list of list of str
        All rows of the same length, numbers with decimal points; without the header of columns.
    lines : list of int
        In which line of the file each row is, from 1.
    names : tuple of str
        In lower case; empty without a header.
    units : tuple of str
        Of each column, empty where the header tells none.
    """

    cells: list[list[str]]
    lines: list[int]
    names: tuple[str, ...] = ()
    units: tuple[str, ...] = ()

    def numbers(self, path: Path) -> np.ndarray:
        """All cells as numbers, shape (rows, columns).

        Raises
        ------
        GapError
            With the line of the first one that is no finite number.
        """
        wrong = [
            f"line {line}, {cell!r}"
            for line, row in zip(self.lines, self.cells, strict=True)
            for cell in row
            if not (is_number(cell) and math.isfinite(float(cell)))
        ]
        if wrong:
            raise GapError(path, one_of(wrong), "a finite number in every cell")
        return np.array(self.cells, float)


def read_text(path: Path, most: int = 2**30) -> TextTable:
    """Read a table, by the separator and the decimal sign that its lines have.

    Parameters
    ----------
    path : Path
        The file.
    most : int
        Bytes that it may have: some 5000 x 5000 numbers, more than memory takes as text.

    Raises
    ------
    GapError
        If it has no rows, or rows of different lengths.
    """
    text = input_file.read_text(path, most, "utf-8-sig")
    lines = [(k, line.strip()) for k, line in enumerate(text.splitlines(), 1) if line.strip()]
    if any(len(line) > LONGEST for _, line in lines):
        raise GapError(path, f"a line longer than {LONGEST} characters", "a line for each row")
    rows = [(k, line) for k, line in lines if line[0] not in "#%"]
    if not rows:
        raise GapError(path, "no rows", "a row of numbers for each point")
    split = _splitter(rows[-1][1])
    cells = [split(line) for _, line in rows]
    numbers = [k for k, _ in rows]
    header = _header(cells[0])
    if header:
        cells, numbers = cells[1:], numbers[1:]
        if not cells:
            raise GapError(path, "no rows below the header", "a row of numbers for each point")
    elif rows[0] != lines[0]:  # the last comment before the numbers may be the header
        header = _header(split(lines[lines.index(rows[0]) - 1][1].lstrip("#% ")))
        header = header if len(header) == len(cells[0]) else []
    width = len(header) or len(cells[0])
    other = [
        f"line {k} of {len(row)} cells, not {width}"
        for k, row in zip(numbers, cells, strict=True)
        if len(row) != width
    ]
    if other:
        raise GapError(path, one_of(other), "rows of the same length")
    names, units = zip(*header, strict=True) if header else ((), ())
    return TextTable(cells, numbers, names, units)


def one_of(places: Sequence[str]) -> str:
    """The first of many places at which something is wrong, and how many more there are."""
    return places[0] if len(places) == 1 else f"{places[0]} and {len(places) - 1} more"


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
