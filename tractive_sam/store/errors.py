"""What can be wrong with a file, in words that name the file and the cure."""

from pathlib import Path


class ResultsError(Exception):
    """A results file that cannot be read or written."""


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
    """

    def __init__(self, path: Path, given: str, allowed: str) -> None:
        self.key = "gap.file"
        self.given = f"{path}: {given}"
        self.allowed = allowed
        super().__init__(f"{self.key}: {self.given}; wanted: {allowed}")
