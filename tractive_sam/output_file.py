"""Atomic output: this module writes every file of the package completely or leaves it unchanged.

The content goes to a temporary file with a unique name in the folder of the output. The temporary
file replaces the output once it is on disk. After any earlier failure the output is unchanged and
the temporary file is removed.
"""

import errno
import hashlib
import os
import re
import stat
import warnings
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from uuid import uuid4

from tractive_sam.interrupt import protect_cleanup, raise_if_interrupted

TEMPORARY = ".new"
"""Suffix of temporary files."""


class OutputError(OSError):
    """Error: an output cannot be written; an earlier file is unchanged.

    Examples
    --------
    >>> try:
    ...     ts.report(history, "missing-folder/discs.html")
    ... except OSError as error:
    ...     print(error)
    missing-folder/discs.html cannot be written: the folder does not exist; create it, or choose another
    """  # noqa: E501 - as it is printed


class OutputPlaceError(OutputError):
    """Error: the name or folder of an output cannot be used; nothing was written."""


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
        """Write all of the data at a position of the file, in bytes.

        Raises
        ------
        OutputError
            If the system does not take them.
        """
        with _report_failure(self.output):
            os.lseek(self._descriptor, position, os.SEEK_SET)
            remaining = memoryview(data).cast("B")
            while remaining:
                remaining = remaining[os.write(self._descriptor, remaining) :]

    def read(self, size: int, position: int) -> bytes:
        """Return at most `size` bytes from a position of the file; fewer at its end."""
        os.lseek(self._descriptor, position, os.SEEK_SET)
        parts: list[bytes] = []
        while size and (part := os.read(self._descriptor, size)):
            parts.append(part)
            size -= len(part)
        return b"".join(parts)

    def truncate(self, size: int) -> None:
        """Set the length of the file, in bytes; raises an OutputError as `write` does."""
        with _report_failure(self.output):
            os.ftruncate(self._descriptor, size)

    def copy(self, source: Path, block: int = 2**24) -> int:
        """Write the content of another file into this one, and return its size in bytes."""
        position = 0
        with _report_failure(self.output), source.open("rb") as file:
            while data := file.read(block):
                self.write(data, position)
                position += len(data)
        return position


@contextmanager
def replace_file(path: Path, *, exclusive: bool = False) -> Iterator[OutputFile]:
    """Yield a temporary file that replaces `path` when the block ends without an error.

    It gets the permissions of the file that it replaces, or the default permissions. If the block
    raises an exception, nothing changes. Symbolic links are resolved.

    Parameters
    ----------
    path : Path
        The output.
    exclusive : bool
        Whether to refuse to replace a file.

    Raises
    ------
    OutputPlaceError
        If the folder does not exist or cannot be written into, or the file may not be replaced.
    OutputError
        If the system does not take the content.
    """
    with protect_cleanup(), _open_replacement(path, exclusive) as file:
        yield file


@contextmanager
def _open_replacement(path: Path, exclusive: bool) -> Iterator[OutputFile]:
    """Yield a temporary file that replaces the output at the end; see `replace_file`."""
    with _report_failure(path, OutputPlaceError):
        target = resolve_link(path)
        mode = _permissions(target, exclusive)
        temporary = temporary_path(target)
        flags = os.O_RDWR | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
        # Never readable by more users than the file that it replaces.
        descriptor = os.open(temporary, flags, 0o666 if mode is None else 0o600)
    try:
        try:
            if mode is not None:
                with _report_failure(path):
                    temporary.chmod(mode)
            yield OutputFile(path, descriptor)
            with _report_failure(path):
                os.fsync(descriptor)  # the content before the name, in case the machine fails
        except BaseException:
            with suppress(OSError):
                os.close(descriptor)
            raise
        with _report_failure(path):
            os.close(descriptor)
            if exclusive:
                _permissions(target, exclusive)
            temporary.replace(target)
    finally:
        with suppress(OSError):
            temporary.unlink()


def write_file(
    path: str | os.PathLike[str], content: str | bytes | memoryview, *, exclusive: bool = False
) -> Path:
    """Write text (as UTF-8) or bytes to a file, completely or not at all, and return its path.

    A terminal, a pipe or another device is written to directly.
    """
    raise_if_interrupted()
    path = Path(path)
    data = content.encode() if isinstance(content, str) else content
    if _is_stream(path):
        with _report_failure(path), path.open("wb") as stream:
            stream.write(data)
        return path
    with replace_file(path, exclusive=exclusive) as file:
        file.write(data, 0)
    return path


def write_table(path: str | os.PathLike[str], columns: Mapping[str, Iterable[float]]) -> Path:
    """Write columns of numbers as CSV with their names, completely or not at all."""
    rows = zip(*columns.values(), strict=True)
    lines = [",".join(columns), *(",".join(f"{value:.18e}" for value in row) for row in rows)]
    return write_file(path, "\n".join(lines) + "\n")


def append_to_file(path: Path, data: bytes) -> None:
    """Append bytes to a file, in one write if possible; create the file if it does not exist.

    If the disk becomes full, a part of the data may remain: readers must recognize it.

    Raises
    ------
    OutputError
        If the system does not take the data.
    """
    with _report_failure(path), path.open("ab", buffering=0) as file:
        remaining = memoryview(data)
        while remaining:
            remaining = remaining[file.write(remaining) :]


def make_folder(path: str | os.PathLike[str]) -> Path:
    """Create a folder for outputs, with its parents, unless it exists; return its path.

    Raises
    ------
    OutputPlaceError
        If it cannot be created.
    """
    path = Path(path)
    with _report_failure(path, OutputPlaceError):
        path.mkdir(parents=True, exist_ok=True)
    return path


def check_folder(path: Path) -> None:
    """Raise an error if no temporary file can be created in the folder of a path."""
    with _report_failure(path, OutputPlaceError):
        temporary = temporary_path(path)
        try:
            temporary.touch()
        finally:
            with suppress(OSError):
                temporary.unlink()


def resolve_link(path: Path) -> Path:
    """Return the target of a symbolic link, or else the path itself; an error for circular links.

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


def hidden_path(path: Path, suffix: str) -> Path:
    """Return the path of a hidden file next to a file: "." + name + suffix."""
    return path.with_name(f".{short_name(path)}{suffix}")


def short_name(path: Path, longest: int = 180) -> str:
    """Return the name of a file, or a hash of the name if it is longer than `longest` bytes.

    Parameters
    ----------
    path : Path
        The file.
    longest : int
        Largest length in bytes; systems allow 255.
    """
    encoded = os.fsencode(path.name)
    return path.name if len(encoded) <= longest else hashlib.sha256(encoded).hexdigest()


def temporary_path(path: Path) -> Path:
    """Return a unique path for a temporary file in the folder of a file."""
    return hidden_path(path, f".{uuid4().hex[:12]}{TEMPORARY}")


def is_write_protected(path: Path) -> bool:
    """Return whether a file is read-only, also by its mode alone, which root could ignore."""
    by_mode = path.stat().st_mode & (stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH)
    return not by_mode or not os.access(path, os.W_OK)


def is_disk_failure(error: Exception) -> bool:
    """Return whether an error means a full or failing disk, rather than an unsuitable path."""
    return getattr(error, "errno", None) in (errno.ENOSPC, errno.EDQUOT, errno.EIO)


def describe_os_error(error: Exception) -> str:
    """Return the cause and cure of a system error as text, also of one that HDF5 reports."""
    # Cause and remedy of each error of the operating system, by error number.
    cures = {
        errno.ENOSPC: "the disk is full; make room, or choose another",
        errno.EDQUOT: "your share of the disk is used up; make room, or choose another",
        errno.EFBIG: "it is larger than files may be here; raise the limit (ulimit -f)",
        errno.EACCES: "permission denied; request it, or choose another folder",
        errno.EPERM: "permission denied; request it, or choose another folder",
        errno.EROFS: "the disk is read-only; choose another",
        errno.ENAMETOOLONG: "the name is too long; choose a shorter one",
        errno.ELOOP: "it is a link that leads in a circle; remove it, or choose another name",
        errno.EIO: "the disk fails; choose another",
        errno.ENOENT: "the folder does not exist; create it, or choose another",
        errno.ENOTDIR: "its folder is a file; choose another",
        errno.EISDIR: "it is a folder; choose another name",
        errno.EEXIST: "it exists already; rename or remove it, or choose another name",
    }
    hdf5_number = re.search(r"errno = (\d+)", str(error))
    number = int(hdf5_number[1]) if hdf5_number else getattr(error, "errno", None)
    return (
        cures.get(number or 0) or getattr(error, "strerror", None) or str(error).partition("\n")[0]
    )


@contextmanager
def _report_failure(path: Path, kind: type[OutputError] = OutputError) -> Iterator[None]:
    """Raise system errors of the block as an OutputError of class `kind` that states the cause."""
    try:
        yield
    except OutputError:
        raise
    except (OSError, ValueError) as error:  # ValueError: a name with a null character
        if is_disk_failure(error):
            kind = OutputError
        raise kind(f"{path} cannot be written: {describe_os_error(error)}") from error


def _permissions(target: Path, exclusive: bool) -> int | None:
    """Return the permissions of a file to be replaced, or None; an error if it must not be."""
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
    """Return whether a path is a terminal, a pipe or another device."""
    with suppress(OSError, ValueError):
        mode = path.stat().st_mode
        opened = str(path).startswith(("/dev/std", "/dev/fd/", "/proc/"))
        return opened or not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))
    return False


@contextmanager
def omit_failing_figure(name: str) -> Iterator[None]:
    """Warn that a figure is omitted if the block cannot draw it: the results do not depend on it.

    System errors, such as a full disk, and a lack of memory are raised.
    """
    try:
        yield
    except (OSError, MemoryError):
        raise
    except Exception as error:
        warnings.warn(f"the figure {name} is omitted: {error}", stacklevel=3)
