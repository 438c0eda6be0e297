"""Texts of fixed length in HDF5 files.

HDF5 stores texts of variable length in a heap that all texts of a file share. The heap has no
checksum, and HDF5 may never return from a damaged heap. So the package reads only texts of fixed
length.
"""

import h5py
import numpy as np


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
