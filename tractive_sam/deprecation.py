"""Former names: they work for one more version, with a warning that states the new name."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Mapping
from typing import Any


def _warn(former: str, name: str) -> None:
    text = f"{former} is called {name} now; the former name will be removed"
    warnings.warn(text, DeprecationWarning, stacklevel=4)


def with_renamed(
    module: str, lookup: Callable[[str], Any], renamed: Mapping[str, str]
) -> Callable[[str], Any]:
    """Return a `__getattr__` of a module that also finds former names.

    Parameters
    ----------
    module : str
        Name of the module.
    lookup : callable
        Its `__getattr__` for present names.
    renamed : mapping of str to str
        Present names by former names.
    """

    def find(name: str) -> Any:
        if name not in renamed:
            return lookup(name)
        _warn(f"{module}.{name}", renamed[name])
        return getattr(sys.modules[module], renamed[name])

    return find


def accept_former_methods(cls: type, renamed: Mapping[str, str]) -> None:
    """Let a class define methods under their former names, with a warning.

    Parameters
    ----------
    cls : type
        A new subclass of a class with renamed methods.
    renamed : mapping of str to str
        Present names by former names.
    """
    for former, name in renamed.items():
        if former in vars(cls) and not isinstance(vars(cls)[former], RenamedAttribute):
            _warn(f"{cls.__name__}.{former}", name)
            setattr(cls, name, vars(cls)[former])


class RenamedAttribute:
    """A former name of an attribute or a method, as an attribute of its class.

    Parameters
    ----------
    name : str
        The present name.
    """

    def __init__(self, name: str) -> None:
        self.name = name

    def __set_name__(self, owner: type, former: str) -> None:
        self.former = f"{owner.__name__}.{former}"

    def __get__(self, instance: Any, owner: type) -> Any:
        """Warn, and return the attribute under its present name."""
        _warn(self.former, self.name)
        return getattr(owner if instance is None else instance, self.name)
