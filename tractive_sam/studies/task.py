"""What a worker is handed."""

from dataclasses import dataclass
from pathlib import Path

from tractive_sam.studies.case import Case


@dataclass(frozen=True)
class Task:
    """A case that is to be computed.

    Attributes
    ----------
    case : Case
        The case.
    file : Path
        Its results file.
    seconds : float
        Time that it is expected to take; long ones go first.
    """

    case: Case
    file: Path
    seconds: float
