"""Errors of results files and gap files; each message names the file and the remedy."""

from pathlib import Path


class ResultsError(Exception):
    """Error of a results file that cannot be read or written.

    Examples
    --------
    >>> try:
    ...     ts.open_history("missing.h5")
    ... except ts.ResultsError as error:
    ...     print(error)
    missing.h5 does not exist; write it by tractive-sam run SCENE -o missing.h5
    """


class DamagedError(ResultsError):
    """Error of a results file with lost data, which must be computed again.

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
    """Error of a file that can no longer be written, for example on a full disk.

    The content before the last change is unchanged.
    """


class FileInUseError(ResultsError):
    """Error raised at once if another process is writing the file."""


class GapError(ValueError):
    """Error of a gap file that cannot be used: key of the scene, fault, and required content.

    Attributes
    ----------
    key : str
        Key of the scene that names the file.
    value : str
        The fault in the file.
    allowed : str
        Required content of the file.

    Examples
    --------
    >>> try:
    ...     ts.solve(scene.replace(gap=ts.Gap(file="missing.csv")))
    ... except (ts.GapError, ts.SceneError) as error:
    ...     print(error)
    1 fault in the scene:
      file: given 'missing.csv'; allowed: an existing file, relative to ...
    """

    def __init__(self, path: Path, value: str, allowed: str, table: str = "gap") -> None:
        self.key = f"{table}.file"
        allowed = allowed.replace("gap.", f"{table}.")
        self.given = f"{path}: {value}"
        self.allowed = allowed
        super().__init__(f"{self.key}: {self.given}; wanted: {allowed}")
        self._parts = path, value, allowed, table

    def for_table(self, table: str) -> "GapError":
        """Return the error with the name of the table that names the file."""
        path, value, allowed, _ = self._parts
        return GapError(path, value, allowed, table)

    def __reduce__(self):
        """Pickle the arguments, so that the error can be passed between processes."""
        return GapError, self._parts
