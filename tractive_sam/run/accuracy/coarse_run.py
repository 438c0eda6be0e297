"""Roll a scene on coarser meshes, to estimate the errors on a finer one."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy  # its parts are loaded when first used

from tractive_sam.contact import Gap, Model
from tractive_sam.results import State
from tractive_sam.rolling import LargestStress, Observer, process_of
from tractive_sam.run.accuracy.assessment import Assessment, assess, worst_error_bar
from tractive_sam.run.accuracy.error_bars import Sample, relative_error_bars
from tractive_sam.run.accuracy.levels import Levels
from tractive_sam.scene import Scene
from tractive_sam.schema import required


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

    def restore(self, step: Any, stored: Any) -> "ErrorBars":
        """Return the observer unchanged: nothing is stored, as the coarser meshes are rolled again.

        Parameters as in `Observer.restore`.
        """
        return self

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

    def next_finer(self) -> "ErrorBars":
        """Return the observer for the next finer mesh, with this run as the middle mesh."""
        return ErrorBars(self.middle, self.fine)

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
