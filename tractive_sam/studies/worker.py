"""What a worker does: one case, into the results file that it alone writes."""

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
from tractive_sam.run import InTurn, roll
from tractive_sam.scene import Scene
from tractive_sam.store import DamagedError, HeldError, lock_of, locked, open_history, versions
from tractive_sam.studies.task import COMPLETE, FAILED, HELD, Outcome, summary

ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
    "OMP_WAIT_POLICY": "passive",
}
"""Environment of a worker: cores are filled with cases, not with threads of one. (FFTW has one
thread wherever nothing else is asked for.)"""


def run_case(scene: Scene, path: str) -> Outcome:
    """Roll a scene, from where its results file ends if there is one.

    Parameters
    ----------
    scene : Scene
        What is computed.
    path : str
        Its results file, in a folder that all machines share.
    """
    file = Path(path)
    if not file.parent.is_dir():
        cure = "the folder of a study must be on a file system that all its machines share"
        return Outcome(FAILED, f"{_here()} finds no folder {file.parent}; {cure}", {}, _here())
    return _outcome(partial(_rolled_or_again, scene, file))


def run_chain(scenes: Sequence[Scene]) -> list[Outcome]:
    """Roll neighbours one after another, each from the one before it; no file is written.

    Parameters
    ----------
    scenes : sequence of Scene
        What is computed.
    """
    neighbours, outcomes = InTurn(), []
    for scene in scenes:
        interrupt.raise_if_interrupted()
        outcomes.append(run_neighbour(scene, neighbours))
    return outcomes


def run_neighbour(scene: Scene, neighbours: InTurn) -> Outcome:
    """Roll a scene from the one that was rolled before it; no file is written."""
    return _outcome(lambda: _of(neighbours.roll(scene), versions()["tractive-sam"]))


def _here() -> str:
    return f"{socket.gethostname()}:{os.getpid()}"


def _outcome(compute: Callable[[], Outcome]) -> Outcome:
    """What became of a case, whatever goes wrong."""
    began = perf_counter()
    try:
        outcome = compute()
    except HeldError:
        outcome = Outcome(HELD, "another process computes it")
    except Exception as error:  # whatever it is, the other cases go on
        outcome = Outcome(FAILED, f"{type(error).__name__}: {error}", traceback=format_exc())
    here = outcome.version or versions()["tractive-sam"]
    return replace(outcome, worker=_here(), seconds=perf_counter() - began, version=here)


def _rolled_or_again(scene: Scene, file: Path) -> Outcome:
    """Roll a scene; where its results file is damaged, from the beginning."""
    try:
        return _rolled(scene, file)
    except DamagedError as error:
        aside = file.with_suffix(".damaged")
        with locked(lock_of(file)):
            os.replace(file, aside)
        note = f"{error}; it was set aside as {aside.name} and computed again"
        return replace(_rolled(scene, file), note=note)


def _rolled(scene: Scene, file: Path) -> Outcome:
    if file.exists():
        history = open_history(file)
        if history.finished and history.scene == scene:
            return _of(history)
    return _of(roll(scene, file, resume=True, progress=False))


def _of(history: History, version: str = "") -> Outcome:
    """What a history says became of its case."""
    status = COMPLETE if history.finished else FAILED
    by = version or history.versions.get("tractive-sam", "")
    return Outcome(status, history.message, summary(history), version=by)
