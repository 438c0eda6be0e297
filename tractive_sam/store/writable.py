"""The place on the disk where a file is to be: whether it may be written, and by whom."""

import hashlib
import os
import stat
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from glob import escape
from pathlib import Path
from uuid import uuid4

from tractive_sam.store.errors import HeldError, ResultsError, reason
from tractive_sam.store.lock import is_locked, locked

LONGEST = 180
"""Bytes of a name that fit into that of a hidden file beside it; systems allow 255."""

NEW = ".new"
"""How the names of copies end that are to take the place of a file."""


@contextmanager
def sole_writer(path: Path, overwrite: bool, check_kind: Callable[[Path], None]) -> Iterator[None]:
    """Be the only one who writes a file; arguments and errors as of `check_writable`.

    Raises
    ------
    HeldError
        If another process writes it.
    """
    check_writable(path, overwrite, check_kind)
    with ExitStack() as held:
        try:
            held.enter_context(locked(lock_of(path)))
        except HeldError:
            cure = "wait for it, stop it, or give this run a file of its own"
            raise HeldError(f"{path} is being written by another run; {cure}") from None
        # Nobody else works on copies now: those there are were left behind by killed processes.
        for copy in real(path).parent.glob(f".{escape(_short(path))}.*{NEW}"):
            with suppress(OSError):
                copy.unlink()
        yield


def is_written(path: Path) -> bool:
    """Whether some process is the writer of a file."""
    return is_locked(lock_of(path))


def lock_of(path: Path) -> Path:
    """The lock of a file."""
    return _hidden(path, ".lock")


def copy_of(path: Path) -> Path:
    """A name for a copy of a file that is to take its place."""
    return _hidden(path, f".{uuid4().hex[:12]}{NEW}")


def check_writable(path: Path, overwrite: bool, check_kind: Callable[[Path], None]) -> None:
    """See that a file can be written; its folder is tried.

    Parameters
    ----------
    path : Path
        The file.
    overwrite : bool
        Whether a file of its kind may be replaced. One of any other kind never is.
    check_kind : callable
        Raises ResultsError if a file is not of that kind.

    Raises
    ------
    ResultsError
        If there is no such folder, it cannot be written into, or there is a file that may not be
        replaced.
    """
    try:
        folder = real(path).parent
        if not folder.is_dir():
            raise ResultsError(f"{folder} is not a folder; create it, or choose another")
        if real(path).exists():
            _check_replaced(path, overwrite, check_kind)
        scratch = copy_of(path)
        scratch.touch()
        scratch.unlink()
    except OSError as error:
        raise ResultsError(f"{path} cannot be written: {reason(error)}") from error


def real(path: Path) -> Path:
    """What a link points to, or the path itself.

    Raises
    ------
    ResultsError
        If it leads in a circle.
    """
    found = Path(os.path.realpath(path))
    if found.is_symlink():
        raise ResultsError(f"{path} is a link that leads in a circle; choose another name")
    return found


def _check_replaced(path: Path, overwrite: bool, check_kind: Callable[[Path], None]) -> None:
    if not overwrite:
        raise ResultsError(
            f"{path} exists already; choose another name, or replace it with overwrite=True"
        )
    try:
        check_kind(path)
    except ResultsError as error:
        cure = "choose another name, or remove it"
        raise ResultsError(f"{path} would be overwritten, but {error}; {cure}") from error
    # The mode is asked, too: to the administrator everything is allowed.
    may_write = path.stat().st_mode & (stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH)
    if not may_write or not os.access(path, os.W_OK):
        raise ResultsError(f"{path} is write-protected; unprotect it, or choose another name")


def _hidden(path: Path, suffix: str) -> Path:
    return real(path).with_name(f".{_short(path)}{suffix}")


def _short(path: Path) -> str:
    """The name of a file, or if that is very long, one that stands for it."""
    name = real(path).name
    encoded = os.fsencode(name)
    return name if len(encoded) <= LONGEST else hashlib.sha256(encoded).hexdigest()
