"""A recorded quantity: its name, unit and description, and how to read it from a contact."""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any, Self

from tractive_sam.results.state import State
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


def _always(_scene: Scene) -> bool:
    """Return True for any scene."""
    return True


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
    when : callable
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
    of: Callable[[State], Any] | None = field(default=None, compare=False)
    dims: tuple[str, ...] = ()
    symbol: str = ""
    label: str = ""
    format: str = ".4g"
    whole: bool = False
    per_length: bool = False
    needs: tuple[str, ...] = field(default=(), compare=False)
    when: Callable[[Scene], bool] = field(default=_always, compare=False)
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
        return all(map(scene.has, self.needs)) and self.when(scene)

    def read(self, contact: State) -> Any:
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
