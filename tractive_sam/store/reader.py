"""Reads results files, finished or not."""

import json
import tomllib
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from tractive_sam.results.history import History
from tractive_sam.results.quantities import (
    BODY_ERROR_BARS,
    BODY_POINTS,
    BODY_SCALARS,
    ERROR_BARS,
    FIELDS,
    POINTS,
    PROFILES,
    SCALARS,
    STATE,
    STRESS,
)
from tractive_sam.store import former, layout
from tractive_sam.store.errors import ResultsError
from tractive_sam.store.opening import Results, results_file
from tractive_sam.store.stored import StoredField, StoredStress

NEEDED = ("revolution",)
"""Columns that every file has."""


def open_history(path: str | Path) -> History:
    """Read a results file; its fields only when they are asked for.

    What was not recorded yet when the file was written reads as nan.

    Parameters
    ----------
    path : path-like
        A file written by `HistoryWriter`, finished or not.

    Raises
    ------
    ResultsError
        If there is no such file, or it cannot be read; the message names the cure.

    Examples
    --------
    >>> _ = ts.roll(scene, "spheres.h5")
    >>> round(float(ts.open_history("spheres.h5")["Qx_over_P"][-1]), 3)
    0.259
    """
    path = Path(path)
    with results_file(path) as file:
        return _history(file)


def state_of(path: str | Path, row: int) -> dict[str, np.ndarray]:
    """The fields after the last record whose contact was solved, by the names of `STATE`.

    Parameters
    ----------
    path : path-like
        A file written by `HistoryWriter`.
    row : int
        Which record that is.

    Returns
    -------
    dict of str to ndarray, shape (n_x, n_y)

    Raises
    ------
    ResultsError
        If there is no such file, or it cannot be read, or holds no such state.
    """
    with results_file(Path(path)) as file:
        if file.version == 1:
            fields = former.state(file, row)
        else:
            kept = int(file.attribute("state", "record")) if file.records else -1
            if kept != row:
                raise ResultsError(f"{path} holds no state of record {row}; run its scene again")
            mesh = (file.length("grid/x"), file.length("grid/y"))
            fields = {name: file.numbers(f"state/{name}", mesh) for name in STATE}
    # The gap is infinite where a mesh has grown.
    lost = [name for name in STATE if name != "gap" and not np.isfinite(fields[name]).all()]
    if lost:
        told = f"{', '.join(lost)} of record {row} are not finite"
        raise ResultsError(f"{path} is damaged (state: {told}); run its scene again")
    return fields


def _history(file: Results) -> History:
    n, m = file.records, file.length("fields/record")
    mesh = (file.length("grid/x"), file.length("grid/y"))
    bodies, versions = _bodies(file), _versions(file)
    for name in _known("fields", FIELDS, file):
        file.check(f"fields/{name}", (m, *mesh))

    def rows(names: Iterable[str], *shape: int, optional: bool = False) -> dict[str, np.ndarray]:
        """Rows of /history; what is optional is left out where it is missing, else it is nan."""
        found = _known("history", names, file) if optional else names
        return {
            name: file.numbers(f"history/{name}", (n, *shape), name not in NEEDED) for name in found
        }

    return History(
        scene_toml=_scene(file),
        status=file.text("scene", "status"),
        message=file.text("scene", "message"),
        **{name: float(file.attribute("scene", name)) for name in layout.REFERENCE},
        half_length=tuple(map(float, file.attribute("grid", "half_length"))),
        x=file.numbers("grid/x", mesh[:1]),
        y=file.numbers("grid/y", mesh[1:]),
        scalars=rows(SCALARS) | rows(ERROR_BARS, optional=True),
        points=rows(POINTS, 2),
        profiles=rows(PROFILES, mesh[1]),
        fields={name: StoredField(file.path, name, m) for name in _known("fields", FIELDS, file)},
        field_revolutions=file.numbers("fields/revolution", (m,)),
        bodies=bodies,
        body_scalars=rows(BODY_SCALARS, len(bodies))
        | rows(BODY_ERROR_BARS, len(bodies), optional=True),
        body_points=rows(BODY_POINTS, len(bodies), 3),
        stresses=_stresses(file, m),
        provenance=versions,
    )


def _known(group: str, names: Iterable[str], file: Results) -> list[str]:
    return [name for name in names if f"{group}/{name}" in file]


def _scene(file: Results) -> str:
    text = file.text("scene")
    if file.version > 1 and file.text("scene", "digest") != layout.digest(text):
        raise file.damaged("scene: the text is not as it was written")
    try:
        tomllib.loads(text)
    except ValueError as error:
        raise file.damaged(f"scene: {error}") from None
    return former.scene(text) if file.version == 1 else text


def _bodies(file: Results) -> tuple[str, ...]:
    if file.version == 1:
        return former.bodies(file)
    return tuple(file.text("history", layout.BODIES, ""))


def _versions(file: Results) -> tuple[tuple[int, dict[str, str]], ...]:
    if file.version == 1:
        return former.versions(file)
    try:
        return tuple(
            (int(row), dict(one)) for row, one in json.loads(file.text("scene", "versions"))
        )
    except (ValueError, TypeError) as error:
        raise file.damaged(f"scene versions: {error}") from None


def _stresses(file: Results, length: int) -> dict[tuple[str, str], StoredStress]:
    """Every stress that is kept; its datasets are looked at, but not read."""
    found = {}
    for body in file.names("stress"):
        for plane in file.names(f"stress/{body}"):
            group = f"stress/{body}/{plane}"
            axes = [name for name in ("x", "y", "depth") if f"{group}/{name}" in file]
            shape = tuple(file.length(f"{group}/{name}") for name in axes)
            file.check(f"{group}/revolution", (length,))
            for name in STRESS:
                file.check(f"{group}/{name}", (length, *shape))
            found[body, plane] = StoredStress(file.path, body, plane, length)
    return found
