"""Text from files and names, safe for terminals and spreadsheets."""

import re

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
