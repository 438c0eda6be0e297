"""What is kept of one contact of a course."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tractive_sam.results.column_table import columns
from tractive_sam.results.fatigue import BodyFatigue
from tractive_sam.results.plane_stress import PlaneStress
from tractive_sam.results.quantity import COORDINATE, Quantity, of_role
from tractive_sam.results.state import State
from tractive_sam.results.stored_fields import BOUND, FIELDS, WARM


@dataclass(frozen=True, eq=False)
class Record:
    """One contact as numbers and arrays under the names of `results.column_table`.

    Attributes
    ----------
    values : mapping of str to object
        One for every column: a number, an array, or of bodies a mapping from "A" and "B".
    columns : mapping of str to Quantity
        What they are.
    fields : mapping of str to ndarray, shape (n_x, n_y)
        By the names of `FIELDS`; empty where they are not kept.
    stress : tuple of PlaneStress
        Stress on the planes that the scene asks for, kept with the fields; of a duty cycle that
        in each block.
    cycles : tuple of BodyFatigue
        What rolling has done to each body that [fatigue] names, kept with the fields.
    own_fields : mapping of str to Quantity
        Those of the fields that are not the package's.
    """

    values: Mapping[str, Any]
    columns: Mapping[str, Quantity]
    fields: Mapping[str, np.ndarray] = field(default_factory=dict)
    stress: tuple[PlaneStress, ...] = ()
    cycles: tuple[BodyFatigue, ...] = ()
    own_fields: Mapping[str, Quantity] = field(default_factory=dict)

    @classmethod
    def of(
        cls,
        contact: State,
        given: Mapping[str, Any],
        *,
        own: Iterable[Quantity] = (),
        with_fields: bool = True,
        stress: Iterable[PlaneStress] = (),
        own_fields: Mapping[Quantity, np.ndarray] | None = None,
    ) -> "Record":
        """Take the record of a contact.

        Parameters
        ----------
        contact : State
            The solved contact.
        given : mapping of str to object
            Columns that the stepping knows, or knows better; what only it knows is nan without.
        own : iterable of Quantity
            Columns beside those of `COLUMNS`.
        with_fields : bool
            Whether to keep the fields.
        stress : iterable of PlaneStress
            Stress on planes.
        own_fields : mapping of Quantity to ndarray, optional
            Fields beside those of `FIELDS`, shape (n_x, n_y).
        """
        names = columns(contact.scene, own)
        values = {
            name: given[name] if name in given else _read(one, contact)
            for name, one in names.items()
        }
        if not with_fields:
            return cls(values, names)
        warm = {} if contact.heat is None else {k: one.of(contact) for k, one in WARM.items()}
        own_values = {one.name: values for one, values in (own_fields or {}).items()}
        quantities = {one.name: one.with_units_of(contact.scene) for one in own_fields or {}}
        return cls(
            values,
            names,
            fields(contact) | warm | own_values,
            tuple(stress),
            own_fields=quantities,
        )

    @property
    def coordinate(self) -> Quantity:
        """The column along which its history goes."""
        return of_role(self.columns.values(), COORDINATE)

    @property
    def blocks(self) -> int:
        """Blocks of a duty cycle that its columns tell apart; none where they do not."""
        for name, one in self.columns.items():
            if "block" in one.dims:
                return np.shape(self.values[name])[one.dims.index("block")]
        return 0

    @property
    def at(self) -> float:
        """Its value of the coordinate."""
        return self.values[self.coordinate.name]

    @property
    def revolution(self) -> int:
        """Revolutions rolled before and in this one."""
        return int(self.values["revolution"])


def _read(one: Quantity, contact: State) -> Any:
    if one.of is not None:
        value = one.of(contact)
        along = {"axis": 2, "y": contact.grid.elements[1]}
        if "body" not in one.dims and np.shape(value) != (
            shape := tuple(along[k] for k in one.dims)
        ):
            raise ValueError(f"column {one.name}: {shape} is needed, not {np.shape(value)}")
        return value
    if one.dims[:1] == ("body",):
        return {}
    return np.full(contact.grid.elements[1], np.nan) if one.dims == ("y",) else np.nan


def fields(contact: State) -> dict[str, np.ndarray]:
    """Return all fields of a contact from which rolling continues: `FIELDS`, and its `BOUND`."""
    found = {name: one.of(contact) for name, one in FIELDS.items()}
    if contact.traction_bound is not None:
        found[BOUND.name] = contact.traction_bound
    return found
