"""The twin discs and their every-revolution run, shared by the benchmarks of wear."""

from pathlib import Path
from time import process_time

import numpy as np
import timing  # noqa: F401 - one thread, before anything is loaded

import tractive_sam as ts

SAVED = (0, 50, 250, 1000, 4000, 15000)
"""Revolutions that the paper shows."""

REFERENCES = Path(__file__).parent / "references"
"""Stored runs of every revolution, which take minutes to hours; they are continued if needed.

Delete them if the computation of the contact or of the slip changes.
"""

EVERY = 'wear.stepping="every-revolution"'
PAPER = (EVERY, 'solver.method="uzawa"', 'solver.slip="upwind"')
"""The exact scheme of the paper."""


def discs(revolutions: int, *settings: str, angle: float = 0.0) -> ts.Scene:
    """Return the scene `twin-discs` without stress."""
    saved = sorted({*(n for n in SAVED if n <= revolutions), revolutions})
    rolled = [f"wear.revolutions={revolutions}", f"wear.save={saved}"]
    scene = ts.Scene.builtin("twin-discs").replace(subsurface=None)
    return scene.with_set([f"friction.angle={angle}", *rolled, *settings])


def timed(scene: ts.Scene) -> tuple[ts.History, float]:
    """Return a history and its CPU seconds in this process, on one thread."""
    began = process_time()
    history = ts.roll(scene)
    assert history.finished, history.message
    return history, process_time() - began


def every_revolution(revolutions: int, angle: float = 0.0) -> ts.History:
    """Return the run of every revolution; it may have more revolutions than requested."""
    stored = stored_reference(angle)
    if stored is not None and stored["revolution"][-1] >= revolutions:
        return stored
    REFERENCES.mkdir(exist_ok=True)
    return ts.roll(discs(revolutions, EVERY, angle=angle), _path(angle), resume=True)


def stored_reference(angle: float) -> ts.History | None:
    """Return the stored run of every revolution, if there is one."""
    if not _path(angle).exists():
        return None
    stored = ts.open_history(_path(angle))
    return stored if stored.finished else None


def _path(angle: float) -> Path:
    return REFERENCES / f"twin-discs-{angle:g}.h5"


def errors(history: ts.History, reference: ts.History, revolution: int) -> dict[str, float]:
    """Return relative errors at a revolution that both this history and the reference recorded."""
    i, k = (int(np.flatnonzero(h["revolution"] == revolution)[0]) for h in (history, reference))
    errors_of_columns = {
        name: float(history[name][i] / reference[name][k] - 1)
        for name in ("wear_max", "Qx_over_P", "p_max", "p_95")
    }
    missed = history["wear_profile"][i] - reference["wear_profile"][k]
    return errors_of_columns | {"profile": float(np.abs(missed).max() / reference["wear_max"][k])}


def roughness(pressure: np.ndarray) -> float:
    """Return the relative ripple of the row loads inside the contact.

    It is the largest third difference: a rippled pressure changes from row to row, whereas a smooth
    pressure is a parabola over four rows.
    """
    carried = pressure.sum(axis=0)
    inside = np.flatnonzero(carried)[6:-6]
    return float(np.abs(np.diff(carried[inside], 3)).max() / carried[inside].mean())
