"""Collect values and fields of records into the parts of a history."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from tractive_sam.results.column_table import columns
from tractive_sam.results.fatigue import BodyFatigue
from tractive_sam.results.grid import Grid, widen_field
from tractive_sam.results.plane_stress import PlaneStress
from tractive_sam.results.quantity import (
    BODIES,
    COORDINATE,
    LABELS,
    PROFILES,
    Quantity,
    find_by_role,
)
from tractive_sam.results.record import Record
from tractive_sam.results.stored_fields import FIELDS, OUTSIDE
from tractive_sam.scene import Scene


def collect(records: Sequence[Record], scene: Scene, grid: Grid) -> dict[str, Any]:
    """Stack records to arrays: return the arguments of `History` (columns, values, fields, ...)."""
    with_fields = [record for record in records if record.fields]
    names = records[0].columns if records else columns(scene)
    coordinate = find_by_role(names.values(), COORDINATE)
    fields = dict.fromkeys(name for record in with_fields for name in record.fields) or FIELDS
    return {
        "columns": names,
        "values": {
            name: stack_values(column, [record.values[name] for record in records], grid)
            for name, column in names.items()
        },
        "fields": {name: [_widen(record, name, grid) for record in with_fields] for name in fields},
        "saved": np.array([r.at for r in with_fields], int if coordinate.whole else float),
        "stresses": _stresses_by_plane(with_fields),
        "cycles": _cycles_by_body(with_fields),
        "stresses_of_blocks": tuple(
            _stresses_by_plane(with_fields, k) for k, _ in enumerate(scene.duty)
        ),
        "user_fields": {k: v for record in with_fields for k, v in record.user_fields.items()},
    }


def _widen(record: Record, name: str, grid: Grid) -> np.ndarray:
    """Return a field on a mesh that may be wider: 0, inf or nan outside, all nan if missing."""
    if name not in record.fields:
        return np.full_like(record.fields["pressure"], np.nan)
    return widen_field(record.fields[name], grid.elements, OUTSIDE.get(name, 0.0))


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


def _stresses_by_plane(
    records: Sequence[Record], block: int | None = None
) -> dict[tuple[str, str], list[PlaneStress]]:
    """Return the stored stresses of all records by (body, plane), of one block or of no block."""
    first = records[0].stress if records else ()
    rows = {
        (stress.body, str(stress.plane)): [record.stress[k] for record in records]
        for k, stress in enumerate(first)
        if stress.block == block
    }
    return dict(sorted(rows.items()))  # as a file has them


def _cycles_by_body(records: Sequence[Record]) -> dict[str, list[BodyFatigue]]:
    """Return the stored `BodyFatigue` of all records, one list for each body."""
    bodies = (cycle.body for cycle in records[0].cycles) if records else ()
    return {body: [record.cycles[k] for record in records] for k, body in enumerate(bodies)}
