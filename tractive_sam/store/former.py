"""What the first format of results files had otherwise.

Rows of /history were laid out before they were filled: /history/committed told how many were.
/state held two slots, of which a record took the one that its row leaves when divided by two. Texts
were of any length, and nothing had a checksum. Such a file is rewritten when it is rolled on.
"""

import h5py
import numpy as np

from tractive_sam.results import BODIES, FIELDS, FORMER, History, Record, fields
from tractive_sam.scene import Scene
from tractive_sam.schema import toml
from tractive_sam.store import layout, rows
from tractive_sam.store.errors import ResultsError
from tractive_sam.store.opening import Results

SLOTS = 2
VERSION_PREFIX = "version_"


DEFAULTS = {("wear", "turns"): "equal"}
"""What was computed where a scene of those files does not say, and would be another thing now."""


RENAMED = {("load", "traction_x"): "force_x", ("load", "traction_y"): "force_y"}
"""Keys of those scenes by their names of today."""


def scene(text: str) -> str:
    """The text of a scene, with what it meant when it was written.

    Raises
    ------
    SceneError
        If it is no TOML.
    """
    tables = toml.parse(text)
    for (table, key), default in DEFAULTS.items():
        if table in tables:
            tables[table].setdefault(key, default)
    match tables:
        case {"body": {"A": dict(A), "B": dict(B)}} if "hardness" in {**A, **B}:
            for body in (A, B):  # one could be given alone, the other was 1 then
                body.setdefault("hardness", 1.0)
    for (table, key), now in RENAMED.items():
        if key in tables.get(table, {}):
            tables[table][now] = tables[table].pop(key)
    return toml.emit(tables)


def state(file: Results, row: int) -> dict[str, np.ndarray]:
    """The fields after one of the last two records, by the names of `FIELDS`.

    Raises
    ------
    ResultsError
        If nothing is kept of it.
    """
    if not file.records - SLOTS <= row < file.records:
        raise ResultsError(f"{file.path} holds no state of record {row}; run its scene again")
    mesh = (file.length("grid/x"), file.length("grid/y"))
    for name in FIELDS:
        file.check(f"state/{name}", (SLOTS, *mesh))
    return {name: file.row(f"state/{name}", row % SLOTS) for name in FIELDS}


def bodies(file: Results) -> tuple[str, ...]:
    """Bodies whose stress was computed."""
    return file.labels("history/body") if "history/body" in file else ()


def versions(file: Results) -> tuple[tuple[int, dict[str, str]], ...]:
    """The programs that computed it."""
    names = [name for name in file.attributes("scene") if name.startswith(VERSION_PREFIX)]
    found = {name.removeprefix(VERSION_PREFIX): file.text("scene", name) for name in names}
    return ((0, found),)


def names(column: str) -> tuple[str, ...]:
    """The name of a column, and the one that it had in this format."""
    return column, *(before for before, now in FORMER.items() if now == column)


def rewrite(
    history: History, count: int, state: dict[str, np.ndarray], scene: Scene, file: h5py.File
) -> None:
    """Write the first records of a history, and the state after them, into an empty file."""
    layout.create(file, scene, history.grid)
    records = [_record(history, row) for row in range(count)]
    for record in records:
        layout.add_columns(file, [record])
    if records:
        rows.append(file, records)
        rows.put_state(file, count - 1, state)


def _record(history: History, row: int) -> Record:
    revolution = int(history["revolution"][row])
    values = {}
    for name, one in history.columns.items():
        value = history[name][row]
        values[name] = dict(zip(BODIES, value, strict=True)) if one.dims[:1] == ("body",) else value
    if revolution not in history.field_revolutions:
        return Record(values, history.columns)
    stress = tuple(history.stress(*plane, revolution) for plane in history.planes)
    return Record(values, history.columns, fields(history.state(revolution)), stress)
