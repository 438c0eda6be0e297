"""Text from files and names, made safe to print."""

from __future__ import annotations

import re
from collections.abc import Mapping
from html import escape

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


def text_table(head: str, rows: Mapping[str, str]) -> str:
    """A heading and lines of (what, told)."""
    width = max(map(len, rows), default=0)
    return "\n".join([head, *(f"  {what:{width}}  {plain(told)}" for what, told in rows.items())])


def html_table(rows: Mapping[str, str], picture: str = "") -> str:
    """Lines of (what, told) as a table of HTML, beside a picture."""
    lines = "".join(
        f'<tr><th style="text-align:left;vertical-align:top;padding-right:1em">{escape(what)}</th>'
        f'<td style="text-align:left">{escape(plain(told))}</td></tr>'
        for what, told in rows.items()
    )
    table = f"<table>{lines}</table>"
    if not picture:
        return table
    style = "display:flex;flex-wrap:wrap;gap:1em;align-items:flex-start"
    return f'<div style="{style}">{table}<div>{picture}</div></div>'
