"""Solve, roll and resume scenes with [accuracy] on meshes refined until the accuracy is reached.

Unworn bodies are solved on finer and finer meshes; a roll has error bars from rolls on two coarser
meshes.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy

from tractive_sam.contact import Gap, Model, solve_on_fitted_mesh
from tractive_sam.results import Cost, History, State, Status
from tractive_sam.rolling import LargestStress, Observer, Step, process_of, start_passage
from tractive_sam.run.error_bars import (
    Assessment,
    Levels,
    Sample,
    assess,
    describe_missed_accuracy,
    relative_error_bars,
    set_tolerances,
    worst_error_bar,
)
from tractive_sam.run.recording import Recording
from tractive_sam.scene import Scene
from tractive_sam.schema import required
from tractive_sam.store import ResultsError
from tractive_sam.subsurface import fatigue, maxima_by_body


@dataclass(frozen=True)
class RefinedContact:
    """Contact of unworn bodies on the mesh that their accuracy needs, with its model and level.

    Attributes
    ----------
    model : Model
        The scene on that mesh.
    contact : State
        Its contact, with error bars; its cost includes all meshes.
    level : int
        Level of the mesh.
    missed : str
        Why the finest allowed mesh does not suffice; empty if it does.
    """

    model: Model
    contact: State
    level: int
    missed: str


def refine_unworn(
    scene: Scene, measured: Gap | None, model_of: Callable[..., Model] = Model
) -> RefinedContact:
    """Solve unworn bodies on finer meshes until the error bars, or the mesh limit, are reached.

    Parameters
    ----------
    scene : Scene
        Scene with [accuracy] and the tolerances of `set_tolerances`.
    measured : Gap, optional
        Measured separation of the scene.
    model_of : callable
        Makes the model of a scene, a measured separation and a mesh.
    """
    levels = Levels(scene, measured)
    samples: list[Sample | None] = []
    has_fatigue = scene.has("fatigue") and not scene.schedule.end
    cost, elements, level = Cost(), 1, Levels.first
    while True:
        model, (contact,) = solve_on_fitted_mesh(model_of(scene, measured, levels.grid(level)))
        before, elements = elements, math.prod(model.grid.elements)
        cost = contact.cost + cost.scaled(before / elements)
        # A contact of a few elements may fail although a finer one converges.
        sample = None
        if contact.converged:
            cycles = fatigue(contact, laws=model.laws) if has_fatigue else {}
            maxima = maxima_by_body(contact, model.laws)
            sample = Sample.from_contact(contact, maxima, cycles)
        samples.append(sample)
        assessment = assess(contact, samples, peak=True)
        if not assessment.missed or not levels.allowed(level + 1):
            contact = replace(contact, cost=cost, error_bars=assessment.error_bars)
            return RefinedContact(model, contact, level, assessment.missed)
        level += 1


@dataclass(frozen=True, eq=False)
class CoarseRun:
    """Samples of one contact over the revolutions of a run on one mesh.

    Attributes
    ----------
    revolutions : tuple of int
        Revolutions of the samples, ascending.
    samples : tuple of Sample
        One for each.
    """

    revolutions: tuple[int, ...] = ()
    samples: tuple[Sample, ...] = ()

    def with_sample(self, revolution: int, sample: Sample) -> "CoarseRun":
        """Return a copy of the run with the sample of a later revolution."""
        return CoarseRun((*self.revolutions, revolution), (*self.samples, sample))

    def at(self, revolution: int) -> Sample | None:
        """Return the sample at a revolution, interpolated; None beyond the last revolution.

        It is interpolated over log(1 + n).
        """
        if not self.revolutions or revolution > self.revolutions[-1]:
            return None
        if revolution in self.revolutions or len(self.revolutions) == 1:
            return self.samples[self.revolutions.index(revolution)]
        between = self._interpolator(np.log1p(revolution))
        names = self.samples[0].values
        values, scales = between[: len(names)], between[len(names) : -1]
        return Sample(
            dict(zip(names, values.tolist(), strict=True)),
            dict(zip(names, scales.tolist(), strict=True)),
            float(between[-1]),
        )

    @cached_property
    def _interpolator(self) -> "scipy.interpolate.PchipInterpolator":
        """Interpolator of values, scales and residual over the logarithm of the revolution."""
        rows = [[*s.values.values(), *s.scales.values(), s.residual] for s in self.samples]
        return scipy.interpolate.PchipInterpolator(np.log1p(self.revolutions), rows)


CoarseRuns = tuple[CoarseRun, ...]


@dataclass(frozen=True, eq=False)
class ErrorBars(Observer):
    """Observer of the error bars of every contact, by comparison with two coarser meshes.

    They are computed when they are recorded: a step that is tried and refused takes no time.

    Attributes
    ----------
    coarse, middle : tuple of CoarseRun
        For each block, on meshes of a quarter and of half the elements, complete. Without them
        contacts have the error bars that they were solved with.
    earlier : tuple of CoarseRun
        Samples of the steps before the last one.
    earlier_shortfall : str
        `shortfall` before the last step.
    step : Step, optional
        The last one.
    """

    coarse: CoarseRuns = ()
    middle: CoarseRuns = ()
    earlier: CoarseRuns = ()
    earlier_shortfall: str = ""
    step: Any = None

    name, key, unsolved = "error_bars", "accuracy", True

    def begin(self, step: Any, model: Model) -> "ErrorBars":
        """Return the observer with the first step as its last one."""
        return self.after(step, model)

    def after(self, step: Any, model: Model) -> "ErrorBars":
        """Return the observer with a new last step; its previous samples become `earlier`."""
        return replace(self, earlier=self.fine, earlier_shortfall=self.shortfall, step=step)

    def complete(self, contact: State, block: int) -> State:
        """Return the contact with its error bars; unchanged if there are no coarser runs."""
        if not self.middle:
            return contact
        assessment = self._assessments[block]
        return replace(contact, error_bars={} if assessment is None else assessment.error_bars)

    @property
    def shortfall(self) -> str:
        """Message on the last too wide error bar at a revolution to save; empty if there is none.

        It names the last error bar that was too wide at a saved revolution.
        """
        if self.step is None or self.step.place not in self.step.contact.scene.schedule:
            return self.earlier_shortfall
        missed = [
            sample.missed for sample in self._assessments if sample is not None and sample.missed
        ]
        if not missed:
            return self.earlier_shortfall
        return f"revolution {self.step.place:.0f}: {missed[-1]}"

    @cached_property
    def fine(self) -> CoarseRuns:
        """Samples of all steps of this run, for each block."""
        runs = self.earlier or tuple(CoarseRun() for _ in self.middle)
        return tuple(
            run if sample is None else run.with_sample(self.step.place, sample)
            for run, sample in zip(runs, self._samples, strict=True)
        )

    @cached_property
    def _samples(self) -> tuple[Sample | None, ...]:
        """Sample of each block in the last step; None for an unsolved contact."""
        if self.step is None:
            return (None,) * len(self.middle)
        return tuple(_sample(self.step, block) for block in range(len(self.middle)))

    @cached_property
    def _assessments(self) -> tuple[Assessment | None, ...]:
        """Assessment of each block in the last step; None for an unsolved contact."""
        return tuple(
            None if sample is None else self._assess(block, sample)
            for block, sample in enumerate(self._samples)
        )

    def _assess(self, block: int, sample: Sample) -> Assessment:
        """Return the error bars of a block's sample, from this revolution of coarser runs."""
        revolution = self.step.place
        samples = (self.coarse[block].at(revolution), self.middle[block].at(revolution), sample)
        return assess(self.step.contacts[block], samples, peak=revolution == 0)


def from_level(
    scene: Scene,
    measured: Gap | None,
    level: int,
    missed: str = "",
    model_of: Callable[..., Model] = Model,
) -> ErrorBars:
    """Roll a scene on the two next coarser meshes, and return the error-bar observer of a level.

    Parameters
    ----------
    scene : Scene
        Scene with [accuracy], [wear] and the tolerances of `set_tolerances`.
    measured : Gap, optional
        Measured separation of the scene.
    level : int
        The level to assess.
    missed : str
        Note on earlier revolutions that were not accurate enough; or empty.
    model_of : callable
        See `refine_unworn`.
    """
    return ErrorBars(*_roll_coarser(scene, measured, level, model_of), earlier_shortfall=missed)


def choose_level(
    scene: Scene, measured: Gap | None, level: int, model_of: Callable[..., Model] = Model
) -> tuple[ErrorBars, int]:
    """Roll on coarse meshes; return the `ErrorBars` observer and the level that likely suffices.

    Parameters
    ----------
    scene : Scene
        Scene with [accuracy], [wear] and the tolerances of `set_tolerances`.
    measured : Gap, optional
        Measured separation of the scene.
    level : int
        Level of the mesh on which the unworn bodies are accurate enough.
    model_of : callable
        See `refine_unworn`.

    Returns
    -------
    ErrorBars
        Error bars on that mesh.
    int
        Level of the mesh: the first with error bars that may be narrow enough, judged by the
        difference between the two meshes before it.
    """
    levels, last = Levels(scene, measured), required(scene.wear, "wear").revolutions
    tolerance = required(scene.accuracy, "accuracy").tolerance
    coarse, middle = _roll_coarser(scene, measured, level, model_of)
    while levels.allowed(level + 1):
        pairs = [
            (before, after)
            for a, b in zip(coarse, middle, strict=True)
            if (before := a.at(last)) is not None and (after := b.at(last)) is not None
        ]
        if len(pairs) == len(coarse):
            expected = max(
                worst_error_bar(relative_error_bars(before, after, after), peak=False)[0]
                for before, after in pairs
            )
            if expected <= tolerance:
                break
        coarse, middle = middle, _roll_mesh(model_of(scene, measured, levels.grid(level)))
        level += 1
    return ErrorBars(coarse, middle), level


def _roll_coarser(
    scene: Scene, measured: Gap | None, level: int, model_of: Callable[..., Model]
) -> tuple[CoarseRuns, CoarseRuns]:
    """Return the samples of runs on meshes with a quarter and with half the elements."""
    levels = Levels(scene, measured)
    coarse, middle = (_roll_mesh(model_of(scene, measured, levels.grid(level - k))) for k in (2, 1))
    return coarse, middle


def _roll_mesh(model: Model) -> CoarseRuns:
    """Roll a model, and return the samples of all its revolutions for each block."""
    runs = tuple(CoarseRun() for _ in model.blocks)
    process, start = process_of(model).begin_fitted()
    for step in process.steps(process.observe(start)):
        samples = (_sample(step, block) for block in range(len(runs)))
        runs = tuple(
            run if sample is None else run.with_sample(step.place, sample)
            for run, sample in zip(runs, samples, strict=True)
        )
    return runs


def _sample(step: Any, block: int) -> Sample | None:
    """Return the sample of a block after a step; None if its contact was not solved."""
    contact = step.contacts[block]
    if not contact.converged:
        return None
    stress = step.observed.get(LargestStress.name)
    maxima = stress.maxima[block] if isinstance(stress, LargestStress) else {}
    # Blocks of a duty cycle have their fatigue in common.
    cycles = (cycle for observer in step.observed.values() for cycle in observer.cycles)
    fatigue = {cycle.body: cycle for cycle in cycles} if len(step.contacts) == 1 else {}
    return Sample.from_contact(contact, maxima, fatigue)


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
        bars = ErrorBars(judged.middle, judged.fine)


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
