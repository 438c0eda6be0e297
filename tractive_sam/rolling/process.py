"""Processes: how the contacts of a scene follow each other, their observers and step control.

A process makes steps: the first one, and from every step the next ones, up to the end of the
schedule or to a contact that is not solved. A step has its contacts, the values of its record, and
all that the next step needs; it can be stored and restored.

A step that was refused differs from one that was cut short by a stop. After a refusal, the next
step is shorter. A cut says little about the next step, which is as long as the error allowed
before. The coordinate may be revolutions, or a distance rolled; its stops may be points to save,
the end, or the blocks of a duty cycle.
"""

from abc import ABC, abstractmethod
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import ceil, isfinite
from typing import Any, ClassVar, Generic, NamedTuple, Self, TypeVar, cast

import numpy as np

from tractive_sam.contact import Gap, Model, enlarge, gap_across
from tractive_sam.description import Row
from tractive_sam.lazy_names import renamed_attributes
from tractive_sam.results import (
    BOUND,
    COORDINATE,
    FIELDS,
    PARTS,
    BodyFatigue,
    Cost,
    Grid,
    History,
    InclusionPassage,
    PlaneStress,
    Quantity,
    Record,
    State,
    Status,
    columns,
    restart_fields,
)
from tractive_sam.scene import Scene, block_label
from tractive_sam.schema import required


@renamed_attributes(asked_by="applies_to")
class Observer(ABC):
    """Base class of observers of a process: columns and fields, updated after each step.

    It defines its columns, stored fields and description, and the state that it needs to resume.
    An object never changes: `begin`, `after` and `restore` return another one. The steps of a
    process do not depend on it, but may become shorter if its error is too large.

    Examples
    --------
    >>> from dataclasses import dataclass, replace
    >>> @dataclass(frozen=True)
    ... class Peak(ts.Observer):
    ...     "Largest pressure so far."
    ...     name = "peak"
    ...     columns = (ts.Quantity("p_peak", "MPa", "largest pressure so far"),)
    ...     kept = ("largest",)
    ...     largest: float = 0.0
    ...     def begin(self, step, model):
    ...         return self.after(step, model)
    ...     def after(self, step, model):
    ...         return replace(self, largest=max(self.largest, step.contact.p_max))
    ...     def record(self, model, recorded):
    ...         return {"p_peak": self.largest}
    >>> history = ts.roll(discs, observers=[Peak()])
    >>> bool(history["p_peak"][-1] == history["p_max"].max())
    True
    """

    name: ClassVar[str]
    """Name in `Step.observed`; the names of its stored state begin with it."""
    key: ClassVar[str] = ""
    """Table of the scene that adds it; empty if a scene names it in [[observer]]."""
    kept: ClassVar[tuple[str, ...]] = ()
    """Attributes that a results file keeps, to resume: numbers, arrays, or tuples of these."""
    unsolved: ClassVar[bool] = False
    """Whether it also follows steps with contacts that were not solved."""

    @property
    def columns(self) -> tuple[Quantity, ...]:
        """Columns that the observer adds to each record; none by default."""
        return ()

    @property
    def fields(self) -> tuple[Quantity, ...]:
        """Fields over x and y that the observer stores with those of a record; none by default."""
        return ()

    @classmethod
    def applies_to(cls, scene: Scene) -> bool:
        """Return whether a scene has the table (`key`) that adds this observer."""
        return bool(cls.key) and scene.has(cls.key)

    def describe(self, model: Model) -> Iterable[Row]:
        """Return the rows that `explain` prints; by default the docstring's first line.

        They are printed below its table of the scene, or below "Observers".
        """
        summary = (type(self).__doc__ or type(self).__name__).strip().splitlines()[0]
        return [Row(self.name, summary)]

    def bytes_needed(self, model: Model) -> float:
        """Return the memory, bytes, besides stored records; 0 unless overridden."""
        return 0.0

    def applications(self, model: Model) -> float:
        """Return the work of a record, in elastic responses; 0 unless overridden."""
        return 0.0

    @abstractmethod
    def begin(self, step: Any, model: Model) -> Self:
        """Return the observer as it is after the first step of a process.

        Parameters
        ----------
        step : Step
            The first step.
        model : Model
            Model of the process.
        """

    @abstractmethod
    def after(self, step: Any, model: Model) -> Self:
        """Return the observer updated by a later step, which may be on a wider mesh.

        Parameters
        ----------
        step : Step
            The later step.
        model : Model
            Model of the process, on the mesh of the step.
        """

    def restore(self, step: Any, stored: Any) -> Self:
        """Return the observer as it was after a stored step, to resume from.

        By default the attributes `kept` have their stored values.

        Parameters
        ----------
        step : Step
            The step, possibly on a wider mesh than the stored one.
        stored : StoredStep
            Its record; `stored.state_of(self)` has the arrays of `state`.

        Raises
        ------
        LookupError
            If an array or a column is missing, with its name.
        """
        if not self.kept:
            return self
        arrays, observer = stored.state_of(self), cast(Any, self)
        return replace(
            observer, **{name: _like(getattr(self, name), arrays[name]) for name in self.kept}
        )

    @property
    def state(self) -> Mapping[str, np.ndarray]:
        """Arrays, by name, from which `restore` makes the observer again; by default `kept`."""
        return {name: np.atleast_1d(getattr(self, name)) for name in self.kept}

    def complete(self, contact: State, block: int) -> State:
        """Return the contact of a block with the observer's results; unchanged by default.

        Parameters
        ----------
        contact : State
            Contact of the block.
        block : int
            Index of the block in a duty cycle; else 0.
        """
        return contact

    def record(self, model: Model, recorded: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return the values of the observer's columns for a record, by name; none by default.

        Parameters
        ----------
        model : Model
            Model of the process.
        recorded : mapping of str to object
            Values of the columns that are read from the contact.
        """
        return {}

    def record_block(self, block: int) -> Mapping[str, Any]:
        """Return the values of columns that each block of a duty cycle has; none by default."""
        return {}

    def record_fields(self, block: int) -> Mapping[str, np.ndarray]:
        """Return the `fields` in the contact of a block, by name, (n_x, n_y); none by default."""
        return {}

    def record_stress(self, block: int) -> tuple[PlaneStress | InclusionPassage, ...]:
        """Return the stress below a block's contact that is stored; none by default."""
        return ()

    @property
    def cycles(self) -> tuple[BodyFatigue, ...]:
        """Fatigue of the bodies in the last step, stored with the fields; none by default."""
        return ()

    def missed(self, model: Model) -> float:
        """Return the error of the last step over the tolerated one; 0 by default."""
        return 0.0

    @property
    def shortfall(self) -> str:
        """Message if steps are less accurate than the scene requires; empty by default.

        A history that ends with one has the status "inaccurate" and this message.
        """
        return ""

    def remark(self, model: Model) -> str:
        """Return text to append to the message of a history, "; ..."; empty by default."""
        return ""


def _like(initial: Any, stored: np.ndarray) -> Any:
    """Return a stored array in the type of an attribute: a number, a tuple, else the array."""
    if isinstance(initial, tuple):
        return tuple(stored.tolist()) if stored.ndim == 1 else tuple(stored)
    return type(initial)(stored[0]) if isinstance(initial, int | float) else stored


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
        """Share of each contact in the sums of the step; 1 each unless overridden.

        In a duty cycle it is the share of its load block in the revolutions.
        """
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
    first_applications: float = 60.0
    """Applications of the elastic operator that the first contact of a block typically takes, at a
    tolerance of 1e-8."""
    next_applications: float = 20.0
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

    def with_laws(self, laws: Any) -> Self:
        """Return the process with another elastic law of its model; itself if it is equal."""
        model = self.model.with_laws(laws)
        return self if model is self.model else self._copy_with(model)

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
        return replace(step, observed=observed) if observed or step.observed else step

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
        if observed:
            record = replace(record, values={**record.values, **observed})
        return record.with_fatigue(self._cycles(step))

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
        stress: list[PlaneStress | InclusionPassage] = []
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


SAFETY, SHORTEST_CUT, LONGEST_GROWTH = 0.8, 0.2, 2.0
"""Safety factor and bounds of the change of a step."""


@dataclass(frozen=True)
class Trial:
    """Length of a step to try, and the length that its error control would allow.

    Attributes
    ----------
    length : float
        Length of the step.
    wish : float
        Length that error control allows without stops.
    refused : bool
        Whether a longer step was refused; `wish` is then the length of this one.
    """

    length: float
    wish: float
    refused: bool = False


@dataclass(frozen=True)
class ErrorControl:
    """Choice of step lengths by an error estimate (Hairer, Norsett & Wanner 1993, II.4).

    Parameters
    ----------
    order : int
        Power of the length with which the error of a step grows.
    unit : float
        Unit of length: steps are integer multiples of it.
    """

    order: int
    unit: float = 1

    def shorter(self, step: Trial, error: float) -> Trial:
        """Return a shorter step to try after a refused one; `error` is over the tolerance."""
        length = self._round(min(step.length * self._change(error), step.length - self.unit))
        return Trial(length, length, refused=True)

    def next(self, step: Trial, error: float) -> float:
        """Return the length of the next step; after a refused one it does not grow."""
        change = self._change(error)
        return self._round(step.length * (min(change, 1.0) if step.refused else change))

    def _change(self, error: float) -> float:
        """Return the factor by which an error changes the step length, within limits."""
        change = SAFETY * max(error, 1e-9) ** (-1.0 / self.order)
        return min(max(change, SHORTEST_CUT), LONGEST_GROWTH)

    def _round(self, length: float) -> float:
        """Return a length rounded down to a multiple of the unit, at least one unit."""
        return max(1, int(length / self.unit)) * self.unit


@dataclass(frozen=True)
class Stops:
    """Error control of steps that must end at stops, for example at coordinates to save.

    Parameters
    ----------
    control : ErrorControl
        Error control of the steps.
    stops : tuple of float
        Places at which a step must end, ascending.
    approach : float
        Longest step over the distance to the next stop.
    """

    control: ErrorControl
    stops: tuple[float, ...]
    approach: float = 1.0

    def first(self, here: float, wish: float, settled: float) -> Trial:
        """Return the first step to try from a coordinate; the next stop limits its length."""
        distance = self.stops[bisect_right(self.stops, here)] - here
        unit = self.control.unit
        nearer = max(unit, settled, ceil(self.approach * distance / unit) * unit)
        return Trial(min(wish, distance, nearer), wish)

    def accepts(self, error: float) -> bool:
        """Return whether a step with this error, over the tolerance, is accepted."""
        return error <= 1.0

    def shorter(self, step: Trial, error: float) -> Trial:
        """Return a shorter step after a refused one, as `ErrorControl.shorter` does."""
        return self.control.shorter(step, error)

    def next(self, step: Trial, error: float) -> float:
        """Return the length of the next step; ending at a stop does not shorten it.

        After a step cut short by a stop, its wish counts again.
        """
        after = self.control.next(step, error)
        return max(after, step.wish) if step.length < step.wish else after


@dataclass(frozen=True)
class FixedSteps:
    """Step control with one step to each stop; it is halved only if it cannot be solved.

    The steps do not depend on the solution, so results are smooth functions of the entries of a
    scene, and finite differences give their derivatives.

    Parameters
    ----------
    stops : tuple of float
        Places at which steps end, ascending.
    """

    stops: tuple[float, ...]

    def first(self, here: float, wish: float, settled: float) -> Trial:
        """Return the step from a coordinate to the next stop."""
        distance = self.stops[bisect_right(self.stops, here)] - here
        return Trial(distance, distance)

    def accepts(self, error: float) -> bool:
        """Return whether the step was solved: its error is finite."""
        return isfinite(error)

    def shorter(self, step: Trial, error: float) -> Trial:
        """Return a refused step of half the length, at least 1; its error is not used."""
        length = max(1, int(0.5 * step.length))
        return Trial(length, length, refused=True)

    def next(self, step: Trial, error: float) -> float:
        """Return the length of the accepted step; it has no effect on the next one."""
        return step.length
