"""The rows of a results file: added, dropped, and made wider."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby

import h5py
import numpy as np

from tractive_sam.mechanics import VON_MISES
from tractive_sam.results import (
    BEFORE,
    BOUND,
    CYCLES,
    FIELDS,
    OUTSIDE,
    STRESS,
    Grid,
    Record,
    stacked,
    widened,
)
from tractive_sam.store import layout

SCALES = ("y", "axis", "body", "block", "position")
"""What is in /history beside rows of records."""

DEPTHS = ("worn", "gained")
"""What is in /state of a transient that wears, (body, x, y)."""

AXES = ("block", "x", "y", "depth", "zeta")
"""What is in /fields, in the planes of /stress and in /fatigue beside them."""


def append(file: h5py.File, records: Sequence[Record]) -> None:
    """Add rows to all groups; narrower records are widened to the mesh of the file."""
    history, grid = file["history"], grid_of(file)
    before = len(history["record"])
    count = before + len(records)
    columns = records[0].columns
    for name in (name for name in history if name not in SCALES):
        values = np.arange(before, count) if name == "record" else None
        if name in columns:
            values = stacked(columns[name], [record.values[name] for record in records], grid)
        _extend(_opened(history, name), before, count, values)
    saved = [(row, one) for row, one in enumerate(records, start=before) if one.fields]
    for _, alike in groupby(saved, lambda one: _groups(one[1])):
        _append_fields(file, *zip(*alike, strict=True))


def grid_of(file: h5py.File) -> Grid:
    """The mesh of a file."""
    grid = file["grid"]
    half_length = tuple(map(float, grid.attrs["half_length"]))
    return Grid(half_length, (len(grid["x"]), len(grid["y"])))


def _groups(record: Record) -> list[str]:
    """Where the fields of a record go."""
    planes = [layout.place_of(one.body, one.plane, one.block) for one in record.stress]
    return [*record.fields, *planes, *(one.body for one in record.cycles)]


def _append_fields(file: h5py.File, rows: Sequence[int], records: Sequence[Record]) -> None:
    """Add what goes to the same groups of each."""
    _append(file["fields"], rows, records, [one.fields for one in records], OUTSIDE)
    for planes in zip(*(one.stress for one in records), strict=True):
        group = file["stress"][layout.place_of(planes[0].body, planes[0].plane, planes[0].block)]
        values = [one.components | {VON_MISES.name: one.by(VON_MISES)} for one in planes]
        _append(group, rows, records, values, dict.fromkeys(values[0], np.nan))  # not known there
    for cycles in zip(*(one.cycles for one in records), strict=True):
        group = file["fatigue"][cycles[0].body]
        names = [name for name in CYCLES if name in group]
        values = [{name: getattr(one, name) for name in names} for one in cycles]
        _append(group, rows, records, values, {})


def _append(
    group: h5py.Group,
    rows: Sequence[int],
    records: Sequence[Record],
    values: Sequence[Mapping[str, np.ndarray]],
    outside: Mapping[str, float],
) -> None:
    about = {"record": rows, records[0].coordinate.name: [one.at for one in records]}
    count = len(group["record"]) + len(rows)
    for name in (*about, *values[0]):
        dataset = _opened(group, name)
        before, *shape = dataset.shape
        each = about.get(name) or [
            widened(np.asarray(one[name]), tuple(shape), outside.get(name, 0.0)) for one in values
        ]
        _extend(dataset, before, before + len(rows), np.stack(each))
    for name in group:
        if name not in about and name not in values[0] and name not in AXES:
            _extend(_opened(group, name), 0, count, None)  # not known in these records


def _opened(group: h5py.Group, name: str) -> h5py.h5d.DatasetID:
    """A dataset by the lower interface of h5py: the other one takes three times as long."""
    return h5py.h5d.open(group.id, name.encode())


def _extend(dataset: h5py.h5d.DatasetID, first: int, count: int, values: np.ndarray | None) -> None:
    """Make a dataset that long, and set its rows from the first one on, unless they are unknown."""
    dataset.set_extent((count, *dataset.shape[1:]))
    if values is not None:
        there = dataset.get_space()
        there.select_hyperslab((first,) + (0,) * (values.ndim - 1), values.shape)
        here = h5py.h5s.create_simple(values.shape)
        dataset.write(here, there, np.ascontiguousarray(values))


def put_state(file: h5py.File, row: int, state: Mapping[str, np.ndarray]) -> None:
    """Keep the state after the record of a row, in place of the one before."""
    group = file["state"]
    group.attrs["record"] = row
    if BOUND.name in group and BOUND.name not in state:  # the traction is bound by the pressure
        del group[BOUND.name]
    of_mesh = (*FIELDS, BOUND.name, *BEFORE, *DEPTHS)
    for name, values in state.items():
        if name in group and name not in of_mesh and group[name].shape != values.shape:
            del group[name]  # of a mesh that has grown, say
        if name not in group:
            layout.add_state(group, name, values)
        dataset = _opened(group, name)
        whole = widened(values, dataset.shape, OUTSIDE.get(name, 0.0))
        dataset.write(h5py.h5s.ALL, h5py.h5s.ALL, np.ascontiguousarray(whole))


def drop_after_state(file: h5py.File) -> None:
    """Drop the last records from which nothing continues: unsolved ones, or those between steps."""
    history = file["history"]
    continues = history["converged"][:] > 0.0
    if "next_step" in history:  # a record between two steps has none
        continues &= np.isfinite(history["next_step"][:])
    count = len(continues) - int(np.argmax(continues[::-1])) if continues.any() else 0
    if count == len(continues):
        return
    for group in (file["fields"], *planes(file), *cycles(file)):
        kept = np.count_nonzero(group["record"][:] < count)
        for name in (name for name in group if name not in AXES):
            group[name].resize(kept, axis=0)
    for name in (name for name in history if name not in SCALES):
        history[name].resize(count, axis=0)


def widen(file: h5py.File, grid: "Grid") -> None:
    """Change to a wider mesh, of which the present one is the middle."""
    before = {"x": len(file["grid/x"]), "y": len(file["grid/y"])}
    after = {"x": len(grid.x), "y": len(grid.y)}
    if after == before:
        return
    history, fields, state = file["history"], file["fields"], file["state"]
    for name in (name for name in history if name not in SCALES):
        dims = history[name].dims
        if "y" in dims[len(dims) - 1]:
            _widen(history[name], ("y",), before, after, lead=len(dims) - 2)
    for name in (name for name in fields if fields[name].ndim > 2):
        lead = fields[name].ndim - 3
        _widen(fields[name], ("x", "y"), before, after, OUTSIDE.get(name, 0.0), lead)
    for name in (name for name in (*FIELDS, BOUND.name, *BEFORE, *DEPTHS) if name in state):
        values = state[name][:]
        state[name].resize((*values.shape[:-2], after["x"], after["y"]))
        state[name][...] = widened(values, state[name].shape, OUTSIDE.get(name, 0.0))
    for group in cycles(file):
        for name in (name for name in CYCLES if name in group):
            _widen(group[name], ("y",), before, after)  # nothing is stressed there
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
    lead: int = 0,
) -> None:
    """Widen every row, one at a time; so many axes come before those of the mesh."""
    first, kept = dataset.shape[1 : 1 + lead], dataset.shape[1 + lead + len(axes) :]
    old = (*(slice(n) for n in first), *(slice(before[axis]) for axis in axes))
    shape = (*first, *(after[axis] for axis in axes), *kept)
    dataset.resize((len(dataset), *shape))
    for row in range(len(dataset)):
        dataset[row] = widened(dataset[(row, *old)], shape, outside)


def planes(file: h5py.File) -> Iterator[h5py.Group]:
    """Groups of the stress on each plane of each body, of duty cycles in each block."""
    groups = [file["stress"]]
    while groups:
        for group in groups.pop().values():
            if "record" in group:
                yield group
            else:
                groups.append(group)


def cycles(file: h5py.File) -> Iterator[h5py.Group]:
    """Groups of what rolling does to each body."""
    if "fatigue" in file:
        yield from file["fatigue"].values()


def along(group: h5py.Group) -> tuple[str, ...]:
    """Those axes of a plane that are axes of the mesh."""
    return tuple(axis for axis in ("x", "y") if axis in group)
