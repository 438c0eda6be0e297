"""What can be wrong with a scene, in plain words."""

from __future__ import annotations

import difflib
import inspect
import reprlib
import warnings
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import ClassVar

_SHORT = reprlib.Repr()
_SHORT.maxstring = _SHORT.maxother = 60


@dataclass(frozen=True)
class Fault:
    """One fault of a scene.

    Parameters
    ----------
    key : str
        Where it is, dotted as in TOML: ``body.A.young``.
    given : str
        What was found there, shortened.
    allowed : str
        What is allowed there, or the cure.
    """

    key: str
    given: str
    allowed: str

    def __str__(self) -> str:
        return f"{self.key}: given {self.given}; allowed: {self.allowed}"

    def under(self, table: str) -> Fault:
        """Return the same fault as seen from the table that holds this one."""
        return replace(self, key=f"{table}.{self.key}")

    def at(self, array: str, place: int) -> Fault:
        """Return the same fault, of an entry under `array`, at a place in an array of tables."""
        return replace(self, key=self.key.replace(array, f"{array}[{place}]", 1))


MOST_TOLD = 20
"""Faults that are told, and misspelt names whose like is sought; of others the number is."""


class SceneError(Exception):
    """A scene that cannot be modelled, with every fault that was found.

    Parameters
    ----------
    faults : iterable of Fault
        At least one; kept as the tuple `faults`.

    Examples
    --------
    >>> try:
    ...     scene.with_set(["load.normal=-1"])
    ... except ts.SceneError as error:
    ...     print(error.faults[0].key, error.faults[0].allowed)
    load.normal a number above 0 (normal load P, N; of a line contact N/mm)
    """

    subject: ClassVar[str] = "scene"

    def __init__(self, faults: Iterable[Fault]) -> None:
        self.faults = tuple(faults)
        super().__init__(self.faults)

    def __str__(self) -> str:
        count = len(self.faults)
        head = f"1 fault in the {self.subject}"
        if count > 1:
            head = f"{count} faults in the {self.subject}"
        more = [f"and {count - MOST_TOLD} more"] if count > MOST_TOLD else []
        return "\n  ".join([f"{head}:", *map(str, self.faults[:MOST_TOLD]), *more])


class SceneWarning(UserWarning):
    """A scene that can be modelled, but hardly as it was meant.

    Examples
    --------
    >>> import warnings
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("error", ts.SceneWarning)  # to stop at doubtful scenes
    ...     scene = ts.Scene.builtin("spheres")
    """


class PlausibilityWarning(SceneWarning):
    """A scene with an entry that looks as if it was meant in another unit, or forgotten."""


def warn(text: str, category: type[SceneWarning] = SceneWarning) -> None:
    """Warn, at the line outside of this package that led here."""
    level, frame = 1, inspect.currentframe()
    while frame is not None and frame.f_globals.get("__name__", "").startswith(INSIDE):
        level, frame = level + 1, frame.f_back
    warnings.warn(text, category, stacklevel=level)


INSIDE = (f"{__name__.partition('.')[0]}.", "contextlib", "functools")
"""Modules of this package, and those whose wrappers are around its functions."""


def shown(value: object) -> str:
    """Short text of a given value."""
    try:
        return _SHORT.repr(value)
    except (ValueError, RecursionError):  # integers of thousands of digits, endless lists
        return f"an unprintable {type(value).__name__}"


RENAMED = {"traction_x": "force_x", "traction_y": "force_y"}
"""Keys by their former names."""


def suggestion(name: str, known: Iterable[str]) -> str:
    """List the known names, the one most like `name` first."""
    known = list(known)
    listed = ", ".join(known)
    if RENAMED.get(name) in known:
        return f"{RENAMED[name]}, which is its name now"
    turned = [one for one in known if sorted(one.split("_")) == sorted(name.split("_"))]
    nearest = turned or difflib.get_close_matches(name, known, n=1)
    return f"{nearest[0]}, perhaps? One of {listed}" if nearest else f"one of {listed}"
