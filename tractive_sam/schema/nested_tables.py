"""Change nested tables by dotted key."""

from collections.abc import Mapping
from typing import Any

from .faults import Fault, shorten
from .keys import join_key, split_key


def copy_tables(value: Any) -> Any:
    """Return a copy of nested tables and their lists; the values within are shared."""
    if isinstance(value, Mapping):
        return {key: copy_tables(item) for key, item in value.items()}
    if isinstance(value, list | tuple) and any(isinstance(item, Mapping) for item in value):
        return [copy_tables(item) for item in value]
    return value


def set_key(tables: dict[str, Any], key: str, value: Any) -> list[Fault]:
    """Set a value by dotted key in nested tables, in place; return faults of the key.

    Returns
    -------
    list of Fault
        The fault of a key that leads through an entry that is no table, or to a place that a list
        does not have; otherwise empty.
    """
    inner: Any = tables
    path = split_key(key)
    for depth, name in enumerate(path):
        allowed = _allowed_within(inner, name, join_key(path[:depth]))
        if allowed:
            return [Fault(key, shorten(value), allowed)]
        if depth < len(path) - 1:
            inner = inner[name] if isinstance(name, int) else inner.setdefault(name, {})
    inner[name] = copy_tables(value)
    return []


def _allowed_within(inner: Any, name: str | int, outer: str) -> str:
    """Describe what is allowed instead of an index or name; empty if an entry can have it."""
    if isinstance(inner, list):
        within = isinstance(name, int) and name < len(inner)
        return "" if within else f"a place in the list: {outer}[0] to {outer}[{len(inner) - 1}]"
    if not isinstance(inner, dict):
        return f"no entry within {outer}"
    return f"nothing: the scene has no list {outer}" if isinstance(name, int) else ""


def remove_key(tables: dict[str, Any], key: str) -> None:
    """Remove an entry by dotted key from nested tables, in place, if it exists."""
    inner: Any = tables
    *path, last = split_key(key)
    for name in path:
        inner = inner[name] if isinstance(name, int) else inner.get(name) or {}
    if isinstance(inner, dict):
        inner.pop(last, None)
