"""``tractive-sam study-show``: what a study has come to."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich import box
from rich.table import Table

from tractive_sam.cli.output import Status, bad_input_told, console, note, say, stop, tell
from tractive_sam.cli.plot import Format

if TYPE_CHECKING:
    from tractive_sam.studies import StudyResults

MOST_FAILURES = 10
"""Failures whose message is told."""


def study_show(
    directory: Annotated[Path, typer.Argument(metavar="DIR", help="The folder of a study.")],
    csv: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write the table, every quantity of it, as CSV."),
    ] = None,
    netcdf: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write every quantity over the axes, for xarray."),
    ] = None,
    figures: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Draw quantities over one or two axes into a folder."),
    ] = None,
    quantity: Annotated[
        list[str] | None,
        typer.Option(help="What to draw and to write as CSV, as Qx_over_P; may be repeated."),
    ] = None,
    units: Annotated[
        bool, typer.Option("--units", help="Units in the headings of the CSV, as Qx [N].")
    ] = False,
    at: Annotated[
        list[str] | None,
        typer.Option(metavar="KEY=VALUE", help="Hold an axis in figures where more than two vary."),
    ] = None,
    format: Annotated[Format, typer.Option(help="Format of the figures.")] = Format.PNG,
) -> None:
    """Show all cases of a study with their last records, also while it runs."""
    with bad_input_told():
        from tractive_sam.scene import parse_settings
        from tractive_sam.studies import open_study, save_figures

        results = open_study(directory)
        held = parse_settings(at or ())
        try:
            written = []
            if csv is not None:
                results.save_csv(csv, quantities=tuple(quantity or ()), units=units)
                written.append(csv)
            if netcdf is not None:
                results.save_netcdf(netcdf)
                written.append(netcdf)
            if figures is not None:
                written += save_figures(
                    results, figures, quantities=tuple(quantity or ()), at=held, format=format
                )
        except ValueError as error:
            raise stop(Status.INVALID, str(error)) from None
    if (csv, netcdf, figures) == (None, None, None):
        console().print(_table(results))
    failures(results)
    mixed_versions(results)
    if results.damage_note:
        note(results.damage_note)
    say(_standing(results))
    for path in written:
        tell(path)


def failures(results: "StudyResults") -> None:
    """Say which cases failed, and why."""
    failed = [row for row in results.rows if row.status == "failed"]
    for row in failed[:MOST_FAILURES]:
        say((f"{row.case} failed: ", "bold red"), row.message)
    if len(failed) > MOST_FAILURES:
        say(f"and {len(failed) - MOST_FAILURES} more")


def mixed_versions(results: "StudyResults") -> None:
    """Say it where cases were computed by several versions of this package."""
    if len(results.versions) > 1:
        found = ", ".join(f"{count} by {version}" for version, count in results.versions.items())
        cure = "remove the files of one (study-show --csv names them) to have them computed again"
        if results.study.keep == "scalars":
            cure = "a new folder has all of them computed by this one"
        told = f"not all cases were computed by one version: {found}; {cure}"
        note(told)


def _standing(results: "StudyResults") -> str:
    counts = [f"{count} {status}" for status, count in results.counts.items() if count]
    return f"{len(results)} cases: {', '.join(counts)}"


def _table(results: "StudyResults") -> Table:
    """The cases, one a row."""
    from tractive_sam.cli.tables import course
    from tractive_sam.description import format_setting
    from tractive_sam.results import columns

    keys = [key for one in results.study.dimensions for key in one.columns]
    scene = results.study.scene
    told, line = course(columns(scene)), scene.line
    shown = [one for one in told if one[0] != "residual" and not (line and "_y" in one[0])]
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("case", justify="right")
    for key in keys:
        table.add_column(key.replace(".", ".\n"), justify="right")
    table.add_column("status")
    for _, heading, _, _ in shown:
        table.add_column(heading, justify="right", no_wrap=True)
    for row in results.rows:
        changes = [format_setting(row.case.changes[key]) for key in keys]
        numbers = [
            format(_of_kind(row.last[name] * factor, form), form) if name in row.last else ""
            for name, _, factor, form in shown
        ]
        table.add_row(str(row.case.number), *changes, row.status, *numbers)
    return table


def _of_kind(value: float, form: str) -> float | int:
    return int(value) if form == "d" else value
