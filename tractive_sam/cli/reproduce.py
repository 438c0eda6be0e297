"""``tractive-sam reproduce``: reproduce the figures and tables of the paper, with a page."""

from pathlib import Path
from typing import Annotated

import typer

from tractive_sam.cli.output import (
    incomplete_exit,
    print_line,
    print_message,
    report_interrupt,
    report_warnings,
    show_progress,
)
from tractive_sam.cli.show import Format


def reproduce(
    output: Annotated[Path, typer.Option("--output", "-o", metavar="DIR")] = Path("paper"),
    reduced: Annotated[bool, typer.Option("--reduced")] = False,
    format: Format = "png",
) -> None:
    """Reproduce every figure and table of the paper, and compare its statements with results.

    Parameters
    ----------
    output
        Folder of the page, the figures and the results files; existing files are replaced.
    reduced
        Use coarse meshes and few revolutions, for a quick check; the page states this.
    format
        Format of the figures.
    """
    from tractive_sam import paper
    from tractive_sam.results import NotConverged

    size, chapters = paper.REDUCED if reduced else paper.FULL, len(paper.CHAPTERS)
    note = "the page was not written"
    try:
        with report_interrupt(note), show_progress() as update, report_warnings():
            page = paper.reproduce(
                output,
                size=size,
                format=format,
                progress=lambda done, text: update(done / chapters, text, ""),
            )
    except NotConverged as error:
        raise incomplete_exit(f"not a solution: {error}") from None
    except RuntimeError as error:
        raise incomplete_exit(str(error)) from None
    print_message(f"{page} needs no network and no other file: open it in any browser, or print it")
    print_line(page)
