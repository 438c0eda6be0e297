"""Rolls a scene and keeps its records, in a file or in memory."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import chain
from os import PathLike
from time import perf_counter
from types import TracebackType
from typing import Any, Self

import numpy as np

from tractive_sam import interrupt
from tractive_sam.contact import Gap, Model
from tractive_sam.results import (
    Grid,
    History,
    LawRecord,
    Quantity,
    Record,
    Status,
    caveats,
)
from tractive_sam.rolling import ErrorEstimator, Observer, Process, Recorder, Step, process_of
from tractive_sam.run.gap_notes import warn_of_gap
from tractive_sam.run.given import check_observers, hash_of
from tractive_sam.scene import Scene
from tractive_sam.schema import PlausibilityWarning, warn
from tractive_sam.store import HistoryWriter, open_history


@dataclass(frozen=True, eq=False)
class Recording:
    """Rolls a scene and keeps the records.

    Parameters
    ----------
    scene : Scene
        What is rolled.
    measured : Gap, optional
        Its measured separation.
    model_of : callable
        Makes the model of a scene, a measured separation and a mesh.
    path : path-like, optional
        Results file; without it records are kept in memory.
    overwrite : bool
        Whether a results file may be replaced.
    progress : callable, optional
        Called with each record.
    columns : tuple of Quantity
        Columns beside the package's.
    began : float
        When the first record began, by `time.perf_counter`.
    started : str
        As of `History`.
    observers : tuple of Observer
        Observers besides those of the scene.
    """

    scene: Scene
    measured: Gap | None
    model_of: Callable[..., Model]
    path: str | PathLike | None
    overwrite: bool
    progress: Callable[[Record], None] | None
    columns: tuple[Quantity, ...]
    began: float
    started: str = ""
    observers: tuple[Observer, ...] = ()

    def process_of(self, model: Model) -> Process[Any]:
        """Return the process of a model, followed by all observers.

        Raises
        ------
        TypeError, ValueError
            As by `check_observers`.
        """
        process = process_of(model, self.observers)
        check_observers(process.following, self.columns)
        return process

    def begun(
        self,
        process: Process,
        start: Step,
        estimator: ErrorEstimator | None = None,
        missed: str = "",
    ) -> History:
        """Roll from the first step on; `missed` tells what is wrong with their accuracy."""
        model = process.model
        laws = model.laws.differences_from(model.scene)
        warn_of_gap(model)
        _warn_beyond_tests(model, start)
        keeper: HistoryWriter | _InMemory = _InMemory(self.scene, laws, self.started)
        if self.path is not None:
            about = {"laws": laws, "started": self.started, "measured": hash_of(model)}
            about["coordinate"] = process.coordinate
            keeper = HistoryWriter(self.path, self.scene, model.grid, self.overwrite, **about)
        start = process.observe(start)
        return self._kept(keeper, process, start, (start,), estimator, missed)

    def resumed(
        self,
        process: Process,
        last: Step,
        before: History,
        estimator: ErrorEstimator | None = None,
        missed: str = "",
    ) -> History:
        """Roll on from the last record of a file that holds `before`; arguments as of `begun`."""
        warn_of_gap(process.model)
        keeper = HistoryWriter.reopen(self.path, self.scene, len(before))
        widest = np.nanmax([before[name] for name in _HALF_WIDTHS], axis=1, initial=0.0)
        return self._kept(keeper, process, last, (), estimator, missed, widest)

    def _kept(
        self,
        keeper: "HistoryWriter | _InMemory",
        process: Process,
        start: Step,
        first: Iterable[Step],
        estimator: ErrorEstimator | None,
        missed: str,
        widest: np.ndarray | tuple[float, float] = (0.0, 0.0),
    ) -> History:
        step, began = start, self.began
        recorder = Recorder(estimator, self.columns, self.measured)
        with keeper:
            for step in chain(first, process.steps(start)):
                told = process.record(step, recorder)
                told = replace(told, values={**told.values, "seconds": perf_counter() - began})
                began = perf_counter()
                state = process.state(step) if step.continues else None
                keeper.append(told, step.grid, state)
                widest = np.fmax(widest, [told.values[name] for name in _HALF_WIDTHS])
                if self.progress is not None:
                    self.progress(told)
                interrupt.raise_if_interrupted()
            missed = missed if estimator is None else estimator.missed
            status, message = process.end(step, np.asarray(widest))
            if step.converged and missed:
                status, message = str(Status.INACCURATE), missed
            keeper.finish(status, message)
        history = keeper.history if self.path is None else open_history(self.path)
        if note := caveats(history).get("p_max"):
            warn(f"p_max: {note}", PlausibilityWarning)
        return history


def _warn_beyond_tests(model: Model, start: Step) -> None:
    """Note what of the first contacts the coefficients of wear were not measured for."""
    for k, (block, contact) in enumerate(zip(model.blocks, start.contacts, strict=True)):
        if block.wear_law is not None and contact.converged:
            fields = contact.pressure, contact.traction, contact.slip
            if told := block.wear_law.beyond_tests(*fields):
                key = f"wear.law: duty block {k + 1}" if len(model.blocks) > 1 else "wear.law"
                warn(f"{key}: {told}", PlausibilityWarning)


class _InMemory:
    """Keeps records as a `HistoryWriter` does, without a file."""

    def __init__(self, scene: Scene, laws: Mapping[str, LawRecord], started: str) -> None:
        self._scene, self._about = scene, {"law_records": laws, "started": started}
        self._grid, self._records = Grid.of((1.0,), (1,)), list[Record]()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: type[BaseException] | BaseException | TracebackType | None) -> None:
        """Nothing is lost that anybody could still ask for."""

    def append(self, record: Record, grid: Grid, state: Mapping[str, np.ndarray]) -> None:
        """Add a record and its mesh."""
        self._grid = grid
        self._records.append(record)

    def finish(self, status: str, message: str) -> None:
        """Make the history."""
        end = {"status": status, "message": message, **self._about}
        self.history = History.of_records(self._records, self._scene, self._grid, **end)


_HALF_WIDTHS = ("half_width_x", "half_width_y")
