"""``tractive-sam table``: creep forces for vehicle, gear and bearing models."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tractive_sam.cli.output import (
    Quiet,
    Status,
    bad_input_told,
    note,
    progress_bar,
    say,
    stop,
    warnings_told,
)

if TYPE_CHECKING:
    from tractive_sam.tables import Progress


def table(
    file: Annotated[
        str,
        typer.Argument(
            metavar="TABLE.toml|FILE.nc|NAME",
            help="A file (TOML) that describes the table; or a table, a file or the built-in "
            "steel, to write it as a header or as text, or with --output to add error bars of "
            "gradients.",
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE.nc", help="The table (netCDF)."),
    ] = None,
    header: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.h", help="Write it as a C header too; its function has the file's name."
        ),
    ] = None,
    fmu: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.fmu",
            help="Write it as a unit of FMI 2.0 too, compiled by cc where there is one.",
        ),
    ] = None,
    text: Annotated[
        Path | None,
        typer.Option(metavar="FILE.txt", help="Write its nodes as columns of text too."),
    ] = None,
    figure: Annotated[
        Path | None,
        typer.Option(metavar="FILE.png", help="Draw the errors of the points held out."),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS", help="Scheduler of dask.distributed whose workers solve contacts."
        ),
    ] = None,
    workers: Annotated[
        int,
        typer.Option(
            min=0, metavar="N", help="Without a scheduler: processes on this machine; 0: this one."
        ),
    ] = 0,
    quiet: Quiet = False,
) -> None:
    """Make a table of creep forces with gradients and error bars."""
    from tractive_sam.studies import SchedulerLostError
    from tractive_sam.tables import build_table, builtin_tables, is_table, open_table

    made = is_table(file)
    if not (made or Path(file).exists()):
        named = ", ".join(builtin_tables())
        raise stop(Status.INVALID, f"{file}: no such file, and no built-in table; one of {named}")
    writes: tuple[tuple[Path | None, Callable[[Any, Path], None]], ...] = (
        (header, _header), (fmu, _fmu), (text, _text), (figure, _figure),
    )  # fmt: skip
    if output is None and not (made and any(path for path, _ in writes)):
        needed = "--output, --header, --fmu, --text or --figure" if made else "--output FILE.nc"
        raise stop(Status.INVALID, f"{file}: {needed} is needed")
    if scheduler is not None and workers:
        refusal = "--workers: a scheduler has its own, start them by dask worker ADDRESS"
        raise stop(Status.INVALID, refusal)
    for path in (output, *(path for path, _ in writes)):
        _check_folder(path)
    _check_code(header, fmu)
    with bad_input_told():
        if made and output is None:
            found = open_table(file)
        else:
            try:
                with _progress() as progress, warnings_told():
                    found = build_table(
                        file, output, progress, scheduler=scheduler, workers=workers,
                        say=note,
                    )  # fmt: skip
            except SchedulerLostError as error:
                raise stop(Status.INCOMPLETE, str(error)) from None
            except RuntimeError as error:
                raise stop(Status.INCOMPLETE, str(error)) from None
        for path, write in writes:
            if path is not None:
                write(found, path)
    say(f"{output or file}: {found.nodes} nodes{_errors(found.about)}")


def _errors(about: Mapping[str, Any]) -> str:
    """Describe the cost of a table and its errors, as far as its file states them."""
    cost = {"contacts": "{} contacts", "cpu_seconds": "{:.3g} s of one core"}
    told = [form.format(about[name]) for name, form in cost.items() if name in about]
    found = ", ".join(["", *told])
    if "held_out" not in about:
        return found
    return found + (
        f"; {about['held_out']} points held out are off by {about['held_out_median']:.1e} of mu P "
        f"in the median, {about['held_out_worst']:.1e} at most, {about['held_out_inside']:.0%} "
        "within what the table tells"
    )


def _check_folder(file: Path | None) -> None:
    if file is not None and not file.absolute().parent.is_dir():
        raise stop(Status.INVALID, f"{file}: there is no folder {file.parent}; make it first")


def _check_code(header: Path | None, fmu: Path | None) -> None:
    """Refuse what could not be written, before anything is computed."""
    from tractive_sam.extras import check_extra
    from tractive_sam.lookup import check_name

    try:
        for path in filter(None, (header, fmu)):
            check_name(path.stem)
    except ValueError as error:
        raise stop(Status.INVALID, str(error)) from None
    if fmu is not None:
        with bad_input_told():
            check_extra("fmpy", "--fmu")


def _header(found, path: Path) -> None:
    from tractive_sam.lookup import c_header
    from tractive_sam.output_file import write_file

    write_file(path, c_header(found, path.stem))


def _fmu(found, path: Path) -> None:
    from tractive_sam.tables import write_fmu

    try:
        if not write_fmu(found, path):
            cure = "fmpy compile adds what a machine with one needs"
            note(f"{path} has sources alone, there is no cc; {cure}")
    except RuntimeError as error:
        raise stop(Status.INCOMPLETE, str(error)) from None


def _text(found, path: Path) -> None:
    from tractive_sam.lookup import columns_of
    from tractive_sam.output_file import write_file

    write_file(path, columns_of(found))


def _figure(found, path: Path) -> None:
    from tractive_sam.plot import DPI, table_errors

    try:
        table_errors(found).savefig(path, dpi=DPI)
    except ValueError as error:
        raise stop(Status.INVALID, f"{path}: {error}") from None


@contextmanager
def _progress() -> Iterator[Callable[["Progress"], None] | None]:
    """Show how far the table is, on a terminal; elsewhere, a line whenever nodes are added."""
    with progress_bar() as bar:
        told = [-1]
        task = None if bar is None else bar.add_task("starting", total=1.0)

        def tell(now: "Progress") -> None:
            if bar is not None and task is not None:
                about = f"{now.nodes} nodes"
                bar.update(task, completed=now.done, total=now.nodes, description=about)
            elif now.round != told[0]:
                told[0] = now.round
                say(f"{now.nodes} nodes")

        yield tell
