"""What can be wrong with a file, in words that name the file and the cure."""

from pathlib import Path


class ResultsError(Exception):
    """A results file that cannot be read or written.

    Examples
    --------
    >>> try:
    ...     ts.open_history("missing.h5")
    ... except ts.ResultsError as error:
    ...     print(error)
    missing.h5 does not exist; write it by tractive-sam run SCENE -o missing.h5
    """


class DamagedError(ResultsError):
    """A results file of which something is lost; to compute it again is the cure.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tractive_sam.store import DamagedError
    >>> Path("cut.h5").touch()
    >>> try:
    ...     ts.open_history("cut.h5")
    ... except DamagedError as error:
    ...     print(error)
    cut.h5 is not an HDF5 file; name a results file (.h5)
    """


class StorageError(ResultsError):
    """A file that could be written to begin with, and then no more: of a full disk, say.

    What was there before the last change is still there.
    """


class HeldError(ResultsError):
    """A file that another process is writing."""


class GapError(ValueError):
    """A file of a measured gap that cannot be used.

    Attributes
    ----------
    key : str
        The entry of the scene at fault.
    given : str
        What was found.
    allowed : str
        What is wanted.

    Examples
    --------
    >>> try:
    ...     ts.solve(scene.replace(gap=ts.Gap(file="missing.csv")))
    ... except (ts.GapError, ts.SceneError) as error:
    ...     print(error)
    1 fault in the scene:
      file: given 'missing.csv'; allowed: an existing file
    """

    def __init__(self, path: Path, given: str, allowed: str, table: str = "gap") -> None:
        self.key = f"{table}.file"
        allowed = allowed.replace("gap.", f"{table}.")
        self.given = f"{path}: {given}"
        self.allowed = allowed
        super().__init__(f"{self.key}: {self.given}; wanted: {allowed}")
        self._parts = path, given, allowed, table

    def of(self, table: str) -> "GapError":
        """The same of a file that another table of the scene names."""
        path, given, allowed, _ = self._parts
        return GapError(path, given, allowed, table)

    def __reduce__(self):
        """Pickle by its parts, so that it crosses between processes."""
        return GapError, self._parts
