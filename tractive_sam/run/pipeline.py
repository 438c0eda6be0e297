"""The entry points from a scene to its results: `solve`, `roll` and `wear_profiles`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from os import PathLike
from pathlib import Path
from time import perf_counter
from typing import Any

from numpy.typing import ArrayLike

from tractive_sam.compute import numeric_settings
from tractive_sam.contact import (
    Laws,
    check_jacobian,
    equilibrium,
    jacobian_of,
    solve_on_fitted_mesh,
)
from tractive_sam.results import History, NotConverged, Quantity, Record, State, WornProfiles
from tractive_sam.rolling import Observer, Step, StoredStep
from tractive_sam.run import inputs, memory, refined_runs
from tractive_sam.run.inputs import read_measured_gap, warn_of_gap
from tractive_sam.run.progress import show_roll_progress, show_solving
from tractive_sam.run.recording import Recording
from tractive_sam.run.resume import (
    check_measured,
    check_observers_in_file,
    check_start_of_file,
    describe_origin,
    last_step,
    report_damage,
    use_stored_files,
    worn_bodies,
)
from tractive_sam.scene import Scene, pressure_notes
from tractive_sam.schema import Fault, PlausibilityWarning, SceneError, required, warn
from tractive_sam.solvers import ProblemSolver
from tractive_sam.store import open_history, results_writer


@numeric_settings()
def solve(
    scene: Scene,
    *,
    wear: ArrayLike | None = None,
    start: State | None = None,
    throw: bool = True,
    laws: Laws | None = None,
    solver: ProblemSolver | None = None,
    jacobian: bool = False,
    progress: bool | None = None,
) -> State:
    """Solve a steady contact of a scene; raise NotConverged if it fails, unless `throw` is False.

    Parameters
    ----------
    scene : Scene
        Scene to solve; its [wear] and [[duty]] are not rolled, see `roll`.
    wear : array_like, shape (n_x, n_y), optional
        Depth worn off both bodies together, mm.
    start : State, optional
        State of a similar scene on an equal mesh, as initial guess.
    throw : bool
        Whether to raise an error if the solve did not converge.
    laws : Laws, optional
        Laws of friction and wear in place of the scene's.
    solver : ProblemSolver, optional
        Method in place of the scene's: any object with `solve(problem, tolerance, start)`, see
        `solvers`.
    jacobian : bool
        Whether to compute the derivatives of forces and approach as well, `State.jacobian`: a
        linear system for each parameter. Needs xarray, which comes with the extra ``study``.
    progress : bool, optional
        True shows a progress bar, False none. By default a bar appears in a terminal or a notebook
        after two seconds.

    Returns
    -------
    State
        Fields, resultants, residual and cost. With [accuracy], and without `wear` and `start`, the
        mesh is refined until the accuracy is reached, and the state has error bars.

    Raises
    ------
    TypeError
        If `scene` is not a Scene, `start` not a State, `laws` not a Laws, or `solver` has no
        method `solve`.
    ValueError
        If `wear` or `start` do not fit the mesh or are not finite, or `jacobian` is True without
        friction.
    ImportError
        If `jacobian` is True and xarray is not installed.
    SceneError
        If no mesh can be chosen that holds the contact, or the memory does not suffice.
    GapError
        If the measured gap cannot be read.
    NotConverged
        If `throw` is True, and the contact conditions do not hold to the scene's tolerance or the
        [accuracy] was not reached.

    Examples
    --------
    >>> ts.solve(scene).message
    'contact conditions hold to ...'
    >>> faster = ts.solve(scene.replace(**{"creepage.longitudinal": -0.002}), start=contact)
    >>> faster.Qx < contact.Qx
    True
    """
    inputs.check_scene(scene)
    scene = scene.with_current_files().without_blocks
    model_of = inputs.model_of(laws, solver)
    measured = read_measured_gap(scene)
    model = model_of(scene, measured)
    memory.check_solve(model)
    if jacobian:
        check_jacobian(model)
    if wear is not None:
        wear = inputs.depths_of(wear, model.grid)
    if start is not None:
        inputs.check_start(start, model.grid)
    with show_solving(progress):
        if start is not None or wear is not None:
            contact = equilibrium(model, wear, start)
        elif scene.accuracy is not None:
            contact = refined_runs.solve_to_accuracy(scene, measured, model_of)
        else:
            _, (contact,) = solve_on_fitted_mesh(model)
    if measured is not None:
        warn_of_gap(model_of(scene, measured, contact.grid))
    contact = _warn_or_raise(contact, throw)
    if jacobian and contact.converged:  # on the mesh of the solution
        model = model_of(scene, measured, contact.grid)
        if model.finds_pitch:
            patch = required(model.patch, "wheel")
            model = model.at_pitch(patch.pitch_at(contact.xi_x))
        return replace(contact, jacobian=jacobian_of(model, contact))
    return contact


def _warn_or_raise(contact: State, throw: bool) -> State:
    """Return a contact; warn of implausible pressure; if `throw`, raise if it is not solved."""
    x, y = contact.p_max_at
    for note in pressure_notes(contact.scene, contact.p_max, f" at ({x:.3g}, {y:.3g}) mm"):
        warn(f"p_max: {note}", PlausibilityWarning)
    if throw and not contact.converged:
        raise NotConverged(contact)
    return contact


@numeric_settings()
def roll(
    scene: Scene,
    path: str | PathLike | None = None,
    *,
    start: History | State | None = None,
    overwrite: bool = False,
    resume: bool = False,
    progress: bool | Callable[[Record], None] | None = None,
    laws: Laws | None = None,
    solver: ProblemSolver | None = None,
    columns: Iterable[Quantity] = (),
    observers: Iterable[Observer] = (),
) -> History:
    """Roll a scene through its revolutions, steps or blocks; return the history, solved or not.

    Parameters
    ----------
    scene : Scene
        Scene to roll.
    path : path-like, optional
        Results file (HDF5), to which each record is written once it is computed; without it the
        records stay in memory.
    start : History or State, optional
        Earlier results for these bodies, under another load for example. The bodies begin as its
        last record left them; revolutions are counted from 0 again. Wear depths, volumes and masses
        include the earlier wear, and `History.started` names its source. A flat body begins unworn.
        On another mesh the depths are interpolated.
    overwrite : bool
        Whether to replace a results file of this package.
    resume : bool
        Whether to continue from the last record of the results file, if it exists. The run may have
        been killed or stopped, or is to be rolled further. The history equals an uninterrupted
        run's.
    progress : bool or callable, optional
        Function to call with each record. True shows a progress bar, False none. By default a bar
        appears in a terminal or a notebook after two seconds.
    laws, solver : Laws and ProblemSolver, optional
        See `solve`.
    columns : iterable of Quantity, optional
        Columns to record in addition to the package's; nan in records from before.
    observers : iterable of Observer, optional
        Observers of the steps, in addition to the scene's.

    Returns
    -------
    History
        All records. If a contact was not solved, the history ends with it, and `status` and
        `message` report it. They also report an [accuracy] that was not reached.

    Raises
    ------
    TypeError
        If `scene` is not a Scene, `start` neither History nor State, `laws` not a Laws, `columns`
        not Quantities, `observers` not Observers, or `solver` has no method `solve`.
    ValueError
        If there is no file to resume from, or a column or an observer has a name or dimensions that
        are not allowed.
    SceneError
        If no mesh can be chosen that holds the contact, or the memory does not suffice.
    ResultsError
        If the results file cannot be written, is being written by another run, or holds another
        scene or other laws than the run to resume; or `start` has other bodies.
    StorageError
        If the disk becomes full; the file then holds the records up to some moment.
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
    inputs.check_scene(scene)
    file = None if path is None else Path(path)
    if resume and file is None:
        raise ValueError("resume: there is no file to resume from; set path to a results file")
    user_columns = inputs.check_columns(columns, laws)
    worn, started = (
        (None, "") if start is None else (worn_bodies(start, scene), describe_origin(start))
    )
    replaced = overwrite or resume
    output = nullcontext() if file is None else results_writer(file, replaced)
    with output, show_roll_progress(scene, progress) as called:
        before = open_history(file) if resume and file is not None and file.exists() else None
        with use_stored_files(before):
            scene = scene.with_current_files()
        gap, stored = read_measured_gap(scene), None
        if before is not None and file is not None:
            if len(before):
                worn, started = check_start_of_file(before, file, started), before.started
            stored = last_step(before, file, scene, laws, user_columns, gap)
        model_of = partial(
            inputs.model_of(laws, solver, worn),
            profiles=inputs.read_profiles(scene),
            datum="vertex" if stored is None else stored[1].history.datum,
        )
        about = (user_columns, began, started, tuple(observers))
        run = Recording(scene, gap, model_of, file, replaced, called, *about)
        return _begin(run) if stored is None else _continue(run, *stored)


def _begin(run: Recording) -> History:
    """Roll a run from its first step, and return the history."""
    model = run.model_of(run.scene, run.measured)
    memory.check_roll(model, in_memory=run.path is None)
    process = run.process_of(model)
    if run.scene.has("accuracy"):
        return refined_runs.roll_to_accuracy(run)
    return run.begin(*process.begin_fitted())[0]


def _continue(run: Recording, last: Step, stored: StoredStep) -> History:
    """Roll a run from the last step of a results file, and return the history."""
    before, path = stored.history, required(run.path, "path")
    model = run.model_of(run.scene, run.measured, last.grid)
    memory.check_roll(model, in_memory=False)
    process = run.process_of(model)
    check_measured(before, path, inputs.hash_measurements(model))
    check_observers_in_file(before, path, process.following)
    with report_damage(path, stored.row):
        last = process.adopt(last, stored)
    if run.scene.has("accuracy"):
        return refined_runs.resume_to_accuracy(run, last, before)
    return run.resume(process, last, before)[0]


def wear_profiles(
    scene: Scene, path: str | PathLike[str] | None = None, **options: Any
) -> WornProfiles:
    """Roll a wheel on a rail with wear; return the worn profiles, raise if the roll failed.

    Material is removed along the normals of both profiles, without any smoothing. Each block of
    [[duty]] is a position of the wheelset with its share in the revolutions.

    Parameters
    ----------
    scene : Scene
        Scene with [wheel], [rail], [wheelset] and [wear].
    path : path-like, optional
        Results file, as for `roll`.
    **options
        Other arguments of `roll`.

    Raises
    ------
    SceneError
        If the scene has no wheel or no wear, or worn profiles have no contact.
    RuntimeError
        If a contact is not solved; the message of the history.

    Examples
    --------
    >>> scene = ts.Scene.builtin("wheel-wear").with_set(["wear.revolutions=1000"])
    >>> worn = ts.wear_profiles(scene)
    >>> round(float(worn.revolutions[-1]))
    1000
    """
    require_wear(scene)
    history = roll(scene, path, **options)
    if not history.finished:
        raise RuntimeError(history.message)
    return WornProfiles.from_history(history)


def require_wear(scene: Scene) -> None:
    """Raise a SceneError unless a scene has [wheelset] and [wear]."""
    for name in ("wheelset", "wear"):
        if getattr(scene, name) is None:
            raise SceneError([Fault(name, "nothing", f"a [{name}] table, to wear profiles")])
