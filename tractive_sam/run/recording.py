"""Roll a scene and record its steps, in a file or in memory."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path
from time import perf_counter
from traceback import clear_frames
from types import TracebackType
from typing import Any, Self

import numpy as np

from tractive_sam import interrupt
from tractive_sam.contact import Gap, Model
from tractive_sam.results import Grid, History, LawRecord, Quantity, Record, caveats
from tractive_sam.rolling import Observer, Process, Recorder, Step, process_of
from tractive_sam.run.inputs import check_observer_columns, hash_measurements, warn_of_gap
from tractive_sam.scene import Scene
from tractive_sam.schema import PlausibilityWarning, required, warn
from tractive_sam.store import HistoryWriter, open_history


@dataclass(frozen=True, eq=False)
class Recording:
    """A roll with its arguments: runs the process of a scene and records its steps.

    Parameters
    ----------
    scene : Scene
        Scene to roll.
    measured : Gap, optional
        Measured separation of the scene.
    model_of : callable
        Makes the model of a scene, a measured separation and a mesh.
    path : path-like, optional
        Results file; without it the records stay in memory.
    overwrite : bool
        Whether a results file may be replaced.
    progress : callable, optional
        Called with each record.
    columns : tuple of Quantity
        Columns in addition to the package's.
    began : float
        Time when the first record began, by `time.perf_counter`.
    started : str
        See `History`.
    observers : tuple of Observer
        Observers besides the scene's.
    """

    half_widths = ("half_width_x", "half_width_y")

    scene: Scene
    measured: Gap | None
    model_of: Callable[..., Model]
    path: Path | None
    overwrite: bool
    progress: Callable[[Record], None] | None
    columns: tuple[Quantity, ...]
    began: float
    started: str = ""
    observers: tuple[Observer, ...] = ()

    def process_of(self, model: Model, *further: Observer) -> Process[Any]:
        """Return the process of a model, with the observers of the roll and further ones.

        Raises
        ------
        TypeError, ValueError
            See `check_observer_columns`.
        """
        process = process_of(model, (*self.observers, *further))
        check_observer_columns(process.following, self.columns)
        return process

    def begin(self, process: Process, start: Step) -> tuple[History, Step]:
        """Record all steps from the first to the end; return the history and the last step."""
        model = process.model
        laws = model.laws.differences_from(model.scene)
        warn_of_gap(model)
        _warn_beyond_tests(model, start)
        sink: HistoryWriter | _InMemory = _InMemory(self.scene, laws, self.started)
        if self.path is not None:
            sink = HistoryWriter(
                self.path,
                self.scene,
                model.grid,
                self.overwrite,
                laws=laws,
                started=self.started,
                measured=hash_measurements(model),
                coordinate=process.coordinate,
            )
        start = process.observe(start)
        return self._record_steps(sink, process, start, (start,))

    def resume(self, process: Process, last: Step, before: History) -> tuple[History, Step]:
        """Roll from the last step of a results file; return the history and the last step."""
        warn_of_gap(process.model)
        sink = HistoryWriter.reopen(required(self.path, "path"), self.scene, len(before))
        widest = np.nanmax([before[name] for name in self.half_widths], axis=1, initial=0.0)
        return self._record_steps(sink, process, last, (), widest)

    def _record_steps(
        self,
        sink: "HistoryWriter | _InMemory",
        process: Process,
        start: Step,
        first: Iterable[Step],
        widest: np.ndarray | tuple[float, float] = (0.0, 0.0),
    ) -> tuple[History, Step]:
        """Record `first` and the steps after `start`; return the history and the last step."""
        step, began = start, self.began
        recorder = Recorder(self.columns, self.measured)
        with sink:
            for step in chain(first, process.steps(start)):
                try:
                    record = process.record(step, recorder)
                except MemoryError as error:
                    clear_frames(error.__traceback__)  # they hold arrays
                    # The contact is kept without what observers add, and computed again by resume.
                    kept = process.record(replace(step, observed={}), recorder)
                    if step is not start:  # stress belongs to all fields in the file
                        kept = replace(kept, tables={})
                    sink.append(kept, step.grid, None)
                    raise
                seconds = perf_counter() - began
                record = replace(record, values={**record.values, "seconds": seconds})
                began = perf_counter()
                stored = step.continues and self.path is not None
                state = process.state(step) if stored else None
                sink.append(record, step.grid, state)
                widest = np.fmax(widest, [record.values[name] for name in self.half_widths])
                if self.progress is not None:
                    self.progress(record)
                interrupt.raise_if_interrupted()
            sink.finish(*process.end(step, np.asarray(widest)))
        history = sink.history if isinstance(sink, _InMemory) else open_history(sink.path)
        if note := caveats(history).get("p_max"):
            warn(f"p_max: {note}", PlausibilityWarning)
        return history, step


def _warn_beyond_tests(model: Model, start: Step) -> None:
    """Warn of contacts beyond the range of tests from which wear coefficients stem."""
    for k, (block, contact) in enumerate(zip(model.blocks, start.contacts, strict=True)):
        if block.wear_law is not None and contact.converged:
            fields = contact.pressure, contact.traction, contact.slip
            if note := block.wear_law.beyond_tests(*fields):
                key = f"wear.law: duty block {k + 1}" if len(model.blocks) > 1 else "wear.law"
                warn(f"{key}: {note}", PlausibilityWarning)


class _InMemory:
    """Collector of records in memory, with the interface of `HistoryWriter`."""

    def __init__(self, scene: Scene, laws: Mapping[str, LawRecord], started: str) -> None:
        self._scene, self._laws, self._started = scene, laws, started
        self._grid, self._records = Grid.from_half_lengths((1.0,), (1,)), list[Record]()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: type[BaseException] | BaseException | TracebackType | None) -> None:
        """Do nothing: records in memory need no file to be closed."""

    def append(self, record: Record, grid: Grid, state: Mapping[str, np.ndarray] | None) -> None:
        """Store a record, and its mesh instead of the previous one; the state is not stored."""
        self._grid = grid
        self._records.append(record)

    def finish(self, status: str, message: str) -> None:
        """Build the history of all records, with its status, and store it as `history`."""
        self.history = History.of_records(
            self._records,
            self._scene,
            self._grid,
            status=status,
            message=message,
            law_records=self._laws,
            started=self._started,
        )
