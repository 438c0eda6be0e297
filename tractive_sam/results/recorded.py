"""What descriptions and balances read of a history: the part of `History` that they need."""

from collections.abc import Mapping, Sequence
from typing import Protocol, Self

import numpy as np

from tractive_sam.results.grid import Grid
from tractive_sam.results.quantity import Quantity
from tractive_sam.scene import Scene


class Recorded(Protocol):
    """Records of a computation; see `History` for what the members mean."""

    @property
    def scene(self) -> Scene:
        """What was computed."""

    @property
    def status(self) -> str:
        """How it ended."""

    @property
    def message(self) -> str:
        """What the status means."""

    @property
    def grid(self) -> Grid:
        """The mesh."""

    @property
    def columns(self) -> Mapping[str, Quantity]:
        """What was recorded."""

    @property
    def values(self) -> Mapping[str, np.ndarray]:
        """One row a record."""

    @property
    def saved(self) -> np.ndarray:
        """Places of the records with fields."""

    @property
    def law_records(self) -> Mapping[str, object]:
        """Laws that replaced those of the scene."""

    @property
    def provenance(self) -> tuple[tuple[int, Mapping[str, str]], ...]:
        """Programs that computed the records."""

    @property
    def started(self) -> str:
        """Where the worn bodies are from with which it began."""

    @property
    def coordinate(self) -> Quantity:
        """The column along which the history goes."""

    @property
    def title(self) -> str:
        """Title of the scene."""

    @property
    def bodies(self) -> tuple[str, ...]:
        """Bodies whose stress was computed."""

    @property
    def block_names(self) -> Sequence[str]:
        """Names of the blocks of a duty cycle."""

    @property
    def laws(self) -> str:
        """Laws that replaced those of the scene."""

    @property
    def totals(self) -> Mapping[str, float]:
        """Contacts solved and seconds spent."""

    @property
    def a0(self) -> float:
        """Semi-axis in x of the unworn contact, mm."""

    @property
    def b0(self) -> float:
        """Semi-axis in y, mm."""

    @property
    def p0(self) -> float:
        """Peak pressure of the unworn contact, MPa."""

    def __len__(self) -> int:
        """Number of records."""

    def __getitem__(self, name: str) -> np.ndarray:
        """A column, one row a record."""

    def of_dims(self, *dims: str) -> Mapping[str, Quantity]:
        """The columns of some dimensions."""

    def block(self, which: int | str) -> Self:
        """One block of a duty cycle as a history."""
