"""The part of `History` that descriptions and balances read."""

from collections.abc import Mapping, Sequence
from typing import Protocol, Self, TypeVar

import numpy as np

from tractive_sam.mechanics import Frame
from tractive_sam.results.grid import Grid
from tractive_sam.results.law_record import LawRecord
from tractive_sam.results.plane_stress import PlaneStress
from tractive_sam.results.quantity import Quantity
from tractive_sam.scene import Scene

T_co = TypeVar("T_co", covariant=True)


class Rows(Protocol[T_co]):
    """Sequence of fields, one a stored record, read from memory or from a file when accessed."""

    def __len__(self) -> int:
        """Number of records with fields."""

    def __getitem__(self, row: int) -> T_co:
        """Return the field of one record."""


class Recorded(Protocol):
    """Protocol of a history: the members of `History` on which its functions depend."""

    @property
    def scene(self) -> Scene:
        """The computed scene."""

    @property
    def status(self) -> str:
        """State of the computation: "done", "running", or the reason why it ended early."""

    @property
    def message(self) -> str:
        """Meaning of the status."""

    @property
    def grid(self) -> Grid:
        """The mesh of the last record."""

    @property
    def columns(self) -> Mapping[str, Quantity]:
        """Descriptions of the columns."""

    @property
    def values(self) -> Mapping[str, np.ndarray]:
        """Values of the columns by name, one row a record."""

    @property
    def fields(self) -> Mapping[str, Rows[np.ndarray]]:
        """Stored fields by name, one a record that has fields."""

    @property
    def user_fields(self) -> Mapping[str, Quantity]:
        """Descriptions of the fields of user-defined observers."""

    @property
    def stresses_of_blocks(self) -> Sequence[Mapping[tuple[str, str], Rows[PlaneStress]]]:
        """Stored stresses of each block of a duty cycle."""

    @property
    def saved(self) -> np.ndarray:
        """Values of the coordinate of the records with fields."""

    @property
    def law_records(self) -> Mapping[str, LawRecord]:
        """User-defined laws that replaced laws of the scene, by table of the scene."""

    @property
    def frame(self) -> Frame | None:
        """Scaled tribological frame of the friction law."""

    @property
    def provenance(self) -> tuple[tuple[int, Mapping[str, str]], ...]:
        """Versions of the programs that computed the records, with the first record of each."""

    @property
    def started(self) -> str:
        """Source of the worn bodies with which the history began; may be empty."""

    @property
    def coordinate(self) -> Quantity:
        """Column by which the records are ordered."""

    @property
    def title(self) -> str:
        """Title of the scene."""

    @property
    def bodies(self) -> tuple[str, ...]:
        """Bodies with computed stress."""

    @property
    def block_names(self) -> Sequence[str]:
        """Names of the blocks of a duty cycle."""

    @property
    def laws(self) -> str:
        """User-defined laws that replaced laws of the scene, in one line of text."""

    @property
    def totals(self) -> Mapping[str, float]:
        """Sums over all records: contacts solved and seconds."""

    @property
    def a0(self) -> float:
        """Semi-axis in x of the unworn contact by Hertz, mm."""

    @property
    def b0(self) -> float:
        """Semi-axis in y of the unworn contact by Hertz, mm."""

    @property
    def p0(self) -> float:
        """Peak pressure of the unworn contact by Hertz, MPa."""

    def __len__(self) -> int:
        """Number of records."""

    def __getitem__(self, name: str) -> np.ndarray:
        """Return a column, one row a record."""

    def of_dims(self, *dims: str) -> Mapping[str, Quantity]:
        """Return the columns with just these dimensions."""

    def block(self, which: int | str) -> Self:
        """Return one block of a duty cycle, by index or name, as a history."""
