"""Revolutions of a scene, kept in a file."""

import numpy as np

from tractive_sam.paper.finding import Work
from tractive_sam.results import History, Record
from tractive_sam.run import roll
from tractive_sam.scene import Scene


def rolled(work: Work, scene: Scene, name: str) -> History:
    """Roll a scene into the results file of that name; one of an earlier run is replaced.

    Raises
    ------
    RuntimeError
        If a contact was not solved.
    """

    def tell(record: Record) -> None:
        work.tell(f"{name}, revolution {record.revolution} of {work.size.revolutions}")

    path = work.results / f"{name}.h5"
    history = roll(scene, path, overwrite=True, progress=tell)
    if not history.finished:
        raise RuntimeError(f"{path}: {history.status}; {history.message}")
    return history


def at_saved(history: History, name: str) -> np.ndarray:
    """What was recorded under a name, at the revolutions whose fields were kept."""
    return history[name][np.isin(history["revolution"], history.field_revolutions)]
