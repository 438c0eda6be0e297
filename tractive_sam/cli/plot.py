"""``tractive-sam plot``: figures of a results file."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from tractive_sam.cli.output import Status, bad_input_told, note, stop, tell
from tractive_sam.cli.show import Results


class Format(StrEnum):
    """Formats of figures, as `tractive_sam.plot.FORMATS`."""

    PNG = "png"
    PDF = "pdf"
    SVG = "svg"


class Units(StrEnum):
    """Units of figures, as `tractive_sam.plot.UNITS`."""

    HERTZ = "hertz"
    SI_MM = "si-mm"


def plot(
    file: Results,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="DIR",
            help="Folder of the figures; by default, FILE-figures in the working folder.",
        ),
    ] = None,
    format: Annotated[Format, typer.Option(help="Format of the figures.")] = Format.PNG,
    units: Annotated[
        Units,
        typer.Option(help="Over the half widths and pressure of Hertz, or in mm and MPa."),
    ] = Units.HERTZ,
    dpi: Annotated[int, typer.Option(min=20, max=1200, help="Dots per inch of PNG figures.")] = 200,
    block: Annotated[
        list[str] | None,
        typer.Option(
            metavar="BLOCK",
            help="Draw a block of a duty cycle as well, by its name, or its place from 0, into a "
            "folder of its own; all: every block. May be repeated.",
        ),
    ] = None,
    animated: Annotated[
        bool,
        typer.Option("--animate", help="Write evolution.gif as well, over the stored revolutions."),
    ] = False,
) -> None:
    """Draw every figure that a results file has something to show in."""
    with bad_input_told():
        from tractive_sam.plot import animate, save_all
        from tractive_sam.store import open_history

        history = open_history(file)
        try:
            every = range(len(history.block_names))
            blocks = every if block == ["all"] else [history.place_of(one) for one in block or ()]
        except LookupError as error:
            raise stop(Status.INVALID, str(error)) from None
        try:
            folder = output or Path(f"{file.stem}-figures")
            paths = save_all(history, folder, format, units=units, dpi=dpi, blocks=blocks)
            if animated:
                paths.append(animate(history, folder / "evolution.gif"))
        except ValueError as error:
            raise stop(Status.INVALID, str(error)) from None
    if not paths:
        raise stop(Status.INVALID, f"{file} holds no record to draw yet")
    if not history.finished:
        note(f"{file} is {history.status}: {history.message}")
    if history.block_names and not block:
        names = ", ".join(history.block_names)
        note(f"--block NAME draws a block of the duty cycle, of {names}; --block all each")
    for path in paths:
        tell(path)
