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

    @abstractmethod
    def restore(self, step: Any, stored: Any) -> Self:
        """Return the observer as it was after a stored step, to resume from.

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
        """Arrays, by name, from which `restore` makes the observer again; none by default."""
        return {}

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

    def record_stress(self, block: int) -> tuple[PlaneStress, ...]:
        """Return the stress on planes below a block's contact, to store; none by default."""
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
