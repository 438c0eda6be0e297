"""The record of a duty cycle, put together of those of its blocks.

A column of the cycle is the mean over its revolutions, where it is no largest or least value, no
sum and not what the stepping itself knows. Those of the blocks follow under names that begin with
``block_``, with a dimension more.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from tractive_sam.results.column_table import PARTS
from tractive_sam.results.column_table import columns as columns_of
from tractive_sam.results.quantity import BODIES, Quantity
from tractive_sam.results.record import Record
from tractive_sam.scene import Scene

PREFIX = "block_"
"""Of columns that tell the blocks apart."""

LARGEST = (
    "p_max",
    "p_95",
    "half_width_x",
    "half_width_y",
    "wear_max",
    "residual",
    "relative_error",
    "fi_surf",
    "temperature_max",
    "utilisation",
    "utilisation_interior",
    "utilisation_surface",
    "stress_max",
    "stress_interior",
    "stress_surface",
)
"""Names or roles of columns of which a cycle has the largest."""

LEAST = (
    "converged",
    "shakedown_lower",
    "shakedown_upper",
    "shakedown_interior",
    "shakedown_surface",
)
"""The same of the least."""

SUMS = ("operator_applications", "convolutions")


def cycle_record(
    records: Sequence[Record],
    revolutions: Sequence[int],
    stepped: Mapping[str, Any],
    scene: Scene,
    own: Iterable[Quantity] = (),
) -> Record:
    """Put the record of a cycle together.

    Parameters
    ----------
    records : sequence of Record
        Of the blocks, in order.
    revolutions : sequence of int
        Of each in a cycle.
    stepped : mapping of str to object
        What only the stepping knows of the cycle.
    scene : Scene
        That of the cycle.
    own : iterable of Quantity
        Columns beside the package's.
    """
    weights = np.array(revolutions, float) / sum(revolutions)
    names = columns_of(scene, [*own, *_others(records[0])])
    values = dict(stepped)
    for name, one in names.items():
        if name not in values:
            values[name] = _together(name, one, names, records, weights)
    for name, one in _told_apart(names, stepped):
        values[PREFIX + name] = _stacked(one, records)
    for name, one in _told_apart(names, stepped):
        names[PREFIX + name] = of_blocks(one)
    fields = {
        name: np.stack([record.fields[name] for record in records])
        for name in (records[0].fields if all(record.fields for record in records) else ())
    }
    stress = [replace(one, block=k) for k, of in enumerate(records) for one in of.stress]
    return Record(values, names, fields, tuple(stress), own_fields=records[0].own_fields)


def of_blocks(one: Quantity) -> Quantity:
    """The column of the blocks."""
    dims = ("block", *one.dims)
    name, told = PREFIX + one.name, f"{one.long_name}, of each block"
    return replace(one, name=name, long_name=told, dims=dims, of=None, role="", symbol="")


def _others(record: Record) -> list[Quantity]:
    """Columns in the place of the package's, such as those of another criterion."""
    return [one for one in record.columns.values() if one.role.startswith("stress")]


def _told_apart(
    names: Mapping[str, Quantity], stepped: Mapping[str, Any]
) -> Iterator[tuple[str, Quantity]]:
    """Columns that each block has of its own."""
    for name, one in list(names.items()):
        known = name in stepped or name.startswith(PREFIX) or name == PARTS.name
        if not known and "y" not in one.dims:
            yield name, one


def _together(
    name: str,
    one: Quantity,
    names: Mapping[str, Quantity],
    records: Sequence[Record],
    weights: np.ndarray,
) -> Any:
    """The value of a cycle."""
    each = [_value(record, one) for record in records]
    if name.endswith("_at"):  # where that is which it belongs to
        of = names[name.removesuffix("_at")]
        return _at_largest(of, each, [record.values[of.name] for record in records])
    if one.dims[:1] == ("body",):
        return {
            body: _combined(one, np.array([value[body] for value in each]), weights)
            for body in each[0]
        }
    return _combined(one, np.array(each, float), weights)


def _value(record: Record, one: Quantity) -> Any:
    """What a block has of a column; nan where it has none, as of creepages that are given."""
    if one.name in record.values:
        return record.values[one.name]
    return {} if one.dims[:1] == ("body",) else np.full([2] * len(one.dims), np.nan)


def _combined(one: Quantity, each: np.ndarray, weights: np.ndarray) -> Any:
    kinds = {one.name, one.role}
    if kinds.intersection(LARGEST):
        found = each.max(axis=0)
    elif kinds.intersection(LEAST):
        found = each.min(axis=0)
    elif one.name in SUMS:
        found = each.sum(axis=0)
    else:
        found = each[0] + np.tensordot(weights, each - each[0], axes=1)  # alike: as each
    return found if one.dims not in ((), ("body",)) else float(found)


def _at_largest(of: Quantity, places: Sequence[Any], values: Sequence[Any]) -> Any:
    """The place of the block whose value is that of the cycle."""
    most = min if {of.name, of.role}.intersection(LEAST) else max
    if of.dims[:1] == ("body",):
        return {
            body: places[most(range(len(values)), key=lambda k: values[k][body])][body]
            for body in places[0]
        }
    return places[most(range(len(values)), key=lambda k: values[k])]


def _stacked(one: Quantity, records: Sequence[Record]) -> np.ndarray:
    """Values of the blocks; of bodies in their order, nan of those that have none."""
    each = [_value(record, one) for record in records]
    if one.dims[:1] != ("body",):
        return np.array(each, float)
    size = (3,) if one.dims[1:] else ()
    none = np.full(size, np.nan)
    return np.array([[value.get(body, none) for body in BODIES] for value in each], float)
