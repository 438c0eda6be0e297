"""Groups, datasets and dimensions of a results file.

    /scene     the TOML text; attributes: status, message, a0, b0, p0, versions (JSON: the programs,
               and from which record on), digest (SHA-256 of the text)
    /grid      x, y
    /history   record, y, axis, body, position; scalars (record,), points (record, axis), profiles
               (record, y), of bodies (record, body) and (record, body, position)
    /fields    record, revolution, x, y; fields (record, x, y)
    /stress    of scenes with [subsurface]: a group <body>/<plane> with record, revolution and its
               two axes, such as x and depth; components (record, x, depth)
    /state     fields (x, y) of the last contact that was solved, from which rolling goes on;
               attribute: record, its row in /history

A netCDF reader seeks the dimensions of a variable in its own group: /grid/x and /grid/y are hard
linked into the groups that need them. The record of a row of /fields and /stress is its row in
/history. All numbers have a checksum, and HDF5 has its own for what it says about them.
"""

import hashlib
import json
import math
from collections.abc import Iterable, Mapping, Sequence

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
from tractive_sam.store.texts import create_text, set_text, text_of
from tractive_sam.store.versions import versions

FORMAT = "tractive-sam history"
FORMAT_VERSION = 2
"""Raised when a reader of the former version would misread the file. That one is still read, see
`former`; a column more needs no new version, as one that a file lacks reads as nan."""

RUNNING = ("running", "the computation has not ended yet, or was killed")
"""Status and message until the end."""

REFERENCE = ("a0", "b0", "p0")
SQUEEZED = {"compression": "gzip", "compression_opts": 1, "shuffle": True}

CHUNK_BYTES = 4096
"""Least size of a chunk: a page of the disk. So none lies within a page, and where a page is lost
and reads as zeros the checksum tells: that of nothing but zeros is zero, too."""

DESCRIPTION = ("units", "long_name")
"""Attributes for other readers, texts of any length: they are never read here."""

BODIES = "bodies"
"""Attribute of /history: the bodies whose stress is computed."""


def create(
    file: h5py.File,
    scene_toml: str,
    mesh: "Grid",
    reference: Mapping[str, float],
) -> None:
    """Lay out an empty results file."""
    set_text(file, "format", FORMAT)
    file.attrs["format_version"] = FORMAT_VERSION
    set_scene(file, scene_toml)
    file["scene"].attrs.update({name: reference.get(name, np.nan) for name in REFERENCE})
    set_status(file, *RUNNING)
    set_versions(file, [])
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
    set_text(file["scene"], "status", status)
    set_text(file["scene"], "message", message)


def set_scene(file: h5py.File, scene_toml: str) -> None:
    """Set the text of the scene, or replace it: the same one, rolled further."""
    about = {}
    if "scene" in file:
        before = file["scene"].attrs
        about = {name: before[name] for name in before if name not in DESCRIPTION}
        del file["scene"]
    scene = create_text(file, "scene", scene_toml)
    for name, value in about.items():
        if isinstance(value, bytes):
            set_text(scene, name, text_of(value))
        else:
            scene.attrs[name] = value
    _describe(scene, Quantity("1", "the scene that was computed, as TOML"))
    set_text(scene, "digest", digest(scene_toml))


def digest(text: str) -> str:
    """The checksum of a text."""
    return hashlib.sha256(text.encode()).hexdigest()


def set_versions(file: h5py.File, before: Sequence[tuple[int, Mapping[str, str]]]) -> None:
    """Add the programs that compute from here on, where they are others than before."""
    now = versions()
    if not before or before[-1][1] != now:
        before = [*before, (len(file["history/record"]) if before else 0, now)]
    set_text(file["scene"], "versions", json.dumps(before))


def add_columns(file: h5py.File, record: Record) -> None:
    """Make room for what the file does not hold yet: numbers, bodies and planes of a record."""
    history = file["history"]
    _create_columns(history, (*record.scalars, *record.points, *record.profiles))
    for numbers in list(record.bodies.values())[:1]:
        if BODIES not in history.attrs:
            _create_bodies(history, tuple(record.bodies))
        shared = history["record"], history["body"]
        for name in (name for name in numbers if name not in history):
            if name in BODY_POINTS:
                _rows(history, name, BODY_POINTS[name], (*shared, history["position"]))
            else:
                _rows(history, name, (BODY_SCALARS | BODY_ERROR_BARS)[name], shared)
    for one in record.stress:
        bodies = file["stress"].require_group(one.body)
        if str(one.plane) not in bodies:
            _create_plane(bodies.create_group(str(one.plane)), file["grid"], one)


def _create_columns(history: h5py.Group, names: Iterable[str]) -> None:
    """Create those columns that are not there."""
    line = len(history["y"]) == 1
    kinds = (
        (scalars(line) | error_bars(line), ()),
        (POINTS, (history["axis"],)),
        (PROFILES, (history["y"],)),
    )
    for name in (name for name in names if name not in history):
        quantities, others = next(kind for kind in kinds if name in kind[0])
        dtype = int if name == "revolution" else float
        _rows(history, name, quantities[name], (history["record"], *others), dtype)


def _create_bodies(history: h5py.Group, bodies: tuple[str, ...]) -> None:
    set_text(history, BODIES, "".join(bodies))
    _labels(history, "body", bodies, "body")
    _labels(history, "position", ["x", "y", "depth"], "component of a position in a body")


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
    state["x"], state["y"] = grid["x"], grid["y"]
    for name, quantity in STATE.items():
        _rows(state, name, quantity, (grid["x"], grid["y"]), rows=len(grid["x"]))


def _create_history(history: h5py.Group, grid: h5py.Group) -> None:
    _scale(history, "record", np.empty(0, int), Quantity("1", "row of /history"))
    _labels(history, "axis", ["x", "y"], "component of a position")
    history["y"] = grid["y"]
    _create_columns(history, (*SCALARS, *POINTS, *PROFILES))


def _create_fields(fields: h5py.Group, grid: h5py.Group) -> None:
    record = _scale(fields, "record", np.empty(0, int), Quantity("1", "row of /history"))
    fields["x"], fields["y"] = grid["x"], grid["y"]
    _rows(fields, "revolution", SCALARS["revolution"], (record,), int)
    for name, quantity in FIELDS.items():
        _rows(fields, name, quantity, (record, grid["x"], grid["y"]), **SQUEEZED)


def _labels(group: h5py.Group, name: str, values: Sequence[str], about: str) -> None:
    """Create a dimension scale of texts, for other readers.

    Texts of a fixed length are not texts to all of them; these are of any, and never read here.
    """
    dataset = group.create_dataset(name, data=values)
    dataset.make_scale(name)
    _describe(dataset, Quantity("1", about))


def _scale(group: h5py.Group, name: str, values: Sequence, quantity: Quantity) -> h5py.Dataset:
    """Create a dimension scale that can grow."""
    chunk = max(len(values), CHUNK_BYTES // 8)
    dataset = group.create_dataset(
        name, data=values, maxshape=(None,), chunks=(chunk,), fletcher32=True
    )
    dataset.make_scale(name)
    return _describe(dataset, quantity)


def _rows(
    group: h5py.Group,
    name: str,
    quantity: Quantity,
    dimensions: tuple[h5py.Dataset, ...],
    dtype: type = float,
    rows: int = 0,
    **filters: str | int | bool,
) -> h5py.Dataset:
    """Create a dataset with one row a record, as yet without rows, or with a number of them."""
    shape = tuple(len(scale) for scale in dimensions[1:])
    least = math.ceil(CHUNK_BYTES / (8 * math.prod(shape)))
    dataset = group.create_dataset(
        name,
        shape=(rows, *shape),
        dtype=dtype,
        maxshape=(None,) * len(dimensions),
        chunks=(1 if filters else max(least, rows), *shape),
        fillvalue=np.nan if dtype is float else -1,
        fletcher32=True,
        **filters,
    )
    for dimension, scale in zip(dataset.dims, dimensions, strict=True):
        dimension.attach_scale(scale)
    if not rows and name != "revolution":
        dataset.attrs["coordinates"] = "revolution"
    return _describe(dataset, quantity)


def _describe(dataset: h5py.Dataset, quantity: Quantity) -> h5py.Dataset:
    dataset.attrs.update({"units": quantity.unit, "long_name": quantity.long_name})
    return dataset
