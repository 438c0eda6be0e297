"""All figures of a history, as files."""

import warnings
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from tractive_sam import interrupt
from tractive_sam.output_file import make_folder
from tractive_sam.plot.contact_view import ContactView
from tractive_sam.plot.figure import Figure, omit_failing_figure
from tractive_sam.plot.measured import Measurements
from tractive_sam.plot.needs import touching_records
from tractive_sam.plot.options import change_options
from tractive_sam.plot.registry import (
    CONTACT_FIGURES,
    HISTORY_FIGURES,
    Drawing,
    register_package_figures,
)
from tractive_sam.results import History
from tractive_sam.schema import installed_entry_points

FORMATS = ("png", "pdf", "svg")

DPI = 200
"""Dots per inch of figures that are written."""


def save_all(
    history: History,
    directory: str | Path,
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
    directory = Path(directory)
    chosen = {history.place_of(block): history.block(block) for block in blocks}
    if measured is not None:
        measured.check(history)
    paths = []
    with change_options(units=units, titles=titles, measured=measured):
        make_folder(directory)
        drawings = {drawing.name: drawing for drawing in list_figures(history)}
        for k, block in chosen.items():
            extra = [drawing for drawing in list_figures(block) if drawing.name not in drawings]
            drawings |= {f"block-{k}/{drawing.name}": drawing for drawing in extra}
        for name, drawing in drawings.items():
            interrupt.raise_if_interrupted()
            path = directory / f"{name}.{format}"
            make_folder(path.parent)
            with omit_failing_figure(name):
                _draw_in_width(drawing, width).savefig(path, dpi=dpi or DPI)
                paths.append(path)
    return paths


def _draw_in_width(drawing: Drawing, width: float | None) -> Figure:
    """Return a drawn figure, in a width in mm if one is given.

    Fonts have a smallest size, so the width of a figure is not in proportion to its scale.
    """
    figure, scale = drawing.draw(), 1.0
    if width is not None:
        while abs((change := width / 25.4 / figure.get_figwidth()) - 1.0) > 2e-3 and scale > 0.05:
            scale *= change
            with change_options(scale=scale):
                figure = drawing.draw()
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
