"""Where a results file ends, and how to go on from there."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from os import PathLike
from typing import Any

import numpy as np

from tractive_sam.contact import Gap, Laws, Stepped, as_asked, choose_grid, reaching
from tractive_sam.results import (
    BODIES,
    PARTS,
    ROLLED,
    UNNAMED,
    Cost,
    History,
    LawRecord,
    Quantity,
    State,
    describe_laws,
)
from tractive_sam.rolling import Damage, Moment, Passage, ProfilePoint
from tractive_sam.scene import Scene
from tractive_sam.store import DamagedError, ResultsError, open_history, state_of

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
    "load_history",  # its blocks count
)
"""Entries of a scene that may change when it is rolled on."""


COURSE = ("entering_profile", "wear_per_revolution")
"""Profiles of the last two records that the stepping goes on from."""


def last_passage(
    history: History,
    path: str | PathLike,
    scene: Scene,
    laws: Laws | None = None,
    columns: Iterable[Quantity] = (),
    measured: Gap | None = None,
) -> Passage | Moment | None:
    """The last revolution of a results file, or moment of a transient, from which to roll on.

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
    Passage, Moment or None
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
    rows = _continuing(history)
    if not rows.size:
        return None
    row = int(rows[-1])
    if scene.transient is not None:
        return _on_grid_of(scene, measured, _last_moment(history, path, row, scene), path)
    revolution = int(history["revolution"][row])
    last = 0 if scene.wear is None else scene.wear.revolutions
    if revolution > last:
        raise ResultsError(
            f"{path} is rolled to revolution {revolution} already, wear.revolutions = {last}: "
            "ask for more, or give the run a file of its own"
        )
    _check_sound(history, path, row)
    contacts = _contacts(history, row, state_of(path, row), scene)
    course = tuple(
        ProfilePoint(
            int(history["revolution"][k]),
            history["entering_profile"][k],
            history["wear_per_revolution"][k],
        )
        for k in (row - 1, row)
        if k > 0  # the unworn bodies are not worn yet: the course begins with revolution 1
    )
    known = {"parts": _parts(history, row, scene), "weights": (1.0,) * len(contacts)}
    if scene.spectrum is not None and history[ROLLED.name][row] >= 0:
        rolled = int(history[ROLLED.name][row])
        known["weights"] = tuple(float(k == rolled) for k in range(len(contacts)))
    passage = Passage(revolution, contacts, 0, int(history["jump"][row]), course, **known)
    return _on_grid_of(scene, measured, passage, path)


def _continuing(history: History) -> np.ndarray:
    """Return the rows of the records from which rolling can continue, shape (n,)."""
    continues = history["converged"] > 0.0
    if "next_step" in history.columns:  # a record between two steps has none
        continues = continues & np.isfinite(history["next_step"])
    return np.flatnonzero(continues)


def _last_moment(history: History, path: str | PathLike, row: int, scene: Scene) -> Moment:
    """The moment of a record, and the contact a step before it."""
    state = state_of(path, row)
    names = "distance", "stretch", "next_step", "approach", "xi_x", "xi_y"
    found = {name: history[name] for name in names}
    contact = replace(history.contact(row, state), scene=scene, cost=Cost())
    stretch, before = int(found["stretch"][row]), None
    last = max((k for k in _continuing(history) if k < row), default=row)
    length = found["distance"][row] - found["distance"][last]
    if length:
        earlier = replace(
            contact,
            pressure=state.get("before_pressure", contact.pressure),
            traction=np.stack((state["before_x"], state["before_y"])),
            approach=float(found["approach"][last]),
            xi_x=found["xi_x"][last],
            xi_y=found["xi_y"][last],
        )
        before = Stepped(earlier)
    shifts = np.array([history[name][row] for name in ("shift_x", "shift_y", "turn")])
    none = np.zeros((2, *contact.grid.elements))
    worn = {"friction": float(np.nansum(history["step_friction"][: row + 1]))}
    if scene.wear is not None:
        if not {"worn", "gained"} <= state.keys():
            raise DamagedError(f"{path} is damaged: the wear of record {row} is missing")
        worn |= {"volumes": history["worn_volume"][row], "deepest": history["wear_max"][row]}
    stepped = Stepped(
        contact,
        energy=float(history["elastic_energy"][row]),
        worn=state.get("worn", none),
        gained=state.get("gained", none),
    )
    return Moment(
        float(found["distance"][row]),
        stretch,
        stepped,
        length,
        float(found["next_step"][row]),
        shifts,
        before,
        **worn,
    )


def last_damage(path: str | PathLike, passage: Passage) -> Damage | None:
    """What rolling had done to the material by the last passage of a results file.

    Raises
    ------
    DamagedError
        If the file does not hold it.
    """
    if passage.contact.scene.fatigue is None:
        return None
    history = open_history(path)
    row = int(np.flatnonzero(history["converged"])[-1])
    unknown = np.full((len(history), len(BODIES)), np.nan)  # without a limit
    initiation = history.values.get("initiation", unknown)[row]
    earlier = int(history["revolution"][max(row - 1, 0)])
    try:
        return Damage.restored(
            passage, state_of(path, row), dict(zip(BODIES, initiation, strict=True)), earlier
        )
    except LookupError as error:
        raise DamagedError(f"{path} is damaged: {error} of record {row} is missing") from None


def _contacts(
    history: History, row: int, fields: dict[str, np.ndarray], scene: Scene
) -> tuple[State, ...]:
    """The contacts of a record; of a duty cycle those of its different blocks."""
    spectrum = scene.spectrum
    if spectrum is None:
        return (replace(history.contact(row, fields), scene=scene, cost=Cost()),)
    first = [spectrum.places.index(k) for k in range(len(spectrum.scenes))]
    of_blocks = {k: {name: field[k] for name, field in fields.items()} for k in first}
    return tuple(
        replace(history.block(k).contact(row, of_blocks[k]), scene=one, cost=Cost())
        for k, one in zip(first, spectrum.scenes, strict=True)
    )


def _parts(history: History, row: int, scene: Scene) -> np.ndarray | None:
    """What each body lost in each of the different blocks, where that was recorded."""
    if PARTS.name not in history.columns:
        return None
    parts, spectrum = history[PARTS.name][row], scene.spectrum
    if spectrum is None:
        return parts
    together = np.zeros((len(spectrum.scenes), *parts.shape[1:]))
    np.add.at(together, list(spectrum.places), parts)
    return together


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


def _check_columns(history: History, path: str | PathLike, columns: Iterable[Quantity]) -> None:
    for one in columns:
        now = one.with_units_of(history.scene)
        if history.columns.get(one.name, now) != now:
            raise ResultsError(
                f"{path} has a column {one.name} that is another quantity (its unit, say): give "
                "this one another name"
            )


def _check_sound(history: History, path: str | PathLike, row: int) -> None:
    """See that a record is one from which rolling can go on."""
    needed = ("approach", "Qx", "Qy", "Mz", "xi_x", "xi_y", "spin", "work_supplied", "residual")
    profiles = [history[name][max(row - 1, 0) : row + 1] for name in COURSE]
    lost = [name for name in needed if not np.isfinite(history[name][row])]
    lost += [
        name for name, values in zip(COURSE, profiles, strict=True) if not np.isfinite(values).all()
    ]
    if not history["jump"][row] >= 1.0:  # "not" rather than "<": nan must fail, too
        lost.append("jump")
    if lost:
        raise DamagedError(
            f"{path} is damaged: {', '.join(lost)} of record {row} cannot be; run its scene again"
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


def _on_grid_of(
    scene: Scene, measured: Gap | None, last: Passage | Moment, path: str | PathLike
) -> Passage | Moment:
    """The passage or moment on the scene's [grid], if it gives one."""
    before = last.contact.grid.shifted(0.0)
    if scene.grid is None:
        return last
    if scene.grid.elements is None:
        grid = reaching(before, (*scene.grid.half_length, 0.5)[:2])
    else:
        grid = choose_grid(scene, measured)
        if not scene.bounded:  # it may have grown
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
