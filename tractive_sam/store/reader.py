"""Reads results files, finished or not.

In the first format of results files the rows of /history were allocated before they were filled;
/history/committed is the number of filled rows. /state had two slots: a record used slot (row
modulo 2). Texts had a variable length, and nothing had a checksum. A file in this format is
rewritten when its run is resumed.
"""

import json
import warnings
from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path

import h5py
import numpy as np

from tractive_sam.results import (
    BEFORE,
    BODIES,
    BOUND,
    COORDINATE,
    DIMS,
    FIELDS,
    LABELS,
    PACKAGE_FIELDS,
    PARTS,
    PROFILES,
    RENAMED_COLUMNS,
    TABLE_QUANTITIES,
    Grid,
    History,
    Quantity,
    Record,
    columns,
    fields_table,
    find_by_role,
    load_laws,
    restart_fields,
    storable_fields,
)
from tractive_sam.scene import Scene, allow_missing_files, use_contents
from tractive_sam.schema import SceneError, SceneWarning, toml
from tractive_sam.store import layout, tables
from tractive_sam.store.errors import ResultsError
from tractive_sam.store.layout import read_inputs
from tractive_sam.store.opening import ResultsFile, open_results
from tractive_sam.store.tables import StoredRows


def _update_scene_text(text: str) -> str:
    """Return the TOML text of an old scene with present keys and explicit old defaults.

    Raises
    ------
    SceneError
        If the text is no TOML.
    """
    # Present names of scene keys, by table and name in this format.
    renamed = {("load", "traction_x"): "force_x", ("load", "traction_y"): "force_y"}
    # Defaults of scene keys in this format that differ from today's.
    defaults = {("wear", "turns"): "equal"}
    tables = toml.parse(text)
    for (table, key), default in defaults.items():
        if table in tables:
            tables[table].setdefault(key, default)
    match tables:
        case {"body": {"A": dict(A), "B": dict(B)}} if "hardness" in {**A, **B}:
            for body in (A, B):  # one body could have a hardness alone; the other had 1
                body.setdefault("hardness", 1.0)
    for (table, key), present_key in renamed.items():
        if key in tables.get(table, {}):
            tables[table][present_key] = tables[table].pop(key)
    return toml.emit(tables)


def _read_legacy_state(file: ResultsFile, row: int) -> dict[str, np.ndarray]:
    """Return the fields after a record of an old file, by name; only the last two have them.

    Raises
    ------
    ResultsError
        If the file does not store the fields of this record.
    """
    slots = 2
    if not file.records - slots <= row < file.records:
        raise ResultsError(f"{file.path} holds no state of record {row}; run its scene again")
    mesh = (file.length("grid/x"), file.length("grid/y"))
    for name in FIELDS:
        file.check(f"state/{name}", (slots, *mesh))
    return {name: file.row(f"state/{name}", row % slots) for name in FIELDS}


def _read_legacy_versions(file: ResultsFile) -> tuple[tuple[int, dict[str, str]], ...]:
    """Return (first row, versions) of the programs that computed an old file."""
    version_prefix = "version_"
    names = [name for name in file.attributes("scene") if name.startswith(version_prefix)]
    packages = {name.removeprefix(version_prefix): file.text("scene", name) for name in names}
    return ((0, packages),)


def write_legacy_history(
    history: History, count: int, state: dict[str, np.ndarray], scene: Scene, file: h5py.File
) -> None:
    """Write the first records of an old history, and its state, to an empty file."""
    layout.create_layout(file, scene, history.grid)
    records = [_read_legacy_record(history, row) for row in range(count)]
    for record in records:
        layout.add_tables(file, [record])
    if records:
        tables.append(file, records)
        tables.put_state(file, count - 1, state)


def _read_legacy_record(history: History, row: int) -> Record:
    """Return one record of a history with its fields and stress."""
    revolution = int(history["revolution"][row])
    values = {}
    for name, quantity in history.columns.items():
        value = history[name][row]
        by_body = quantity.dims[:1] == ("body",)
        values[name] = dict(zip(BODIES, value, strict=True)) if by_body else value
    if revolution not in history.field_revolutions:
        return Record(values, history.columns)
    fields = restart_fields(history.state(revolution))
    saved = history.row_of(revolution)
    tables = {path: rows[saved] for path, rows in history.tables.items()}
    tables["fields"] = fields_table(fields, storable_fields(history.scene))
    return Record(values, history.columns, tables)


def open_history(path: str | PathLike[str]) -> History:
    """Open a results file as a history; its fields are read when accessed.

    A column that the file does not contain reads as nan.

    Parameters
    ----------
    path : path-like
        A file written by `HistoryWriter`, finished or not.

    Raises
    ------
    ResultsError
        If the file does not exist or cannot be read; the message states the remedy.

    Examples
    --------
    >>> _ = ts.roll(scene, "spheres.h5")
    >>> round(float(ts.open_history("spheres.h5")["Qx_over_P"][-1]), 3)
    0.259
    """
    path = Path(path)
    with open_results(path) as file:
        return _read_history(file)


def read_state(path: str | PathLike[str], row: int) -> dict[str, np.ndarray]:
    """Return the arrays from which a run resumes after a row, by name; ResultsError if not stored.

    Its names are listed in `FIELDS`, for a transient also in `BEFORE`, and by observers.

    Parameters
    ----------
    path : path-like
        A file written by `HistoryWriter`.
    row : int
        Row of this record.

    Returns
    -------
    dict of str to ndarray, shape (n_x, n_y)
        Fields by name; arrays of observers may have other shapes.

    Raises
    ------
    ResultsError
        If the file does not exist, cannot be read, or does not contain this state.
    """
    with open_results(Path(path)) as file:
        if file.version == 1:
            fields = _read_legacy_state(file, row)
            names = list(fields)
        else:
            stored_row = int(file.attribute("state", "record")) if file.records else -1
            if stored_row != row:
                raise ResultsError(f"{path} holds no state of record {row}; run its scene again")
            blocks = (file.length("fields/block"),) if "fields/block" in file else ()
            mesh = (*blocks, file.length("grid/x"), file.length("grid/y"))
            names = _stored_names("state", (*FIELDS, *BEFORE, BOUND.name), file)
            fields = {name: file.numbers(f"state/{name}", mesh) for name in names}
            arrays = (
                name for name in file.names("state") if name not in (*names, "block", "x", "y")
            )
            fields |= {name: file.all_numbers(f"state/{name}") for name in arrays}
    # An observer stores only nan for damage without a limit.
    lost = [
        name
        for name, values in fields.items()
        if not PACKAGE_FIELDS.get(name, BOUND).outside
        and not np.isfinite(values).all()
        and (name in names or not np.isnan(values).all())
    ]
    if lost:
        fault = f"{', '.join(lost)} of record {row} are not finite"
        raise ResultsError(f"{path} is damaged (state: {fault}); run its scene again")
    return fields


def has_state(path: str | PathLike, row: int) -> bool:
    """Return whether a file has the state after a row; without it a contact was all that fitted."""
    with open_results(Path(path)) as file:
        return file.version == 1 or int(file.attribute("state", "record")) >= row


def _read_history(file: ResultsFile) -> History:
    """Return the history in a file; fields, stress and fatigue are read when accessed."""
    n, m = file.records, file.length("fields/record")
    mesh = (file.length("grid/x"), file.length("grid/y"))
    half_x, half_y = map(float, file.attribute("grid", "half_length"))
    centre_x, centre_y = map(float, file.attribute("grid", "centre", (0.0, 0.0)))
    scene = _read_scene(file)
    # Also the dimensions for duty cycles, each block and the wear of each body in each block, and
    # columns of profiles.
    dims = (*DIMS, *(("block", *axes) for axes in DIMS), PARTS.dims)
    dims += tuple((name,) for name in PROFILES)
    quantities = columns(scene, _read_user_defined("history", dims, file))
    user_fields = {field.name: field for field in _read_user_defined("fields", ((),), file)}
    try:
        coordinate = find_by_role(quantities.values(), COORDINATE).name
    except LookupError as error:  # the scene names a process that has not written the file
        raise file.damage_error(f"history: {error}") from None
    try:
        laws = load_laws(file.text("scene", "law_records", ""), file.text("scene", "laws", ""))
    except ValueError as error:
        raise file.damage_error(f"scene {error}") from None
    return History(
        scene,
        file.text("scene", "status"),
        file.text("scene", "message"),
        Grid((half_x, half_y), mesh, centre=(centre_x, centre_y)),
        quantities,
        {name: _read_column(file, quantity, n, mesh) for name, quantity in quantities.items()},
        _read_tables(file, scene, {**storable_fields(scene), **user_fields}, coordinate),
        file.numbers(f"fields/{coordinate}", (m,)),
        _read_versions(file),
        laws,
        file.text("scene", "started", ""),
        file.text("scene", "measured", ""),
        file.text("scene", "datum", "node"),
    )


def _read_tables(
    file: ResultsFile, scene: Scene, fields: Mapping[str, Quantity], coordinate: str
) -> dict[str, StoredRows]:
    """Return the fields, stress and fatigue by path, read when accessed."""
    kinds, paths = ("stress", "passage"), ["fields"]
    shifts = {f"{kind}/block-{k}": b.shift_y for k, b in enumerate(scene.duty) for kind in kinds}
    for start in (*kinds, *shifts):
        for body in sorted({*BODIES}.intersection(file.names(start) if start in file else ())):
            paths += [f"{start}/{body}/{plane}" for plane in file.names(f"{start}/{body}")]
    if scene.fatigue is not None and "fatigue" in file:
        paths += [f"fatigue/{body}" for body in file.names("fatigue")]
    length, tables = file.length("fields/record"), {}
    for path in paths:
        kind = path.partition("/")[0]
        quantities = {**TABLE_QUANTITIES[kind], **(fields if kind == "fields" else {})}
        if kind not in kinds:  # which have all variables
            stored = _stored_names(path, quantities, file)
            quantities = {name: quantities[name] for name in stored}
        file.check(f"{path}/{coordinate}", (length,))
        shift = shifts.get("/".join(path.split("/")[:2]), 0.0)
        tables[path] = StoredRows.check(file, path, quantities, length, shift)
    return tables


def _read_column(
    file: ResultsFile, column: Quantity, records: int, mesh: tuple[int, int]
) -> np.ndarray:
    """Return the values of a column; nan if the file lacks it."""
    lengths = dict(zip("xy", mesh, strict=True))
    for dim in {"block", *PROFILES}.intersection(column.dims):
        lengths[dim] = file.length(f"history/{dim}")
    shape = tuple(lengths[k] if k in lengths else len(LABELS[k]) for k in column.dims)
    before = [name for name, present in RENAMED_COLUMNS.items() if present == column.name]
    names = (f"history/{name}" for name in (column.name, *before))
    name = next((name for name in names if name in file), None)
    if name is None and column.role != COORDINATE:
        return np.full((records, *shape), np.nan)
    name = name or f"history/{column.name}"
    if column.dims[:1] != ("body",) or file.version > 1:
        return file.numbers(name, (records, *shape))
    values = np.full((records, *shape), np.nan)
    stored_bodies = file.labels("history/body") if "history/body" in file else ()
    stored = file.numbers(name, (records, len(stored_bodies), *shape[1:]))
    for k, body in enumerate(stored_bodies):
        values[:, BODIES.index(body)] = stored[:, k]
    return values


def _read_user_defined(
    group: str, dims: tuple[tuple[str, ...], ...], file: ResultsFile
) -> list[Quantity]:
    """Return the user-defined columns or fields that a group describes."""
    try:
        described = json.loads(file.text(group, layout.USER, "[]"))
        quantities = [
            Quantity(**quantity | {"dims": tuple(quantity["dims"])}) for quantity in described
        ]
        wrong = [
            quantity.name
            for quantity in quantities
            if not quantity.name.isidentifier() or quantity.dims not in dims
        ]
        if wrong:
            raise ValueError(f"{wrong[0]!r} is not a valid name, or has wrong dimensions")
        return quantities
    except (ValueError, TypeError, KeyError) as error:
        kind = {"history": "columns", "fields": "fields"}[group]
        raise file.damage_error(f"user-defined {kind}: {error}") from None


def _stored_names(group: str, names: Iterable[str], file: ResultsFile) -> list[str]:
    """Return those names that a group of the file contains."""
    return [name for name in names if f"{group}/{name}" in file]


def _read_scene(file: ResultsFile) -> Scene:
    """Return the scene in a file, without repeating its warnings."""
    text = file.text("scene")
    if file.version > 1 and file.text("scene", "digest") != layout.digest(text):
        raise file.damage_error("scene: the text has changed since it was written")
    contents = read_inputs(file)
    try:
        with allow_missing_files(), use_contents(contents), warnings.catch_warnings():
            warnings.simplefilter("ignore", SceneWarning)
            if file.version == 1:
                text = _update_scene_text(text)
            return Scene.from_toml_text(text)
    except (ValueError, SceneError) as error:
        raise file.damage_error(f"scene: {error}") from None


def _read_versions(file: ResultsFile) -> tuple[tuple[int, dict[str, str]], ...]:
    """Return (first row, package versions) of the programs that computed the file."""
    if file.version == 1:
        return _read_legacy_versions(file)
    try:
        return tuple(
            (int(row), dict(packages))
            for row, packages in json.loads(file.text("scene", "versions"))
        )
    except (ValueError, TypeError) as error:
        raise file.damage_error(f"scene versions: {error}") from None
