"""Texts in HDF5 files, each of a fixed length.

Those of any length lie in heaps that all texts of a file share and that have no checksum: damage to
one can keep HDF5 busy for ever. So nothing that is read here is one of them.
"""

import h5py
import numpy as np


def set_text(node: h5py.Group | h5py.Dataset, name: str, text: str) -> None:
    """Set an attribute."""
    encoded = text.encode()
    node.attrs.create(name, encoded, dtype=_kind(encoded))


def text_of(value: str | bytes) -> str:
    """A text as it was read, of either kind.

    Raises
    ------
    ValueError
        If it is none in UTF-8.
    """
    if not isinstance(value, str | bytes):
        raise ValueError(f"{value!r} is no text")
    return value.decode() if isinstance(value, bytes) else value.encode().decode()


def create_text(group: h5py.Group, name: str, text: str) -> h5py.Dataset:
    """Create a dataset that is one text."""
    encoded = text.encode()
    return group.create_dataset(name, data=np.array(encoded, _kind(encoded)))


def _kind(encoded: bytes) -> np.dtype:
    """Of a length with room for a zero: netCDF-C 4.9.0 reads on until it finds one."""
    return h5py.string_dtype("utf-8", len(encoded) + 1)
