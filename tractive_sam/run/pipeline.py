"""From a scene to its results: the two front doors, `solve` and `roll`."""

from collections.abc import Callable, Iterable
from contextlib import nullcontext
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain
from os import PathLike
from pathlib import Path
from time import perf_counter

import numpy as np
from numpy.typing import ArrayLike

from tractive_sam import interrupt
from tractive_sam.contact import Gap, Laws, Model, equilibrium, fitted
from tractive_sam.operators.threads import one_blas_thread
from tractive_sam.results.grid import Grid
from tractive_sam.results.history import History
from tractive_sam.results.quantities import Quantity
from tractive_sam.results.record import Record, fields
from tractive_sam.results.state import Contact, NotConverged
from tractive_sam.results.status import Status
from tractive_sam.rolling import Passage, passages, recorded
from tractive_sam.run import memory
from tractive_sam.run.accuracy import (
    Judge,
    Levels,
    judge_of,
    judge_on,
    missed_before,
    refined,
    with_tolerances,
)
from tractive_sam.run.resume import last_passage
from tractive_sam.scene import Scene
from tractive_sam.scene.quantities import LARGEST
from tractive_sam.solvers import Solver
from tractive_sam.store import (
    HistoryWriter,
    ResultsError,
    open_history,
    read_gap,
    results_writer,
)


def measured_gap(scene: Scene) -> Gap | None:
    """The measured separation of a scene, read from its file where it names one."""
    gap = scene.gap
    if gap is None:
        return None
    if gap.file is not None:
        return read_gap(gap.file)
    return gap.x, gap.y, gap.separation


@one_blas_thread()
def solve(
    scene: Scene,
    *,
    wear: ArrayLike | None = None,
    start: Contact | None = None,
    throw: bool = True,
    laws: Laws | None = None,
    solver: Solver | None = None,
) -> Contact:
    """Solve one steady state of a scene.

    Parameters
    ----------
    scene : Scene
        What is asked; its [wear] is not rolled, see `roll`.
    wear : array_like, shape (n_x, n_y), optional
        Depth worn off both bodies together, mm.
    start : Contact, optional
        Contact of a similar scene on the same mesh, as first guess.
    throw : bool
        Whether to raise where the solve did not converge.
    laws : Laws, optional
        Laws of friction and wear in place of the scene's.
    solver : Solver, optional
        Method in place of the scene's: any object with `solve(problem, tolerance, start)`, see
        `solvers`.

    Returns
    -------
    Contact
        Fields, resultants, residual and cost; of a scene with [accuracy], without `wear` or
        `start`, on the mesh that it takes, and with error bars.

    Raises
    ------
    TypeError
        If `scene` is no Scene, `start` no Contact, `laws` no Laws, or `solver` has no method
        `solve`.
    ValueError
        If `wear` or `start` do not fit the mesh, or are not finite.
    SceneError
        If no mesh can be chosen that holds the contact, or the memory does not suffice.
    GapError
        If the measured gap cannot be read.
    NotConverged
        If `throw` and the contact conditions do not hold to the scene's tolerance, or its
        [accuracy] was not reached.

    Examples
    --------
    >>> ts.solve(scene).message
    'contact conditions hold to ...'
    >>> faster = ts.solve(scene.replace(**{"creepage.longitudinal": -0.002}), start=contact)
    >>> faster.Qx < contact.Qx
    True
    """
    _check_scene(scene)
    model_of = _model_of(laws, solver)
    measured = measured_gap(scene)
    model = model_of(scene, measured)
    memory.check_solve(model)
    if scene.accuracy is not None and wear is None and start is None:
        return _checked(_accurate(scene, measured, model_of), throw)
    if wear is not None:
        wear = _depths(wear, model.grid)
    if start is not None:
        _check_start(start, model.grid)
    if start is None and wear is None:
        _, contact = fitted(model)
    else:
        contact = equilibrium(model, wear, start)
    return _checked(contact, throw)


def _checked(contact: Contact, throw: bool) -> Contact:
    if throw and not contact.converged:
        raise NotConverged(contact)
    return contact


def _check_scene(scene: Scene) -> None:
    if not isinstance(scene, Scene):
        cure = "Scene.builtin(name), Scene.from_toml(path) or Scene(...) makes one"
        raise TypeError(f"scene: a Scene is needed, not {type(scene).__name__}; {cure}")


def _model_of(laws: Laws | None, solver: Solver | None) -> Callable[..., Model]:
    """Makes models with laws and a method of one's own, if there are any."""
    if not isinstance(laws, Laws | None):
        cure = "Laws.of(scene).replace(friction=...) makes them"
        raise TypeError(f"laws: Laws are needed, not {type(laws).__name__}; {cure}")
    if solver is not None and not callable(getattr(solver, "solve", None)):
        needed = "an object with solve(problem, tolerance, start), such as solvers.Newton()"
        raise TypeError(f"solver: {needed} is needed, not {type(solver).__name__}")
    return partial(Model, laws=laws, solver=solver)


def _depths(wear: ArrayLike, grid: Grid) -> np.ndarray:
    """Depths of wear given from outside, mm."""
    needed = f"wear: finite numbers of the shape {grid.elements} are needed, mm"
    try:
        depths = np.asarray(wear)
    except ValueError:  # rows of different lengths
        raise ValueError(needed) from None
    # "not all" rather than "any": nan must fail, too
    if (
        depths.dtype.kind not in "fiu"
        or depths.shape != grid.elements
        or np.ma.is_masked(wear)
        or not (np.abs(depths) <= LARGEST).all()
    ):
        raise ValueError(needed)
    return depths.astype(float)


def _check_start(start: Contact, grid: Grid) -> None:
    if not isinstance(start, Contact):
        raise TypeError(f"start: a Contact is needed, as of solve, not {type(start).__name__}")
    if start.grid != grid:
        raise ValueError(
            f"start: a contact on the mesh of the scene is needed, {grid.elements} elements "
            f"over {grid.half_length} mm; not {start.grid.elements} over {start.grid.half_length}: "
            "give both scenes the same [grid]"
        )
    shape = grid.elements
    for name, field, wanted in (
        ("pressure", start.pressure, shape),
        ("traction", start.traction, (2, *shape)),
        ("approach", start.approach, ()),
        ("creepages", (start.xi_x, start.xi_y), (2,)),
    ):
        if np.shape(field) != wanted or not (np.abs(field) <= LARGEST).all():
            raise ValueError(f"start: its {name} are to be finite numbers of the shape {wanted}")


def _accurate(scene: Scene, measured: Gap | None, model_of: Callable[..., Model]) -> Contact:
    """New bodies on the mesh that their accuracy takes."""
    found = refined(with_tolerances(scene), measured, model_of)
    if not found.contact.converged or not found.missed:
        return found.contact
    return replace(found.contact, status=Status.INACCURATE, message=found.missed)


@one_blas_thread()
def roll(
    scene: Scene,
    path: str | PathLike | None = None,
    *,
    overwrite: bool = False,
    resume: bool = False,
    progress: Callable[[Record], None] | None = None,
    laws: Laws | None = None,
    solver: Solver | None = None,
    columns: Iterable[Quantity] = (),
) -> History:
    """Roll a scene through its revolutions; without [wear] that is revolution 0, the new bodies.

    Parameters
    ----------
    scene : Scene
        What is asked.
    path : path-like, optional
        Results file (HDF5), to which records are streamed as they are computed; without it they are
        kept in memory.
    overwrite : bool
        Whether a results file of this package may be replaced.
    resume : bool
        Whether to go on from the last record of the results file, if there is one: of a run that
        was killed or stopped, or of a finished one that is to be rolled further. The history is
        that of an uninterrupted run.
    progress : callable, optional
        Called with each record.
    laws, solver : Laws and Solver, optional
        As of `solve`.
    columns : iterable of Quantity, optional
        Columns to record beside the package's.

    Returns
    -------
    History
        All records. Where a contact was not solved the history ends with it, and `status` and
        `message` say so; of a scene with [accuracy] they also say where that was not reached.

    Raises
    ------
    TypeError
        If `scene` is no Scene, `laws` no Laws, or `solver` has no method `solve`.
    ValueError
        If there is no file to resume from.
    SceneError
        If no mesh can be chosen that holds the contact, or the memory does not suffice.
    ResultsError
        If the results file cannot be written, is being written by another run, or holds another
        scene than the one to resume.
    StorageError
        If the disk becomes full meanwhile; the file then holds the records up to some moment.
    GapError
        If the measured gap cannot be read.

    Examples
    --------
    >>> len(ts.roll(discs, progress=lambda record: print(record.revolution)))
    0
    1
    2
    3
    """
    began = perf_counter()
    _check_scene(scene)
    if resume and path is None:
        raise ValueError("resume: the path of a results file is needed to go on from")
    run = _Run(
        scene, path, overwrite or resume, progress, tuple(columns), began, _model_of(laws, solver)
    )
    if path is None:
        return _rolled(run)
    with results_writer(Path(path), overwrite or resume):  # before what may take long
        if not (resume and Path(path).exists()):
            return _rolled(run)
        before = open_history(path)
        return _rolled(run, last_passage(before, path, scene), before)


def _rolled(run: "_Run", last: Passage | None = None, before: History | None = None) -> History:
    """Roll from new bodies on, or from the last passage of a file that holds what was before."""
    scene = run.scene
    model = run.model_of(scene, measured_gap(scene), None if last is None else last.contact.grid)
    memory.check_roll(model, in_memory=run.path is None)
    if last is None or before is None:
        if scene.accuracy is not None:
            return _rolled_accurately(run)
        model, contact = fitted(model)
        return run.begun(model, Passage(0, contact, 1))
    if scene.accuracy is not None:
        return _resumed_accurately(run, last, before)
    return run.resumed(model, last, len(before))


def _rolled_accurately(run: "_Run") -> History:
    """Roll on finer and finer meshes, until the error bars are within the tolerance."""
    scene, measured = with_tolerances(run.scene), measured_gap(run.scene)
    new = refined(scene, measured, run.model_of)
    if scene.wear is None or not new.contact.converged:
        return run.begun(new.model, Passage(0, new.contact, 1), missed=new.missed)
    return _rolled_from(run, scene, measured, *judge_of(scene, measured, new.level, run.model_of))


def _rolled_from(
    run: "_Run", scene: Scene, measured: Gap | None, judge: Judge, level: int
) -> History:
    """Roll on the mesh of a level, and on finer ones while its error bars are too wide."""
    levels = Levels(scene, measured)
    while True:
        history = run.begun(*_new(run.model_of(scene, measured, levels.grid(level))), judge)
        if history.status != Status.INACCURATE or not levels.allowed(level + 1):
            return history
        run, judge, level = replace(run, overwrite=True), judge.followed(), level + 1


def _resumed_accurately(run: "_Run", last: Passage, before: History) -> History:
    """Roll on on the mesh of a file, and from new bodies on finer ones where that takes it."""
    scene, measured = with_tolerances(run.scene), measured_gap(run.scene)
    levels, missed = Levels(scene, measured), missed_before(before, scene)
    model = run.model_of(scene, measured, last.contact.grid)
    try:
        level = levels.of(last.contact.grid)
    except LookupError:
        raise ResultsError(
            f"{run.path} has a mesh that this version does not choose for the scene: resume it "
            "with the version that wrote it, or give the run a file of its own"
        ) from None
    complete = scene.wear is None or last.revolution == scene.wear.revolutions
    judge = None if complete else judge_on(scene, measured, level, missed, run.model_of)
    history = run.resumed(model, last, len(before), judge, missed)
    finer = scene.wear is not None and levels.allowed(level + 1)
    if history.status != Status.INACCURATE or not finer:
        return history
    judge = judge_on(scene, measured, level + 1, model_of=run.model_of)
    return _rolled_from(run, scene, measured, judge, level + 1)


def _new(model: Model) -> tuple[Model, Passage]:
    model, contact = fitted(model)
    return model, Passage(0, contact, 1)


@dataclass(frozen=True)
class _Run:
    """Rolls a scene and keeps the records, in a file or in memory; arguments as of `roll`.

    `began` is when that began, by `time.perf_counter`; `model_of` makes the models.
    """

    scene: Scene
    path: str | PathLike | None
    overwrite: bool
    progress: Callable[[Record], None] | None
    columns: tuple[Quantity, ...]
    began: float
    model_of: Callable[..., Model]

    def begun(
        self, model: Model, start: Passage, judge: Judge | None = None, missed: str = ""
    ) -> History:
        """Roll from the new bodies on; `missed` tells what is wrong with their accuracy."""
        writer = None
        if self.path is not None:
            writer = HistoryWriter(self.path, self.scene, model.grid, self.overwrite)
        return self._kept(model, start, (start,), writer, judge, missed)

    def resumed(
        self,
        model: Model,
        last: Passage,
        records: int,
        judge: Judge | None = None,
        missed: str = "",
    ) -> History:
        """Roll on from the last of a number of records in the file; arguments as of `begun`."""
        writer = HistoryWriter.reopen(self.path, self.scene, records)
        return self._kept(model, last, (), writer, judge, missed)

    def _kept(
        self,
        model: Model,
        start: Passage,
        first: Iterable[Passage],
        writer: HistoryWriter | None,
        judge: Judge | None = None,
        missed: str = "",
    ) -> History:
        records, passage, began = [], start, self.began
        with nullcontext() if writer is None else writer:
            for passage in chain(first, passages(model, start)):
                record = recorded(passage, model.laws, began, judge, self.columns)
                began = perf_counter()
                if writer is None:
                    records.append(record)
                else:
                    writer.append(record, passage.contact.grid, fields(passage.contact))
                if self.progress is not None:
                    self.progress(record)
                interrupt.heed()
            contact = passage.contact
            if judge is not None:
                missed = judge.missed
            status, message = _ended(passage, missed)
            if writer is not None:
                writer.finish(status, message)
                return open_history(self.path)
        end = {"status": status, "message": message}
        return History.of_records(records, self.scene, contact.grid, **end)


def _ended(passage: Passage, missed: str) -> tuple[str, str]:
    """Status and message of a history that ends with this passage."""
    contact = passage.contact
    if contact.converged and missed:
        return str(Status.INACCURATE), missed
    message = contact.message
    if contact.scene.wear is not None:
        message = f"revolution {passage.revolution}: {message}"
    return "done" if contact.converged else str(contact.status), message
