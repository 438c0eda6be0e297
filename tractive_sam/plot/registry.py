"""Registered figures: what each one needs, and which of them a history has.

A figure is registered where it is defined, by the decorator `history_figure` or `contact_figure`.
Whether it applies follows from what a history contains: columns, fields, stress and elements.
`save_all`, ``tractive-sam plot`` and the report draw what `figures_of` lists.
"""

import inspect
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial, wraps
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from typing import Any, ParamSpec

import numpy as np

from tractive_sam.plot.conditions import ONE_ROW, Need, refuse
from tractive_sam.plot.drawn import Drawn, Source
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.style import styled
from tractive_sam.results import COORDINATE, PREFIX, History

P = ParamSpec("P")


@dataclass(frozen=True)
class FigureEntry:
    """A registered figure.

    Attributes
    ----------
    name : str
        Name of its file; in it ``{coordinate}`` is what the history goes along, another role the
        column of this role, and other names in braces are arguments of `each`.
    function : callable
        What was registered; the first sentence of its docstring is the caption.
    draw : callable
        Draws a history or a `Drawn` in the style of the package.
    columns : sequence of str
        Names or roles of columns that are needed, each with a finite number. Where they differ
        between the blocks of a duty cycle, the figure is one of each block.
    cure : str
        What to add to a scene so that its history has these columns.
    needs : sequence of Need
        Other conditions.
    shown : callable
        Whether a history in which it applies has it among its figures: not where it is empty.
    each : callable
        Arguments of each of several figures, as ``{"body": "A"}``.

    Raises
    ------
    ValueError
        If the name is no name of a file, or the function has no docstring.
    """

    name: str
    function: Callable[..., Figure]
    draw: Callable[..., Figure]
    columns: Sequence[str] = ()
    cure: str = ""
    needs: Sequence[Need] = ()
    shown: Callable[[Any], bool] = lambda _subject: True
    each: Callable[[Any], Iterable[Mapping[str, Any]]] = lambda _subject: ({},)

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[\w{}][\w{}.-]*", self.name):
            allowed = "letters, digits, '.', '-' and '_'"
            raise ValueError(f"name of a figure: {self.name!r}; allowed: {allowed}")
        if not self.caption:
            raise ValueError(
                f"the figure {self.name} has no caption: its function needs a docstring"
            )

    @property
    def caption(self) -> str:
        """The first sentence of the docstring."""
        told = " ".join((inspect.getdoc(self.function) or "").partition("\n\n")[0].split())
        return re.split(r"(?<=\.)\s", told)[0]

    @property
    def origin(self) -> str:
        """Module and name of the function."""
        return f"{self.function.__module__}.{self.function.__qualname__}"

    def check(self, subject: Drawn | History) -> None:
        """Raise ValueError where the figure does not apply, with what it needs."""
        if missing := self._missing(subject):
            refuse(self.function.__name__, missing)

    def drawings(self, subject: Drawn | History, ending: str = "") -> "Iterator[Drawing]":
        """Figures of a history or a contact; none where they do not apply or would be empty."""
        if self._missing(subject) or self._by_block(subject) or not self.shown(subject):
            return
        words = {one.role: one.name for one in subject.columns.values() if one.role}
        words[COORDINATE] = subject.coordinate.name + "s" * subject.coordinate.whole
        for arguments in self.each(subject):
            name = self.name.format_map(words | arguments).translate(_FILE_NAME) + ending
            yield Drawing(name, self, partial(self.draw, subject, **arguments))

    def _missing(self, subject: Drawn | History) -> list[str]:
        cure = f" (add {self.cure} to the scene)" if self.cure else ""
        lacking = [
            f"the column {name}{cure}"
            for name in self.columns
            if not any(np.isfinite(subject[one]).any() for one in _columns(subject, name))
        ]
        return lacking or [need.text for need in self.needs if not need.holds(subject)]

    def _by_block(self, subject: Drawn | History) -> bool:
        """Whether the columns are those of several blocks together: each block has the figure."""
        found = (one for name in self.columns for one in _columns(subject, name))
        return any(PREFIX + one in subject.columns for one in found)


_FILE_NAME = str.maketrans({"_": "-", "=": "", "/": "-", "\\": "-"})


def _columns(subject: Drawn | History, name: str) -> list[str]:
    """Names of the columns of a name or a role."""
    return [one.name for one in subject.columns.values() if name in (one.name, one.role)]


@dataclass(frozen=True)
class Drawing:
    """A figure that a history has.

    Attributes
    ----------
    name : str
        Name of its file, without ending.
    entry : FigureEntry
        As it is registered.
    draw : callable
        Returns the figure.

    Examples
    --------
    >>> drawing = plot.figures_of(history)[0]
    >>> drawing.name, drawing.caption
    ('pressure-0', 'Map of the pressure.')
    """

    name: str
    entry: FigureEntry
    draw: Callable[[], Figure]

    @property
    def caption(self) -> str:
        """What it shows, in one sentence."""
        return self.entry.caption


OF_HISTORIES: dict[str, FigureEntry] = {}
OF_CONTACTS: dict[str, FigureEntry] = {}
"""Figures of a history, and of one contact, by their names."""


def history_figure(
    name: str, *, line: Callable[..., Figure] | None = None, **settings: Any
) -> Callable[[Callable[P, Figure]], Callable[P, Figure]]:
    """Register a function that draws a history: where it applies, it is one of its figures.

    The first sentence of its docstring is the caption. The function that is returned draws in the
    style of the package, and raises ValueError where the figure does not apply.

    Parameters
    ----------
    name : str
        Name of its file; in it ``{coordinate}`` is what the history goes along, another role the
        column of this role, and other names in braces are arguments of `each`.
    line : callable, optional
        Draws line contacts, which have a single row of elements, in its place.
    **settings
        ``columns``, ``cure``, ``needs``, ``shown`` and ``each`` of `FigureEntry`.

    Raises
    ------
    ValueError
        If the name is taken or is no name of a file, or there is no docstring.

    Examples
    --------
    >>> @plot.history_figure("p-mean", columns=["p_mean"])
    ... def p_mean(history):
    ...     '''Mean contact pressure, over the course.'''
    ...     drawn = plot.Figure()
    ...     drawn.add_subplot().plot(history["revolution"], history["p_mean"])
    ...     return drawn
    >>> p_mean(history)
    Traceback (most recent call last):
    ...
    ValueError: the figure p_mean cannot be drawn: it needs the column p_mean
    """

    def register(function: Callable[P, Figure]) -> Callable[P, Figure]:
        entry = _add(OF_HISTORIES, name, function, line, settings)

        @wraps(function)
        def checked(*args: P.args, **options: P.kwargs) -> Figure:
            entry.check(next(iter((*args, *options.values()))))
            return entry.draw(*args, **options)

        return checked

    return register


def contact_figure(
    name: str, *, line: Callable[[Drawn], Figure] | None = None, **settings: Any
) -> Callable[[Callable[..., Figure]], Callable[..., Figure]]:
    """Register a function that draws one contact, given as a `Drawn`.

    A history has the figure of its first and its last stored contact. The function that is returned
    takes what `Drawn.of` takes: a contact, or a history and one of its records.

    Parameters
    ----------
    name, line, **settings
        As for `history_figure`, of a `Drawn`.

    Raises
    ------
    ValueError
        As by `history_figure`.

    Examples
    --------
    >>> varies = plot.Need(lambda state: state.contact.friction_varies, "friction that varies")
    >>> @plot.contact_figure("friction-behind", needs=[varies])
    ... def friction_behind(state):
    ...     '''Largest traction that friction allows, in the row behind the contact.'''
    ...     drawn = plot.Figure()
    ...     drawn.add_subplot().plot(state.y, state.contact.bound[0])
    ...     return drawn
    >>> friction_behind(contact)
    Traceback (most recent call last):
    ...
    ValueError: the figure friction_behind cannot be drawn: it needs friction that varies
    """

    def register(function: Callable[..., Figure]) -> Callable[..., Figure]:
        entry = _add(OF_CONTACTS, name, function, line, settings)

        @wraps(function, assigned=("__module__", "__name__", "__qualname__", "__doc__"))
        def checked(source: Source, at: float | None = None, **named: float) -> Figure:
            state = Drawn.of(source, at, **named)
            entry.check(state)
            return entry.draw(state)

        del checked.__wrapped__  # its parameters are others
        return checked

    return register


@cache
def register_own() -> None:
    """Import the modules of this package, which register its figures."""
    for module in iter_modules([str(Path(__file__).parent)]):
        import_module(f"{__package__}.{module.name}")


def _add(
    entries: dict[str, FigureEntry],
    name: str,
    function: Callable[..., Figure],
    line: Callable[..., Figure] | None,
    settings: Mapping[str, Any],
) -> FigureEntry:
    """Add an entry; a function that is defined again replaces its own."""

    def draw(subject: Drawn | History, *args: Any, **options: Any) -> Figure:
        chosen = line if line and ONE_ROW.holds(subject) else function
        return chosen(subject, *args, **options)

    entry = FigureEntry(name, function, styled(draw), **settings)
    if not entry.origin.startswith(__package__):
        register_own()  # their names are taken
    other = entries.setdefault(name, entry)
    if other.origin != entry.origin:
        raise ValueError(f"figure {name} of {entry.origin}: {other.origin} has this name")
    entries[name] = entry
    return entry
