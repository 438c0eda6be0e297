"""Formats of numbers, units and symbols, and descriptions in rows, for all outputs.

Terminals, notebooks, figures, pages and messages use these functions. A `Description` consists of
sections of rows, each a label and a text. This module contains no physics: a module that computes a
quantity also describes it.
"""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import zip_longest
from typing import Any, Protocol

from tractive_sam.safe_text import Html, as_html, fill, printable_text


@dataclass(frozen=True)
class Row:
    """One line of a description: label, text, and whether the brief form has it.

    Attributes
    ----------
    label : str
        Name of the quantity or setting.
    text : str
        Its description, with numbers and units.
    brief : bool
        Whether the summary of a scene and the report of a run print it.
    """

    label: str
    text: str
    brief: bool = False


@dataclass(frozen=True)
class Section:
    """Section of a description: a heading and its rows of label and text."""

    title: str
    rows: list[tuple[str, str]]


class Description(tuple[Section, ...]):
    """Sections of a description, shown as text, and as tables in a notebook."""

    __slots__ = ()

    def __repr__(self) -> str:
        return "\n\n".join(text_table(section.title, dict(section.rows)) for section in self)

    def _repr_html_(self) -> Html:
        """Return the description as HTML tables, for notebooks."""
        template = "<b>$title</b>$rows"
        return as_html(
            fill(template, title=section.title, rows=html_table(dict(section.rows)))
            for section in self
        )


@dataclass(frozen=True)
class TextTable:
    """Table of texts, for a terminal and for a notebook.

    Attributes
    ----------
    rows : sequence of sequence of str
        The cells of each row.
    headings : tuple of str
        The heading of each column, with its unit in a second line; none for labels and texts.
    numbers : frozenset of int
        The columns of numbers, which are aligned at the right.
    caption : str
        A line below the table, or an empty text.
    """

    rows: Sequence[Sequence[str]]
    headings: tuple[str, ...] = ()
    numbers: frozenset[int] = frozenset()
    caption: str = ""

    @classmethod
    def from_labels(cls, rows: Mapping[str, str]) -> "TextTable":
        """Return the table of labels and their texts."""
        return cls([*rows.items()])

    @classmethod
    def from_dicts(cls, rows: Sequence[Mapping[str, str]]) -> "TextTable":
        """Return the table of rows of texts by heading; its first column contains no numbers."""
        headings = tuple(rows[0]) if rows else ()
        numbers = frozenset(range(1, len(headings)))
        return cls([[*row.values()] for row in rows], headings, numbers)

    def to_text(self) -> str:
        """Return the table as aligned lines."""
        lines = [*zip_longest(*(heading.split("\n") for heading in self.headings), fillvalue="")]
        cells = [*lines, *([printable_text(text) for text in row] for row in self.rows)]
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        texts = (
            "  ".join(
                f"{text:>{width}}" if number in self.numbers else f"{text:{width}}"
                for number, (text, width) in enumerate(zip(line, widths, strict=True))
            ).rstrip()
            for line in cells
        )
        return "\n".join([*texts, *filter(None, [self.caption])])

    def to_html(self) -> Html:
        """Return the table as HTML."""
        if not (self.headings or self.numbers):
            return html_table({label: text for label, text in self.rows})  # noqa: C416 - typed
        cells: list[tuple[str, Sequence[str]]] = [("th", self.headings)] if self.headings else []
        cells += (("td", row) for row in self.rows)
        lines = (
            fill(
                "<tr>$cells</tr>\n",
                cells=[fill(f"<{tag}>$text</{tag}>", text=text) for text in row],
            )
            for tag, row in cells
        )
        return fill("<table>$lines</table>", lines=lines)


class ShortArrays:
    """Base of dataclasses with arrays, whose `repr` states shapes and ranges in one line.

    The dataclass is declared with ``repr=False``.
    """

    def __repr__(self) -> str:
        values = ((field.name, getattr(self, field.name)) for field in fields(self) if field.repr)  # type: ignore[arg-type]
        texts = (f"{name}={_short_repr(value)}" for name, value in values)
        return f"{type(self).__name__}({', '.join(texts)})"


def _short_repr(value: Any) -> str:
    """Return the text "<shape: least to largest>" of an array, and the `repr` of other values."""
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{key!r}: {_short_repr(item)}' for key, item in value.items())}}}"
    if not hasattr(value, "dtype") or value.ndim == 0 or value.dtype.kind not in "bif":
        return repr(value)
    shape = " x ".join(map(str, value.shape))
    finite = [float(item) for item in value.flat if math.isfinite(item)]
    between = f": {min(finite):.4g} to {max(finite):.4g}" if finite else ""
    return f"<{shape}{between}>"


class Labelled(Protocol):
    """Protocol of a quantity to be formatted, as `results.Quantity`: name, unit, symbol, format."""

    @property
    def name(self) -> str:
        """Name of the quantity in files and in Python."""

    @property
    def unit(self) -> str:
        """Unit of the quantity, "1" for none."""

    @property
    def symbol(self) -> str:
        """Symbol of the quantity as math text, "" for none."""

    @property
    def format(self) -> str:
        """Format specification of values of the quantity."""


def format_number(value: float, error_bar: float = 0.0) -> str:
    """Return a number and its error bar as text, with as many digits as the error bar justifies.

    Examples
    --------
    >>> from tractive_sam.description import format_number
    >>> format_number(77.3512), format_number(77.3512, 0.0123), format_number(300.0)
    ('77.35', '77.351 ± 0.012', '300')
    """
    if math.isinf(error_bar):
        return f"{value:.4g}, without a limit on finer meshes"
    if error_bar > 1e-12 * abs(value):  # smaller ones are rounding errors
        # As many digits as the error bar has, which is printed with two.
        decimals = max(0, 1 - math.floor(math.log10(error_bar)))
        if abs(value) >= 1e-3:
            return f"{value:.{decimals}f} ± {error_bar:.{decimals}f}"
        return f"{value:.4g} ± {error_bar:.2g}"
    return f"{value:.0f}" if float(value).is_integer() and abs(value) < 1e9 else f"{value:.4g}"


def without_nan(value: Any) -> Any:
    """Return nested dictionaries and lists with None instead of nan and inf, as JSON needs."""
    if isinstance(value, dict):
        return {key: without_nan(item) for key, item in value.items()}
    if isinstance(value, list):
        return [without_nan(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def format_duration(seconds: float) -> str:
    """Return a time as text in seconds, minutes or hours.

    Examples
    --------
    >>> from tractive_sam.description import format_duration
    >>> format_duration(0.3), format_duration(600.0)
    ('a second or less', '10 min')
    """
    if seconds < 1.0:
        return "a second or less"
    if seconds < 120.0:
        return f"{seconds:.0f} s"
    if seconds < 7200.0:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"


def format_setting(value: Any, max_length: int = 50) -> str:
    """Return the value of a scene key as short text; of a duty cycle, its blocks and revolutions.

    Parameters
    ----------
    value : object
        A number, a text, or a list of them or of blocks.
    max_length : int
        Most characters of a list.

    Examples
    --------
    >>> from tractive_sam.description import format_setting
    >>> format_setting(({"name": "curve", "revolutions": 7}, {"revolutions": 3}))
    '(curve 7, duty[1] 3)'
    """
    if isinstance(value, float):
        return f"{value:.6g}"
    if not isinstance(value, tuple | list):
        return str(value)
    if value and all(isinstance(item, Mapping) and "revolutions" in item for item in value):
        names = [item.get("name") or f"duty[{k}]" for k, item in enumerate(value)]
        blocks = zip(names, value, strict=True)
        value = ", ".join(f"{name} {item['revolutions']}" for name, item in blocks)
        return printable_text(f"({value})", max_length)
    return printable_text(str(value), max_length)


def format_unit(unit: str) -> str:
    """Return a unit with raised powers ("mm²"), or "" for the unit "1".

    Examples
    --------
    >>> from tractive_sam.description import format_unit
    >>> format_unit("mm3"), format_unit("1")
    ('mm³', '')
    """
    raised = re.sub(r"(?<=[a-z])([23])(?!\d)", lambda match: "²³"[int(match[1]) - 2], unit)
    return "" if unit == "1" else raised


def format_with_unit(text: str, unit: str) -> str:
    """Return a text followed by the unit in parentheses, unless the unit is "1"."""
    return f"{text} ({format_unit(unit)})" if format_unit(unit) else text


def math_symbol(quantity: Labelled) -> str:
    """Return the symbol of a quantity, or else its name, as math text without dollar signs."""
    name = quantity.name.replace("_", r"\_")
    return quantity.symbol or rf"\mathrm{{{name}}}"


def math_label(quantity: Labelled) -> str:
    """Return the symbol and the unit of a quantity as math text, "$p$ (MPa)"."""
    return format_with_unit(f"${math_symbol(quantity)}$", quantity.unit)


def format_place(coordinate: Labelled, value: float) -> str:
    """Return a revolution or distance in the format of its column, thousands with commas."""
    return f"{value:,{coordinate.format}}"


def math_value(quantity: Labelled, value: float) -> str:
    """Return symbol, value and unit of a coordinate with math text, as in "$N$ = 1,000"."""
    unit = f" {quantity.unit}" if format_unit(quantity.unit) else ""
    return f"${math_symbol(quantity)}$ = {format_place(quantity, value)}{unit}"


def html_symbol(symbol: str) -> Html:
    """Return simple math text as HTML, or "" if it has more than letters, signs and indices."""
    # fmt: off
    names = (
        "alpha", "beta", "gamma", "delta", "varepsilon", "theta", "lambda", "mu", "xi", "sigma",
        "tau", "phi", "varphi", "omega", "Delta", "Phi", "Omega",
    )
    # fmt: on
    signs = dict(zip(names, "αβγδεθλµξστφφωΔΦΩ", strict=True))
    flat = re.sub(r"\\(?:mathrm|text)\{([^{}]*)\}", r"\1", symbol)
    flat = re.sub(r"\\([A-Za-z]+)\s*", lambda match: signs.get(match[1], match[0]), flat)
    text: str = as_html(flat.replace(r"\,", "\u2009"))
    for sign, tag in (("_", "sub"), (r"\^", "sup")):
        text = re.sub(rf"{sign}(?:\{{([^{{}}]*)\}}|(\w+|\S))", rf"<{tag}>\1\2</{tag}>", text)
    return Html("" if re.search(r"[\\{}$]", text) else text)


def text_table(heading: str, rows: Mapping[str, str] | Iterable[tuple[str, str]]) -> str:
    """Return a heading and rows of label and text as aligned lines."""
    safe = {printable_text(label): printable_text(text) for label, text in dict(rows).items()}
    width = max(map(len, safe), default=0)
    return "\n".join([heading, *(f"  {label:{width}}  {text}" for label, text in safe.items())])


def html_columns(rows: Iterable[Mapping[str, str]]) -> Html:
    """Return rows of text, by the heading of their column, as an HTML table."""
    return TextTable.from_dicts(list(rows)).to_html()


def html_table(rows: Mapping[str, str], picture: Html = Html()) -> Html:  # noqa: B008 - immutable
    """Return rows of label and text as an HTML table, next to a picture if there is one."""
    line = (
        '<tr><th style="text-align:left;vertical-align:top;padding-right:1em">$label</th>'
        '<td style="text-align:left">$text</td></tr>'
    )
    lines = (fill(line, label=label, text=printable_text(text)) for label, text in rows.items())
    table = fill("<table>$lines</table>", lines=lines)
    if not picture:
        return table
    style = "display:flex;flex-wrap:wrap;gap:1em;align-items:flex-start"
    both = '<div style="$style">$table<div>$picture</div></div>'
    return fill(both, style=style, table=table, picture=picture)
