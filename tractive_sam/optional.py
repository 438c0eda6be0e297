"""Packages of extras, imported when they are first used.

A module can thus name their types in its annotations and needs no import inside functions. Check
with `extras.check_extra` first: its error names the extra.
"""

from importlib import import_module
from types import ModuleType
from typing import Any


class LazyPackage(ModuleType):
    """A package that is imported for its first attribute."""

    def __getattr__(self, name: str) -> Any:
        """Return an attribute of the package; tools that look for special names load nothing."""
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(import_module(self.__name__), name)


pandas = LazyPackage("pandas")
xarray = LazyPackage("xarray")
