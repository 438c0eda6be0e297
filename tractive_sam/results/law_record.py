"""Laws that replaced those of a scene, as a history and its file know them."""

import json
from collections.abc import Mapping
from dataclasses import dataclass

from tractive_sam.mechanics import Frame

UNNAMED = "laws"
"""Name of the only record of a file that was written before laws had fingerprints."""


@dataclass(frozen=True)
class LawRecord:
    """A law that replaced the one of the scene.

    Attributes
    ----------
    text : str
        Name and parameters of the law, for people.
    fingerprint : str
        Hash of its content (`mechanics.law`); empty where the file does not have it.
    frame : Frame, optional
        Of a friction law: coefficients and axes in which its tractions are measured.
    """

    text: str
    fingerprint: str = ""
    frame: Frame | None = None


def describe_laws(records: Mapping[str, LawRecord]) -> str:
    """Return the laws in one line, "friction=..., wear=..."; empty where none was replaced."""
    return ", ".join(
        one.text if name == UNNAMED else f"{name}={one.text}" for name, one in records.items()
    )


def dump_laws(records: Mapping[str, LawRecord]) -> str:
    """Return the laws as JSON."""
    return json.dumps(
        {
            name: {
                "text": one.text,
                "fingerprint": one.fingerprint,
                "frame": None if one.frame is None else [*one.frame.mu, one.frame.angle],
            }
            for name, one in records.items()
        }
    )


def load_laws(text: str, line: str = "") -> dict[str, LawRecord]:
    """Return the laws from JSON, or from their line alone where the JSON is empty.

    Raises
    ------
    ValueError
        If the JSON is not what `dump_laws` writes.
    """
    if not text:
        return {UNNAMED: LawRecord(line)} if line else {}
    try:
        return {
            str(name): LawRecord(str(one["text"]), str(one["fingerprint"]), _frame(one["frame"]))
            for name, one in json.loads(text).items()
        }
    except (AttributeError, KeyError, TypeError) as error:
        raise ValueError(f"laws: {error!r}") from None


def _frame(numbers: list[float] | None) -> Frame | None:
    if numbers is None:
        return None
    first, second, angle = map(float, numbers)
    return Frame((first, second), angle)
