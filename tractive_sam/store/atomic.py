"""Changes to a file that happen whole or not at all."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import h5py

from tractive_sam.store.errors import StorageError, reason
from tractive_sam.store.writable import copy_of, real

LIBVER = ("v110", "v110")
"""File format: the first whose metadata all have checksums."""


@contextmanager
def atomic_rewrite(path: Path, *, empty: bool = False) -> Iterator[h5py.File]:
    """Work on a copy of a file, or on an empty one, that takes the place of the file at the end.

    If the block fails, or the process is killed in it, the file remains as it was. Every copy has a
    name of its own, so that two processes at one file do not write into each other's; what a killed
    process leaves behind, the next `sole_writer` removes.

    Raises
    ------
    StorageError
        If the disk does not take it.
    """
    path = real(path)
    copy = copy_of(path)
    try:
        if path.exists():
            copy.touch(mode=0o600)  # never open to more people than the file that it replaces
            shutil.copymode(path, copy)
        if not empty:
            shutil.copyfile(path, copy)
        # Without a cache of chunks every write reaches the system where it is made, and raises
        # there. One that fails later, as the cache is emptied, HDF5 drops without a word.
        with h5py.File(
            copy, "w" if empty else "r+", libver=LIBVER, locking=False, rdcc_nbytes=0
        ) as file:
            yield file
        _to_disk(copy)
        os.replace(copy, path)
    except Exception as error:
        if not _of_the_disk(error):
            raise
        raise StorageError(f"{path} cannot be written: {reason(error)}") from error
    finally:
        with suppress(OSError):
            copy.unlink()


def _of_the_disk(error: Exception) -> bool:
    """Whether the system, or HDF5 on top of it, could not write."""
    return isinstance(error, OSError | RuntimeError) or "errno = " in str(error)


def _to_disk(path: Path) -> None:
    """Have the content on disk before the name points to it, should the machine fail."""
    with path.open("rb+") as file:
        os.fsync(file.fileno())
