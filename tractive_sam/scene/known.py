"""Entries of a table that are valid, for checks between them."""

from __future__ import annotations

from typing import Any


class UnknownEntryError(LookupError):
    """An entry that a check asked for is faulty or missing: the check cannot be made."""


class Known(dict[str, Any]):
    """Valid entries and defaults by dotted key; whole tables are there if all in them is valid.

    Asking for anything else raises `UnknownEntryError`. `given` holds the keys that were written
    down, be their values valid or not.
    """

    def __init__(self) -> None:
        super().__init__()
        self.given: set[str] = set()

    def __missing__(self, key: str) -> Any:
        raise UnknownEntryError(key)

    def add(self, key: str, inner: Known) -> None:
        """Take over what is known of the table `key`."""
        self.update({f"{key}.{name}": value for name, value in inner.items()})
        self.given.update(f"{key}.{name}" for name in inner.given)
