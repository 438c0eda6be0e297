"""Adds, drops, widens and reads the rows of a results file."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from tractive_sam.mechanics import VON_MISES
from tractive_sam.results import (
    BEFORE,
    BOUND,
    COMPONENTS,
    FATIGUE_FIELDS,
    FIELDS,
    OUTSIDE,
    PROFILES,
    STRESS,
    BodyFatigue,
    Grid,
    PlaneStress,
    Record,
    stack_values,
    widen_field,
)
from tractive_sam.scene import Plane
from tractive_sam.store import layout
from tractive_sam.store.layout import plane_path
from tractive_sam.store.opening import open_results

SCALES = ("y", "axis", "body", "block", "position", *PROFILES)
"""Members of /history that have no row for each record."""

DEPTHS = ("worn", "gained")
"""Members of /state of a transient with wear, (body, x, y)."""

AXES = ("block", "x", "y", "depth", "zeta")
"""Members of /fields, /stress and /fatigue that have no row for each record."""


def append(file: h5py.File, records: Sequence[Record]) -> None:
    """Append a history row for each record, and rows to other groups for records with fields."""
    history, grid = file["history"], read_grid(file)
    before = len(history["record"])
    count = before + len(records)
    columns = records[0].columns
    for name in (name for name in history if name not in SCALES):
        values = np.arange(before, count) if name == "record" else None
        if name in columns:
            values = stack_values(columns[name], [record.values[name] for record in records], grid)
        _extend(_open_dataset(history, name), before, count, values)
    with_fields = [
        (row, record) for row, record in enumerate(records, start=before) if record.fields
    ]
    for _, similar in groupby(with_fields, lambda record: _field_groups(record[1])):
        _append_fields(file, *zip(*similar, strict=True))


def read_grid(file: h5py.File) -> Grid:
    """Return the mesh of a file."""
    grid = file["grid"]
    half_x, half_y = map(float, grid.attrs["half_length"])
    centre_x, centre_y = map(float, grid.attrs.get("centre", (0.0, 0.0)))
    elements = len(grid["x"]), len(grid["y"])
    return Grid((half_x, half_y), elements, centre=(centre_x, centre_y))


def _field_groups(record: Record) -> list[str]:
    """Return names that identify which fields, stresses and fatigue a record has."""
    planes = [layout.plane_path(plane.body, plane.plane, plane.block) for plane in record.stress]
    return [*record.fields, *planes, *(plane.body for plane in record.cycles)]


def _append_fields(file: h5py.File, rows: Sequence[int], records: Sequence[Record]) -> None:
    """Append fields, stress and fatigue of records with equal groups."""
    _append_group(file["fields"], rows, records, [record.fields for record in records], OUTSIDE)
    for planes in zip(*(record.stress for record in records), strict=True):
        group = file["stress"][layout.plane_path(planes[0].body, planes[0].plane, planes[0].block)]
        values = [plane.components | {VON_MISES.name: plane.by(VON_MISES)} for plane in planes]
        unknown = dict.fromkeys(values[0], np.nan)  # outside a narrower mesh
        _append_group(group, rows, records, values, unknown)
    for cycles in zip(*(record.cycles for record in records), strict=True):
        group = file["fatigue"][cycles[0].body]
        names = [name for name in FATIGUE_FIELDS if name in group]
        values = [{name: getattr(fatigue, name) for name in names} for fatigue in cycles]
        _append_group(group, rows, records, values, {})


def _append_group(
    group: h5py.Group,
    rows: Sequence[int],
    records: Sequence[Record],
    values: Sequence[Mapping[str, np.ndarray]],
    outside: Mapping[str, float],
) -> None:
    """Append one row for each record to every dataset of a group, the fill value where unknown."""
    about = {"record": rows, records[0].coordinate.name: [record.at for record in records]}
    count = len(group["record"]) + len(rows)
    for name in (*about, *values[0]):
        dataset = _open_dataset(group, name)
        before, *shape = dataset.shape
        described: Sequence[Any] = about.get(name, ())
        columns = described or [
            widen_field(np.asarray(fields[name]), tuple(shape), outside.get(name, 0.0))
            for fields in values
        ]
        _extend(dataset, before, before + len(rows), np.stack(columns))
    for name in group:
        if name not in about and name not in values[0] and name not in AXES:
            _extend(_open_dataset(group, name), 0, count, None)  # unknown in these records


def _open_dataset(group: h5py.Group, name: str) -> h5py.h5d.DatasetID:
    """Return a dataset in h5py's low-level interface, which is faster."""
    return h5py.h5d.open(group.id, name.encode())


def _extend(dataset: h5py.h5d.DatasetID, first: int, count: int, values: np.ndarray | None) -> None:
    """Extend a dataset to `count` rows, and write values from row `first` on, if given."""
    dataset.set_extent((count, *dataset.shape[1:]))
    if values is not None:
        target = dataset.get_space()
        target.select_hyperslab((first,) + (0,) * (values.ndim - 1), values.shape)
        source = h5py.h5s.create_simple(values.shape)
        dataset.write(source, target, np.ascontiguousarray(values))


def put_state(file: h5py.File, row: int, state: Mapping[str, np.ndarray]) -> None:
    """Replace the arrays in a file from which a run resumes, and the row that they follow."""
    group = file["state"]
    group.attrs["record"] = row
    # Some processes need no fields to continue, and the bound may follow from the pressure.
    for name in (*FIELDS, BOUND.name):
        if name in group and name not in state:
            del group[name]
    of_mesh = (*FIELDS, BOUND.name, *BEFORE, *DEPTHS)
    for name, values in state.items():
        if name in group and name not in of_mesh and group[name].shape != values.shape:
            del group[name]  # for example because the mesh has grown
        if name not in group:
            layout.add_state(group, name, values)
        dataset = _open_dataset(group, name)
        padded = widen_field(values, dataset.shape, OUTSIDE.get(name, 0.0))
        dataset.write(h5py.h5s.ALL, h5py.h5s.ALL, np.ascontiguousarray(padded))


def drop_after_state(file: h5py.File) -> None:
    """Remove all records after the last one from which a run can resume."""
    history = file["history"]
    continues = history["converged"][:] > 0.0
    if "next_step" in history:  # a record between two steps has none
        continues &= np.isfinite(history["next_step"][:])
    if (last := int(file["state"].attrs.get("record", -1))) >= 0:
        continues[last + 1 :] = False
    count = len(continues) - int(np.argmax(continues[::-1])) if continues.any() else 0
    if count == len(continues):
        return
    for group in (file["fields"], *plane_groups(file), *fatigue_groups(file)):
        remaining = np.count_nonzero(group["record"][:] < count)
        for name in (name for name in group if name not in AXES):
            group[name].resize(remaining, axis=0)
    for name in (name for name in history if name not in SCALES):
        history[name].resize(count, axis=0)


def widen(file: h5py.File, grid: "Grid") -> None:
    """Widen a file's mesh around its centre; new elements hold 0 or defaults, stress nan."""
    before = {"x": len(file["grid/x"]), "y": len(file["grid/y"])}
    after = {"x": len(grid.x), "y": len(grid.y)}
    if after == before:
        return
    history, fields, state = file["history"], file["fields"], file["state"]
    for name in (name for name in history if name not in SCALES):
        dims = history[name].dims
        if "y" in dims[len(dims) - 1]:
            _widen_rows(history[name], ("y",), before, after, lead=len(dims) - 2)
    for name in (name for name in fields if fields[name].ndim > 2):
        lead = fields[name].ndim - 3
        _widen_rows(fields[name], ("x", "y"), before, after, OUTSIDE.get(name, 0.0), lead)
    for name in (name for name in (*FIELDS, BOUND.name, *BEFORE, *DEPTHS) if name in state):
        values = state[name][:]
        state[name].resize((*values.shape[:-2], after["x"], after["y"]))
        state[name][...] = widen_field(values, state[name].shape, OUTSIDE.get(name, 0.0))
    for group in fatigue_groups(file):
        for name in (name for name in FATIGUE_FIELDS if name in group):
            _widen_rows(group[name], ("y",), before, after)  # the new margin is unstressed
    for group in plane_groups(file):
        for name in STRESS:
            # Unlike wear and pressure, stress is not zero outside the former mesh.
            _widen_rows(group[name], mesh_axes(group), before, after, np.nan)
    for name, centres in (("x", grid.x), ("y", grid.y)):
        file["grid"][name].resize(centres.shape)
        file["grid"][name][:] = centres
    file["grid"].attrs["half_length"] = grid.half_length


def _widen_rows(
    dataset: h5py.Dataset,
    axes: tuple[str, ...],
    before: Mapping[str, int],
    after: Mapping[str, int],
    outside: float = 0.0,
    lead: int = 0,
) -> None:
    """Widen every row of a dataset to a larger mesh, with `outside` around the former one."""
    outer, inner = dataset.shape[1 : 1 + lead], dataset.shape[1 + lead + len(axes) :]
    old = (*(slice(n) for n in outer), *(slice(before[axis]) for axis in axes))
    shape = (*outer, *(after[axis] for axis in axes), *inner)
    dataset.resize((len(dataset), *shape))
    for row in range(len(dataset)):
        dataset[row] = widen_field(dataset[(row, *old)], shape, outside)


def plane_groups(file: h5py.File) -> Iterator[h5py.Group]:
    """Yield the HDF5 groups of stress on each plane of each body (and block)."""
    groups = [file["stress"]]
    while groups:
        for group in groups.pop().values():
            if "record" in group:
                yield group
            else:
                groups.append(group)


def fatigue_groups(file: h5py.File) -> Iterator[h5py.Group]:
    """Yield the HDF5 groups of the fatigue of each body."""
    if "fatigue" in file:
        yield from file["fatigue"].values()


def mesh_axes(group: h5py.Group) -> tuple[str, ...]:
    """Return those axes of a plane's group that are axes of the mesh."""
    return tuple(axis for axis in ("x", "y") if axis in group)


@dataclass(frozen=True)
class StoredField:
    """Sequence of the arrays of a field, one a record, read from the file when accessed.

    Attributes
    ----------
    path : Path
        The results file.
    name : str
        A name of `FIELDS`.
    length : int
        Number of records with fields.
    """

    path: Path
    name: str
    length: int

    def __len__(self) -> int:
        return self.length

    def __getitem__(self, row: int) -> np.ndarray:
        """Return the field of a record, shape (n_x, n_y)."""
        with open_results(self.path) as file:
            return file.row(f"fields/{self.name}", range(self.length)[row])


@dataclass(frozen=True)
class StoredStress:
    """Sequence of `PlaneStress` on one plane, one a record, read from the file when accessed.

    Attributes
    ----------
    path : Path
        The results file.
    body, plane : str
        "A" or "B", and the plane as the scene names it.
    length : int
        Number of records with stress.
    block : int, optional
        Number of the block of a duty cycle.
    shift : float
        Lateral position of the running band of the block, mm; y counts from there.
    """

    path: Path
    body: str
    plane: str
    length: int
    block: int | None = None
    shift: float = 0.0

    def __len__(self) -> int:
        return self.length

    def __getitem__(self, row: int) -> "PlaneStress":
        """Return the stress of a record, on the mesh that it was computed on."""
        with open_results(self.path) as file:
            group = f"stress/{plane_path(self.body, self.plane, self.block)}"
            names = [name for name in ("x", "y", "depth") if f"{group}/{name}" in file]
            lengths = {name: file.length(f"{group}/{name}") for name in names}
            axes = {name: file.numbers(f"{group}/{name}", (n,)) for name, n in lengths.items()}
            row = range(self.length)[row]
            components = {name: file.row(f"{group}/{name}", row) for name in COMPONENTS}
            position = float(file.attribute(group, "position"))
        # The mesh may have grown since; the stress outside the former mesh is nan.
        finite = np.isfinite(components[COMPONENTS[0]])
        inside = [np.flatnonzero(finite.any(axis=axis)) for axis in (1, 0)]
        axes = {name: axes[name][points] for name, points in zip(axes, inside, strict=True)}
        if "y" in axes:
            axes["y"] = axes["y"] - self.shift
        components = {name: values[np.ix_(*inside)] for name, values in components.items()}
        plane = Plane.parse(self.plane)
        return PlaneStress(self.body, plane, position, axes, components, self.block)


@dataclass(frozen=True)
class StoredCycles:
    """Sequence of a body's `BodyFatigue`, one a record, read from the file when accessed.

    Attributes
    ----------
    path : Path
        The results file.
    body : str
        "A" or "B".
    shear_yield : float
        Shear yield stress, MPa; see `BodyFatigue`.
    length : int
        Number of records.
    """

    path: Path
    body: str
    shear_yield: float
    length: int

    def __len__(self) -> int:
        return self.length

    def __getitem__(self, row: int) -> BodyFatigue:
        """Return the fatigue of a record, without the criterion: only the scene names it."""
        row, empty = range(self.length)[row], np.zeros(0)
        with open_results(self.path) as file:
            group = f"fatigue/{self.body}"
            values = {
                name: file.row(f"{group}/{name}", row) if f"{group}/{name}" in file else empty
                for name in FATIGUE_FIELDS
            }
            axes = {
                name: file.all_numbers(f"{group}/{name}") if f"{group}/{name}" in file else empty
                for name in ("y", "depth", "zeta")
            }
        return BodyFatigue(
            self.body, **axes, **values, criterion=None, shear_yield=self.shear_yield
        )
