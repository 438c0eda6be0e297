"""Change the tables of a scene by dotted key, also keys that exclude each other."""

from collections.abc import Iterable, Mapping
from typing import Any

from tractive_sam.schema import (
    Fault,
    SceneError,
    copy_tables,
    remove_key,
    set_key,
    shorten,
    split_key,
    toml,
)

from .wear import BY_COEFFICIENT

_ALTERNATIVES: tuple[tuple[tuple[str, ...], ...], ...] = (
    (("body.A.young",), ("body.A.shear",)),
    (("body.B.young",), ("body.B.shear",)),
    (("load.normal",), ("load.approach",), ("load.pressure",)),
    (("load.force_x",), ("creepage.longitudinal",)),
    (("load.force_y",), ("creepage.lateral",)),
    (("friction.mu",), ("friction.static",)),
    (("friction.kinetic", "friction.half_speed"), ("friction.A", "friction.B")),
    (("gap.file",), ("gap.x", "gap.y", "gap.separation")),
    (("fatigue.shear_yield",), ("fatigue.yield_strength",)),
    (("wear.intensity",), ("wear.coefficient", "wear.coefficient.A", "wear.coefficient.B")),
    (
        ("accuracy", "accuracy.tolerance", "accuracy.elements"),
        ("grid", "grid.half_length", "grid.elements"),
    ),
)
"""Groups of keys: a key of one group of a line excludes all keys of the other groups."""


def excluded_keys(key: str) -> tuple[str, ...]:
    """Return the keys that a scene cannot have beside a key, as they are alternatives to it."""
    excluded = tuple(
        alternative
        for groups in _ALTERNATIVES
        if any(key in group for group in groups)
        for group in groups
        if key not in group
        for alternative in group
    )
    if key in ("wear.coefficient.A", "wear.coefficient.B"):  # they give the shares in the wear
        return (*excluded, "body.A.hardness", "body.B.hardness")
    return excluded


def parse_settings(settings: Iterable[str]) -> dict[str, Any]:
    """Return values by dotted key from texts "table.key=value"; values are written as in TOML.

    Raises
    ------
    SceneError
        With a fault for each setting of another form.
    """
    pairs = [(text, *text.partition("=")) for text in settings]
    faults = [
        Fault(shorten(text), "a setting without key or value", "table.key=value")
        for text, key, equals, _ in pairs
        if not (equals and key.strip())
    ]
    if faults:
        raise SceneError(faults)
    return {key.strip(): toml.parse_value(value.strip()) for _, key, _, value in pairs}


def override(tables: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return tables changed by values at dotted keys; alternatives of a new key are removed.

    Parameters
    ----------
    tables : mapping
        Nested tables; they are not changed.
    changes : mapping
        New values by dotted key, as ``load.normal`` or ``duty[0].load.normal``. Missing tables are
        added; None removes an entry. Setting one of two alternatives (young/shear, normal/approach,
        creepage/force, gap file/arrays, load history/blocks) removes the other, unless it is set as
        well. A wear law removes the coefficients of another law. Values of `wear.save` above a new
        `wear.revolutions` are removed, and the last revolution is added.

    Raises
    ------
    SceneError
        If a key leads through an entry that is not a table, or to a place that a list does not
        have.
    """
    result = copy_tables(tables)
    faults = [fault for key, value in changes.items() for fault in set_key(result, key, value)]
    if faults:
        raise SceneError(faults)
    for key, value in changes.items():
        block, bracket, entry = key.rpartition("].")
        for alternative in excluded_keys(entry) if value is not None else ():
            rival = f"{block}{bracket}{alternative}"
            if not any(f"{change}.".startswith(f"{rival}.") for change in changes):
                remove_key(result, rival)
    changed = {split_key(change)[0] for change in changes}
    for key, alternative in (("load_history", "duty"), ("duty", "load_history")):
        if key in changed and alternative not in changed:
            remove_key(result, alternative)
    if changes.get("wear.law", "archard") not in BY_COEFFICIENT:
        for key in ("wear.intensity", "wear.coefficient"):
            if not any(f"{change}.".startswith(f"{key}.") for change in changes):
                remove_key(result, key)
    if "wear.revolutions" in changes and "wear.save" not in changes:
        _shorten_save(result)
    return result


def _shorten_save(tables: dict[str, Any]) -> None:
    """End the stored revolutions in a scene's tables with the last revolution, in place."""
    match tables:
        case {"wear": {"revolutions": last, "save": (list() | tuple()) as save} as wear}:
            # The checks of the scene report values that are not integers.
            are_integers = all(type(n) is int for n in (last, *save))
            if are_integers and 1 <= last < max(save, default=0):
                wear["save"] = sorted({n for n in save if n < last} | {last})
