"""``tractive-sam reproduce``: reproduce the figures and tables of the paper, with a page."""

from pathlib import Path
from typing import Annotated

import typer

from tractive_sam.cli.output import (
    ExitStatus,
    error_exit,
    print_line,
    print_message,
    report_errors,
    report_warnings,
    show_progress,
)
from tractive_sam.cli.plot import Format


def reproduce(
    output: Annotated[Path, typer.Option("--output", "-o", metavar="DIR")] = Path("paper"),
    reduced: Annotated[bool, typer.Option("--reduced")] = False,
    format: Format = Format.PNG,
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
    with report_errors():
        try:
            with show_progress() as update, report_warnings():
                page = paper.reproduce(
                    output,
                    size=size,
                    format=format,
                    progress=lambda done, text: update(done / chapters, text, ""),
                )
        except KeyboardInterrupt:
            message = "interrupted; the page was not written"
            raise error_exit(ExitStatus.INCOMPLETE, message) from None
        except NotConverged as error:
            raise error_exit(ExitStatus.INCOMPLETE, f"not a solution: {error}") from None
        except RuntimeError as error:
            raise error_exit(ExitStatus.INCOMPLETE, str(error)) from None
    print_message(f"{page} needs no network and no other file: open it in any browser, or print it")
    print_line(page)
