"""Locks that end with the process that holds them, however that ends."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

try:
    from fcntl import LOCK_EX, LOCK_NB, flock
except ImportError:  # no such locks on this system
    flock = None


class HeldError(Exception):
    """Another process holds the lock."""


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold a lock, on every machine that shares the file; the file goes with the lock.

    Where the file system has no locks, nothing is held: a results file then still has only one
    writer (see `store.HistoryWriter`), but the one that comes later takes it over.

    Raises
    ------
    HeldError
        If another process holds it.
    """
    if flock is None:
        yield
        return
    file = _open_locked(path)
    try:
        yield
    finally:
        path.unlink(missing_ok=True)  # while it is held, so that nobody holds a file without name
        os.close(file)


def is_locked(path: Path) -> bool:
    """Whether some process holds the lock."""
    if flock is None or not path.exists():
        return False
    try:
        with locked(path):
            return False
    except HeldError:
        return True


def _open_locked(path: Path) -> int:
    while True:
        file = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            flock(file, LOCK_EX | LOCK_NB)
        except BlockingIOError:
            os.close(file)
            raise HeldError(f"{path} is held by another process") from None
        except OSError:  # a file system without locks
            return file
        if _is_named(file, path):
            return file
        os.close(file)  # its last holder removed the name meanwhile


def _is_named(file: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(file), os.stat(path))
    except FileNotFoundError:
        return False
