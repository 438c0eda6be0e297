"""HDF5 files are opened for reading, and those of other programs are checked before.

An HDF5 file can refer to other files: by external links, by virtual datasets, and by datasets in
a file of raw bytes. HDF5 opens these files without a question, so that a reader could be made to
read any file of the machine. All these references are refused, and soft links, too.

Heaps of texts are checked before HDF5 reads them. A heap is a sequence of objects, each with its
size; HDF5 never returns from an object of size zero. Source: HDF5 file format specification, III.E,
"Disk Format: Level 1E - Global Heap".
"""

import hashlib
import mmap
from pathlib import Path
from struct import unpack_from

import h5py

from tractive_sam.input_file import open_regular
from tractive_sam.store.errors import ResultsError

SEAL = b"\nSHA-256 of the bytes before this line: "
"""Begin of the last line of netCDF files of this package, after the end of their HDF5 data."""


def has_seal(path: Path) -> bool:
    """Return whether a file ends with the hash of its bytes; ValueError if the hash is another."""
    with open_regular(path) as file:
        length = file.seek(0, 2) - len(SEAL) - 64
        file.seek(max(length, 0))
        seal = file.read()
        if not seal.startswith(SEAL):
            return False
        file.seek(0)
        found, rest = hashlib.sha256(), length
        while block := file.read(min(rest, 2**20)):
            found.update(block)
            rest -= len(block)
        if seal != SEAL + found.hexdigest().encode():
            raise ValueError("its content is not what was written")
    return True


def open_to_read(path: Path) -> h5py.File:
    """Open an HDF5 file for reading, also while other code of this process has it open.

    HDF5 shares one handle between all openings of a file by one driver. It refuses an opening with
    different flags: h5py and xarray set flags of locks, netCDF sets a flag of closing. So the file
    is opened by the driver for buffered files, which other code does not use. Only a file that this
    process has open for writing is opened by the usual driver, to share its handle.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    ResultsError
        If another process has it open for writing.
    OSError
        If the file is not a regular file, not an HDF5 file, or is damaged.
    ValueError
        If its last line is the hash of another content.
    """
    has_seal(path)  # HDF5 may never return from a damaged file
    try:
        return h5py.File(path, "r", driver="stdio", locking=False)
    except OSError as error:
        unopened = error
    for locking in (False, "best-effort", True):
        try:
            file = h5py.File(path, "r", locking=locking)
        except OSError as error:
            if "already open for write" in str(error):
                cure = "close it there; if its writer was killed, use h5clear -s"
                message = f"{path} is open for writing in another program: {cure}"
                raise ResultsError(message) from error
            if "flag values don't match" not in str(error):
                raise  # only the usual driver states the cause
        else:
            if file.mode == "r+":
                return file
            file.close()  # the shared handle of an earlier reader may predate the damage
    raise unopened


_HEAD, _OBJECT, _SIGNATURE = 16, 16, b"GCOL"


def get_member(group: h5py.Group, name: str) -> h5py.Group | h5py.Dataset:
    """Return a group or dataset by name; ValueError for any link or data in another file.

    Raises
    ------
    KeyError
        If the name does not exist.
    ValueError
        If the name is a link or no group or dataset, or the numbers are in another file.
    """
    item = group.id
    for part in map(str.encode, filter(None, name.split("/"))):
        if not item.links.exists(part):
            raise KeyError(f"{name} does not exist")
        if item.links.get_info(part).type != h5py.h5l.TYPE_HARD:
            raise ValueError(f"{name} is a link; only data in the file itself are read")
        item = h5py.h5o.open(item, part)
    if isinstance(item, h5py.h5g.GroupID):
        return h5py.Group(item)
    if not isinstance(item, h5py.h5d.DatasetID):
        raise ValueError(f"{name} is neither a group nor a dataset")
    layout = item.get_create_plist()
    if layout.get_layout() == h5py.h5d.VIRTUAL or layout.get_external_count():
        raise ValueError(f"{name} lies in other files; only data in the file itself are read")
    return h5py.Dataset(item, readonly=True)


def check_claimed_size(
    member: h5py.Group | h5py.Dataset, claimed: int, ratio: int = 1032, min_bytes: int = 2**26
) -> None:
    """Raise a ValueError if a file is too small for the amount of data that it claims to hold.

    Parameters
    ----------
    member : h5py.Group or h5py.Dataset
        Any member of the file.
    claimed : int
        Size of the data in memory, bytes.
    ratio : int
        Largest compression ratio (deflate).
    min_bytes : int
        Bytes that any file may claim: values that were never written need no space in a file.

    Raises
    ------
    ValueError
        If the file is too small.
    """
    size = h5py.h5i.get_file_id(member.id).get_filesize()
    if claimed > max(ratio * size, min_bytes):
        raise ValueError(f"a file of {size} bytes claims {claimed / 2**20:.4g} MiB of data")


def numeric_dataset(dataset: h5py.Dataset) -> h5py.Dataset:
    """Return a dataset; ValueError unless it is numeric and fits the size of its file.

    Raises
    ------
    ValueError
        If it is no numeric dataset, or claims more data than the file can contain.
    """
    if not isinstance(dataset, h5py.Dataset) or dataset.dtype.kind not in "biuf":
        raise ValueError("not an array of numbers")
    check_claimed_size(dataset, dataset.size * max(dataset.dtype.itemsize, 8))
    return dataset


def has_endless_heap(path: Path) -> bool:
    """Return whether a damaged heap of texts would make HDF5 read for ever."""
    # Last superblock version of files that may contain texts in heaps that this package reads.
    last_heap_superblock = 2
    with path.open("rb") as file:
        start = file.read(9)
        if len(start) < 9 or start[8] > last_heap_superblock:
            return False
        with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
            position = content.find(_SIGNATURE)
            while position >= 0:
                if _is_endless_heap(content, position):
                    return True
                position = content.find(_SIGNATURE, position + 1)
    return False


def _is_endless_heap(content: mmap.mmap, position: int) -> bool:
    """Return whether the heap at a position contains an object of size zero."""
    if position + _HEAD > len(content):
        return False
    end = min(position + unpack_from("<Q", content, position + 8)[0], len(content))
    position += _HEAD
    while position + _OBJECT <= end:
        number, _, _, size = unpack_from("<HHIQ", content, position)
        if number:
            position += _OBJECT + (size + 7) // 8 * 8
        elif size:
            position += size  # free space, including its header
        else:
            return True
    return False
