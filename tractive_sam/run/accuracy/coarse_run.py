"""Roll a scene on coarser meshes, to estimate the errors on a finer one."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import scipy  # its parts are loaded when first used

from tractive_sam.contact import Gap, Model
from tractive_sam.results import BodyFatigue, Maximum
from tractive_sam.rolling import LargestStress, Passage, process_of
from tractive_sam.run.accuracy.assessment import assess, worst_error_bar
from tractive_sam.run.accuracy.error_bars import Sample, relative_error_bars
from tractive_sam.run.accuracy.levels import Levels
from tractive_sam.scene import Scene


class CoarseRun:
    """Samples of a scene over its revolutions on one mesh."""

    def __init__(self) -> None:
        self._revolutions: list[int] = []
        self._samples: list[Sample] = []
        self._interpolator: scipy.interpolate.PchipInterpolator | None = None

    def add(self, revolution: int, sample: Sample) -> None:
        """Append the sample of the next revolution."""
        self._revolutions.append(revolution)
        self._samples.append(sample)
        self._interpolator = None

    def at(self, revolution: int) -> Sample | None:
        """Return the sample of a revolution, interpolated over log(1 + n); None beyond the last."""
        if not self._revolutions or revolution > self._revolutions[-1]:
            return None
        if revolution in self._revolutions or len(self._revolutions) == 1:
            return self._samples[self._revolutions.index(revolution)]
        between = self._between(np.log1p(revolution))
        names = self._samples[0].values
        values, scales = between[: len(names)], between[len(names) : -1]
        return Sample(
            dict(zip(names, values.tolist(), strict=True)),
            dict(zip(names, scales.tolist(), strict=True)),
            float(between[-1]),
        )

    def _between(self, at: float) -> np.ndarray:
        """Interpolate values, scales and residual, in this order; fit again after new samples."""
        if self._interpolator is None:
            rows = [[*s.values.values(), *s.scales.values(), s.residual] for s in self._samples]
            self._interpolator = scipy.interpolate.PchipInterpolator(
                np.log1p(self._revolutions), rows
            )
        return self._interpolator(at)


CoarseRuns = tuple[CoarseRun, ...]


class ErrorEstimator:
    """Estimates the error bars of revolutions on one mesh from the revolutions on two coarser ones.

    Parameters
    ----------
    coarse, middle : tuple of CoarseRun
        Complete runs of each block, on meshes of a quarter and of half the elements.
    missed : str
        Note on earlier revolutions that were not accurate enough; or empty.

    Attributes
    ----------
    middle : tuple of CoarseRun
        The runs on half the elements.
    fine : tuple of CoarseRun
        Samples of the revolutions estimated so far.
    missed : str
        Which error bar was last too wide at a saved revolution, and what to do; or empty.
    """

    def __init__(self, coarse: CoarseRuns, middle: CoarseRuns, missed: str = "") -> None:
        self._coarse, self.middle = coarse, middle
        self.fine = tuple(CoarseRun() for _ in middle)
        self.missed = missed

    def __call__(self, passage: Passage, block: int = 0) -> Mapping[str, Any]:
        """Return the error bars of a revolution, for the contact of a block."""
        contact, revolution = passage.contacts[block], passage.revolution
        if not contact.converged:
            return {}
        sample = Sample.of(contact, _maxima(passage, block), _fatigue_by_body(passage))
        self.fine[block].add(revolution, sample)
        coarser = (runs[block].at(revolution) for runs in (self._coarse, self.middle))
        samples = (*coarser, sample)
        assessment = assess(contact, samples, peak=revolution == 0)
        if assessment.missed and revolution in contact.scene.schedule:
            self.missed = f"revolution {revolution}: {assessment.missed}"
        return assessment.error_bars

    def next_finer(self) -> "ErrorEstimator":
        """Return the estimator of the next finer mesh."""
        return ErrorEstimator(self.middle, self.fine)


def from_level(
    scene: Scene,
    measured: Gap | None,
    level: int,
    missed: str = "",
    model_of: Callable[..., Model] = Model,
) -> ErrorEstimator:
    """Roll a scene on the two meshes coarser than a level, and return the estimator for that level.

    Parameters
    ----------
    scene : Scene
        Scene with [accuracy], [wear] and the tolerances of `set_tolerances`.
    measured : Gap, optional
        Its measured separation.
    level : int
        The level to assess.
    missed : str
        See `ErrorEstimator`.
    model_of : callable
        See `refine_unworn`.
    """
    return ErrorEstimator(*_roll_coarser(scene, measured, level, model_of), missed)


def choose_level(
    scene: Scene, measured: Gap | None, level: int, model_of: Callable[..., Model] = Model
) -> tuple[ErrorEstimator, int]:
    """Find the mesh on which a rolled scene is probably accurate enough.

    Parameters
    ----------
    scene : Scene
        Scene with [accuracy], [wear] and the tolerances of `set_tolerances`.
    measured : Gap, optional
        Its measured separation.
    level : int
        Level of the mesh on which the unworn bodies are accurate enough.
    model_of : callable
        See `refine_unworn`.

    Returns
    -------
    ErrorEstimator
        Estimator for that mesh.
    int
        Level of the mesh: the first whose error bars may be narrow enough, judged by the
        difference between the two meshes before it.
    """
    levels, last = Levels(scene, measured), scene.wear.revolutions
    coarse, middle = _roll_coarser(scene, measured, level, model_of)
    while levels.allowed(level + 1):
        pairs = [(a.at(last), b.at(last)) for a, b in zip(coarse, middle, strict=True)]
        if all(before is not None and after is not None for before, after in pairs):
            expected = max(
                worst_error_bar(relative_error_bars(before, after, after), peak=False)[0]
                for before, after in pairs
            )
            if expected <= scene.accuracy.tolerance:
                break
        coarse, middle = middle, _roll_mesh(model_of(scene, measured, levels.grid(level)))
        level += 1
    return ErrorEstimator(coarse, middle), level


def _roll_coarser(
    scene: Scene, measured: Gap | None, level: int, model_of: Callable[..., Model]
) -> tuple[CoarseRuns, CoarseRuns]:
    """Roll on the meshes of a quarter and of half the elements of a level."""
    levels = Levels(scene, measured)
    coarse, middle = (_roll_mesh(model_of(scene, measured, levels.grid(level - k))) for k in (2, 1))
    return coarse, middle


def _roll_mesh(model: Model) -> CoarseRuns:
    runs = tuple(CoarseRun() for _ in model.blocks)
    process, start = process_of(model).begin_fitted()
    for passage in process.steps(process.observe(start)):
        for k, (run, contact) in enumerate(zip(runs, passage.contacts, strict=True)):
            if contact.converged:
                sample = Sample.of(contact, _maxima(passage, k), _fatigue_by_body(passage))
                run.add(int(passage.place), sample)
    return runs


def _fatigue_by_body(passage: Passage) -> dict[str, BodyFatigue]:
    """Return the fatigue of each body; {} for a duty cycle, in which blocks share it."""
    if len(passage.contacts) > 1:
        return {}
    return {cycle.body: cycle for seen in passage.observed.values() for cycle in seen.cycles}


def _maxima(passage: Passage, block: int) -> Mapping[str, Maximum]:
    """Return the largest stresses in the contact of a block, if they are recorded."""
    stress = passage.observed.get(LargestStress.name)
    return stress.maxima[block] if isinstance(stress, LargestStress) else {}
