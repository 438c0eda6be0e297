"""Base class of the laws: a description for people and a fingerprint of the content."""

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from functools import cached_property
from numbers import Real
from types import CodeType, FunctionType
from typing import Any, ClassVar

import numpy as np


class Law:
    """Base class of the laws of mechanics: a one-line description and a hash of the content.

    Examples
    --------
    >>> ts.Coulomb(mu=(0.6, 0.3)).describe()
    'Coulomb(mu=(0.6, 0.3), angle=0.0)'
    >>> strong, weak = ts.Coulomb(mu=(0.6, 0.3)), ts.Coulomb(mu=(0.3, 0.3))
    >>> strong.fingerprint() == weak.fingerprint()
    False
    """

    recorded_name: ClassVar[str | None] = None
    """Module and class in fingerprints, which results files store, if it was renamed or moved."""

    def describe(self) -> str:
        """Return the name of the law and its parameters in one line."""
        return describe(self)

    def fingerprint(self) -> str:
        """Return a hash of the content: equal for equal laws, in any process.

        It covers the name of the class and its parameters: arrays with every number, functions
        with their code. The code of the class itself is not covered. A law that depends on more (a
        file, a compiled library) must override this method.
        """
        return _hash(self)


def describe(law: object) -> str:
    """Return the name of a law and its parameters in one line."""
    if type(law).__repr__ is object.__repr__:
        parameters = ", ".join(f"{name}={value!r}" for name, value in _parameters(law).items())
        return f"{type(law).__name__}({parameters})"
    return " ".join(repr(law).split())  # numpy breaks lines within arrays


def fingerprint(law: object) -> str:
    """Return a hash of the content of a law (`Law.fingerprint`) or of any other object."""
    return law.fingerprint() if isinstance(law, Law) else _hash(law)


def _hash(law: object) -> str:
    """Return the SHA-256 hash, hexadecimal, of the class and the parameters of an object."""
    content = _content([type(law), _parameters(law)])
    return hashlib.sha256(b"".join(content)).hexdigest()


def _parameters(law: object) -> dict[str, Any]:
    """Return the parameters of an object by name, without cached values.

    A field with the metadata "added" counts only if it is given: laws of earlier versions, which do
    not have it, keep their fingerprint.
    """
    if is_dataclass(law):
        values = {field.name: getattr(law, field.name) for field in fields(law)}
        added = {field.name for field in fields(law) if field.metadata.get("added")}
        return {name: x for name, x in values.items() if x is not None or name not in added}
    kind = type(law)
    return {
        name: value
        for name, value in sorted(getattr(law, "__dict__", {}).items())
        if not isinstance(getattr(kind, name, None), cached_property)
    }


def _content(value: Any) -> Iterator[bytes]:
    """Yield bytes that are equal for equal content; lengths separate neighbouring items."""
    match value:
        case Law() if type(value).fingerprint is not Law.fingerprint:
            yield value.fingerprint().encode()
        case None | complex() | str() | bytes():
            text = repr(value).encode()
            yield f"{type(value).__name__}{len(text)}:".encode() + text
        case Real():  # 1, 1.0 and numpy's are equal parameters
            yield f"number{float(value).hex()}".encode()
        case np.ndarray() if value.dtype != object:
            yield f"array{value.dtype.str}{value.shape}".encode() + value.tobytes()
        case Mapping():
            yield f"mapping{len(value)}".encode()
            for key in sorted(value, key=repr):
                yield from _content(key)
                yield from _content(value[key])
        case list() | tuple() | set() | frozenset() | np.ndarray():
            yield f"sequence{len(value)}".encode()
            for item in sorted(value, key=repr) if isinstance(value, set | frozenset) else value:
                yield from _content(item)
        case FunctionType():
            closure = [cell.cell_contents for cell in value.__closure__ or ()]
            yield from _content(["function", value.__code__, value.__defaults__, closure])
        case CodeType():
            yield from _content(["code", value.co_code, value.co_names, list(value.co_consts)])
        case type():
            recorded = vars(value).get("recorded_name")
            names = recorded.rsplit(".", 1) if recorded else [value.__module__, value.__qualname__]
            yield from _content(["class", *names])
        case _:
            yield from _content([type(value), _parameters(value)])
