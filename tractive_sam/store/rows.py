"""The rows of a results file: laid out, filled, and made wider."""

from collections.abc import Iterator, Mapping

import h5py
import numpy as np

from tractive_sam.results.grid import Grid
from tractive_sam.results.history import padded
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
from tractive_sam.results.record import Record

SLOTS = 2
"""States kept: that of the last record, and the one that is being written."""


def committed(file: h5py.File) -> int:
    """Number of complete records."""
    return int(file["history/committed"][()])


def full(file: h5py.File) -> bool:
    """Whether every row laid out is taken."""
    return committed(file) == len(file["history/record"])


def lay_out(file: h5py.File, count: int) -> None:
    """Change the number of rows in /history; on disk at once, so that filling moves nothing."""
    history = file["history"]
    of_records = (*SCALARS, *ERROR_BARS, *POINTS, *PROFILES)
    names = (*of_records, *BODY_SCALARS, *BODY_ERROR_BARS, *BODY_POINTS)
    for name in (name for name in names if name in history):
        before = len(history[name])
        history[name].resize(count, axis=0)
        history[name][before:] = history[name].fillvalue
    history["record"].resize(count, axis=0)
    history["record"][:] = np.arange(count)


def fill(file: h5py.File, record: Record, state: Mapping[str, np.ndarray] | None = None) -> None:
    """Fill the first free row of /history, in place."""
    row, history = committed(file), file["history"]
    for values in (record.scalars, record.points, record.profiles):
        for name, value in values.items():
            history[name][row] = value
    for column, body in enumerate(record.bodies.values()):
        for name, value in body.items():
            history[name][row, column] = value
    for name, value in (state or {}).items():
        file["state"][name][row % SLOTS] = value
    # The number of complete records must not reach the disk before they do.
    file.flush()
    history["committed"][()] = row + 1
    file.flush()


def append_fields(file: h5py.File, record: Record) -> None:
    """Add a row to /fields and /stress, for the record that will next be filled in."""
    _append(file["fields"], file, record, record.fields)
    for plane in record.stress:
        group = file["stress"][plane.body][str(plane.plane)]
        _append(group, file, record, plane.components | {"von_mises": plane.von_mises})


def _append(
    group: h5py.Group, file: h5py.File, record: Record, values: Mapping[str, np.ndarray]
) -> None:
    about = {"record": committed(file), "revolution": record.revolution}
    for name, value in (about | dict(values)).items():
        group[name].resize(len(group[name]) + 1, axis=0)
        group[name][-1] = value


def drop_unsolved(file: h5py.File) -> None:
    """Drop a last record whose contact was not solved; the state before it is still there."""
    last = committed(file) - 1
    if last < 0 or file["history/converged"][last]:
        return
    for group in (file["fields"], *planes(file)):
        kept = np.count_nonzero(group["record"][:] < last)
        for name in ("record", "revolution", *(FIELDS if group.name == "/fields" else STRESS)):
            group[name].resize(kept, axis=0)
    file["history/committed"][()] = last


def differs(file: h5py.File, grid: "Grid") -> bool:
    """Whether a mesh is not that of the file."""
    return (len(file["grid/x"]), len(file["grid/y"])) != (len(grid.x), len(grid.y))


def widen(file: h5py.File, grid: "Grid") -> None:
    """Change to a wider mesh, of which the present one is the middle."""
    before = {"x": len(file["grid/x"]), "y": len(file["grid/y"])}
    after = {"x": len(grid.x), "y": len(grid.y)}
    history, fields = file["history"], file["fields"]
    for name in PROFILES:
        _widen(history[name], ("y",), before, after)
    for name in FIELDS:
        _widen(fields[name], ("x", "y"), before, after)
    for name in STATE:
        # Nothing touches there; only the state of the next record tells how wide the gap is.
        outside = np.inf if name == "gap" else 0.0
        _widen(file["state"][name], ("x", "y"), before, after, outside)
    for group in planes(file):
        for name in STRESS:
            # Unlike wear and pressure, stress is not zero beside the former mesh.
            _widen(group[name], along(group), before, after, np.nan)
    for name, centres in (("x", grid.x), ("y", grid.y)):
        file["grid"][name].resize(centres.shape)
        file["grid"][name][:] = centres
    file["grid"].attrs["half_length"] = grid.half_length


def _widen(
    dataset: h5py.Dataset,
    axes: tuple[str, ...],
    before: Mapping[str, int],
    after: Mapping[str, int],
    outside: float = 0.0,
) -> None:
    """Widen every row, one at a time."""
    kept = dataset.shape[1 + len(axes) :]
    old = tuple(slice(before[axis]) for axis in axes)
    shape = (*(after[axis] for axis in axes), *kept)
    dataset.resize((len(dataset), *shape))
    for row in range(len(dataset)):
        dataset[row] = padded(dataset[(row, *old)], shape, outside)


def planes(file: h5py.File) -> Iterator[h5py.Group]:
    """Groups of the stress on each plane of each body."""
    for body in file["stress"].values():
        yield from body.values()


def along(group: h5py.Group) -> tuple[str, ...]:
    """Those axes of a plane that are axes of the mesh."""
    return tuple(axis for axis in ("x", "y") if axis in group)
