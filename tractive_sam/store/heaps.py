"""Looks at the heaps of texts in files of the first format, before HDF5 does.

A heap is a row of objects, each with its size; where one of size zero stands, HDF5 goes round for
ever. Source: HDF5 file format specification, III.E, "Disk Format: Level 1E - Global Heap".
"""

import mmap
from pathlib import Path
from struct import unpack_from

SUPERBLOCK_OF_FORMER = 2
"""Version of the first block of an HDF5 file, up to which texts in heaps are read here."""

_HEAD, _OBJECT, _SIGNATURE = 16, 16, b"GCOL"


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
