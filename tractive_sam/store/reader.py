"""Reads results files, finished or not."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

from tractive_sam.record import FIELDS, POINTS, PROFILES, SCALARS, History
from tractive_sam.store import layout
from tractive_sam.store.errors import ResultsError
from tractive_sam.store.rows import committed


@contextmanager
def results_file(path: Path) -> Iterator[h5py.File]:
    """Open a results file for reading.

    Raises
    ------
    ResultsError
        If it is not one, or is damaged; also where the block meets the damage.
    """
    if not path.exists():
        raise ResultsError(f"{path} does not exist; write it by tractive-sam run SCENE -o {path}")
    if not path.is_file():
        raise ResultsError(f"{path} is not a file; name a results file (.h5)")
    try:
        with h5py.File(path, "r") as file:
            _check(path, file)
            yield file
    except (OSError, KeyError, RuntimeError) as error:
        raise ResultsError(f"{path} {_diagnosis(path, error)}") from error


def open_history(path: str | Path) -> History:
    """Read a results file; its fields only when they are asked for.

    Parameters
    ----------
    path : path-like
        A file written by `HistoryWriter`, finished or not.

    Raises
    ------
    ResultsError
        If there is no such file, or it cannot be read; the message names the cure.
    """
    path = Path(path)
    with results_file(path) as file:
        scene, grid, history, fields = (file[k] for k in ("scene", "grid", "history", "fields"))
        n, m, about = committed(file), len(fields["record"]), dict(scene.attrs)
        return History(
            scene_toml=scene[()].decode(),
            status=about["status"],
            message=about["message"],
            **{name: float(about[name]) for name in layout.REFERENCE},
            x=grid["x"][:],
            y=grid["y"][:],
            scalars={name: history[name][:n] for name in SCALARS},
            points={name: history[name][:n] for name in POINTS},
            profiles={name: history[name][:n] for name in PROFILES},
            fields={name: StoredField(path, name, m) for name in FIELDS},
            field_revolutions=fields["revolution"][:],
            totals={name: about[name].item() for name in layout.TOTALS if name in about},
            versions={
                name.removeprefix(layout.VERSION_PREFIX): version
                for name, version in about.items()
                if name.startswith(layout.VERSION_PREFIX)
            },
        )


@dataclass(frozen=True)
class StoredField:
    """One field of several records, read from the file whenever a record is asked for.

    Attributes
    ----------
    path : Path
        The results file.
    name : str
        A name of `FIELDS`.
    length : int
        Number of records with fields.
    """

    path: Path
    name: str
    length: int

    def __len__(self) -> int:
        return self.length

    def __getitem__(self, row: int) -> np.ndarray:
        """The field of one record, shape (n_x, n_y)."""
        with results_file(self.path) as file:
            return file["fields"][self.name][range(self.length)[row]]


def _check(path: Path, file: h5py.File) -> None:
    if file.attrs.get("format") != layout.FORMAT:
        raise ResultsError(f"{path} is an HDF5 file, but not one of tractive-sam")
    version = file.attrs["format_version"]
    if version > layout.FORMAT_VERSION:
        raise ResultsError(f"{path} has format {version}; a newer tractive-sam can read it")
    missing = {"scene", "grid", "history", "fields"} - set(file)
    if missing:
        lost = ", ".join(f"/{name}" for name in sorted(missing))
        raise ResultsError(f"{path} lacks {lost}: it is damaged; run its scene again")


def _diagnosis(path: Path, error: Exception) -> str:
    if isinstance(error, PermissionError):
        return "may not be read; ask for permission"
    if isinstance(error, OSError) and not h5py.is_hdf5(path):
        return "is not an HDF5 file; name a results file (.h5)"
    return f"is truncated or damaged ({error}); copy it again, or run its scene again"
