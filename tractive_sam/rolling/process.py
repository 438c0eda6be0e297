"""Processes: how the contacts of a scene follow each other, record by record.

A process makes steps: the first one, and from every step the next ones, up to the end of the
schedule or to a contact that is not solved. A step knows its contacts, what its record tells of
them, and all that the next step needs, also after it was stored.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar, Generic, NamedTuple, Protocol, Self, TypeVar

import numpy as np

from tractive_sam.contact import Gap, Model, across, grown
from tractive_sam.description import Row
from tractive_sam.results import (
    COORDINATE,
    PARTS,
    BodyFatigue,
    Cost,
    Grid,
    History,
    PlaneStress,
    Quantity,
    Record,
    State,
    Status,
    fields,
)
from tractive_sam.rolling.observer import Observer
from tractive_sam.scene import Scene

GROWTHS = 16
"""Most enlargements of a mesh: to 35 times its width."""


class StepRecord(NamedTuple):
    """What a step gives to its record.

    Attributes
    ----------
    contact : State
        The contact to record.
    values : dict
        Columns that only the process knows, by name; and those of the package that the contact
        alone does not know.
    may_store : bool
        Whether fields may be stored.

    Examples
    --------
    >>> ts.StepRecord(contact, {"stroke": 1}).may_store
    True
    """

    contact: State
    values: dict[str, Any]
    may_store: bool = True


@dataclass(frozen=True, eq=False)
class Step(ABC):
    """One record of a process, and all that the next one needs.

    Attributes
    ----------
    contacts : tuple of State
        Those of the different blocks of [[duty]]; one without.
    observed : mapping of str to Observer
        Observers after it, by their names.
    continues : bool
        Whether the process continues from it.

    Examples
    --------
    >>> class Stroke(ts.Step):
    ...     place = 1
    ...     def on(self, grid):
    ...         return Stroke(tuple(one.on(grid) for one in self.contacts))
    ...     def record(self, block=None):
    ...         return ts.StepRecord(self.contact, {"stroke": self.place})
    >>> Stroke((contact,)).converged
    True
    """

    contacts: tuple[State, ...]
    observed: Mapping[str, Observer] = field(default_factory=dict, kw_only=True)
    continues: bool = field(default=True, kw_only=True)

    @property
    @abstractmethod
    def place(self) -> float:
        """Value of the coordinate."""

    @abstractmethod
    def on(self, grid: Grid) -> Self:
        """Return the same on a wider mesh of the same elements."""

    @abstractmethod
    def record(self, block: int | None = None) -> StepRecord:
        """Return what is recorded of the step, or of one of its blocks."""

    @property
    def weights(self) -> tuple[float, ...]:
        """Share of each contact in the step."""
        return (1.0,) * len(self.contacts)

    @property
    def contact(self) -> State:
        """The contact that decides how it ended."""
        return self.contacts[0]

    @property
    def converged(self) -> bool:
        """Whether all contacts were solved."""
        return all(contact.converged for contact in self.contacts)

    @property
    def off_grid(self) -> bool:
        """Whether the contact has reached the edge of the mesh."""
        return self.contact.status is Status.OFF_GRID

    @property
    def grid(self) -> Grid:
        """The mesh of all blocks."""
        return self.contacts[0].grid.shifted(0.0)

    @property
    def own_state(self) -> Mapping[str, np.ndarray]:
        """Arrays to continue from besides the fields of the contacts, by name."""
        return {}


@dataclass(frozen=True, eq=False)
class StoredStep:
    """The record of a history from which a process is to continue.

    Attributes
    ----------
    history : History
        All records.
    row : int
        Which of them.
    state : mapping of str to ndarray
        Fields of its contacts, `Step.own_state` and the state of the observers.
    """

    history: History
    row: int
    state: Mapping[str, np.ndarray] = field(repr=False)

    @property
    def earlier(self) -> int:
        """Row of the record before it from which the process could continue; its own if none."""
        return max((k for k in continuing_rows(self.history) if k < self.row), default=self.row)

    def contact(self, scene: Scene) -> State:
        """Return the contact, of a scene that may ask for more records than the history has."""
        found = self.history.contact(self.row, dict(self.state))
        return replace(found, scene=scene, cost=Cost())

    def state_of(self, observer: Observer) -> Mapping[str, np.ndarray]:
        """Return the `state` of an observer as it was stored, by the names that it gave.

        Raises
        ------
        LookupError
            By the mapping, if there is none of a name.
        """
        start = f"{observer.name}_"
        found = {k.removeprefix(start): v for k, v in self.state.items() if k.startswith(start)}
        return _StateOf(found, start, self.state)

    def require(self, names: Iterable[str], before: int = 0) -> None:
        """Raise a LookupError if a column is not finite in this record or some before it."""
        rows = slice(max(self.row - before, 0), self.row + 1)
        lost = [name for name in names if not np.isfinite(self.history[name][rows]).all()]
        if lost:
            raise LookupError(", ".join(lost))


class _StateOf(dict[str, np.ndarray]):
    """Arrays of an observer by the names that it gave; in older files these are the whole names."""

    def __init__(
        self, found: Mapping[str, np.ndarray], start: str, state: Mapping[str, np.ndarray]
    ) -> None:
        super().__init__(found)
        self._start, self._state = start, state

    def __missing__(self, name: str) -> np.ndarray:
        if name not in self._state:
            raise LookupError(f"{self._start}{name}")
        return self._state[name]


def continuing_rows(history: History) -> np.ndarray:
    """Return the rows of the records from which a process can continue, shape (n,)."""
    continues = history["converged"] > 0.0
    if "next_step" in history.columns:  # a record between two steps has none
        continues = continues & np.isfinite(history["next_step"])
    return np.flatnonzero(continues)


class ErrorEstimator(Protocol):
    """Gives steps their error bars, by the same steps on coarser meshes."""

    missed: str
    """Which of them was last too wide, and what to do; or empty."""

    def __call__(self, step: Any, block: int = 0) -> Mapping[str, Any]:
        """Return the error bars of `State` for the contact of a block."""


@dataclass(frozen=True, eq=False)
class Recorder:
    """What goes into every record besides what its step knows.

    Attributes
    ----------
    estimator : ErrorEstimator, optional
        Gives the error bars; by default they are those of the contact.
    columns : tuple of Quantity
        Columns besides those of the package.
    measured : Gap, optional
        The measured separation of the scene.
    """

    estimator: ErrorEstimator | None = None
    columns: tuple[Quantity, ...] = ()
    measured: Gap | None = None


AnyStep = TypeVar("AnyStep", bound=Step)


class Process(ABC, Generic[AnyStep]):
    """The contacts of a scene on a mesh, one after the other.

    Parameters
    ----------
    model : Model
        The scene in numbers, as `model.scene` and `model.grid`.

    Examples
    --------
    >>> class Drive(ts.Process):
    ...     "Strokes forth and back."
    ...     columns = (ts.Quantity("stroke", "1", "strokes", role="coordinate"),)
    >>> sorted(Drive.__abstractmethods__)  # what is left to write
    ['advance', 'begin', 'expected_records', 'restore']
    """

    columns: ClassVar[tuple[Quantity, ...]] = ()
    """Columns that it records besides those of the package; one of the role "coordinate" takes the
    place of the revolutions."""
    observers: ClassVar[tuple[type[Observer], ...]] = ()
    """Observers of the package that may follow it, where the scene has their table."""

    def __init__(self, model: Model):
        self.model = model
        self.further: tuple[Observer, ...] = ()

    @cached_property
    def following(self) -> tuple[Observer, ...]:
        """All observers that follow it, as they are before the first step."""
        kinds = (kind for kind in self.observers if kind.asked_by(self.model.scene))
        return (*(kind() for kind in kinds), *self.further)

    def followed_by(self, further: Iterable[Observer]) -> Self:
        """Return the same with other further observers."""
        return self._with(self.model, tuple(further))

    def _with(self, model: Model, further: tuple[Observer, ...] | None = None) -> Self:
        found = type(self)(model, **self.parameters)
        found.further = self.further if further is None else further
        return found

    @property
    def coordinate(self) -> Quantity | None:
        """Its own coordinate; None where it is that of the scene."""
        return next((one for one in self.columns if one.role == COORDINATE), None)

    def describe(self) -> Iterable[Row]:
        """Return the rows that `explain` prints of it besides those of its table."""
        summary = (type(self).__doc__ or type(self).__name__).strip().splitlines()[0]
        return [Row("process", summary)]

    @abstractmethod
    def begin(self) -> AnyStep:
        """Return the first step."""

    @abstractmethod
    def advance(self, last: AnyStep) -> Iterator[AnyStep]:
        """Yield the steps after one, to the end or to a contact that is not solved."""

    @classmethod
    @abstractmethod
    def restore(cls, scene: Scene, stored: StoredStep) -> AnyStep:
        """Return the step of a stored record; `adopt` adds what only the model knows.

        Raises
        ------
        LookupError
            If something is missing, with its name.
        """

    @classmethod
    @abstractmethod
    def expected_records(cls, scene: Scene, dx: float) -> int:
        """Return the number of records on elements so long, mm; of adaptive steps, about."""

    def on(self, grid: Grid) -> Self:
        """Return the same on another mesh."""
        return self._with(self.model.on(grid))

    @property
    def parameters(self) -> dict[str, Any]:
        """Arguments of the class besides the model."""
        return {}

    def begin_fitted(self) -> tuple[Self, AnyStep]:
        """Return the first step on a mesh that holds its contacts, and the process on that mesh."""
        return self, self.begin()

    def adopt(self, step: AnyStep, stored: StoredStep) -> AnyStep:
        """Return a restored step with what the model and the observers know of it."""
        return replace(
            step, observed={one.name: one.restore(step, stored) for one in self.following}
        )

    def observe(self, step: AnyStep, before: AnyStep | None = None) -> AnyStep:
        """Return a step with its observers; most are as before if it was not solved."""
        observed = {} if before is None else dict(before.observed)
        for one in self.following:
            if step.converged or one.unsolved:
                follow = observed[one.name].after if one.name in observed else one.begin
                observed[one.name] = follow(step, self.model)
        return replace(step, observed=observed)

    def steps(self, last: AnyStep | None = None) -> Iterator[AnyStep]:
        """Yield the steps after one; by default all of them.

        A mesh that the scene leaves open grows with the contact; the steps from there on are on
        the wider mesh.
        """
        process, growths = self, 0
        if last is None:
            last = self.observe(self.begin())
            yield last
        while True:
            for found in process.advance(last):
                step = found if found.observed else process.observe(found, last)
                if step.off_grid and not self.model.scene.has_fixed_domain and growths < GROWTHS:
                    growths += 1
                    wider = grown(process.model.grid, step.contact.at_edge)
                    process, last = process.on(wider), last.on(wider)
                    break
                if step.continues:
                    last = step
                yield step
            else:
                return

    def state(self, step: AnyStep) -> dict[str, np.ndarray]:
        """Return all arrays to continue from after a step, by name.

        Fields of its contact, what it and what its observers need besides.
        """
        return fields(step.contact) | self._state_besides_fields(step)

    @staticmethod
    def _state_besides_fields(step: AnyStep) -> dict[str, np.ndarray]:
        found = dict(step.own_state)
        for seen in step.observed.values():
            found |= {f"{seen.name}_{name}": values for name, values in seen.state.items()}
        return found

    def record(self, step: AnyStep, recorder: Recorder) -> Record:
        """Return the record of a step.

        Fields, and the stress on the planes of the scene, are part of it where the scene saves
        them, and of a contact that was not solved; columns of observers are part of every record.
        """
        record = self._record_contact(step, step.record(), recorder)
        observed = {}
        for one in self._recording(step):
            values = one.record(self.model, record.values)
            observed |= {name: values[name] for name in values if name in record.columns}
        stored = self._cycles(step) if record.fields else ()
        return replace(record, values={**record.values, **observed}, cycles=stored)

    @staticmethod
    def _recording(step: AnyStep) -> list[Observer]:
        """Return the observers that followed a step to its end."""
        return [one for one in step.observed.values() if step.converged or one.unsolved]

    @staticmethod
    def _cycles(step: AnyStep) -> tuple[BodyFatigue, ...]:
        return tuple(one for seen in step.observed.values() for one in seen.cycles)

    def _record_contact(
        self, step: AnyStep, given: StepRecord, recorder: Recorder, block: int = 0
    ) -> Record:
        """Return the record of one contact, that of a block in a duty cycle."""
        contact, values, may_store = given
        store = (may_store and step.place in contact.scene.schedule) or not step.converged
        if recorder.estimator is not None:
            contact = replace(contact, error_bars=recorder.estimator(step, block))
        if recorder.measured is not None:
            values["measured_profile"] = across(recorder.measured, contact.grid)
        columns = [*recorder.columns, *self.columns]
        if PARTS.name in values:
            columns.append(PARTS)
        of_fields: dict[Quantity, np.ndarray] = {}
        stress: list[PlaneStress] = []
        for seen in self._recording(step):
            contact = seen.complete(contact, block)
            values |= seen.record_block(block)
            columns += seen.columns
            if store:
                found = seen.record_fields(block)
                of_fields |= {one: found[one.name] for one in seen.fields}
                stress += seen.record_stress(block)
        own = {"own": columns, "own_fields": of_fields}
        return Record.of(contact, values, **own, with_fields=store, stress=stress)

    def end(self, step: AnyStep, half_widths: np.ndarray) -> tuple[str, str]:
        """Return status and message of a history that ends with a step.

        Parameters
        ----------
        step : Step
            The last one.
        half_widths : ndarray, shape (2,)
            The largest half widths of the contact in all records, mm.
        """
        contact = step.contact
        remarks = "".join(one.remark(self.model) for one in step.observed.values())
        message = f"{self._describe_place(step)}{contact.message}{remarks}"
        return "done" if contact.converged else str(contact.status), message

    def _describe_place(self, step: AnyStep) -> str:
        return self.model.scene.schedule.message_start.format(step.place)
