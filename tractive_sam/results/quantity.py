"""Recorded quantities, and tables: arrays with named dimensions, of one or all records.

A `Quantity` has a name, a unit and a description, and reads itself from a contact. A record has a
table for its fields, and one for the stress on each plane, for the passage of each inclusion and
for the fatigue of each body, by paths as in the results file: "fields", "stress/A/y=0",
"stress/block-0/A/y=0", "passage/A/inclusion-1", "fatigue/A".
"""

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Generic, NamedTuple, Protocol, Self, TypeVar

import numpy as np

from tractive_sam.extra_packages import xarray
from tractive_sam.extras import check_extra
from tractive_sam.results.grid import Grid, widen_field
from tractive_sam.scene import Scene

BODIES = ("A", "B")

LABELS = {"axis": ("x", "y"), "body": BODIES, "position": ("x", "y", "depth")}
"""Labels along the dimensions of columns, except dimensions of the mesh."""

PREFIX = "block_"
"""Prefix of columns with a value for each block."""

PROFILES = ("wheel", "rail")
"""Dimensions along the nodes of the profile of a wheel or a rail."""

DIMS = ((), ("axis",), ("y",), ("body",), ("body", "position"))
"""Dimensions that a user-defined column may have in addition to the record."""


@dataclass(frozen=True)
class Quantity:
    """Description of a recorded quantity (column): name, unit, dimensions and how it is computed.

    Attributes
    ----------
    name : str
        Name in files and in Python.
    unit : str
        Unit; "1" if it has none.
    long_name : str
        Description for readers.
    of : callable, optional
        Function that reads it from a contact. It returns a number, an array of its dimensions, or
        for dimensions ("body", ...) a mapping from "A" and "B". None if only the process has it.
    dims : tuple of str
        Dimensions in addition to the record, one of `DIMS`: "y" of the mesh, "axis" (x, y),
        "body" (A, B), "position" (x, y, depth). Columns of the package may also have one of
        `PROFILES`.
    symbol : str
        Symbol as math text, for figures.
    label : str
        Label of axes in figures; by default the description.
    format : str
        Format of numbers in tables.
    whole : bool
        Whether its values are integers and exist in all records.
    per_length : bool
        Whether it is per length in a line contact.
    needs : tuple of str
        Dotted keys of entries that a scene must have for it, see `Scene.has`.
    when : callable, optional
        Further condition on a scene.
    bodies_of : str
        For dimensions ("body", ...): the table of the scene that lists its bodies; by default both.
    role : str
        Role of the column, independent of its name: a user-defined column replaces the column of
        the package with its role.
    over_blocks : str
        How a duty cycle combines the values of its blocks, one of `joined`; the mean is
        weighted with their revolutions.
    place_of, error_of : str
        Name of the column to which this position or error bar belongs.
    outside : float
        For a function of x and y: its value outside a mesh that has grown.

    Examples
    --------
    >>> share = ts.Quantity("share", "1", "P over E* a^2", lambda c: c.P / c.grid.element_area)
    >>> ts.roll(scene, columns=[share])["share"].shape
    (1,)
    """

    joined = ("mean", "largest", "smallest", "sum")
    """How the record of a duty cycle combines the values of its blocks."""

    name: str
    unit: str
    long_name: str
    of: Callable[[Any], Any] | None = field(default=None, compare=False)
    dims: tuple[str, ...] = ()
    symbol: str = ""
    label: str = ""
    format: str = ".4g"
    whole: bool = False
    per_length: bool = False
    needs: tuple[str, ...] = field(default=(), compare=False)
    when: Callable[[Scene], bool] | None = field(default=None, compare=False)
    bodies_of: str = field(default="", compare=False)
    role: str = ""
    over_blocks: str = "mean"
    place_of: str = ""
    error_of: str = ""
    outside: float = field(default=0.0, compare=False)

    def __post_init__(self) -> None:
        """Raise an error for text or formats that would break the lines of an output.

        Raises
        ------
        ValueError
            With the attribute, its value and what is allowed.
        """
        for name in ("name", "unit", "long_name", "symbol", "label", "format", "role"):
            text = getattr(self, name)
            if not isinstance(text, str) or not text.isprintable():
                raise ValueError(f"{name} of a column is {text!r}; allowed: one line of text")
        if not re.fullmatch(r"[-+ z#]*\d{0,2},?(\.\d{1,2})?[deEfFgG%]?", self.format, re.ASCII):
            allowed = "a format of numbers as in .4g, of at most 99 places"
            raise ValueError(f"format of the column {self.name} is {self.format!r}; {allowed}")
        if self.over_blocks not in self.joined:
            raise ValueError(
                f"over_blocks of the column {self.name} is {self.over_blocks!r}; allowed: "
                f"{', '.join(self.joined)}"
            )

    @property
    def attributes(self) -> dict[str, str]:
        """Unit and description, as attributes of a dataset."""
        return {"units": self.unit, "long_name": self.long_name}

    @property
    def is_profile(self) -> bool:
        """Whether the quantity is a function of position on the mesh or on a profile."""
        return not {"y", *PROFILES}.isdisjoint(self.dims)

    def applies(self, scene: Scene) -> bool:
        """Return whether histories of a scene have this column."""
        return all(map(scene.has, self.needs)) and (self.when is None or self.when(scene))

    def read(self, contact: Any) -> Any:
        """Return the value of the quantity in a contact; LookupError if only rolls have it.

        Raises
        ------
        LookupError
            If only the process has it.
        """
        if self.of is None:
            raise LookupError(
                f"{self.name} is not a quantity of a single contact: only a roll records it"
            )
        return self.of(contact)

    def bodies(self, scene: Scene) -> tuple[str, ...]:
        """Return the bodies ("A", "B") for which a scene has this quantity; empty if none."""
        if not self.applies(scene):
            return ()
        return getattr(scene, self.bodies_of).bodies if self.bodies_of else BODIES

    def with_units_of(self, scene: Scene) -> Self:
        """Return the quantity with the units of a scene: per length in a line contact."""
        unit = scene.contact_type.unit(self.unit) if self.per_length else self.unit
        if unit == self.unit:
            return self
        name = f"{self.long_name} per length"
        return replace(self, unit=unit, long_name=name, per_length=False)


def index_by_name(quantities: Iterable[Quantity]) -> dict[str, Quantity]:
    """Return a mapping from the names of quantities to the quantities."""
    return {quantity.name: quantity for quantity in quantities}


COORDINATE = "coordinate"
"""Role of the column that orders the records: revolutions, or a distance that grows."""


def find_by_role(columns: Iterable[Quantity], role: str) -> Quantity:
    """Return the column that has a role; a LookupError is raised if there is none.

    Raises
    ------
    LookupError
        If no column has this role.
    """
    for column in columns:
        if column.role == role:
            return column
    raise LookupError(f"no column has the role {role}")


def read_component(field: str, k: int, contact: Any) -> np.ndarray:
    """Return a component of a vector field of a contact, shape (n_x, n_y)."""
    return getattr(contact, field)[k]


def vectors(field: str, unit: str, text: str) -> list[Quantity]:
    """Return the quantities of both components of a vector field of a contact, as ``slip_x``."""
    return [
        Quantity(f"{field}_{axis}", unit, f"{direction} {text}", partial(read_component, field, k))
        for k, (axis, direction) in enumerate((("x", "longitudinal"), ("y", "lateral")))
    ]


def read_number(name: str, contact: Any) -> Any:
    """Return an attribute of a contact as numbers; 1 and 0 for true and false."""
    return 1.0 * getattr(contact, name)


def read_error_bar(name: str, bodies: Iterable[str], contact: Any) -> Any:
    """Return the error bar of a named quantity of a contact, or of each body; nan if none."""
    bars = contact.error_bars.get(name, {} if bodies else math.nan)
    return {body: bars.get(body, math.nan) for body in bodies} if bodies else bars


def error_bar_column(of: Quantity) -> Quantity:
    """Return the column "..._error" that holds the error bar of a quantity."""
    return replace(
        of,
        name=f"{of.name}_error",
        long_name=f"error bar of {of.name}",
        over_blocks="mean",
        error_of=of.name,
        of=partial(read_error_bar, of.name, BODIES if of.dims else ()),
        symbol="",
        needs=(*of.needs, "accuracy"),
    )


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
