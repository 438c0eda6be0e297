"""Groups, datasets and dimensions of a results file.

    /scene     the TOML text; attributes: status, message, a0, b0, p0, versions (JSON: versions of
               the programs, each with its first record), digest (SHA-256 of the text), laws and
               law_records (user-defined laws, as text and as JSON with fingerprints), started
               (source of the worn bodies at the start), measured (SHA-256 of the numbers of the
               measured gap and profiles), datum (datum of the approach: vertex; if it is missing,
               the nearest node)
    /inputs    only with files that the scene names: a group for each key, for example gap.file,
               with attributes path, hashes (JSON: SHA-256 of the file and of files that it names,
               by path), reading (keys that influence the reading); x, y, separation of a map; s,
               y, z, tangent_y, tangent_z of a profile; these over x and node of sections of a rail
    /grid      x, y
    /history   record, y, axis, body, block, position, wheel, rail (nodes of their profiles); a
               dataset for each column (record, further dimensions), including the coordinate,
               revolution; attribute: own (JSON: user-defined columns)
    /fields    record, revolution, x, y; fields (record, x, y) or, for duty cycles, (record, block,
               x, y); attribute: own (JSON: user-defined fields)
    /stress    only with [subsurface]: a group <body>/<plane> with record, revolution and the two
               axes of the plane, for example x and depth; components (record, x, depth); for duty
               cycles, these groups are in the groups block-0, block-1 and so on
    /fatigue   only with [fatigue]: a group for each body with record, revolution, depth (below the
               present surface) and zeta (below the unworn surface); utilisation, residual_shear
               and path_radius (record, y, depth), damage (record, y, zeta), worn (record, y)
    /state     fields (x, y) of the last solved contact, from which a run resumes; attribute: record
               (its row in /history); arrays of any shape from which observers resume, with names
               that begin with the name of the observer

A netCDF reader looks for the dimensions of a variable in the group of the variable. /grid/x and
/grid/y are therefore hard-linked into the groups that need them. The value record of a row of
/fields or /stress is its row in /history. All numbers have a checksum, and HDF5 adds checksums of
its metadata.
"""

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType

import h5py
import numpy as np

from tractive_sam.results import (
    BOUND,
    COLUMNS,
    COORDINATE,
    FATIGUE_FIELDS,
    FIELDS,
    LABELS,
    PROFILES,
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
    find_by_role,
    storable_fields,
)
from tractive_sam.results import columns as columns_of
from tractive_sam.scene import Scene, block_label
from tractive_sam.store.datasets import (
    COMPRESSED,
    FORMAT,
    FORMAT_VERSION,
    create_labels,
    create_rows,
    create_scale,
    create_text,
    decode_text,
    describe_dataset,
    plane_path,
    set_text,
    versions,
)
from tractive_sam.store.inputs import add_inputs

RUNNING = ("running", "the computation has not ended yet, or was killed")
"""Status and message of a run that has not ended."""

USER = "own"
"""Attribute of /history and /fields: user-defined columns and fields."""

ROW = Quantity("record", "1", "row of /history")


def package_columns() -> dict[str, Quantity]:
    """Return the columns that the package defines, by name."""
    return {column.name: column for column in COLUMNS}


def create_layout(
    file: h5py.File,
    scene: Scene,
    mesh: Grid,
    laws: Mapping[str, LawRecord] | None = None,
    coordinate: Quantity | None = None,
) -> None:
    """Create the groups and datasets of an empty results file.

    Parameters
    ----------
    file : h5py.File
        An empty file.
    scene : Scene
        The scene that is computed.
    mesh : Grid
        The mesh.
    laws : mapping of str to LawRecord, optional
        Laws that replace laws of the scene.
    coordinate : Quantity, optional
        The column along which the history runs; by default the scene's.
    """
    coordinate = coordinate or find_by_role(columns_of(scene).values(), COORDINATE)
    set_text(file, "format", FORMAT)
    file.attrs["format_version"] = FORMAT_VERSION
    set_scene(file, scene)
    add_inputs(file, scene)
    set_text(file["scene"], "laws", describe_laws(laws or {}))
    set_text(file["scene"], "law_records", dump_laws(laws or {}))
    set_status(file, *RUNNING)
    set_versions(file, [])
    grid = file.create_group("grid")
    grid.attrs["half_length"] = mesh.half_length
    grid.attrs["centre"] = mesh.centre
    for name, centres, along in (("x", mesh.x, "rolling"), ("y", mesh.y, "lateral")):
        about = Quantity(name, "mm", f"centres of the elements in the {along} direction")
        create_scale(grid, name, centres, about)
    # A record may replace columns that have a role by other columns.
    fixed_columns = {
        name: quantity
        for name, quantity in columns_of(scene, (coordinate,)).items()
        if quantity.role in ("", COORDINATE)
    }
    history = file.create_group("history")
    _create_history(history, grid, fixed_columns)
    if names := [block_label(scene, k) for k in range(len(scene.duty))]:
        create_labels(history, "block", names, "block of the duty cycle")
    stored_fields = {
        name: quantity for name, quantity in storable_fields(scene).items() if quantity is not BOUND
    }
    _create_fields(file.create_group("fields"), grid, history, coordinate, stored_fields)
    file.create_group("stress")
    _create_state(file.create_group("state"), grid, history)


def set_status(file: h5py.File, status: str, message: str) -> None:
    """Write status and message of the computation into a results file."""
    set_text(file["scene"], "status", status)
    set_text(file["scene"], "message", message)


def set_scene(file: h5py.File, scene: Scene) -> None:
    """Write or replace a results file's scene: its text, checksum and Hertz solution."""
    # Attributes for other readers, texts of variable length: this package never reads them.
    description = ("units", "long_name")
    # Attributes for other readers: the Hertz solution of the unworn contact.
    reference = {"a0": "a", "b0": "b", "p0": "p0"}
    about = {}
    if "scene" in file:
        before = file["scene"].attrs
        about = {name: before[name] for name in before if name not in description}
        del file["scene"]
    text, hertz = scene.to_toml(), scene.hertz
    dataset = create_text(file, "scene", text)
    for name, value in about.items():
        if isinstance(value, bytes):
            set_text(dataset, name, decode_text(value))
        else:
            dataset.attrs[name] = value
    for name, of_hertz in reference.items():
        dataset.attrs[name] = np.nan if hertz is None else getattr(hertz, of_hertz)
    describe_dataset(dataset, Quantity("scene", "1", "the scene that was computed, as TOML"))
    set_text(dataset, "digest", digest(text))


def digest(text: str) -> str:
    """Return the SHA-256 checksum of a text."""
    return hashlib.sha256(text.encode()).hexdigest()


def set_versions(file: h5py.File, previous: Sequence[tuple[int, Mapping[str, str]]]) -> None:
    """Append the current program versions to a results file, if they have changed."""
    current = versions()
    if not previous or previous[-1][1] != current:
        previous = [*previous, (len(file["history/record"]) if previous else 0, current)]
    set_text(file["scene"], "versions", json.dumps(previous))


def add_columns(file: h5py.File, records: Iterable[Record]) -> None:
    """Create the datasets of columns, fields, stress and fatigue of records that a file lacks."""
    created: set[str] = set()
    for record in records:
        if not record.columns.keys() <= created:
            _create_columns(file["history"], record.columns, record.lengths)
            created |= record.columns.keys()
        _create_missing_fields(file["fields"], record)
        for plane in record.stress:
            if (path := plane_path(plane.body, plane.plane, plane.block)) not in file["stress"]:
                group = file["stress"].create_group(path)
                _create_plane(group, file["grid"], plane, record.coordinate)
        for body in record.cycles:
            bodies = file.require_group("fatigue")
            if body.body not in bodies:
                _create_cycle(bodies.create_group(body.body), file, body, record.coordinate)


def _create_missing_fields(fields: h5py.Group, record: Record) -> None:
    """Create the datasets of a record's fields that a file lacks."""
    quantities = {BOUND.name: BOUND, **record.user_fields}
    for name in (name for name in record.fields if name not in fields):
        _create_field(fields, quantities[name], record.coordinate)
        if name in record.user_fields:
            _add_user_defined(fields, [quantities[name]])


def _add_user_defined(group: h5py.Group, quantities: Iterable[Quantity]) -> None:
    """Store the descriptions of user-defined quantities in a results file."""
    # Attributes that are stored only if they are set: earlier versions do not know them.
    relation_names = ("place_of", "error_of")
    # Attributes of a user-defined quantity that are stored.
    described_keys = (
        *("name", "unit", "long_name", "dims", "symbol", "label"),
        *("format", "whole", "per_length", "role"),
    )
    described = json.loads(decode_text(group.attrs[USER])) if USER in group.attrs else []
    for quantity in quantities:
        relations = {key: getattr(quantity, key) for key in relation_names}
        stored = {key: getattr(quantity, key) for key in described_keys}
        described.append(stored | {key: name for key, name in relations.items() if name})
    set_text(group, USER, json.dumps(described))


def _create_columns(
    history: h5py.Group,
    columns: Mapping[str, Quantity],
    lengths: Mapping[str, int] = MappingProxyType({}),
) -> None:
    """Create the datasets of columns that a file lacks.

    Parameters
    ----------
    history : h5py.Group
        The group of the columns.
    columns : mapping of str to Quantity
        All columns.
    lengths : mapping of str to int
        Lengths of the dimensions that differ between histories.
    """
    missing = [column for dimension, column in columns.items() if dimension not in history]
    coordinate = find_by_role(columns.values(), COORDINATE).name
    for column in missing:
        for dimension in (dimension for dimension in column.dims if dimension not in history):
            if dimension in PROFILES:
                nodes = Quantity(dimension, "1", f"nodes of the profile of the {dimension}")
                create_scale(history, dimension, np.arange(lengths[dimension]), nodes)
                continue
            labels = LABELS.get(dimension) or [str(k + 1) for k in range(lengths[dimension])]
            about = "component" if dimension in ("axis", "position") else dimension
            create_labels(history, dimension, labels, about)
        scales = tuple(history[dimension] for dimension in ("record", *column.dims))
        create_rows(history, column.name, column, scales, coordinate=coordinate)
    # A process may compute a column that the package reads from contacts of other scenes; a
    # coordinate may be a column of the package without being the coordinate of the scene.
    package = package_columns()
    user_defined = [
        column
        for column in missing
        if column.name not in package
        or (column.of is None) > (package[column.name].of is None)
        or column.role == COORDINATE
    ]
    user_defined = [column for column in user_defined if column != REVOLUTION]
    if user_defined:
        _add_user_defined(history, user_defined)


def _create_plane(
    group: h5py.Group, grid: h5py.Group, plane: "PlaneStress", coordinate: Quantity
) -> None:
    """Create the empty datasets for the stress on one plane, one row per record."""
    group.attrs["position"] = plane.position
    record = create_scale(group, "record", np.empty(0, int), ROW)
    create_rows(group, coordinate.name, coordinate, (record,), coordinate=coordinate.name)
    axes = []
    for name, centres in plane.axes.items():
        if name in grid:
            group[name] = grid[name]
        else:
            create_scale(
                group, name, centres, Quantity(name, "mm", "depth below the surface of the body")
            )
        axes.append(group[name])
    for name, quantity in STRESS.items():
        create_rows(group, name, quantity, (record, *axes), coordinate=coordinate.name)


def _create_cycle(
    group: h5py.Group, file: h5py.File, fatigue: BodyFatigue, coordinate: Quantity
) -> None:
    """Create the empty datasets for the fatigue of one body, one row per record."""
    record = create_scale(group, "record", np.empty(0, int), ROW)
    create_rows(group, coordinate.name, coordinate, (record,), coordinate=coordinate.name)
    group["y"] = file["grid/y"]
    about = Quantity("depth", "mm", "depth below the present surface")
    create_scale(group, "depth", fatigue.depth, about)
    if fatigue.zeta.size:
        about = Quantity("zeta", "mm", "depth below the unworn surface")
        create_scale(group, "zeta", fatigue.zeta, about)
    for name, quantity in FATIGUE_FIELDS.items():
        if all(axis in group for axis in quantity.dims):
            scales = (record, *(group[axis] for axis in quantity.dims))
            create_rows(group, name, quantity, scales, coordinate=coordinate.name, **COMPRESSED)


def _link_axes(
    group: h5py.Group, grid: h5py.Group, history: h5py.Group
) -> tuple[h5py.Dataset, ...]:
    """Link the axes of fields into a group, and return them: (block,) x, y."""
    group["x"], group["y"] = grid["x"], grid["y"]
    if "block" not in history:
        return group["x"], group["y"]
    group["block"] = history["block"]
    return group["block"], group["x"], group["y"]


def _create_state(state: h5py.Group, grid: h5py.Group, history: h5py.Group) -> None:
    """Create the datasets of the state from which a run resumes."""
    state.attrs["record"] = -1  # none yet
    first, *axes = _link_axes(state, grid, history)
    for name, quantity in FIELDS.items():
        create_rows(state, name, quantity, (first, *axes), rows=len(first))


def _create_history(history: h5py.Group, grid: h5py.Group, columns: Mapping[str, Quantity]) -> None:
    """Create empty datasets of history columns, one row per record, and link the axis y."""
    create_scale(history, "record", np.empty(0, int), ROW)
    history["y"] = grid["y"]
    _create_columns(history, columns)


def _create_fields(
    fields: h5py.Group,
    grid: h5py.Group,
    history: h5py.Group,
    coordinate: Quantity,
    quantities: Mapping[str, Quantity],
) -> None:
    """Create empty datasets of fields, one row per record, and link their axes."""
    record = create_scale(fields, "record", np.empty(0, int), ROW)
    axes = _link_axes(fields, grid, history)
    create_rows(fields, coordinate.name, coordinate, (record,), coordinate=coordinate.name)
    scales = (record, *axes)
    for name, quantity in quantities.items():
        create_rows(fields, name, quantity, scales, coordinate=coordinate.name, **COMPRESSED)


def _create_field(fields: h5py.Group, quantity: Quantity, coordinate: Quantity) -> None:
    """Create the dataset of one further field; earlier records have nan."""
    scales = tuple(fields[name] for name in ("record", "block", "x", "y") if name in fields)
    rows, along = len(fields["record"]), coordinate.name
    create_rows(fields, quantity.name, quantity, scales, rows, coordinate=along, **COMPRESSED)
