"""Datasets of a results file: texts, scales, rows of records; and the versions of packages.

HDF5 stores texts of variable length in a heap that all texts of a file share. The heap has no
checksum, and HDF5 may never return from a damaged heap. So the package reads only texts of fixed
length.
"""

import math
import platform
from collections.abc import Sequence
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import h5py
import numpy as np

from tractive_sam.results import Quantity
from tractive_sam.scene import Plane


def set_text(node: h5py.Group | h5py.Dataset, name: str, text: str) -> None:
    """Set an HDF5 attribute to a text of fixed length."""
    encoded = text.encode()
    node.attrs.create(name, encoded, dtype=_text_type(encoded))


def decode_text(value: str | bytes) -> str:
    """Return an HDF5 text as str; ValueError unless it is text in UTF-8.

    Raises
    ------
    ValueError
        If it is not a text in UTF-8.
    """
    if not isinstance(value, str | bytes):
        raise ValueError(f"{value!r} is not a text")
    return value.decode() if isinstance(value, bytes) else value.encode().decode()


def create_text(group: h5py.Group, name: str, text: str) -> h5py.Dataset:
    """Create an HDF5 dataset with one text."""
    encoded = text.encode()
    return group.create_dataset(name, data=np.array(encoded, _text_type(encoded)))


def _text_type(encoded: bytes) -> np.dtype:
    """Return the HDF5 type of an encoded text with a final zero byte."""
    return h5py.string_dtype("utf-8", len(encoded) + 1)


FORMAT = "tractive-sam history"
FORMAT_VERSION = 2
"""Increased when readers of the version before would misread the file. Version 1 is still read, see
`legacy_format`. A new column needs no new version: a missing column reads as nan."""


def versions() -> dict[str, str]:
    """Return the versions of Python, this package and the five it computes with, by name."""
    packages = ("tractive-sam", "numpy", "scipy", "numba", "pyfftw", "h5py")
    return {"python": platform.python_version()} | {name: _version(name) for name in packages}


@cache  # reading the description of a package takes milliseconds
def _version(package: str) -> str:
    """Return the version of an installed package, or a note that it is missing."""
    try:
        return version(package)
    except PackageNotFoundError:  # run from a source tree
        return "not installed"


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
