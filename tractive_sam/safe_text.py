"""Safe text for terminals, spreadsheets and HTML, where it is escaped unless it is `Html`."""

import re
from collections.abc import Iterable
from html import escape
from string import Template
from typing import TypeAlias

_COMMANDS = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f"  # controls of terminals, without tab and line feed
    "\u202a-\u202e\u2066-\u2069"  # controls of the writing direction
    "\ud800-\udfff]"  # bytes of file names that are no characters
)


def printable_text(text: str, max_length: int | None = 2000) -> str:
    """Return a text without terminal control characters, cut to `max_length` characters.

    The replacement character U+FFFD takes the place of each control character.

    Parameters
    ----------
    text : str
        Any text.
    max_length : int, optional
        Longest text of a message, characters; None: no limit.
    """
    if max_length is not None and len(text) > max_length:
        text = f"{text[: max_length - 1]}…"
    return _COMMANDS.sub("\ufffd", text)


def csv_cell(value: object) -> object:
    """Return a CSV cell without control characters, with ' before text that is a formula.

    Numbers, also as text, do not change. An apostrophe is put before a text that a spreadsheet
    would compute: spreadsheets then treat it as text.
    """
    if not isinstance(value, str):
        return value
    text = printable_text(value, None)
    try:
        float(text)
    except ValueError:
        return f"'{text}" if text.lstrip(" ").startswith(("=", "+", "-", "@", "\t", "\n")) else text
    return text


class Html(str):
    """Text that is HTML already, and is written to a page without escaping.

    Only `fill` and code that writes tags create it. HTML joined with other text is a plain `str`
    and is escaped.
    """

    __slots__ = ()


Content: TypeAlias = "str | Iterable[Html]"


def as_html(content: Content) -> Html:
    """Return text escaped as HTML, HTML unchanged, and a sequence of HTML joined."""
    if isinstance(content, Html):
        return content
    if isinstance(content, str):
        return Html(escape(printable_text(content, None)))
    return Html("".join(as_html(part) for part in content))


def fill(template: str, /, **content: Content) -> Html:
    """Return a template with each placeholder $name replaced by its content, escaped.

    Parameters
    ----------
    template : str
        HTML from the package, never text from a file.
    **content : str or iterable of Html
        Content of each placeholder. Anything that is not `Html` is text and is escaped.

    Raises
    ------
    KeyError
        If a name has no content.

    Examples
    --------
    >>> from tractive_sam.safe_text import fill
    >>> fill("<p>$text</p>", text="<script>")
    '<p>&lt;script&gt;</p>'
    """
    html = {name: as_html(part) for name, part in content.items()}
    return Html(Template(template).substitute(html))


def security_policy(
    scripts: Iterable[str] = (), styles: Iterable[str] = (), style_attributes: bool = False
) -> Html:
    """Return the CSP meta element of a page that allows only these scripts and styles.

    Parameters
    ----------
    scripts, styles : iterable of str
        Content of the script and style elements of the page.
    style_attributes : bool
        Whether style attributes are allowed.
    """
    style = [*map(_digest, styles)]
    parts = [
        "default-src 'none'",
        f"script-src {' '.join(map(_digest, scripts)) or _NONE}",
        f"style-src-elem {' '.join(style) or _NONE}",
        f"style-src-attr {_INLINE if style_attributes else _NONE}",
        "img-src data: blob:",
        "base-uri 'none'",
        "form-action 'none'",
    ]
    return fill(
        '<meta http-equiv="Content-Security-Policy" content="$policy">',
        policy=Html("; ".join(parts)),
    )


_NONE, _INLINE = "'none'", "'unsafe-inline'"


def _digest(content: str) -> str:
    """Return the hash "'sha256-...'" that a browser computes for a script or style."""
    # Only pages need them, and loading them takes longer than printing help.
    from base64 import b64encode  # noqa: PLC0415
    from hashlib import sha256  # noqa: PLC0415

    lines = content.replace("\r\n", "\n").replace("\r", "\n")
    return f"'sha256-{b64encode(sha256(lines.encode()).digest()).decode()}'"
