from dataclasses import replace

import h5py
import numpy as np

from tractive_sam.kernels.stress import COMPONENTS
from tractive_sam.results.column_table import columns
from tractive_sam.results.grid import Grid
from tractive_sam.results.quantity import fields_table
from tractive_sam.results.record import Record
from tractive_sam.results.state import FIELDS
from tractive_sam.results.stress import PlaneStress
from tractive_sam.scene import Plane, Scene

STRESSED = Scene.builtin("twin-discs")
SCENE = STRESSED.replace(subsurface=None)


def mesh(n_x=5, n_y=9):
    return Grid((0.05 * n_x, 0.1 * n_y), (n_x, n_y))


def make_stress(number, grid):
    """Stress of both bodies on a vertical plane and on one at constant depth."""
    depth = np.array([0.0, 0.1, 0.3])
    planes = {"y=0": {"x": grid.x, "depth": depth}, "z=0.5a": {"x": grid.x, "y": grid.y}}
    return tuple(
        PlaneStress(
            body,
            Plane.parse(plane),
            0.14,
            axes,
            {
                name: np.full([len(axis) for axis in axes.values()], number + 0.1 * k)
                for k, name in enumerate(COMPONENTS)
            },
        )
        for body in "AB"
        for plane, axes in planes.items()
    )


def with_stress(record, grid=None):
    """Return the record for a scene with [subsurface]."""
    number = record.revolution / 10
    added = {}
    for name, one in columns(STRESSED).items():
        if one.dims[:1] == ("body",):
            added[name] = {
                body: number + k if one.dims == ("body",) else (number, k, 0.1)
                for k, body in enumerate("AB")
            }
    stress = make_stress(number, grid or mesh()) if record.tables else ()
    tables = {**record.tables, **{plane.path: plane.table for plane in stress}}
    return replace(record, values=record.values | added, columns=columns(STRESSED), tables=tables)


def make_values(number, revolution, names, n_y):
    """Numbers that report which record they are of, one for every column."""
    kinds = {(): lambda k: number + 0.01 * k, ("axis",): lambda k: (0.1 * number, -0.1 * number)}
    kinds[("body",)] = lambda k: {"A": number, "B": number + 1.0}
    values = {
        name: kinds.get(one.dims, lambda k: np.full(n_y, 1e-6 * number))(k)
        for k, (name, one) in enumerate(names.items())
    }
    return values | {"revolution": revolution, "solves": 2, "seconds": 0.5, "converged": 1.0}


def make_record(number, with_fields=False, grid=None):
    """Return a record in which every value equals its number."""
    grid, names = grid or mesh(), columns(SCENE)
    values = make_values(number, 10 * number, names, len(grid.y))
    fields = {name: np.full(grid.elements, number + 0.1 * k) for k, name in enumerate(FIELDS)}
    tables = {"fields": fields_table(fields, FIELDS, grid)}
    return Record(values, names, tables if with_fields else {})


def records(count, every=3):
    return [make_record(number, number % every == 0) for number in range(count)]


def assert_described(path):
    """Check that all datasets of a results file have a unit, a description and dimensions."""

    def check(name, item):
        if isinstance(item, h5py.Dataset):
            assert item.attrs["units"], name
            assert item.attrs["long_name"], name
            assert all(dim.keys() for dim in item.dims) or item.is_scale, name

    with h5py.File(path) as file:
        file.visititems(check)
