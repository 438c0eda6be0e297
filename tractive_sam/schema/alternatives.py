"""Checks of entries that exclude each other."""

from collections.abc import Iterator

from .faults import Fault
from .table_base import Check
from .valid_entries import ValidEntries


def exactly_one(*keys: str) -> Check:
    """Return a check that reports a fault unless exactly one of some keys is given."""

    def check(entries: ValidEntries) -> Iterator[Fault]:
        if not entries.given.intersection(keys):
            yield Fault(keys[0], "nothing", f"exactly one of {_join_keys(keys)}")
        yield from not_both(*keys)(entries)

    return check


def not_both(*keys: str) -> Check:
    """Return a check that reports a fault if more than one of some keys is given."""

    def check(entries: ValidEntries) -> Iterator[Fault]:
        first, *further = [key for key in keys if key in entries.given] or [""]
        if further:
            yield Fault(first, f"with {' and '.join(further)}", f"only one of {_join_keys(keys)}")

    return check


def _join_keys(keys: tuple[str, ...]) -> str:
    """Return keys as a list in words: "a, b and c"."""
    return f"{', '.join(keys[:-1])} and {keys[-1]}"
