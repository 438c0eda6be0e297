"""Changes to an HDF5 file that happen whole or not at all."""

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

LIBVER = ("v110", "v110")
"""File format: the first whose metadata all have checksums."""


class WritableFile(h5py.File):
    """An HDF5 file for writing; what the disk refuses is reported by `check`, not by HDF5.

    HDF5 ends the process if it cannot write while it closes a file.

    Parameters
    ----------
    output : OutputFile
        Where to write.
    size : int
        Bytes of the HDF5 file that it holds; 0 for a new one.
    """

    def __init__(self, output: OutputFile, size: int = 0) -> None:
        self._content = _UnfailingFile(output, size)
        # Without a cache of chunks every write is made at once, so that `check` sees its failure.
        mode = "r+" if size else "w"
        super().__init__(self._content, mode, libver=LIBVER, rdcc_nbytes=0)

    def check(self) -> None:
        """Raise OutputError if the disk refused anything so far."""
        if self._content.error is not None:
            raise self._content.error

    def close(self) -> None:
        """Close the file; an interrupt waits, since HDF5 does not survive an exception there."""
        with delay_interrupt():
            super().close()


@contextmanager
def atomic_rewrite(path: Path, *, empty: bool = False) -> Iterator[WritableFile]:
    """Work on a copy of a file, or on an empty one, that takes the place of the file at the end.

    If the block fails, or the process is killed in it, the file remains as it was. Every copy has a
    unique name, so that two processes at one file do not write into each other's; what a killed
    process leaves behind, the next `sole_writer` removes.

    Raises
    ------
    StorageError
        If the disk does not take it.
    """
    try:
        with replace_file(path) as output:
            size = 0 if empty else output.copy(resolve_link(path))
            with WritableFile(output, size) as file:
                try:
                    yield file
                except Exception:
                    file.check()  # what HDF5 reports may only follow from that
                    raise
            file.check()
    except OutputError as error:
        raise StorageError(str(error)) from error
    except Exception as error:
        if not _is_of_disk(error):
            raise
        raise StorageError(f"{path} cannot be written: {describe_os_error(error)}") from error


def _is_of_disk(error: Exception) -> bool:
    """Check whether the system, or HDF5 on top of it, could not read what it had written."""
    return isinstance(error, OSError | RuntimeError) or "errno = " in str(error)


class _UnfailingFile:
    """The file object that HDF5 writes into.

    After a failure the rest is kept in memory, where HDF5 finds it when it reads it again.
    """

    def __init__(self, output: OutputFile, size: int) -> None:
        self._output, self._size, self._position = output, size, 0
        self._unwritten: list[tuple[int, bytes]] = []
        self.error: OutputError | None = None

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        start = {os.SEEK_SET: 0, os.SEEK_CUR: self._position, os.SEEK_END: self._size}
        self._position = start[whence] + offset
        return self._position

    def tell(self) -> int:
        return self._position

    def read(self, size: int) -> bytes:
        data = bytearray(size)
        return bytes(data[: self.readinto(data)])

    def readinto(self, buffer) -> int:
        view, start = memoryview(buffer).cast("B"), self._position
        count = max(0, min(len(view), self._size - start))
        found = self._output.read(count, start)
        view[: len(found)] = found
        view[len(found) : count] = bytes(count - len(found))  # a hole at the end
        for place, data in self._unwritten:
            first, last = max(start, place), min(start + count, place + len(data))
            if first < last:
                view[first - start : last - start] = data[first - place : last - place]
        self._position += count
        return count

    def write(self, data) -> int:
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

    def truncate(self, size: int) -> int:
        try:
            if self.error is None:
                self._output.truncate(size)
        except OutputError as error:
            self.error = error
        self._size = size
        return size

    def flush(self) -> None:
        """Nothing waits to be written."""
