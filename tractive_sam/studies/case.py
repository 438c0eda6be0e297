"""The cases of a study, checked before the first is run, and the log of complete ones.

1a2b3c4d {"digest": "0123456789abcdef", "size": 0, "version": ..., "message": ..., "row": {...}}

The checksum is the CRC-32 of the text after the space, which detects every error of up to three
bits and every burst of up to 32. A line that does not agree with its checksum does not count: the
case is not complete. Lines of version 0.1 have no checksum; they count only before the first line
that has one.
"""

import hashlib
import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np

from tractive_sam import interrupt
from tractive_sam.description import format_setting
from tractive_sam.output_file import append_to_file, write_file
from tractive_sam.scene import Scene
from tractive_sam.schema import Fault, SceneError
from tractive_sam.store import FORMAT_VERSION, GapError, read_gap, versions
from tractive_sam.studies.design import Study, StudyError

DIGEST = 16
"""Hexadecimal digits of the hash of a scene."""


@dataclass(frozen=True)
class Case:
    """One case of a study: its number, the values that vary, and its scene.

    Attributes
    ----------
    number : int
        Index among all cases; the last dimension varies fastest.
    changes : mapping of str to object
        Values that vary, by dotted key.
    scene : Scene
        The scene.
    digest : str
        Hash of the scene without its title.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> from tractive_sam.studies import cases
    >>> study = ts.Study(scene="spheres", axis=[{"key": "friction.mu", "values": [0.2, 0.4]}])
    >>> case = cases(study)[1]
    >>> print(case)
    case 1 (friction.mu = 0.4)
    >>> case.scene.friction.mu
    (0.4, 0.4)
    """

    number: int
    changes: dict[str, Any]
    scene: Scene
    digest: str

    @property
    def name(self) -> str:
        """File name of the case without suffix: its number and the hash of its scene."""
        return f"{self.number:05d}-{self.digest}"

    def __str__(self) -> str:
        values = ", ".join(f"{k} = {format_setting(value)}" for k, value in self.changes.items())
        return f"case {self.number} ({values})"


def cases(study: Study) -> list[Case]:
    """Return all cases of a study; StudyError with the faults of all their scenes.

    Raises
    ------
    StudyError
        With the faults of all scenes that are not valid, each once.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> from tractive_sam.studies import cases
    >>> angles = {"key": "friction.angle", "values": [0, 45, 90]}
    >>> loads = {"key": "load.normal", "values": [100.0, 300.0]}
    >>> len(cases(ts.Study(scene="twin-discs", axis=[angles, loads])))
    6
    """
    listed: list[Case] = []
    faults: dict[tuple[str, str], list[tuple[Fault, Case]]] = {}
    seen: dict[str, Case] = {}
    base = study.scene.with_current_files(fix=True)
    for number, changes in enumerate(_changes(study)):
        interrupt.raise_if_interrupted()
        try:
            scene = base.replace(**changes).with_current_files(fix=True)
            for key, table in {"gap": scene.gap, **scene.schedule.profiles}.items():
                if table is not None and table.file is not None:
                    read_gap(table, key)
            case = Case(number, changes, scene, _digest(scene))
        except SceneError as error:
            case, new = Case(number, changes, study.scene, ""), list(error.faults)
        except GapError as error:
            case = Case(number, changes, study.scene, "")
            new = [Fault(error.key, error.given, error.allowed)]
        else:
            twin = seen.setdefault(case.digest, case)
            allowed = f"scenes that differ; {twin} is equal"
            new = [] if twin is case else [Fault("axis", "a scene twice", allowed)]
            listed.append(case)
        for fault in new:
            # Many cases share a fault: it is reported once, with their number.
            faults.setdefault((fault.key, fault.given), []).append((fault, case))
    if faults:
        raise StudyError(_merge_faults(same) for same in faults.values())
    return listed


def _changes(study: Study) -> Iterator[dict[str, Any]]:
    """Yield the values by key of every case."""
    dimensions = study.dimensions
    for index in np.ndindex(study.shape):
        places = zip(dimensions, index, strict=True)
        yield {key: value for dimension, k in places for key, value in dimension.at(k).items()}


def _merge_faults(same: list[tuple[Fault, Case]]) -> Fault:
    """Return the first of equal faults, with the number of cases that have it."""
    fault, case = same[0]
    where = f"in {case}" if len(same) == 1 else f"in {case} and {len(same) - 1} more"
    return replace(fault, given=f"{fault.given} {where}")


def _digest(scene: Scene) -> str:
    """Return a hash of a scene, of the files it names, and of the methods' version.

    Results of versions with different methods or files are never mixed.
    """
    return hashlib.sha256(f"{scene.fingerprint()} {_generation()}".encode()).hexdigest()[:DIGEST]


@cache
def _generation() -> str:
    """Return the text "major.minor format" of the package's methods and its results format."""
    first, second, *_ = (*versions()["tractive-sam"].split("."), "")
    return f"{first}.{second} {FORMAT_VERSION}"


def title_of(key: str) -> str:
    """Return the meaning and unit of a key of the scene, for titles."""
    title = Scene.find_field(key).title or key
    within, bracket, _ = key.rpartition("].")
    return f"{within}]: {title}" if bracket else title


@dataclass(frozen=True)
class LoggedCases:
    """Entries of the log of complete cases, and the number of damaged lines.

    Attributes
    ----------
    entries : mapping of str to mapping
        The last entry of each case, by the hash of its scene.
    damaged : int
        Number of lines that are damaged, or cut as a killed client leaves them.
    """

    entries: Mapping[str, Mapping[str, Any]]
    damaged: int

    @property
    def damage_note(self) -> str:
        """Note on damaged lines of the log; empty if there are none."""
        if not self.damaged:
            return ""
        lines = "1 line is" if self.damaged == 1 else f"{self.damaged} lines are"
        cure = "the cases that have no results file are computed again by tractive-sam study"
        return f"complete.jsonl: {lines} damaged or cut and not used; {cure}"


class CaseLog:
    """File that logs the complete cases of a study, line by line with checksums.

    Parameters
    ----------
    path : Path
        The file; it need not exist.
    """

    checked = re.compile(rb"([0-9a-f]{8}) (.*)", re.DOTALL)

    def __init__(self, path: Path) -> None:
        self.path = path

    def read(self) -> LoggedCases:
        """Return the last undamaged entry of each case, and the number of damaged lines."""
        lines = self._lines()
        entries = [entry for _, entry in lines if entry is not None]
        by_case = {entry["digest"]: entry for entry in entries}
        return LoggedCases(by_case, len(lines) - len(entries))

    def append(self, entry: Mapping[str, Any]) -> None:
        """Append an entry as a line with a checksum.

        Raises
        ------
        OutputError
            If the disk does not take it; the entries before remain.
        """
        text = json.dumps(entry).encode()
        # The end of line closes what a killed client may have left of its last line.
        append_to_file(self.path, b"\n%08x %b" % (crc32(text), text))

    def drop_damaged(self) -> None:
        """Rewrite the log without lines that are damaged or cut.

        Raises
        ------
        OutputError
            If the disk does not take the rest; nothing has changed then.
        """
        undamaged = [line for line, entry in self._lines() if entry is not None]
        write_file(self.path, b"".join(b"\n%b" % line for line in undamaged))

    def _lines(self) -> list[tuple[bytes, dict[str, Any] | None]]:
        """Return (line, entry) of each line of the log; the entry of a damaged line is None."""
        if not self.path.is_file():
            return []
        lines, checked_before = [], False
        for line in filter(None, self.path.read_bytes().split(b"\n")):
            checked = self.checked.fullmatch(line)
            entry = None
            if checked and int(checked[1], 16) == crc32(checked[2]):
                entry, checked_before = _entry(checked[2]), True
            elif not checked_before:
                entry = _entry(line)
            lines.append((line, entry))
        return lines


def _entry(text: bytes) -> dict[str, Any] | None:
    """Return the entry that a line contains; None if the line is damaged or cut."""
    try:
        entry = json.loads(text)
    except ValueError:
        return None
    match entry:
        case {
            "digest": str(),
            "size": int(),
            "version": str(),
            "message": str(),
            "row": dict(row),
        } if all(isinstance(value, int | float) for value in row.values()):
            return entry
    return None
