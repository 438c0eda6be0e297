"""Records of the laws that replaced laws of a scene, as a history and its file store them."""

import json
from collections.abc import Mapping
from dataclasses import dataclass

from tractive_sam.mechanics import Frame

UNNAMED = "laws"
"""Name of the only record of a file that was written before laws had fingerprints."""


@dataclass(frozen=True)
class LawRecord:
    """Name, hash and frame of a user-defined law that replaced the law of the scene.

    Attributes
    ----------
    text : str
        Name and parameters of the law, for readers.
    fingerprint : str
        Hash of its content (`mechanics.law`); empty if the file lacks it.
    frame : Frame, optional
        For a friction law: coefficients and axes in which its tractions are measured.
    """

    text: str
    fingerprint: str = ""
    frame: Frame | None = None


def describe_laws(records: Mapping[str, LawRecord]) -> str:
    """Return user-defined laws as text, "friction=..., wear=..."; empty if none was replaced."""
    return ", ".join(
        law.text if name == UNNAMED else f"{name}={law.text}" for name, law in records.items()
    )


def dump_laws(records: Mapping[str, LawRecord]) -> str:
    """Return records of user-defined laws as JSON."""
    return json.dumps(
        {
            name: {
                "text": law.text,
                "fingerprint": law.fingerprint,
                "frame": None if law.frame is None else [*law.frame.mu, law.frame.angle],
            }
            for name, law in records.items()
        }
    )


def load_laws(text: str, line: str = "") -> dict[str, LawRecord]:
    """Return records of user-defined laws from JSON; without JSON, from their line of text.

    Raises
    ------
    ValueError
        If the JSON is not what `dump_laws` writes.
    """
    if not text:
        return {UNNAMED: LawRecord(line)} if line else {}
    try:
        return {
            str(name): LawRecord(str(law["text"]), str(law["fingerprint"]), _frame(law["frame"]))
            for name, law in json.loads(text).items()
        }
    except (AttributeError, KeyError, TypeError) as error:
        raise ValueError(f"laws: {error!r}") from None


def _frame(numbers: list[float] | None) -> Frame | None:
    """Return a frame from its two coefficients and its angle; None if there are none."""
    if numbers is None:
        return None
    first, second, angle = map(float, numbers)
    return Frame((first, second), angle)
