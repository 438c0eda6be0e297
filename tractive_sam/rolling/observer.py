"""Observers: what follows the steps of a process without changing them."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from typing import Any, ClassVar, Self

import numpy as np

from tractive_sam.contact import Model
from tractive_sam.description import Row
from tractive_sam.results import BodyFatigue, PlaneStress, Quantity, State
from tractive_sam.scene import Scene


class Observer(ABC):
    """What an observer knows after a step of a process, with its parameters.

    It owns its columns, its stored fields, its description and what it needs to resume. An object
    never changes: `begin`, `after` and `restore` return another one. The steps of a process do not
    depend on it, but may be made shorter where it misses too much.

    Examples
    --------
    >>> from dataclasses import dataclass, replace
    >>> @dataclass(frozen=True)
    ... class Peak(ts.Observer):
    ...     "Largest pressure so far."
    ...     name = "peak"
    ...     columns = (ts.Quantity("p_peak", "MPa", "largest pressure so far"),)
    ...     largest: float = 0.0
    ...     def begin(self, step, model):
    ...         return self.after(step, model)
    ...     def after(self, step, model):
    ...         return replace(self, largest=max(self.largest, step.contact.p_max))
    ...     def record(self, model, recorded):
    ...         return {"p_peak": self.largest}
    ...     @property
    ...     def state(self):
    ...         return {"largest": np.array([self.largest])}
    ...     def restore(self, step, stored):
    ...         return replace(self, largest=float(stored.state_of(self)["largest"][0]))
    >>> history = ts.roll(discs, observers=[Peak()])
    >>> bool(history["p_peak"][-1] == history["p_max"].max())
    True
    """

    name: ClassVar[str]
    """Name under which steps have it; its state is stored under names that begin with it."""
    key: ClassVar[str] = ""
    """Its table of the scene; empty where a scene names it in [[observer]]."""
    unsolved: ClassVar[bool] = False
    """Whether it also follows steps whose contacts were not solved."""

    @property
    def columns(self) -> tuple[Quantity, ...]:
        """Columns that it records besides those of the package."""
        return ()

    @property
    def fields(self) -> tuple[Quantity, ...]:
        """Functions of x and y that it stores with the fields of a record."""
        return ()

    @classmethod
    def asked_by(cls, scene: Scene) -> bool:
        """Whether the scene has its table."""
        return bool(cls.key) and scene.has(cls.key)

    def describe(self, model: Model) -> Iterable[Row]:
        """Return the rows that `explain` prints of it; by default the first line of its docstring.

        They are printed below its table of the scene, or below "Observers".
        """
        summary = (type(self).__doc__ or type(self).__name__).strip().splitlines()[0]
        return [Row(self.name, summary)]

    def bytes_needed(self, model: Model) -> float:
        """Return the memory that it takes besides what is stored with records, bytes."""
        return 0.0

    @abstractmethod
    def begin(self, step: Any, model: Model) -> Self:
        """Return what is known after the first step."""

    @abstractmethod
    def after(self, step: Any, model: Model) -> Self:
        """Return what is known after a later step, perhaps on a wider mesh."""

    @abstractmethod
    def restore(self, step: Any, stored: Any) -> Self:
        """Return what was known after a stored step.

        Parameters
        ----------
        step : Step
            The step, perhaps on a wider mesh than when it was stored.
        stored : StoredStep
            Its record; `stored.state_of(self)` has the arrays of `state`.

        Raises
        ------
        LookupError
            If something is missing, with its name.
        """

    @property
    def state(self) -> Mapping[str, np.ndarray]:
        """Arrays to resume from, by name; of at least one dimension."""
        return {}

    def complete(self, contact: State, block: int) -> State:
        """Return the contact of a block to record, with what only the observer knows of it."""
        return contact

    def record(self, model: Model, recorded: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return the values of its columns, given what the contact recorded."""
        return {}

    def record_block(self, block: int) -> Mapping[str, Any]:
        """Return the values of the columns that each block of a duty cycle has."""
        return {}

    def record_fields(self, block: int) -> Mapping[str, np.ndarray]:
        """Return the values of `fields` in the contact of a block, each of shape (n_x, n_y)."""
        return {}

    def record_stress(self, block: int) -> tuple[PlaneStress, ...]:
        """Return stress on planes in the contact of a block, to be stored with the fields."""
        return ()

    @property
    def cycles(self) -> tuple[BodyFatigue, ...]:
        """Fatigue of the bodies, to be stored with the fields."""
        return ()

    def missed(self, model: Model) -> float:
        """Return what the last step missed over what the scene tolerates."""
        return 0.0

    def remark(self, model: Model) -> str:
        """Return what the message of a history has to add; begins with a semicolon."""
        return ""
