"""Reads results files, finished or not."""

import json
import math
import warnings
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from tractive_sam.results import (
    BEFORE,
    BODIES,
    BOUND,
    COORDINATE,
    CYCLES,
    DIMS,
    FIELDS,
    LABELS,
    OUTSIDE,
    PARTS,
    STRESS,
    Grid,
    History,
    LawRecord,
    Quantity,
    columns,
    kept_fields,
    load_laws,
    of_role,
)
from tractive_sam.scene import Scene, allow_missing_files
from tractive_sam.schema import SceneError, SceneWarning
from tractive_sam.store import former, layout
from tractive_sam.store.errors import ResultsError
from tractive_sam.store.opening import Results, results_file
from tractive_sam.store.stored import StoredCycles, StoredField, StoredStress


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
    """The fields after the last record whose contact was solved, by the names of `FIELDS`.

    Of a transient also by those of `BEFORE`.

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
            mesh = _shape_of_fields(file)
            names = (*FIELDS, *_known("state", (*BEFORE, BOUND.name), file))
            fields = {name: file.numbers(f"state/{name}", mesh) for name in names}
            more = (name for name in file.names("state") if name not in (*names, "block", "x", "y"))
            fields |= {name: file.whole(f"state/{name}") for name in more}
    lost = [name for name in fields if name not in OUTSIDE and not np.isfinite(fields[name]).all()]
    if lost:
        told = f"{', '.join(lost)} of record {row} are not finite"
        raise ResultsError(f"{path} is damaged (state: {told}); run its scene again")
    return fields


def _history(file: Results) -> History:
    n, m = file.records, file.length("fields/record")
    mesh = (file.length("grid/x"), file.length("grid/y"))
    half_length = tuple(map(float, file.attribute("grid", "half_length")))
    scene = _scene(file)
    # Those of a duty cycle, too: of each block, and what each block wore off each body.
    dims = (*DIMS, *(("block", *each) for each in DIMS), PARTS.dims)
    known = columns(scene, _own("history", dims, file))
    own_fields = {one.name: one for one in _own("fields", ((),), file)}
    coordinate = of_role(known.values(), COORDINATE).name
    kept = _known("fields", (*kept_fields(scene), *own_fields), file)
    for name in kept:
        file.check(f"fields/{name}", (m, *_shape_of_fields(file)))
    return History(
        scene,
        file.text("scene", "status"),
        file.text("scene", "message"),
        Grid(half_length, mesh),
        known,
        {name: _column(file, one, n, mesh) for name, one in known.items()},
        {name: StoredField(file.path, name, m) for name in kept},
        file.numbers(f"fields/{coordinate}", (m,)),
        _stresses(file, m, coordinate),
        _versions(file),
        _laws(file),
        file.text("scene", "started", ""),
        _cycles(file, scene, m),
        tuple(_stresses(file, m, coordinate, k, one.shift_y) for k, one in enumerate(scene.duty)),
        file.text("scene", "measured", ""),
        file.text("scene", "datum", "node"),
        own_fields,
    )


def _laws(file: Results) -> dict[str, LawRecord]:
    """Return the laws that replaced those of the scene."""
    try:
        return load_laws(file.text("scene", "law_records", ""), file.text("scene", "laws", ""))
    except ValueError as error:
        raise file.damaged(f"scene {error}") from None


def _cycles(file: Results, scene: Scene, length: int) -> dict[str, StoredCycles]:
    """What is kept of bodies that are followed; its datasets are looked at, but not read."""
    found, asked = {}, scene.fatigue
    for body in file.names("fatigue") if asked is not None and "fatigue" in file else ():
        k, group = asked.shear_yield_stress, f"fatigue/{body}"
        rows, axes = [file.length("grid/y")], {}
        for name in ("depth", "zeta"):
            axes[name] = file.length(f"{group}/{name}") if f"{group}/{name}" in file else 0
        axes["y"] = rows[0]
        for name, one in CYCLES.items():
            if f"{group}/{name}" in file:
                file.check(f"{group}/{name}", (length, *(axes[axis] for axis in one.dims)))
        found[body] = StoredCycles(file.path, body, math.nan if k is None else k, length)
    return found


def _shape_of_fields(file: Results) -> tuple[int, ...]:
    """Of one record; with a dimension more where blocks are told apart."""
    blocks = (file.length("fields/block"),) if "fields/block" in file else ()
    return (*blocks, file.length("grid/x"), file.length("grid/y"))


def _column(file: Results, one: Quantity, records: int, mesh: tuple[int, int]) -> np.ndarray:
    """A column; nan where the file has none."""
    along = dict(zip("xy", mesh, strict=True))
    if "block" in one.dims:
        along["block"] = file.length("history/block")
    shape = tuple(along[k] if k in along else len(LABELS[k]) for k in one.dims)
    name = next((f"history/{k}" for k in former.names(one.name) if f"history/{k}" in file), None)
    if name is None and one.role != COORDINATE:
        return np.full((records, *shape), np.nan)
    if one.dims[:1] != ("body",) or file.version > 1:
        return file.numbers(name or f"history/{one.name}", (records, *shape))
    values, of_bodies = np.full((records, *shape), np.nan), former.bodies(file)
    found = file.numbers(name, (records, len(of_bodies), *shape[1:]))
    for k, body in enumerate(of_bodies):
        values[:, BODIES.index(body)] = found[:, k]
    return values


def _own(group: str, dims: tuple[tuple[str, ...], ...], file: Results) -> list[Quantity]:
    """Return the columns or fields of a group that are not the package's."""
    try:
        described = json.loads(file.text(group, layout.OWN, "[]"))
        found = [Quantity(**one | {"dims": tuple(one["dims"])}) for one in described]
        wrong = [one.name for one in found if not one.name.isidentifier() or one.dims not in dims]
        if wrong:
            raise ValueError(f"{wrong[0]!r} is no name, or has other dimensions")
        return found
    except (ValueError, TypeError, KeyError) as error:
        what = {"history": "columns", "fields": "fields"}[group]
        raise file.damaged(f"own {what}: {error}") from None


def _known(group: str, names: Iterable[str], file: Results) -> list[str]:
    return [name for name in names if f"{group}/{name}" in file]


def _scene(file: Results) -> Scene:
    text = file.text("scene")
    if file.version > 1 and file.text("scene", "digest") != layout.digest(text):
        raise file.damaged("scene: the text is not as it was written")
    try:
        with (
            allow_missing_files(),
            warnings.catch_warnings(),
        ):  # of a mesh too coarse, say: its user was warned then
            warnings.simplefilter("ignore", SceneWarning)  # its user was warned then
            return Scene.from_toml_text(former.scene(text) if file.version == 1 else text)
    except (ValueError, SceneError) as error:
        raise file.damaged(f"scene: {error}") from None


def _versions(file: Results) -> tuple[tuple[int, dict[str, str]], ...]:
    if file.version == 1:
        return former.versions(file)
    try:
        return tuple(
            (int(row), dict(one)) for row, one in json.loads(file.text("scene", "versions"))
        )
    except (ValueError, TypeError) as error:
        raise file.damaged(f"scene versions: {error}") from None


def _stresses(
    file: Results,
    length: int,
    coordinate: str,
    block: int | None = None,
    shift: float = 0.0,
) -> dict[tuple[str, str], StoredStress]:
    """Every stress that is kept, of a block or the whole; its datasets are looked at, not read."""
    found, of = {}, "stress" if block is None else f"stress/block-{block}"
    for body in sorted({*BODIES}.intersection(file.names(of) if of in file else ())):
        for plane in file.names(f"{of}/{body}"):
            group = f"{of}/{body}/{plane}"
            axes = [name for name in ("x", "y", "depth") if f"{group}/{name}" in file]
            shape = tuple(file.length(f"{group}/{name}") for name in axes)
            file.check(f"{group}/{coordinate}", (length,))
            for name in STRESS:
                file.check(f"{group}/{name}", (length, *shape))
            found[body, plane] = StoredStress(file.path, body, plane, length, block, shift)
    return found
