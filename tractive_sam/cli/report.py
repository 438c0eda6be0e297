"""``tractive-sam report``: write a results file as one interactive page."""

from pathlib import Path
from typing import Annotated

import typer

from tractive_sam.cli.fit import write_fit_report
from tractive_sam.cli.output import invalid_exit, print_line, print_note, refuse, report_warnings
from tractive_sam.cli.plot import Measured
from tractive_sam.cli.show import Results


def report(
    file: Results,
    output: Annotated[Path | None, typer.Option("--output", "-o", metavar="FILE.html")] = None,
    measured: Measured = None,
) -> None:
    """Write a results file as one interactive page, which needs no other file and no network.

    Parameters
    ----------
    output
        The page; an existing page is replaced. By default, FILE.html in the working folder.
    """
    if write_fit_report(file, output, measured is not None):
        return
    from tractive_sam import pages
    from tractive_sam.plot import Measurements
    from tractive_sam.store import open_history

    history = open_history(file)
    if not len(history):
        raise invalid_exit(f"{file} has no record to show; resume its run")
    path = output or Path(f"{file.stem}.html")
    with refuse(ValueError), report_warnings():
        points = None if measured is None else Measurements.from_file(measured)
        pages.report(history, path, points)
    if not history.finished:
        print_note(f"{file} is {history.status}: {history.message}")
    print_line(path)
