"""Groups, datasets and dimensions of a results file.

    /scene     the TOML text; attributes: status, message, a0, b0, p0, versions
    /grid      x, y
    /history   record, committed, y, axis, body, position; scalars (record,), points (record, axis),
               profiles (record, y), of bodies (record, body) and (record, body, position)
    /fields    record, revolution, x, y; fields (record, x, y)
    /stress    of scenes with [subsurface]: a group <body>/<plane> with record, revolution and its
               two axes, such as x and depth; components (record, x, depth)
    /state     fields (slot, x, y) of the last record, from which rolling goes on

A netCDF reader seeks the dimensions of a variable in its own group: /grid/x and /grid/y are hard
linked into the groups that need them. The record of a row of /fields and /stress is its row in
/history; that of a slot of /state is the last one that leaves it when divided by their number.
"""

import math
from collections.abc import Mapping

import h5py
import numpy as np

from tractive_sam.results.grid import Grid
from tractive_sam.results.plane_stress import PlaneStress
from tractive_sam.results.quantities import (
    BODY_ERROR_BARS,
    BODY_POINTS,
    BODY_SCALARS,
    FIELDS,
    POINTS,
    PROFILES,
    SCALARS,
    STATE,
    STRESS,
    Quantity,
    error_bars,
    scalars,
)
from tractive_sam.results.record import Record
from tractive_sam.store.rows import SLOTS
from tractive_sam.store.versions import versions

FORMAT = "tractive-sam history"
FORMAT_VERSION = 1
"""Raised when a reader of the former version would misread the file."""

RUNNING = ("running", "the computation has not ended yet, or was killed")
"""Status and message until the end."""

VERSION_PREFIX = "version_"
REFERENCE = ("a0", "b0", "p0")
SQUEEZED = {"compression": "gzip", "compression_opts": 1, "shuffle": True}

CHUNK_BYTES = 4096
"""Of the rows in /history: a page of the disk."""


def create(
    file: h5py.File,
    scene_toml: str,
    mesh: "Grid",
    reference: Mapping[str, float],
) -> None:
    """Lay out an empty results file."""
    file.attrs.update({"format": FORMAT, "format_version": FORMAT_VERSION})
    _create_scene(file, scene_toml, reference)
    grid = file.create_group("grid")
    grid.attrs["half_length"] = mesh.half_length
    _scale(grid, "x", mesh.x, Quantity("mm", "centres of the elements in the rolling direction"))
    _scale(grid, "y", mesh.y, Quantity("mm", "centres of the elements in the lateral direction"))
    _create_history(file.create_group("history"), grid)
    _create_fields(file.create_group("fields"), grid)
    file.create_group("stress")
    _create_state(file.create_group("state"), grid)


def set_status(file: h5py.File, status: str, message: str) -> None:
    """Say how far the computation has come."""
    file["scene"].attrs.update({"status": status, "message": message})


def set_scene(file: h5py.File, scene_toml: str) -> None:
    """Replace the text of the scene: the same one, rolled further."""
    about = dict(file["scene"].attrs)
    del file["scene"]
    file.create_dataset("scene", data=scene_toml).attrs.update(about)


def lacks(file: h5py.File, record: Record) -> bool:
    """Whether there is no room yet for some of the numbers or the stress that a record holds."""
    history = file["history"]
    return (
        not all(name in history for name in record.scalars)
        or (bool(record.bodies) and "body" not in history)
        or any(f"{one.body}/{one.plane}" not in file["stress"] for one in record.stress)
    )


def add_columns(file: h5py.File, record: Record) -> None:
    """Make room for the numbers, bodies and planes of a record."""
    history, line = file["history"], len(file["grid/y"]) == 1
    rows = len(history["record"])
    for name, quantity in (scalars(line) | error_bars(line)).items():
        if name in record.scalars and name not in history:
            _rows(history, name, quantity, (history["record"],), rows=rows)[:] = np.nan
    if record.bodies and "body" not in history:
        _create_bodies(history, record)
    for one in record.stress:
        bodies = file["stress"].require_group(one.body)
        if str(one.plane) not in bodies:
            _create_plane(bodies.create_group(str(one.plane)), file["grid"], one)


def _create_bodies(history: h5py.Group, first: Record) -> None:
    record = history["record"]
    body = _scale(history, "body", tuple(first.bodies), Quantity("1", "body"))
    position = _scale(
        history, "position", ["x", "y", "depth"], Quantity("1", "component of a position in a body")
    )
    known = next(iter(first.bodies.values()))
    for name, quantity in (BODY_SCALARS | BODY_ERROR_BARS).items():
        if name in known:
            _rows(history, name, quantity, (record, body))
    for name, quantity in BODY_POINTS.items():
        _rows(history, name, quantity, (record, body, position))


def _create_plane(group: h5py.Group, grid: h5py.Group, plane: "PlaneStress") -> None:
    group.attrs["position"] = plane.position
    record = _scale(group, "record", np.empty(0, int), Quantity("1", "row of /history"))
    _rows(group, "revolution", SCALARS["revolution"], (record,), int)
    axes = []
    for name, centres in plane.axes.items():
        if name in grid:
            group[name] = grid[name]
        else:
            _scale(group, name, centres, Quantity("mm", "depth below the surface of the body"))
        axes.append(group[name])
    for name, quantity in STRESS.items():
        _rows(group, name, quantity, (record, *axes), **SQUEEZED)


def _create_state(state: h5py.Group, grid: h5py.Group) -> None:
    slot = _scale(state, "slot", range(SLOTS), Quantity("1", "copy of the state"))
    state["x"], state["y"] = grid["x"], grid["y"]
    for name, quantity in STATE.items():
        _rows(state, name, quantity, (slot, grid["x"], grid["y"]), rows=SLOTS)


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
    for name, quantity in scalars(line=len(grid["y"]) == 1).items():
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
        _rows(fields, name, quantity, (record, grid["x"], grid["y"]), **SQUEEZED)


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
    rows: int = 0,
    **filters,
) -> h5py.Dataset:
    """Create a dataset with one row a record, as yet without rows, or with rows laid out."""
    shape = tuple(len(scale) for scale in dimensions[1:])
    together = 1 if filters else max(1, CHUNK_BYTES // (8 * math.prod(shape)))
    dataset = group.create_dataset(
        name,
        shape=(rows, *shape),
        dtype=dtype,
        maxshape=(None,) * len(dimensions),
        chunks=(together, *shape),
        fillvalue=np.nan if dtype is float else -1,
        **filters,
    )
    for dimension, scale in zip(dataset.dims, dimensions, strict=True):
        dimension.attach_scale(scale)
    if rows:
        dataset[:] = 0.0  # on disk at once, so that writing a state moves nothing
    elif name != "revolution":
        dataset.attrs["coordinates"] = "revolution"
    return _describe(dataset, quantity)


def _describe(dataset: h5py.Dataset, quantity: Quantity) -> h5py.Dataset:
    dataset.attrs.update({"units": quantity.unit, "long_name": quantity.long_name})
    return dataset
