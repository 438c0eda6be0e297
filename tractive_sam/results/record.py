"""The stored values of one contact of a history."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tractive_sam.results.column_table import columns
from tractive_sam.results.fatigue import BodyFatigue
from tractive_sam.results.plane_stress import PlaneStress
from tractive_sam.results.quantity import COORDINATE, PROFILES, Quantity, find_by_role
from tractive_sam.results.state import State
from tractive_sam.results.stored_fields import BOUND, FIELDS, HEAT_FIELDS


@dataclass(frozen=True, eq=False)
class Record:
    """One record of a history: values of its columns, and possibly fields and stresses.

    Attributes
    ----------
    values : mapping of str to object
        Values of all columns: a number, an array, or for bodies a mapping from "A" and "B".
    columns : mapping of str to Quantity
        Descriptions of the columns.
    fields : mapping of str to ndarray, shape (n_x, n_y)
        Fields by the names of `FIELDS`; empty if they are not stored.
    stress : tuple of PlaneStress
        Stress on the planes of the scene, stored with the fields; for a duty cycle of all blocks.
    cycles : tuple of BodyFatigue
        Fatigue of each body that [fatigue] names, stored with the fields.
    user_fields : mapping of str to Quantity
        Descriptions of user-defined fields.
    """

    values: Mapping[str, Any]
    columns: Mapping[str, Quantity]
    fields: Mapping[str, np.ndarray] = field(default_factory=dict)
    stress: tuple[PlaneStress, ...] = ()
    cycles: tuple[BodyFatigue, ...] = ()
    user_fields: Mapping[str, Quantity] = field(default_factory=dict)

    @classmethod
    def from_contact(
        cls,
        contact: State,
        process_values: Mapping[str, Any],
        *,
        user_columns: Iterable[Quantity] = (),
        chosen: dict[str, Quantity] | None = None,
        with_fields: bool = True,
        stress: Iterable[PlaneStress] = (),
        user_fields: Mapping[Quantity, np.ndarray] | None = None,
    ) -> "Record":
        """Return the record of a contact: values of all columns, and fields unless left out.

        Parameters
        ----------
        contact : State
            The solved contact.
        process_values : mapping of str to object
            Values that the process computes; they take precedence. Columns without a function of
            the contact are nan without them.
        user_columns : iterable of Quantity
            Columns in addition to `COLUMNS`.
        chosen : dict of str to Quantity, optional
            All columns by name, if they are known already.
        with_fields : bool
            Whether to store the fields.
        stress : iterable of PlaneStress
            Stress on planes.
        user_fields : mapping of Quantity to ndarray, optional
            Fields in addition to `FIELDS`, shape (n_x, n_y).
        """
        names = columns(contact.scene, user_columns) if chosen is None else chosen
        values = {
            name: process_values[name] if name in process_values else _read(column, contact)
            for name, column in names.items()
        }
        if not with_fields:
            return cls(values, names)
        warm = {}
        if contact.heat is not None:
            warm = {name: quantity.read(contact) for name, quantity in HEAT_FIELDS.items()}
        user_fields = user_fields or {}
        fields = restart_fields(contact) | warm | {k.name: v for k, v in user_fields.items()}
        quantities = {k.name: k.with_units_of(contact.scene) for k in user_fields}
        return cls(values, names, fields, tuple(stress), user_fields=quantities)

    @property
    def coordinate(self) -> Quantity:
        """Column by which the records of the history are ordered."""
        return find_by_role(self.columns.values(), COORDINATE)

    @property
    def lengths(self) -> dict[str, int]:
        """Lengths, by name, of the dimensions ("block", profiles) that differ between histories."""
        return {
            dim: np.shape(self.values[name])[column.dims.index(dim)]
            for name, column in self.columns.items()
            for dim in column.dims
            if dim in ("block", *PROFILES)
        }

    @property
    def at(self) -> float:
        """Value of the coordinate in this record, as its revolution or distance."""
        return self.values[self.coordinate.name]

    @property
    def revolution(self) -> int:
        """Number of revolutions rolled, including this one."""
        return int(self.values["revolution"])


def _read(column: Quantity, contact: State) -> Any:
    """Return a column in a contact, nan or {} if only rolls have it; check its shape."""
    if column.of is not None:
        value = column.of(contact)
        if not column.dims and isinstance(value, float):
            return value
        along = {"axis": 2, "y": contact.grid.elements[1]}
        if "body" not in column.dims and np.shape(value) != (
            shape := tuple(along[k] for k in column.dims)
        ):
            raise ValueError(
                f"column {column.name}: its shape must be {shape}, not {np.shape(value)}"
            )
        return value
    if column.dims[:1] == ("body",):
        return {}
    return np.full(contact.grid.elements[1], np.nan) if column.dims == ("y",) else np.nan


def restart_fields(contact: State) -> dict[str, np.ndarray]:
    """Return the fields of a contact that a resumed computation needs, by name."""
    values = {name: quantity.read(contact) for name, quantity in FIELDS.items()}
    if contact.traction_bound is not None:
        values[BOUND.name] = contact.traction_bound
    return values
