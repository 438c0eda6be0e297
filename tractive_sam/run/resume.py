"""Where a results file ends, and how to go on from there."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from os import PathLike
from typing import Any

import numpy as np

from tractive_sam.contact import Gap, Laws, as_asked, choose_grid, reaching
from tractive_sam.results import UNNAMED, History, LawRecord, Quantity, describe_laws
from tractive_sam.rolling import Observer, Step, StoredStep, continuing_rows, process_type
from tractive_sam.scene import Scene
from tractive_sam.store import DamagedError, ResultsError, read_state

MOST_TOLD = 5
"""Differences of two scenes that are told one by one."""

FREE = (
    "title",
    "wear.revolutions",
    "wear.save",
    "wear.stepping",
    "wear.tolerance",
    "transient.save",
    "transient.step",
    "transient.stepping",
    "transient.tolerance",
    "solver",
    "grid",
    "process.end",
    "process.save",
    "load_history",  # its blocks count
)
"""Entries of a scene that may change when it is rolled on."""


def last_step(
    history: History,
    path: str | PathLike,
    scene: Scene,
    laws: Laws | None = None,
    columns: Iterable[Quantity] = (),
    measured: Gap | None = None,
) -> tuple[Step, StoredStep] | None:
    """Return the last step of a results file from which to continue, and what is stored of it.

    Parameters
    ----------
    history : History
        What the file holds.
    path : path-like
        The file.
    scene : Scene
        The scene of the file; the entries `FREE` may differ, a grid only in being wider.
    laws : Laws, optional
        Laws in place of the scene's, those of the file.
    columns : iterable of Quantity
        Columns beside the package's, new ones or those of the file.
    measured : Gap, optional
        The measured separation of the scene.

    Returns
    -------
    (Step, StoredStep) or None
        None if the file holds no record of a contact that was solved.

    Raises
    ------
    ResultsError
        If the file holds another scene, other laws or another column of a name, or was rolled
        further.
    """
    _check_same(history, path, scene)
    _check_laws(history, path, (laws or Laws.of(scene)).differences_from(scene))
    _check_columns(history, path, columns)
    rows = continuing_rows(history)
    if not rows.size:
        return None
    row, place = int(rows[-1]), history[history.coordinate.name]
    if place[row] > scene.schedule.end:
        along, key = history.coordinate.name, scene.schedule.end_key
        raise ResultsError(
            f"{path} is rolled to {along} {place[row]:g} already, {key} = "
            f"{scene.schedule.end:g}: ask for more, or give the run a file of its own"
        )
    stored = StoredStep(history, row, read_state(path, row))
    with damaged(path, row):
        step = process_type(scene).restore(scene, stored)
    return _on_grid_of(scene, measured, step, path), stored


@contextmanager
def damaged(path: str | PathLike, row: int) -> Iterator[None]:
    """Raise a DamagedError where something of a record is missing.

    Raises
    ------
    DamagedError
        With what is missing.
    """
    try:
        yield
    except LookupError as error:
        raise DamagedError(
            f"{path} is damaged: {error.args[0]} of record {row} is missing or cannot be; run its "
            "scene again"
        ) from None


def what_differs(before: Scene, now: Scene) -> str:
    """What makes two scenes different ones, as far as resuming goes; empty for the same one."""
    there, here = before.settings(), now.settings()
    differ = sorted(_differing(there, here))
    told = [f"{k}: {_shown(there, k)} there, {_shown(here, k)} now" for k in differ[:MOST_TOLD]]
    more = [f"and {len(differ) - MOST_TOLD} more"] if len(differ) > MOST_TOLD else []
    return "; ".join(told + more)


def _check_same(history: History, path: str | PathLike, scene: Scene) -> None:
    if told := what_differs(history.scene, scene):
        raise ResultsError(
            f"{path} holds another scene ({told}); resume with the same one, or give this one a "
            "file of its own"
        )


def _check_laws(history: History, path: str | PathLike, laws: Mapping[str, LawRecord]) -> None:
    """Raise where the laws of a file are not those to resume with, by their content."""
    before, now = (
        {name: one.fingerprint for name, one in records.items()}
        for records in (history.law_records, laws)
    )
    line = describe_laws(laws)
    if before == now or (UNNAMED in before and history.laws == line):
        return
    alike = ", of other content," if history.laws == line else ""
    raise ResultsError(
        f"laws: {path} was computed with {history.laws or 'the laws of its scene'}, and is to be "
        f"resumed with {line or 'those of its scene'}{alike}: resume it with the same laws, or "
        "write this run to another file"
    )


def check_measured(history: History, path: str | PathLike | None, measured: str) -> None:
    """Raise where the measured gap or a profile is not that of the file any more.

    Raises
    ------
    ResultsError
        If so. Files that were written before do not tell.
    """
    if history.measured and history.measured != measured:
        raise ResultsError(
            f"{path} was computed with another content of the file of [gap] or of "
            "[transient.profile]: bring that back to resume it, or give this run a file of its own"
        )


def check_observed(history: History, path: str | PathLike, observers: Iterable[Observer]) -> None:
    """Raise where a file was written without an observer that is to resume from it.

    Raises
    ------
    ResultsError
        With the observer.
    """
    known = {**history.columns, **history.own_fields}
    for one in observers:
        if not one.key and any(own.name not in known for own in (*one.columns, *one.fields)):
            raise ResultsError(
                f"{path} was computed without the observer {one.name}: resume it without this "
                "observer, or write this run to another file"
            )


def _check_columns(history: History, path: str | PathLike, columns: Iterable[Quantity]) -> None:
    for one in columns:
        now = one.with_units_of(history.scene)
        if history.columns.get(one.name, now) != now:
            raise ResultsError(
                f"{path} has a column {one.name} that is another quantity (its unit, say): give "
                "this one another name"
            )


def _differing(before: Any, now: Any, key: str = "") -> list[str]:
    """Dotted keys of the entries that differ and may not."""
    if key in FREE or _same(before, now):
        return []
    if isinstance(before, dict) and isinstance(now, dict):
        return [
            found
            for name in {**before, **now}
            for found in _differing(before.get(name), now.get(name), f"{key}.{name}".lstrip("."))
        ]
    if _are_tables(before) and _are_tables(now) and len(before) == len(now):
        pairs = enumerate(zip(before, now, strict=True))
        return [found for k, pair in pairs for found in _differing(*pair, f"{key}[{k}]")]
    return [key]


def _are_tables(value: Any) -> bool:
    return isinstance(value, tuple) and bool(value) and isinstance(value[0], dict)


def _same(before: Any, now: Any) -> bool:
    if isinstance(before, np.ndarray) or isinstance(now, np.ndarray):
        return np.array_equal(before, now)
    if isinstance(before, dict) and isinstance(now, dict):
        return before.keys() == now.keys() and all(_same(before[k], now[k]) for k in before)
    return before == now


def _shown(entries: dict[str, Any], key: str) -> str:
    value: Any = entries
    for name in key.replace("[", ".").replace("]", "").split("."):
        value = value[int(name)] if isinstance(value, tuple) else (value or {}).get(name)
    if _are_tables(value):
        return f"{len(value)} tables"
    return "nothing" if value is None else str(value)


def _on_grid_of(scene: Scene, measured: Gap | None, last: Step, path: str | PathLike) -> Step:
    """The step on the scene's [grid], if it gives one."""
    before = last.contact.grid.shifted(0.0)
    if scene.grid is None:
        return last
    if scene.grid.elements is None:
        wider = reaching(before, (*scene.grid.half_length, 0.5)[:2])
        grid = replace(wider, centre=scene.grid.place)
    else:
        grid = choose_grid(scene, measured)
        if not scene.has_fixed_domain:  # it may have grown
            grid = reaching(grid, before.half_length)
    if grid == before:
        return last
    try:
        return last.on(grid)
    except ValueError:
        half_length, (nx, ny) = before.half_length, before.elements
        raise ResultsError(
            f"{path} has {nx} x {ny} elements over +-{half_length[0]:g} x +-{half_length[1]:g} mm; "
            "a wider grid must have the same elements, as many more on either side: "
            f"{as_asked(reaching(before, grid.half_length))}"
        ) from None
