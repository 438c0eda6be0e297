"""What the first format of results files had otherwise.

Rows of /history were laid out before they were filled: /history/committed told how many were.
/state held two slots, of which a record took the one that its row leaves when divided by two. Texts
were of any length, and nothing had a checksum. Such a file is rewritten when it is rolled on.
"""

import h5py
import numpy as np

from tractive_sam.results import STATE, History, Record
from tractive_sam.scene import toml
from tractive_sam.store import layout, rows
from tractive_sam.store.errors import ResultsError
from tractive_sam.store.opening import Results

SLOTS = 2
VERSION_PREFIX = "version_"


DEFAULTS = {("wear", "turns"): "equal"}
"""What was computed where a scene of those files does not say, and would be another thing now."""


def scene(text: str) -> str:
    """The text of a scene, with what it meant when it was written.

    Raises
    ------
    SceneError
        If it is no TOML.
    """
    tables = toml.parse(text)
    lacking = [
        (table, key) for table, key in DEFAULTS if table in tables and key not in tables[table]
    ]
    for table, key in lacking:
        tables[table][key] = DEFAULTS[table, key]
    return toml.emit(tables) if lacking else text


def state(file: Results, row: int) -> dict[str, np.ndarray]:
    """The fields after one of the last two records, by the names of `STATE`.

    Raises
    ------
    ResultsError
        If nothing is kept of it.
    """
    if not file.records - SLOTS <= row < file.records:
        raise ResultsError(f"{file.path} holds no state of record {row}; run its scene again")
    mesh = (file.length("grid/x"), file.length("grid/y"))
    for name in STATE:
        file.check(f"state/{name}", (SLOTS, *mesh))
    return {name: file.row(f"state/{name}", row % SLOTS) for name in STATE}


def bodies(file: Results) -> tuple[str, ...]:
    """Bodies whose stress was computed."""
    return file.labels("history/body") if "history/body" in file else ()


def versions(file: Results) -> tuple[tuple[int, dict[str, str]], ...]:
    """The programs that computed it."""
    names = [name for name in file.attributes("scene") if name.startswith(VERSION_PREFIX)]
    found = {name.removeprefix(VERSION_PREFIX): file.text("scene", name) for name in names}
    return ((0, found),)


def rewrite(
    history: History, count: int, state: dict[str, np.ndarray], scene_toml: str, file: h5py.File
) -> None:
    """Write the first records of a history, and the state after them, into an empty file."""
    reference = {name: getattr(history, name) for name in layout.REFERENCE}
    layout.create(file, scene_toml, history, reference)
    kept = dict(zip(history.field_revolutions.tolist(), range(count), strict=False))
    records = [_record(history, row, kept) for row in range(count)]
    for record in records:
        layout.add_columns(file, record)
    if records:
        rows.append(file, records)
        rows.put_state(file, count - 1, state)


def _record(history: History, row: int, kept: dict[int, int]) -> Record:
    revolution = int(history["revolution"][row])
    in_bodies = history.body_scalars | history.body_points
    field_row = kept.get(revolution)
    return Record(
        revolution,
        *(
            {name: values[row] for name, values in kind.items()}
            for kind in (history.scalars, history.points, history.profiles)
        ),
        fields={}
        if field_row is None
        else {name: values[field_row] for name, values in history.fields.items()},
        bodies={
            body: {name: values[row, column] for name, values in in_bodies.items()}
            for column, body in enumerate(history.bodies)
        },
        stress=()
        if field_row is None
        else tuple(values[field_row] for values in history.stresses.values()),
    )
