"""Scenes with [accuracy], on finer and finer meshes while their error bars are too wide."""

from collections.abc import Callable
from dataclasses import replace

from tractive_sam.contact import Gap, Model
from tractive_sam.results import History, State, Status
from tractive_sam.rolling import Passage, begun
from tractive_sam.run.accuracy.assessment import missed_before
from tractive_sam.run.accuracy.coarse_run import ErrorEstimator, choose_level, from_level
from tractive_sam.run.accuracy.levels import Levels, with_tolerances
from tractive_sam.run.accuracy.steady import refined
from tractive_sam.run.recording import Recording
from tractive_sam.scene import Scene
from tractive_sam.store import ResultsError


def solved(scene: Scene, measured: Gap | None, model_of: Callable[..., Model]) -> State:
    """Unworn bodies on the mesh that their accuracy takes; arguments as of `refined`."""
    found = refined(with_tolerances(scene), measured, model_of)
    if not found.contact.converged or not found.missed:
        return found.contact
    return replace(found.contact, status=Status.INACCURATE, note=found.missed)


def rolled(run: Recording) -> History:
    """Roll from unworn bodies on."""
    scene = with_tolerances(run.scene)
    blocks = scene.spectrum.scenes if scene.spectrum else (scene,)
    each = [refined(one, run.measured, run.model_of) for one in blocks]
    unworn = max(each, key=lambda one: one.level)
    if not scene.schedule.end:
        start = begun(unworn.model, (unworn.contact,))
        return run.begun(run.process_of(unworn.model), start, missed=unworn.missed)
    if not all(one.contact.converged for one in each):
        grid = Levels(scene, run.measured).grid(unworn.level)
        process = run.process_of(run.model_of(scene, run.measured, grid))
        return run.begun(*process.begin_fitted())
    return _rolled_from(run, scene, *choose_level(scene, run.measured, unworn.level, run.model_of))


def _rolled_from(run: Recording, scene: Scene, estimator: ErrorEstimator, level: int) -> History:
    """Roll on the mesh of a level, and on finer ones while its error bars are too wide."""
    levels = Levels(scene, run.measured)
    while True:
        model = run.model_of(scene, run.measured, levels.grid(level))
        history = run.begun(*run.process_of(model).begin_fitted(), estimator)
        if history.status != Status.INACCURATE or not levels.allowed(level + 1):
            return history
        run, estimator, level = replace(run, overwrite=True), estimator.refined(), level + 1


def resumed(run: Recording, last: Passage, before: History) -> History:
    """Roll on on the mesh of a file, and from unworn bodies on finer ones where that takes it."""
    scene, measured = with_tolerances(run.scene), run.measured
    levels, missed = Levels(scene, measured), missed_before(before, scene)
    model = run.model_of(scene, measured, last.contact.grid.shifted(0.0))
    try:
        level = levels.of(last.grid)
    except LookupError:
        raise ResultsError(
            f"{run.path} has a mesh that this version does not choose for the scene: resume it "
            "with the version that wrote it, or give the run a file of its own"
        ) from None
    complete = last.place == scene.schedule.end
    estimator = None if complete else from_level(scene, measured, level, missed, run.model_of)
    history = run.resumed(run.process_of(model), last, before, estimator, missed)
    finer = bool(scene.schedule.end) and levels.allowed(level + 1)
    if history.status != Status.INACCURATE or not finer:
        return history
    estimator = from_level(scene, measured, level + 1, model_of=run.model_of)
    return _rolled_from(run, scene, estimator, level + 1)
