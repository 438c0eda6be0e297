"""Reads NumPy files from other programs; sizes are checked before memory is allocated."""

import zipfile
from math import prod
from pathlib import Path
from typing import IO

import numpy as np
from numpy.lib import format as npy

from tractive_sam.input_file import open_regular


def read_array(path: Path) -> np.ndarray:
    """Return the array in an .npy file; ValueError if it contains Python objects.

    Raises
    ------
    OSError
        If the file is no regular file.
    ValueError
        If it contains Python objects or fewer numbers than its header states, or is no .npy file.
    """
    with open_regular(path) as file:
        if zipfile.is_zipfile(file):
            raise ValueError("an archive of arrays; its suffix is .npz")
        size = file.seek(0, 2)
        file.seek(0)
        return _read_checked(file, size)


def read_archive(path: Path, max_bytes: int = 2**31) -> dict[str, np.ndarray]:
    """Return the arrays in an .npz file by name; ValueError above `max_bytes` in all.

    Parameters
    ----------
    path : Path
        The file.
    max_bytes : int
        Largest total size of the arrays: a small compressed file may contain huge arrays.

    Raises
    ------
    OSError, ValueError
        See `read_array`; also if the arrays are larger than `max_bytes`.
    """
    with open_regular(path) as file, zipfile.ZipFile(file) as archive:
        members = archive.infolist()
        size = sum(member.file_size for member in members)
        if size > max_bytes:
            raise ValueError(f"{size / 2**20:.4g} MiB of arrays, at most {max_bytes / 2**20:.4g}")
        arrays = {}
        for member in members:
            with archive.open(member) as content:
                name = member.filename.removesuffix(".npy")
                arrays[name] = _read_checked(content, member.file_size)
    return arrays


def _read_checked(file: IO[bytes], size: int) -> np.ndarray:
    """Return an array from a file of `size` bytes, checked before memory is allocated."""
    version = npy.read_magic(file)
    header = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
    shape, _, dtype = header(file)
    if dtype.hasobject:
        raise ValueError("Python objects instead of numbers")
    if any(n < 0 for n in shape) or prod(shape) * dtype.itemsize > size:
        raise ValueError(f"{size} bytes claim an array of the shape {shape}")
    file.seek(0)
    return npy.read_array(file, allow_pickle=False)
