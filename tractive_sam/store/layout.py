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
    /passage   only with [[inclusion]]: a group <body>/inclusion-<k> with record, revolution and
               moment; place, p_max, lift and von_mises (record, moment); for duty cycles, these
               groups are in the groups block-0, block-1 and so on
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

HDF5 stores texts of variable length in a heap that all texts of a file share. The heap has no
checksum, and HDF5 may never return from a damaged heap. So the package reads only texts of fixed
length.
"""

import hashlib
import json
import math
import platform
from collections.abc import Iterable, Mapping, Sequence
from functools import cache, partial
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from tractive_sam.rail import Profile, RailSections
from tractive_sam.results import (
    BOUND,
    COLUMNS,
    COORDINATE,
    FIELDS,
    MESH_AXES,
    PACKAGE_FIELDS,
    REVOLUTION,
    Grid,
    LawRecord,
    Quantity,
    Record,
    Table,
    Variable,
    column_axes,
    describe_laws,
    dump_laws,
    find_by_role,
    index_by_name,
    storable_fields,
)
from tractive_sam.results import columns as columns_of
from tractive_sam.scene import FileContent, Scene, block_label
from tractive_sam.store.errors import ResultsError
from tractive_sam.store.opening import (
    FORMAT,
    FORMAT_VERSION,
    ResultsFile,
    decode_text,
    open_results,
)


def set_text(node: h5py.Group | h5py.Dataset, name: str, text: str) -> None:
    """Set an HDF5 attribute to a text of fixed length."""
    encoded = text.encode()
    node.attrs.create(name, encoded, dtype=_text_type(encoded))


def create_text(group: h5py.Group, name: str, text: str) -> h5py.Dataset:
    """Create an HDF5 dataset with one text."""
    encoded = text.encode()
    return group.create_dataset(name, data=np.array(encoded, _text_type(encoded)))


def _text_type(encoded: bytes) -> np.dtype:
    """Return the HDF5 type of an encoded text with a final zero byte."""
    return h5py.string_dtype("utf-8", len(encoded) + 1)


def versions() -> dict[str, str]:
    """Return the versions of Python, this package and the five it computes with, by name."""
    packages = ("tractive-sam", "numpy", "scipy", "numba", "pyfftw", "h5py")
    return {"python": platform.python_version()} | {name: _version(name) for name in packages}


@cache  # reading the description of a package takes milliseconds
def _version(package: str) -> str:
    """Return the version of an installed package, or a note that it is missing."""
    try:
        return version(package)
    except PackageNotFoundError:  # run from a source tree
        return "not installed"


COMPRESSED: dict[str, Any] = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
"""Filters of fields."""

CHUNK_BYTES = 4096
"""Least size of a chunk: a page of the disk. The checksum of a chunk of zeros is zero, so the
loss of a page that contains all of a chunk with its checksum would not be noticed."""


def create_labels(group: h5py.Group, name: str, values: Sequence[str], about: str) -> None:
    """Create an HDF5 dimension scale of texts of variable length.

    Some of them do not support texts of fixed length. So these texts have a variable length, and
    this package never reads them.
    """
    dataset = group.create_dataset(name, data=values)
    dataset.make_scale(name)
    describe_dataset(dataset, Quantity(name, "1", about))


def create_scale(
    group: h5py.Group, name: str, values: np.ndarray, quantity: Quantity
) -> h5py.Dataset:
    """Create an HDF5 dimension scale that can grow."""
    chunk = max(len(values), CHUNK_BYTES // 8)
    dataset = group.create_dataset(
        name, data=values, maxshape=(None,), chunks=(chunk,), fletcher32=True
    )
    dataset.make_scale(name)
    return describe_dataset(dataset, quantity)


def create_rows(
    group: h5py.Group,
    name: str,
    quantity: Quantity,
    dimensions: tuple[h5py.Dataset, ...],
    rows: int = 0,
    coordinate: str = "",
    **filters: str | int | bool,
) -> h5py.Dataset:
    """Create a dataset of one row per record that can grow; unknown values are nan or -1 (int)."""
    shape = tuple(len(scale) for scale in dimensions[1:])
    min_rows = math.ceil(CHUNK_BYTES / (8 * math.prod(shape)))
    dataset = group.create_dataset(
        name,
        shape=(rows, *shape),
        dtype=int if quantity.whole else float,
        maxshape=(None,) * len(dimensions),
        chunks=(1 if filters else max(min_rows, rows), *shape),
        fillvalue=-1 if quantity.whole else np.nan,
        fletcher32=True,
        **filters,
    )
    for k, scale in enumerate(dimensions):
        h5py.h5ds.attach_scale(dataset.id, scale.id, k)
    return describe_dataset(dataset, quantity, coordinate if coordinate != name else "")


def describe_dataset(dataset: h5py.Dataset, quantity: Quantity, along: str = "") -> h5py.Dataset:
    """Store the unit and description of a quantity in a new dataset, and return the dataset."""
    texts = quantity.attributes | ({"coordinates": along} if along else {})
    # h5py's low-level interface is faster: a file has hundreds of these attributes.
    kind = h5py.h5t.py_create(h5py.string_dtype(), logical=True)
    scalar = h5py.h5s.create(h5py.h5s.SCALAR)
    for name, text in texts.items():
        attribute = h5py.h5a.create(dataset.id, name.encode(), kind, scalar)
        attribute.write(np.array(text, h5py.string_dtype()))
    return dataset


def add_state(state: h5py.Group, name: str, values: np.ndarray) -> None:
    """Add an array to the group of arrays from which a run resumes."""
    chunks = tuple(max(1, n) for n in values.shape)
    about = {"chunks": chunks, "maxshape": (None,) * values.ndim, "fletcher32": True}
    describe_dataset(
        state.create_dataset(name, data=values, **about), Quantity(name, "", "to continue from")
    )


_PARTS = ("y", "z", "tangent_y", "tangent_z")
"""Numbers of profiles: points and tangents."""


def add_inputs(file: h5py.File, scene: Scene) -> None:
    """Add the content of the files that a scene names, with its hashes, to a results file."""
    for key, (_, content, reading) in scene.inputs.items():
        group = file.require_group("inputs").create_group(key)
        hashes = json.dumps(content.hashes)
        for name, text in (("path", content.path), ("hashes", hashes), ("reading", reading)):
            set_text(group, name, text)
        parsed = content.get(reading)
        if notes := getattr(parsed, "notes", ()):
            set_text(group, "notes", json.dumps(notes))
        match parsed:
            case Profile() as profile:
                _add_arrays(group, {"s": profile.s}, _split(profile.points, profile.tangents))
            case RailSections() as rail:
                axes = {"x": rail.x, "node": np.arange(float(rail.points.shape[1]))}
                _add_arrays(group, axes, _split(rail.points, rail.tangents))
            case (x, y, separation):
                _add_arrays(group, {"x": x, "y": y}, {"separation": separation})


def read_inputs(file: ResultsFile) -> list[FileContent]:
    """Return the contents of the files that the scene of a results file names."""
    contents: dict[str, FileContent] = {}
    for key in file.names("inputs") if "inputs" in file else ():
        group = f"inputs/{key}"
        path, hashes, reading = (file.text(group, name) for name in ("path", "hashes", "reading"))
        try:
            files = {str(name): str(digest) for name, digest in json.loads(hashes).items()}
            content = contents.setdefault(path, FileContent(path, files, is_stored=True))
            if f"{group}/separation" in file:  # may be large
                content.parsed[reading] = partial(_read_map, file.path, group, hashes)
            elif f"{group}/z" in file:
                content.parsed[reading] = _read_profile(file, group)
        except (ValueError, AttributeError) as error:
            raise file.damage_error(f"{group}: {error}") from None
    return [*contents.values()]


def _split(points: np.ndarray, tangents: np.ndarray) -> dict[str, np.ndarray]:
    """Return the parts of points and tangents, shape (..., 2), by name."""
    parts = np.moveaxis(np.concatenate((points, tangents), axis=-1), -1, 0)
    return dict(zip(_PARTS, parts, strict=True))


def _add_arrays(
    group: h5py.Group, axes: dict[str, np.ndarray], arrays: dict[str, np.ndarray]
) -> None:
    """Add the axes of arrays as scales, and the arrays with checksums."""
    about = {
        "x": "position along the track",
        "y": "lateral position",
        "z": "height, positive downwards",
        "s": "arc length",
        "node": "number of a point of a section",
        "tangent_y": "derivative of y",
        "tangent_z": "derivative of z",
        "separation": "separation added to the radii",
    }
    for name, values in axes.items():
        create_scale(group, name, values, Quantity(name, "mm", about[name]))
    for name, values in arrays.items():
        dataset = group.create_dataset(
            name, data=values, chunks=True, fletcher32=True, **COMPRESSED
        )
        for k, axis in enumerate(axes):
            h5py.h5ds.attach_scale(dataset.id, group[axis].id, k)
        describe_dataset(dataset, Quantity(name, "mm", about[name]))


def _read_profile(file: ResultsFile, group: str) -> Profile | RailSections:
    """Return the profile, or the sections of a rail, in a group; ValueError for wrong shapes."""
    parts = np.stack([file.all_numbers(f"{group}/{name}") for name in _PARTS], axis=-1)
    kind: Any = Profile if f"{group}/s" in file else RailSections
    along = file.all_numbers(f"{group}/{'s' if kind is Profile else 'x'}")
    if parts.shape[:1] != along.shape or not np.isfinite(parts).all():
        raise ValueError(f"a profile of the shape {parts.shape}")
    notes = tuple(map(str, json.loads(file.text(group, "notes", "[]"))))
    return kind(along, parts[..., :2], parts[..., 2:], notes)


def _read_map(path: Path, group: str, hashes: str) -> tuple[np.ndarray, ...]:
    """Return x, y and separation in a results file; ResultsError if it has been replaced."""
    with open_results(path) as file:
        if "inputs" not in file or file.text(group, "hashes") != hashes:
            raise ResultsError(f"{path} has been replaced since it was opened; open it again")
        x, y, separation = (
            file.all_numbers(f"{group}/{name}") for name in ("x", "y", "separation")
        )
        if separation.shape != (x.size, y.size) or not np.isfinite(separation).all():
            raise file.damage_error(f"{group}: a separation of the shape {separation.shape}")
    return x, y, separation


RUNNING = ("running", "the computation has not ended yet, or was killed")
"""Status and message of a run that has not ended."""

USER = "own"
"""Attribute of /history and /fields: user-defined columns and fields."""

ROW = Quantity("record", "1", "row of /history")


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
    for name, centres in (("x", mesh.x), ("y", mesh.y)):
        create_scale(grid, name, centres, MESH_AXES[name])
    # A record may replace columns that have a role by other columns.
    fixed_columns = {
        name: quantity
        for name, quantity in columns_of(scene, (coordinate,)).items()
        if quantity.role in ("", COORDINATE)
    }
    create_table(file, "history", coordinate, Table({}))
    _require_axis(file, file["history"], "y")
    _add_columns(file, fixed_columns, column_axes(fixed_columns, {}))
    if names := [block_label(scene, k) for k in range(len(scene.duty))]:
        create_labels(file["history"], "block", names, "block of the duty cycle")
    dims = ("block", "x", "y") if names else ("x", "y")
    fields = {
        name: Variable(quantity, dims, None)
        for name, quantity in storable_fields(scene).items()
        if quantity is not BOUND
    }
    create_table(file, "fields", coordinate, Table(fields))
    file.create_group("stress")
    state = file.create_group("state")
    state.attrs["record"] = -1  # none yet
    scales = tuple(_require_axis(file, state, dim) for dim in dims)
    for name, quantity in FIELDS.items():
        create_rows(state, name, quantity, scales, rows=len(scales[0]))


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


def add_tables(file: h5py.File, records: Iterable[Record]) -> None:
    """Create the datasets of columns, fields, stress and fatigue of records that a file lacks."""
    created: set[str] = set()
    for record in records:
        if not record.columns.keys() <= created:
            _add_columns(file, record.columns, column_axes(record.columns, record.values))
            created |= record.columns.keys()
        for path, table in record.tables.items():
            missing = [name for name in table.variables if f"{path}/{name}" not in file]
            if missing:
                create_table(file, path, record.coordinate, table)
            user_defined = [name for name in missing if name not in PACKAGE_FIELDS]
            if path == "fields" and user_defined:
                quantities = [table.variables[name].quantity for name in user_defined]
                _add_user_defined(file[path], quantities)


def create_table(file: h5py.File, path: str, coordinate: Quantity, table: Table) -> None:
    """Create the group of a table, and the datasets that it lacks, one row a record."""
    group = file.require_group(path)
    filters = COMPRESSED if path.partition("/")[0] in ("fields", "fatigue") else {}
    if "record" not in group:
        create_scale(group, "record", np.empty(0, int), ROW)
        if path != "history":
            create_rows(group, coordinate.name, coordinate, (group["record"],))
    for name, value in table.attributes.items():
        if isinstance(value, float):
            group.attrs[name] = value
    for name, axis in table.axes.items():
        _require_axis(file, group, name, axis)
    for name, variable in table.variables.items():
        if name not in group:
            axes = (_require_axis(file, group, dim) for dim in variable.dims)
            scales, along = (group["record"], *axes), coordinate.name
            create_rows(group, name, variable.quantity, scales, coordinate=along, **filters)


def _require_axis(
    file: h5py.File, group: h5py.Group, name: str, axis: Variable | None = None
) -> h5py.Dataset:
    """Return the scale of a dimension, created or linked if a group lacks it."""
    shared = {"x": "grid", "y": "grid", "block": "history"}.get(name, "")
    if name in group:
        return group[name]
    if f"{shared}/{name}" in file:
        group[name] = file[f"{shared}/{name}"]
    elif axis is not None and isinstance(axis.data, np.ndarray):
        create_scale(group, name, axis.data, axis.quantity)
    elif axis is not None:
        create_labels(group, name, axis.data, axis.quantity.long_name)
    return group[name]


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


def _add_columns(
    file: h5py.File, columns: Mapping[str, Quantity], axes: Mapping[str, Variable]
) -> None:
    """Create the datasets of columns that a file lacks, with their axes."""
    history = file["history"]
    missing = [column for name, column in columns.items() if name not in history]
    coordinate = find_by_role(columns.values(), COORDINATE)
    variables = {column.name: Variable(column, column.dims, None) for column in missing}
    used = {dim: axes[dim] for column in missing for dim in column.dims if dim in axes}
    create_table(file, "history", coordinate, Table(variables, used))
    # A process may compute a column that the package reads from contacts of other scenes; a
    # coordinate may be a column of the package without being the coordinate of the scene.
    package = index_by_name(COLUMNS)
    user_defined = [
        column
        for column in missing
        if column.name not in package
        or (column.of is None) > (package[column.name].of is None)
        or (column.role == COORDINATE and column != REVOLUTION)
    ]
    if user_defined:
        _add_user_defined(history, user_defined)
