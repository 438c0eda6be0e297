"""``tractive-sam study``: many scenes on many cores and machines."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeAlias

import typer

from tractive_sam import interrupt
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
    from tractive_sam.studies import Progress

StudyFile: TypeAlias = Annotated[
    Path, typer.Argument(metavar="STUDY.toml", help="A study file (TOML).")
]


def study(
    file: StudyFile,
    output: Annotated[
        Path,
        typer.Option(
            "--output",
            "-o",
            metavar="DIR",
            help="Folder of the study. If it is that of an earlier run, the study goes on: what is "
            "complete is not run again.",
        ),
    ],
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Scheduler of dask.distributed whose workers compute; they must see DIR, too.",
        ),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            min=0,
            metavar="N",
            help="Without a scheduler: processes on this machine; 0 computes one case after "
            "another in this one. By default as many as cores, or 0 where the work takes no longer "
            "than their start.",
        ),
    ] = None,
    encrypted: Annotated[
        bool | None,
        typer.Option(
            "--encrypted/--unencrypted",
            help="Have the processes of this machine speak TLS, so that no other user of it can "
            "run programs through them; they do by default.",
        ),
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Compute every case of a study that is not complete, long ones first."""
    from tractive_sam import studies
    from tractive_sam.cli.study_show import failures, mixed_versions
    from tractive_sam.studies import SCHEDULER_ENCRYPTS

    if scheduler is not None and workers is not None:
        refusal = "--workers: a scheduler has its own, start them by dask worker ADDRESS"
        raise stop(Status.INVALID, refusal)
    if scheduler is not None and encrypted:
        raise stop(Status.INVALID, f"--encrypted: {SCHEDULER_ENCRYPTS}")
    with bad_input_told():
        try:
            with warnings_told():
                asked = studies.Study.from_toml(file)
            with interrupt.protect_cleanup(), _progress() as progress, warnings_told():
                results = studies.study(
                    asked,
                    output,
                    scheduler=scheduler,
                    workers=workers,
                    encrypted=encrypted,
                    progress=progress,
                    say=note,
                )
        except KeyboardInterrupt:
            held = f"{output} holds what was computed, the same command goes on from there"
            raise stop(Status.INCOMPLETE, f"interrupted; {held}") from None
        except studies.SchedulerLostError as error:
            raise stop(Status.INCOMPLETE, str(error)) from None
    failures(results)
    mixed_versions(results)
    complete = results.counts["complete"]
    say(f"{output}: {complete} of {len(results)} cases complete; tractive-sam study-show {output}")
    if not results.complete:
        raise stop(Status.INCOMPLETE, "not all cases are complete; the same command tries again")


@contextmanager
def _progress() -> Iterator[Callable[["Progress"], None] | None]:
    """Show how far the study is, on a terminal; elsewhere, a line for each case."""
    with progress_bar() as bar:
        if bar is None:
            yield _tell
            return
        task = bar.add_task("starting", total=1.0)

        def advance(now: "Progress") -> None:
            failed = f", {now.failed} failed" if now.failed else ""
            told = f"{now.ended} of {now.cases} cases{failed}"
            bar.update(task, completed=now.share, description=told)

        yield advance


def _tell(now: "Progress") -> None:
    if now.case is None or now.outcome is None:
        say(f"{now.cases} cases, {now.ended} of them complete already")
        return
    spent = f"{now.outcome.seconds:.3g} s on {now.outcome.worker or 'no worker'}"
    say(f"{now.ended} of {now.cases}: {now.case} {now.outcome.status}, {spent}")
