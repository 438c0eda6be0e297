"""Worn bodies of another run, with which a roll begins."""

from collections.abc import Mapping
from os import PathLike
from typing import Any

import numpy as np

from tractive_sam.contact import Worn
from tractive_sam.results import BODIES, PARTS, History, State
from tractive_sam.scene import Scene
from tractive_sam.store import ResultsError

SAME = ("body", "gap")
"""Tables of the scene in which the bodies must be the same, but for what only tells their wear."""

OF_WEAR = ("hardness", "density")


def worn_bodies(start: History | State, scene: Scene) -> Worn:
    """What a history or a contact left of both bodies.

    Parameters
    ----------
    start : History or State
        What was rolled before; of a history its last record that was solved.
    scene : Scene
        What is to be rolled, by the same bodies.

    Raises
    ------
    TypeError
        If `start` is neither.
    ResultsError
        If it is of other bodies, or does not tell what each of them lost.
    """
    if not isinstance(start, History | State):
        needed = "a History, as of roll or open_history, or a State, as of history.state"
        raise TypeError(f"start: {needed} is needed, not {type(start).__name__}")
    _check_same_bodies(start.scene, scene)
    if start.scene.has("wear") and not start.scene.schedule.revolves:
        raise ResultsError(
            "start: only whole revolutions wear bodies evenly along the track; give the results of "
            "a scene without [transient] and [process]"
        )
    worn = _of_state(start) if isinstance(start, State) else _of_history(start)
    if not np.isfinite(worn.depths).all():
        raise ResultsError("start: its wear is not known; roll its scene again")
    return worn


def told_of(start: History | State) -> str:
    """Where worn bodies are from, in a line."""
    scene = start.scene
    where = f"revolution {start.revolution}" if isinstance(start, State) else _last_of(start)
    named = f" of {scene.title!r}" if scene.title else ""
    told = f"{where}{named} (scene {scene.fingerprint()[:12]})"
    before = start.started if isinstance(start, History) else ""
    return f"{told}; that began with {before}" if before else told


def _last_of(history: History) -> str:
    row = _last_row(history)
    along = history.coordinate
    return f"{along.name} {history[along.name][row]:{along.format}}"


def _last_row(history: History) -> int:
    solved = np.flatnonzero(history["converged"] > 0.0)
    if not solved.size:
        raise ResultsError("start: the history holds no contact that was solved")
    return int(solved[-1])


def before(history: History) -> Worn | None:
    """The worn bodies with which a history itself began; None of new ones."""
    if not history.started:
        return None
    depths = np.stack([history[f"wear_profile_{body}"][0] for body in BODIES])
    return Worn(history.y, depths)


def started_as(history: History, path: str | PathLike, asked: str) -> Worn | None:
    """The worn bodies with which a file began that is to go on, the same as asked for.

    Raises
    ------
    ResultsError
        If others are asked for.
    """
    if asked not in ("", history.started):
        raise ResultsError(
            f"{path} began with {history.started or 'unworn bodies'}, and is to go on as if with "
            f"{asked}: resume it without a start, or give this run a file of its own"
        )
    return before(history)


def _of_history(history: History) -> Worn:
    row = _last_row(history)
    entering, leaving = (history[name][row] for name in ("entering_profile", "wear_profile"))
    began = before(history)
    new = np.zeros((2, history.y.size)) if began is None else began.depths
    turns = history.scene.turns
    if PARTS.name in history.columns:
        here = new + history[PARTS.name][row].sum(axis=0)
        passed = np.stack([history[f"wear_profile_{body}"][row] for body in BODIES]) - here
        lasting = np.array([turns.per_count[body] for body in BODIES])
        return Worn(history.y, here + lasting[:, None] * passed)
    since = (entering - new.sum(axis=0), leaving - new.sum(axis=0))
    return Worn(history.y, new + np.stack([turns.worn(body, *since) for body in BODIES]))


def _of_state(state: State) -> Worn:
    wear = state.scene.wear
    if wear is not None and not wear.together:
        raise ResultsError(
            "start: its bodies wear by laws of their own, and a contact does not tell how much "
            "each lost; give the history"
        )
    turns = state.scene.turns
    depths = [turns.worn(body, state.wear[-1], state.wear[0]) for body in BODIES]
    return Worn(state.grid.y, np.stack(depths))


def _check_same_bodies(before: Scene, now: Scene) -> None:
    there, here = (_bodies(scene) for scene in (before, now))
    differ = sorted(key for key in there.keys() | here.keys() if there.get(key) != here.get(key))
    if differ:
        told = ", ".join(f"{k}: {there.get(k)} there, {here.get(k)} now" for k in differ[:3])
        raise ResultsError(f"start: its bodies are others ({told}); give both scenes the same ones")


def _bodies(scene: Scene) -> dict[str, Any]:
    """What makes the bodies of a scene, by dotted key."""
    settings = {name: scene.settings().get(name, {}) for name in SAME}
    return {key: str(value) for key, value in _flat(settings) if key.split(".")[-1] not in OF_WEAR}


def _flat(table: Mapping[str, Any], above: str = ""):
    for name, value in table.items():
        key = f"{above}.{name}".lstrip(".")
        if isinstance(value, Mapping):
            yield from _flat(value, key)
        else:
            yield key, value
