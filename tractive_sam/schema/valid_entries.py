"""Entries of a table that are valid, for the checks between them."""

from typing import Any


class InvalidEntryError(LookupError):
    """Raised when a check reads an invalid or missing entry, so that the check is skipped."""


class ValidEntries(dict[str, Any]):
    """Valid entries of a table by dotted key; other keys raise `InvalidEntryError`.

    A look-up of any other key raises `InvalidEntryError`. `given` contains the keys that the scene
    gives, with valid or invalid values.
    """

    def __init__(self) -> None:
        super().__init__()
        self.given: set[str] = set()

    def __missing__(self, key: str) -> Any:
        raise InvalidEntryError(key)

    def add(self, key: str, inner: "ValidEntries") -> None:
        """Add the valid entries of the inner table `key`."""
        self.update({f"{key}.{name}": value for name, value in inner.items()})
        self.given.update(f"{key}.{name}" for name in inner.given)
