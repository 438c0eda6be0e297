"""The task of a worker, and its outcome."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tractive_sam.results import BODIES, History
from tractive_sam.studies.case import Case

COMPLETE, FAILED, LOCKED = "complete", "failed", "locked"


@dataclass(frozen=True)
class Task:
    """Case to compute, with its results file and its estimated time.

    Attributes
    ----------
    case : Case
        The case.
    file : Path or None
        Results file of the case; None if the study keeps scalars.
    seconds : float
        Expected time; long cases are first.
    """

    case: Case
    file: Path | None
    seconds: float


@dataclass(frozen=True)
class CaseOutcome:
    """Outcome of a computed case: status, message, and values of its last record.

    Attributes
    ----------
    status : str
        `COMPLETE`, `FAILED`, or `LOCKED` by another process.
    message : str
        How it ended.
    row : mapping of str to number
        The last record, from `summary`.
    worker : str
        Machine and process.
    seconds : float
        Time it took on the worker.
    version : str
        Version of this package on the worker.
    note : str
        A note for the user.
    traceback : str
        Traceback of a failure.
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
    """Return a record's scalars, those of bodies as "name A", and the history's totals, by name."""
    if not len(history):
        return {}
    row = {name: history[name][record].item() for name in history.of_dims()}
    for name, quantity in history.of_dims("body").items():
        for body in quantity.bodies(history.scene):
            row[f"{name} {body}"] = float(history[name][record, BODIES.index(body)])
    return row | history.totals
