"""Opens results files and reports damaged ones."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.output_file import describe_os_error
from tractive_sam.store.datasets import FORMAT, FORMAT_VERSION, decode_text
from tractive_sam.store.errors import DamagedError, ResultsError
from tractive_sam.store.hdf5_guard import (
    check_claimed_size,
    get_member,
    has_endless_heap,
    numeric_dataset,
    open_to_read,
)


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
