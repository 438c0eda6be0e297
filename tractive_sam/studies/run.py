"""Run a study: estimate its cost, hand out what is not complete, keep what comes back."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from functools import cache
from os import PathLike
from pathlib import Path
from time import sleep
from traceback import format_exception
from typing import Any

import numpy as np

from tractive_sam import interrupt
from tractive_sam.compute import cores
from tractive_sam.contact import Model
from tractive_sam.description import Description, Section, format_duration, format_setting
from tractive_sam.results import FIELDS, STRESS, columns
from tractive_sam.run import SequentialRuns, explain, memory
from tractive_sam.scene import Scene
from tractive_sam.schema import Fault
from tractive_sam.store import ResultsError, open_history, read_gap
from tractive_sam.studies.cluster import WAITS, open_workers
from tractive_sam.studies.design import Case, Study, StudyError, cases
from tractive_sam.studies.pool import Call, WorkerDiedError, Workers
from tractive_sam.studies.results import Folder, StudyResults, read_results
from tractive_sam.studies.worker import (
    COMPLETE,
    FAILED,
    LOCKED,
    CaseOutcome,
    Chain,
    Task,
    make_chains,
    neighbour_order,
    run_case,
    run_chain,
    run_neighbour,
)


def explain_study(study: Study, workers: int) -> Description:
    """Return sections that describe the cases of a study, with expected time and disk space.

    Parameters
    ----------
    study : Study
        The study.
    workers : int
        Number of processes.

    Raises
    ------
    StudyError
        With the faults of all scenes that are not valid.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> angles = {"key": "friction.angle", "start": 0, "stop": 90, "number": 7}
    >>> study = ts.Study(scene="twin-discs", axis=[angles])
    >>> axes, work = ts.explain_study(study, workers=2)
    >>> axes.rows
    [('friction.angle', '7 values: 0, 15, 30 ... 90'), ('in all', '7 cases')]
    >>> [label for label, text in work.rows]
    ['a case', 'all cases', 'with 2 workers', 'memory', 'results']
    """
    all_cases = cases(study)
    models = _models(case.scene for case in all_cases)
    files = study.keep == "all"
    seconds = np.array(_estimate_times(models, files))
    # The last record of a case takes 2 kB.
    volume = sum(map(_file_size, models)) if files else 2e3 * len(all_cases)
    memory_each = f"about {max(map(memory.scene_bytes, models)) / 2**20:.0f} MiB a worker"
    size = f"{volume / 1e6:.0f} MB" if volume > 1e6 else f"{volume / 1e3:.0f} kB"
    number = f"{len(all_cases)} files" if files and len(all_cases) > 1 else "one file"
    total = max(seconds.sum() / workers, seconds.max())
    shortest, longest = format_duration(min(seconds)), format_duration(max(seconds))
    work = [
        ("a case", " to ".join(dict.fromkeys((shortest, longest)))),
        ("all cases", f"about {format_duration(seconds.sum())} of one core"),
        (f"with {workers} workers", f"about {format_duration(total)}; set others by --workers N"),
        ("memory", f"{memory_each}, and {explain.PROGRAM_MEMORY} MiB for programs"),
        ("results", f"at most about {size} in {number}"),
    ]
    axes = [*_describe_axes(study), ("in all", f"{len(all_cases)} cases")]
    return Description((Section("Cases", axes), Section("Work", work)))


def estimate_times(scenes: Iterable[Scene], with_files: bool = True) -> list[float]:
    """Return the estimated CPU time of each scene on this machine, s.

    Parameters
    ----------
    scenes : iterable of Scene
        Scenes.
    with_files : bool
        Whether each scene writes its results file.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> from tractive_sam.studies import estimate_times
    >>> len(estimate_times([ts.Scene.builtin("spheres")]))
    1
    """
    return _estimate_times(_models(scenes), with_files)


def check_memory(cases: list[Case], workers: int) -> None:
    """Raise a StudyError if so many simultaneous cases need more than the free memory.

    Raises
    ------
    StudyError
        With the number of processes for which it suffices.
    """
    each = (
        max(map(memory.scene_bytes, _models(case.scene for case in cases)), default=0.0)
        + explain.PROGRAM_MEMORY * 2**20
    )
    free, workers = memory.available_memory(), min(workers, len(cases))
    if workers * each > free:
        mebi = 2**20
        value = f"{workers} of about {each / mebi:.0f} MiB each, and {free / mebi:.0f} are free"
        fits = int(free / each)
        allowed = f"at most {fits} on this machine" if fits else "coarser scenes, or more memory"
        raise StudyError([Fault("workers", value, allowed)])


def _describe_axes(study: Study) -> list[tuple[str, str]]:
    """Return rows with the keys that vary, their number of values, and their range."""
    rows = []
    for dimension in study.dimensions:
        for key, column in dimension.columns.items():
            values = ", ".join(map(format_setting, column[:3]))
            if len(column) > 3:
                values += f" ... {format_setting(column[-1])}"
            rows.append((key, f"{len(column)} values: {values}"))
    return rows


def _models(scenes: Iterable[Scene]) -> list[Model]:
    """Return the model of each scene; gap files are read once."""
    read = cache(read_gap)
    return [Model(scene, None if scene.gap is None else read(scene.gap)) for scene in scenes]


def _estimate_times(
    models: list[Model], with_files: bool, *, file: float = 0.1, uzawa: float = 20.0
) -> list[float]:
    """Return the estimated seconds of each case, from timing one mesh of each kind.

    Parameters
    ----------
    models : list of Model
        Models of the cases.
    with_files : bool
        Whether a results file is written for each.
    file : float
        Seconds for a results file, independent of its content (benchmarks/study.py).
    uzawa : float
        Applications of Uzawa's method over the default one's, roughly: it orders the cases.
    """
    kinds = defaultdict(list)
    for model in models:
        kinds[memory.fields_per_operator(model), type(model.elasticity)].append(model)
    # Measured seconds of an elastic response of the median model, per unit of work.
    medians = {kind: sorted(alike, key=_work)[len(alike) // 2] for kind, alike in kinds.items()}
    pace = {k: explain.seconds_per_application(m) / _work(m) for k, m in medians.items()}
    return [
        file * with_files
        + explain.seconds_of_inclusions(model)
        + pace[memory.fields_per_operator(model), type(model.elasticity)]
        * _work(model)
        * explain.expected_applications(model)
        * (1.0 if model.method.predictable else uzawa)
        for model in models
    ]


def _work(model: Model) -> float:
    """Return the relative work of an elastic response of a model."""
    return explain.transform_work(model.grid.elements)


def _file_size(model: Model, empty: float = 2e5) -> float:
    """Return the estimated size of a model's results file, bytes."""
    scene, (nx, ny) = model.scene, model.grid.elements
    saved = len(scene.schedule.save)
    numbers = (saved + 1) * len(FIELDS) * nx * ny  # also the state from which a run resumes
    sizes = (ny if column.dims else 1 for column in columns(scene).values())
    numbers += explain.expected_records(model) * sum(sizes)
    if scene.subsurface is not None:
        below = scene.subsurface
        planes = len(below.planes) * len(below.bodies)
        numbers += saved * planes * len(STRESS) * below.elements * (nx + ny) // 2
    return empty + 8.0 * numbers


@dataclass(frozen=True)
class StudyProgress:
    """Progress of a study when a case has ended: the case and the remaining time.

    Attributes
    ----------
    cases, ended, failed : int
        Number of all cases, of those that have ended, and of those that failed.
    share : float
        Share of the expected work that is done.
    case : Case or None
        The case that has ended; None at the beginning.
    outcome : Outcome or None
        Outcome of the case.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> mu = {"key": "friction.mu", "values": [0.2, 0.4]}
    >>> study = ts.Study(scene="spheres", without=["subsurface"], axis=[mu])
    >>> def report(progress: ts.studies.StudyProgress) -> None:
    ...     print(f"{progress.ended} of {progress.cases}, {progress.share:.0%} of the work")
    >>> results = ts.study(study, "friction", workers=0, progress=report)
    0 of 2, 0% of the work
    1 of 2, 50% of the work
    2 of 2, 100% of the work
    """

    cases: int
    ended: int
    failed: int
    share: float
    case: Case | None = None
    outcome: CaseOutcome | None = None


def study(
    requested: Study | str | PathLike[str],
    directory: str | PathLike[str],
    *,
    scheduler: str | None = None,
    workers: int | None = None,
    progress: Callable[[StudyProgress], None] | None = None,
    say: Callable[[str], None] | None = None,
) -> StudyResults:
    """Run the cases of a study that are not complete; return the results of all cases.

    If it keeps scalars, neighbours are computed one after another and start from each other:
    numbers depend on the number of workers and on interruptions, by at most the tolerance of the
    solver.

    A script that calls it without a scheduler must do so under ``if __name__ == "__main__":``, as
    the workers are processes that import the script.

    Parameters
    ----------
    requested : Study or path-like
        The study, or its file.
    directory : path-like
        Its folder. In the folder of an earlier run, complete cases are not run again, and others
        resume from their last record.
    scheduler : str, optional
        Address of a scheduler of dask.distributed: its workers compute, and must see the folder
        under this name.
    workers : int, optional
        Without a scheduler: number of processes on this machine. With 0, the cases are computed in
        this process, one after another. By default one for each core, or 0 if the work is shorter
        than their start.
    progress : callable, optional
        Called at the beginning, and whenever a case has ended.
    say : callable, optional
        Called with a message about what the study waits for.

    Returns
    -------
    StudyResults
        All cases, complete or not.

    Raises
    ------
    StudyError
        With the faults of the study and of all its scenes, or if the memory is too small for the
        processes; no case has been run then.
    ResultsError
        If the folder cannot be used or made, if workers cannot start, or, with a scheduler, if dask
        is not installed or cannot read the address.
    SchedulerLostError
        If the scheduler does not exist or was lost; complete cases remain complete.
    OSError
        If the folder cannot be written any more; complete cases remain complete.

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
    requested = requested if isinstance(requested, Study) else Study.from_toml(requested)
    report, say, folder = progress or (lambda _: None), say or (lambda _: None), Folder(directory)
    if scheduler is not None:
        workers = 0  # it has its own
    with ExitStack() as stack:
        pool = None
        if scheduler is not None or workers:  # they start while the cases are checked
            pool = stack.enter_context(open_workers(workers or 0, scheduler, say))
        all_cases = cases(requested)
        stack.enter_context(folder.lock(requested))
        if note := folder.log.read().damage_note:
            say(note)
            folder.log.drop_damaged()
        tasks, done = remaining_tasks(folder, all_cases, requested)
        # The progress refers to the remaining work, without cases that are complete already.
        total = sum(task.seconds for task in tasks) or 1.0
        # Processes take a second to start: less work is done in this one.
        if workers is None and total > 10.0:
            workers = cores()
            pool = stack.enter_context(open_workers(workers))
        if workers and tasks:
            check_memory([task.case for task in tasks], workers)
        ended, failed, share = done, 0, 0.0
        report(StudyProgress(len(all_cases), ended, failed, share))
        outcomes = _run_in_process(tasks, say) if pool is None else run_tasks(tasks, pool, say)
        for task, outcome in outcomes:
            if outcome.status == COMPLETE:
                folder.log_complete(task, outcome)
            else:
                folder.log_failure(task.case, outcome)
            if outcome.note:
                say(f"{task.case}: {outcome.note}")
            ended += 1
            failed += outcome.status != COMPLETE
            share += task.seconds / total
            report(StudyProgress(len(all_cases), ended, failed, share, task.case, outcome))
    return read_results(folder, requested, all_cases)


def remaining_tasks(folder: Folder, cases: list[Case], requested: Study) -> tuple[list[Task], int]:
    """Return (tasks of incomplete cases, longest or neighbours first; number of complete cases).

    Long cases are first; if only scalars are stored, neighbours follow each other.
    """
    files, complete = folder.results(), folder.log.read().entries
    scalars = requested.keep == "scalars"
    remaining = []
    for case in cases:
        interrupt.raise_if_interrupted()
        entry = complete.get(case.digest)
        if entry and scalars and not entry["size"]:
            continue
        if not (entry and case.digest in files and _is_complete(files[case.digest])):
            remaining.append(case)
    seconds = estimate_times((case.scene for case in remaining), with_files=not scalars)
    tasks = [
        Task(case, None if scalars else folder.file_of(case, files), time)
        for case, time in zip(remaining, seconds, strict=True)
    ]
    if scalars:
        order = neighbour_order(requested.shape)
        tasks.sort(key=lambda task: order[task.case.number])
    else:
        tasks.sort(key=lambda task: -task.seconds)
    return tasks, len(cases) - len(remaining)


def run_tasks(
    tasks: list[Task], workers: Workers, log: Callable[[str], None]
) -> Iterator[tuple[Task, CaseOutcome]]:
    """Run tasks on workers; yield (task, outcome) as they end.

    Parameters
    ----------
    tasks : list of Task
        The tasks.
    workers : Workers
        The workers.
    log : callable
        Called with a message about what is waited for.
    """
    remaining = {task.case.digest: task for task in tasks}
    killed: dict[str, int] = {}
    waiting = False
    while remaining:
        chains = make_chains(remaining.values(), single=killed)
        locked = False
        for k, answer in workers.run([_worker_call(chain) for chain in chains]):
            for task, outcome in zip(chains[k], _outcomes(answer, len(chains[k])), strict=True):
                if outcome is None and len(chains[k]) > 1:
                    killed[task.case.digest] = 0  # single cases show which one killed the worker
                    continue
                ended = outcome or _judge_death(task, killed)
                if ended is not None and ended.status != LOCKED:
                    del remaining[task.case.digest]
                    yield task, ended
                locked |= ended is not None and ended.status == LOCKED
        if locked:
            if not waiting:
                log(f"waiting for {len(remaining)} cases, which other processes compute")
            waiting = True
            sleep(WAITS.pause)


def _worker_call(chain: Chain) -> Call:
    """Return the call of a worker for a chain of tasks."""
    first = chain[0]
    if first.file is not None:
        return run_case, first.case.scene, str(first.file)
    return run_chain, [task.case.scene for task in chain]


def _outcomes(answer: Any, number: int) -> list[CaseOutcome | None]:
    """Return a chain's outcomes: None for each if its workers died, FAILED after an error."""
    if isinstance(answer, WorkerDiedError):
        return [None] * number
    if isinstance(answer, Exception):
        traceback = "".join(format_exception(answer))
        text = f"{type(answer).__name__}: {answer}"
        return [CaseOutcome(FAILED, text, traceback=traceback)] * number
    return answer if isinstance(answer, list) else [answer]


def _judge_death(task: Task, killed: dict[str, int]) -> CaseOutcome | None:
    """Store a case's records in `killed`; return a failure if they have not grown, else None."""
    before, records = killed.get(task.case.digest, 0), 0
    if task.file is not None:
        with suppress(ResultsError):
            records = len(open_history(task.file))
    killed[task.case.digest] = records
    if records > before:
        return None
    cure = "the memory may be too small: tractive-sam explain estimates what a scene needs"
    return CaseOutcome(FAILED, f"every worker that computed it died; {cure}")


def _run_in_process(
    tasks: list[Task], log: Callable[[str], None]
) -> Iterator[tuple[Task, CaseOutcome]]:
    """Run tasks in this process, waiting for locked ones; yield (task, outcome) as they end."""
    neighbours = SequentialRuns()
    for task in tasks:
        if task.file is None:
            interrupt.raise_if_interrupted()
            yield task, run_neighbour(task.case.scene, neighbours)
            continue
        waiting = False
        while (outcome := run_case(task.case.scene, str(task.file))).status == LOCKED:
            if not waiting:
                log(f"waiting for {task.case}, which another process computes")
            waiting = True
            interrupt.raise_if_interrupted()
            sleep(WAITS.pause)
        yield task, outcome


def _is_complete(file: Path) -> bool:
    """Return whether a results file can be read and is complete."""
    try:
        return open_history(file).finished
    except ResultsError:
        return False
