"""Tables of numbers in text, as instruments, spreadsheets and other programs write them."""

import csv
import math
import operator
import re
from collections import Counter
from collections.abc import Collection, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from os import PathLike
from typing import Self

import numpy as np

from tractive_sam.input_file import read_text

LENGTHS = {
    "m": 1e3, "cm": 10.0, "mm": 1.0, "um": 1e-3, "nm": 1e-6, "angstrom": 1e-7, "in": 25.4,
    "mil": 0.0254, "uin": 25.4e-6,
}  # fmt: skip
"""Units of length, in mm."""

_SCALES = {
    "n": (1.0, "N"), "kn": (1e3, "N"), "n/mm": (1.0, "N/mm"), "kn/mm": (1e3, "N/mm"),
    "n/m": (1e-3, "N/mm"), "kn/m": (1.0, "N/mm"), "n mm": (1.0, "N mm"), "nmm": (1.0, "N mm"),
    "n m": (1e3, "N mm"), "mpa": (1.0, "MPa"), "gpa": (1e3, "MPa"), "pa": (1e-6, "MPa"),
    "kpa": (1e-3, "MPa"), "bar": (0.1, "MPa"), "1/mm": (1.0, "1/mm"), "1/m": (1e-3, "1/mm"),
    "mm/s": (1.0, "mm/s"), "m/s": (1e3, "mm/s"), "km/h": (1e3 / 3.6, "mm/s"), "-": (1.0, "1"),
    "1": (1.0, "1"), "%": (1e-2, "1"), "‰": (1e-3, "1"), "deg": (1.0, "degrees"),
    "°": (1.0, "degrees"), "degrees": (1.0, "degrees"), "°c": (1.0, "degC"), "degc": (1.0, "degC"),
    "s": (1.0, "s"), "ms": (1e-3, "s"), "min": (60.0, "s"), "h": (3600.0, "s"), "mg": (1.0, "mg"),
    "g": (1e3, "mg"), "mm2": (1.0, "mm2"), "mm²": (1.0, "mm2"), "mm3": (1.0, "mm3"),
    "mm³": (1.0, "mm3"), "rad": (1.0, "rad"), "mrad": (1.0, "mrad"), "rev": (1.0, "1"),
}  # fmt: skip
"""Factor from a stated unit, in lower case, to a unit of the package, and this unit."""

_MISSING = frozenset(
    ("", "nan", "na", "n/a", "#n/a", "null", "none", "-", "--", "---", "*", "***", "bad", "masked",
     "nodata")
)  # fmt: skip
"""Texts of cells, in lower case, that stand for a missing value."""

_NUMBER_LIKE = re.compile(r"\s*[\"']?[-+−]?[.,]?\d")
_STATEMENT = re.compile(r"\s*([^\W\d][^:=]*?)\s*[:=]\s*(.*\S)")


class TextError(ValueError):
    """Error of a text table: the fault with its line, and what is allowed.

    Attributes
    ----------
    value, allowed : str
        The fault, and what is allowed instead.
    """

    def __init__(self, value: str, allowed: str) -> None:
        super().__init__(value, allowed)
        self.value, self.allowed = value, allowed

    def __str__(self) -> str:
        return f"{self.value}; allowed: {self.allowed}"


def find_length_unit(text: str) -> str | None:
    """Return the unit of length that a text names, a key of `LENGTHS`; None for other texts."""
    synonyms = {
        "metre": "m", "meter": "m", "centimetre": "cm", "centimeter": "cm", "millimetre": "mm",
        "millimeter": "mm", "micron": "um", "micrometre": "um", "micrometer": "um",
        "nanometre": "nm", "nanometer": "nm", "å": "angstrom", "inch": "in", "inche": "in",
        '"': "in", "thou": "mil", "microinch": "uin", "microinche": "uin",
    }  # fmt: skip
    unit = re.sub("[µμ]", "u", text.strip()).strip(".")
    unit = unit if unit in ("M", "Nm") else unit.casefold()  # mega, newton metre
    unit = synonyms.get(unit, synonyms.get(unit.removesuffix("s"), unit))
    return unit if unit in LENGTHS else None


def split_statement(text: str) -> tuple[str, str]:
    """Return key, in lower case, and value of "key: value" or "key = value"; else "" and text."""
    match = _STATEMENT.match(text)
    return (match[1].lower(), match[2]) if match else ("", text)


def find_scale(unit: str, meaning: str) -> float | None:
    """Return the factor from a stated unit to the unit in a meaning; None if they do not match.

    Parameters
    ----------
    unit : str
        Stated unit; without one, the factor is 1.
    meaning : str
        Text that names units of the package as words, "mm" for example; without one, "1".
    """
    length = find_length_unit(unit)
    factor, base = (LENGTHS[length], "mm") if length else _SCALES.get(unit.casefold(), (1.0, ""))
    known = {"mm", *(base for _, base in _SCALES.values())}
    words = set(re.split(r"[,;]?\s+", meaning)) & known or {"1"}
    return factor if base in words or unit in ("", *words) else None


def parse_number(cell: str, decimal: str = ".") -> float | None:
    """Return the number in a cell, also nan, inf and 1.2D+01; None if it is no number."""
    text = cell.strip().replace("−", "-")
    if decimal == ",":
        text = "?" if "." in text else text.replace(",", ".")
    if re.fullmatch(r"[-+]?[\d.]+[dD][-+]?\d+", text):
        text = text.lower().replace("d", "e")
    try:
        return None if "_" in text else float(text)
    except ValueError:
        return None


@dataclass(frozen=True, eq=False)
class TextTable:
    """Rows of a text file, with names and units of columns from its header.

    Attributes
    ----------
    rows : list of list of str
        Cells, as they are written; rows of equal length.
    lines : list of int
        Line number of each row in the file, from 1.
    labels : tuple of str
        Cells of the header, as they are written; empty without a header.
    names, units : tuple of str
        Names of the columns and their units, from the labels and a row of units. Units of length
        are keys of `LENGTHS`; others are as written, without brackets; empty if not stated.
    remarks : list of (int, str)
        Line number and text of comments, lines before the header, and left-out row numbers.
    decimal : str
        Decimal sign: a point or a comma.
    """

    rows: list[list[str]]
    lines: list[int]
    labels: tuple[str, ...] = ()
    names: tuple[str, ...] = ()
    units: tuple[str, ...] = ()
    remarks: Sequence[tuple[int, str]] = ()
    decimal: str = "."

    def find(self, name: str) -> int | None:
        """Return the index of the column with a label or a name; None without one.

        Raises
        ------
        TextError
            If several columns have the name.
        """
        for texts in (self.labels, self.names):
            if texts.count(name) > 1:
                raise TextError(f"two columns {name}", "each column name once")
            if name in texts:
                return texts.index(name)
        return None

    def numbers(self, columns: Sequence[int] | None = None, missing: bool = False) -> np.ndarray:
        """Return cells as finite numbers, shape (rows, columns).

        Parameters
        ----------
        columns : sequence of int, optional
            Indices of the columns; by default all.
        missing : bool
            If true, empty cells and words such as "nan" give nan.

        Raises
        ------
        TextError
            If a cell is no finite number; the message names the line and the cell of the first.
        """
        rows = self.rows if columns is None else [[row[k] for k in columns] for row in self.rows]
        values = None
        # Python and NumPy read "1_0" as 10.
        if self.decimal == "." and not any("_" in "".join(row) for row in rows):
            with suppress(ValueError):
                values = np.array(rows, float)
                if np.isfinite(values).all() and values.min() > -999.0:
                    return values
        numbers = [[parse_number(cell, self.decimal) for cell in row] for row in rows]
        marks = _find_marks(numbers)
        numbers = [[None if number in marks else number for number in row] for row in numbers]
        wrong = [
            (i, k)
            for i, row in enumerate(numbers)
            for k, number in enumerate(row)
            if number is None or not math.isfinite(number)
            if not (missing and (rows[i][k].lower() in _MISSING or _is_mark(rows[i][k])))
        ]
        if not wrong:
            filled = [[math.nan if number is None else number for number in row] for row in numbers]
            return np.array(filled, float)
        i, k = wrong[0]
        cell, column = rows[i][k], k if columns is None else columns[k]
        place = f"line {self.lines[i]}, {cell!r}"
        if self.labels and self.labels[column]:
            place += f" in column {self.labels[column]}"
        place += f" and {len(wrong) - 1} more" if len(wrong) > 1 else ""
        allowed = "a finite number in every cell"
        if re.fullmatch(r"[-+]?\d{1,3}([,.]\d{3})+([,.]\d*)?", cell):
            allowed += ", without separators of thousands"
        raise TextError(place, allowed)

    def check_remark(self, line: int, text: str, units: Collection[str]) -> bool:
        """Return whether a remark states something; TextError for a scale, other units or rows.

        Parameters
        ----------
        line, text : int, str
            The remark.
        units : collection of str
            Units that are used.

        Returns
        -------
        bool
            True for a number, an assignment or a unit, except a number of rows that is correct.
        """
        key, value = split_statement(text)
        place = f"line {line}, {text[:60]!r}"
        cure = "the file without this line, if it does not apply"
        rows, columns = len(self.rows), len(self.rows[0])
        counts = _find_counts(text)
        corner = self.names or parse_number(self.rows[0][0], self.decimal)
        shapes = [(rows, columns), *([] if corner else [(rows - 1, columns - 1)])]
        whole = [rows, *(math.prod(shape) for shape in shapes)]
        is_grid = columns <= 3 and bool(re.match(r"n ?(cols|rows|[xy]\b)|[xy]", text.lower()))
        if counts:
            fits = sorted(counts) in map(sorted, shapes)
            if len(counts) == 1:
                n = counts[0]
                fits = n in sum(shapes, ()) or (is_grid and n > 0 and rows % n == 0)
            if len(counts) == 2 or re.search("point|pixel|sample|value", text.lower()):
                fits |= math.prod(counts) in whole
            if not fits:
                raise TextError(f"{place}, but {rows} rows", "a complete file; or " + cure)
            return False
        if _states_scale(key, value, text):
            raise TextError(f"{place}, which is not applied", f"numbers to which it is; or {cure}")
        words = re.split(r"[\s,;:=]+", _replace_per_cent(value))
        for before, word in zip(["", *words], words, strict=False):
            inner = word.strip("[](){}<>.")
            stated = inner if key or inner != word or before in ("in", "unit", "units") else ""
            stated = stated if inner not in ("in", "mil") or inner != word else ""
            unit = _read_unit(f"[{stated}]") if stated.casefold() in _SCALES else None
            unit = find_length_unit(stated) or unit
            if unit and parse_number(before) is None and unit not in units:
                raise TextError(
                    f"{place}, with the unit {stated}", f"units in the header; or {cure}"
                )
        is_count = text.replace(" ", "").isdigit() and text.split(maxsplit=1)[0] == str(rows)
        return not is_count and bool(key or "%" in words or re.search(r"[\d:=]", text))

    def statements(self) -> dict[str, tuple[int, str]]:
        """Return (line, value) by lower-case key of remarks "key: value" or "key = value"."""
        parts = ((line, *split_statement(text)) for line, text in self.remarks)
        return {key: (line, value) for line, key, value in parts if key}

    def without_row_numbers(self) -> Self:
        """Return the table without a first column that a header marks as row numbers."""
        titles = ("", "#", "no", "nr", "index", "row", "line", "point", "sample")
        if len(self.names) < 2 or self.names[0].lower() not in titles:
            return self
        first = [parse_number(row[0], self.decimal) for row in self.rows]
        if first != [k + (first[0] or 0.0) for k in range(len(first))]:
            return self
        return replace(
            self,
            rows=[row[1:] for row in self.rows],
            labels=self.labels[1:],
            names=self.names[1:],
            units=self.units[1:],
            remarks=[*self.remarks, (self.lines[0], "the first column holds row numbers")],
        )


def describe_unused(remarks: Sequence[tuple[int, str]]) -> str:
    """Return the lines of comments and headings that are not used, as text for a note."""
    lines = [f"line {line} {text[:40]!r}" for line, text in remarks]
    return f"comments and headings are not used: {list_first(lines, 3)}"


def list_first(texts: Sequence[str], most: int) -> str:
    """Return at most `most` texts, separated by commas, and the number of the others."""
    more = f", and {len(texts) - most} more" if len(texts) > most else ""
    return ", ".join(texts[:most]) + more


def read_table(path: str | PathLike[str], max_bytes: int = 2**26) -> TextTable:
    """Return the table in a text file; see `parse_table`.

    Parameters
    ----------
    path : path-like
        The file.
    max_bytes : int
        Largest size of the file.

    Raises
    ------
    OSError
        See `input_file.read_text`.
    TextError
        If there is no table.
    """
    try:
        return parse_table(read_text(path, max_bytes, None))
    except UnicodeDecodeError:
        allowed = "text in UTF-8, UTF-16 or Windows-1252"
        raise TextError("bytes that are no text", allowed) from None


def parse_table(text: str, first_line: int = 1) -> TextTable:
    """Return the table in a text: its rows, their lines, and the header above them.

    Columns are separated by semicolons, tabs, commas or blanks; unless commas separate them, a
    comma may be the decimal sign. Empty lines, and comments after #, % or !, are skipped. The last
    line without numbers above the rows, or else the last comment, is the header if it has a cell
    for each column; a row of units may follow it. Lines above the header are remarks, and so is a
    number of rows above them.

    Parameters
    ----------
    text : str
        Lines with Unix line ends.
    first_line : int
        Number of the first line, for messages.

    Raises
    ------
    TextError
        If there are no rows, rows of different lengths, numbers before the table, or numbers whose
        decimal sign is not clear.
    """
    body, remarks = _separate_comments(text, first_line)
    number_like = [(n, line) for n, line in body if _NUMBER_LIKE.match(line)]
    if not body:
        raise TextError("no rows", "a row of numbers for each point")
    separator, decimal, width = _find_dialect(number_like or body)
    rows = [_split(line, separator) for _, line in body]
    lines = [number for number, _ in body]

    def find_first(kind: str) -> int | None:
        found = (len(row) == width and _classify(row, decimal) == kind for row in rows)
        return next((k for k, is_row in enumerate(found) if is_row), None)

    first = find_first("numbers")
    first = find_first("mixed") if first is None else first
    if first is None:
        raise TextError("no rows below the header", "a row of numbers for each point")
    while first and len(rows[first - 1]) == width and not _STATEMENT.match(body[first - 1][1]):
        if _classify(rows[first - 1], decimal) != "mixed":
            break
        first -= 1  # a matrix with text in its corner, or a row with a cell that is no number
    if first and rows[first - 1] == [str(len(rows) - first)]:  # the number of rows
        first -= 1
        remarks.append((lines.pop(first), rows.pop(first)[0]))
        del body[first]
    trailing = separator != " " and all(not row[-1] for row in rows[first:])
    header, start = _find_header(body[: first + 1], remarks, separator, width, trailing)
    for k in range(start):
        if parse_number(rows[k][0], decimal) is not None and rows[k] != [str(len(rows) - first)]:
            value = f"line {lines[k]}, {body[k][1].strip()[:40]!r}, before the table"
            allowed = f"rows of {width} cells; headings that begin with a letter or #"
            raise TextError(value, allowed)
    remarks += [(number, line.strip()) for number, line in body[:start]]
    rows, lines = rows[first:], lines[first:]
    if trailing and len(rows[0]) > 1 and (not header or len(header[0]) < width):
        rows, width = [row[:-1] for row in rows], width - 1
    wrong = [(line, len(row)) for line, row in zip(lines, rows, strict=True) if len(row) != width]
    if wrong:
        more = f" and {len(wrong) - 1} more" if len(wrong) > 1 else ""
        value = f"line {wrong[0][0]} of {wrong[0][1]} cells, not {width}{more}"
        raise TextError(value, "rows of equal length")
    if _begins_with_count(rows, decimal):
        remarks.append((lines[0], " ".join(rows[0])))
        rows, lines = rows[1:], lines[1:]
    named = [_parse_label(*cells) for cells in zip(*header, strict=True)]
    names, units = zip(*named, strict=True) if named else ((), ())
    labels = tuple(header[0]) if header else ()
    table = TextTable(rows, lines, labels, names, units, sorted(remarks), decimal)
    return table.without_row_numbers()


def _replace_per_cent(text: str) -> str:
    """Return a text with % instead of words for it."""
    words = r"(?<![^\W_])(per[\s_-]?cent|pct|prozent)(?![^\W_])"
    return re.sub(words, "%", text, flags=re.IGNORECASE)


def _find_counts(text: str) -> list[int]:
    """Return numbers of rows, columns or points that a remark states; empty without them."""
    what = "(?:points|rows|columns|lines|samples|pixels|values|profiles)"
    count = rf"(?:number of |data |no\.? of )?{what}|n ?(?:cols|rows|x|y)|[xy][ _-]?(?:res|pixels)"
    match = re.fullmatch(rf"(?:{count})\s*[:=\s]\s*(\d+)", text.strip(), re.IGNORECASE)
    match = match or re.fullmatch(rf"(\d+)\s+{what}", text.strip(), re.IGNORECASE)
    match = match or re.search(rf"\b(\d+)\s*[x×*]\s*(\d+)\s+{what}\b", text, re.IGNORECASE)
    return [int(number) for number in match.groups()] if match else []


def _states_scale(key: str, value: str, text: str) -> bool:
    """Return whether a remark states a scale, an offset or a sign that changes the numbers."""
    scale = r"scal\w*|factor|gain|offset|inver\w+|mirror\w*|flip\w*|multipl\w+|upside"
    if re.search(rf"\b({scale})\b", key):
        return value.lower() not in ("1", "1.0", "0", "0.0", "no", "off", "none", "false")
    more = rf"{scale}|divided|magnif\w*|amplif\w*|verst(?:ä|ae)rk\w*|conversion|calibration"
    number = r"(?![01](?:\.0*)?(?![\w.,]))[-+]?[\d.,]*\d(?:e[-+]?\d+)?(?![-/:.\d])"
    patterns = (
        rf"\b(?:{more})\b(?:[\s:=]|by|of|is|factor|times)*{number}",
        r"(?<!not )\b(?:upside|inverted|mirrored|flipped)\b",
        r"[^\W\d]\)?(?:\s+[x×]|\s*\*)\s*1(?:0+|e[-+]?\d+)\b",  # z x 1000
        r"\b10\s*(?:\^|\*\*)|\b10[⁻⁺⁰-⁹²³]",
        r"\b\d[\d.]*\s*[*·×]\s*[^\W\d]",  # 2 * value
    )
    return any(re.search(pattern, text, re.IGNORECASE) for pattern in patterns)


def _is_mark(cell: str) -> bool:
    """Return whether instruments write a number, such as -9999, for missing points."""
    return bool(re.fullmatch(r"-(9{3,}([.,][90]*)?|32768(\.0*)?)", cell.strip()))


def _find_marks(numbers: Sequence[Sequence[float | None]]) -> set[float]:
    """Return numbers such as -9999 that mark missing points: far larger than all others."""
    values = {number for row in numbers for number in row if number is not None}
    marks = {value for value in values if value <= -999.0 and _is_mark(f"{value:.10g}")}
    largest = max((abs(value) for value in values - marks if math.isfinite(value)), default=0.0)
    return {mark for mark in marks if abs(mark) > 1.5 * largest}


def _separate_comments(
    text: str, first_line: int
) -> tuple[list[tuple[int, str]], list[tuple[int, str]]]:
    """Return (line, text) of the lines with content, and of comments."""
    # Largest length of a line, characters.
    longest = 1_000_000
    comment = re.compile(r"#|!|%(?!\s*(?:[;,\t#!]|$))")  # but "50 %" is no comment
    body, remarks = [], []
    for number, line in enumerate(text.split("\n"), first_line):
        content = line.strip()
        if len(content) > longest:
            raise TextError(
                f"line {number} longer than {longest} characters", "a line for each row"
            )
        if content[:1] in ("#", "!") or re.match(r"%(?!\s*[;,\t])", content):
            remarks.append((number, content.lstrip("#%! ")))
        elif content:
            mark = comment.search(line) if _NUMBER_LIKE.match(line) else None
            if mark:
                remarks.append((number, line[mark.end() :].strip()))
            body.append((number, line[: mark.start()] if mark else line))
    return body, remarks


def _find_dialect(lines: Sequence[tuple[int, str]]) -> tuple[str, str, int]:
    """Return the separator, the decimal sign, and the number of columns of lines of numbers."""
    sample = [line for _, line in lines[-200:]]
    separator = next(
        (mark for mark in ";\t" if 2 * sum(mark in line for line in sample) > len(sample)), ""
    )
    if not separator:
        score = {
            mark: sum(_classify([cell], sign) == "numbers" for cell in cells) / len(cells)
            for mark, sign in ((",", "."), (" ", "."), (" ,", ","))
            for cells in ([cell for line in sample[-20:] for cell in _split(line, mark[0])],)
        }
        separator = "," if score[","] >= max(score[" "], score[" ,"]) else " "
        separator = separator if any(separator in line.strip() for line in sample) else " "
    width = Counter(len(_split(line, separator)) for line in sample).most_common(1)[0][0]
    commas = separator != "," or any('"' in line for _, line in lines)
    commas = commas and any("," in line for _, line in lines)
    undecided = separator == "," and not any("." in line for line in sample)
    cells = [_split(line, separator) for _, line in lines] if commas or undecided else []
    with_comma = any(re.search(r"^\s*[-+]?\d*,\d", cell) for row in cells for cell in row)
    if undecided and not with_comma:
        _check_comma(lines, [row for row in cells if len(row) == width])
    for column in zip(*(row for row in cells if with_comma and len(row) == width), strict=True):
        grouped = [bool(re.fullmatch(r"[-+]?[1-9]\d{0,2}(,\d{3})+", cell)) for cell in column]
        whole = [bool(re.fullmatch(r"[-+]?\d{1,3}", cell)) for cell in column]
        both = [bool(re.search(r"\d,\d{3}\.\d|\d\.\d{3},\d", cell)) for cell in column]
        ambiguous = any(grouped) and any(whole) and all(map(operator.or_, grouped, whole))
        if any(both) or ambiguous:
            k = (both if any(both) else grouped).index(True)
            value = f"line {lines[k][0]}, {column[k]!r}: separators of thousands are possible"
            raise TextError(value, "numbers with a decimal sign alone")
    return separator, "," if with_comma else ".", width


def _check_comma(lines: Sequence[tuple[int, str]], cells: Sequence[list[str]]) -> None:
    """Raise a TextError if commas between whole numbers look like decimal commas."""
    if any("." in line for _, line in lines):
        return
    matches = [re.fullmatch(r"(\d\d+)([eEdD][-+]?\d+)?", c) for row in cells for c in row[1::2]]
    alike = all(matches) and len({len(match[1]) for match in matches if match}) == 1
    spaced = all(re.search(r",\s", line) and re.search(r"\d,\d", line) for _, line in lines)
    if spaced or (alike and len(cells[0]) % 2 == 0 and len(cells[0]) > 2):
        number, line = lines[0]
        value = f"line {number}, {line.strip()[:40]!r}: commas between columns and in numbers"
        raise TextError(value, "semicolons or tabs between columns, or decimal points")


def _split(line: str, separator: str) -> list[str]:
    """Return the cells of a line, without quotes and surrounding blanks."""
    if '"' in line:
        row = next(csv.reader([line.strip()], delimiter=separator, skipinitialspace=True))
        return [cell.strip() for cell in row if cell or separator != " "]
    return line.split() if separator == " " else [cell.strip() for cell in line.split(separator)]


def _classify(row: Sequence[str], decimal: str) -> str:
    """Return "numbers" of a row without other words, "mixed" of one with both, else "words"."""
    numbers = sum(parse_number(cell, decimal) is not None for cell in row)
    missing = sum(cell.lower() in _MISSING for cell in row if cell.lower() != "nan")
    if numbers + missing == len(row) and (numbers or any(cell not in ("", "-") for cell in row)):
        return "numbers"
    return "mixed" if numbers else "words"


def _begins_with_count(rows: Sequence[list[str]], decimal: str) -> bool:
    """Return whether the first row gives the number of the other rows, away from their values."""
    if rows[0][0] != str(len(rows) - 1) or not all(map(str.isdigit, rows[0])) or len(rows) < 4:
        return False
    places = [parse_number(row[0], decimal) or 0.0 for row in rows]
    steps = np.abs(np.diff(places))
    return bool(steps[0] > 5.0 * steps[1:].max())


def _find_header(
    lines: Sequence[tuple[int, str]],
    remarks: list[tuple[int, str]],
    separator: str,
    width: int,
    trailing: bool,
) -> tuple[list[list[str]], int]:
    """Return the labels and the row of units, and the number of lines above them in the file.

    Parameters
    ----------
    lines, remarks : sequence of (int, str)
        Lines up to the first row of numbers; comments, from which the header is removed.
    separator : str
        Separator of the columns.
    width : int
        Number of columns.
    trailing : bool
        Whether the last column is empty, so that the header may have one cell less.

    Returns
    -------
    header : list of list of str
        Labels and units of each column; empty without a header.
    start : int
        Number of lines above the header.
    """
    above = lines[:-1]

    def fit(line: str) -> list[str]:
        """Return a cell for each column; empty if the line is no header."""
        if _STATEMENT.match(line):
            return []
        candidates = [_split(line, separator)]
        if separator == " ":
            candidates.append(_split(re.sub(r"\s+(?=[\[(])", "", line), " "))
            patterns = r"\s{2,}|\t+", r"[,;]\s*"
            candidates += [re.split(pattern, line.strip()) for pattern in patterns]
        for cells in candidates:
            labels = cells[:-1] if trailing and not cells[-1] else cells
            if len(labels) in (width, width - trailing) and _classify(labels, ".") == "words":
                return labels
        return []

    plain = [fit(line) for _, line in above[-2:]]
    if plain and not plain[-1] and not _STATEMENT.match(above[-1][1]):
        cells = len(_split(above[-1][1], separator))
        if separator != " " and cells > 1:
            value = f"line {above[-1][0]}, {above[-1][1].strip()[:40]!r}, of {cells} cells"
            raise TextError(value, f"a header of {width} cells, as many as in the rows")
    between = (above[-1][0] if above else 0), lines[-1][0]
    notes = [r for r in remarks if between[0] < r[0] < between[1] and not _STATEMENT.match(r[1])]
    for found in plain, [fit(line) for _, line in notes[-2:]]:
        if not found or not found[-1]:
            continue
        header = [found[-1], [""] * len(found[-1])]
        units = [_read_unit(cell) for cell in found[-1] if cell]
        if len(found) > 1 and len(found[-2]) == len(found[-1]) and None not in units:
            header = [found[-2], found[-1]]
        used = 1 + (header[1] is found[-1])
        if found is plain:
            return header, len(above) - used
        named = [_parse_label(*cells) for cells in zip(*header, strict=True)]
        if any(unit or len(name) == 1 or "." in name for name, unit in named):
            for note in notes[-used:]:
                remarks.remove(note)
            return header, len(above)
    return [], len(above)


def _read_unit(text: str) -> str | None:
    """Return a unit without brackets, of lengths as in `LENGTHS`; None for other words."""
    inner = re.sub(r"^\s*[\[({<]\s*|\s*[\])}>]\s*$", "", text)
    known = find_length_unit(inner)
    if known or inner != text or inner.casefold() in _SCALES:
        return known or inner
    return None


def _parse_label(label: str, unit: str = "") -> tuple[str, str]:
    """Return the name and the unit of a column; an error if a row of units has another unit."""
    # Other words may be part of a name.
    units = {unit: unit for unit in ("kN", "N", "MPa", "GPa", "kPa", "Nm", "mrad", "rad", "deg")}
    name, stated = label.strip().strip("'\""), ""
    brackets, last_word = r"(.+?)[\s_]*[\[({<](.*)[\])}>]", r"(.+?)(?:[\s_]in[\s_]|[\s,/]+)(\S+)"
    ratio = re.fullmatch(r"(.*?\w)(?:[\s_]+in)?[\s_,/]*([%‰])", _replace_per_cent(name))
    match = re.fullmatch(f"{brackets}|{last_word}", name)
    if ratio:
        name, stated = ratio[1], ratio[2]
    elif match and match[1]:
        name, stated = match[1], find_length_unit(match[2]) or _replace_per_cent(match[2].strip())
    elif match and (found := find_length_unit(match[4]) or units.get(match[4])):
        name, stated = match[3], found
    elif short := re.fullmatch(r"([^\W\d_]+)_([^\W_]+)", name):
        found = find_length_unit(short[2]) or units.get(short[2])
        name, stated = (short[1], found) if found else (name, "")
    below = (_read_unit(_replace_per_cent(unit)) or unit) if unit else ""
    if stated and below and stated != below:
        raise TextError(f"column {label!r} in {below}", "one unit for each column")
    return name, stated or below
