"""What a worker does: one case, into the results file that it alone writes."""

import os
import socket
from pathlib import Path
from time import perf_counter
from typing import Any

from tractive_sam.run.pipeline import roll
from tractive_sam.scene import Scene
from tractive_sam.store import open_history
from tractive_sam.studies.lock import HeldError, locked
from tractive_sam.studies.task import COMPLETE, FAILED, HELD, Outcome, lock_of, summary

ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
    "OMP_WAIT_POLICY": "passive",
}
"""Environment of a worker: cores are filled with cases, not with threads of one. (FFTW has one
thread wherever nothing else is asked for.)"""


def run_case(scene_toml: str, path: str) -> Outcome:
    """Roll a scene, from where its results file ends if there is one.

    Parameters
    ----------
    scene_toml : str
        The scene.
    path : str
        Its results file, in a folder that all machines share.
    """
    began = perf_counter()
    file, worker = Path(path), f"{socket.gethostname()}:{os.getpid()}"
    if not file.parent.is_dir():
        cure = "the folder of a study must be on a file system that all its machines share"
        return Outcome(FAILED, f"{worker} finds no folder {file.parent}; {cure}", {}, worker)
    try:
        with locked(lock_of(file)):
            status, message, row = _rolled(scene_toml, file)
    except HeldError:
        status, message, row = HELD, "another process computes it", {}
    except Exception as error:  # whatever it is, the other cases go on
        status, message, row = FAILED, f"{type(error).__name__}: {error}", {}
    return Outcome(status, message, row, worker, perf_counter() - began)


def _rolled(scene_toml: str, file: Path) -> tuple[str, str, dict[str, Any]]:
    scene = Scene.from_toml_text(scene_toml)
    if file.exists():
        history = open_history(file)
        if history.finished and Scene.from_toml_text(history.scene_toml) == scene:
            return COMPLETE, history.message, summary(history)
    history = roll(scene, file, resume=True)
    return COMPLETE if history.finished else FAILED, history.message, summary(history)
