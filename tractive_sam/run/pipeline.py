"""From a scene to its results: the two front doors, `solve` and `roll`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from os import PathLike
from pathlib import Path
from time import perf_counter

from numpy.typing import ArrayLike

from tractive_sam.contact import Laws, check_jacobian, equilibrium, fitted, jacobian_of
from tractive_sam.operators import one_blas_thread
from tractive_sam.results import History, NotConverged, Quantity, Record, State
from tractive_sam.rolling import Observer
from tractive_sam.run import accurately, given, memory
from tractive_sam.run.gap_notes import warn_of_gap
from tractive_sam.run.given import measured_gap
from tractive_sam.run.progress import progress_shown, solving_shown
from tractive_sam.run.recording import Recording
from tractive_sam.run.resume import check_measured, check_observed, damaged, last_step
from tractive_sam.run.start import started_as, told_of, worn_bodies
from tractive_sam.scene import Scene, pressure_notes
from tractive_sam.schema import PlausibilityWarning, warn
from tractive_sam.solvers import Solver
from tractive_sam.store import open_history, results_writer


@one_blas_thread()
def solve(
    scene: Scene,
    *,
    wear: ArrayLike | None = None,
    start: State | None = None,
    throw: bool = True,
    laws: Laws | None = None,
    solver: Solver | None = None,
    jacobian: bool = False,
    progress: bool | None = None,
) -> State:
    """Solve one steady state of a scene.

    Parameters
    ----------
    scene : Scene
        What is asked; its [wear] and [[duty]] are not rolled, see `roll`.
    wear : array_like, shape (n_x, n_y), optional
        Depth worn off both bodies together, mm.
    start : State, optional
        State of a similar scene on the same mesh, as first guess.
    throw : bool
        Whether to raise where the solve did not converge.
    laws : Laws, optional
        Laws of friction and wear in place of the scene's.
    solver : Solver, optional
        Method in place of the scene's: any object with `solve(problem, tolerance, start)`, see
        `solvers`.
    jacobian : bool
        Whether to compute the derivatives of forces and approach as well, `State.jacobian`: a
        linear system for each parameter. Needs xarray, which comes with the extra ``study``.
    progress : bool, optional
        True for a bar, False for none. By default a bar in a terminal or a notebook, of what takes
        longer than two seconds.

    Returns
    -------
    State
        Fields, resultants, residual and cost; of a scene with [accuracy], without `wear` or
        `start`, on the mesh that it takes, and with error bars.

    Raises
    ------
    TypeError
        If `scene` is no Scene, `start` no State, `laws` no Laws, or `solver` has no method
        `solve`.
    ValueError
        If `wear` or `start` do not fit the mesh, or are not finite; or a Jacobian is asked for
        without friction.
    ImportError
        If a Jacobian is asked for without xarray.
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
    given.check_scene(scene)
    scene = scene.without_blocks
    model_of = given.model_of(laws, solver)
    measured = measured_gap(scene)
    model = model_of(scene, measured)
    memory.check_solve(model)
    if jacobian:
        check_jacobian(model)
    if wear is not None:
        wear = given.depths_of(wear, model.grid)
    if start is not None:
        given.check_start(start, model.grid)
    with solving_shown(progress):
        if start is not None or wear is not None:
            contact = equilibrium(model, wear, start)
        elif scene.accuracy is not None:
            contact = accurately.solved(scene, measured, model_of)
        else:
            _, contact = fitted(model)
    if measured is not None:
        warn_of_gap(model_of(scene, measured, contact.grid))
    contact = _checked(contact, throw)
    if jacobian and contact.converged:  # on the mesh that it was solved on
        model = model_of(scene, measured, contact.grid)
        return replace(contact, jacobian=jacobian_of(model, contact))
    return contact


def _checked(contact: State, throw: bool) -> State:
    x, y = contact.p_max_at
    for note in pressure_notes(contact.scene, contact.p_max, f" at ({x:.3g}, {y:.3g}) mm"):
        warn(f"p_max: {note}", PlausibilityWarning)
    if throw and not contact.converged:
        raise NotConverged(contact)
    return contact


@one_blas_thread()
def roll(
    scene: Scene,
    path: str | PathLike | None = None,
    *,
    start: History | State | None = None,
    overwrite: bool = False,
    resume: bool = False,
    progress: bool | Callable[[Record], None] | None = None,
    laws: Laws | None = None,
    solver: Solver | None = None,
    columns: Iterable[Quantity] = (),
    observers: Iterable[Observer] = (),
) -> History:
    """Roll a scene through its revolutions; without [wear] that is revolution 0, the unworn bodies.

    Parameters
    ----------
    scene : Scene
        What is asked.
    path : path-like, optional
        Results file (HDF5), to which records are streamed as they are computed; without it they are
        kept in memory.
    start : History or State, optional
        What was rolled before by the same bodies, under another load, say: they begin as its last
        record left them, and revolutions count anew. What was worn before is in the wear depths,
        volumes and masses, and `History.started` says where it is from. A flat body begins unworn.
        Where the mesh is another one, depths are interpolated.
    overwrite : bool
        Whether a results file of this package may be replaced.
    resume : bool
        Whether to go on from the last record of the results file, if there is one: of a run that
        was killed or stopped, or of a finished one that is to be rolled further. The history is
        that of an uninterrupted run.
    progress : bool or callable, optional
        Called with each record; True for a bar, False for none. By default a bar in a terminal or
        a notebook, of what takes longer than two seconds.
    laws, solver : Laws and Solver, optional
        As of `solve`.
    columns : iterable of Quantity, optional
        Columns to record beside the package's; nan in records that were resumed without them.
    observers : iterable of Observer, optional
        What is to follow the steps besides the observers of the scene.

    Returns
    -------
    History
        All records. Where a contact was not solved the history ends with it, and `status` and
        `message` say so; of a scene with [accuracy] they also say where that was not reached.

    Raises
    ------
    TypeError
        If `scene` is no Scene, `start` neither History nor State, `laws` no Laws, `columns` no
        Quantities, `observers` no Observers, or `solver` has no method `solve`.
    ValueError
        If there is no file to resume from, or a column or an observer has a name or dimensions that
        cannot be.
    SceneError
        If no mesh can be chosen that holds the contact, or the memory does not suffice.
    ResultsError
        If the results file cannot be written, is being written by another run, or holds another
        scene than the one to resume, or other laws; or `start` is of other bodies.
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
    >>> heavier = ts.roll(discs.replace(**{"load.normal": 400.0}), start=history)
    >>> bool(heavier["wear_max"][0] > 0.9 * history["wear_max"][-1])
    True
    """
    began = perf_counter()
    given.check_scene(scene)
    if resume and path is None:
        raise ValueError("resume: the path of a results file is needed to go on from")
    own = given.columns_of(columns, laws)
    worn, started = (None, "") if start is None else (worn_bodies(start, scene), told_of(start))
    replaced = overwrite or resume
    kept = nullcontext() if path is None else results_writer(Path(path), replaced)  # at once
    with kept, progress_shown(scene, progress) as called:
        before = open_history(path) if resume and Path(path).exists() else None
        if before is not None and len(before):
            worn, started = started_as(before, path, started), before.started
        model_of, gap = given.model_of(laws, solver, worn), measured_gap(scene)
        found = None if before is None else last_step(before, path, scene, laws, own, gap)
        last = None if found is None else found[0]
        datum = "vertex" if found is None or before is None else before.datum
        model_of = partial(model_of, profiles=given.travelling(scene), datum=datum)
        about = (own, began, started, tuple(observers))
        run = Recording(scene, gap, model_of, path, replaced, called, *about)
        grid = None if last is None else last.grid
        model = model_of(scene, run.measured, grid)
        memory.check_roll(model, in_memory=path is None)
        process = run.process_of(model)
        if found is None or before is None:
            accurate = scene.has("accuracy")
            return accurately.rolled(run) if accurate else run.begun(*process.begin_fitted())
        check_measured(before, path, given.hash_of(model))
        check_observed(before, path, process.following)
        with damaged(path, found[1].row):
            last = process.adopt(*found)
        if scene.has("accuracy"):
            return accurately.resumed(run, last, before)
        return run.resumed(process, last, before)
