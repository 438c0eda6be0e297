"""File locks that are released when their process ends, also when it is killed."""

import errno
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from filelock import FileLock, Timeout

from tractive_sam.store.errors import FileInUseError, ResultsError


@contextmanager
def hold_lock(path: Path) -> Iterator[None]:
    """Within the block, hold a lock file; raise a FileInUseError at once if it is locked.

    The lock excludes other processes, also on other machines.

    A file system without locks is accepted: a results file then still has only one writer (see
    `HistoryWriter`), but a later writer takes over from an earlier one.

    Raises
    ------
    FileInUseError
        If another process holds the lock.
    ResultsError
        If the lock file is a link.
    OSError
        If the lock file cannot be created.
    """
    # Error numbers of file systems without locks.
    no_locks = (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP, errno.EINVAL)
    lock = FileLock(path)
    try:
        lock.acquire(blocking=False)
    except Timeout:
        raise FileInUseError(f"another process holds {path}; wait until it ends") from None
    except OSError as error:
        if path.is_symlink():
            raise ResultsError(f"{path} is a link; remove it: locks are regular files") from error
        if error.errno not in no_locks:
            raise
    try:
        yield
    finally:
        if lock.is_locked:
            with suppress(OSError):  # some systems cannot remove an open file
                path.unlink()  # before the release, so that no process locks a removed file
        lock.release()


def is_locked(path: Path) -> bool:
    """Return whether a process holds the lock of a file."""
    if not path.exists():
        return False
    try:
        with hold_lock(path):
            return False
    except FileInUseError:
        return True
