"""Reads text tables of instruments and spreadsheets."""

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tractive_sam import input_file
from tractive_sam.store.errors import GapError

_SPACED = re.compile(r"\d\s+[-+.\w]")  # a number, space, and the next one
_BEFORE_UNIT = re.compile(r"\s+(?=[\[(])")
_NAME = re.compile(r"""\s*["']?([^\W\d_]+)[\s_]*[\[(]?\s*(nm|[uµμ]m|mm|m)?\s*[\])]?["']?\s*""")


@dataclass(frozen=True)
class TextTable:
    """Cells of a text file, with names and units of columns from its header.

    Attributes
    ----------
    cells : list of list of str
        Rows of equal length, numbers with decimal points; without the header.
    lines : list of int
        Line number of each row in the file, from 1.
    names : tuple of str
        Names of the columns in lower case; empty without a header.
    units : tuple of str
        Unit of each column; an empty text if the header states none.
    """

    cells: list[list[str]]
    lines: list[int]
    names: tuple[str, ...] = ()
    units: tuple[str, ...] = ()

    def numbers(self, path: Path) -> np.ndarray:
        """Return all cells as numbers (rows, columns); GapError unless all are finite.

        Raises
        ------
        GapError
            If a cell is no finite number; the message states the line of the first.
        """
        wrong = [
            f"line {line}, {cell!r}"
            for line, row in zip(self.lines, self.cells, strict=True)
            for cell in row
            if not (is_number(cell) and math.isfinite(float(cell)))
        ]
        if wrong:
            raise GapError(path, first_place(wrong), "a finite number in every cell")
        return np.array(self.cells, float)


def read_gap_text(path: Path, max_bytes: int = 2**30) -> TextTable:
    """Return the cells of a text file, with their line numbers and the header's names and units.

    Separator and decimal sign are detected.

    Parameters
    ----------
    path : Path
        The file.
    max_bytes : int
        Largest size of the file: about 5000 x 5000 numbers, which as text already need too much
        memory.

    Raises
    ------
    GapError
        If the file has no rows, or rows of different lengths.
    """
    # Largest length of a line, characters.
    longest = 1_000_000
    text = input_file.read_text(path, max_bytes, "utf-8-sig")
    stripped = enumerate(map(str.strip, text.splitlines()), 1)
    lines = [(number, line) for number, line in stripped if line]
    if any(len(line) > longest for _, line in lines):
        raise GapError(path, f"a line longer than {longest} characters", "one line for each row")
    rows = [(number, line) for number, line in lines if line[0] not in "#%"]
    if not rows:
        raise GapError(path, "no rows", "a row of numbers for each point")
    split = _choose_splitter(rows[-1][1])
    cells = [split(line) for _, line in rows]
    line_numbers = [number for number, _ in rows]
    header = _parse_header(cells[0])
    if header:
        cells, line_numbers = cells[1:], line_numbers[1:]
        if not cells:
            raise GapError(path, "no rows below the header", "a row of numbers for each point")
    elif rows[0] != lines[0]:  # the last comment line before the numbers may be the header
        header = _parse_header(split(lines[lines.index(rows[0]) - 1][1].lstrip("#% ")))
        header = header if len(header) == len(cells[0]) else []
    width = len(header) or len(cells[0])
    wrong = [
        f"line {number} of {len(row)} cells, not {width}"
        for number, row in zip(line_numbers, cells, strict=True)
        if len(row) != width
    ]
    if wrong:
        raise GapError(path, first_place(wrong), "rows of equal length")
    names, units = zip(*header, strict=True) if header else ((), ())
    return TextTable(cells, line_numbers, names, units)


def first_place(places: Sequence[str]) -> str:
    """Return the first of several faulty places, with the number of others, as text."""
    return places[0] if len(places) == 1 else f"{places[0]} and {len(places) - 1} more"


def is_number(cell: str) -> bool:
    """Return whether Python's float can read a cell; also nan and inf."""
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _choose_splitter(line: str) -> Callable[[str], list[str]]:
    """Return a function that splits lines in the format of this line into cells."""
    for separator in (";", "\t"):
        if separator in line:
            return lambda row: [cell.strip().replace(",", ".") for cell in row.split(separator)]
    if _SPACED.search(line):
        if re.search(r"\d,\d", line) and "." not in line:
            return lambda row: _BEFORE_UNIT.sub("", row).replace(",", ".").split()
        return lambda row: _BEFORE_UNIT.sub("", row).split()
    return lambda row: [cell.strip() for cell in row.split(",")]


def _parse_header(cells: list[str]) -> list[tuple[str, str]]:
    """Return (name, unit) of each column of a header line; [] if the line is no header."""
    matches = [match for cell in cells if (match := _NAME.fullmatch(cell))]
    if len(matches) < len(cells):
        return []
    return [(match[1].lower(), re.sub("[µμ]", "u", match[2] or "")) for match in matches]
