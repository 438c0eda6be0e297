"""Observers follow the steps of a process without changing them."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from typing import Any, ClassVar, Self

import numpy as np

from tractive_sam.contact import Model
from tractive_sam.deprecation import renamed_attributes
from tractive_sam.description import Row
from tractive_sam.results import BodyFatigue, PlaneStress, Quantity, State
from tractive_sam.scene import Scene


@renamed_attributes(asked_by="applies_to")
class Observer(ABC):
    """The values of an observer after a step of a process, and its parameters.

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
    """Name in `Step.observed`; the names of its stored state begin with it."""
    key: ClassVar[str] = ""
    """Table of the scene that adds it; empty if a scene names it in [[observer]]."""
    unsolved: ClassVar[bool] = False
    """Whether it also follows steps with contacts that were not solved."""

    @property
    def columns(self) -> tuple[Quantity, ...]:
        """Columns that it records in addition to the package's."""
        return ()

    @property
    def fields(self) -> tuple[Quantity, ...]:
        """Functions of x and y that it stores with the fields of a record."""
        return ()

    @classmethod
    def applies_to(cls, scene: Scene) -> bool:
        """Return whether the scene has its table."""
        return bool(cls.key) and scene.has(cls.key)

    def describe(self, model: Model) -> Iterable[Row]:
        """Return the rows that `explain` prints for it; by default the first line of its docstring.

        They are printed below its table of the scene, or below "Observers".
        """
        summary = (type(self).__doc__ or type(self).__name__).strip().splitlines()[0]
        return [Row(self.name, summary)]

    def bytes_needed(self, model: Model) -> float:
        """Return the memory that it takes in addition to its stored records, bytes."""
        return 0.0

    @abstractmethod
    def begin(self, step: Any, model: Model) -> Self:
        """Return the observer after the first step; `step.observed` has the observers before it.

        Parameters
        ----------
        step : Step
            The first step.
        model : Model
            Model of the process.
        """

    @abstractmethod
    def after(self, step: Any, model: Model) -> Self:
        """Return the observer after a later step, which may be on a wider mesh.

        Parameters
        ----------
        step : Step
            The later step.
        model : Model
            Model of the process, on the mesh of the step.
        """

    @abstractmethod
    def restore(self, step: Any, stored: Any) -> Self:
        """Return the observer after a stored step.

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

    @property
    def state(self) -> Mapping[str, np.ndarray]:
        """Arrays to resume from, by name; each has at least one dimension."""
        return {}

    def complete(self, contact: State, block: int) -> State:
        """Return the contact of a block to record, completed by results of the observer.

        Parameters
        ----------
        contact : State
            Contact of the block.
        block : int
            Index of the block in a duty cycle; else 0.
        """
        return contact

    def record(self, model: Model, recorded: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return the values of its columns, given the values recorded from the contact.

        Parameters
        ----------
        model : Model
            Model of the process.
        recorded : mapping of str to object
            Values of the columns that are read from the contact.
        """
        return {}

    def record_block(self, block: int) -> Mapping[str, Any]:
        """Return the values of the columns that exist for each block of a duty cycle, by name."""
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
        """Return the error of the last step over the error that the scene tolerates."""
        return 0.0

    @property
    def shortfall(self) -> str:
        """Message that the steps are less accurate than the scene requires; empty if they are not.

        A history that ends with one has the status "inaccurate" and this message.
        """
        return ""

    def remark(self, model: Model) -> str:
        """Return an addition to the message of a history; it begins with a semicolon."""
        return ""
