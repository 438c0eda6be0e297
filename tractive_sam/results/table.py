"""Tables: arrays with named dimensions, a part of one record or of all records of a history.

A record has a table for its fields, and one for the stress on each plane, for the passage of each
inclusion and for the fatigue of each body, by paths as in the results file: "fields",
"stress/A/y=0", "stress/block-0/A/y=0", "passage/A/inclusion-1", "fatigue/A".
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, NamedTuple, Protocol, TypeVar

import numpy as np

from tractive_sam.extra_packages import xarray
from tractive_sam.extras import check_extra
from tractive_sam.results.grid import Grid, widen_field
from tractive_sam.results.quantity import Quantity

MESH_AXES = {
    "x": Quantity("x", "mm", "centres of the elements in the rolling direction"),
    "y": Quantity("y", "mm", "centres of the elements in the lateral direction"),
}
"""Dimensions of the mesh."""


class Variable(NamedTuple):
    """A quantity with dimensions.

    Attributes
    ----------
    quantity : Quantity
        Its name, unit and description.
    dims : tuple of str
        Names of the dimensions of its array.
    data : ndarray
        Its values.
    """

    quantity: Quantity
    dims: tuple[str, ...]
    data: Any


@dataclass(frozen=True, eq=False)
class Table:
    """Arrays with named dimensions, like a dataset of xarray.

    Attributes
    ----------
    variables : mapping of str to Variable
        The arrays.
    axes : mapping of str to Variable
        Coordinates along dimensions.
    attributes : mapping
        Numbers and objects that belong to all arrays; a file stores the numbers.
    """

    variables: Mapping[str, Variable]
    axes: Mapping[str, Variable] = field(default_factory=dict)
    attributes: Mapping[str, Any] = field(default_factory=dict)

    def __getitem__(self, name: str) -> np.ndarray:
        """Return the array of a variable or an axis."""
        return (self.variables.get(name) or self.axes[name]).data

    def __contains__(self, name: str) -> bool:
        return name in self.variables or name in self.axes

    def to_xarray(self) -> "xarray.Dataset":
        """Return the table as a dataset of xarray, with units and descriptions.

        Raises
        ------
        ImportError
            If xarray is not installed; the extra ``study`` installs it.
        """
        check_extra("xarray", "to_xarray")
        data, axes = (
            {name: (v.dims, v.data, v.quantity.attributes) for name, v in variables.items()}
            for variables in (self.variables, self.axes)
        )
        return xarray.Dataset(data, axes)


T_co = TypeVar("T_co", covariant=True)


class Rows(Protocol[T_co]):
    """Sequence of fields, one a stored record, read from memory or from a file when accessed."""

    def __len__(self) -> int:
        """Number of records with fields."""

    def __getitem__(self, row: int) -> T_co:
        """Return the field of one record."""


class TableRows(Rows[Table], Protocol):
    """Sequence of the tables of one path, one a stored record."""

    @property
    def quantities(self) -> Mapping[str, Quantity]:
        """Descriptions of the variables, by name."""

    def read(self, name: str, row: int) -> np.ndarray:
        """Return one variable of one record, on the mesh of the history."""


@dataclass(frozen=True, eq=False)
class CollectedTables:
    """Tables of one path in all records, in memory.

    Attributes
    ----------
    tables : sequence of Table
        The tables of the records.
    quantities : mapping of str to Quantity
        Descriptions of the variables, by name.
    grid : Grid
        The last mesh, which is the widest.
    """

    tables: Sequence[Table]
    quantities: Mapping[str, Quantity]
    grid: Grid

    def __len__(self) -> int:
        return len(self.tables)

    def __getitem__(self, row: int) -> Table:
        return self.tables[row]

    def read(self, name: str, row: int) -> np.ndarray:
        """Return one field on the last mesh: `outside` around the former one, nan if missing."""
        table = self.tables[row]
        if name not in table:
            return np.full_like(next(iter(table.variables.values())).data, np.nan)
        return widen_field(table[name], self.grid.elements, self.quantities[name].outside)


@dataclass(frozen=True, eq=False)
class View(Generic[T_co]):
    """Sequence of objects, one a stored record, each made when it is accessed.

    Attributes
    ----------
    length : int
        Number of records.
    make : callable
        Makes the object of a row.
    """

    length: int
    make: Callable[[int], T_co]

    def __len__(self) -> int:
        return self.length

    def __getitem__(self, row: int) -> T_co:
        return self.make(range(self.length)[row])


def fields_table(
    fields: Mapping[str, np.ndarray], quantities: Mapping[str, Quantity], grid: Grid | None = None
) -> Table:
    """Return the table of fields over ([block,] x, y) with the descriptions of all fields."""
    dims = ("block", "x", "y")
    variables = {
        name: Variable(quantities[name], dims[-values.ndim :], values)
        for name, values in fields.items()
    }
    centres = {} if grid is None else {"x": grid.x, "y": grid.y}
    return Table(variables, {k: Variable(MESH_AXES[k], (k,), at) for k, at in centres.items()})
