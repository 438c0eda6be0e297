"""Opens results files, and says what is wrong with those that cannot be read."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np

from tractive_sam.output_file import describe_os_error
from tractive_sam.store import layout
from tractive_sam.store.errors import DamagedError, ResultsError
from tractive_sam.store.hdf5_file import open_to_read
from tractive_sam.store.hdf5_guard import (
    check_claim,
    has_endless_heap,
    member,
    numbers_of,
)
from tractive_sam.store.texts import text_of

GROUPS = ("grid", "history", "fields", "stress", "state")


@contextmanager
def results_file(path: Path) -> Iterator["Results"]:
    """Open a results file for reading.

    Raises
    ------
    ResultsError
        If it is not one, or is damaged.
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
        with path.open("rb"):  # says why it may not be read
            pass
    except OSError as error:
        raise ResultsError(f"{path} cannot be read: {describe_os_error(error)}") from error
    with _open(path) as file:
        results = Results(path, file)
        results.check_format()
        yield results


def _open(path: Path) -> h5py.File:
    if has_endless_heap(path):
        raise _damaged(path, "its texts")
    try:
        return open_to_read(path)
    except ResultsError:
        raise
    except Exception as error:  # h5py has no one kind of error for what is damaged
        if not h5py.is_hdf5(path):
            told = f"{path} is not an HDF5 file; name a results file (.h5)"
            raise DamagedError(told) from error
        raise _damaged(path, str(error)) from error


def _damaged(path: Path, found: str) -> DamagedError:
    cure = "copy it again, or run its scene again"
    return DamagedError(f"{path} is truncated or damaged ({found}); {cure}")


class Results:
    """A results file that is open for reading.

    Every reading tells with a ResultsError what is damaged, or what another program has put in
    place of what was written. Names are those within the file, like "history/Qx".

    Parameters
    ----------
    path : Path
        The file.
    file : h5py.File
        The same, open.
    """

    def __init__(self, path: Path, file: h5py.File) -> None:
        self.path, self._file = path, file

    def check_format(self) -> None:
        """See that it is a results file whose format is known."""
        kind = self.text("/", "format", "")
        if kind.startswith("creep-force"):
            cure = f"tractive-sam show {self.path}, or tractive-sam table {self.path} --figure"
            raise ResultsError(f"{self.path} is a table of creep forces and no results: {cure}")
        if kind != layout.FORMAT:
            raise ResultsError(f"{self.path} is an HDF5 file, but not one of tractive-sam")
        if self.version > layout.FORMAT_VERSION:
            told = f"{self.path} has format {self.version}; a newer tractive-sam can read it"
            raise ResultsError(told)
        kinds = {"scene": h5py.Dataset} | dict.fromkeys(GROUPS, h5py.Group)
        with self._damage_told("/"):
            lost = [
                k
                for k, kind in kinds.items()
                if k not in self._file or not isinstance(self._item(k), kind)
            ]
        if lost:
            told = ", ".join(f"/{name}" for name in sorted(lost))
            raise DamagedError(f"{self.path} lacks {told}: it is damaged; run its scene again")

    @property
    def version(self) -> int:
        """Version of the format."""
        with self._damage_told("format_version"):
            return int(self._file.attrs["format_version"])

    @property
    def records(self) -> int:
        """Number of complete records."""
        laid_out = self.length("history/record")
        with self._damage_told("history/record"):
            check_claim(self._file, 8 * laid_out * len(self._item("history")))
        if self.version > 1:
            return laid_out
        with self._damage_told("history/committed"):  # rows were laid out before they were filled
            committed = int(self._item("history/committed")[()])
        if not 0 <= committed <= laid_out:
            raise _damaged(self.path, f"{committed} of {laid_out} records")
        return committed

    def __contains__(self, name: str) -> bool:
        with self._damage_told(name):
            return name in self._file

    def names(self, group: str) -> tuple[str, ...]:
        """What is in a group."""
        with self._damage_told(group):
            return tuple(self._item(group).keys())

    def length(self, name: str) -> int:
        """Number of rows of a dataset."""
        with self._damage_told(name):
            return len(self._item(name))

    def numbers(self, name: str, shape: tuple[int, ...], optional: bool = False) -> np.ndarray:
        """As many rows of numbers as the shape says; nan where they are optional and missing."""
        if optional and name not in self:
            return np.full(shape, np.nan)
        self.check(name, shape)
        with self._damage_told(name):
            return numbers_of(self._item(name))[: shape[0]]

    def whole(self, name: str) -> np.ndarray:
        """All numbers of a dataset."""
        with self._damage_told(name):
            return numbers_of(self._item(name))[...]

    def row(self, name: str, row: int) -> np.ndarray:
        """One row of numbers."""
        with self._damage_told(name):
            dataset = self._item(name)
            check_claim(dataset, dataset.nbytes // max(len(dataset), 1))
            return dataset[row]

    def check(self, name: str, shape: tuple[int, ...]) -> None:
        """See that there are numbers of a shape, or more rows of them, without reading them."""
        with self._damage_told(name):
            found = self._item(name)
            numbers = found.dtype.kind in "fiu" and found.maxshape[0] is None
            if not numbers or found.shape[1:] != shape[1:] or len(found) < shape[0]:
                told = f"{found.dtype} of the shape {found.shape}, not numbers of the shape {shape}"
                raise ValueError(told)

    def text(self, name: str, attribute: str | None = None, default: str | None = None) -> str:
        """A dataset that is a text, or an attribute that is one."""
        with self._damage_told(f"{name} {attribute or ''}".rstrip()):
            item = self._item(name)
            if attribute is None:
                check_claim(item, item.nbytes)
                return text_of(item[()])
            if default is not None and attribute not in item.attrs:
                return default
            return text_of(item.attrs[attribute])

    def labels(self, name: str) -> tuple[str, ...]:
        """A dataset of texts."""
        with self._damage_told(name):
            item = self._item(name)
            check_claim(item, item.nbytes)
            return tuple(map(text_of, item[:].tolist()))

    def attribute(self, name: str, attribute: str) -> np.ndarray:
        """An attribute that is a number, or several."""
        with self._damage_told(f"{name} {attribute}"):
            return np.asarray(self._item(name).attrs[attribute], float)

    def attributes(self, name: str) -> tuple[str, ...]:
        """The names of all attributes."""
        with self._damage_told(name):
            return tuple(self._item(name).attrs.keys())

    def verify(self) -> None:
        """Read all numbers: what is damaged is told by its checksum."""
        # Not by `visit`: it may end the process where a page of the file is lost (HDF5 2.0).
        left, groups = ["/"], set()
        while left:
            name = left.pop()
            with self._damage_told(name):
                item = self._item(name)
                if isinstance(item, h5py.Group):
                    if item in groups:  # a group may lie in itself
                        raise ValueError("a group in several places")
                    groups.add(item)
                    left += [f"{name.rstrip('/')}/{inner}" for inner in item]
                elif item.dtype.kind in "fiu" and item.size:
                    check_claim(item, item.nbytes)
                    for chunk in item.iter_chunks() if item.chunks else [()]:
                        _ = item[chunk]

    def _item(self, name: str) -> h5py.Group | h5py.Dataset:
        """Return what lies under a name in this file; no link is followed."""
        return member(self._file, name)

    def damaged(self, found: str) -> DamagedError:
        """The error that tells what was found."""
        return _damaged(self.path, found)

    @contextmanager
    def _damage_told(self, name: str) -> Iterator[None]:
        """Around what h5py is asked for, and nothing else."""
        try:
            yield
        except MemoryError:
            raise
        except Exception as error:  # h5py has no one kind of error for what is damaged
            raise _damaged(self.path, f"{name.strip('/')}: {error}") from error
