"""Revolutions of a scene, stored in a results file."""

import numpy as np

from tractive_sam.paper.finding import Work
from tractive_sam.results import History, Record
from tractive_sam.run import roll
from tractive_sam.scene import Scene


def roll_into_file(work: Work, scene: Scene, name: str) -> History:
    """Roll a scene, store the results in the file `name`.h5 (overwritten), and return the history.

    Raises
    ------
    RuntimeError
        If a contact was not solved.
    """

    def report(record: Record) -> None:
        work.report(f"{name}, revolution {record.revolution} of {work.size.revolutions}")

    path = work.results / f"{name}.h5"
    history = roll(scene, path, overwrite=True, progress=report)
    if not history.finished:
        raise RuntimeError(f"{path}: {history.status}; {history.message}")
    return history


def read_saved(history: History, name: str) -> np.ndarray:
    """Return a column of a history at the revolutions with stored fields."""
    return history[name][np.isin(history["revolution"], history.field_revolutions)]
