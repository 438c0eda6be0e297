"""The text of a scene file: TOML to nested tables and back."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from tractive_sam import input_file

from .faults import Fault, SceneError, shown

FILE = "(file)"
"""The key of faults of the file itself."""


def parse(text: str) -> dict[str, Any]:
    """Read TOML.

    Raises
    ------
    SceneError
        If the text is no TOML; with the line that is at fault.
    """
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # ValueError: also numbers beyond all bounds
        raise SceneError([_syntax_fault(text, str(error))]) from None


def parse_file(path: Path, most: int = 2**26) -> dict[str, Any]:
    """Read a TOML file, UTF-8.

    Parameters
    ----------
    path : Path
        A regular file, or the standard input.
    most : int
        Bytes that it may have: a gap of 1500 x 1500 points in the scene itself takes 45 MB.

    Raises
    ------
    SceneError
        If there is no such readable file, or if it is no TOML.
    """
    try:
        text = input_file.read_text(path, most)
    except UnicodeDecodeError:
        raise SceneError([Fault(FILE, shown(str(path)), "a text file in UTF-8")]) from None
    except (OSError, ValueError) as error:  # ValueError: a path with a null character
        reason = getattr(error, "strerror", None) or str(error)
        allowed = f"a readable file ({reason.lower()})"
        raise SceneError([Fault(FILE, shown(str(path)), allowed)]) from None
    return parse(text)


def parse_value(text: str) -> Any:
    """Read one TOML value; what is none is taken as a string, so that words need no quotes."""
    try:
        found = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    return found["value"] if found.keys() == {"value"} else text


def emit(tables: Mapping[str, Any]) -> str:
    """Write nested tables as TOML; `parse` gives them back exactly."""
    return tomli_w.dumps(_plain(tables))


def _plain(value: Any) -> Any:
    """Numbers, lists and tables; all else, such as a path or a plane, is the text of itself."""
    match value:
        case Mapping():
            return {key: _plain(item) for key, item in value.items()}
        case np.ndarray():
            return value.tolist()
        case list() | tuple():
            return [_plain(item) for item in value]
        case bool() | int() | float():
            return value
    return str(value)


def _syntax_fault(text: str, message: str) -> Fault:
    """Find the line in the parser's message, which ends in "(at line 3, column 5)"."""
    reason, line = re.sub(r" \(at .*\)$", "", message), re.search(r"\(at line (\d+)", message)
    if not line:
        return Fault(FILE, "no TOML", f"TOML ({reason})")
    number, lines = int(line[1]), text.split("\n")
    content = lines[number - 1] if number <= len(lines) else ""
    hint = next((told for form, told in _SLIPS if form.search(content)), "")
    return Fault(FILE, f"line {number}, {shown(content)}", f"TOML ({reason}){hint}")


_SLIPS = (
    (re.compile(r"=\s*[-+]?\d+,\d+\s*(#|$)"), "; a decimal point, perhaps?"),
    (re.compile(r"=\s*[-+]?infinity\b", re.IGNORECASE), "; inf, perhaps?"),
)
"""What is often written in place of a number, and the cure."""
