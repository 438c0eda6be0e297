"""Names of a package, looked up when first used, also in a zip archive; former names warn."""

import os
import sys
import warnings
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

import lazy_loader  # type: ignore[import-untyped]


def attach_names(package: str, file: str) -> tuple[Any, Any, list[str]]:
    """Return `__getattr__`, `__dir__` and `__all__` of a package from its `__init__.pyi`.

    Parameters
    ----------
    package : str
        Name of the package.
    file : str
        Path of its `__init__.py`, perhaps within an archive.
    """
    stub = f"{os.path.splitext(file)[0]}.pyi"
    if os.path.exists(stub):
        return lazy_loader.attach_stub(package, stub)
    from importlib.resources import as_file, files  # noqa: PLC0415 - takes time to load

    with as_file(files(package) / "__init__.pyi") as extracted:
        return lazy_loader.attach_stub(package, str(extracted))


def _warn(old: str, name: str) -> None:
    """Warn (DeprecationWarning) that a former name was used, and state the present one."""
    text = f"{old} is called {name} now; the former name will be removed"
    warnings.warn(text, DeprecationWarning, stacklevel=4)


def with_renamed(
    module: str, lookup: Callable[[str], Any], renamed: Mapping[str, str]
) -> Callable[[str], Any]:
    """Return a `__getattr__` of a module that finds present names, and former ones with a warning.

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


def accept_renamed_methods(cls: type, renamed: Mapping[str, str]) -> None:
    """Let a subclass define methods under their former names, with a warning.

    Parameters
    ----------
    cls : type
        A new subclass of a class with renamed methods.
    renamed : mapping of str to str
        Present names by former names.
    """
    for old, name in renamed.items():
        if old in vars(cls) and not isinstance(vars(cls)[old], _RenamedAttribute):
            _warn(f"{cls.__name__}.{old}", name)
            setattr(cls, name, vars(cls)[old])


Class = TypeVar("Class", bound=type)


def renamed_attributes(**renamed: str) -> Callable[[Class], Class]:
    """Return a class decorator that keeps attributes available under former names, with a warning.

    Parameters
    ----------
    **renamed : str
        Present names by former names.
    """

    def add(cls: Class) -> Class:
        for old, name in renamed.items():
            setattr(cls, old, _RenamedAttribute(f"{cls.__name__}.{old}", name))
        return cls

    return add


class _RenamedAttribute:
    """Descriptor of an attribute or method under its former name, which warns."""

    def __init__(self, old: str, name: str) -> None:
        self._old, self._name = old, name

    def __get__(self, instance: Any, owner: type) -> Any:
        """Warn, and return the attribute under its present name."""
        _warn(self._old, self._name)
        return getattr(owner if instance is None else instance, self._name)
