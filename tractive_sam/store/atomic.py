"""Atomic changes to HDF5 files: completely or not at all."""

import io
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

from tractive_sam.interrupt import delay_interrupt
from tractive_sam.output_file import (
    OutputError,
    OutputFile,
    describe_os_error,
    replace_file,
    resolve_link,
)
from tractive_sam.store.errors import StorageError


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
        if not _is_of_disk(error):
            raise
        raise StorageError(f"{path} cannot be written: {describe_os_error(error)}") from error


def _is_of_disk(error: Exception) -> bool:
    """Return whether h5py's error comes from the disk: OSError, RuntimeError or an errno text."""
    return isinstance(error, OSError | RuntimeError) or "errno = " in str(error)


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
