"""Reads HDF5 files that others wrote: nothing outside the file, and no more than it can hold.

An HDF5 file may name other files, which HDF5 opens by itself: by external links, by virtual
datasets, and by datasets whose numbers lie in a file of raw bytes. Whoever reads such a file would
have any file of this machine read as numbers. All of them are refused, soft links as well.

Heaps of texts are looked at before HDF5 does. A heap is a row of objects, each with its size; where
one of size zero stands, HDF5 goes round for ever. Source: HDF5 file format specification, III.E,
"Disk Format: Level 1E - Global Heap".
"""

import mmap
from pathlib import Path
from struct import unpack_from

import h5py

SUPERBLOCK_OF_FORMER = 2
"""Version of the first block of an HDF5 file, up to which texts in heaps are read here."""

_HEAD, _OBJECT, _SIGNATURE = 16, 16, b"GCOL"


def member(group: h5py.Group, name: str) -> h5py.Group | h5py.Dataset:
    """Return what lies under a name in the file itself.

    Raises
    ------
    KeyError
        If there is nothing.
    ValueError
        If a link stands there, or a dataset whose numbers lie in another file.
    """
    item = group
    for part in filter(None, name.split("/")):
        link = item.get(part, getlink=True)
        if link is None:
            raise KeyError(f"there is no {name}")
        if not isinstance(link, h5py.HardLink):
            raise ValueError(f"{part} is a link; only data in the file itself are read")
        item = item[part]
    if isinstance(item, h5py.Dataset) and (item.is_virtual or item.external):
        raise ValueError(f"{name} lies in other files; only data in the file itself are read")
    return item


def check_claim(group: h5py.Group, claimed: int, ratio: int = 1032, least: int = 2**26) -> None:
    """See that a file can hold as much as it claims, before memory is taken for it.

    Parameters
    ----------
    group : h5py.Group
        Any of the file.
    claimed : int
        Bytes in memory.
    ratio : int
        Most bytes in memory for a byte in the file: that of deflate.
    least : int
        Bytes that any file may claim: what is not written is filled, and takes no room in a file.

    Raises
    ------
    ValueError
        If the file is too small for them.
    """
    size = group.file.id.get_filesize()
    if claimed > max(ratio * size, least):
        raise ValueError(f"{claimed / 2**20:.4g} MiB are claimed by a file of {size} bytes")


def numbers_of(dataset: h5py.Dataset) -> h5py.Dataset:
    """Return a dataset that holds numbers, as many as the file can hold.

    Raises
    ------
    ValueError
        If it is a group, holds anything else, or claims more.
    """
    if not isinstance(dataset, h5py.Dataset) or dataset.dtype.kind not in "biuf":
        raise ValueError("no array of numbers")
    check_claim(dataset.parent, dataset.size * max(dataset.dtype.itemsize, 8))
    return dataset


def has_endless_heap(path: Path) -> bool:
    """Whether HDF5 would never come back from reading a text."""
    with path.open("rb") as file:
        start = file.read(9)
        if len(start) < 9 or start[8] > SUPERBLOCK_OF_FORMER:
            return False
        with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
            at = content.find(_SIGNATURE)
            while at >= 0:
                if _is_endless(content, at):
                    return True
                at = content.find(_SIGNATURE, at + 1)
    return False


def _is_endless(content: mmap.mmap, at: int) -> bool:
    if at + _HEAD > len(content):
        return False
    end = min(at + unpack_from("<Q", content, at + 8)[0], len(content))
    at += _HEAD
    while at + _OBJECT <= end:
        number, _, _, size = unpack_from("<HHIQ", content, at)
        if number:
            at += _OBJECT + (size + 7) // 8 * 8
        elif size:
            at += size  # what is free, its head included
        else:
            return True
    return False
