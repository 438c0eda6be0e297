"""``tractive-sam study``: compute many scenes on many cores and machines."""

from pathlib import Path
from typing import Annotated

import typer

import tractive_sam as ts
from tractive_sam import interrupt
from tractive_sam.cli.output import (
    ExitStatus,
    Quiet,
    incomplete_exit,
    invalid_exit,
    print_message,
    print_note,
    refuse,
    report_interrupt,
    report_warnings,
    show_progress,
)
from tractive_sam.cli.scene_input import Allow


def study(
    file: Annotated[Path, typer.Argument(metavar="STUDY.toml")],
    output: Annotated[Path, typer.Option("--output", "-o", metavar="DIR")],
    scheduler: Annotated[str | None, typer.Option(metavar="ADDRESS")] = None,
    workers: Annotated[int | None, typer.Option(min=0, metavar="N")] = None,
    encrypted: Annotated[bool | None, typer.Option("--encrypted/--unencrypted")] = None,
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
    encrypted
        Whether the processes on this machine use TLS, so that other users of the machine cannot
        run programs through them; by default, they do.
    """
    from tractive_sam import studies
    from tractive_sam.cli.show import print_failures, report_versions

    check_workers(scheduler, workers)
    if scheduler is not None and encrypted:
        raise invalid_exit(f"--encrypted: {studies.SCHEDULER_ENCRYPTS}")
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
                encrypted=encrypted,
                progress=lambda state: update(state.share, *_describe_progress(state)),
                say=print_note,
            )
    print_failures(results)
    report_versions(results)
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
