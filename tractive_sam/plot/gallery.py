"""All figures of a history, as files."""

import warnings
from collections.abc import Iterable
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path

from tractive_sam import interrupt
from tractive_sam.output_file import make_folder
from tractive_sam.plot.conditions import touching_records
from tractive_sam.plot.drawn import Drawn
from tractive_sam.plot.registry import OF_CONTACTS, OF_HISTORIES, Drawing, register_own
from tractive_sam.plot.scale import units as drawn_in
from tractive_sam.results import History

FORMATS = ("png", "pdf", "svg")

DPI = 200
"""Dots per inch of figures that are written."""

GROUP = "tractive_sam.figures"
"""Entry points of installed packages: modules that register figures when they are imported."""


def save_all(
    history: History,
    directory: str | Path,
    format: str = "png",
    *,
    units: str = "hertz",
    dpi: float | None = None,
    blocks: Iterable[int | str] = (),
) -> list[Path]:
    """Draw every figure that a history has something to show in.

    Figures of one state are drawn for the first and the last stored revolution at which the bodies
    touch, which their names then end in.

    Parameters
    ----------
    history : History
        What to draw.
    directory : path-like
        Where to; made if it does not exist.
    format : str
        One of `FORMATS`.
    units : str
        "hertz", over the half widths and the pressure of Hertz; or "si-mm", in mm and MPa.
    dpi : float, optional
        Dots per inch of PNG; by default 200.
    blocks : iterable of int or str
        Blocks of a duty cycle to draw as well, by place or name: into folders block-0, ... of their
        places, but for the figures that are the same of all blocks.

    Raises
    ------
    LookupError
        If there is no such block.

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
    make_folder(directory)
    paths = []
    with drawn_in(units):
        drawings = {one.name: one for one in figures_of(history)}
        for k, block in chosen.items():
            own = (one for one in figures_of(block) if one.name not in drawings)
            drawings |= {f"block-{k}/{one.name}": one for one in own}
        for name, drawing in drawings.items():
            interrupt.heed()
            paths.append(directory / f"{name}.{format}")
            make_folder(paths[-1].parent)
            drawing.draw().savefig(paths[-1], dpi=dpi or DPI)
    return paths


def figures_of(history: History) -> list[Drawing]:
    """List the figures that a history has, with captions, without drawing them.

    Those of one contact come first, of the first and the last stored record in which the bodies
    touch.

    Examples
    --------
    >>> [drawing.name for drawing in plot.figures_of(history) if "wear" in drawing.name]
    ['wear-2', 'wear-depth', 'wear-over-revolutions', 'wear-profiles']
    """
    register_own()
    _register_installed()
    found = []
    for at in touching_records(history):
        state = Drawn.of(history, at)
        ending = f"-{at:{history.coordinate.format}}" if len(history) > 1 else ""
        found += [
            one for name in sorted(OF_CONTACTS) for one in OF_CONTACTS[name].drawings(state, ending)
        ]
    return found + [
        one for name in sorted(OF_HISTORIES) for one in OF_HISTORIES[name].drawings(history)
    ]


@cache
def _register_installed() -> None:
    """Import the modules of installed packages that register figures."""
    for point in entry_points(group=GROUP):
        try:
            point.load()
        except Exception as error:
            warnings.warn(f"the figures of {point.value} are left out: {error}", stacklevel=2)
