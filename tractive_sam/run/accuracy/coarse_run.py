"""The revolutions of a scene on coarser meshes, by which those on a finer one are judged."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import scipy  # its parts are loaded when first used

from tractive_sam.contact import Gap, Model
from tractive_sam.results import BodyFatigue, Maximum
from tractive_sam.rolling import LargestStress, Passage, process_of
from tractive_sam.run.accuracy.assessment import assess, worst_of
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
        """Take up the next sample."""
        self._revolutions.append(revolution)
        self._samples.append(sample)
        self._interpolator = None

    def at(self, revolution: int) -> Sample | None:
        """The sample of a revolution, interpolated over their logarithm; None beyond the last."""
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
        """Values, scales and residual, interpolated; fitted anew once samples were added."""
        if self._interpolator is None:
            rows = [[*s.values.values(), *s.scales.values(), s.residual] for s in self._samples]
            self._interpolator = scipy.interpolate.PchipInterpolator(
                np.log1p(self._revolutions), rows
            )
        return self._interpolator(at)


CoarseRuns = tuple[CoarseRun, ...]


class ErrorEstimator:
    """Gives the revolutions on one mesh their error bars, by their courses on two coarser ones.

    Parameters
    ----------
    coarse, middle : tuple of CoarseRun
        Of each block, on meshes of a quarter and of half the elements, complete.
    missed : str
        What was missed of revolutions rolled earlier; or empty.

    Attributes
    ----------
    middle : tuple of CoarseRun
        As given.
    fine : tuple of CoarseRun
        What was judged.
    missed : str
        Which error bar was last too wide at a saved revolution, and what to do; or empty.
    """

    def __init__(self, coarse: CoarseRuns, middle: CoarseRuns, missed: str = "") -> None:
        self._coarse, self.middle = coarse, middle
        self.fine = tuple(CoarseRun() for _ in middle)
        self.missed = missed

    def __call__(self, passage: Passage, block: int = 0) -> Mapping[str, Any]:
        """Error bars of a revolution, of the contact of a block."""
        contact, revolution = passage.contacts[block], passage.revolution
        if not contact.converged:
            return {}
        sample = Sample.of(contact, _maxima(passage, block), _cycled(passage))
        self.fine[block].add(revolution, sample)
        samples = (*(one[block].at(revolution) for one in (self._coarse, self.middle)), sample)
        assessment = assess(contact, samples, peak=revolution == 0)
        if assessment.missed and revolution in contact.scene.schedule:
            self.missed = f"revolution {revolution}: {assessment.missed}"
        return assessment.error_bars

    def refined(self) -> "ErrorEstimator":
        """The estimator of the next finer mesh."""
        return ErrorEstimator(self.middle, self.fine)


def from_level(
    scene: Scene,
    measured: Gap | None,
    level: int,
    missed: str = "",
    model_of: Callable[..., Model] = Model,
) -> ErrorEstimator:
    """Roll a scene on the two meshes that are coarser than that of a level.

    Parameters
    ----------
    scene : Scene
        With [accuracy], [wear] and the tolerances of `with_tolerances`.
    measured : Gap, optional
        Its measured separation.
    level : int
        The level to assess.
    missed : str
        As of `ErrorEstimator`.
    model_of : callable
        As of `refined`.
    """
    return ErrorEstimator(*_coarser(scene, measured, level, model_of), missed)


def choose_level(
    scene: Scene, measured: Gap | None, level: int, model_of: Callable[..., Model] = Model
) -> tuple[ErrorEstimator, int]:
    """Roll a scene on coarser meshes than the one that its accuracy takes.

    Parameters
    ----------
    scene : Scene
        With [accuracy], [wear] and the tolerances of `with_tolerances`.
    measured : Gap, optional
        Its measured separation.
    level : int
        Level of the mesh on which the unworn bodies are accurate enough.
    model_of : callable
        As of `refined`.

    Returns
    -------
    ErrorEstimator, int
        And the level of the mesh to assess: the first whose error bars may be narrow enough, by
        the difference between the two before it.
    """
    levels, last = Levels(scene, measured), scene.wear.revolutions
    coarse, middle = _coarser(scene, measured, level, model_of)
    while levels.allowed(level + 1):
        pairs = [(a.at(last), b.at(last)) for a, b in zip(coarse, middle, strict=True)]
        if all(before is not None and now is not None for before, now in pairs):
            least = max(
                worst_of(relative_error_bars(before, now, now), peak=False)[0]
                for before, now in pairs
            )
            if least <= scene.accuracy.tolerance:
                break
        coarse, middle = middle, _rolled(model_of(scene, measured, levels.grid(level)))
        level += 1
    return ErrorEstimator(coarse, middle), level


def _coarser(
    scene: Scene, measured: Gap | None, level: int, model_of: Callable[..., Model]
) -> tuple[CoarseRuns, CoarseRuns]:
    """The courses on the meshes of a quarter and of half the elements of a level."""
    levels = Levels(scene, measured)
    coarse, middle = (_rolled(model_of(scene, measured, levels.grid(level - k))) for k in (2, 1))
    return coarse, middle


def _rolled(model: Model) -> CoarseRuns:
    runs = tuple(CoarseRun() for _ in model.blocks)
    process, start = process_of(model).begin_fitted()
    for passage in process.steps(process.observe(start)):
        for k, (run, contact) in enumerate(zip(runs, passage.contacts, strict=True)):
            if contact.converged:
                sample = Sample.of(contact, _maxima(passage, k), _cycled(passage))
                run.add(int(passage.place), sample)
    return runs


def _cycled(passage: Passage) -> dict[str, BodyFatigue]:
    """What rolling has done to the bodies; blocks of a duty cycle have it in common."""
    if len(passage.contacts) > 1:
        return {}
    return {one.body: one for seen in passage.observed.values() for one in seen.cycles}


def _maxima(passage: Passage, block: int) -> Mapping[str, Maximum]:
    """Return the largest stresses in the contact of a block, as far as they are followed."""
    stress = passage.observed.get(LargestStress.name)
    return stress.maxima[block] if isinstance(stress, LargestStress) else {}
