"""Rolls a scene and keeps its records, in a file or in memory."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import chain
from os import PathLike
from time import perf_counter
from types import TracebackType
from typing import Self

import numpy as np

from tractive_sam import interrupt
from tractive_sam.contact import Gap, Model, not_resolved
from tractive_sam.results import (
    Grid,
    History,
    LawRecord,
    Quantity,
    Record,
    Status,
    caveats,
    fields,
)
from tractive_sam.rolling import ErrorEstimator, Passage, followed, passages, recorded
from tractive_sam.run.gap_notes import warn_of_gap
from tractive_sam.run.given import hash_of
from tractive_sam.run.resume import last_damage
from tractive_sam.scene import FewestElements, PlausibilityWarning, Scene, warn
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

    def begun(
        self,
        model: Model,
        start: Passage,
        estimator: ErrorEstimator | None = None,
        missed: str = "",
    ) -> History:
        """Roll from the unworn bodies on; `missed` tells what is wrong with their accuracy."""
        laws = model.laws.differences_from(model.scene)
        warn_of_gap(model)
        _warn_beyond_tests(model, start)
        keeper: HistoryWriter | _InMemory = _InMemory(self.scene, laws, self.started)
        if self.path is not None:
            about = {"laws": laws, "started": self.started, "measured": hash_of(model)}
            keeper = HistoryWriter(self.path, self.scene, model.grid, self.overwrite, **about)
        if isinstance(start, Passage):
            start = followed(model, start)
        return self._kept(keeper, model, start, (start,), estimator, missed)

    def resumed(
        self,
        model: Model,
        last: Passage,
        before: History,
        estimator: ErrorEstimator | None = None,
        missed: str = "",
    ) -> History:
        """Roll on from the last record of a file that holds `before`; arguments as of `begun`."""
        warn_of_gap(model)
        keeper = HistoryWriter.reopen(self.path, self.scene, len(before))
        if isinstance(last, Passage):
            last = replace(last, damage=last_damage(self.path, last))
        widest = np.nanmax([before[name] for name in _HALF_WIDTHS], axis=1, initial=0.0)
        return self._kept(keeper, model, last, (), estimator, missed, widest)

    def _kept(
        self,
        keeper: "HistoryWriter | _InMemory",
        model: Model,
        start: Passage,
        first: Iterable[Passage],
        estimator: ErrorEstimator | None,
        missed: str,
        widest: np.ndarray | float = 0.0,
    ) -> History:
        passage, began = start, self.began
        with keeper:
            for passage in chain(first, passages(model, start)):
                told = recorded(passage, model, began, estimator, self.columns, self.measured)
                began = perf_counter()
                grid = passage.contact.grid.shifted(0.0)
                state = _state(passage, self.scene) if passage.continues else None
                keeper.append(told, grid, state)
                widest = np.fmax(widest, [told.values[name] for name in _HALF_WIDTHS])
                if self.progress is not None:
                    self.progress(told)
                interrupt.heed()
            missed = missed if estimator is None else estimator.missed
            status, message = _ended(passage, model, missed, widest)
            keeper.finish(status, message)
        history = keeper.history if self.path is None else open_history(self.path)
        if note := caveats(history).get("p_max"):
            warn(f"p_max: {note}", PlausibilityWarning)
        return history


def _state(passage: Passage, scene: Scene) -> dict[str, np.ndarray]:
    """All that rolling goes on from: the fields of its contact, or of each block."""
    if scene.spectrum is None:
        return fields(passage.contact) | passage.beside
    each = [fields(passage.contacts[k]) for k in scene.spectrum.places]
    return {name: np.stack([one[name] for one in each]) for name in each[0]} | passage.beside


def _warn_beyond_tests(model: Model, start: Passage) -> None:
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


def _ended(
    passage: Passage, model: Model, missed: str, widest: np.ndarray | float
) -> tuple[str, str]:
    """Status and message of a history that ends with this passage.

    `widest` are the largest half widths of all records, mm. A [transient] may begin and end with a
    contact of few elements, where the bodies touch and part, but not be so small throughout.
    """
    contact = passage.contact
    if contact.converged and contact.scene.transient is not None:
        sides = np.array((contact.grid.dx, contact.grid.dy))
        few = (widest > 0.0) & (2.0 * widest < FewestElements.contact * sides)
        if np.any(few):
            across = np.ceil(2.0 * np.asarray(widest) / sides)
            return str(Status.NOT_RESOLVED), not_resolved(contact, across)
    if contact.converged and missed:
        return str(Status.INACCURATE), missed
    message = contact.message
    if isinstance(passage, Passage) and len(passage.contacts) > 1 and not contact.converged:
        message = f"{contact.scene.title.split(', ')[-1]}: {message}"
    message = contact.scene.schedule.describe_place(passage.place) + message
    if isinstance(passage, Passage) and passage.damage is not None:
        message += passage.damage.warning(model)
    return "done" if contact.converged else str(contact.status), message
