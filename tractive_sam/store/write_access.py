"""Checks whether an output may be written, and gives one process the right to write it."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from glob import escape
from pathlib import Path

from tractive_sam.output_file import (
    TEMPORARY,
    OutputError,
    OutputPlaceError,
    check_folder,
    describe_os_error,
    hidden_path,
    is_write_protected,
    resolve_link,
    short_name,
)
from tractive_sam.store.errors import FileInUseError, ResultsError, StorageError
from tractive_sam.store.lock import hold_lock, is_locked


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
