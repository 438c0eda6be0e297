"""Whether a file may be written where it is wanted."""

from collections.abc import Callable
from pathlib import Path

from tractive_sam.store.errors import ResultsError


def make_room(path: Path, overwrite: bool, check_kind: Callable[[Path], None]) -> None:
    """See that a file can be written.

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
        If there is no such folder, or a file that may not be replaced.
    """
    if not path.parent.is_dir():
        raise ResultsError(f"{path.parent} is not a folder; create it, or choose another")
    if not path.exists():
        return
    if not overwrite:
        raise ResultsError(
            f"{path} exists already; choose another name, or replace it with overwrite=True"
        )
    try:
        check_kind(path)
    except ResultsError as error:
        cure = "choose another name, or remove it"
        raise ResultsError(f"{path} would be overwritten, but {error}; {cure}") from error
