"""Commands ``show``, ``plot``, ``report``, ``study-show`` and ``export`` of results files."""

import csv
import json
import re
import sys
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

import typer

import tractive_sam as ts
from tractive_sam.cli.output import (
    console,
    incomplete_exit,
    invalid_exit,
    print_line,
    print_message,
    print_note,
    print_table,
    refuse,
    report_interrupt,
    report_warnings,
)
from tractive_sam.cli.scene_input import RESULTS, Allow, Settings, read_scene
from tractive_sam.safe_text import csv_cell

Results = Annotated[
    Path,
    typer.Argument(
        metavar="FILE",
        help="A results file, also of a running run; a fit, spread, design or creep-force table; "
        "or the folder of a study.",
    ),
]


def show(
    file: Results,
    as_json: Annotated[bool, typer.Option("--json")] = False,
    as_csv: Annotated[bool, typer.Option("--csv")] = False,
) -> None:
    """Print the results in a file.

    Parameters
    ----------
    as_json
        Print every record as JSON instead of tables.
    as_csv
        Print every record as a line of CSV instead of tables.
    """
    if as_json and as_csv:
        raise invalid_exit("--json and --csv: use one of them")
    if file.suffix == ".nc" and not file.exists():
        cure = "tractive-sam fit and tractive-sam table write result files"
        raise invalid_exit(f"{file} does not exist; {cure}")
    document = ts.open_any(file)
    with refuse(ValueError):
        if as_json:
            print_line(json.dumps(document.to_dict(), allow_nan=False))
        elif as_csv:
            columns = document.columns()
            writer = csv.writer(sys.stdout, lineterminator="\n")
            writer.writerow(map(csv_cell, columns))
            writer.writerows(map(csv_cell, row) for row in zip(*columns.values(), strict=True))
        else:
            print_document(document)


def print_document(document: "ts.Document") -> None:
    """Print the title of a document, its tables with their titles, and its notes."""
    tables = document.tables()
    if document.title:
        console().print(document.title, style="bold")
    for title, table in tables.items():
        if len(tables) > 1:
            console().print(f"\n{title}", style="bold")
        print_table(table)
    print_notes(document)


def print_notes(document: "ts.Document") -> None:
    """Print the notes of a document."""
    for note in document.notes():
        print_note(note)


Format: TypeAlias = Literal["png", "pdf", "svg"]
"""Formats of figures as choices of an option, as `tractive_sam.plot.FORMATS`."""


def _parse_width(text: str) -> float:
    """Return the width in mm of a text as "84mm" or "84"; raise an error outside 30 to 1000."""
    number = re.fullmatch(r"(\d+(?:\.\d+)?)\s*(?:mm)?", text.strip())
    if number is None or not 30.0 <= float(number[1]) <= 1000.0:
        raise typer.BadParameter(f"{text!r} is not a width; use 30mm to 1000mm, as in 84mm")
    return float(number[1])


Dpi: TypeAlias = Annotated[
    int, typer.Option(min=20, max=1200, help="Dots per inch of PNG figures.")
]
Width: TypeAlias = Annotated[
    float | None,
    typer.Option(
        parser=_parse_width,
        metavar="WIDTH",
        help="Width of every figure, for example 84mm for a journal column.",
    ),
]

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
    units: Literal["hertz", "si-mm"] | None = None,
    dpi: Dpi = 200,
    block: Annotated[list[str] | None, typer.Option(metavar="BLOCK")] = None,
    title: Annotated[bool | None, typer.Option("--title/--no-title")] = None,
    width: Width = None,
    measured: Measured = None,
    animated: Annotated[bool, typer.Option("--animate")] = False,
) -> None:
    """Draw every figure that applies to the results in a file.

    Parameters
    ----------
    output
        Folder of the figures; by default, FILE-figures in the working folder.
    format
        Format of the figures.
    units
        Divide by the Hertzian half-widths and pressure, the default, or use mm and MPa.
    block
        Also draw a block of a duty cycle, by its name or its index from 0, into a separate
        folder; all: every block. May be repeated.
    title
        Draw titles, the default.
    animated
        Also write evolution.gif, an animation of the stored revolutions.
    """
    options: dict[str, Any] = {
        "units": units, "blocks": block, "titles": title, "measured": _read_measured(measured),
        "animate": animated or None,
    }  # fmt: skip
    document = ts.open_any(file)
    with refuse(ValueError), report_warnings():
        paths = document.save_figures(
            output or Path(f"{file.stem}-figures"), format, dpi=dpi, width=width,
            **{name: option for name, option in options.items() if option is not None},
        )  # fmt: skip
    _report_incomplete(document)
    if document.block_names and not block:
        names = ", ".join(document.block_names)
        print_note(f"--block NAME draws a block of the duty cycle: {names}; --block all draws each")
    for path in paths:
        print_line(path)


def report(
    file: Results,
    output: Annotated[Path | None, typer.Option("--output", "-o", metavar="FILE.html")] = None,
    measured: Measured = None,
) -> None:
    """Write the results in a file as one page, which needs no other file and no network.

    Parameters
    ----------
    output
        The page; an existing page is replaced. By default, FILE.html in the working folder.
    """
    points = _read_measured(measured)
    document = ts.open_any(file)
    with refuse(ValueError), report_warnings():
        options = {} if points is None else {"measured": points}
        page = document.save_page(output or Path(f"{file.stem}.html"), **options)
    _report_incomplete(document)
    print_line(page)


def _read_measured(file: Path | None) -> "ts.plot.Measurements | None":
    """Read a file of measured points, if there is one; end with an error if it is not valid."""
    with refuse(ValueError):
        return None if file is None else ts.plot.Measurements.from_file(file)


def _report_incomplete(document: "ts.Document") -> None:
    """Print a note if a document is not complete."""
    if not document.is_complete:
        print_note(f"{document.path} is {document.status}: {document.message}")


def study_show(
    directory: Annotated[Path, typer.Argument(metavar="DIR")],
    csv: Annotated[Path | None, typer.Option(metavar="FILE")] = None,
    netcdf: Annotated[Path | None, typer.Option(metavar="FILE")] = None,
    figures: Annotated[Path | None, typer.Option(metavar="DIR")] = None,
    quantity: Annotated[list[str] | None, typer.Option(metavar="NAME")] = None,
    units: Annotated[bool, typer.Option("--units")] = False,
    at: Annotated[list[str] | None, typer.Option(metavar="KEY=VALUE")] = None,
    format: Format = "png",
) -> None:
    """Show all cases of a study with their last records, even while it is running.

    Parameters
    ----------
    directory
        The folder of a study.
    csv
        Write all quantities of all cases as CSV.
    netcdf
        Write all quantities as netCDF, as functions of the axes, for xarray.
    figures
        Draw quantities as functions of one or two axes, into a folder.
    quantity
        Quantity to draw and to write as CSV, for example Qx_over_P; may be repeated.
    units
        Write units into the headings of the CSV, for example Qx [N].
    at
        Fix an axis in figures, if more than two vary; may be repeated.
    format
        Format of the figures.
    """
    from tractive_sam.documents import StudyDocument
    from tractive_sam.scene import parse_settings
    from tractive_sam.studies import open_study, save_figures

    results, names = open_study(directory), tuple(quantity or ())
    fixed = parse_settings(at or ())
    written = []
    with refuse(ValueError), report_warnings():
        if csv is not None:
            results.save_csv(csv, quantities=names, units=units)
            written.append(csv)
        if netcdf is not None:
            results.save_netcdf(netcdf)
            written.append(netcdf)
        if figures is not None:
            written += save_figures(results, figures, quantities=names, at=fixed, format=format)
    document = StudyDocument(directory, results)
    if (csv, netcdf, figures) == (None, None, None):
        print_document(document)
    else:
        print_notes(document)
    print_message(document.message)
    for path in written:
        print_line(path)


def export(
    source: Annotated[str, typer.Argument(metavar="FILE.h5|SCENE")],
    settings: Settings = None,
    allow: Allow = None,
    output: Annotated[Path | None, typer.Option("--output", "-o", metavar="FILE.vtkhdf")] = None,
    revolution: Annotated[float | None, typer.Option("--revolution", "--distance")] = None,
    body: Literal["A", "B"] = "A",
    block: str | None = None,
    surface: Annotated[bool, typer.Option("--surface")] = False,
    depth: float | None = None,
    elements: int | None = None,
) -> None:
    """Write the stress in a volume of one body, or the surface, for ParaView.

    Parameters
    ----------
    source
        A results file, or a scene; the unworn contact of a scene is solved first.
    output
        File to write; an existing file is replaced. By default, named after the source and the
        body, in the working folder.
    revolution
        Stored revolution, or distance of a transient in mm; by default, the last.
    body
        Body to export.
    block
        Block of a duty cycle, by its name or its index from 0.
    surface
        Write pressure, traction, slip, wear and gap instead of stress; each stored revolution
        is a time step.
    depth
        Depth in units of the semi-axis a of the unworn contact; by default, the depth in the
        scene, or 1.5.
    elements
        Number of points along the depth; by default, the number in the scene, or 64.
    """
    from tractive_sam.run import export_surface, export_volume
    from tractive_sam.store import check_volume

    if surface and (revolution is not None or depth is not None or elements is not None):
        cure = "omit --revolution, --depth and --elements"
        message = f"--surface exports every stored revolution, without a depth; {cure}"
        raise invalid_exit(message)
    output = output or Path(f"{Path(source).stem}-{'surface' if surface else body}.vtkhdf")
    check_volume(output, overwrite=True)
    with report_interrupt(f"{output} was not written"), report_warnings():
        opened = _open_source(source, settings, revolution)
        try:
            opened = _select_block(opened, block)
            if surface:
                export_surface(opened, output, overwrite=True)
            else:
                export_volume(
                    opened, output, body=body, revolution=revolution, depth=depth,
                    elements=elements, overwrite=True,
                )  # fmt: skip
        except (LookupError, ValueError) as error:
            raise invalid_exit(f"{source}: {error}") from None
    print_line(output)


def _select_block(opened: "ts.State | ts.History", block: str | None) -> "ts.State | ts.History":
    """Return the named block of a duty cycle, else the input; LookupError if it must be named."""
    if isinstance(opened, ts.State):
        if block is not None:
            raise LookupError(
                "--block: a scene is solved without its [[duty]]; run it, and export the results"
            )
        return opened
    if block is not None:
        return opened.block(block)
    if names := opened.block_names:
        raise LookupError(f"choose a block of the duty cycle by --block: {', '.join(names)}")
    return opened


def _open_source(
    source: str, settings: list[str] | None, revolution: float | None
) -> "ts.State | ts.History":
    """Return the history in a results file, or the solved contact of a scene."""
    if Path(source).suffix in RESULTS:
        if settings:
            message = f"--set changes a scene, and {source} is a results file; omit --set"
            raise invalid_exit(message)
        history = ts.open_history(source)
        if not history.finished:
            print_note(f"{source} is {history.status}: {history.message}")
        return history
    scene = read_scene(source, settings)
    if revolution is not None:
        cure = f"compute them by tractive-sam run {source}, and export the results file"
        raise invalid_exit(f"--revolution: a scene has no revolutions yet; {cure}")
    contact = ts.solve(scene, throw=False)
    if not contact.converged:
        raise incomplete_exit(f"not a solution: {contact.message}")
    return contact
