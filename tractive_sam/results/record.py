"""The stored values of one contact of a history, or of a duty cycle, and their collection.

A column of the cycle is the mean over its revolutions, unless it is an extreme value, a sum, or a
value that only the process of the cycle computes. The columns of the blocks follow under names
that begin with ``block_``, with one more dimension.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tractive_sam.results.column_table import PACKAGE_FIELDS, columns, storable_fields
from tractive_sam.results.grid import Grid, widen_field
from tractive_sam.results.heat import HEAT_FIELDS
from tractive_sam.results.quantity import (
    BODIES,
    COORDINATE,
    LABELS,
    PREFIX,
    PROFILES,
    CollectedTables,
    Quantity,
    Table,
    Variable,
    fields_table,
    find_by_role,
)
from tractive_sam.results.state import BOUND, FIELDS, State
from tractive_sam.results.stress import (
    FATIGUE_FIELDS,
    STRESS,
    BodyFatigue,
    InclusionPassage,
    PlaneStress,
)
from tractive_sam.scene import Scene


@dataclass(frozen=True, eq=False)
class Record:
    """One record of a history: values of its columns, and possibly fields and stresses.

    Attributes
    ----------
    values : mapping of str to object
        Values of all columns: a number, an array, or for bodies a mapping from "A" and "B".
    columns : mapping of str to Quantity
        Descriptions of the columns.
    tables : mapping of str to Table
        Fields, stress and fatigue by path, as "fields" and "stress/A/y=0"; empty if none are
        stored.
    """

    values: Mapping[str, Any]
    columns: Mapping[str, Quantity]
    tables: Mapping[str, Table] = field(default_factory=dict)

    @classmethod
    def from_contact(
        cls,
        contact: State,
        process_values: Mapping[str, Any],
        *,
        user_columns: Iterable[Quantity] = (),
        chosen: dict[str, Quantity] | None = None,
        with_fields: bool = True,
        stress: Iterable[PlaneStress | InclusionPassage] = (),
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
        stress : iterable of PlaneStress and InclusionPassage
            Stress on planes, and passages of inclusions.
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
        fields, quantities = restart_fields(contact), storable_fields(contact.scene)
        for name in HEAT_FIELDS:
            if name in quantities and (array := quantities[name].read(contact)) is not None:
                fields[name] = array
        for quantity, array in (user_fields or {}).items():
            fields[quantity.name] = array
            quantities[quantity.name] = quantity.with_units_of(contact.scene)
        tables = {one.path: one.table for one in stress}
        tables["fields"] = fields_table(fields, quantities, contact.grid)
        return cls(values, names, tables)

    @property
    def fields(self) -> dict[str, np.ndarray]:
        """Fields by name, shape (n_x, n_y); empty if they are not stored."""
        table = self.tables.get("fields")
        return {} if table is None else {name: v.data for name, v in table.variables.items()}

    def with_fatigue(self, cycles: Iterable[BodyFatigue]) -> "Record":
        """Return the record with the fatigue of bodies, which is stored with the fields."""
        if not self.tables:
            return self
        fatigue = {f"fatigue/{cycle.body}": cycle.table for cycle in cycles}
        return replace(self, tables={**self.tables, **fatigue})

    @property
    def coordinate(self) -> Quantity:
        """Column by which the records of the history are ordered."""
        return find_by_role(self.columns.values(), COORDINATE)

    @property
    def at(self) -> float:
        """Value of the coordinate in this record, as its revolution or distance."""
        return self.values[self.coordinate.name]

    @property
    def revolution(self) -> int:
        """Number of revolutions rolled, including this one."""
        return int(self.values["revolution"])


TABLE_QUANTITIES = {
    "fields": PACKAGE_FIELDS,
    "stress": STRESS,
    "passage": InclusionPassage.quantities,
    "fatigue": FATIGUE_FIELDS,
}
"""Variables of the package in tables, by the first part of their paths."""


def column_axes(columns: Mapping[str, Quantity], values: Mapping[str, Any]) -> dict[str, Variable]:
    """Return labels or nodes along each dimension of columns, except dimensions of the mesh.

    Parameters
    ----------
    columns : mapping of str to Quantity
        The columns.
    values : mapping of str to object
        Their values; needed for columns along blocks and profiles, whose lengths differ.
    """
    axes: dict[str, Variable] = {}
    for name, column in columns.items():
        for k, dim in enumerate(column.dims):
            if dim in (*axes, "y"):
                continue
            data: Any = LABELS.get(dim)
            about = "component" if dim in ("axis", "position") else dim
            if dim in PROFILES:
                data = np.arange(np.shape(values[name])[k])
                about = f"nodes of the profile of the {dim}"
            elif data is None:
                data = [str(place + 1) for place in range(np.shape(values[name])[k])]
            axes[dim] = Variable(Quantity(dim, "1", about), (dim,), data)
    return axes


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


def cycle_record(
    records: Sequence[Record],
    revolutions: Sequence[int],
    process_values: Mapping[str, Any],
    scene: Scene,
    user_columns: Iterable[Quantity] = (),
) -> Record:
    """Combine the records of the blocks of a duty cycle into the record of the cycle.

    Parameters
    ----------
    records : sequence of Record
        Records of the blocks, in order.
    revolutions : sequence of int
        Revolutions of each block in a cycle.
    process_values : mapping of str to object
        Values that only the process of the cycle computes.
    scene : Scene
        Scene of the cycle.
    user_columns : iterable of Quantity
        User-defined columns.
    """
    weights = np.array(revolutions, float) / sum(revolutions)
    stress = [column for column in records[0].columns.values() if column.role.startswith("stress")]
    names = columns(scene, [*user_columns, *stress])
    values = dict(process_values)
    for name, quantity in names.items():
        if name not in values:
            values[name] = _combine_blocks(name, quantity, names, records, weights)
    for name, quantity in _block_quantities(names, process_values):
        values[PREFIX + name] = _stack_blocks(quantity, records)
    for name, quantity in _block_quantities(names, process_values):
        names[PREFIX + name] = replace(
            quantity,
            name=PREFIX + name,
            long_name=f"{quantity.long_name}, of each block",
            dims=("block", *quantity.dims),
            of=None,
            role="",
            symbol="",
        )
    tables: dict[str, Table] = {}
    if all(record.tables for record in records):
        first = records[0].tables["fields"]
        tables["fields"] = fields_table(
            {name: np.stack([r.fields[name] for r in records]) for name in first.variables},
            {name: variable.quantity for name, variable in first.variables.items()},
        )
        tables |= {
            path.replace("/", f"/block-{k}/", 1): table
            for k, record in enumerate(records)
            for path, table in record.tables.items()
            if path.startswith(("stress/", "passage/"))
        }
    return Record(values, names, tables)


def _block_quantities(
    names: Mapping[str, Quantity], process_values: Mapping[str, Any]
) -> Iterator[tuple[str, Quantity]]:
    """Yield (name, column) of the columns of a cycle that have a value in each block."""
    for name, quantity in list(names.items()):
        joint = name in process_values or "block" in quantity.dims
        if not joint and not quantity.is_profile:
            yield name, quantity


def _combine_blocks(
    name: str,
    quantity: Quantity,
    names: Mapping[str, Quantity],
    records: Sequence[Record],
    weights: np.ndarray,
) -> Any:
    """Return the value of a column for the cycle (mean, sum, extreme, ...) from its blocks."""
    each = [_value_or_nan(record, quantity) for record in records]
    if quantity.place_of:
        of = names[quantity.place_of]
        return _place_of_extreme(of, each, [record.values[of.name] for record in records])
    if quantity.dims[:1] == ("body",):
        return {
            body: _combine(quantity, np.array([value[body] for value in each]), weights)
            for body in each[0]
        }
    return _combine(quantity, np.array(each, float), weights)


def _value_or_nan(record: Record, quantity: Quantity) -> Any:
    """Return the value of a column in a block; if missing, nan, or {} for a column of bodies."""
    if quantity.name in record.values:
        return record.values[quantity.name]
    return {} if quantity.dims[:1] == ("body",) else np.full([2] * len(quantity.dims), np.nan)


def _combine(quantity: Quantity, each: np.ndarray, weights: np.ndarray) -> Any:
    """Combine values of the blocks by the rule of a column: mean, sum, largest or smallest."""
    match quantity.over_blocks:
        case "largest":
            value = each.max(axis=0)
        case "smallest":
            value = each.min(axis=0)
        case "sum":
            value = each.sum(axis=0)
        case _:  # a mean that is exact for equal values
            value = each[0] + np.tensordot(weights, each - each[0], axes=1)
    return value if quantity.dims not in ((), ("body",)) else float(value)


def _place_of_extreme(of: Quantity, places: Sequence[Any], values: Sequence[Any]) -> Any:
    """Return the position from the block in which the column `of` has its extreme value."""
    extreme = min if of.over_blocks == "smallest" else max
    if of.dims[:1] == ("body",):
        return {
            body: places[extreme(range(len(values)), key=lambda k: values[k][body])][body]
            for body in places[0]
        }
    return places[extreme(range(len(values)), key=lambda k: values[k])]


def _stack_blocks(quantity: Quantity, records: Sequence[Record]) -> np.ndarray:
    """Return the values of a column in all blocks as an array; nan for bodies without a value."""
    each = [_value_or_nan(record, quantity) for record in records]
    if quantity.dims[:1] != ("body",):
        return np.array(each, float)
    size = (3,) if quantity.dims[1:] else ()
    none = np.full(size, np.nan)
    return np.array([[value.get(body, none) for body in BODIES] for value in each], float)


def collect(records: Sequence[Record], scene: Scene, grid: Grid) -> dict[str, Any]:
    """Stack records to arrays: return the arguments of `History` (columns, values, fields, ...)."""
    with_fields = [record for record in records if record.tables]
    names = records[0].columns if records else columns(scene)
    coordinate = find_by_role(names.values(), COORDINATE)
    parts: dict[str, list[Table]] = {"fields": []}
    for record in with_fields:
        for values in record.fields.values():
            widen_field(values, grid.elements)  # raises an error now, not when a field is read
        for path, table in record.tables.items():
            parts.setdefault(path, []).append(table)
    quantities = {
        path: {name: v.quantity for table in tables for name, v in table.variables.items()}
        for path, tables in parts.items()
    }
    return {
        "columns": names,
        "values": {
            name: stack_values(column, [record.values[name] for record in records], grid)
            for name, column in names.items()
        },
        "tables": {
            path: CollectedTables(parts[path], quantities[path] or FIELDS, grid)
            for path in sorted(parts)  # as in a file
        },
        "saved": np.array([r.at for r in with_fields], int if coordinate.whole else float),
    }


def stack_values(quantity: Quantity, values: Sequence[Any], grid: Grid) -> np.ndarray:
    """Stack values of a column, one a record, to an array; values along a mesh are widened."""
    along = {"x": grid.elements[0], "y": grid.elements[1]}
    for dim in {"block", *PROFILES}.intersection(quantity.dims):
        along[dim] = np.shape(values[0])[quantity.dims.index(dim)] if len(values) else 0
    shape = tuple(along[k] if k in along else len(LABELS[k]) for k in quantity.dims)
    rows = np.empty((len(values), *shape), int if quantity.whole else float)
    for row, value in zip(rows, values, strict=True) if shape else ():
        if quantity.dims[0] == "body":
            row[:] = np.nan
            for body, of_body in value.items():
                row[BODIES.index(body)] = of_body
        else:
            mesh = tuple(along[name] for name in quantity.dims if name in ("x", "y"))
            row[:] = widen_field(np.asarray(value, float), mesh) if mesh else value
    if not shape:
        rows[:] = values
    return rows
