"""Safe HTML: text is escaped unless it is `Html`."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable
from hashlib import sha256
from html import escape
from string import Template
from typing import TypeAlias

from tractive_sam.plain import plain


class Html(str):
    """HTML that may stand in a page as it is.

    Only `fill` and code that writes tags by itself make it. Joined with other text it is text
    again, and escaped.
    """

    __slots__ = ()


Content: TypeAlias = "str | Iterable[Html]"


def as_html(content: Content) -> Html:
    """Return HTML as it is, several of it in a row, and text escaped."""
    if isinstance(content, Html):
        return content
    if isinstance(content, str):
        return Html(escape(plain(content, None)))
    return Html("".join(as_html(one) for one in content))


def fill(template: str, /, **content: Content) -> Html:
    """Return a template with its names, as $name, replaced by their content.

    Parameters
    ----------
    template : str
        HTML that the package has written; no text of a file.
    **content : str or iterable of Html
        By name. What is not `Html` is text, and is escaped.

    Raises
    ------
    KeyError
        If a name has no content.

    Examples
    --------
    >>> from tractive_sam.markup import fill
    >>> fill("<p>$text</p>", text="<script>")
    '<p>&lt;script&gt;</p>'
    """
    found = {name: as_html(one) for name, one in content.items()}
    return Html(Template(template).substitute(found))


def policy(
    scripts: Iterable[str] = (), styles: Iterable[str] = (), attributes: bool = False
) -> Html:
    """Return the content security policy of a page that has these scripts and styles, and no other.

    Parameters
    ----------
    scripts, styles : iterable of str
        The content of its elements of script and of style.
    attributes : bool
        Whether style attributes are allowed.
    """
    style = [*map(_digest, styles)]
    parts = [
        "default-src 'none'",
        f"script-src {' '.join(map(_digest, scripts)) or _NONE}",
        f"style-src-elem {' '.join(style) or _NONE}",
        f"style-src-attr {_INLINE if attributes else _NONE}",
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
    """Return the hash of an element's content as a browser takes it: with one end of lines."""
    lines = content.replace("\r\n", "\n").replace("\r", "\n")
    return f"'sha256-{b64encode(sha256(lines.encode()).digest()).decode()}'"
