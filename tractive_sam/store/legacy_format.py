"""Reads the first format of results files.

In this format the rows of /history were allocated before they were filled; /history/committed is
the number of filled rows. /state had two slots: a record used slot (row modulo 2). Texts had a
variable length, and nothing had a checksum. A file in this format is rewritten when its run is
resumed.
"""

import h5py
import numpy as np

from tractive_sam.results import BODIES, FIELDS, RENAMED_COLUMNS, History, Record, restart_fields
from tractive_sam.scene import Scene
from tractive_sam.schema import toml
from tractive_sam.store import layout, rows
from tractive_sam.store.errors import ResultsError
from tractive_sam.store.opening import ResultsFile


def update_scene_text(text: str) -> str:
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


def read_legacy_state(file: ResultsFile, row: int) -> dict[str, np.ndarray]:
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


def read_bodies(file: ResultsFile) -> tuple[str, ...]:
    """Return the bodies with stored stress in an old file; () if there are none."""
    return file.labels("history/body") if "history/body" in file else ()


def read_versions(file: ResultsFile) -> tuple[tuple[int, dict[str, str]], ...]:
    """Return (first row, versions) of the programs that computed an old file."""
    version_prefix = "version_"
    names = [name for name in file.attributes("scene") if name.startswith(version_prefix)]
    packages = {name.removeprefix(version_prefix): file.text("scene", name) for name in names}
    return ((0, packages),)


def column_names(column: str) -> tuple[str, ...]:
    """Return the present name of a column and its name in old files."""
    return column, *(before for before, present in RENAMED_COLUMNS.items() if present == column)


def write_history(
    history: History, count: int, state: dict[str, np.ndarray], scene: Scene, file: h5py.File
) -> None:
    """Write the first records of an old history, and its state, to an empty file."""
    layout.create_layout(file, scene, history.grid)
    records = [_read_record(history, row) for row in range(count)]
    for record in records:
        layout.add_columns(file, [record])
    if records:
        rows.append(file, records)
        rows.put_state(file, count - 1, state)


def _read_record(history: History, row: int) -> Record:
    """Return one record of a history with its fields and stress."""
    revolution = int(history["revolution"][row])
    values = {}
    for name, quantity in history.columns.items():
        value = history[name][row]
        by_body = quantity.dims[:1] == ("body",)
        values[name] = dict(zip(BODIES, value, strict=True)) if by_body else value
    if revolution not in history.field_revolutions:
        return Record(values, history.columns)
    stress = tuple(history.stress(*plane, revolution) for plane in history.planes)
    return Record(values, history.columns, restart_fields(history.state(revolution)), stress)
