"""Groups, datasets and dimensions of a results file.

    /scene     the TOML text; attributes: status, message, a0, b0, p0, totals, versions
    /grid      x, y
    /history   record, committed, y, axis; scalars (record,), points (record, axis),
               profiles (record, y)
    /fields    record, revolution, x, y; fields (record, x, y)

A netCDF reader seeks the dimensions of a variable in its own group: /grid/x and /grid/y are hard
linked into the groups that need them. The record of a row of /fields is its row in /history.
"""

import math
from collections.abc import Mapping

import h5py
import numpy as np

from tractive_sam.record import FIELDS, POINTS, PROFILES, SCALARS, Quantity
from tractive_sam.store.versions import versions

FORMAT = "tractive-sam history"
FORMAT_VERSION = 1
"""Raised when a reader of the former version would misread the file."""

RUNNING = ("running", "the computation has not ended yet, or was killed")
"""Status and message until the end."""

VERSION_PREFIX = "version_"
REFERENCE = ("a0", "b0", "p0")
TOTALS = ("contact_solves", "wall_seconds")

CHUNK_BYTES = 4096
"""Of the rows in /history: a page of the disk."""


def create(
    file: h5py.File,
    scene_toml: str,
    x: np.ndarray,
    y: np.ndarray,
    reference: Mapping[str, float],
) -> None:
    """Lay out an empty results file."""
    file.attrs.update({"format": FORMAT, "format_version": FORMAT_VERSION})
    _create_scene(file, scene_toml, reference)
    grid = file.create_group("grid")
    _scale(grid, "x", x, Quantity("mm", "centres of the elements in the rolling direction"))
    _scale(grid, "y", y, Quantity("mm", "centres of the elements in the lateral direction"))
    _create_history(file.create_group("history"), grid)
    _create_fields(file.create_group("fields"), grid)


def set_status(
    file: h5py.File, status: str, message: str, totals: Mapping[str, float] | None = None
) -> None:
    """Say how far the computation has come; totals by the names of `TOTALS`."""
    file["scene"].attrs.update({"status": status, "message": message} | dict(totals or {}))


def _create_scene(file: h5py.File, scene_toml: str, reference: Mapping[str, float]) -> None:
    scene = file.create_dataset("scene", data=scene_toml)
    _describe(scene, Quantity("1", "the scene that was computed, as TOML"))
    scene.attrs.update({name: float(reference.get(name, np.nan)) for name in REFERENCE})
    scene.attrs.update({VERSION_PREFIX + name: value for name, value in versions().items()})
    set_status(file, *RUNNING)


def _create_history(history: h5py.Group, grid: h5py.Group) -> None:
    record = _scale(history, "record", np.empty(0, int), Quantity("1", "row of /history"))
    axis = _scale(history, "axis", ["x", "y"], Quantity("1", "component of a position"))
    history["y"] = grid["y"]
    _describe(
        history.create_dataset("committed", data=0),
        Quantity("1", "number of complete records; rows beyond are of no meaning"),
    )
    for name, quantity in SCALARS.items():
        dtype = int if name == "revolution" else float
        _rows(history, name, quantity, (record,), dtype)
    for name, quantity in POINTS.items():
        _rows(history, name, quantity, (record, axis))
    for name, quantity in PROFILES.items():
        _rows(history, name, quantity, (record, grid["y"]))


def _create_fields(fields: h5py.Group, grid: h5py.Group) -> None:
    record = _scale(fields, "record", np.empty(0, int), Quantity("1", "row of /history"))
    fields["x"], fields["y"] = grid["x"], grid["y"]
    _rows(fields, "revolution", SCALARS["revolution"], (record,), int)
    for name, quantity in FIELDS.items():
        _rows(
            fields,
            name,
            quantity,
            (record, grid["x"], grid["y"]),
            compression="gzip",
            compression_opts=1,
            shuffle=True,
        )


def _scale(group: h5py.Group, name: str, values, quantity: Quantity) -> h5py.Dataset:
    """Create a dimension scale that can grow."""
    chunk = max(len(values), 64)
    dataset = group.create_dataset(name, data=values, maxshape=(None,), chunks=(chunk,))
    dataset.make_scale(name)
    return _describe(dataset, quantity)


def _rows(
    group: h5py.Group,
    name: str,
    quantity: Quantity,
    dimensions: tuple[h5py.Dataset, ...],
    dtype: type = float,
    **filters,
) -> h5py.Dataset:
    """Create a dataset with one row a record, as yet without rows."""
    shape = tuple(len(scale) for scale in dimensions[1:])
    rows = 1 if filters else max(1, CHUNK_BYTES // (8 * math.prod(shape)))
    dataset = group.create_dataset(
        name,
        shape=(0, *shape),
        dtype=dtype,
        maxshape=(None,) * len(dimensions),
        chunks=(rows, *shape),
        fillvalue=np.nan if dtype is float else -1,
        **filters,
    )
    for dimension, scale in zip(dataset.dims, dimensions, strict=True):
        dimension.attach_scale(scale)
    if name != "revolution":
        dataset.attrs["coordinates"] = "revolution"
    return _describe(dataset, quantity)


def _describe(dataset: h5py.Dataset, quantity: Quantity) -> h5py.Dataset:
    dataset.attrs.update({"units": quantity.unit, "long_name": quantity.long_name})
    return dataset
