"""Entries of a table that are valid, for the checks between them."""

from __future__ import annotations

from typing import Any


class InvalidEntryError(LookupError):
    """An entry that a check needs is invalid or missing: the check is left out."""


class ValidEntries(dict[str, Any]):
    """Valid entries and defaults by dotted key; a table is included if all its entries are valid.

    A look-up of any other key raises `InvalidEntryError`. `given` contains the keys that the scene
    gives, with valid or invalid values.
    """

    def __init__(self) -> None:
        super().__init__()
        self.given: set[str] = set()

    def __missing__(self, key: str) -> Any:
        raise InvalidEntryError(key)

    def add(self, key: str, inner: ValidEntries) -> None:
        """Add the valid entries of the inner table `key`."""
        self.update({f"{key}.{name}": value for name, value in inner.items()})
        self.given.update(f"{key}.{name}" for name in inner.given)
