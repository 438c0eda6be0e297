"""Groups, datasets and dimensions of a results file.

    /scene     the TOML text; attributes: status, message, a0, b0, p0, versions (JSON: the programs,
               and from which record on), digest (SHA-256 of the text), laws and law_records (laws
               that replaced those of the scene, as text and as JSON with fingerprints), started
               (where the worn bodies are from with which it began), measured (SHA-256 of the
               numbers of its measured gap and profiles), datum (what the approach is counted
               from: vertex; without it the nearest node)
    /grid      x, y
    /history   record, y, axis, body, block, position; a dataset for each column (record, its
               dimensions), one of them the coordinate, revolution; attribute: own (JSON: columns
               that are not the package's)
    /fields    record, revolution, x, y; fields (record, x, y), of duty cycles (record, block, x,
               y); attribute: own (JSON: fields that are not the package's)
    /stress    of scenes with [subsurface]: a group <body>/<plane> with record, revolution and its
               two axes, such as x and depth; components (record, x, depth); of duty cycles a group
               more around it, block-0 and so on
    /fatigue   of scenes with [fatigue]: a group for each body with record, revolution, depth (below
               the present surface) and zeta (below the unworn one); utilisation, residual_shear,
               path_radius (record, y, depth), damage (record, y, zeta), worn (record, y)
    /state     fields (x, y) of the last contact that was solved, from which rolling goes on;
               attribute: record, its row in /history; what observers resume from, of any shape,
               under names that begin with theirs

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

from tractive_sam.results import (
    BOUND,
    COLUMNS,
    COORDINATE,
    CYCLES,
    FIELDS,
    LABELS,
    REVOLUTION,
    STRESS,
    BodyFatigue,
    Grid,
    LawRecord,
    PlaneStress,
    Quantity,
    Record,
    describe_laws,
    dump_laws,
    kept_fields,
    of_role,
)
from tractive_sam.results import columns as columns_of
from tractive_sam.scene import Plane, Scene, block_label
from tractive_sam.store.texts import create_text, set_text, text_of
from tractive_sam.store.versions import versions

FORMAT = "tractive-sam history"
FORMAT_VERSION = 2
"""Raised when a reader of the former version would misread the file. That one is still read, see
`former`; a column more needs no new version, as one that a file lacks reads as nan."""

RUNNING = ("running", "the computation has not ended yet, or was killed")
"""Status and message until the end."""

REFERENCE = {"a0": "a", "b0": "b", "p0": "p0"}
"""Attributes for other readers: the unworn contact by Hertz."""
SQUEEZED = {"compression": "gzip", "compression_opts": 1, "shuffle": True}

CHUNK_BYTES = 4096
"""Least size of a chunk: a page of the disk. So none lies within a page, and where a page is lost
and reads as zeros the checksum tells: that of nothing but zeros is zero, too."""

DESCRIPTION = ("units", "long_name")
"""Attributes for other readers, texts of any length: they are never read here."""

OWN = "own"
"""Attribute of /history and /fields: columns and fields that are not the package's."""

ROW = Quantity("record", "1", "row of /history")
TOLD = (
    "name",
    "unit",
    "long_name",
    "dims",
    "symbol",
    "label",
    "format",
    "whole",
    "per_length",
    "role",
)
"""What is kept of a column that is not the package's."""


def known_names() -> set[str]:
    """Names of the package's columns."""
    return {one.name for one in COLUMNS}


def create(
    file: h5py.File,
    scene: Scene,
    mesh: Grid,
    laws: Mapping[str, LawRecord] | None = None,
    coordinate: Quantity | None = None,
) -> None:
    """Lay out an empty results file of a history along a coordinate, by default the scene's."""
    coordinate = coordinate or of_role(columns_of(scene).values(), COORDINATE)
    set_text(file, "format", FORMAT)
    file.attrs["format_version"] = FORMAT_VERSION
    set_scene(file, scene)
    set_text(file["scene"], "laws", describe_laws(laws or {}))
    set_text(file["scene"], "law_records", dump_laws(laws or {}))
    set_status(file, *RUNNING)
    set_versions(file, [])
    grid = file.create_group("grid")
    grid.attrs["half_length"] = mesh.half_length
    for name, centres, along in (("x", mesh.x, "rolling"), ("y", mesh.y, "lateral")):
        about = Quantity(name, "mm", f"centres of the elements in the {along} direction")
        _scale(grid, name, centres, about)
    # A record may have other columns in the place of those with a role.
    certain = {
        name: one
        for name, one in columns_of(scene, (coordinate,)).items()
        if one.role in ("", COORDINATE)
    }
    history = file.create_group("history")
    _create_history(history, grid, certain)
    if names := [block_label(scene, k) for k in range(len(scene.duty))]:
        _labels(history, "block", names, "block of the duty cycle")
    kept = {name: one for name, one in kept_fields(scene).items() if one is not BOUND}
    _create_fields(file.create_group("fields"), grid, history, coordinate, kept)
    file.create_group("stress")
    _create_state(file.create_group("state"), grid, history)


def set_status(file: h5py.File, status: str, message: str) -> None:
    """Say how far the computation has come."""
    set_text(file["scene"], "status", status)
    set_text(file["scene"], "message", message)


def set_scene(file: h5py.File, scene: Scene) -> None:
    """Set the text of the scene, or replace it: the same one, rolled further."""
    about = {}
    if "scene" in file:
        before = file["scene"].attrs
        about = {name: before[name] for name in before if name not in DESCRIPTION}
        del file["scene"]
    text, hertz = scene.to_toml(), scene.hertz
    dataset = create_text(file, "scene", text)
    for name, value in about.items():
        if isinstance(value, bytes):
            set_text(dataset, name, text_of(value))
        else:
            dataset.attrs[name] = value
    for name, of_hertz in REFERENCE.items():
        dataset.attrs[name] = np.nan if hertz is None else getattr(hertz, of_hertz)
    _describe(dataset, Quantity("scene", "1", "the scene that was computed, as TOML"))
    set_text(dataset, "digest", digest(text))


def digest(text: str) -> str:
    """The checksum of a text."""
    return hashlib.sha256(text.encode()).hexdigest()


def set_versions(file: h5py.File, before: Sequence[tuple[int, Mapping[str, str]]]) -> None:
    """Add the programs that compute from here on, where they are others than before."""
    now = versions()
    if not before or before[-1][1] != now:
        before = [*before, (len(file["history/record"]) if before else 0, now)]
    set_text(file["scene"], "versions", json.dumps(before))


def add_columns(file: h5py.File, records: Iterable[Record]) -> None:
    """Make room for what the file does not hold yet: columns, planes and bodies of records."""
    known: set[str] = set()
    for record in records:
        if not record.columns.keys() <= known:
            _create_columns(file["history"], record.columns, record.blocks)
            known |= record.columns.keys()
        _create_missing_fields(file["fields"], record)
        for one in record.stress:
            if (place := place_of(one.body, one.plane, one.block)) not in file["stress"]:
                group = file["stress"].create_group(place)
                _create_plane(group, file["grid"], one, record.coordinate)
        for body in record.cycles:
            bodies = file.require_group("fatigue")
            if body.body not in bodies:
                _create_cycle(bodies.create_group(body.body), file, body, record.coordinate)


def _create_missing_fields(fields: h5py.Group, record: Record) -> None:
    """Create those fields of a record that are not there, and say which are not the package's."""
    known = {BOUND.name: BOUND, **record.own_fields}
    for name in (name for name in record.fields if name not in fields):
        _create_field(fields, known[name], record.coordinate)
        if name in record.own_fields:
            _add_own(fields, [known[name]])


def _add_own(group: h5py.Group, quantities: Iterable[Quantity]) -> None:
    """Describe what is not the package's, so that a file is read without what defined it."""
    described = json.loads(text_of(group.attrs[OWN])) if OWN in group.attrs else []
    described += [{key: getattr(one, key) for key in TOLD} for one in quantities]
    set_text(group, OWN, json.dumps(described))


def place_of(body: str, plane: Plane | str, block: int | None = None) -> str:
    """Where in /stress that on a plane of a body is."""
    return f"{'' if block is None else f'block-{block}/'}{body}/{plane}"


def _create_columns(history: h5py.Group, columns: Mapping[str, Quantity], blocks: int = 0) -> None:
    """Create those columns that are not there, and say which are not the package's."""
    missing = [one for name, one in columns.items() if name not in history]
    coordinate = of_role(columns.values(), COORDINATE).name
    for one in missing:
        for name in (name for name in one.dims if name not in history):
            labels = LABELS.get(name) or [str(k + 1) for k in range(blocks)]
            _labels(history, name, labels, "component" if name in ("axis", "position") else name)
        scales = [history[name] for name in ("record", *one.dims)]
        _rows(history, one.name, one, scales, coordinate=coordinate)
    # A coordinate may be the package's, and yet not that of the scene.
    own = [one for one in missing if one.name not in known_names() or one.role == COORDINATE]
    own = [one for one in own if one != REVOLUTION]
    if own:
        _add_own(history, own)


def _create_plane(
    group: h5py.Group, grid: h5py.Group, plane: "PlaneStress", coordinate: Quantity
) -> None:
    group.attrs["position"] = plane.position
    record = _scale(group, "record", np.empty(0, int), ROW)
    _rows(group, coordinate.name, coordinate, (record,), coordinate=coordinate.name)
    axes = []
    for name, centres in plane.axes.items():
        if name in grid:
            group[name] = grid[name]
        else:
            _scale(
                group, name, centres, Quantity(name, "mm", "depth below the surface of the body")
            )
        axes.append(group[name])
    for name, quantity in STRESS.items():
        _rows(group, name, quantity, (record, *axes), coordinate=coordinate.name)


def _create_cycle(
    group: h5py.Group, file: h5py.File, one: BodyFatigue, coordinate: Quantity
) -> None:
    """Room for what rolling does to a body, and for what it goes on from."""
    record = _scale(group, "record", np.empty(0, int), ROW)
    _rows(group, coordinate.name, coordinate, (record,), coordinate=coordinate.name)
    group["y"] = file["grid/y"]
    _scale(group, "depth", one.depth, Quantity("depth", "mm", "depth below the present surface"))
    if one.zeta.size:
        about = Quantity("zeta", "mm", "depth below the unworn surface")
        _scale(group, "zeta", one.zeta, about)
    for name, quantity in CYCLES.items():
        if all(axis in group for axis in quantity.dims):
            scales = (record, *(group[axis] for axis in quantity.dims))
            _rows(group, name, quantity, scales, coordinate=coordinate.name, **SQUEEZED)


def add_state(state: h5py.Group, name: str, values: np.ndarray) -> None:
    """Keep something more to go on from, beside the fields."""
    chunks = tuple(max(1, n) for n in values.shape)
    about = {"chunks": chunks, "maxshape": (None,) * values.ndim, "fletcher32": True}
    _describe(state.create_dataset(name, data=values, **about), Quantity(name, "", "to go on from"))


def _axes(group: h5py.Group, grid: h5py.Group, history: h5py.Group) -> tuple[h5py.Dataset, ...]:
    """The dimensions of a field, linked into its group."""
    group["x"], group["y"] = grid["x"], grid["y"]
    if "block" not in history:
        return group["x"], group["y"]
    group["block"] = history["block"]
    return group["block"], group["x"], group["y"]


def _create_state(state: h5py.Group, grid: h5py.Group, history: h5py.Group) -> None:
    first, *others = _axes(state, grid, history)
    for name, quantity in FIELDS.items():
        _rows(state, name, quantity, (first, *others), rows=len(first))


def _create_history(history: h5py.Group, grid: h5py.Group, columns: Mapping[str, Quantity]) -> None:
    _scale(history, "record", np.empty(0, int), ROW)
    history["y"] = grid["y"]
    _create_columns(history, columns)


def _create_fields(
    fields: h5py.Group,
    grid: h5py.Group,
    history: h5py.Group,
    coordinate: Quantity,
    kept: Mapping[str, Quantity],
) -> None:
    record = _scale(fields, "record", np.empty(0, int), ROW)
    axes = _axes(fields, grid, history)
    _rows(fields, coordinate.name, coordinate, (record,), coordinate=coordinate.name)
    scales = (record, *axes)
    for name, quantity in kept.items():
        _rows(fields, name, quantity, scales, coordinate=coordinate.name, **SQUEEZED)


def _create_field(fields: h5py.Group, quantity: Quantity, coordinate: Quantity) -> None:
    """Create one more field; it is unknown in the records before."""
    scales = [fields[name] for name in ("record", "block", "x", "y") if name in fields]
    about = {"rows": len(fields["record"]), "coordinate": coordinate.name}
    _rows(fields, quantity.name, quantity, tuple(scales), **about, **SQUEEZED)


def _labels(group: h5py.Group, name: str, values: Sequence[str], about: str) -> None:
    """Create a dimension scale of texts, for other readers.

    Texts of a fixed length are not texts to all of them; these are of any, and never read here.
    """
    dataset = group.create_dataset(name, data=values)
    dataset.make_scale(name)
    _describe(dataset, Quantity(name, "1", about))


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
    rows: int = 0,
    coordinate: str = "",
    **filters: str | int | bool,
) -> h5py.Dataset:
    """Create a dataset with one row a record, as yet without rows, or with a number of them."""
    shape = tuple(len(scale) for scale in dimensions[1:])
    least = math.ceil(CHUNK_BYTES / (8 * math.prod(shape)))
    dataset = group.create_dataset(
        name,
        shape=(rows, *shape),
        dtype=int if quantity.whole else float,
        maxshape=(None,) * len(dimensions),
        chunks=(1 if filters else max(least, rows), *shape),
        fillvalue=-1 if quantity.whole else np.nan,
        fletcher32=True,
        **filters,
    )
    for dimension, scale in zip(dataset.dims, dimensions, strict=True):
        dimension.attach_scale(scale)
    if coordinate not in ("", name):
        dataset.attrs["coordinates"] = coordinate
    return _describe(dataset, quantity)


def _describe(dataset: h5py.Dataset, quantity: Quantity) -> h5py.Dataset:
    dataset.attrs.update({"units": quantity.unit, "long_name": quantity.long_name})
    return dataset
