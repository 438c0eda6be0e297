"""``tractive-sam study-show``: show the cases of a study and their results."""

from pathlib import Path
from typing import Annotated

import typer
from rich import box
from rich.table import Table

import tractive_sam as ts
from tractive_sam.cli.output import console, print_line, print_message, print_note, refuse
from tractive_sam.cli.plot import Format


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
    from tractive_sam.scene import parse_settings
    from tractive_sam.studies import open_study, save_figures

    results, names = open_study(directory), tuple(quantity or ())
    fixed = parse_settings(at or ())
    written = []
    with refuse(ValueError):
        if csv is not None:
            results.save_csv(csv, quantities=names, units=units)
            written.append(csv)
        if netcdf is not None:
            results.save_netcdf(netcdf)
            written.append(netcdf)
        if figures is not None:
            written += save_figures(results, figures, quantities=names, at=fixed, format=format)
    if (csv, netcdf, figures) == (None, None, None):
        console().print(_case_table(results))
    print_failures(results)
    report_versions(results)
    if results.damage_note:
        print_note(results.damage_note)
    counts = [f"{count} {status}" for status, count in results.counts.items() if count]
    print_message(f"{len(results)} cases: {', '.join(counts)}")
    for path in written:
        print_line(path)


def print_failures(results: "ts.StudyResults", max_lines: int = 10) -> None:
    """Print the failed cases of a study with their messages, at most `max_lines` of them."""
    failed = [row for row in results.rows if row.status == "failed"]
    for row in failed[:max_lines]:
        print_message((f"{row.case} failed: ", "bold red"), row.message)
    if len(failed) > max_lines:
        print_message(f"and {len(failed) - max_lines} more")


def report_versions(results: "ts.StudyResults") -> None:
    """Print a note if several versions of this package computed the cases of a study."""
    if len(results.versions) > 1:
        counts = ", ".join(f"{count} by {version}" for version, count in results.versions.items())
        cure = "to compute them again, remove the files of one version (see study-show --csv)"
        if results.study.keep == "scalars":
            cure = "in a new folder this version computes all of them"
        print_note(f"several versions computed the cases: {counts}; {cure}")


def _case_table(results: "ts.StudyResults") -> Table:
    """Return a terminal table of the cases of a study: changed keys, status and results."""
    from tractive_sam.cli.tables import select_columns
    from tractive_sam.description import format_setting
    from tractive_sam.results import columns

    keys = [key for dimension in results.study.dimensions for key in dimension.columns]
    scene = results.study.scene
    shown = [
        column
        for column in select_columns(columns(scene))
        if column.name != "residual" and not (scene.line and "_y" in column.name)
    ]
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("case", justify="right")
    for key in keys:
        table.add_column(key.replace(".", ".\n"), justify="right")
    table.add_column("status")
    for column in shown:
        table.add_column(column.heading, justify="right", no_wrap=True)
    for row in results.rows:
        changes = [format_setting(row.case.changes[key]) for key in keys]
        numbers = [
            column.format_value(row.last[column.name]) if column.name in row.last else ""
            for column in shown
        ]
        table.add_row(str(row.case.number), *changes, row.status, *numbers)
    return table
