"""A recorded quantity: its name, unit and description, and how it is read off a contact."""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any, Self

from tractive_sam.results.state import State
from tractive_sam.scene import Scene

BODIES = ("A", "B")

DIMS = ((), ("axis",), ("y",), ("body",), ("body", "position"))
"""What a column of one's own can have beside the record."""


def _always(_scene: Scene) -> bool:
    return True


@dataclass(frozen=True)
class Quantity:
    """A recorded quantity.

    Attributes
    ----------
    name : str
        Its name, in files and in Python.
    unit : str
        Unit; "1" where it has none.
    long_name : str
        Description for people.
    of : callable, optional
        Reads it off a contact: a number; an array of its dimensions; of dimensions ("body", ...) a
        mapping from "A" and "B". What only the stepping knows has none.
    dims : tuple of str
        Its dimensions beside the record, one of `DIMS`: "y" is that of the mesh, "axis" (x, y),
        "body" (A, B), "position" (x, y, depth).
    symbol : str
        For math text in figures.
    label : str
        On axes of figures; by default its description.
    format : str
        Of a number in tables.
    whole : bool
        Whether it is a whole number, and known of every record.
    per_length : bool
        Whether it is per length in a line contact.
    needs : tuple of str
        Dotted keys of what a scene has to have for it, see `Scene.has`.
    when : callable
        What else has to hold of a scene.
    bodies_of : str
        Of dimensions ("body", ...): the table of the scene that lists its bodies; by default both.
    role : str
        What it is whatever its name: a column of one's own takes the place of the package's of the
        same role.

    Examples
    --------
    >>> share = ts.Quantity("share", "1", "P over E* a^2", lambda c: c.P / c.grid.element_area)
    >>> ts.roll(scene, columns=[share])["share"].shape
    (1,)
    """

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

    def __post_init__(self) -> None:
        """Refuse what would be no line of text, or no format of numbers, in an output.

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
            allowed = "a format of numbers such as .4g, of at most 99 places"
            raise ValueError(f"format of the column {self.name} is {self.format!r}; {allowed}")

    def applies(self, scene: Scene) -> bool:
        """Whether a scene has it."""
        return all(map(scene.has, self.needs)) and self.when(scene)

    def bodies(self, scene: Scene) -> tuple[str, ...]:
        """The bodies in which a scene has it, of dimensions ("body", ...)."""
        if not self.applies(scene):
            return ()
        return getattr(scene, self.bodies_of).bodies if self.bodies_of else BODIES

    def with_units_of(self, scene: Scene) -> Self:
        """Return the quantity as a scene has it: per length in a line contact."""
        unit = scene.contact_type.unit(self.unit) if self.per_length else self.unit
        if unit == self.unit:
            return self
        name = f"{self.long_name} per length"
        return replace(self, unit=unit, long_name=name, per_length=False)


def by_name(quantities: Iterable[Quantity]) -> dict[str, Quantity]:
    """Quantities by their names."""
    return {one.name: one for one in quantities}


COORDINATE = "coordinate"
"""Role of the column along which a history goes: revolutions, or a distance that grows."""


def of_role(columns: Iterable[Quantity], role: str) -> Quantity:
    """The one of a role, whatever its name.

    Raises
    ------
    LookupError
        If there is none.
    """
    for one in columns:
        if one.role == role:
            return one
    raise LookupError(f"no column is the {role}")
