"""Tables of numbers in text, as instruments, spreadsheets and other programs write them."""

import csv
import math
import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from os import PathLike
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

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
    "km": (1e6, "mm"),
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
     "nodata", "nan(ind)", "1.#qnan", "1.#ind", "-1.#ind")
)  # fmt: skip
"""Texts of cells, in lower case, that stand for a missing value."""

_NUMBER_LIKE = re.compile(r"\s*[\"']?[-+−]?[.,]?\d")
_STATEMENT = re.compile(r"\s*([^\W\d][^:=]*?)\s*[:=]\s*(.*\S)")


def _write_patterns() -> dict[str, str]:
    """Return the patterns of remarks by meaning: of "key=value", or of a text without a key."""
    items = "(?:points|rows|columns|lines|samples|pixels|values|profiles)"
    scale = r"\b(?:scal\w*|factor|gain|offset|inver\w+|mirror\w*|flip\w*|multipl\w+|upside"
    none = r"(?:[01](?:[.,]0*)?x?|1:1|no|off|none|false|linear)$"
    number = r"(?![01](?:\.0*)?x?(?![\w.,]))[-+]?[\d.,]*\d(?:e[-+]?\d+)?(?![-/:.\d])"
    step = r"\bd[xy]\b|step|spacing|pixel ?size|cell ?size|pitch|increment"
    return {
        # What all readers check or refuse.
        "counts": rf"^(?:number of |data |no\.? of )?{items}[=\s]\s*(\d+)$|^(\d+)\s+{items}$|"
        rf"^(?:n ?(?:cols|rows|x|y)|[xy][ _-]?(?:res|pixels))[=\s]\s*(\d+)$|"
        rf"\b(\d+)\s*[x×*]\s*(\d+)\s+{items}\b",
        "scale": rf"{scale})\b[^=]*=(?!{none})|"
        rf"{scale}|divided|magnif\w*|amplif\w*|verst(?:ä|ae)rk\w*|conversion|calibration)\b"
        rf"(?:[\s=]|by|of|is|factor|times)*{number}|"
        rf"(?<!not )\b(?:upside|inverted|mirrored|flipped)\b(?![^=]*={none})|"
        r"[^\W\d]\)?(?:\s+[x×]|\s*\*)\s*1(?:0+|e[-+]?\d+)\b|"  # z x 1000
        rf"\bunits?\b[^=]*=\W*{number}|"  # units: 0.1 mm
        r"\b10\s*(?:\^|\*\*)|\b10[⁻⁺⁰-⁹²³]|\b\d[\d.]*\s*[*·×]\s*[^\W\d]",  # 2 * value
        # What no reader names: all other remarks state something.
        "nothing": r"^sep=\W?$|^\W*(?:(?:begin|by|channel|data|end|eof|file|first|hand|kind|of|one|"
        r"measured|pass|points?|rig|run|scan|second|stylus|start|test|the|third|three|two)(?:\W+|$))*$",
        # What maps and traces use or refuse.
        "unit of values": r"^(?![^=]*(?:\b[xy]\b|lateral))[^=]*\bunits?\b[^=]*=",
        "size": r"^(?:width|height)=([\d.e+-]+)\s*(\S+)$",
        "order": r"^[^=]*\b(?:columns?|rows?|format|fields|order|layout)\b[^=]*(?:=|$)",
        "rows along y": r"rows?\W+(?:are |along )?y\b|columns?\W+(?:are |along )?x\b",
        "origin": r"^origin=.*(?:lower|upper|top|bottom|left|right)",
        "downwards": r"\b(?:positive|direction|orientation|sign|points?|axis)\b.*"
        r"\b(?:down\w*|into|inwards?|below)\b",
        "step": step,
        "lengths": rf"^(?=[^=]*=|.*\d)[^=]*(?:unit|pixel|resolution|sampling|\bdz\b|{step})",
        # What profiles use.
        "points": r"^(?:xypoints|points|number of points)=",
        "entry": r"^(?:[xy]offset|columndef|(?:length )?units?)=",
        "side": r"^(?:rail|side)=(?:l.*|r|right)$",
        "description": r"^(?:alarm|area(?:gain|loss|ref)|battery|bogie|car|chainage|chars|comment|"
        r"curve|date|device|driver|empl(?:oyee)?(?:num|no)?|field id|file(?: ?name)?|flag|grade|id|"
        r"instrument|km|kp|line|location|location_(?:latitude|longitude)|mileage|mp|name|operator|"
        r"originalheader|program ?(?:date|name|ver|version)|qr|rcf|s[dh]|serial ?(?:no|number)|"
        r"speed|stock|temperature|time|title|train|type|uof\d|user ?name|vehicle|version|w\d|"
        r"windows ?version)=[^=]*$",
    }


_MEANINGS = _write_patterns()
"""Patterns of remarks, in lower case, by their meaning."""


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


class Remark(NamedTuple):
    """A comment, or a line above the rows of a table: its line number, from 1, and its text."""

    line: int
    text: str

    @property
    def key(self) -> str:
        """Key of "key: value" or "key = value", in lower case; "" of other texts."""
        match = _STATEMENT.match(self.text)
        return match[1].lower() if match else ""

    @property
    def value(self) -> str:
        """Value of "key: value" or "key = value"; other texts as they are."""
        match = _STATEMENT.match(self.text)
        return match[2] if match else self.text

    @property
    def place(self) -> str:
        """Line and text, for messages."""
        return f"line {self.line}, {self.text[:60]!r}"

    def states(self, meaning: str) -> re.Match[str] | None:
        """Return the match of the remark and the pattern of a meaning; None without one."""
        key = f"{self.key}=" if self.key else ""
        return re.search(_MEANINGS[meaning], f"{key}{self.value}".strip().lower())


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


def find_length_units(text: str) -> list[str]:
    """Return the units of length among the words of a text, but not the word "in"."""
    words = (word for word in re.split(r"[\s\[\](){},;:=]+|(?<=\d)(?=[^\W\d])", text))
    return [
        unit for word in words if word not in ("in", "mil") and (unit := find_length_unit(word))
    ]


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


def find_marks(values: np.ndarray) -> np.ndarray:
    """Return which values are numbers, such as -9999, that instruments write for missing points.

    Such a number is more than 1.5 times as large as all other values.
    """
    sizes = np.abs(values)
    candidates = np.unique(sizes[sizes >= 999.0])
    marks = [m for m in candidates if re.fullmatch(r"9{3,}(\.9+)?|3276[78]", f"{m:.10g}")]
    is_mark = np.isin(sizes, marks)
    others = sizes[~is_mark & np.isfinite(sizes)]
    return is_mark & (sizes > 1.5 * others.max(initial=0.0))


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
    remarks : list of Remark
        Comments, lines before the header, and left-out row numbers.
    decimal : str
        Decimal sign: a point or a comma.
    """

    rows: list[list[str]]
    lines: list[int]
    labels: tuple[str, ...] = ()
    names: tuple[str, ...] = ()
    units: tuple[str, ...] = ()
    remarks: Sequence[Remark] = ()
    decimal: str = "."

    def find(self, name: str) -> int | None:
        """Return the index of the column with a label or a name; None without one.

        Raises
        ------
        TextError
            If several columns have the name.
        """
        texts = self.labels if name in self.labels else self.names
        if texts.count(name) > 1:
            raise TextError(f"two columns {name}", "each column name once")
        return texts.index(name) if name in texts else None

    def column(self, place: int, meaning: str, missing: bool = False) -> np.ndarray:
        """Return the numbers of a column in the unit that its meaning names, shape (rows,).

        Parameters
        ----------
        place : int
            Index of the column.
        meaning : str
            See `find_scale`.
        missing : bool
            See `numbers`.

        Raises
        ------
        TextError
            If the column has a unit of another quantity, or a cell is no finite number.
        """
        factor = find_scale(self.units[place], meaning)
        if factor is None:
            value = f"column {self.labels[place]!r} in {self.units[place]}"
            raise TextError(value, f"the unit of {meaning}")
        return factor * self.numbers([place], missing)[:, 0]

    def numbers(self, columns: Sequence[int] | None = None, missing: bool = False) -> np.ndarray:
        """Return cells as finite numbers, shape (rows, columns).

        Parameters
        ----------
        columns : sequence of int, optional
            Indices of the columns; by default all.
        missing : bool
            If true, empty cells, words such as "nan" and numbers such as -9999 give nan.

        Raises
        ------
        TextError
            If a cell is no finite number; the message names the line and the cell of the first.
        """
        rows = self.rows if columns is None else [[row[k] for k in columns] for row in self.rows]
        # Python and NumPy read "1_0" as 10.
        if self.decimal == "." and not any("_" in "".join(row) for row in rows):
            with suppress(ValueError):
                values = np.array(rows, float)
                if np.isfinite(values).all() and values.min() > -999.0:
                    return values
        values = np.array(
            [[parse_number(cell, self.decimal) for cell in row] for row in rows], float
        )
        is_mark = find_marks(values) & (values < 0.0)
        values[is_mark] = math.nan
        wrong = [
            (i, k)
            for i, k in np.argwhere(~np.isfinite(values))
            if not (missing and (is_mark[i, k] or rows[i][k].lower() in _MISSING))
        ]
        if not wrong:
            return values
        i, k = wrong[0]
        cell, column = rows[i][k], k if columns is None else columns[k]
        label = self.labels[column] if self.labels else ""
        place = f"line {self.lines[i]}, {cell!r}" + (f" in column {label}" if label else "")
        allowed = "a finite number in every cell"
        if "." in cell and self.decimal == ",":
            allowed += ", with a decimal comma as in other cells, and no separators of thousands"
        if re.fullmatch(r"[-+]?\d{1,3}([,.]\d{3})+([,.]\d*)?", cell):
            allowed += ", without separators of thousands"
        raise TextError(list_first([place] * len(wrong), 1), allowed)

    def find_unused(self, units: Collection[str], remarks: Iterable[Remark] | None = None) -> str:
        """Return a note that lists remarks that state something; "" without them.

        Parameters
        ----------
        units : collection of str
            Units that are used.
        remarks : iterable of Remark, optional
            Remarks that are not used otherwise; by default all.

        Raises
        ------
        TextError
            If one states a scale, another unit, or another number of rows or columns.
        """
        remarks = self.remarks if remarks is None else remarks
        lines = [f"line {r.line} {r.text[:40]!r}" for r in remarks if self._is_unused(r, units)]
        return f"comments and headings are not used: {list_first(lines, 3)}" if lines else ""

    def _is_unused(self, remark: Remark, units: Collection[str]) -> bool:
        """Return whether a remark states something; a TextError as in `find_unused`."""
        cure = "the file without this line, if it does not apply"
        rows = len(self.rows)
        if counts := remark.states("counts"):
            if not self._has_size([int(count) for count in counts.groups() if count], remark.text):
                raise TextError(f"{remark.place}, but {rows} rows", f"a complete file; or {cure}")
            return False
        if remark.states("scale"):
            value = f"{remark.place}, which is not applied"
            raise TextError(value, f"numbers to which it is; or {cure}")
        words = re.split(r"[\s,;:=]+", _replace_per_cent(remark.value))
        for before, word in zip(["", *words], words, strict=False):
            inner = word.strip("[](){}<>.")
            is_unit = inner != word or before in ("in", "unit", "units")
            is_unit |= bool(remark.key) and inner not in ("in", "mil")
            # "Operator: S" names no unit, but "normal: N" does.
            is_unit &= not inner.isdigit() and inner != "-"
            is_unit &= len(inner) > 1 or not inner.isupper() or inner == "N"
            stated = _read_unit(inner) if is_unit and not remark.states("description") else None
            if stated and parse_number(before) is None and stated not in units:
                value = f"{remark.place}, with the unit {inner}"
                raise TextError(value, f"units in the header; or {cure}")
        is_count = remark.text.replace(" ", "").isdigit() and remark.text.split()[0] == str(rows)
        return not is_count and not remark.states("nothing")

    def _has_size(self, counts: list[int], text: str) -> bool:
        """Return whether the table, or its part without coordinates, has the stated size."""
        rows, columns = len(self.rows), len(self.rows[0])
        corner = self.names or parse_number(self.rows[0][0], self.decimal)
        shapes = [(rows, columns), *([] if corner else [(rows - 1, columns - 1)])]
        is_grid = columns <= 3 and re.match(r"n ?(cols|rows|[xy]\b)|[xy]", text.lower())
        whole = (rows, *map(math.prod, shapes))
        if len(counts) == 2:
            return sorted(counts) in map(sorted, shapes) or math.prod(counts) in whole
        (n,) = counts
        if n in whole and re.search("point|pixel|sample|value", text.lower()):
            return True
        return n in sum(shapes, ()) or bool(is_grid and n and rows % n == 0)

    def _without_row_numbers(self) -> Self:
        """Return the table without a first column that a header marks as row numbers."""
        titles = ("", "#", "no", "nr", "index", "row", "line", "point", "sample")
        if len(self.names) < 2 or self.names[0].lower() not in titles:
            return self
        first = [parse_number(row[0], self.decimal) for row in self.rows]
        if first != [k + (first[0] or 0.0) for k in range(len(first))]:
            return self
        remark = Remark(self.lines[0], "the first column holds row numbers")
        labels, names, units = (texts[1:] for texts in (self.labels, self.names, self.units))
        table = replace(self, labels=labels, names=names, units=units)
        return replace(table, rows=[row[1:] for row in self.rows], remarks=[*self.remarks, remark])


def equal_columns(columns: Mapping[str, ArrayLike]) -> dict[str, np.ndarray]:
    """Return columns of finite numbers, each of shape (rows,); a TextError for others."""
    try:
        arrays = {name: np.asarray(values, float).ravel() for name, values in columns.items()}
    except (ValueError, TypeError):
        raise TextError("no numbers", "numbers in every row") from None
    if len({array.size for array in arrays.values()} - {0}) != 1:
        sizes = ", ".join(f"{array.size} values of {name}" for name, array in arrays.items())
        raise TextError(sizes, "columns of equal length, with a row for each measurement")
    for name, array in arrays.items():
        if (wrong := np.flatnonzero(~np.isfinite(array))).size:
            value = f"{array[wrong[0]]} in row {wrong[0] + 1} of {name}"
            raise TextError(value, "finite numbers in every row")
    return arrays


def list_first(texts: Sequence[str], most: int) -> str:
    """Return at most `most` texts, separated by commas, and the number of the others."""
    more = f"{',' * (most > 1)} and {len(texts) - most} more" if len(texts) > most else ""
    return ", ".join(texts[:most]) + more


def read_table(
    path: str | PathLike[str], max_bytes: int = 2**26, *, named: bool = False
) -> TextTable:
    """Return the table in a text file; see `parse_table`.

    Parameters
    ----------
    path : path-like
        The file.
    max_bytes : int
        Largest size of the file.
    named : bool
        Whether the columns must have names.

    Raises
    ------
    OSError
        See `input_file.read_text`.
    TextError
        If there is no table, or no name of a column that needs one.
    """
    try:
        table = parse_table(read_text(path, max_bytes, None))
    except UnicodeDecodeError:
        raise TextError("bytes that are no text", "text in UTF-8, UTF-16 or Windows-1252") from None
    if named and not table.names:
        raise TextError("no header row", "a row of column names above the numbers")
    return table


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
    if not body:
        raise TextError("no rows", "a row of numbers for each point")
    number_like = [line for line in body if _NUMBER_LIKE.match(line.text)]
    separator, decimal, width = _find_dialect(number_like or body)
    rows = [_split(line.text, separator) for line in body]
    first = _find_first_row(body, rows, decimal, width)
    above, count = body[:first], [str(len(rows) - first)]
    if first and rows[first - 1] == count:
        remarks.append(Remark(above.pop().line, *count))
    lines, rows = [line.line for line in body[first:]], rows[first:]
    trailing = separator != " " and all(not row[-1] for row in rows)
    last_line = above[-1].line if above else 0
    notes = [
        r for r in remarks if last_line < r.line < lines[0] and not r.key and r.text != count[0]
    ]
    header, used = _find_header(above, notes, separator, width, trailing)
    above = [line for line in above if line not in used]
    for line in above:
        cells = _split(line.text, separator)
        if parse_number(cells[0], decimal) is not None and cells != count:
            value = f"line {line.line}, {line.text.strip()[:40]!r}, before the table"
            raise TextError(value, f"rows of {width} cells; headings that begin with a letter or #")
    remarks = [r for r in remarks if r not in used]
    remarks += [Remark(line.line, line.text.strip()) for line in above]
    if trailing and width > 1 and len(header) < width:
        rows, width = [row[:-1] for row in rows], width - 1
    sizes = zip(lines, map(len, rows), strict=True)
    wrong = [f"line {line} of {n} cells, not {width}" for line, n in sizes if n != width]
    if wrong:
        raise TextError(list_first(wrong, 1), "rows of equal length")
    if _begins_with_count(rows, decimal):
        remarks.append(Remark(lines[0], " ".join(rows[0])))
        rows, lines = rows[1:], lines[1:]
    labels, names, units = zip(*header, strict=True) if header else ((), (), ())
    table = TextTable(rows, lines, labels, names, units, sorted(remarks), decimal)
    return table._without_row_numbers()


def _replace_per_cent(text: str) -> str:
    """Return a text with % instead of words for it."""
    words = r"(?<![^\W_])(per[\s_-]?cent|pct|prozent)(?![^\W_])"
    return re.sub(words, "%", text, flags=re.IGNORECASE)


def _separate_comments(text: str, first_line: int) -> tuple[list[Remark], list[Remark]]:
    """Return the lines with content, and the comments."""
    longest = 1_000_000  # characters of a line
    comment = re.compile(r"(?<!\.)#|!|%(?!\s*(?:[;,\t#!]|$))")  # but "50 %" is no comment
    body, remarks = [], []
    for number, line in enumerate(text.split("\n"), first_line):
        content = line.strip()
        if len(content) > longest:
            value = f"line {number} longer than {longest} characters"
            raise TextError(value, "a line for each row")
        if content[:1] in ("#", "!") or re.match(r"%(?!\s*[;,\t])", content):
            remarks.append(Remark(number, content.lstrip("#%! ")))
        elif not re.fullmatch(r"[-=_]{4,}|", content):  # a rule below a header
            mark = comment.search(line) if _NUMBER_LIKE.match(line) else None
            if mark:
                remarks.append(Remark(number, line[mark.end() :].strip()))
            body.append(Remark(number, line[: mark.start()] if mark else line))
    return body, remarks


def _find_dialect(lines: Sequence[Remark]) -> tuple[str, str, int]:
    """Return the separator, the decimal sign, and the number of columns of lines of numbers.

    Of the separators and signs that are possible, those count that make most cells of the last
    lines numbers.
    """
    sample = [line.text for line in lines[-200:]]
    common = [mark for mark in ";\t" if 2 * sum(mark in line for line in sample) > len(sample)]
    quoted = any('"' in line for line in sample)

    def share(dialect: tuple[str, str]) -> float:
        """Return the share of numbers among the cells."""
        cells = [cell for line in sample[-20:] for cell in _split(line, dialect[0])]
        return sum(_classify([cell], dialect[1]) == "numbers" for cell in cells) / len(cells)

    marks = common[:1] or [" ", ","]
    dialects = [(mark, decimal) for decimal in ".," for mark in marks]
    dialects = [pair for pair in dialects if quoted or pair != (",", ",")]
    separator = max(dialects, key=share)[0]
    width = Counter(len(_split(line, separator)) for line in sample).most_common(1)[0][0]
    if separator == "," and not quoted:
        _check_separating_commas(lines, width)
        return separator, ".", width
    if not any("," in line.text for line in lines):
        return separator, ".", width
    rows = [(line, _split(line.text, separator)) for line in lines]
    if not any(re.match(r"[-+]?\d*,\d", cell) for _, row in rows for cell in row):
        return separator, ".", width
    rows = [row for row in rows if len(row[1]) == width]
    for k in range(width):
        column = [row[k] for _, row in rows]
        both = [bool(re.search(r"\d,\d{3}\.\d|\d\.\d{3},\d", cell)) for cell in column]
        groups = [bool(re.fullmatch(r"[-+]?[1-9]\d{0,2}(,\d{3})+", cell)) for cell in column]
        whole = [bool(re.fullmatch(r"[-+]?\d{1,3}", cell)) for cell in column]
        if any(groups) and any(whole) and all(map(max, groups, whole)):
            both = groups
        if any(both):
            n = both.index(True)
            value = f"line {rows[n][0].line}, {column[n]!r}: separators of thousands are possible"
            raise TextError(value, "numbers with a decimal sign alone")
    return separator, ",", width


def _check_separating_commas(lines: Sequence[Remark], width: int) -> None:
    """Raise a TextError if commas between whole numbers look like decimal commas."""
    texts = [line.text for line in lines]
    if any("." in text for text in texts):
        return
    cells = [row[1::2] for row in (_split(text, ",") for text in texts) if len(row) == width]
    matches = [re.fullmatch(r"(\d\d+)([eEdD][-+]?\d+)?", cell) for row in cells for cell in row]
    alike = all(matches) and len({len(match[1]) for match in matches if match}) == 1
    spaced = all(re.search(r",\s", text) and re.search(r"\d,\d", text) for text in texts)
    if spaced or (alike and width % 2 == 0 and width > 2):
        place = f"line {lines[0].line}, {texts[0].strip()[:40]!r}"
        value = f"{place}: commas between columns and in numbers"
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


def _find_first_row(
    body: Sequence[Remark], rows: Sequence[list[str]], decimal: str, width: int
) -> int:
    """Return the index of the first row of the table; a TextError without one.

    It is the first row of numbers alone. Rows directly above it that also have other cells belong
    to the table: the first row of a matrix with a word in its corner, or a row with a wrong cell.
    """
    kinds = (_classify(row, decimal) if len(row) == width else "" for row in rows)
    mixed: list[int] = []
    for k, kind in enumerate(kinds):
        if kind == "numbers":
            above = next((n for n in range(k - 1, -1, -1) if n not in mixed or body[n].key), -1)
            return above + 1
        mixed += [k] * (kind == "mixed")
    if not mixed:
        value = f"no rows below the header; {body[-1].place}, is none"
        raise TextError(value, "a row of numbers for each point, without units")
    return mixed[0]


def _begins_with_count(rows: Sequence[list[str]], decimal: str) -> bool:
    """Return whether the first row gives the number of the other rows, away from their values."""
    if rows[0][0] != str(len(rows) - 1) or not all(map(str.isdigit, rows[0])) or len(rows) < 4:
        return False
    places = [parse_number(row[0], decimal) or 0.0 for row in rows]
    steps = np.abs(np.diff(places))
    return bool(steps[0] > 5.0 * steps[1:].max())


def _find_header(
    above: Sequence[Remark], notes: Sequence[Remark], separator: str, width: int, trailing: bool
) -> tuple[list[tuple[str, str, str]], list[Remark]]:
    """Return label, name and unit of the columns, and the lines that state them; else empty lists.

    Parameters
    ----------
    above : sequence of Remark
        Lines above the first row: the last is a header if it has a label for each column.
    notes : sequence of Remark
        Comments below these lines: else, the last is a header if its labels look like columns.
    separator : str
        Separator of the columns.
    width : int
        Number of columns.
    trailing : bool
        Whether the last column is empty, so that the header may have one cell less.
    """

    def read_labels(line: Remark) -> list[str]:
        """Return a label for each column; empty if the line is no header."""
        texts = [_split(line.text, separator)]
        if separator == " ":
            texts.append(_split(re.sub(r"\s+(?=[\[(])", "", line.text), " "))
            texts += [re.split(mark, line.text.strip()) for mark in (r"\s{2,}|\t+", r"[,;]\s*")]
        for cells in () if line.key else texts:
            labels = cells[:-1] if trailing and not cells[-1] else cells
            if len(labels) in (width, width - trailing) and _classify(labels, ".") == "words":
                return labels
        return []

    def read_header(lines: Sequence[Remark]) -> tuple[list[tuple[str, str, str]], list[Remark]]:
        """Return the header in the last line, or in the last two if they state names and units."""
        before, labels = [*([], []), *map(read_labels, lines[-2:])][-2:]
        is_units = all(_read_unit(cell) is not None for cell in labels if cell)
        if labels and is_units and len(before) == len(labels):
            pairs, used = [*zip(before, labels, strict=True)], [*lines[-2:]]
        else:
            pairs, used = [(label, "") for label in labels], [*lines[-1:]] if labels else []
        return [(pair[0], *_parse_label(*pair)) for pair in pairs], used

    header, used = read_header(above)
    if header:
        return header, used
    if above and not above[-1].key and separator != " ":
        cells = len(_split(above[-1].text, separator))
        if cells > 1:
            value = f"line {above[-1].line}, {above[-1].text.strip()[:40]!r}, of {cells} cells"
            cure = "; semicolons or tabs between columns if commas are decimal signs"
            allowed = f"a header of {width} cells, as many as in the rows"
            raise TextError(value, allowed + cure * (separator == ","))
    header, used = read_header(notes)
    is_named = any(unit or len(name) == 1 or "." in name for _, name, unit in header)
    return (header, used) if is_named else ([], [])


def _read_unit(text: str) -> str | None:
    """Return a unit without brackets, of lengths as in `LENGTHS`; None for other words."""
    inner = re.sub(r"^\s*[\[({<]\s*|\s*[\])}>]\s*$", "", text)
    known = find_length_unit(inner)
    return known or (inner if inner != text or inner.casefold() in _SCALES else None)


def _parse_label(label: str, unit: str = "") -> tuple[str, str]:
    """Return the name and the unit of a column; an error if a row of units has another unit."""
    name = label.strip().strip("'\"")
    text = _replace_per_cent(name)
    brackets, last_word = r"(.+?)[\s_]*[\[({<](.*)[\])}>]", r"(.+?)(?:[\s_]in[\s_]|[\s,/]+)(\S+)"
    ratio = re.fullmatch(r"(.*?\w)(?:[\s_]+in)?[\s_,/]*([%‰])", text)
    stated = ""
    if ratio:
        name, stated = ratio[1], ratio[2]
    elif match := re.fullmatch(brackets, name):
        name, stated = match[1], find_length_unit(match[2]) or _replace_per_cent(match[2].strip())
    elif match := re.fullmatch(last_word, name) or re.fullmatch(r"([^\W\d_]+)_([^\W_]+)", name):
        # Other words may be part of a name.
        others = ("kN", "N", "MPa", "GPa", "kPa", "Nm", "mrad", "rad", "deg")
        found = find_length_unit(match[2]) or (match[2] if match[2] in others else "")
        name, stated = (match[1], found) if found else (name, "")
    below = (_read_unit(_replace_per_cent(unit)) or unit) if unit else ""
    if stated and below and stated != below:
        raise TextError(f"column {label!r} in {below}", "one unit for each column")
    return name, stated or below
