"""Runs a study: hands out what is not complete, and keeps what comes back."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from time import sleep

from tractive_sam import interrupt
from tractive_sam.operators import cores
from tractive_sam.run import InTurn
from tractive_sam.store import ResultsError, open_history
from tractive_sam.studies import cluster
from tractive_sam.studies.case import Case, cases
from tractive_sam.studies.chain import in_turn
from tractive_sam.studies.cost import check_memory, estimates
from tractive_sam.studies.design import Study
from tractive_sam.studies.folder import Folder
from tractive_sam.studies.results import StudyResults, open_study
from tractive_sam.studies.task import COMPLETE, HELD, Outcome, Task
from tractive_sam.studies.worker import run_case, run_neighbour

SCHEDULER_ENCRYPTS = (
    "a scheduler has its own encryption, of which dask's configuration tells; its address then "
    "begins with tls://"
)


STARTING = 10.0
"""Work that is done in this process unless others are asked for, s: they take seconds to start."""


@dataclass(frozen=True)
class Progress:
    """How far a study is, after a case has ended.

    Attributes
    ----------
    cases, ended, failed : int
        Number of cases in all, of those that need no more work, and of those among them that
        failed.
    share : float
        Share of the expected work that is done.
    case : Case or None
        The case that has ended; None at the beginning.
    outcome : Outcome or None
        What became of it.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> mu = {"key": "friction.mu", "values": [0.2, 0.4]}
    >>> study = ts.Study(scene="spheres", without=["subsurface"], axis=[mu])
    >>> def tell(progress: ts.studies.Progress) -> None:
    ...     print(f"{progress.ended} of {progress.cases}, {progress.share:.0%} of the work")
    >>> results = ts.study(study, "friction", workers=0, progress=tell)
    0 of 2, 0% of the work
    1 of 2, 50% of the work
    2 of 2, 100% of the work
    """

    cases: int
    ended: int
    failed: int
    share: float
    case: Case | None = None
    outcome: Outcome | None = None


def study(
    asked: Study | str | PathLike[str],
    directory: str | PathLike[str],
    *,
    scheduler: str | None = None,
    workers: int | None = None,
    encrypted: bool | None = None,
    progress: Callable[[Progress], None] | None = None,
    say: Callable[[str], None] | None = None,
) -> StudyResults:
    """Run the cases of a study that are not complete, long ones first.

    Where it keeps scalars, neighbours are computed in turn and start from each other: numbers hang
    on where that was cut, as by another number of workers or by going on later, by no more than the
    tolerance of the solver.

    A script that calls it without a scheduler of its own must do so under ``if __name__ ==
    "__main__":``, as the workers are processes that import the script.

    Parameters
    ----------
    asked : Study or path-like
        The study, or its file.
    directory : path-like
        Its folder; where it is that of an earlier run, the study goes on: complete cases are not
        run again, others go on from their last record.
    scheduler : str, optional
        Address of a scheduler of dask.distributed whose workers are to do it; they have to see the
        folder under the same name.
    workers : int, optional
        Without a scheduler: number of processes on this machine. With 0, the cases are computed in
        this process, one after another. By default as many as cores, or 0 where the work is done
        sooner than they would have started.
    encrypted : bool, optional
        Whether the processes of this machine speak TLS among each other, so that no other user of
        it can hand them work; needs the package cryptography, of the extra study. They do unless
        it is False.
    progress : callable, optional
        Called at the beginning, and whenever a case has ended.
    say : callable, optional
        Called with a word about what is waited for.

    Returns
    -------
    StudyResults
        All cases, complete or not.

    Raises
    ------
    StudyError
        With the faults of the study and of all its scenes, or where so many processes do not fit
        into the memory; nothing has been run then.
    ValueError
        If encryption is asked of a scheduler, which has its own.
    ResultsError
        If the folder cannot be used or made, or dask is not installed or cannot read the address.
    SchedulerLostError
        If there is no scheduler, or none any more; what is complete remains so.
    OSError
        If the folder cannot be written any more; what is complete remains so.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> mu = {"key": "friction.mu", "values": [0.2, 0.4]}
    >>> study = ts.Study(scene="spheres", without=["subsurface"], axis=[mu])
    >>> results = ts.study(study, "friction", workers=0)
    >>> results.complete
    True
    >>> results.column("Qx_over_P").round(1)
    array([0.2, 0.3])
    """
    if scheduler is not None and encrypted:
        raise ValueError(f"encrypted: {SCHEDULER_ENCRYPTS}")
    asked = asked if isinstance(asked, Study) else Study.from_toml(asked)
    found, folder = cases(asked), Folder(directory)
    tell, say = progress or (lambda _: None), say or (lambda _: None)
    with folder.taken(asked):
        if note := folder.log.read().damage_note:
            say(note)
            folder.log.drop_damaged()
        tasks, done = _left(folder, found, asked)
        # Cases that are complete already are of no interest to the bar: it shows the work left.
        total = sum(task.seconds for task in tasks) or 1.0
        ended, failed, share = done, 0, 0.0
        tell(Progress(len(found), ended, failed, share))
        for task, outcome in _ended(tasks, scheduler, workers, encrypted, say):
            if outcome.status == COMPLETE:
                folder.keep(task, outcome)
            else:
                folder.fail(task.case, outcome)
            if outcome.note:
                say(f"{task.case}: {outcome.note}")
            ended += 1
            failed += outcome.status != COMPLETE
            share += task.seconds / total
            tell(Progress(len(found), ended, failed, share, task.case, outcome))
    return open_study(directory)


def _left(folder: Folder, found: list[Case], asked: Study) -> tuple[list[Task], int]:
    """What is to be done, and the number of cases that are complete.

    Long cases come first; where scalars are kept, neighbours come one after another.
    """
    files, complete = folder.results(), folder.log.read().entries
    scalars = asked.keep == "scalars"
    left = []
    for case in found:
        interrupt.raise_if_interrupted()
        kept = complete.get(case.digest)
        if kept and scalars and not kept["size"]:
            continue
        if not (kept and case.digest in files and _is_complete(files[case.digest])):
            left.append(case)
    seconds = estimates(left, with_files=not scalars)
    tasks = [
        Task(case, None if scalars else folder.file_of(case, files), time)
        for case, time in zip(left, seconds, strict=True)
    ]
    if scalars:
        turn = in_turn(asked.shape)
        tasks.sort(key=lambda task: turn[task.case.number])
    else:
        tasks.sort(key=lambda task: -task.seconds)
    return tasks, len(found) - len(left)


def _ended(
    tasks: list[Task],
    scheduler: str | None,
    workers: int | None,
    encrypted: bool | None,
    say: Callable[[str], None],
) -> Iterator[tuple[Task, Outcome]]:
    if not tasks:
        return
    if scheduler is None and workers is None and sum(task.seconds for task in tasks) < STARTING:
        workers = 0
    if workers == 0 and scheduler is None:
        yield from _one_after_another(tasks, say)
        return
    cluster.check_installed()
    if scheduler is not None:
        chosen: AbstractContextManager = nullcontext((scheduler, None))
    else:
        count = workers or cores()
        check_memory([task.case for task in tasks], count)
        chosen = cluster.local_cluster(count, encrypted is not False)
    with chosen as (address, security):
        yield from cluster.on_cluster(tasks, address, _reached, say, security)


def _one_after_another(
    tasks: list[Task], say: Callable[[str], None]
) -> Iterator[tuple[Task, Outcome]]:
    neighbours = InTurn()
    for task in tasks:
        if task.file is None:
            interrupt.raise_if_interrupted()
            yield task, run_neighbour(task.case.scene, neighbours)
            continue
        told = False
        while (outcome := run_case(task.case.scene, str(task.file))).status == HELD:
            if not told:
                say(f"waiting for {task.case}, which another process computes")
            told = True
            interrupt.raise_if_interrupted()
            sleep(cluster.PAUSE)
        yield task, outcome


def _is_complete(file: Path) -> bool:
    """Whether a results file can be read and says so."""
    try:
        return open_history(file).finished
    except ResultsError:
        return False


def _reached(task: Task) -> int:
    """Records in the results file of a task."""
    if task.file is None:
        return 0
    try:
        return len(open_history(task.file))
    except ResultsError:
        return 0
