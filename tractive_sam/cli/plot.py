"""``tractive-sam plot``: draw the figures of a results file."""

import re
from pathlib import Path
from typing import Annotated, Literal, TypeAlias

import typer

from tractive_sam.cli.fit import plot_fit
from tractive_sam.cli.output import invalid_exit, print_line, print_note, refuse, report_warnings
from tractive_sam.cli.show import Results

Format: TypeAlias = Literal["png", "pdf", "svg"]
"""Formats of figures as choices of an option, as `tractive_sam.plot.FORMATS`."""


def _parse_width(text: str) -> float:
    """Return the width in mm of a text as "84mm" or "84"; raise an error outside 30 to 1000."""
    number = re.fullmatch(r"(\d+(?:\.\d+)?)\s*(?:mm)?", text.strip())
    if number is None or not 30.0 <= float(number[1]) <= 1000.0:
        raise typer.BadParameter(f"{text!r} is not a width; use 30mm to 1000mm, as in 84mm")
    return float(number[1])


Measured = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE.csv",
        help="Draw measured points and the rms of their differences from the results. The CSV "
        "file has the column revolution (or distance) and further columns, for example "
        "Qx_over_P or 'worn_mass B'.",
    ),
]


def plot(
    file: Results,
    output: Annotated[Path | None, typer.Option("--output", "-o", metavar="DIR")] = None,
    format: Format = "png",
    units: Literal["hertz", "si-mm"] = "hertz",
    dpi: Annotated[int, typer.Option(min=20, max=1200)] = 200,
    block: Annotated[list[str] | None, typer.Option(metavar="BLOCK")] = None,
    title: Annotated[bool, typer.Option("--title/--no-title")] = True,
    width: Annotated[float | None, typer.Option(parser=_parse_width, metavar="WIDTH")] = None,
    measured: Measured = None,
    animated: Annotated[bool, typer.Option("--animate")] = False,
) -> None:
    """Draw every figure that applies to a results file.

    Parameters
    ----------
    output
        Folder of the figures; by default, FILE-figures in the working folder.
    format
        Format of the figures.
    units
        Divide by the Hertzian half-widths and pressure, or use mm and MPa.
    dpi
        Dots per inch of PNG figures.
    block
        Also draw a block of a duty cycle, by its name or its index from 0, into a separate
        folder; all: every block. May be repeated.
    title
        Draw titles.
    width
        Width of every figure, for example 84mm for a journal column.
    animated
        Also write evolution.gif, an animation of the stored revolutions.
    """
    if plot_fit(file, output, format, dpi, measured is not None):
        return
    from tractive_sam.plot import Measurements, animate, save_all
    from tractive_sam.store import open_history

    history = open_history(file)
    with refuse(LookupError):
        every = range(len(history.block_names))
        blocks = every if block == ["all"] else [*map(history.place_of, block or ())]
    with refuse(ValueError), report_warnings():
        points = None if measured is None else Measurements.from_file(measured)
        folder = output or Path(f"{file.stem}-figures")
        paths = save_all(
            history, folder, format, units=units, dpi=dpi, blocks=blocks, titles=title,
            width=width, measured=points,
        )  # fmt: skip
        if animated:
            paths.append(animate(history, folder / "evolution.gif"))
    if not paths:
        raise invalid_exit(f"{file} contains no record to draw; resume its run")
    if not history.finished:
        print_note(f"{file} is {history.status}: {history.message}")
    if history.block_names and not block:
        names = ", ".join(history.block_names)
        print_note(f"--block NAME draws a block of the duty cycle: {names}; --block all draws each")
    for path in paths:
        print_line(path)
