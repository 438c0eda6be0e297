"""Atomic output: this module writes every file of the package, completely or not at all.

The content goes to a temporary file with a unique name in the folder of the output. The temporary
file replaces the output once it is on disk. After any earlier failure the output is unchanged and
the temporary file is removed.
"""

import errno
import hashlib
import os
import re
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from uuid import uuid4

from tractive_sam.interrupt import heed, protected

CURES = {
    errno.ENOSPC: "the disk is full; make room, or choose another",
    errno.EDQUOT: "your share of the disk is used up; make room, or choose another",
    errno.EFBIG: "it is larger than files may be here; raise the limit (ulimit -f)",
    errno.EACCES: "permission denied; ask for it, or choose another folder",
    errno.EPERM: "permission denied; ask for it, or choose another folder",
    errno.EROFS: "the disk is read-only; choose another",
    errno.ENAMETOOLONG: "the name is too long; choose a shorter one",
    errno.ELOOP: "it is a link that leads in a circle; remove it, or choose another name",
    errno.EIO: "the disk fails; choose another",
    errno.ENOENT: "there is no such folder; create it, or choose another",
    errno.ENOTDIR: "its folder is a file; choose another",
    errno.EISDIR: "it is a folder; choose another name",
    errno.EEXIST: "it exists already; rename or remove it, or choose another name",
}
"""What the system found wrong, and what to do about it."""

TEMPORARY = ".new"
"""How the names of temporary files end."""


class OutputError(OSError):
    """An output that cannot be written; a file that was there before is unchanged.

    Examples
    --------
    >>> try:
    ...     ts.report(history, "no-such-folder/discs.html")
    ... except OSError as error:
    ...     print(error)
    no-such-folder/discs.html cannot be written: there is no such folder; create it, or choose another
    """  # noqa: E501 - as it is printed


class OutputPlaceError(OutputError):
    """An output whose name or folder cannot be used; nothing was written."""


class OutputFile:
    """The temporary file of an output, open for writing and reading at any position.

    Parameters
    ----------
    output : Path
        The output, for messages.
    descriptor : int
        The temporary file, open.
    """

    def __init__(self, output: Path, descriptor: int) -> None:
        self.output, self._descriptor = output, descriptor

    def write(self, data: bytes | memoryview, position: int) -> None:
        """Write all of the data from a position on.

        Raises
        ------
        OutputError
            If the system does not take them.
        """
        with _failure_reported(self.output):
            os.lseek(self._descriptor, position, os.SEEK_SET)
            rest = memoryview(data).cast("B")
            while rest:
                rest = rest[os.write(self._descriptor, rest) :]

    def read(self, size: int, position: int) -> bytes:
        """Read at most `size` bytes from a position on; fewer at the end of the file."""
        os.lseek(self._descriptor, position, os.SEEK_SET)
        parts: list[bytes] = []
        while size and (part := os.read(self._descriptor, size)):
            parts.append(part)
            size -= len(part)
        return b"".join(parts)

    def truncate(self, size: int) -> None:
        """Set the length of the file, in bytes; raises as `write` does."""
        with _failure_reported(self.output):
            os.ftruncate(self._descriptor, size)

    def copy(self, source: Path, block: int = 2**24) -> int:
        """Begin with the content of another file; returns its size. `block` bounds the memory."""
        position = 0
        with _failure_reported(self.output), source.open("rb") as file:
            while data := file.read(block):
                self.write(data, position)
                position += len(data)
        return position


@contextmanager
def replace_file(path: Path, *, exclusive: bool = False) -> Iterator[OutputFile]:
    """Write a file that takes the place of another one, or of none, when the block ends.

    It gets the permissions of the file that it replaces, or those of any new file. If the block
    raises, nothing changes. Links are followed.

    Parameters
    ----------
    path : Path
        The output.
    exclusive : bool
        Whether to refuse to replace a file.

    Raises
    ------
    OutputPlaceError
        If there is no such folder, it cannot be written into, or the file may not be replaced.
    OutputError
        If the system does not take the content.
    """
    with protected(), _replacement(path, exclusive) as file:
        yield file


@contextmanager
def _replacement(path: Path, exclusive: bool) -> Iterator[OutputFile]:
    with _failure_reported(path, OutputPlaceError):
        target = followed(path)
        mode = _mode_of(target, exclusive)
        temporary = temporary_of(target)
        flags = os.O_RDWR | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
        # Never open to more people than the file that it replaces.
        descriptor = os.open(temporary, flags, 0o666 if mode is None else 0o600)
    try:
        try:
            if mode is not None:
                with _failure_reported(path):
                    temporary.chmod(mode)
            yield OutputFile(path, descriptor)
            with _failure_reported(path):
                os.fsync(descriptor)  # the content before the name, should the machine fail
        except BaseException:
            with suppress(OSError):
                os.close(descriptor)
            raise
        with _failure_reported(path):
            os.close(descriptor)
            if exclusive:
                _mode_of(target, exclusive)
            temporary.replace(target)
    finally:
        with suppress(OSError):
            temporary.unlink()


def write_file(
    path: str | os.PathLike[str], content: str | bytes | memoryview, *, exclusive: bool = False
) -> Path:
    """Write a file as a whole, text as UTF-8; arguments and errors are those of `replace_file`.

    What is no file, as a terminal or a pipe, is written to directly.
    """
    heed()
    path = Path(path)
    data = content.encode() if isinstance(content, str) else content
    if _is_stream(path):
        with _failure_reported(path), path.open("wb") as stream:
            stream.write(data)
        return path
    with replace_file(path, exclusive=exclusive) as file:
        file.write(data, 0)
    return path


def append_to_file(path: Path, data: bytes) -> None:
    """Append to a file, in one write where the system takes it; created if it does not exist.

    If the disk does not take all of it, a part may remain: readers must recognize one.

    Raises
    ------
    OutputError
        If the system does not take the data.
    """
    with _failure_reported(path), path.open("ab", buffering=0) as file:
        rest = memoryview(data)
        while rest:
            rest = rest[file.write(rest) :]


def make_folder(path: str | os.PathLike[str]) -> Path:
    """Create a folder for outputs, with those it is in, unless it exists.

    Raises
    ------
    OutputPlaceError
        If it cannot be created.
    """
    path = Path(path)
    with _failure_reported(path, OutputPlaceError):
        path.mkdir(parents=True, exist_ok=True)
    return path


def check_folder(path: Path) -> None:
    """Check that a temporary file can be created beside a file; raises as `replace_file` does."""
    with _failure_reported(path, OutputPlaceError):
        temporary = temporary_of(path)
        try:
            temporary.touch()
        finally:
            with suppress(OSError):
                temporary.unlink()


def followed(path: Path) -> Path:
    """Return what a link points to, or the path itself.

    Raises
    ------
    OutputPlaceError
        If the link leads in a circle.
    """
    target = Path(os.path.realpath(path))
    if target.is_symlink():
        raise OutputPlaceError(
            f"{path} is a link that leads in a circle; choose another name, or remove it"
        )
    return target


def hidden_beside(path: Path, suffix: str) -> Path:
    """Return the path of a hidden file beside a file, `.NAME` and a suffix."""
    return path.with_name(f".{short_name(path)}{suffix}")


def short_name(path: Path, longest: int = 180) -> str:
    """Return the name of a file, or a hash of one that leaves no room for a prefix and a suffix.

    Parameters
    ----------
    path : Path
        The file.
    longest : int
        Bytes; systems allow 255.
    """
    encoded = os.fsencode(path.name)
    return path.name if len(encoded) <= longest else hashlib.sha256(encoded).hexdigest()


def temporary_of(path: Path) -> Path:
    """Return a unique name for a temporary file beside a file."""
    return hidden_beside(path, f".{uuid4().hex[:12]}{TEMPORARY}")


def is_write_protected(path: Path) -> bool:
    """Check whether a file may not be written; its mode counts also for the administrator."""
    by_mode = path.stat().st_mode & (stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH)
    return not by_mode or not os.access(path, os.W_OK)


def is_disk_failure(error: Exception) -> bool:
    """Check whether the disk is full or fails, rather than that a name or folder is unsuitable."""
    return getattr(error, "errno", None) in (errno.ENOSPC, errno.EDQUOT, errno.EIO)


def reason(error: Exception) -> str:
    """Return the cause of an error of the system, also from the text of HDF5, and the cure."""
    by_hdf5 = re.search(r"errno = (\d+)", str(error))
    number = int(by_hdf5[1]) if by_hdf5 else getattr(error, "errno", None)
    return (
        CURES.get(number or 0) or getattr(error, "strerror", None) or str(error).partition("\n")[0]
    )


@contextmanager
def _failure_reported(path: Path, kind: type[OutputError] = OutputError) -> Iterator[None]:
    """Name the output and the cause in what the system reports."""
    try:
        yield
    except OutputError:
        raise
    except (OSError, ValueError) as error:  # ValueError: a name with a null character
        if is_disk_failure(error):
            kind = OutputError
        raise kind(f"{path} cannot be written: {reason(error)}") from error


def _mode_of(target: Path, exclusive: bool) -> int | None:
    """Return the permissions of the file that is to be replaced; None if there is none."""
    try:
        mode = target.stat().st_mode
    except FileNotFoundError:
        return None
    if exclusive:
        raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(target))
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(target))
    if is_write_protected(target):
        raise OutputPlaceError(
            f"{target} cannot be written: it is write-protected; unprotect it, or choose "
            "another name"
        )
    return stat.S_IMODE(mode)


def _is_stream(path: Path) -> bool:
    """Check whether a path leads to a terminal, a pipe or another device."""
    with suppress(OSError, ValueError):
        mode = path.stat().st_mode
        opened = str(path).startswith(("/dev/std", "/dev/fd/", "/proc/"))
        return opened or not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))
    return False
