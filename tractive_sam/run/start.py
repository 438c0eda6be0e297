"""The worn bodies of an earlier run, from which a roll begins."""

from collections.abc import Mapping
from os import PathLike
from typing import Any

import numpy as np

from tractive_sam.contact import Worn
from tractive_sam.results import BODIES, PARTS, History, State
from tractive_sam.scene import Scene
from tractive_sam.store import ResultsError


def worn_bodies(start: History | State, scene: Scene) -> Worn:
    """Return both bodies' wear depths from a history or contact; raise if the bodies differ.

    Parameters
    ----------
    start : History or State
        Earlier results; of a history the last record that was solved.
    scene : Scene
        Scene to roll, with equal bodies.

    Raises
    ------
    TypeError
        If `start` is neither a History nor a State.
    ResultsError
        If its bodies differ, or it does not record what each of them lost.
    """
    if not isinstance(start, History | State):
        needed = "a History (from roll or open_history) or a State (from history.state)"
        raise TypeError(f"start: must be {needed}, not {type(start).__name__}")
    _check_same_bodies(start.scene, scene)
    if start.scene.has("wear") and not start.scene.schedule.revolves:
        raise ResultsError(
            "start: only full revolutions wear bodies evenly along the track; give the results of "
            "a scene without [transient] and [process]"
        )
    worn = _depths_from_state(start) if isinstance(start, State) else _depths_from_history(start)
    if not np.isfinite(worn.depths).all():
        raise ResultsError("start: its wear is not finite; roll its scene again")
    return worn


def describe_origin(start: History | State) -> str:
    """Describe in one line the history or contact from which worn bodies come."""
    scene = start.scene
    where = (
        f"revolution {start.revolution}"
        if isinstance(start, State)
        else _describe_last_record(start)
    )
    title = f" of {scene.title!r}" if scene.title else ""
    origin = f"{where}{title} (scene {scene.fingerprint()[:12]})"
    before = start.started if isinstance(start, History) else ""
    return f"{origin}; that began with {before}" if before else origin


def _describe_last_record(history: History) -> str:
    """Return the coordinate of the last solved record as text ("revolution 100")."""
    row = _last_row(history)
    along = history.coordinate
    return f"{along.name} {history[along.name][row]:{along.format}}"


def _last_row(history: History) -> int:
    """Return the row of the last solved record of a history; raise an error if there is none."""
    solved = np.flatnonzero(history["converged"] > 0.0)
    if not solved.size:
        raise ResultsError("start: the history holds no solved contact; give another one")
    return int(solved[-1])


def worn_bodies_before(history: History) -> Worn | None:
    """Return the worn bodies with which a history began; None if they were unworn."""
    if not history.started:
        return None
    depths = np.stack([history[f"wear_profile_{body}"][0] for body in BODIES])
    return Worn(history.y, depths)


def check_start_of_file(history: History, path: str | PathLike, origin: str) -> Worn | None:
    """Return the worn bodies with which a file began; raise an error if `origin` names others.

    Raises
    ------
    ResultsError
        If `origin` names others.
    """
    if origin not in ("", history.started):
        raise ResultsError(
            f"{path} began with {history.started or 'unworn bodies'}, but start is "
            f"{origin}: resume it without start, or write this run to another file"
        )
    return worn_bodies_before(history)


def _depths_from_history(history: History) -> Worn:
    """Return the wear depths of both bodies after the last solved record of a history."""
    row = _last_row(history)
    entering, leaving = (history[name][row] for name in ("entering_profile", "wear_profile"))
    began = worn_bodies_before(history)
    new = np.zeros((2, history.y.size)) if began is None else began.depths
    turns = history.scene.turns
    if PARTS.name in history.columns:
        here = new + history[PARTS.name][row].sum(axis=0)
        passed = np.stack([history[f"wear_profile_{body}"][row] for body in BODIES]) - here
        lasting = np.array([turns.per_count[body] for body in BODIES])
        return Worn(history.y, here + lasting[:, None] * passed)
    since = (entering - new.sum(axis=0), leaving - new.sum(axis=0))
    return Worn(history.y, new + np.stack([turns.mean_depth(body, *since) for body in BODIES]))


def _depths_from_state(state: State) -> Worn:
    """Return the wear depths of both bodies after the revolution of a contact."""
    wear = state.scene.wear
    if wear is not None and not wear.together:
        raise ResultsError(
            "start: its bodies wear by separate laws, and a contact does not record how much "
            "each of them lost; give the history"
        )
    turns = state.scene.turns
    depths = [turns.mean_depth(body, state.wear[-1], state.wear[0]) for body in BODIES]
    return Worn(state.grid.y, np.stack(depths))


def _check_same_bodies(before: Scene, requested: Scene) -> None:
    """Raise a ResultsError that lists entries if the bodies of two scenes differ."""
    stored, current = (_entries_of_bodies(scene) for scene in (before, requested))
    keys = stored.keys() | current.keys()
    differ = sorted(key for key in keys if stored.get(key) != current.get(key))
    if differ:
        listed = ", ".join(f"{k}: {stored.get(k)} there, {current.get(k)} now" for k in differ[:3])
        raise ResultsError(f"start: its bodies differ ({listed}); give both scenes equal bodies")


def _entries_of_bodies(scene: Scene) -> dict[str, Any]:
    """Return the entries of [body] and [gap] as text by key, except hardness and density."""
    of_wear = ("hardness", "density")
    # Tables of the scene in which the bodies must agree, except for entries of wear alone.
    same = ("body", "gap")
    settings = {name: scene.settings().get(name, {}) for name in same}
    return {
        key: _describe_entry(value)
        for key, value in _flatten(settings)
        if key.split(".")[-1] not in of_wear
    }


def _describe_entry(value: Any) -> str:
    """Return a value as text, with the hash of its content if it is a file."""
    content = getattr(value, "content", None)
    return str(value) if content is None else f"{value}, SHA-256 {content.digest[:12]}"


def _flatten(table: Mapping[str, Any], above: str = ""):
    """Yield (dotted key, value) of all entries of nested tables."""
    for name, value in table.items():
        key = f"{above}.{name}".lstrip(".")
        if isinstance(value, Mapping):
            yield from _flatten(value, key)
        else:
            yield key, value
