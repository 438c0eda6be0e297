"""Datasets of a results file: scales, rows of records, and their description."""

import math
from collections.abc import Sequence
from typing import Any

import h5py
import numpy as np

from tractive_sam.results import Quantity
from tractive_sam.scene import Plane

COMPRESSED: dict[str, Any] = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
"""Filters of fields."""

CHUNK_BYTES = 4096
"""Least size of a chunk: a page of the disk. The checksum of a chunk of zeros is zero, so the
loss of a page that contains all of a chunk with its checksum would not be noticed."""


def create_labels(group: h5py.Group, name: str, values: Sequence[str], about: str) -> None:
    """Create an HDF5 dimension scale of texts of variable length.

    Some of them do not support texts of fixed length. So these texts have a variable length, and
    this package never reads them.
    """
    dataset = group.create_dataset(name, data=values)
    dataset.make_scale(name)
    describe_dataset(dataset, Quantity(name, "1", about))


def create_scale(
    group: h5py.Group, name: str, values: np.ndarray, quantity: Quantity
) -> h5py.Dataset:
    """Create an HDF5 dimension scale that can grow."""
    chunk = max(len(values), CHUNK_BYTES // 8)
    dataset = group.create_dataset(
        name, data=values, maxshape=(None,), chunks=(chunk,), fletcher32=True
    )
    dataset.make_scale(name)
    return describe_dataset(dataset, quantity)


def create_rows(
    group: h5py.Group,
    name: str,
    quantity: Quantity,
    dimensions: tuple[h5py.Dataset, ...],
    rows: int = 0,
    coordinate: str = "",
    **filters: str | int | bool,
) -> h5py.Dataset:
    """Create a dataset of one row per record that can grow; unknown values are nan or -1 (int)."""
    shape = tuple(len(scale) for scale in dimensions[1:])
    min_rows = math.ceil(CHUNK_BYTES / (8 * math.prod(shape)))
    dataset = group.create_dataset(
        name,
        shape=(rows, *shape),
        dtype=int if quantity.whole else float,
        maxshape=(None,) * len(dimensions),
        chunks=(1 if filters else max(min_rows, rows), *shape),
        fillvalue=-1 if quantity.whole else np.nan,
        fletcher32=True,
        **filters,
    )
    for k, scale in enumerate(dimensions):
        h5py.h5ds.attach_scale(dataset.id, scale.id, k)
    return describe_dataset(dataset, quantity, coordinate if coordinate != name else "")


def describe_dataset(dataset: h5py.Dataset, quantity: Quantity, along: str = "") -> h5py.Dataset:
    """Store the unit and description of a quantity in a new dataset, and return the dataset."""
    texts = {"units": quantity.unit, "long_name": quantity.long_name}
    texts |= {"coordinates": along} if along else {}
    # h5py's low-level interface is faster: a file has hundreds of these attributes.
    kind = h5py.h5t.py_create(h5py.string_dtype(), logical=True)
    scalar = h5py.h5s.create(h5py.h5s.SCALAR)
    for name, text in texts.items():
        attribute = h5py.h5a.create(dataset.id, name.encode(), kind, scalar)
        attribute.write(np.array(text, h5py.string_dtype()))
    return dataset


def plane_path(body: str, plane: Plane | str, block: int | None = None) -> str:
    """Return the path "[block-k/]body/plane", within /stress, of a plane's group."""
    return f"{'' if block is None else f'block-{block}/'}{body}/{plane}"


def add_state(state: h5py.Group, name: str, values: np.ndarray) -> None:
    """Add an array to the group of arrays from which a run resumes."""
    chunks = tuple(max(1, n) for n in values.shape)
    about = {"chunks": chunks, "maxshape": (None,) * values.ndim, "fletcher32": True}
    describe_dataset(
        state.create_dataset(name, data=values, **about), Quantity(name, "", "to continue from")
    )
