"""Observers: what follows the material of the bodies through the steps of a process."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar, Self

import numpy as np

from tractive_sam.contact import Model
from tractive_sam.results import BodyFatigue
from tractive_sam.scene import Scene


class Observation(ABC):
    """What an observer knows after a step.

    It owns its columns, its fields, what is stored of it to continue from, and its remarks. The
    steps of a process do not depend on it, but may be made shorter where it misses too much.
    """

    name: ClassVar[str]
    """Name under which steps know it."""
    key: ClassVar[str]
    """Table of the scene that asks for it."""

    @classmethod
    def asked_by(cls, scene: Scene) -> bool:
        """Whether a scene asks for it."""
        return scene.has(cls.key)

    @classmethod
    def bytes_needed(cls, model: Model) -> float:
        """Return the memory that it takes besides what is stored with records, bytes."""
        return 0.0

    @classmethod
    @abstractmethod
    def begin(cls, step: Any, model: Model) -> Self:
        """Return what is known after the first step."""

    @abstractmethod
    def after(self, step: Any, model: Model) -> Self:
        """Return what is known after a later step, perhaps on a wider mesh."""

    @classmethod
    @abstractmethod
    def restore(cls, step: Any, stored: Any) -> Self:
        """Return what was known after a stored step, a `StoredStep`.

        Raises
        ------
        LookupError
            If something is missing, with its name.
        """

    @abstractmethod
    def columns(self, model: Model, recorded: Mapping[str, Any]) -> dict[str, Any]:
        """Return its columns, given what the contact recorded under the same names."""

    def block_columns(self, block: int) -> dict[str, Any]:
        """Return the columns that a block of a duty cycle has by itself."""
        return {}

    @property
    def fields(self) -> tuple[BodyFatigue, ...]:
        """What is stored with the fields of a record."""
        return ()

    @property
    def state(self) -> Mapping[str, np.ndarray]:
        """Arrays to continue from, by name."""
        return {}

    def missed(self, model: Model) -> float:
        """Return what the last step missed over what the scene tolerates."""
        return 0.0

    def remark(self, model: Model) -> str:
        """Return what the message of a history has to add; begins with a semicolon."""
        return ""
