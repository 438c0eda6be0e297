"""Locks that end with the process that holds them, however that ends."""

import errno
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from filelock import FileLock, Timeout

from tractive_sam.store.errors import HeldError

NO_LOCKS = (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP, errno.EINVAL)
"""Errors of file systems that have no locks."""


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold a lock, on every machine that shares the file; the file goes with the lock.

    Where the file system has no locks, nothing is held: a results file then still has only one
    writer (see `HistoryWriter`), but the one that comes later takes it over.

    Raises
    ------
    HeldError
        If another process holds it.
    OSError
        If its file cannot be made.
    """
    lock = FileLock(path)
    try:
        lock.acquire(blocking=False)
    except Timeout:
        raise HeldError(f"{path} is held by another process") from None
    except OSError as error:
        if error.errno not in NO_LOCKS:
            raise
    try:
        yield
    finally:
        if lock.is_locked:
            with suppress(OSError):  # some systems remove no file that is open
                path.unlink()  # while it is held, so that nobody holds a file without name
        lock.release()


def is_locked(path: Path) -> bool:
    """Whether some process holds the lock."""
    if not path.exists():
        return False
    try:
        with locked(path):
            return False
    except HeldError:
        return True
