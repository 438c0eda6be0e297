"""Tasks: cases and chains of neighbouring ones, which a worker computes and stores."""

from __future__ import annotations

import os
import socket
from collections.abc import Callable, Container, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from time import perf_counter
from traceback import format_exc
from typing import Any

import numpy as np

from tractive_sam import interrupt, run
from tractive_sam.results import BODIES, History
from tractive_sam.scene import Scene
from tractive_sam.store import (
    DamagedError,
    FileInUseError,
    hold_lock,
    lock_path,
    open_history,
    versions,
)
from tractive_sam.studies.design import Case

COMPLETE, FAILED, LOCKED = "complete", "failed", "locked"


@dataclass(frozen=True)
class Task:
    """Case to compute, with its results file and its estimated time.

    Attributes
    ----------
    case : Case
        The case.
    file : Path or None
        Results file of the case; None if the study keeps scalars.
    seconds : float
        Expected time; long cases are first.
    """

    case: Case
    file: Path | None
    seconds: float


@dataclass(frozen=True)
class CaseOutcome:
    """Outcome of a computed case: status, message, and values of its last record.

    Attributes
    ----------
    status : str
        `COMPLETE`, `FAILED`, or `LOCKED` by another process.
    message : str
        How it ended.
    row : mapping of str to number
        The last record, from `summary`.
    worker : str
        Machine and process.
    seconds : float
        Time it took on the worker.
    version : str
        Version of this package on the worker.
    note : str
        A note for the user.
    traceback : str
        Traceback of a failure.
    """

    status: str
    message: str
    row: dict[str, Any] = field(default_factory=dict)
    worker: str = ""
    seconds: float = 0.0
    version: str = ""
    note: str = ""
    traceback: str = ""


def summary(history: History, record: int = -1) -> dict[str, Any]:
    """Return a record's scalars, those of bodies as "name A", and the history's totals, by name."""
    if not len(history):
        return {}
    row = {name: history[name][record].item() for name in history.of_dims()}
    for name, quantity in history.of_dims("body").items():
        for body in quantity.bodies(history.scene):
            row[f"{name} {body}"] = float(history[name][record, BODIES.index(body)])
    return row | history.totals


Chain = tuple[Task, ...]
"""Tasks that a worker receives together."""


def neighbour_order(shape: tuple[int, ...]) -> np.ndarray:
    """Return the position of each case in an order in which neighbours follow one another."""
    places = np.array(
        [np.ravel_multi_index(place, shape) for place in run.neighbouring_places(shape)]
    )
    return np.argsort(places)


def make_chains(
    tasks: Iterable[Task], single: Container[str] = (), *, longest: float = 2.0
) -> list[Chain]:
    """Divide tasks into chains of <= `longest` s; tasks with a file or in `single` remain alone.

    Parameters
    ----------
    tasks : iterable of Task
        Tasks in their order.
    single : container of str
        Hashes of cases that are separate chains, as are those with a results file.
    longest : float
        Expected seconds of a chain of several cases: the loss if a worker dies, and the time for
        which others wait at the end.
    """
    chains: list[list[Task]] = []
    remaining = 0.0
    for task in tasks:
        joins = task.file is None and task.case.digest not in single
        remaining -= task.seconds
        if joins and remaining >= 0.0:
            chains[-1].append(task)
        else:
            chains.append([task])
            remaining = longest - task.seconds if joins else 0.0
    return [tuple(chain) for chain in chains]


def run_case(scene: Scene, path: str) -> CaseOutcome:
    """Roll a scene to a results file, or resume it; return the outcome, FAILED after an error.

    Parameters
    ----------
    scene : Scene
        The scene.
    path : str
        Its results file, in a folder that all machines share.
    """
    file = Path(path)
    if not file.parent.is_dir():
        cure = "the folder of a study must be on a file system that all its machines share"
        return CaseOutcome(
            FAILED, f"{_worker_name()} finds no folder {file.parent}; {cure}", {}, _worker_name()
        )
    return _outcome(partial(_compute_or_repeat, scene, file))


def run_chain(scenes: Sequence[Scene]) -> list[CaseOutcome]:
    """Compute scenes in memory, each from the last solution; return outcomes, also of errors.

    Parameters
    ----------
    scenes : sequence of Scene
        The scenes.
    """
    neighbours, outcomes = run.SequentialRuns(), []
    for scene in scenes:
        interrupt.raise_if_interrupted()
        outcomes.append(run_neighbour(scene, neighbours))
    return outcomes


def run_neighbour(scene: Scene, neighbours: run.SequentialRuns) -> CaseOutcome:
    """Compute a scene in memory from the last solution; return the outcome, also of an error."""
    return _outcome(lambda: _history_outcome(neighbours.roll(scene), versions()["tractive-sam"]))


def _worker_name() -> str:
    """Return the name of this machine and the id of this process."""
    return f"{socket.gethostname()}:{os.getpid()}"


def _outcome(compute: Callable[[], CaseOutcome]) -> CaseOutcome:
    """Return the outcome of a computation; an error becomes FAILED, a file in use LOCKED."""
    began = perf_counter()
    try:
        outcome = compute()
    except FileInUseError:
        outcome = CaseOutcome(LOCKED, "another process computes it")
    except Exception as error:  # whatever the error, the other cases are computed
        outcome = CaseOutcome(FAILED, f"{type(error).__name__}: {error}", traceback=format_exc())
    version = outcome.version or versions()["tractive-sam"]
    return replace(outcome, worker=_worker_name(), seconds=perf_counter() - began, version=version)


def _compute_or_repeat(scene: Scene, file: Path) -> CaseOutcome:
    """Compute a scene to a file; if the file is damaged, rename it and compute again."""
    try:
        return _compute(scene, file)
    except DamagedError as error:
        damaged = file.with_suffix(".damaged")
        with hold_lock(lock_path(file)):
            os.replace(file, damaged)
        note = f"{error}; it was renamed to {damaged.name} and computed again"
        return replace(_compute(scene, file), note=note)


def _compute(scene: Scene, file: Path) -> CaseOutcome:
    """Compute a scene to a results file, or resume it unless it is complete; return the outcome."""
    if file.exists():
        history = open_history(file)
        if history.finished and history.scene == scene:
            return _history_outcome(history)
    return _history_outcome(run.roll(scene, file, resume=True, progress=False))


def _history_outcome(history: History, version: str = "") -> CaseOutcome:
    """Return the outcome of a history: COMPLETE if it is finished, else FAILED."""
    status = COMPLETE if history.finished else FAILED
    by = version or history.versions.get("tractive-sam", "")
    return CaseOutcome(status, history.message, summary(history), version=by)
