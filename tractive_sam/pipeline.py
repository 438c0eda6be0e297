"""From a scene to its results: the two front doors, `solve` and `roll`."""

from collections.abc import Callable
from contextlib import nullcontext
from itertools import chain
from os import PathLike
from pathlib import Path
from time import perf_counter

import numpy as np

from tractive_sam.contact import Contact, Gap, Model, NotConverged, equilibrium, grown
from tractive_sam.record import History, Record, state
from tractive_sam.restart import last_passage
from tractive_sam.rolling import Passage, passages, recorded
from tractive_sam.scene import Scene
from tractive_sam.solvers import Status
from tractive_sam.store import HistoryWriter, open_history, read_gap

GROWTHS = 8
"""Most enlargements of a mesh that the scene left to us."""


def measured_gap(scene: Scene) -> Gap | None:
    """The measured separation of a scene, read from its file where it names one."""
    gap = scene.gap
    if gap is None:
        return None
    if gap.file is not None:
        return read_gap(gap.file)
    return gap.x, gap.y, gap.separation


def solve(
    scene: Scene,
    *,
    wear: np.ndarray | None = None,
    start: Contact | None = None,
    throw: bool = True,
) -> Contact:
    """Solve one steady state of a scene.

    Parameters
    ----------
    scene : Scene
        What is asked; its [wear] is not rolled, see `roll`.
    wear : ndarray, shape (n_x, n_y), optional
        Depth worn off both bodies together, mm.
    start : Contact, optional
        Contact of a similar scene on the same mesh, as first guess.
    throw : bool
        Whether to raise where the solve did not converge.

    Returns
    -------
    Contact
        Fields, resultants, residual and cost.

    Raises
    ------
    ValueError
        If `wear` or `start` do not fit the mesh.
    NotConverged
        If `throw` and the contact conditions do not hold to the scene's tolerance.
    """
    model = Model(scene, measured_gap(scene))
    if wear is not None:
        wear = np.asarray(wear, float)
        if wear.shape != model.grid.elements or not np.isfinite(wear).all():
            raise ValueError(f"wear: finite numbers of the shape {model.grid.elements} are needed")
    if start is not None and start.grid != model.grid:
        raise ValueError(
            f"start: a contact on the mesh of the scene is needed, {model.grid.elements} elements "
            f"over {model.grid.half_length} mm; not {start.grid.elements} over "
            f"{start.grid.half_length}"
        )
    contact = equilibrium(model, wear, start)
    if start is None and wear is None:
        model, contact = _fitted(model, contact)
    if throw and not contact.converged:
        raise NotConverged(contact)
    return contact


def _fitted(model: Model, contact: Contact) -> tuple[Model, Contact]:
    """Enlarge a mesh that the scene left to us until it holds the contact."""
    for _ in range(GROWTHS):
        if contact.status is not Status.OFF_GRID or model.scene.grid is not None:
            break
        model = Model(model.scene, model.measured, grown(model.grid))
        contact = equilibrium(model)
    return model, contact


def roll(
    scene: Scene,
    path: str | PathLike | None = None,
    *,
    overwrite: bool = False,
    resume: bool = False,
    progress: Callable[[Record], None] | None = None,
) -> History:
    """Roll a scene through its revolutions; without [wear] that is revolution 0, the new bodies.

    Parameters
    ----------
    scene : Scene
        What is asked.
    path : path-like, optional
        Results file (HDF5), to which every record is streamed as it is computed; without it the
        records are kept in memory.
    overwrite : bool
        Whether a results file of this package may be replaced.
    resume : bool
        Whether to go on from the last record of the results file, if there is one: of a run that
        was killed or stopped, or of a finished one that is to be rolled further. The history is
        that of an uninterrupted run.
    progress : callable, optional
        Called with each record.

    Returns
    -------
    History
        All records. Where a contact was not solved the history ends with it, and `status` and
        `message` say so.

    Raises
    ------
    ResultsError
        If the results file cannot be written, or holds another scene than the one to resume.
    GapError
        If the measured gap cannot be read.
    """
    began = perf_counter()
    last = None
    if resume and path is not None and Path(path).exists():
        last = last_passage(open_history(path), path, scene)
    if last is None:
        model = Model(scene, measured_gap(scene))
        model, contact = _fitted(model, equilibrium(model))
        start = Passage(0, contact, 1)
    else:
        start = last
        model = Model(scene, measured_gap(scene), last.contact.grid)
    hertz = scene.hertz
    reference = {} if hertz is None else {"a0": hertz.a, "b0": hertz.b, "p0": hertz.p0}
    records, writer = [], None
    if path is not None and last is None:
        writer = HistoryWriter(path, scene.to_toml(), model.grid, reference, overwrite or resume)
    elif path is not None:
        writer = HistoryWriter.reopen(path, scene.to_toml())
    with nullcontext() if writer is None else writer:
        passage = start
        for passage in chain((start,) if last is None else (), passages(model, start)):
            record = recorded(passage, began)
            began = perf_counter()
            if writer is None:
                records.append(record)
            else:
                writer.append(record, passage.contact.grid, state(passage.contact))
            if progress is not None:
                progress(record)
        contact = passage.contact
        status = "done" if contact.converged else str(contact.status)
        message = contact.message
        if scene.wear is not None:
            message = f"revolution {passage.revolution}: {message}"
        if writer is not None:
            writer.finish(status, message)
            return open_history(path)
    return History.of_records(
        records, scene.to_toml(), contact.grid, status=status, message=message, **reference
    )
