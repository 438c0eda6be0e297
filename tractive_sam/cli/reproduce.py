"""``tractive-sam reproduce``: the paper's figures and tables, and a page about them."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from tractive_sam.cli.output import (
    Status,
    bad_input_told,
    progress_bar,
    say,
    stop,
    tell,
    warnings_told,
)
from tractive_sam.cli.plot import Format


def reproduce(
    output: Annotated[
        Path,
        typer.Option(
            "--output",
            "-o",
            metavar="DIR",
            help="Folder of the page, the figures and the results files; those of an earlier run "
            "are replaced.",
        ),
    ] = Path("paper"),
    reduced: Annotated[
        bool,
        typer.Option(
            "--reduced",
            help="Coarse meshes and few revolutions, to see that it works; the page says so.",
        ),
    ] = False,
    format: Annotated[Format, typer.Option(help="Format of the figures.")] = Format.PNG,
) -> None:
    """Reproduce every figure and table of the paper, with its statements beside our numbers."""
    from tractive_sam import paper
    from tractive_sam.results import NotConverged

    size = paper.REDUCED if reduced else paper.FULL
    with bad_input_told():
        try:
            with _progress(len(paper.CHAPTERS)) as advance, warnings_told():
                page = paper.reproduce(output, size=size, format=format, tell=advance)
        except KeyboardInterrupt:
            told = "interrupted; the page was not written"
            raise stop(Status.INCOMPLETE, told) from None
        except NotConverged as error:
            raise stop(Status.INCOMPLETE, f"not a solution: {error}") from None
        except RuntimeError as error:
            raise stop(Status.INCOMPLETE, str(error)) from None
    say(f"{page} needs no network and no other file: open it in any browser, or print it")
    tell(page)


@contextmanager
def _progress(chapters: int) -> Iterator[Callable[[int, str], None]]:
    """Show what is being done, on a terminal."""
    with progress_bar() as bar:
        if bar is None:
            yield lambda done, line: None
            return
        task = bar.add_task("", total=chapters)
        yield lambda done, line: bar.update(task, completed=done, description=line)
