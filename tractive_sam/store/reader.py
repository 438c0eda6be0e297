"""Reads results files, finished or not."""

from collections.abc import Iterable
from pathlib import Path

import h5py
import numpy as np

from tractive_sam.results.history import History
from tractive_sam.results.quantities import (
    ADDED,
    BODY_ERROR_BARS,
    BODY_POINTS,
    BODY_SCALARS,
    ERROR_BARS,
    FIELDS,
    POINTS,
    PROFILES,
    SCALARS,
    STATE,
)
from tractive_sam.store import layout
from tractive_sam.store.form import check_form
from tractive_sam.store.opening import results_file
from tractive_sam.store.rows import SLOTS, committed
from tractive_sam.store.stored import StoredField, StoredStress


def open_history(path: str | Path) -> History:
    """Read a results file; its fields only when they are asked for.

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
        check_form(file)
        scene, grid, history, fields = (file[k] for k in ("scene", "grid", "history", "fields"))
        n, m, about = committed(file), len(fields["record"]), dict(scene.attrs)
        bodies = tuple(history["body"].asstr()) if "body" in history else ()
        return History(
            scene_toml=scene[()].decode(),
            status=about["status"],
            message=about["message"],
            **{name: float(about[name]) for name in layout.REFERENCE},
            half_length=tuple(map(float, grid.attrs["half_length"])),
            x=grid["x"][:],
            y=grid["y"][:],
            scalars=_scalars(history, n),
            points=_rows(history, n, POINTS),
            profiles=_rows(history, n, PROFILES),
            fields={name: StoredField(path, name, m) for name in FIELDS},
            field_revolutions=fields["revolution"][:],
            bodies=bodies,
            body_scalars=_of_bodies(history, n, BODY_SCALARS, (len(bodies),))
            | _rows(history, n, BODY_ERROR_BARS, optional=True),
            body_points=_of_bodies(history, n, BODY_POINTS, (len(bodies), 3)),
            stresses=_stresses(path, file, m),
            versions={
                name.removeprefix(layout.VERSION_PREFIX): version
                for name, version in about.items()
                if name.startswith(layout.VERSION_PREFIX)
            },
        )


def state_of(path: str | Path, row: int) -> dict[str, np.ndarray]:
    """The fields after one of the last two records, by the names of `STATE`, shape (n_x, n_y).

    Parameters
    ----------
    path : path-like
        A file written by `HistoryWriter`.
    row : int
        Which record: the last, or the one before where the last was not solved.

    Raises
    ------
    ResultsError
        If there is no such file, or it cannot be read.
    """
    with results_file(Path(path)) as file:
        if not committed(file) - SLOTS <= row < committed(file):
            raise ValueError(f"/state: nothing is kept of record {row}")
        slot = row % SLOTS
        fields = {name: file["state"][name][slot] for name in STATE}
        # The gap is infinite where a mesh has grown.
        lost = [name for name in STATE if name != "gap" and not np.isfinite(fields[name]).all()]
        if lost:
            raise ValueError(f"/state: {', '.join(lost)} of record {row} are not finite")
        return fields


def _scalars(history: h5py.Group, n: int) -> dict[str, np.ndarray]:
    """The first rows of all scalars; nan of those that a former file lacks."""
    lacking = [name for name in ADDED if name not in history]
    found = _rows(history, n, (name for name in SCALARS if name not in lacking))
    found |= dict.fromkeys(lacking, np.full(n, np.nan))
    ordered = {name: found[name] for name in SCALARS}
    return ordered | _rows(history, n, ERROR_BARS, optional=True)


def _rows(
    history: h5py.Group, n: int, names: Iterable[str], optional: bool = False
) -> dict[str, np.ndarray]:
    """The first rows under these names, or under those of them that there are."""
    return {name: history[name][:n] for name in names if not optional or name in history}


def _of_bodies(
    history: h5py.Group, n: int, names: Iterable[str], shape: tuple[int, ...]
) -> dict[str, np.ndarray]:
    """Rows of what is recorded of bodies; without columns where there is nothing."""
    return {name: history[name][:n] if name in history else np.empty((n, *shape)) for name in names}


def _stresses(path: Path, file: h5py.File, length: int) -> dict[tuple[str, str], StoredStress]:
    return {
        (body, plane): StoredStress(path, body, plane, length)
        for body, group in file["stress"].items()
        for plane in group
    }
