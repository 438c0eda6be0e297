"""The log of complete cases, `complete.jsonl`: a checksum and the last record of a case per line.

    1a2b3c4d {"digest": "0123456789abcdef", "size": 0, "version": ..., "message": ..., "row": {...}}

The checksum is the CRC-32 of the text after the space, which detects every error of up to three
bits and every burst of up to 32. A line that does not agree with its checksum does not count: the
case is not complete. Lines of version 0.1 have no checksum; they count only before the first line
that has one.
"""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from zlib import crc32

from tractive_sam.output_file import append_to_file, write_file


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
