"""``tractive-sam show``: the history in a results file."""

import csv
import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from tractive_sam.cli.output import Status, bad_input_told, console, stop, tell

Results = Annotated[Path, typer.Argument(metavar="FILE.h5", help="A results file.")]


def show(
    file: Results,
    as_json: Annotated[
        bool, typer.Option("--json", help="Every record as JSON, in place of tables.")
    ] = False,
    as_csv: Annotated[
        bool, typer.Option("--csv", help="Every record as a line of CSV, in place of tables.")
    ] = False,
) -> None:
    """Show the history in a results file, also while it is computed."""
    if as_json and as_csv:
        raise stop(Status.INVALID, "--json and --csv: give one of them")
    with bad_input_told():
        from tractive_sam.store import open_history

        history = open_history(file)
    if as_json:
        tell(json.dumps(history.to_dict(), allow_nan=False))
        return
    if as_csv:
        columns = history.numbers()
        writer = csv.writer(sys.stdout, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(zip(*(values.tolist() for values in columns.values()), strict=True))
        return
    from tractive_sam.cli import tables

    out = console()
    out.print(tables.about(history))
    if len(history) > 1:
        out.print(tables.records(history))
    if len(history):
        out.print(tables.last_record(history))
