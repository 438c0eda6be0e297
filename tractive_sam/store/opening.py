"""Opens results files, and says what is wrong with those that cannot be opened."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

from tractive_sam.store import layout
from tractive_sam.store.errors import DamagedError, ResultsError
from tractive_sam.store.form import GROUPS


@contextmanager
def results_file(path: Path) -> Iterator[h5py.File]:
    """Open a results file for reading.

    Raises
    ------
    ResultsError
        If it is not one, or is damaged (`DamagedError`); also where the block meets the damage.
    """
    if not path.exists():
        raise ResultsError(f"{path} does not exist; write it by tractive-sam run SCENE -o {path}")
    if not path.is_file():
        raise ResultsError(f"{path} is not a file; name a results file (.h5)")
    try:
        with h5py.File(path, "r") as file:
            _check(path, file)
            yield file
    # What h5py raises of a damaged file, and what it makes of one of another form.
    except (OSError, KeyError, RuntimeError, ValueError, TypeError, AttributeError) as error:
        kind = ResultsError if isinstance(error, PermissionError) else DamagedError
        raise kind(f"{path} {_diagnosis(path, error)}") from error


def _check(path: Path, file: h5py.File) -> None:
    if file.attrs.get("format") != layout.FORMAT:
        raise ResultsError(f"{path} is an HDF5 file, but not one of tractive-sam")
    version = file.attrs["format_version"]
    if version > layout.FORMAT_VERSION:
        raise ResultsError(f"{path} has format {version}; a newer tractive-sam can read it")
    kinds = {"scene": h5py.Dataset} | dict.fromkeys(GROUPS, h5py.Group)
    missing = [name for name, kind in kinds.items() if not isinstance(file.get(name), kind)]
    if missing:
        lost = ", ".join(f"/{name}" for name in sorted(missing))
        raise DamagedError(f"{path} lacks {lost}: it is damaged; run its scene again")


def _diagnosis(path: Path, error: Exception) -> str:
    if isinstance(error, PermissionError):
        return "may not be read; ask for permission"
    if isinstance(error, OSError) and not h5py.is_hdf5(path):
        return "is not an HDF5 file; name a results file (.h5)"
    return f"is truncated or damaged ({error}); copy it again, or run its scene again"
