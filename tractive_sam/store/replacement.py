"""Changes to a file that happen whole or not at all."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from glob import escape
from pathlib import Path
from time import time
from uuid import uuid4

import h5py

LIBVER = ("v108", "v108")
"""File format. Later ones mark a file as open while it is written, and a marked file whose writer
was killed cannot be opened any more."""

ABANDONED = 3600.0
"""Time after which a copy that nobody wrote into is taken for left behind, s."""


def open_in_place(path: Path) -> h5py.File:
    """Open a file to write values of existing elements, and no more than that.

    It is not locked: as its structure stays as it is, others can read it meanwhile.
    """
    return h5py.File(path, "r+", libver=LIBVER, locking=False)


@contextmanager
def replacement(path: Path, *, empty: bool = False) -> Iterator[h5py.File]:
    """Work on a copy of a file, or on an empty one, that takes the place of the file at the end.

    If the block fails, or the process is killed in it, the file remains as it was. Every copy has a
    name of its own, so that two processes at one file do not write into each other's; what a killed
    process leaves behind, a replacement after `ABANDONED` removes.
    """
    path = path.resolve()  # of a link, what it points to is replaced
    copy = path.with_name(f".{path.name}.{uuid4().hex}.new")
    _sweep(path)
    try:
        if not empty:
            shutil.copyfile(path, copy)
        with h5py.File(copy, "w" if empty else "r+", libver=LIBVER, locking=False) as file:
            yield file
        _to_disk(copy)
        os.replace(copy, path)
    finally:
        copy.unlink(missing_ok=True)


def _sweep(path: Path) -> None:
    """Remove copies of a file that nobody works on any more."""
    for copy in path.parent.glob(f".{escape(path.name)}.*.new"):
        with suppress(OSError):  # another process was faster
            if time() - copy.stat().st_mtime > ABANDONED:
                copy.unlink()


def _to_disk(path: Path) -> None:
    """Have the content on disk before the name points to it, should the machine fail."""
    with path.open("rb+") as file:
        os.fsync(file.fileno())
