"""Text from files and names, safe to print."""

from __future__ import annotations

import re

_COMMANDS = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f"  # of terminals; the tab and the end of a line do no harm
    "\u202a-\u202e\u2066-\u2069"  # that turn the direction of writing
    "\ud800-\udfff]"  # bytes of file names that are no characters
)

MOST = 2000
"""Longest text of a message, characters."""


def plain(text: str, most: int | None = MOST) -> str:
    """A text without characters that command a terminal, and not too long to be read.

    Each of them becomes a question mark in a box, U+FFFD. None for `most` cuts nothing.
    """
    if most is not None and len(text) > most:
        text = f"{text[: most - 1]}…"
    return _COMMANDS.sub("\ufffd", text)


def csv_cell(value: object) -> object:
    """Return a cell of CSV that neither commands a terminal nor is a formula in a spreadsheet.

    Numbers, also as text, stay as they are. Before other text that a spreadsheet would compute
    stands an apostrophe, which spreadsheets take as the sign of text.
    """
    if not isinstance(value, str):
        return value
    text = plain(value, None)
    try:
        float(text)
    except ValueError:
        return f"'{text}" if text.lstrip(" ").startswith(("=", "+", "-", "@", "\t", "\n")) else text
    return text
