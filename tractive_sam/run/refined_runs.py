"""Solve, roll and resume scenes with [accuracy] on meshes refined until the accuracy is reached."""

from collections.abc import Callable
from dataclasses import replace

from tractive_sam.contact import Gap, Model
from tractive_sam.results import History, State, Status
from tractive_sam.rolling import Step, start_passage
from tractive_sam.run.accuracy.assessment import describe_missed_accuracy
from tractive_sam.run.accuracy.coarse_run import ErrorBars, choose_level, from_level
from tractive_sam.run.accuracy.levels import Levels, set_tolerances
from tractive_sam.run.accuracy.steady import refine_unworn
from tractive_sam.run.recording import Recording
from tractive_sam.scene import Scene
from tractive_sam.store import ResultsError


def solve_to_accuracy(scene: Scene, measured: Gap | None, model_of: Callable[..., Model]) -> State:
    """Solve unworn bodies on refined meshes; return the contact, "inaccurate" if not reached."""
    refinement = refine_unworn(set_tolerances(scene), measured, model_of)
    if not refinement.contact.converged or not refinement.missed:
        return refinement.contact
    return replace(refinement.contact, status=Status.INACCURATE, note=refinement.missed)


def roll_to_accuracy(run: Recording) -> History:
    """Roll a scene with [accuracy] on meshes refined as needed; return the history."""
    scene = set_tolerances(run.scene)
    blocks = scene.spectrum.scenes if scene.spectrum else (scene,)
    refinements = [refine_unworn(block, run.measured, run.model_of) for block in blocks]
    unworn = max(refinements, key=lambda refinement: refinement.level)
    if not scene.schedule.end:
        process = run.process_of(unworn.model, ErrorBars(earlier_shortfall=unworn.missed))
        return run.begin(process, start_passage(unworn.model, (unworn.contact,)))[0]
    if not all(refinement.contact.converged for refinement in refinements):
        grid = Levels(scene, run.measured).grid(unworn.level)
        process = run.process_of(run.model_of(scene, run.measured, grid))
        return run.begin(*process.begin_fitted())[0]
    return _rolled_from(run, scene, *choose_level(scene, run.measured, unworn.level, run.model_of))


def _rolled_from(run: Recording, scene: Scene, bars: ErrorBars, level: int) -> History:
    """Roll on the mesh of a level, and on finer ones while error bars are too wide."""
    levels = Levels(scene, run.measured)
    while True:
        model = run.model_of(scene, run.measured, levels.grid(level))
        history, last = run.begin(*run.process_of(model, bars).begin_fitted())
        if history.status != Status.INACCURATE or not levels.allowed(level + 1):
            return history
        run, level = replace(run, overwrite=True), level + 1
        judged = last.observed[bars.name]
        assert isinstance(judged, ErrorBars)  # the name is its own
        bars = judged.next_finer()


def resume_to_accuracy(run: Recording, last: Step, before: History) -> History:
    """Resume on the mesh of a file, or roll again on finer ones; return the history."""
    scene, measured = set_tolerances(run.scene), run.measured
    levels, missed = Levels(scene, measured), describe_missed_accuracy(before, scene)
    model = run.model_of(scene, measured, last.contact.grid.shifted(0.0))
    try:
        level = levels.find_level(last.grid)
    except LookupError:
        raise ResultsError(
            f"{run.path} has a mesh that this version does not choose for the scene: resume it "
            "with the version that wrote it, or write this run to another file"
        ) from None
    bars = ErrorBars(earlier_shortfall=missed)
    if last.place != scene.schedule.end:
        bars = from_level(scene, measured, level, missed, run.model_of)
    last = replace(last, observed={**last.observed, bars.name: bars})
    history, _ = run.resume(run.process_of(model, bars), last, before)
    finer = bool(scene.schedule.end) and levels.allowed(level + 1)
    if history.status != Status.INACCURATE or not finer:
        return history
    bars = from_level(scene, measured, level + 1, model_of=run.model_of)
    return _rolled_from(run, scene, bars, level + 1)
