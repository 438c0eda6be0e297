"""What a worker is handed, and what it hands back."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tractive_sam.results import BODIES, History
from tractive_sam.studies.case import Case

COMPLETE, FAILED, HELD = "complete", "failed", "held"


@dataclass(frozen=True)
class Task:
    """A case that is to be computed.

    Attributes
    ----------
    case : Case
        The case.
    file : Path or None
        Its results file; None where the study keeps scalars.
    seconds : float
        Time that it is expected to take; long ones go first.
    """

    case: Case
    file: Path | None
    seconds: float


@dataclass(frozen=True)
class Outcome:
    """What became of a case.

    Attributes
    ----------
    status : str
        `COMPLETE`, `FAILED`, or `HELD` by another process.
    message : str
        How it ended.
    row : mapping of str to number
        The last record, see `summary`.
    worker : str
        Machine and process.
    seconds : float
        Time it took on the worker.
    version : str
        Of this package, on the worker.
    note : str
        What else there is to say.
    traceback : str
        Where the worker failed.
    """

    status: str
    message: str
    row: dict[str, Any] = field(default_factory=dict)
    worker: str = ""
    seconds: float = 0.0
    version: str = ""
    note: str = ""
    traceback: str = ""


def summary(history: History, record: int = -1) -> dict[str, Any]:
    """A record of a history, the last by default, as plain numbers; of bodies as ``Name A``."""
    if not len(history):
        return {}
    row = {name: history[name][record].item() for name in history.of_dims()}
    for name, one in history.of_dims("body").items():
        for body in one.bodies(history.scene):
            row[f"{name} {body}"] = float(history[name][record, BODIES.index(body)])
    return row | history.totals
