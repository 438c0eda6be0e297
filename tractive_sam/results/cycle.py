"""The record of a duty cycle, combined from the records of its blocks.

A column of the cycle is the mean over its revolutions, unless it is an extreme value, a sum, or a
value that only the process of the cycle computes. The columns of the blocks follow under names
that begin with ``block_``, with one more dimension.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from tractive_sam.results.column_table import columns as columns_of
from tractive_sam.results.quantity import BODIES, PREFIX, Quantity
from tractive_sam.results.record import Record
from tractive_sam.scene import Scene


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
    names = columns_of(scene, [*user_columns, *_replacing_columns(records[0])])
    values = dict(process_values)
    for name, quantity in names.items():
        if name not in values:
            values[name] = _combine_blocks(name, quantity, names, records, weights)
    for name, quantity in _block_quantities(names, process_values):
        values[PREFIX + name] = _stack_blocks(quantity, records)
    for name, quantity in _block_quantities(names, process_values):
        names[PREFIX + name] = block_quantity(quantity)
    fields = {
        name: np.stack([record.fields[name] for record in records])
        for name in (records[0].fields if all(record.fields for record in records) else ())
    }
    stress = [
        replace(plane, block=k) for k, record in enumerate(records) for plane in record.stress
    ]
    return Record(values, names, fields, tuple(stress), user_fields=records[0].user_fields)


def block_quantity(quantity: Quantity) -> Quantity:
    """Return the column "block_..." with the values of a column in each block of a duty cycle."""
    dims = ("block", *quantity.dims)
    name, text = PREFIX + quantity.name, f"{quantity.long_name}, of each block"
    return replace(quantity, name=name, long_name=text, dims=dims, of=None, role="", symbol="")


def _replacing_columns(record: Record) -> list[Quantity]:
    """Return the stress columns of a record, which replace columns of the package."""
    return [column for column in record.columns.values() if column.role.startswith("stress")]


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
