"""Commands ``study`` and ``table``: compute many scenes, and tables of creep forces."""

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal, cast

import typer

import tractive_sam as ts
from tractive_sam import interrupt
from tractive_sam.cli.output import (
    ExitStatus,
    Quiet,
    check_folder,
    incomplete_exit,
    invalid_exit,
    print_message,
    print_note,
    refuse,
    report_interrupt,
    report_warnings,
    show_progress,
)
from tractive_sam.cli.scene_input import Allow, complete_creep_tables


def study(
    file: Annotated[Path, typer.Argument(metavar="STUDY.toml")],
    output: Annotated[Path, typer.Option("--output", "-o", metavar="DIR")],
    scheduler: Annotated[str | None, typer.Option(metavar="ADDRESS")] = None,
    workers: Annotated[int | None, typer.Option(min=0, metavar="N")] = None,
    allow: Allow = None,
    quiet: Quiet = False,
) -> None:
    """Compute all incomplete cases of a study, long cases first.

    Parameters
    ----------
    file
        A study file (TOML).
    output
        Folder of the study; complete cases in an existing folder are not repeated.
    scheduler
        Scheduler of dask.distributed; its workers compute the cases and must have access to
        DIR.
    workers
        Number of processes on this machine, without a scheduler; with 0, this process computes
        one case after another. By default, one for each core, or 0 if starting them would take
        longer than the work.
    """
    from tractive_sam import studies
    from tractive_sam.documents import StudyDocument

    check_workers(scheduler, workers)
    if workers:
        studies.prepare_workers()  # they load modules while this process does
    cure = f"repeat the command to continue the study in {output}"
    with report_interrupt(cure), refuse(studies.SchedulerLostError, status=ExitStatus.INCOMPLETE):
        with report_warnings():
            requested = studies.Study.from_toml(file)
        with interrupt.protect_cleanup(), show_progress() as update, report_warnings():
            results = studies.study(
                requested,
                output,
                scheduler=scheduler,
                workers=workers,
                progress=lambda state: update(state.share, *_describe_progress(state)),
                say=print_note,
            )
    for note in StudyDocument(output, results).notes():
        print_note(note)
    complete = f"{results.counts['complete']} of {len(results)} cases complete"
    print_message(f"{output}: {complete}; tractive-sam study-show {output}")
    if not results.complete:
        raise incomplete_exit("not all cases are complete; repeat the command to try them again")


def check_workers(scheduler: str | None, workers: int | None) -> None:
    """End with an error if both a scheduler and a number of workers are given."""
    if scheduler is not None and workers is not None:
        cure = "start its workers by dask worker ADDRESS"
        raise invalid_exit(f"--workers: not with a scheduler; {cure}")


def _describe_progress(state: "ts.studies.StudyProgress") -> tuple[str, str]:
    """Return the text for the progress bar of a study, and the line printed without a bar."""
    count = f"{state.ended} of {state.cases}"
    failed = f", {state.failed} failed" if state.failed else ""
    if state.case is None or state.outcome is None:
        return f"{count} cases", f"{state.cases} cases, {state.ended} of them complete already"
    spent = f"{state.outcome.seconds:.3g} s on {state.outcome.worker or 'no worker'}"
    return f"{count} cases{failed}", f"{count}: {state.case} {state.outcome.status}, {spent}"


def table(
    file: Annotated[
        str,
        typer.Argument(metavar="TABLE.toml|FILE.nc|NAME", autocompletion=complete_creep_tables),
    ],
    output: Annotated[Path | None, typer.Option("--output", "-o", metavar="FILE.nc")] = None,
    header: Annotated[Path | None, typer.Option(metavar="FILE.h")] = None,
    fmu: Annotated[Path | None, typer.Option(metavar="FILE.fmu")] = None,
    fmi: Annotated[int, typer.Option(min=2, max=3)] = 2,
    text: Annotated[Path | None, typer.Option("--text", metavar="FILE.txt")] = None,
    figure: Annotated[Path | None, typer.Option(metavar="FILE.png")] = None,
    scheduler: Annotated[str | None, typer.Option(metavar="ADDRESS")] = None,
    workers: Annotated[int, typer.Option(min=0, metavar="N")] = 0,
    allow: Allow = None,
    quiet: Quiet = False,
) -> None:
    """Build a creep-force table with gradients and error bars.

    Parameters
    ----------
    file
        The design of a table (TOML), or an existing table, which may be a file or the built-in
        table steel; it is written as a header or as text or, with --output, receives error bars
        of its gradients.
    output
        The table (netCDF).
    header
        Also write the table in C: a header, and FILE.c in the folder of the header; the
        function has the name of the file.
    fmu
        Also write the table as a functional mock-up unit, compiled by cc if cc is installed.
    fmi
        Version of the Functional Mock-up Interface for --fmu.
    text
        Also write the nodes of the table as columns of text.
    figure
        Draw the errors at the check points.
    scheduler
        Scheduler of dask.distributed; its workers solve the contacts.
    workers
        Number of processes on this machine, without a scheduler; 0: this process.
    """
    writers: dict[Path | None, Callable[[Any, Path], None]] = {
        header: _write_header,
        fmu: partial(_write_fmu, fmi=cast(Literal[2, 3], fmi)),
        text: _write_text,
        figure: _write_figure,
    }
    writers.pop(None, None)
    _check_arguments(file, output, writers)
    check_workers(scheduler, workers or None)
    _check_names(header, fmu)
    built = _build(file, output, scheduler, workers) if output else ts.open_table(file)
    for path, write in writers.items():
        if path is not None:
            write(built, path)
    print_message(f"{output or file}: {built.nodes} nodes{_describe_cost_and_errors(built.about)}")


def _check_arguments(file: str, output: Path | None, writers: Mapping[Path | None, Any]) -> None:
    """End with an error if the file, the output option or the folder of an output is missing."""
    from tractive_sam.tables import builtin_tables, is_table

    exists = is_table(file)
    if not (exists or Path(file).exists()):
        names = f"built-in tables: {', '.join(builtin_tables())}"
        raise invalid_exit(f"{file} is neither a file nor a built-in table; {names}")
    if output is None and not (exists and writers):
        needed = "--output, --header, --fmu, --text or --figure" if exists else "--output FILE.nc"
        raise invalid_exit(f"{file}: {needed} is needed")
    for path in filter(None, (output, *writers)):
        check_folder(path)


def _build(file: str, output: Path, scheduler: str | None, workers: int) -> "ts.CreepTable":
    """Build a table into a file, with a progress display of its nodes, and return it."""
    rounds: list[int] = []
    without_result = ConnectionError, RuntimeError  # no scheduler, or an unsolved contact
    with (
        refuse(*without_result, status=ExitStatus.INCOMPLETE),
        show_progress() as update,
        report_warnings(),
    ):

        def report(state: "ts.tables.TableProgress") -> None:
            nodes = f"{state.nodes} nodes"
            update(state.done / state.nodes, nodes, "" if state.round in rounds else nodes)
            rounds.append(state.round)

        return ts.build_table(
            file, output, report, scheduler=scheduler, workers=workers, say=print_note
        )


def _describe_cost_and_errors(about: Mapping[str, Any]) -> str:
    """Return the contacts, CPU time and errors of a table as text, as far as its file has them."""
    cost = {"contacts": "{} contacts", "cpu_seconds": "{:.3g} s of one core"}
    parts = [form.format(about[name]) for name, form in cost.items() if name in about]
    text = ", ".join(["", *parts])
    if "held_out" not in about:
        return text
    return text + (
        f"; the error at {about['held_out']} check points is {about['held_out_median']:.1e} of "
        f"mu P in the median, {about['held_out_worst']:.1e} at most, and at "
        f"{about['held_out_inside']:.0%} of them within the reported error"
    )


def _check_names(header: Path | None, fmu: Path | None) -> None:
    """End with an error if a file name is no C name, a header no .h, or fmpy is missing."""
    from tractive_sam.extras import check_extra
    from tractive_sam.lookup import check_name

    for path in filter(None, (header, fmu)):
        with refuse(ValueError):
            check_name(path.stem)
    if header is not None and header.suffix != ".h":
        raise invalid_exit(f"{header}: a file ending in .h is needed, which FILE.c includes")
    if fmu is not None:
        check_extra("fmpy", "--fmu")


def _write_header(built: "ts.CreepTable", path: Path) -> None:
    """Write a creep-force table as C code: a header and, next to it, a source file."""
    from tractive_sam.lookup import c_sources
    from tractive_sam.output_file import write_file

    header, source = c_sources(built, path.stem).values()
    write_file(path.with_suffix(".c"), source)
    write_file(path, header)


def _write_fmu(built: "ts.CreepTable", path: Path, fmi: Literal[2, 3]) -> None:
    """Write a creep-force table as a functional mock-up unit; note if it was not compiled."""
    try:
        if not ts.write_fmu(built, path, fmi):
            cure = "fmpy compile adds the binary on a machine with a compiler"
            print_note(f"{path} contains only sources, as cc is not installed; {cure}")
    except RuntimeError as error:
        raise incomplete_exit(str(error)) from None


def _write_text(built: "ts.CreepTable", path: Path) -> None:
    """Write the nodes of a creep-force table as columns of text."""
    from tractive_sam.lookup import columns_of
    from tractive_sam.output_file import write_file

    write_file(path, columns_of(built))


def _write_figure(built: "ts.CreepTable", path: Path) -> None:
    """Write the figure of the errors of a creep-force table at its check points."""
    from tractive_sam.plot import DPI, table_errors

    try:
        table_errors(built).savefig(path, dpi=DPI)
    except ValueError as error:
        raise invalid_exit(f"{path}: {error}") from None
