"""Appends, widens, drops and reads the tables of a results file: groups with a row for each record.

In such a group the scales of dimensions have no rows, and all other datasets have one for each
record. Nothing here depends on what a table contains.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

from tractive_sam.results import (
    BEFORE,
    BOUND,
    FIELDS,
    MESH_AXES,
    TABLE_QUANTITIES,
    Grid,
    Quantity,
    Record,
    Table,
    Variable,
    stack_values,
    widen_field,
)
from tractive_sam.store import layout
from tractive_sam.store.opening import ResultsFile, open_results

ON_MESH = (*FIELDS, BOUND.name, *BEFORE, "worn", "gained")
"""Arrays of /state whose last dimensions are the mesh; depths of a transient are (body, x, y)."""


def append(file: h5py.File, records: Sequence[Record]) -> None:
    """Append a row for each record to the history and to the tables that the record has."""
    history, grid = file["history"], read_grid(file)
    before = len(history["record"])
    columns = {
        name: stack_values(column, [record.values[name] for record in records], grid)
        for name, column in records[0].columns.items()
    }
    _append_rows(history, {"record": np.arange(before, before + len(records)), **columns})
    for path in dict.fromkeys(path for record in records for path in record.tables):
        rows = [row for row, record in enumerate(records) if path in record.tables]
        places = np.array([records[row].at for row in rows])
        tables = [records[row].tables[path] for row in rows]
        names = dict.fromkeys(name for table in tables for name in table.variables)
        arrays: dict[str, np.ndarray] = {}
        for name in names:  # on a mesh that may be wider; nan in tables that lack the variable
            shape = file[path][name].shape[1:]
            arrays[name] = np.stack(
                [
                    widen_field(np.asarray(v.data), shape, v.quantity.outside)
                    if (v := table.variables.get(name)) is not None
                    else np.full(shape, np.nan)
                    for table in tables
                ]
            )
        about = {"record": np.add(rows, before), records[0].coordinate.name: places}
        _append_rows(file[path], about | arrays)


def _append_rows(group: h5py.Group, values: Mapping[str, np.ndarray]) -> None:
    """Append rows to all datasets of a table; those without values get the fill value."""
    before, new = len(group["record"]), len(values["record"])
    for name in _row_names(group):
        _extend(_open_dataset(group, name), before, before + new, values.get(name))


def _row_names(group: h5py.Group) -> list[str]:
    """Return the names of the datasets of a table that have a row for each record."""
    scale = h5py.h5ds.is_scale
    return [name for name in group if name == "record" or not scale(_open_dataset(group, name))]


def read_grid(file: h5py.File) -> Grid:
    """Return the mesh of a file."""
    grid = file["grid"]
    half_x, half_y = map(float, grid.attrs["half_length"])
    centre_x, centre_y = map(float, grid.attrs.get("centre", (0.0, 0.0)))
    elements = len(grid["x"]), len(grid["y"])
    return Grid((half_x, half_y), elements, centre=(centre_x, centre_y))


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
    for name, values in state.items():
        if name in group and name not in ON_MESH and group[name].shape != values.shape:
            del group[name]  # for example because the mesh has grown
        if name not in group:
            layout.add_state(group, name, values)
        dataset = _open_dataset(group, name)
        padded = widen_field(values, dataset.shape, _outside("fields", name))
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
    for group in _table_groups(file):
        remaining = np.count_nonzero(group["record"][:] < count)
        for name in _row_names(group):
            group[name].resize(remaining, axis=0)


def _table_groups(group: h5py.Group) -> Iterator[h5py.Group]:
    """Yield the tables in a group of a file."""
    for member in group.values():
        if isinstance(member, h5py.Group):
            if "record" in member:
                yield member
            else:
                yield from _table_groups(member)


def widen(file: h5py.File, grid: Grid) -> None:
    """Widen a file's mesh around its centre; new elements hold `Quantity.outside`."""
    after = {"x": len(grid.x), "y": len(grid.y)}
    if after == {"x": len(file["grid/x"]), "y": len(file["grid/y"])}:
        return
    for group in _table_groups(file):
        for name in _row_names(group):
            dims = [dim.keys()[0] for dim in [*group[name].dims][1:]]
            if not after.keys().isdisjoint(dims):
                _widen_rows(group[name], dims, after, _outside(group.name.strip("/"), name))
    state = file["state"]
    for name in [name for name in ON_MESH if name in state]:
        values = state[name][:]
        state[name].resize((*values.shape[:-2], after["x"], after["y"]))
        state[name][...] = widen_field(values, state[name].shape, _outside("fields", name))
    for name, centres in (("x", grid.x), ("y", grid.y)):
        file["grid"][name].resize(centres.shape)
        file["grid"][name][:] = centres
    file["grid"].attrs["half_length"] = grid.half_length


def _outside(path: str, name: str) -> float:
    """Return the value outside the mesh of a variable of a table; 0 if it is user-defined."""
    quantity = TABLE_QUANTITIES.get(path.partition("/")[0], {}).get(name)
    return 0.0 if quantity is None else quantity.outside


def _widen_rows(
    dataset: h5py.Dataset, dims: Sequence[str], after: Mapping[str, int], outside: float
) -> None:
    """Widen every row of a dataset to a larger mesh, with `outside` around the former one."""
    before = dataset.shape[1:]
    shape = tuple(after.get(dim, n) for dim, n in zip(dims, before, strict=True))
    dataset.resize((len(dataset), *shape))
    former = tuple(map(slice, before))
    for row in range(len(dataset)):
        dataset[row] = widen_field(dataset[(row, *former)], shape, outside)


@dataclass(frozen=True)
class StoredRows:
    """Tables of one path in a results file, one a record, read when accessed.

    Attributes
    ----------
    file : Path
        The results file.
    path : str
        Path of the group.
    variables : mapping of str to Variable
        Its variables, without data.
    length : int
        Number of records.
    shift : float
        Lateral position of the running band of a block, mm; y counts from there.
    """

    file: Path
    path: str
    variables: Mapping[str, Variable]
    length: int
    shift: float = 0.0

    @classmethod
    def check(
        cls,
        file: ResultsFile,
        path: str,
        quantities: Mapping[str, Quantity],
        length: int,
        shift: float = 0.0,
    ) -> "StoredRows":
        """Return the table of a path; raise a DamagedError for datasets of other shapes.

        Parameters
        ----------
        file : ResultsFile
            The open file.
        path : str
            Path of the group.
        quantities : mapping of str to Quantity
            Its variables.
        length : int
            Number of records.
        shift : float
            See `shift`.

        Raises
        ------
        DamagedError
            With the dataset.
        """
        axes = tuple(
            name for name in ("block", "x", "y", "along", "depth") if f"{path}/{name}" in file
        )
        shared = MESH_AXES if path == "fields" else ()  # fields have the mesh of the history
        variables = {}
        for name, quantity in quantities.items():
            dims = quantity.dims or axes
            scales = (f"{'grid' if dim in shared else path}/{dim}" for dim in dims)
            file.check(f"{path}/{name}", (length, *map(file.length, scales)))
            variables[name] = Variable(quantity, dims, None)
        return cls(file.path, path, variables, length, shift)

    def __len__(self) -> int:
        return self.length

    @property
    def quantities(self) -> dict[str, Quantity]:
        """Descriptions of the variables, by name."""
        return {name: variable.quantity for name, variable in self.variables.items()}

    def read(self, name: str, row: int) -> np.ndarray:
        """Return one variable of a record."""
        with open_results(self.file) as file:
            return file.row(f"{self.path}/{name}", row)

    def __getitem__(self, row: int) -> Table:
        """Return all variables of a record, on its mesh if they are unknown outside of it."""
        row = range(self.length)[row]
        with open_results(self.file) as file:
            arrays = {name: file.row(f"{self.path}/{name}", row) for name in self.variables}
            axes = {
                name: file.all_numbers(f"{self.path}/{name}")
                for name in ("x", "y", "along", "depth", "zeta", "moment")
                if f"{self.path}/{name}" in file
            }
            about = {
                name: float(file.attribute(self.path, name))
                for name in file.attributes(self.path)
                if name == "position"
            }
        if all(math.isnan(quantity.outside) for quantity in self.quantities.values()):
            finite = np.isfinite(next(iter(arrays.values())))
            inside = [np.flatnonzero(finite.any(axis=axis)) for axis in (1, 0)]
            axes = {name: axes[name][points] for name, points in zip(axes, inside, strict=True)}
            arrays = {name: values[np.ix_(*inside)] for name, values in arrays.items()}
        if self.shift and "y" in axes:
            axes["y"] = axes["y"] - self.shift
        return Table(
            {name: v._replace(data=arrays[name]) for name, v in self.variables.items()},
            {
                name: Variable(
                    Quantity(name, "1" if name == "moment" else "mm", f"position in {name}"),
                    (name,),
                    places,
                )
                for name, places in axes.items()
            },
            about,
        )
