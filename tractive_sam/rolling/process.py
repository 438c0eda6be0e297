"""Processes: how the contacts of a scene follow each other, record by record.

A process makes steps: the first one, and from every step the next ones, up to the end of the
schedule or to a contact that is not solved. A step has its contacts, the values of its record, and
all that the next step needs; it can be stored and restored.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar, Generic, NamedTuple, Self, TypeVar

import numpy as np

from tractive_sam.contact import Gap, Model, enlarge, gap_across
from tractive_sam.deprecation import renamed_attributes
from tractive_sam.description import Row
from tractive_sam.results import (
    BOUND,
    COORDINATE,
    FIELDS,
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
    columns,
    restart_fields,
)
from tractive_sam.rolling.observer import Observer
from tractive_sam.scene import Scene, block_label
from tractive_sam.schema import required

GROWTHS = 16
"""Largest number of enlargements of a mesh: to 35 times its width."""


class StepRecord(NamedTuple):
    """Contact and values of one step, from which its record in the history is made.

    Attributes
    ----------
    contact : State
        The contact to record.
    values : dict
        Columns that only the process computes, by name; and columns of the package that the contact
        alone does not determine.
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
    """Base class of a step of a process; a subclass adds its coordinate and its record.

    Attributes
    ----------
    contacts : tuple of State
        Contacts of the different blocks of [[duty]]; one without blocks.
    observed : mapping of str to Observer
        Observers after the step, by their names.
    continues : bool
        Whether the process may continue from it.

    Examples
    --------
    >>> class Stroke(ts.Step):
    ...     place = 1
    ...     def on(self, grid):
    ...         return Stroke(tuple(contact.on(grid) for contact in self.contacts))
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
        """Value of the coordinate (revolution, distance, ...) of the step's record."""

    @abstractmethod
    def on(self, grid: Grid) -> Self:
        """Return the step on a wider mesh of equal elements."""

    @abstractmethod
    def record(self, block: int | None = None) -> StepRecord:
        """Return contact and values of the step (or of one of its blocks) for its record."""

    @property
    def weights(self) -> tuple[float, ...]:
        """Weight of each contact in the values of the step; 1 each unless overridden."""
        return (1.0,) * len(self.contacts)

    @property
    def contact(self) -> State:
        """First unsolved contact of the step; if all were solved, the first one."""
        return next((c for c in self.contacts if not c.converged), self.contacts[0])

    @property
    def converged(self) -> bool:
        """Whether all contacts of the step were solved."""
        return all(contact.converged for contact in self.contacts)

    @property
    def is_outgrown(self) -> bool:
        """Whether a contact has reached the edge of the mesh, so that the mesh must grow."""
        return self.contact.status is Status.OFF_GRID

    @property
    def grid(self) -> Grid:
        """Mesh of all blocks, without the shift of a contact."""
        return self.contacts[0].grid.shifted(0.0)

    @property
    def own_state(self) -> Mapping[str, np.ndarray]:
        """Arrays, by name, to resume besides the fields of the contacts; empty by default."""
        return {}


@dataclass(frozen=True, eq=False)
class StoredStep:
    """Record of a history with its arrays, from which a process resumes.

    Attributes
    ----------
    history : History
        All records.
    row : int
        Row of the record.
    state : mapping of str to ndarray
        Fields of its contacts, `Step.own_state` and the state of the observers.
    """

    history: History
    row: int
    state: Mapping[str, np.ndarray] = field(repr=False)

    @property
    def earlier_row(self) -> int:
        """Row of the last earlier record from which a process can resume; else this row."""
        return max((k for k in continuing_rows(self.history) if k < self.row), default=self.row)

    def contact(self, scene: Scene, place: int | None = None) -> State:
        """Return the stored contact (of one block), with `scene` as its scene.

        Parameters
        ----------
        scene : Scene
            The scene of the contact.
        place : int, optional
            Place of its block in [[duty]].
        """
        history, stored = self.history, dict(self.state)
        if place is not None:
            names = [name for name in (*FIELDS, BOUND.name) if name in stored]
            history, stored = history.block(place), {name: stored[name][place] for name in names}
        contact = replace(history.contact(self.row, stored), scene=scene, cost=Cost())
        if contact.friction_varies:  # files of earlier versions have no bound
            contact = replace(contact, traction_bound=contact.bound)
        return contact

    def state_of(self, observer: Observer) -> Mapping[str, np.ndarray]:
        """Return the stored arrays of an observer, by the names that the observer uses.

        Raises
        ------
        LookupError
            When a name is looked up that was not stored.
        """
        arrays = self.state_under(observer.name)
        return _ObserverState(arrays, f"{observer.name}_", self.state)

    def state_under(self, name: str) -> dict[str, np.ndarray]:
        """Return the stored arrays with names that begin with "name_", without this prefix."""
        start = f"{name}_"
        return {k.removeprefix(start): v for k, v in self.state.items() if k.startswith(start)}

    def require(self, names: Iterable[str], before: int = 0) -> None:
        """Raise a LookupError if columns are not finite in this record (or some before it)."""
        rows = slice(max(self.row - before, 0), self.row + 1)
        missing = [name for name in names if not np.isfinite(self.history[name][rows]).all()]
        if missing:
            raise LookupError(", ".join(missing))


class _ObserverState(dict[str, np.ndarray]):
    """Mapping of an observer's stored arrays by name; finds unprefixed names of old files."""

    def __init__(
        self, arrays: Mapping[str, np.ndarray], start: str, state: Mapping[str, np.ndarray]
    ) -> None:
        super().__init__(arrays)
        self._start, self._state = start, state

    def __missing__(self, name: str) -> np.ndarray:
        if name not in self._state:
            raise LookupError(f"{self._start}{name}")
        return self._state[name]


def continuing_rows(history: History) -> np.ndarray:
    """Return the indices of the records from which a process can resume, shape (n,)."""
    continues = history["converged"] > 0.0
    if "next_step" in history.columns:  # a record between two steps has none
        continues = continues & np.isfinite(history["next_step"])
    return np.flatnonzero(continues)


@dataclass(frozen=True, eq=False)
class Recorder:
    """Columns that are added to every record, with a cache of the complete list of columns.

    Attributes
    ----------
    columns : tuple of Quantity
        Columns in addition to the package's.
    measured : Gap, optional
        The measured separation of the scene.
    """

    columns: tuple[Quantity, ...] = ()
    measured: Gap | None = None
    _last: list[tuple[Scene, list[Quantity], dict[str, Quantity]]] = field(
        default_factory=list, init=False
    )

    def choose_columns(self, scene: Scene, own: list[Quantity]) -> dict[str, Quantity]:
        """Return all columns of a record by name; cached for the scene of the last record.

        Parameters
        ----------
        scene : Scene
            The scene of the contact.
        own : list of Quantity
            Columns in addition to the package's.
        """
        for known, before, chosen in self._last:
            if known is scene and list(map(id, before)) == list(map(id, own)):
                return chosen
        self._last[:] = [(scene, own, columns(scene, own))]
        return self._last[0][2]


AnyStep = TypeVar("AnyStep", bound=Step)


@renamed_attributes(followed_by="with_observers")
class Process(ABC, Generic[AnyStep]):
    """Base class of processes, sequences of contacts; a subclass begins and advances them.

    Parameters
    ----------
    model : Model
        The scene in numbers, as `model.scene` and `model.grid`.

    Examples
    --------
    >>> class Drive(ts.Process):
    ...     "Strokes forth and back."
    ...     columns = (ts.Quantity("stroke", "1", "strokes", role="coordinate"),)
    >>> sorted(Drive.__abstractmethods__)  # the methods to write
    ['advance', 'begin', 'expected_records', 'restore']
    """

    columns: ClassVar[tuple[Quantity, ...]] = ()
    """Columns that it records in addition to the package's; a column of the role "coordinate"
    replaces the revolutions."""
    observers: ClassVar[tuple[type[Observer], ...]] = ()
    """Observers of the package that follow it if the scene has their table."""
    first_applications: ClassVar[float] = 60.0
    """Applications of the elastic operator that the first contact of a block typically takes, at a
    tolerance of 1e-8."""
    next_applications: ClassVar[float] = 20.0
    """Applications that each further contact typically takes; it starts from the previous one."""

    def __init__(self, model: Model):
        self.model = model
        self.further_observers: tuple[Observer, ...] = ()

    @cached_property
    def following(self) -> tuple[Observer, ...]:
        """Observers of the process in their initial state, before the first step."""
        kinds = (kind for kind in self.observers if kind.applies_to(self.model.scene))
        return (*(kind() for kind in kinds), *self.further_observers)

    def with_observers(self, further: Iterable[Observer]) -> Self:
        """Return a copy of the process with these further observers instead of previous ones."""
        return self._copy_with(self.model, tuple(further))

    def _copy_with(self, model: Model, further: tuple[Observer, ...] | None = None) -> Self:
        """Return a copy of the process with another model, or with other further observers."""
        process = type(self)(model, **self.parameters)
        process.further_observers = self.further_observers if further is None else further
        return process

    @property
    def coordinate(self) -> Quantity | None:
        """Column by which the records are ordered; None if it follows from the scene."""
        return next((column for column in self.columns if column.role == COORDINATE), None)

    def describe(self) -> Iterable[Row]:
        """Return rows for `explain`; by default the first line of the class docstring."""
        summary = (type(self).__doc__ or type(self).__name__).strip().splitlines()[0]
        return [Row("process", summary)]

    @abstractmethod
    def begin(self) -> AnyStep:
        """Return the first step of the process."""

    @abstractmethod
    def advance(self, last: AnyStep) -> Iterator[AnyStep]:
        """Yield the steps that follow a step, to the end or to an unsolved contact."""

    @classmethod
    @abstractmethod
    def restore(cls, scene: Scene, stored: StoredStep) -> AnyStep:
        """Return the step of a stored record, without what the model adds (see `adopt`).

        Raises
        ------
        LookupError
            If an array or a column is missing, with its name.
        """

    @classmethod
    @abstractmethod
    def expected_records(cls, scene: Scene, dx: float) -> int:
        """Return the (approximate) number of records for elements of the length dx, mm.

        Parameters
        ----------
        scene : Scene
            Scene of the process.
        dx : float
            Element size in the rolling direction, mm.
        """

    def on(self, grid: Grid) -> Self:
        """Return a copy of the process on another mesh."""
        return self._copy_with(self.model.on(grid))

    @property
    def parameters(self) -> dict[str, Any]:
        """Constructor arguments of the process besides the model, by name; none by default."""
        return {}

    def begin_fitted(self) -> tuple[Self, AnyStep]:
        """Return the process and its first step; by default without fitting the mesh."""
        return self, self.begin()

    def adopt(self, step: AnyStep, stored: StoredStep) -> AnyStep:
        """Return a restored step with its observers; a subclass adds values of its model.

        Parameters
        ----------
        step : Step
            Step from `restore`.
        stored : StoredStep
            The record of the history.
        """
        observers = {observer.name: observer.restore(step, stored) for observer in self.following}
        return replace(step, observed=observers)

    def observe(self, step: AnyStep, before: AnyStep | None = None) -> AnyStep:
        """Return a step with its observers updated; if it is unsolved, most stay as they were.

        Each observer receives the step with the observers that come before it.

        Parameters
        ----------
        step : Step
            The step, without its observers.
        before : Step, optional
            The step before it, with observers; None for the first step.
        """
        observed: dict[str, Observer] = {}
        for observer in self.following:
            last = None if before is None else before.observed.get(observer.name)
            if step.converged or observer.unsolved:
                follow = observer.begin if last is None else last.after
                last = follow(replace(step, observed=dict(observed)), self.model)
            if last is not None:
                observed[observer.name] = last
        return replace(step, observed=observed)

    def steps(self, last: AnyStep | None = None) -> Iterator[AnyStep]:
        """Yield the observed steps after a step (default: all), on a mesh that grows if needed.

        Unless the scene fixes the mesh, it grows with the contact; the following steps are on the
        wider mesh.
        """
        process, growths = self, 0
        if last is None:
            last = self.observe(self.begin())
            yield last
        while True:
            for advanced in process.advance(last):
                step = advanced if advanced.observed else process.observe(advanced, last)
                if step.is_outgrown and not self.model.scene.has_fixed_domain and growths < GROWTHS:
                    growths += 1
                    wider = enlarge(process.model.grid, step.contact.at_edge)
                    process, last = process.on(wider), last.on(wider)
                    break
                if step.continues:
                    last = step
                yield step
            else:
                return

    def state(self, step: AnyStep) -> dict[str, np.ndarray]:
        """Return all arrays, by name, from which the process can resume after a step.

        The fields of its contact, and the states of the step and of its observers.
        """
        return restart_fields(step.contact) | self._state_besides_fields(step)

    @staticmethod
    def _state_besides_fields(step: AnyStep) -> dict[str, np.ndarray]:
        """Return the arrays of a step and its observers, by name, without the contact's fields."""
        state = dict(step.own_state)
        for observer in step.observed.values():
            state |= {f"{observer.name}_{name}": array for name, array in observer.state.items()}
        return state

    def record(self, step: AnyStep, recorder: Recorder) -> Record:
        """Return the record of a step for the history: values, fields and stresses.

        It contains fields, and the stress on the planes of the scene, if the scene saves them or
        the contact was not solved. Columns of observers are in every record.

        Parameters
        ----------
        step : Step
            The step.
        recorder : Recorder
            Additions to every record.
        """
        record = self._record_contact(step, step.record(), recorder)
        observed: dict[str, Any] = {}
        for observer in self._observers_of(step):
            values = observer.record(self.model, record.values)
            observed |= {name: values[name] for name in values if name in record.columns}
        stored = self._cycles(step) if record.fields else ()
        return replace(record, values={**record.values, **observed}, cycles=stored)

    @staticmethod
    def _observers_of(step: AnyStep) -> list[Observer]:
        """Return the observers that have values for a step (unsolved steps have fewer)."""
        return [seen for seen in step.observed.values() if step.converged or seen.unsolved]

    @staticmethod
    def _cycles(step: AnyStep) -> tuple[BodyFatigue, ...]:
        """Return the fatigue of the bodies that the observers of a step computed."""
        return tuple(cycle for observer in step.observed.values() for cycle in observer.cycles)

    def _record_contact(
        self, step: AnyStep, provided: StepRecord, recorder: Recorder, block: int = 0
    ) -> Record:
        """Return the record of one contact of a step, in a duty cycle of one block."""
        contact, values, may_store = provided
        store = (may_store and step.place in contact.scene.schedule) or not step.converged
        if recorder.measured is not None:
            values["measured_profile"] = gap_across(recorder.measured, contact.grid)
        user_columns = [*recorder.columns, *self.columns]
        if PARTS.name in values:
            user_columns.append(PARTS)
        of_fields: dict[Quantity, np.ndarray] = {}
        stress: list[PlaneStress] = []
        for seen in self._observers_of(step):
            contact = seen.complete(contact, block)
            values |= seen.record_block(block)
            user_columns += seen.columns
            if store:
                arrays = seen.record_fields(block)
                of_fields |= {quantity: arrays[quantity.name] for quantity in seen.fields}
                stress += seen.record_stress(block)
        chosen = recorder.choose_columns(contact.scene, user_columns)
        return Record.from_contact(
            contact, values, chosen=chosen, with_fields=store, stress=stress, user_fields=of_fields
        )

    def end(self, step: AnyStep, half_widths: np.ndarray) -> tuple[str, str]:
        """Return (status, message): "done", inaccurate, or the status of an unsolved contact.

        Parameters
        ----------
        step : Step
            The last step.
        half_widths : ndarray, shape (2,)
            The largest half widths of the contact in all records, mm.
        """
        contact = step.contact
        shortfalls = [
            observer.shortfall for observer in step.observed.values() if observer.shortfall
        ]
        if step.converged and shortfalls:
            return str(Status.INACCURATE), shortfalls[0]
        remarks = "".join(observer.remark(self.model) for observer in step.observed.values())
        message = f"{self._describe_place(step)}{contact.message}{remarks}"
        return "done" if contact.converged else str(contact.status), message

    def _describe_place(self, step: AnyStep) -> str:
        """Describe where a step is (coordinate, unsolved block) for messages.

        The text is the beginning of a message.
        """
        scene = self.model.scene
        place = scene.schedule.message_start.format(step.place)
        if step.converged or len(step.contacts) == 1:
            return place
        block = required(scene.spectrum, "duty").places.index(step.contacts.index(step.contact))
        return f"{place}{block_label(scene, block)}: "
