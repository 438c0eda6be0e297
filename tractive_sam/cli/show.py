"""``tractive-sam show``: the history in a results file."""

import csv
import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from tractive_sam.cli.explain import print_sections
from tractive_sam.cli.output import Status, bad_input_told, console, stop, tell
from tractive_sam.safe_text import csv_cell

Results = Annotated[Path, typer.Argument(metavar="FILE.h5", help="A results file.")]


def show(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE.h5", help="A results file; or a table of creep forces (FILE.nc, steel)."
        ),
    ],
    as_json: Annotated[
        bool, typer.Option("--json", help="Every record as JSON, in place of tables.")
    ] = False,
    as_csv: Annotated[
        bool, typer.Option("--csv", help="Every record as a line of CSV, in place of tables.")
    ] = False,
) -> None:
    """Show the history in a results file, also while it is computed; or a table of creep forces."""
    if as_json and as_csv:
        raise stop(Status.INVALID, "--json and --csv: give one of them")
    from tractive_sam.tables import is_table

    if is_table(file):
        _show_table(file, as_json, as_csv)
        return
    with bad_input_told():
        from tractive_sam.store import open_history

        history = open_history(file)
    if as_json:
        tell(json.dumps(history.to_dict(), allow_nan=False))
        return
    if as_csv:
        columns = history.numbers()
        writer = csv.writer(sys.stdout, lineterminator="\n")
        writer.writerow(map(csv_cell, columns))
        writer.writerows(zip(*(values.tolist() for values in columns.values()), strict=True))
        return
    from tractive_sam.cli import tables

    out = console()
    out.print(tables.about(history))
    if len(history) > 1:
        out.print(tables.records(history))
    if len(history):
        out.print(tables.last_record(history))


def _show_table(file: Path, as_json: bool, as_csv: bool) -> None:
    """What a table of creep forces tells of itself."""
    from tractive_sam.tables import explain_table, open_table, table_as_dict

    if as_csv:
        cure = f"tractive-sam table {file} --text FILE.txt writes its nodes"
        raise stop(Status.INVALID, f"--csv is of results, and {file} a table of forces; {cure}")
    with bad_input_told():
        table = open_table(file)
    if as_json:
        tell(json.dumps(table_as_dict(table), allow_nan=False))
    else:
        print_sections(str(table.about.get("title", "")), explain_table(table))
