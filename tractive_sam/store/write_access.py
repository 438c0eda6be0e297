"""File locks that are released when their process ends, also when it is killed."""

import errno
import io
import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from glob import escape
from pathlib import Path

import h5py
from filelock import FileLock, Timeout

from tractive_sam.interrupt import delay_interrupt
from tractive_sam.output_file import (
    TEMPORARY,
    OutputError,
    OutputFile,
    OutputPlaceError,
    check_folder,
    describe_os_error,
    hidden_path,
    is_write_protected,
    replace_file,
    resolve_link,
    short_name,
)
from tractive_sam.store.errors import FileInUseError, ResultsError, StorageError


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


@contextmanager
def sole_writer(path: Path, overwrite: bool, check_kind: Callable[[Path], None]) -> Iterator[None]:
    """Within the block, lock a file for writing; FileInUseError at once if it is locked.

    Parameters
    ----------
    path, overwrite, check_kind
        See `check_writable`, also for its errors.

    Raises
    ------
    FileInUseError
        If another process writes the file.
    """
    check_writable(path, overwrite, check_kind)
    with ExitStack() as locks:
        try:
            locks.enter_context(hold_lock(lock_path(path)))
        except FileInUseError:
            cure = "wait for it, stop it, or choose a separate file for this run"
            raise FileInUseError(f"another run writes {path}; {cure}") from None
        except OSError as error:
            raise StorageError(f"{path} cannot be written: {describe_os_error(error)}") from error
        # No other process writes copies now: existing copies come from killed processes.
        target = resolve_target(path)
        for copy in target.parent.glob(f".{escape(short_name(target))}.*{TEMPORARY}"):
            with suppress(OSError):
                copy.unlink()
        yield


def is_written(path: Path) -> bool:
    """Return whether a process is writing a file."""
    return is_locked(lock_path(path))


def lock_path(path: Path) -> Path:
    """Return the path of the lock of a file."""
    return hidden_path(resolve_target(path), ".lock")


def check_writable(path: Path, overwrite: bool, check_kind: Callable[[Path], None]) -> None:
    """Raise a ResultsError unless a file can be written, or replaced if it exists.

    Parameters
    ----------
    path : Path
        The file.
    overwrite : bool
        Whether a file of this kind may be replaced. A file of another kind is never replaced.
    check_kind : callable
        Raises ResultsError if a file is of another kind.

    Raises
    ------
    ResultsError
        If the folder does not exist or cannot be written, or a file exists that may not be
        replaced.
    """
    try:
        folder = resolve_target(path).parent
        if not folder.is_dir():
            raise ResultsError(f"{folder} is not a folder; create it, or choose another folder")
        if resolve_target(path).exists():
            _check_replaceable(path, overwrite, check_kind)
        check_folder(resolve_target(path))
    except OutputPlaceError as error:
        raise ResultsError(str(error)) from error
    except OutputError as error:
        raise StorageError(str(error)) from error
    except OSError as error:
        raise ResultsError(f"{path} cannot be written: {describe_os_error(error)}") from error


def resolve_target(path: Path) -> Path:
    """Return the target of a symbolic link, or the path itself if it is no link.

    Raises
    ------
    ResultsError
        If the link leads in a circle.
    """
    try:
        return resolve_link(path)
    except OutputPlaceError as error:
        raise ResultsError(str(error)) from None


def _check_replaceable(path: Path, overwrite: bool, check_kind: Callable[[Path], None]) -> None:
    """Raise a ResultsError unless `overwrite` is set and a file is of the kind that is replaced."""
    if not overwrite:
        raise ResultsError(f"{path} exists; choose another name, or replace it with overwrite=True")
    try:
        check_kind(path)
    except ResultsError as error:
        cure = "choose another name, or remove it"
        raise ResultsError(f"{path} would be overwritten, but {error}; {cure}") from error
    if is_write_protected(path):
        raise ResultsError(f"{path} is write-protected; unprotect it, or choose another name")


class WritableFile(h5py.File):
    """HDF5 file for writing that reports disk errors when `check` is called, not in HDF5.

    HDF5 would end the process if it could not write while it closes a file.

    Parameters
    ----------
    output : OutputFile
        The file that receives the bytes.
    size : int
        Size of the HDF5 file in it, bytes; 0 for a new file.
    """

    libver = ("v110", "v110")
    """HDF5 file format: the first with checksums of all metadata."""

    def __init__(self, output: OutputFile, size: int = 0) -> None:
        self._content = _UnfailingFile(output, size)
        # Without a chunk cache every write is immediate, so that `check` sees its failure.
        mode = "r+" if size else "w"
        super().__init__(self._content, mode, libver=self.libver, rdcc_nbytes=0)

    def check(self) -> None:
        """Raise an OutputError if an earlier write failed."""
        if self._content.error is not None:
            raise self._content.error

    def close(self) -> None:
        """Close the file; interrupts are delayed until it is closed."""
        with delay_interrupt():
            super().close()


@contextmanager
def atomic_rewrite(path: Path, *, empty: bool = False) -> Iterator[WritableFile]:
    """Yield a copy of a file, or an empty one, that replaces it unless the block fails.

    If the block fails or the process is killed, the file is unchanged. Each copy has a unique name,
    so two processes never write to the same copy. The next `sole_writer` removes the copies of
    killed processes.

    Raises
    ------
    StorageError
        If the file cannot be written.
    """
    try:
        with replace_file(path) as output:
            size = 0 if empty else output.copy(resolve_link(path))
            with WritableFile(output, size) as file:
                try:
                    yield file
                except Exception:
                    file.check()  # an error of HDF5 may follow from a failed write
                    raise
            file.check()
    except OutputError as error:
        raise StorageError(str(error)) from error
    except Exception as error:
        # Errors of the disk that h5py raises.
        if not (isinstance(error, OSError | RuntimeError) or "errno = " in str(error)):
            raise
        raise StorageError(f"{path} cannot be written: {describe_os_error(error)}") from error


class _UnfailingFile(io.RawIOBase):
    """File object for HDF5 that does not raise errors: after one, data stay in memory.

    HDF5 can read these data again.
    """

    def __init__(self, output: OutputFile, size: int) -> None:
        self._output, self._size, self._position = output, size, 0
        self._unwritten: list[tuple[int, bytes]] = []
        self.error: OutputError | None = None

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Set the position and return it, as `io.IOBase.seek`."""
        start = {os.SEEK_SET: 0, os.SEEK_CUR: self._position, os.SEEK_END: self._size}
        self._position = start[whence] + offset
        return self._position

    def readinto(self, buffer) -> int:
        """Fill a buffer and return the number of bytes; includes data that were not written."""
        view, start = memoryview(buffer).cast("B"), self._position
        count = max(0, min(len(view), self._size - start))
        stored = self._output.read(count, start)
        view[: len(stored)] = stored
        view[len(stored) : count] = bytes(count - len(stored))  # a hole at the end
        for offset, data in self._unwritten:
            first, last = max(start, offset), min(start + count, offset + len(data))
            if first < last:
                view[first - start : last - start] = data[first - offset : last - offset]
        self._position += count
        return count

    def write(self, data) -> int:
        """Write data, or store them in memory after a failure; return their size in bytes."""
        size = memoryview(data).nbytes
        try:
            if self.error is None:
                self._output.write(data, self._position)
        except OutputError as error:
            self.error = error
        if self.error is not None:
            self._unwritten.append((self._position, bytes(data)))
        self._position += size
        self._size = max(self._size, self._position)
        return size

    def truncate(self, size: int | None = None, /) -> int:
        """Set the length of the file and return it; a disk error is stored, not raised."""
        size = self._position if size is None else size
        try:
            if self.error is None:
                self._output.truncate(size)
        except OutputError as error:
            self.error = error
        self._size = size
        return size

    def flush(self) -> None:
        """Do nothing: every write is immediate."""
