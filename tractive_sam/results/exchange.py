"""A history as plain lists, as arrays of numbers, and as a dataset of xarray."""

import math
from itertools import product
from typing import Any

import numpy as np

from tractive_sam.optional import xarray
from tractive_sam.results.column_table import STRESSES
from tractive_sam.results.describe import balance_of
from tractive_sam.results.history_data import HistoryData
from tractive_sam.results.quantity import BODIES, LABELS, Quantity
from tractive_sam.results.stored_fields import storable_fields


def to_dict(history: HistoryData) -> dict[str, Any]:
    """Return columns (no profiles), balances, totals and status as plain lists; None for nan."""
    balance = balance_of(history)
    roles = {column.role for column in history.columns.values()}
    rows: dict[str, Any] = {} if "stress_max" in roles else {name: {} for name in STRESSES}
    for name, column in history.columns.items():
        if column.dims[:1] == ("body",):
            of_bodies = {
                body: history[name][:, BODIES.index(body)] for body in column.bodies(history.scene)
            }
            rows[name] = {body: values.tolist() for body, values in of_bodies.items()}
        elif not column.is_profile:
            rows[name] = history[name].tolist()
    rows |= {"energy_balance": balance.energy.tolist(), "wear_balance": balance.wear.tolist()}
    reference = {"a0": history.a0, "b0": history.b0, "p0": history.p0}
    about = {"status": history.status, "message": history.message} | reference
    return _without_nan({**about, **rows, **history.totals})


def numbers(history: HistoryData) -> dict[str, np.ndarray]:
    """Return all columns except profiles as arrays (n,), with names like "worn_mass A".

    Columns of a body, an axis or a position have names like "worn_mass A" and "p_max_at x".
    """
    arrays = {}
    for name, column in history.columns.items():
        if column.is_profile:
            continue
        of_dims = {**LABELS, "block": history.block_names}
        labels = [of_dims[dim] for dim in column.dims]
        if column.dims[:1] == ("body",):
            labels[0] = column.bodies(history.scene)
        for place in product(*labels):
            dims = zip(column.dims, place, strict=True)
            at: tuple[Any, ...] = (..., *(of_dims[dim].index(label) for dim, label in dims))
            arrays[" ".join((name, *place))] = history[name][at]
    return arrays


def to_dataset(history: HistoryData) -> "xarray.Dataset":
    """Return the columns and stored fields of a history as an xarray Dataset."""

    def about(quantity: Quantity) -> dict[str, str]:
        return {"units": quantity.unit, "long_name": quantity.long_name}

    along = history.coordinate
    data = {
        name: ((along.name, *column.dims), history[name], about(column))
        for name, column in history.columns.items()
        if column is not along
    }
    quantities = {**storable_fields(history.scene), **history.user_fields}
    for name, rows in history.fields.items():
        blocks = () if not history.block_names else (len(history.block_names),)
        values = np.empty((len(rows), *blocks, *history.grid.elements))
        for row in range(len(rows)):
            values[row] = rows[row]
        dims = ("saved", *("block" for _ in blocks), "x", "y")
        data[name] = (dims, values, about(quantities[name]))
    labels = {name: list(values) for name, values in LABELS.items()}
    if history.block_names:
        labels["block"] = list(history.block_names)
    coordinates = labels | {
        along.name: (along.name, history[along.name], about(along)),
        "saved": ("saved", history.saved, about(along)),
        "x": ("x", history.grid.x, {"units": "mm"}),
        "y": ("y", history.grid.y, {"units": "mm"}),
    }
    attributes = {"title": history.title, "status": history.status, "message": history.message}
    return xarray.Dataset(data, coordinates, attributes)


def _without_nan(value: Any) -> Any:
    """Return nested dictionaries and lists with None instead of nan and inf."""
    if isinstance(value, dict):
        return {key: _without_nan(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_without_nan(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
