"""The place on the disk where a file is to be: whether it may be written, and by whom."""

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
from tractive_sam.store.errors import HeldError, ResultsError, StorageError
from tractive_sam.store.lock import is_locked, locked


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
        except OSError as error:
            raise StorageError(f"{path} cannot be written: {describe_os_error(error)}") from error
        # Nobody else works on copies now: those there are were left behind by killed processes.
        target = real(path)
        for copy in target.parent.glob(f".{escape(short_name(target))}.*{TEMPORARY}"):
            with suppress(OSError):
                copy.unlink()
        yield


def is_written(path: Path) -> bool:
    """Whether some process is the writer of a file."""
    return is_locked(lock_of(path))


def lock_of(path: Path) -> Path:
    """The lock of a file."""
    return hidden_path(real(path), ".lock")


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
        check_folder(real(path))
    except OutputPlaceError as error:
        raise ResultsError(str(error)) from error
    except OutputError as error:
        raise StorageError(str(error)) from error
    except OSError as error:
        raise ResultsError(f"{path} cannot be written: {describe_os_error(error)}") from error


def real(path: Path) -> Path:
    """What a link points to, or the path itself.

    Raises
    ------
    ResultsError
        If it leads in a circle.
    """
    try:
        return resolve_link(path)
    except OutputPlaceError as error:
        raise ResultsError(str(error)) from None


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
    if is_write_protected(path):
        raise ResultsError(f"{path} is write-protected; unprotect it, or choose another name")
