"""Compute cases on a worker, which alone writes their results files."""

import os
import socket
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from time import perf_counter
from traceback import format_exc

from tractive_sam import interrupt
from tractive_sam.results import History
from tractive_sam.run import SequentialRuns, roll
from tractive_sam.scene import Scene
from tractive_sam.store import (
    DamagedError,
    FileInUseError,
    hold_lock,
    lock_path,
    open_history,
    versions,
)
from tractive_sam.studies.task import COMPLETE, FAILED, LOCKED, CaseOutcome, summary

SINGLE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
    "OMP_WAIT_POLICY": "passive",
}
"""Environment of a worker: the cores compute several cases, not several threads of one. (FFTW has
one thread by default.)"""


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
    neighbours, outcomes = SequentialRuns(), []
    for scene in scenes:
        interrupt.raise_if_interrupted()
        outcomes.append(run_neighbour(scene, neighbours))
    return outcomes


def run_neighbour(scene: Scene, neighbours: SequentialRuns) -> CaseOutcome:
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
    return _history_outcome(roll(scene, file, resume=True, progress=False))


def _history_outcome(history: History, version: str = "") -> CaseOutcome:
    """Return the outcome of a history: COMPLETE if it is finished, else FAILED."""
    status = COMPLETE if history.finished else FAILED
    by = version or history.versions.get("tractive-sam", "")
    return CaseOutcome(status, history.message, summary(history), version=by)
