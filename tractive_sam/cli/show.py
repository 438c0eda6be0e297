"""``tractive-sam show``: the history in a results file."""

import json
from pathlib import Path
from typing import Annotated

import typer

from tractive_sam.cli.output import bad_input_told, console, tell

Results = Annotated[Path, typer.Argument(metavar="FILE.h5", help="A results file.")]


def show(
    file: Results,
    as_json: Annotated[
        bool, typer.Option("--json", help="Every record as JSON, in place of tables.")
    ] = False,
) -> None:
    """Show the history in a results file, also while it is computed."""
    with bad_input_told():
        from tractive_sam.store import open_history

        history = open_history(file)
    if as_json:
        tell(json.dumps(history.to_dict(), allow_nan=False))
        return
    from tractive_sam.cli import tables

    out = console()
    out.print(tables.about(history))
    if len(history) > 1:
        out.print(tables.records(history))
    if len(history):
        out.print(tables.last_record(history))
