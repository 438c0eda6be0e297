"""Opens HDF5 files for reading: results files, and files of other programs.

An HDF5 file can refer to other files: by external links, by virtual datasets, and by datasets in
a file of raw bytes. HDF5 opens these files without a question, so that a reader could be made to
read any file of the machine. All these references are refused, and soft links, too.

Heaps of texts are checked before HDF5 reads them. A heap is a sequence of objects, each with its
size; HDF5 never returns from an object of size zero. Source: HDF5 file format specification, III.E,
"Disk Format: Level 1E - Global Heap".
"""

import hashlib
import mmap
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from struct import unpack_from

import h5py
import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.input_file import open_regular
from tractive_sam.output_file import describe_os_error
from tractive_sam.store.errors import DamagedError, ResultsError

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


FORMAT = "tractive-sam history"
FORMAT_VERSION = 2
"""Increased when readers of the version before would misread the file. Version 1 is still read, see
`reader`. A new column needs no new version: a missing column reads as nan."""


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


@contextmanager
def open_results(path: Path) -> Iterator["ResultsFile"]:
    """Open a results file for reading within the block; ResultsError if it is none.

    Raises
    ------
    ResultsError
        If the file is no results file or is damaged.
    """
    try:
        if not path.exists():
            cure = f"write it by tractive-sam run SCENE -o {path}"
            raise ResultsError(f"{path} does not exist; {cure}")
        if not path.is_file():
            cure = "name a results file (.h5)"
            if (path / "study.toml").exists():
                cure = f"it is a study: tractive-sam study-show {path}, or {cure} in it"
            raise ResultsError(f"{path} is not a file; {cure}")
        with path.open("rb"):  # its error states why the file cannot be read
            pass
    except OSError as error:
        raise ResultsError(f"{path} cannot be read: {describe_os_error(error)}") from error
    with _open(path) as file:
        results = ResultsFile(path, file)
        results.check_format()
        yield results


def _open(path: Path) -> h5py.File:
    """Return an HDF5 file opened for reading; errors state the damage."""
    if has_endless_heap(path):
        raise _damage_error(path, "its texts")
    try:
        return open_to_read(path)
    except ResultsError:
        raise
    except Exception as error:  # h5py raises many types of errors for damaged files
        if not h5py.is_hdf5(path):
            message = f"{path} is not an HDF5 file; name a results file (.h5)"
            raise DamagedError(message) from error
        raise _damage_error(path, str(error)) from error


def _damage_error(path: Path, problem: str) -> DamagedError:
    """Return the error of a damaged file, with advice."""
    cure = "copy it again, or run its scene again"
    return DamagedError(f"{path} is truncated or damaged ({problem}); {cure}")


class ResultsFile:
    """Results file that is open for reading, with checked access to its content.

    Each method raises ResultsError if the data are damaged or were replaced by another program.
    Names are paths within the file, for example "history/Qx".

    Parameters
    ----------
    path : Path
        Path of the file.
    file : h5py.File
        The open file.
    """

    groups = ("grid", "history", "fields", "stress", "state")

    def __init__(self, path: Path, file: h5py.File) -> None:
        self.path, self._file = path, file
        self._opened: dict[str, h5py.Group | h5py.Dataset] = {}

    def check_format(self) -> None:
        """Raise a ResultsError unless this is an undamaged results file in a known format."""
        kind = self.text("/", "format", "")
        if kind.startswith("creep-force"):
            cure = f"tractive-sam show {self.path}, or tractive-sam table {self.path} --figure"
            raise ResultsError(f"{self.path} is a creep-force table, not a results file: {cure}")
        if kind != FORMAT:
            cure = "name a results file (.h5)"
            raise ResultsError(f"{self.path} is an HDF5 file, but not of tractive-sam; {cure}")
        if self.version > FORMAT_VERSION:
            message = f"{self.path} has format {self.version}; a newer tractive-sam can read it"
            raise ResultsError(message)
        lost = [name for name in ("scene", *self.groups) if name not in self]
        if lost:
            message = ", ".join(f"/{name}" for name in sorted(lost))
            raise DamagedError(f"{self.path} lacks {message}: it is damaged; run its scene again")

    @property
    def version(self) -> int:
        """Version of the file format."""
        with self._report_damage("format_version"):
            return int(self._file.attrs["format_version"])

    @property
    def records(self) -> int:
        """Number of complete records, the rows of the history."""
        laid_out = self.length("history/record")
        with self._report_damage("history/record"):
            check_claimed_size(self._file, 8 * laid_out * len(self._item("history")))
        if self.version > 1:
            return laid_out
        with self._report_damage("history/committed"):  # format 1 allocates rows in advance
            committed = int(self._item("history/committed")[()])
        if not 0 <= committed <= laid_out:
            raise _damage_error(self.path, f"{committed} of {laid_out} records")
        return committed

    def __contains__(self, name: str) -> bool:
        with self._report_damage(name):
            return name in self._opened or name in self._file

    def names(self, group: str) -> tuple[str, ...]:
        """Return the names of the members of a group."""
        with self._report_damage(group):
            return tuple(self._item(group).keys())

    def length(self, name: str) -> int:
        """Return the number of rows of a dataset."""
        with self._report_damage(name):
            return len(self._item(name))

    def numbers(self, name: str, shape: tuple[int, ...]) -> np.ndarray:
        """Return the first rows of a dataset, in a shape."""
        self.check(name, shape)
        return self.all_numbers(name)[: shape[0]]

    def all_numbers(self, name: str) -> np.ndarray:
        """Return a numeric dataset as an array."""
        with self._report_damage(name):
            return numeric_dataset(self._item(name))[...]

    def row(self, name: str, row: int) -> np.ndarray:
        """Return one row of a dataset."""
        with self._report_damage(name):
            dataset = self._item(name)
            check_claimed_size(dataset, dataset.nbytes // max(len(dataset), 1))
            return dataset[row]

    def check(self, name: str, shape: tuple[int, ...]) -> None:
        """Raise a DamagedError unless a dataset has >= shape[0] rows of numbers of shape[1:]."""
        with self._report_damage(name):
            dataset = self._item(name)
            numbers = dataset.dtype.kind in "fiu" and dataset.maxshape[0] is None
            if not numbers or dataset.shape[1:] != shape[1:] or len(dataset) < shape[0]:
                described = f"{dataset.dtype} of the shape {dataset.shape}"
                raise ValueError(f"{described}, not numbers of the shape {shape}")

    def text(self, name: str, attribute: str | None = None, default: str | None = None) -> str:
        """Return a text dataset or text attribute; `default` if the attribute is missing."""
        with self._report_damage(f"{name} {attribute or ''}".rstrip()):
            item = self._item(name)
            if attribute is None:
                check_claimed_size(item, item.nbytes)
                return decode_text(item[()])
            if default is not None and attribute not in item.attrs:
                return default
            return decode_text(item.attrs[attribute])

    def labels(self, name: str) -> tuple[str, ...]:
        """Return a dataset of texts as a tuple."""
        with self._report_damage(name):
            item = self._item(name)
            check_claimed_size(item, item.nbytes)
            return tuple(map(decode_text, item[:].tolist()))

    def attribute(self, name: str, attribute: str, default: ArrayLike | None = None) -> np.ndarray:
        """Return a numeric attribute of a member, or the default if it is missing."""
        with self._report_damage(f"{name} {attribute}"):
            attributes = self._item(name).attrs
            missing = default is not None and attribute not in attributes
            return np.asarray(default if missing else attributes[attribute], float)

    def attributes(self, name: str) -> tuple[str, ...]:
        """Return the names of all attributes of a member."""
        with self._report_damage(name):
            return tuple(self._item(name).attrs.keys())

    def verify(self) -> None:
        """Read all numbers, so that HDF5 checks every checksum; DamagedError at the first fault."""
        # Not by `visit`: it may end the process if a page of the file is lost (HDF5 2.0).
        pending, groups = ["/"], set()
        while pending:
            name = pending.pop()
            with self._report_damage(name):
                item = self._item(name)
                if isinstance(item, h5py.Group):
                    if item in groups:  # a group may contain itself
                        raise ValueError("a group in several places")
                    groups.add(item)
                    pending += [f"{name.rstrip('/')}/{inner}" for inner in item]
                elif item.dtype.kind in "fiu" and item.size:
                    check_claimed_size(item, item.nbytes)
                    for chunk in item.iter_chunks() if item.chunks else [()]:
                        _ = item[chunk]

    def _item(self, name: str) -> h5py.Group | h5py.Dataset:
        """Return a group or dataset by its path; KeyError if missing, ValueError for a link."""
        if name not in self._opened:
            group, _, last = name.strip("/").rpartition("/")
            self._opened[name] = get_member(self._item(group) if group else self._file, last)
        return self._opened[name]

    def damage_error(self, problem: str) -> DamagedError:
        """Return the error that describes damage of this file."""
        return _damage_error(self.path, problem)

    @contextmanager
    def _report_damage(self, name: str) -> Iterator[None]:
        """Within the block, turn all errors except MemoryError into a DamagedError."""
        try:
            yield
        except MemoryError:
            raise
        except Exception as error:  # h5py raises many types of errors for damaged files
            raise _damage_error(self.path, f"{name.strip('/')}: {error}") from error
