"""Reads NumPy's files that others wrote: claims are checked before memory is taken for them."""

import zipfile
from math import prod
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.lib import format as npy

from tractive_sam.input_file import open_regular


def read_array(path: Path) -> np.ndarray:
    """Read the array of an .npy file.

    Raises
    ------
    OSError
        If it is no regular file.
    ValueError
        If it holds objects, or fewer numbers than it claims, or is no such file.
    """
    with open_regular(path) as file:
        if zipfile.is_zipfile(file):
            raise ValueError("an archive of arrays; its suffix is .npz")
        size = file.seek(0, 2)
        file.seek(0)
        return _read(file, size)


def read_archive(path: Path, most: int = 2**31) -> dict[str, np.ndarray]:
    """Read the arrays of an .npz file, by their names.

    Parameters
    ----------
    path : Path
        The file.
    most : int
        Bytes that its arrays may have together: compressed, a small file may hold any number.

    Raises
    ------
    OSError, ValueError
        As by `read_array`; also if there are more bytes than that.
    """
    with open_regular(path) as file, zipfile.ZipFile(file) as archive:
        members = archive.infolist()
        size = sum(one.file_size for one in members)
        if size > most:
            raise ValueError(f"{size / 2**20:.4g} MiB of arrays, at most {most / 2**20:.4g}")
        arrays = {}
        for one in members:
            with archive.open(one) as content:
                arrays[one.filename.removesuffix(".npy")] = _read(content, one.file_size)
    return arrays


def _read(file: BinaryIO, size: int) -> np.ndarray:
    """Read an array of which there are so many bytes, its header included."""
    version = npy.read_magic(file)
    header = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
    shape, _, dtype = header(file)
    if dtype.hasobject:
        raise ValueError("objects, and no numbers")
    if any(n < 0 for n in shape) or prod(shape) * dtype.itemsize > size:
        raise ValueError(f"an array of the shape {shape} is claimed by {size} bytes")
    file.seek(0)
    return npy.read_array(file, allow_pickle=False)
