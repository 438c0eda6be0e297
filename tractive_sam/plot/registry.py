"""Registered figures: the needs of each one, the figures that a history has, and all as files.

A figure is registered by its decorator, `history_figure` or `contact_figure`. Whether it applies
depends on the columns, fields, stresses and elements of a history. `save_all`, ``tractive-sam
plot`` and the report draw what `list_figures` lists.
"""

import inspect
import re
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial, wraps
from importlib import import_module
from os import PathLike
from pathlib import Path
from pkgutil import iter_modules
from typing import Any, ParamSpec

import numpy as np

from tractive_sam import interrupt
from tractive_sam.output_file import make_folder, omit_failing_figure
from tractive_sam.plot.contact_map import (
    SINGLE_ROW,
    ContactView,
    Need,
    Source,
    refuse,
    touching_records,
)
from tractive_sam.plot.figure import Figure, Measurements, apply_style, change_options
from tractive_sam.results import COORDINATE, PREFIX, History
from tractive_sam.schema import installed_entry_points

Arguments = ParamSpec("Arguments")


@dataclass(frozen=True)
class FigureEntry:
    """Registered figure: name, function, and what it needs.

    Attributes
    ----------
    name : str
        Name of its file. ``{coordinate}`` in it stands for the coordinate of the history, another
        role for the column of this role, and other names in braces for arguments of `each`.
    function : callable
        The registered function; the first sentence of its docstring is the caption.
    draw : callable
        Draws a history or a `ContactView` in the style of the package.
    columns : sequence of str
        Names or roles of columns that are needed, each with a finite number. If they differ
        between the blocks of a duty cycle, each block has the figure.
    cure : str
        Keys to add to a scene so that its history has these columns.
    needs : sequence of Need
        Other conditions.
    shown : callable
        Whether a history to which it applies has it among its figures: not if it is empty.
    each : callable
        Arguments of each of several figures, for example ``{"body": "A"}``.

    Raises
    ------
    ValueError
        If the name cannot be the name of a file, or the function has no docstring.
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
            raise ValueError(f"the figure {self.name} has no caption: add a docstring")

    @property
    def caption(self) -> str:
        """Caption of the figure: the first sentence of its docstring."""
        summary = " ".join((inspect.getdoc(self.function) or "").partition("\n\n")[0].split())
        return re.split(r"(?<=\.)\s", summary)[0]

    @property
    def origin(self) -> str:
        """Module and name of the function that draws the figure."""
        return f"{self.function.__module__}.{self.function.__qualname__}"

    def check(self, subject: ContactView | History) -> None:
        """Raise a ValueError if a history or contact lacks something that the figure needs."""
        if missing := self._missing(subject):
            refuse(self.function.__name__, missing)

    def drawings(self, subject: ContactView | History, ending: str = "") -> "Iterator[Drawing]":
        """Yield the drawings of the figure for a history or contact; none if it does not apply."""
        found = [column for name in self.columns for column in _find_columns(subject, name)]
        differs_by_block = any(PREFIX + column in subject.columns for column in found)
        if self._missing(subject) or differs_by_block or not self.shown(subject):
            return
        roles = {column.role: column.name for column in subject.columns.values() if column.role}
        coordinate = subject.coordinate
        plural = "es" if coordinate.name.endswith("ch") else "s"
        roles[COORDINATE] = coordinate.name + plural * coordinate.whole
        for arguments in self.each(subject):
            name = self.name.format_map(roles | dict(arguments)) + ending
            name = re.sub(r"[_/\\ ]", "-", name).replace("=", "")
            draw = partial(self.draw, subject, **arguments)
            yield Drawing(name, self.caption, draw, self.name)

    def _missing(self, subject: ContactView | History) -> list[str]:
        """Return what the figure needs and the history or contact lacks."""
        cure = f" (add {self.cure} to the scene)" if self.cure else ""
        history = subject.history if isinstance(subject, ContactView) else subject
        missing = [
            f"the column {name}{cure}"
            for name in self.columns
            if history is None
            or not any(np.isfinite(history[k]).any() for k in _find_columns(subject, name))
        ]
        return missing or [need.text for need in self.needs if not need.holds(subject)]


def _find_columns(subject: ContactView | History, name: str) -> list[str]:
    """Return the names of the columns with this name or role."""
    columns = subject.columns.values()
    return [column.name for column in columns if name in (column.name, column.role)]


@dataclass(frozen=True)
class Drawing:
    """Figure with its arguments and caption, before it is drawn.

    Attributes
    ----------
    name : str
        Name of its file, without ending.
    caption : str
        Caption of the figure in one sentence.
    draw : callable
        Returns the figure.
    registered : str
        Name of a registered figure of histories or contacts; else empty.

    Examples
    --------
    >>> drawing = plot.list_figures(history)[0]
    >>> drawing.name, drawing.caption
    ('pressure-0', 'Map of the contact pressure p_n.')
    """

    name: str
    caption: str
    draw: Callable[[], Figure]
    registered: str = ""


HISTORY_FIGURES: dict[str, FigureEntry] = {}
CONTACT_FIGURES: dict[str, FigureEntry] = {}
"""Figures of a history, and of one contact, by their names."""


def history_figure(
    name: str, *, line: Callable[..., Figure] | None = None, **settings: Any
) -> Callable[[Callable[Arguments, Figure]], Callable[Arguments, Figure]]:
    """Return a decorator that registers a function as a figure of histories.

    The first sentence of its docstring is the caption. The returned function draws in the style of
    the package, and raises ValueError if the figure does not apply.

    Parameters
    ----------
    name : str
        Name of its file. ``{coordinate}`` in it stands for the coordinate of the history, another
        role for the column of this role, and other names in braces for arguments of `each`.
    line : callable, optional
        Function that draws line contacts, which have a single row of elements.
    **settings
        ``columns``, ``cure``, ``needs``, ``shown`` and ``each`` of `FigureEntry`.

    Raises
    ------
    ValueError
        If another figure has the name, it cannot be the name of a file, or a docstring is missing.

    Examples
    --------
    >>> @plot.history_figure("p-mean", columns=["p_mean"])
    ... def p_mean(history):
    ...     '''Mean contact pressure, over the course.'''
    ...     figure = plot.Figure()
    ...     figure.add_subplot().plot(history["revolution"], history["p_mean"])
    ...     return figure
    >>> p_mean(history)
    Traceback (most recent call last):
    ...
    ValueError: the figure p_mean cannot be drawn: it needs the column p_mean
    """

    def register(function: Callable[Arguments, Figure]) -> Callable[Arguments, Figure]:
        entry = _add(HISTORY_FIGURES, name, function, line, settings)

        @wraps(function)
        def checked(*args: Arguments.args, **options: Arguments.kwargs) -> Figure:
            subjects: tuple[Any, ...] = (*args, *options.values())
            entry.check(subjects[0])
            return entry.draw(*args, **options)

        return checked

    return register


def contact_figure(
    name: str, *, line: Callable[[ContactView], Figure] | None = None, **settings: Any
) -> Callable[[Callable[..., Figure]], Callable[..., Figure]]:
    """Return a decorator that registers a function as a figure of one contact.

    A history has the figure for its first and its last stored contact. The returned function has
    the parameters of `ContactView.from_source`: a contact, or a history and one of its records.

    Parameters
    ----------
    name, line, **settings
        As for `history_figure`, for a `ContactView`.

    Raises
    ------
    ValueError
        As `history_figure`.

    Examples
    --------
    >>> varies = plot.Need(lambda view: view.contact.friction_varies, "friction that varies")
    >>> @plot.contact_figure("friction-behind", needs=[varies])
    ... def friction_behind(view):
    ...     '''Traction bound in the row behind the contact.'''
    ...     figure = plot.Figure()
    ...     figure.add_subplot().plot(view.y, view.contact.bound[0])
    ...     return figure
    >>> friction_behind(contact)
    Traceback (most recent call last):
    ...
    ValueError: the figure friction_behind cannot be drawn: it needs friction that varies
    """

    def register(function: Callable[..., Figure]) -> Callable[..., Figure]:
        entry = _add(CONTACT_FIGURES, name, function, line, settings)

        @wraps(function, assigned=("__module__", "__name__", "__qualname__", "__doc__"))
        def checked(source: Source, at: float | None = None, **named: float) -> Figure:
            view = ContactView.from_source(source, at, **named)
            entry.check(view)
            return entry.draw(view)

        del checked.__wrapped__  # its parameters differ
        return checked

    return register


@cache
def register_package_figures() -> None:
    """Import the modules of this package so that their figures are registered."""
    for module in iter_modules([str(Path(__file__).parent)]):
        import_module(f"{__package__}.{module.name}")


def _add(
    entries: dict[str, FigureEntry],
    name: str,
    function: Callable[..., Figure],
    line: Callable[..., Figure] | None,
    settings: Mapping[str, Any],
) -> FigureEntry:
    """Register a function as a figure and return its entry; ValueError if the name is taken."""

    def draw(subject: ContactView | History, *args: Any, **options: Any) -> Figure:
        chosen = line if line and SINGLE_ROW.holds(subject) else function
        return chosen(subject, *args, **options)

    entry = FigureEntry(name, function, apply_style(draw), **settings)
    if not entry.origin.startswith(__package__):
        register_package_figures()  # their names are reserved
    registered = entries.setdefault(name, entry)
    if registered.origin != entry.origin:
        raise ValueError(f"figure {name} of {entry.origin}: {registered.origin} has this name")
    entries[name] = entry
    return entry


FORMATS = ("png", "pdf", "svg")

DPI = 200
"""Dots per inch of figures that are written."""


def save_all(
    history: History,
    directory: str | PathLike[str],
    format: str = "png",
    *,
    units: str = "hertz",
    dpi: float | None = None,
    blocks: Iterable[int | str] = (),
    titles: bool = True,
    width: float | None = None,
    measured: Measurements | None = None,
) -> list[Path]:
    """Draw and save every figure that applies to a history; return the paths.

    Figures of one contact are drawn for the first and the last stored record in which the bodies
    touch; their names end in its revolution. A figure that cannot be drawn is omitted with a
    warning.

    Parameters
    ----------
    history : History
        History to draw.
    directory : path-like
        Folder of the figures; it is created if it does not exist.
    format : str
        One of `FORMATS`.
    units : str
        "hertz", over the half widths and the pressure of Hertz; or "si-mm", in mm and MPa.
    dpi : float, optional
        Dots per inch of PNG; by default 200.
    blocks : iterable of int or str
        Blocks of a duty cycle to draw as well, by index or name: into folders block-0, ... of their
        indices, except for figures that do not depend on the block.
    titles : bool
        Whether figures have titles.
    width : float, optional
        Width of every figure, mm, for example a column of a journal.
    measured : Measurements, optional
        Measured points, which are drawn with the columns that have their names.

    Raises
    ------
    LookupError
        If a block does not exist.
    ValueError
        If measured columns are unknown, or the units.

    Returns
    -------
    list of Path
        The files.

    Examples
    --------
    >>> flat = ts.roll(ts.Scene.builtin("cylinders"))
    >>> plot.save_all(flat, "figures", "svg")[0].name
    'pressure.svg'
    """
    chosen = {history.place_of(block): history.block(block) for block in blocks}
    if measured is not None:
        measured.check(history)
    with change_options(units=units, measured=measured):
        drawings = list_figures(history)
        shared = {drawing.name for drawing in drawings}
        for k, block in chosen.items():
            extra = (drawing for drawing in list_figures(block) if drawing.name not in shared)
            drawings += (replace(drawing, name=f"block-{k}/{drawing.name}") for drawing in extra)
        return save_drawings(drawings, directory, format, dpi=dpi, width=width, titles=titles)


def save_drawings(
    drawings: Iterable[Drawing],
    directory: str | PathLike[str],
    format: str = "png",
    *,
    dpi: float | None = None,
    width: float | None = None,
    titles: bool = True,
) -> list[Path]:
    """Draw figures and save them in a folder; return the paths.

    A figure that cannot be drawn is omitted with a warning.

    Parameters
    ----------
    drawings : iterable of Drawing
        Figures; a name may contain a folder.
    directory, format, dpi, width, titles
        See `save_all`.

    Examples
    --------
    >>> drawings = plot.list_figures(history)[:1]
    >>> [path.name for path in plot.save_drawings(drawings, "first")]
    ['pressure-0.png']
    """
    paths = []
    make_folder(directory)
    for drawing in drawings:
        interrupt.raise_if_interrupted()
        path = Path(directory) / f"{drawing.name}.{format}"
        make_folder(path.parent)
        with omit_failing_figure(drawing.name), change_options(titles=titles):
            draw_in_width(drawing.draw, width).savefig(path, dpi=dpi or DPI)
            paths.append(path)
    return paths


def draw_in_width(draw: Callable[[], Figure], width: float | None) -> Figure:
    """Return the figure that a function draws, in a width in mm if one is given.

    Fonts have a smallest size, so the width of a figure is not in proportion to its scale.

    Examples
    --------
    >>> figure = plot.draw_in_width(lambda: plot.pressure(contact), 84.0)
    >>> round(25.4 * figure.get_figwidth())
    84
    """
    figure, scale = draw(), 1.0
    if width is not None:
        while abs((change := width / 25.4 / figure.get_figwidth()) - 1.0) > 2e-3 and scale > 0.05:
            scale *= change
            with change_options(scale=scale):
                figure = draw()
    return figure


def list_figures(history: History) -> list[Drawing]:
    """Return the figures that apply to a history, with captions, not yet drawn.

    The figures of one contact come first: of the first and the last stored record in which the
    bodies touch.

    Examples
    --------
    >>> [drawing.name for drawing in plot.list_figures(history) if "wear" in drawing.name]
    ['wear-2', 'wear-depth', 'wear-over-revolutions', 'wear-profiles']
    """
    register_package_figures()
    _register_installed()
    drawings: list[Drawing] = []
    for at in touching_records(history):
        view = ContactView.from_source(history, at)
        ending = f"-{at:{history.coordinate.format}}" if len(history) > 1 else ""
        for _, entry in sorted(CONTACT_FIGURES.items()):
            drawings += entry.drawings(view, ending)
    for _, entry in sorted(HISTORY_FIGURES.items()):
        drawings += entry.drawings(history)
    return drawings


@cache
def _register_installed() -> None:
    """Import the modules that installed packages name for figures; warn if one fails."""
    for point in installed_entry_points("tractive_sam.figures"):
        try:
            point.load()
        except Exception as error:
            warnings.warn(f"the figures of {point.value} are omitted: {error}", stacklevel=2)
