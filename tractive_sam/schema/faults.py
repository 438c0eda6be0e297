"""Faults of a document, and the errors and warnings that report them."""

from __future__ import annotations

import difflib
import inspect
import re
import reprlib
import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, TypeVar

Value = TypeVar("Value")


@dataclass(frozen=True)
class Fault:
    """Fault of a scene: its key, the given value, and what is allowed.

    Parameters
    ----------
    key : str
        Dotted key of the faulty entry, as in TOML: ``body.A.young``.
    given : str
        The value found there, shortened.
    allowed : str
        Allowed values, or a correction.
    """

    key: str
    given: str
    allowed: str

    FILE: ClassVar = "(file)"
    SCENE: ClassVar = "(scene)"
    """Keys of faults of a complete document."""

    def __str__(self) -> str:
        return f"{self.key}: given {self.given}; allowed: {self.allowed}"

    def under(self, table: str) -> Fault:
        """Return the fault with its key prefixed by the name of an outer table.

        A fault of a complete document becomes one of the table that names the document.
        """
        return replace(
            self, key=table if self.key in (self.FILE, self.SCENE) else f"{table}.{self.key}"
        )

    def at(self, array: str, place: int) -> Fault:
        """Return the fault with an index after the name of an array: ``duty[0]`` for ``duty``."""
        return replace(self, key=self.key.replace(array, f"{array}[{place}]", 1))


class SceneError(Exception):
    """Error that lists every fault of a scene that cannot be modelled.

    Parameters
    ----------
    faults : iterable of Fault
        At least one; stored as the tuple `faults`.

    Examples
    --------
    >>> try:
    ...     scene.with_set(["load.normal=-1"])
    ... except ts.SceneError as error:
    ...     print(error.faults[0].key, error.faults[0].allowed)
    load.normal a number above 0 (normal load P, N; in a line contact, N/mm)
    """

    subject: ClassVar[str] = "scene"
    max_listed: ClassVar[int] = 20
    """Number of faults that a message lists; it only counts the others."""

    def __init__(self, faults: Iterable[Fault]) -> None:
        self.faults = tuple(faults)
        super().__init__(self.faults)

    def __str__(self) -> str:
        count, limit = len(self.faults), self.max_listed
        head = f"{count} fault{'s' if count > 1 else ''} in the {self.subject}:"
        more = [f"and {count - limit} more"] if count > limit else []
        return "\n  ".join([head, *map(str, self.faults[:limit]), *more])


class SceneWarning(UserWarning):
    """Warning of a scene that can be modelled, but probably differs from what was meant.

    Examples
    --------
    >>> import warnings
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("error", ts.SceneWarning)  # stop at doubtful scenes
    ...     scene = ts.Scene.builtin("spheres")
    """


class PlausibilityWarning(SceneWarning):
    """Warning of a value that is probably in another unit, or missing."""


class SeveralSolutionsWarning(SceneWarning):
    """Warning of a solved contact that may have other solutions, as friction falls too fast."""


def warn(text: str, category: type[SceneWarning] = SceneWarning) -> None:
    """Issue a warning that points to the line outside of the package from which it was called."""
    # Modules of this package, and modules that wrap its functions.
    inside = (f"{__name__.partition('.')[0]}.", "contextlib", "functools")
    level, frame = 1, inspect.currentframe()
    while frame is not None and frame.f_globals.get("__name__", "").startswith(inside):
        level, frame = level + 1, frame.f_back
    warnings.warn(text, category, stacklevel=level)


def shorten(value: object, max_length: int = 60) -> str:
    """Return a value as text of at most `max_length` characters, for a message."""
    short = reprlib.Repr()
    short.maxstring = short.maxother = max_length
    try:
        return short.repr(value)
    except (ValueError, RecursionError):  # integers of thousands of digits, endless lists
        return f"an unprintable {type(value).__name__}"


def suggest_name(name: str, names: Iterable[str], meanings: Mapping[str, str] = {}) -> str:
    """Return a text with the nearest allowed name, and with a list of all names if it is short.

    Parameters
    ----------
    name : str
        A name that is not allowed.
    names : iterable of str
        Allowed names.
    meanings : mapping of str to str
        Meanings of allowed names. If no name is spelled like `name`, the nearest one is the only
        one with that word in its meaning.
    """
    names = list(names)
    listed = f"{'one of ' * (len(names) > 1)}{', '.join(names)}"
    parts = sorted(name.lower().split("_"))
    reordered = [key for key in names if sorted(key.lower().split("_")) == parts]
    nearest = reordered or difflib.get_close_matches(name, names, n=1)
    if not nearest:
        described = [key for key in names if name in re.findall(r"\w+", meanings.get(key, ""))]
        if len(described) != 1:
            return listed
        nearest = described
    # A long list would hide the suggestion.
    return f"{nearest[0]}, perhaps?" + (f" Or {listed}" if len(names) <= 8 else "")


def required(value: Value | None, key: str) -> Value:
    """Return a value unchanged; raise a SceneError that names its key if it is None.

    Parameters
    ----------
    value : object or None
        The part, for example a table.
    key : str
        Dotted key of the part.

    Raises
    ------
    SceneError
        If the scene does not have it.
    """
    if value is None:
        raise SceneError([Fault(key, "nothing", "a value; it is needed here")])
    return value
