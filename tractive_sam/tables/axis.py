"""Axes of a table besides the creepages: any keys of a scene."""

from collections.abc import Iterator
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np

from tractive_sam.lookup import check_axis_name
from tractive_sam.scene import Scene
from tractive_sam.schema import Check, Fault, ValidEntries, optional, shorten
from tractive_sam.studies import Axis


def _check_name(entries: ValidEntries) -> Iterator[Fault]:
    """Report an axis of a table with an invalid name."""
    name = entries["name"] or _default_name(entries["key"])
    try:
        check_axis_name(name, further=True)
    except ValueError as error:
        yield Fault("name", shorten(name), str(error))


def _default_name(key: str) -> str:
    """Return the name of an axis from its key: the last part (wheelset.y: wheelset_y)."""
    return "wheelset_y" if key == "wheelset.y" else key.rpartition(".")[2]


def _check_positions(entries: ValidEntries) -> Iterator[Fault]:
    """Report an axis of a table whose values lack ascending numeric positions, one for each."""
    values, at = entries["values"], entries["at"]
    if values is None:  # a range of numbers
        return
    if at is None:
        if not all(map(_is_number, values)):
            needed = "a number for each of the values, ascending: their places along the axis"
            yield Fault("at", "nothing, with values that are not numbers", needed)
        elif _does_not_ascend(values):
            yield Fault("values", shorten(values), "ascending numbers, each once")
    elif len(at) != len(values):
        yield Fault("at", f"{len(at)} numbers", f"{len(values)}, as many as there are values")


def _check_ascending(entries: ValidEntries) -> Iterator[Fault]:
    """Report positions or ranges of an axis that do not ascend."""
    start, stop = entries["start"], entries["stop"]
    if entries["at"] is not None and _does_not_ascend(entries["at"]):
        yield Fault("at", shorten(entries["at"]), "ascending numbers, each once")
    if start is not None and stop is not None and stop < start:
        yield Fault("stop", shorten(stop), "more than start")


def _does_not_ascend(values: tuple[float, ...]) -> bool:
    """Return whether numbers do not ascend strictly."""
    return any(low >= high for low, high in pairwise(values))


def _is_number(value: object) -> bool:
    """Return whether a value is a number and not a bool."""
    return isinstance(value, int | float) and not isinstance(value, bool)


class TableAxis(Axis):
    """Axis of a creep-force table: keys that vary together; numbers are interpolated, files not.

    Numbers, and lists of them, are interpolated, and nodes are added between them. Other values,
    for example files of gaps, are discrete.

    Examples
    --------
    >>> from tractive_sam.tables import TableAxis
    >>> ratio = {"name": "mu2_over_mu1", "at": [0.5, 1.0]}
    >>> axis = TableAxis(key="friction.mu", values=[[0.3, 0.15], [0.3, 0.3]], **ratio)
    >>> axis.entries_at(0.75)["friction.mu"]
    [0.3, 0.225]
    """

    name: str | None = optional(
        "what a table calls it", "a name; by default the last part of the key"
    )
    at: tuple[float, ...] | None = optional(
        "places of the values along the axis", "ascending numbers; the values by default"
    )
    checks: ClassVar[tuple[Check, ...]] = (
        *Axis.checks,
        _check_name,
        _check_positions,
        _check_ascending,
    )

    @property
    def label(self) -> str:
        """Name of the axis in a table."""
        return self.name or _default_name(self.key)

    @property
    def nodes(self) -> np.ndarray:
        """Positions of the values along the axis, the first nodes of the table."""
        return np.array(self.column() if self.at is None else self.at, float)

    @property
    def apart(self) -> bool:
        """Whether the values are discrete (files), so that none are interpolated."""
        return not all(map(_is_interpolated, self.dimension().columns.items()))

    def entries_at(self, x: float) -> dict[str, Any]:
        """Return the values of the scene keys at a position x along the axis, by key."""
        columns, nodes = self.dimension().columns, self.nodes
        near = int(np.abs(nodes - x).argmin())
        if nodes[near] == x or self.apart:
            return {key: column[near] for key, column in columns.items()}
        return {key: _interpolate(x, nodes, column) for key, column in columns.items()}


def _is_interpolated(item: tuple[str, tuple[Any, ...]]) -> bool:
    """Return whether the values of a non-integer key are numbers, or number lists of one length."""
    key, column = item
    if Scene.find_field(key).annotation is int:
        return False
    lists = [value for value in column if isinstance(value, list | tuple)]
    if lists:
        alike = len(lists) == len(column) and len(set(map(len, lists))) == 1
        return alike and all(_is_number(x) for row in lists for x in row)
    return all(map(_is_number, column))


def _interpolate(x: float, nodes: np.ndarray, column: tuple[Any, ...]) -> Any:
    """Return the value of a key, a number or a list, interpolated at a position x."""
    if isinstance(column[0], list | tuple):
        return [float(np.interp(x, nodes, values)) for values in zip(*column, strict=True)]
    return float(np.interp(x, nodes, column))
