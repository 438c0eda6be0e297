"""Convert TOML text to nested tables, and nested tables to TOML text."""

import re
import tomllib
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from tractive_sam import input_file

from .faults import Fault, SceneError, shorten


def parse(text: str) -> dict[str, Any]:
    """Return the nested tables of TOML text.

    Raises
    ------
    SceneError
        If the text is not TOML, with the faulty line.
    """
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # ValueError: also numbers beyond all bounds
        raise SceneError([_syntax_fault(text, str(error))]) from None


def parse_file(path: Path, max_bytes: int = 2**26) -> dict[str, Any]:
    """Return the nested tables of a TOML file; files above `max_bytes` are refused.

    Parameters
    ----------
    path : Path
        A regular file, or the standard input.
    max_bytes : int
        Largest size in bytes: a gap of 1500 x 1500 points in the scene itself takes 45 MB.

    Raises
    ------
    SceneError
        If the file cannot be read, or is not TOML.
    """
    try:
        text = input_file.read_text(path, max_bytes)
    except UnicodeDecodeError:
        raise SceneError(
            [Fault(Fault.FILE, shorten(str(path)), "a text file in UTF-8 or UTF-16")]
        ) from None
    except (OSError, ValueError) as error:  # ValueError: a path with a null character
        reason = getattr(error, "strerror", None) or str(error)
        allowed = f"a readable file ({reason.lower()})"
        raise SceneError([Fault(Fault.FILE, shorten(str(path)), allowed)]) from None
    return parse(text)


def parse_value(text: str) -> Any:
    """Read one TOML value; any other text is returned as a string, so that words need no quotes.

    Unlike in TOML, a number may begin or end with its decimal point, for example ``[[500, .4]]``.
    """
    with_digits = re.sub(r"(?<![\w.])\.(?=\d)", "0.", text)
    with_digits = re.sub(r"(?<=\d)\.(?![\w.])", ".0", with_digits)
    for candidate in dict.fromkeys((text, with_digits)):
        with suppress(ValueError, RecursionError):
            tables = tomllib.loads(f"value = {candidate}")
            if tables.keys() == {"value"}:
                return tables["value"]
    return text


def emit(tables: Mapping[str, Any]) -> str:
    """Return nested tables as TOML text, with short lists of numbers and texts in one line."""
    text = tomli_w.dumps(_to_toml_types(tables))
    in_lines = re.compile(r'\[\n((?:    (?:[-+.\w:]+|"(?:[^"\\\n]|\\.)*"),\n)+)\]')

    def join(match: re.Match[str]) -> str:
        items = " ".join(line.removeprefix("    ") for line in match[1].split("\n"))
        items = items.rstrip(" ,")
        return f"[{items}]" if len(items) <= 80 else match[0]

    return in_lines.sub(join, text)


def _to_toml_types(value: Any) -> Any:
    """Return a value as TOML types; paths and other objects become text."""
    match value:
        case Mapping():
            return {key: _to_toml_types(item) for key, item in value.items()}
        case np.ndarray():
            return value.tolist()
        case list() | tuple():
            return [_to_toml_types(item) for item in value]
        case bool() | int() | float():
            return value
    return str(value)


def _syntax_fault(text: str, message: str) -> Fault:
    """Return a fault with the line of a syntax error in TOML text."""
    reason, line = re.sub(r" \(at .*\)$", "", message), re.search(r"\(at line (\d+)", message)
    if not line:
        return Fault(Fault.FILE, "text that is not TOML", f"TOML ({reason})")
    number, lines = int(line[1]), text.split("\n")
    content = lines[number - 1] if number <= len(lines) else ""
    hint = ""
    if re.search(r"=\s*[-+]?\d+,\d+\s*(#|$)", content):
        hint = "; a decimal point, perhaps?"
    elif re.search(r"[=,\[]\s*[-+]?(\.\d|\d+\.(?!\d))", content):
        hint = "; digits before and after the decimal point, as in 0.5 and 1.0"
    elif re.search(r"=\s*[-+]?infinity\b", content, re.IGNORECASE):
        hint = "; inf, perhaps?"
    elif re.search(r'"[^"]*\\', content):
        hint = "; in double quotes a backslash begins an escape: write / or single quotes"
    return Fault(Fault.FILE, f"line {number}, {shorten(content)}", f"TOML ({reason}){hint}")
