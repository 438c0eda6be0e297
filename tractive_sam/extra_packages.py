"""Packages of extras, imported when they are first used.

A module can thus name their types in its annotations and needs no import inside functions. Check
with `extras.check_extra` first: its error names the extra.
"""

from importlib import import_module
from types import ModuleType
from typing import Any


class LazyPackage(ModuleType):
    """Stand-in for an optional package that is imported when an attribute is first used."""

    def __getattr__(self, name: str) -> Any:
        """Import the package, and return its attribute; special names import nothing."""
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(import_module(self.__name__), name)


pandas = LazyPackage("pandas")
xarray = LazyPackage("xarray")
