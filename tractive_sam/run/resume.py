"""The last step of a results file, or worn bodies of an earlier run, from which a roll begins."""

import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from os import PathLike
from typing import Any

import numpy as np

from tractive_sam.contact import Gap, Laws, Worn, choose_grid, describe_grid_entries, extend_to
from tractive_sam.results import (
    BODIES,
    PARTS,
    UNNAMED,
    History,
    LawRecord,
    Quantity,
    State,
    describe_laws,
)
from tractive_sam.rolling import Observer, Step, StoredStep, continuing_rows, process_type
from tractive_sam.scene import Scene, use_contents
from tractive_sam.schema import required
from tractive_sam.store import DamagedError, ResultsError, has_state, read_state


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
    if isinstance(start, State):
        where = f"revolution {start.revolution}"
    else:
        along = start.coordinate
        where = f"{along.name} {start[along.name][_last_row(start)]:{along.format}}"
    title = f" of {scene.title!r}" if scene.title else ""
    origin = f"{where}{title} (scene {scene.fingerprint()[:12]})"
    before = start.started if isinstance(start, History) else ""
    return f"{origin}; that began with {before}" if before else origin


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


FREE = (
    *("title", "solver", "grid", "load_history"),  # the blocks of a load history count
    *("wear.revolutions", "wear.save", "wear.stepping", "wear.tolerance", "wear.step_depth"),
    *("transient.save", "transient.step", "transient.stepping", "transient.tolerance"),
    *("transient.stage.step", "transient.stage.stepping", "transient.stage.tolerance"),
    *("process.end", "process.save"),
)
"""Entries of a scene that may change when it is resumed, without the indices of their tables."""


def last_step(
    history: History,
    path: str | PathLike,
    scene: Scene,
    laws: Laws | None = None,
    columns: Iterable[Quantity] = (),
    measured: Gap | None = None,
) -> tuple[Step, StoredStep] | None:
    """Return the step from which a results file resumes, and its arrays; None if there is none.

    Parameters
    ----------
    history : History
        Content of the file.
    path : path-like
        The file.
    scene : Scene
        The scene of the file; the entries `FREE` may differ, and the grid may be wider.
    laws : Laws, optional
        User-defined laws; they must equal the laws of the file.
    columns : iterable of Quantity
        User-defined columns, new ones or columns of the file.
    measured : Gap, optional
        The measured separation of the scene.

    Returns
    -------
    (Step, StoredStep) or None
        None if the file holds no record of a contact that was solved.

    Raises
    ------
    ResultsError
        If the file holds another scene, other laws, or a different column with one of the names, or
        is already rolled further.
    """
    if differences := describe_differences(history.scene, scene):
        raise ResultsError(
            f"{path} holds another scene ({differences}); resume with the scene of the file, or "
            "write this run to another file"
        )
    _check_laws(history, path, (laws or Laws.of(scene)).differences_from(scene))
    _check_columns(history, path, columns)
    rows = continuing_rows(history)
    if rows.size and not has_state(path, rows[-1]):
        rows = rows[:-1]
    if not rows.size:
        return None
    row, place = int(rows[-1]), history[history.coordinate.name]
    if place[row] > scene.schedule.end:
        along, key = history.coordinate.name, scene.schedule.end_key
        raise ResultsError(
            f"{path} is already rolled to {along} {place[row]:g}, beyond {key} = "
            f"{scene.schedule.end:g}: raise {key}, or write this run to another file"
        )
    stored = StoredStep(history, row, read_state(path, row))
    with report_damage(path, row):
        step = process_type(scene).restore(scene, stored)
    return _move_to_grid(scene, measured, step, path), stored


@contextmanager
def use_stored_files(history: History | None) -> Iterator[None]:
    """Within the block, let scenes use the content in a results file for files that are missing."""
    inputs = {} if history is None else history.scene.inputs
    stored = [content for _, content, _ in inputs.values() if content.is_stored]
    with use_contents(stored, only_missing=True):
        yield


@contextmanager
def report_damage(path: str | PathLike, row: int) -> Iterator[None]:
    """Within the block, turn missing parts of a record into a DamagedError.

    Raises
    ------
    DamagedError
        With the missing part.
    """
    try:
        yield
    except LookupError as error:
        raise DamagedError(
            f"{path} is damaged: {error.args[0]} of record {row} is missing or not valid; run its "
            "scene again"
        ) from None


def describe_differences(before: Scene, requested: Scene, free: Collection[str] = FREE) -> str:
    """List up to five differences of two scenes, except in entries that are free; may be ""."""
    # Number of differences of two scenes that a message lists.
    most_listed = 5
    stored, current, files = before.settings(), requested.settings(), requested.inputs
    keys = sorted(_differing_keys(stored, current, free), key=lambda key: (key not in files, key))
    # Other entries, as the radii of a wheel, follow from those that were given.
    entries = before.entries(), requested.entries()
    given = [key for key in keys if any(_find_entry(one, key) is not None for one in entries)]
    keys = given or keys
    history, is_block = requested.load_history, re.compile(r"duty\b").match
    made = [f"load_history.file: other blocks from {history.file}"] if history else []
    if made and any(map(is_block, keys)):
        keys = [key for key in keys if not is_block(key)]
    else:
        made = []
    listed = made + [_describe_difference(stored, current, key) for key in keys[:most_listed]]
    more = [f"and {len(keys) - most_listed} more"] if len(keys) > most_listed else []
    return "; ".join(listed + more)


def _check_laws(history: History, path: str | PathLike, laws: Mapping[str, LawRecord]) -> None:
    """Raise an error unless the laws of a run equal those of its results file."""
    stored, current = (
        {name: law.fingerprint for name, law in records.items()}
        for records in (history.law_records, laws)
    )
    line = describe_laws(laws)
    if stored == current or (UNNAMED in stored and history.laws == line):
        return
    alike = ", with different content," if history.laws == line else ""
    raise ResultsError(
        f"laws: {path} was computed with {history.laws or 'the laws of its scene'}, and is to be "
        f"resumed with {line or 'the laws of its scene'}{alike}: resume it with its laws, or "
        "write this run to another file"
    )


def check_measured(history: History, path: str | PathLike | None, measured: str) -> None:
    """Raise an error if the measured gap or a profile has changed since the file was written.

    Raises
    ------
    ResultsError
        If it has changed. Files of earlier versions do not record it and pass.
    """
    if history.measured and history.measured != measured:
        raise ResultsError(
            f"{path} was computed with another content of the file of [gap] or of "
            "[transient.profile]: restore that file to resume, or write this run to another file"
        )


def check_observers_in_file(
    history: History, path: str | PathLike, observers: Iterable[Observer]
) -> None:
    """Raise an error if a file lacks columns or fields of a user-defined observer.

    Raises
    ------
    ResultsError
        With the observer.
    """
    stored = {**history.columns, **history.user_fields}
    for observer in observers:
        quantities = (*observer.columns, *observer.fields)
        if not observer.key and any(quantity.name not in stored for quantity in quantities):
            raise ResultsError(
                f"{path} was computed without the observer {observer.name}: resume it without this "
                "observer, or write this run to another file"
            )


def _check_columns(history: History, path: str | PathLike, columns: Iterable[Quantity]) -> None:
    """Raise an error if a results file has another column of this name."""
    for column in columns:
        current = column.with_units_of(history.scene)
        if history.columns.get(column.name, current) != current:
            raise ResultsError(
                f"{path} has another column {column.name}, for example with a different unit: "
                "rename the new column"
            )


def _differing_keys(before: Any, after: Any, free: Collection[str], key: str = "") -> list[str]:
    """Return the dotted keys of entries that differ but must not, to resume; empty if none."""
    if re.sub(r"\[\d+\]", "", key) in free:
        return []
    if isinstance(before, dict) and isinstance(after, dict):
        return [
            differing
            for name in {**before, **after}
            for differing in _differing_keys(
                before.get(name), after.get(name), free, f"{key}.{name}".lstrip(".")
            )
        ]
    if _are_tables(before) and _are_tables(after) and len(before) == len(after):
        pairs = enumerate(zip(before, after, strict=True))
        return [
            differing
            for k, pair in pairs
            for differing in _differing_keys(*pair, free, f"{key}[{k}]")
        ]
    arrays = isinstance(before, np.ndarray) or isinstance(after, np.ndarray)
    contents: list[Any] = [getattr(value, "content", None) for value in (before, after)]
    if None not in contents:  # wherever the files are
        equal = contents[0].digest == contents[1].digest
    else:
        equal = np.array_equal(before, after) if arrays else before == after
    return [] if equal else [key]


def _describe_difference(stored: Any, current: Any, key: str) -> str:
    """Describe the two values of a key, or name the changed file if the path is equal."""
    before, now = (_find_entry(entries, key) for entries in (stored, current))
    if str(before) == str(now) and getattr(now, "content", None) is not None:
        changed = ", ".join(before.content.files_differing_from(now.content))
        return f"{key}: {changed} has changed, whose earlier content was computed"
    return f"{key}: {_format_entry(before)} there, {_format_entry(now)} now"


def _are_tables(value: Any) -> bool:
    """Return whether a value is a tuple that begins with a table (dict)."""
    return isinstance(value, tuple) and bool(value) and isinstance(value[0], dict)


def _find_entry(entries: dict[str, Any], key: str) -> Any:
    """Return the value of a dotted key; None if it is not set."""
    value: Any = entries
    for name in key.replace("[", ".").replace("]", "").split("."):
        value = value[int(name)] if isinstance(value, tuple) else (value or {}).get(name)
    return value


def _format_entry(value: Any) -> str:
    """Return a value as text: "nothing" for None, tables by their number."""
    if _are_tables(value):
        return f"{len(value)} tables"
    return "nothing" if value is None else str(value)


def _move_to_grid(scene: Scene, measured: Gap | None, last: Step, path: str | PathLike) -> Step:
    """Return a step moved to the [grid] that the scene has now, if it has one."""
    before = last.grid
    if scene.grid is None:
        return last
    if scene.grid.elements is None:
        half_x, half_y = (*required(scene.grid.half_length, "grid.half_length"), 0.5)[:2]
        wider = extend_to(before, (half_x, half_y))
        grid = replace(wider, centre=scene.grid.place)
    else:
        grid = choose_grid(scene, measured)
        if not scene.has_fixed_domain:  # it may have grown
            grid = extend_to(grid, before.half_length)
    if grid == before:
        return last
    try:
        return last.on(grid)
    except ValueError:
        half_length, (nx, ny) = before.half_length, before.elements
        raise ResultsError(
            f"{path} has {nx} x {ny} elements over +-{half_length[0]:g} x +-{half_length[1]:g} mm; "
            "a wider grid must keep the element size and add as many elements on each side: "
            f"{describe_grid_entries(extend_to(before, grid.half_length))}"
        ) from None
