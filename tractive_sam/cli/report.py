"""``tractive-sam report``: a results file as one interactive page."""

from pathlib import Path
from typing import Annotated

import typer

from tractive_sam.cli.output import Status, bad_input_told, note, stop, tell
from tractive_sam.cli.show import Results


def report(
    file: Results,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE.html",
            help="The page, replaced if it is there; by default FILE.html in the working folder.",
        ),
    ] = None,
) -> None:
    """Write a results file as one interactive page, which needs no other file and no network."""
    with bad_input_told():
        from tractive_sam import pages
        from tractive_sam.store import open_history

        history = open_history(file)
        if not len(history):
            raise stop(Status.INVALID, f"{file} holds no record to show yet")
        path = output or Path(f"{file.stem}.html")
        pages.report(history, path)
    if not history.finished:
        note(f"{file} is {history.status}: {history.message}")
    tell(path)
