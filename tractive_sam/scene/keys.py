"""Every key of a scene: its meaning with its unit, what is allowed, its default.

All from the fields that read a scene; docstrings, the command line, the manual and the files that
one starts from are told from here.
"""

from __future__ import annotations

import inspect
import re
import textwrap
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import reduce
from operator import or_
from types import UnionType
from typing import TYPE_CHECKING, Annotated, Any, Union, get_args, get_origin

from pydantic import BeforeValidator

from .quantities import FROM_NUMBER

if TYPE_CHECKING:
    from pydantic.fields import FieldInfo

    from .table import Table

EXAMPLES = "\n\nExamples\n"
"""Where a docstring tells its keys: before this, or at its end."""


@dataclass(frozen=True)
class Key:
    """A key of a table.

    Attributes
    ----------
    name : str
        Its name in the table.
    meaning : str
        What it stands for, with its unit.
    allowed : str
        What may be given.
    default : str
        As it is written in a scene file; "required", or "none" where nothing stands for it.
    """

    name: str
    meaning: str
    allowed: str
    default: str


@dataclass(frozen=True)
class Group:
    """A table of a scene, or several of one kind.

    Attributes
    ----------
    names : tuple of str
        Their names, dotted; "" is the scene itself.
    about : str
        What it is, in a few lines.
    keys : tuple of Key
        Its keys but for those that are tables only.
    """

    names: tuple[str, ...]
    about: str
    keys: tuple[Key, ...]


def parts(key: str) -> list[str | int]:
    """The names of a dotted key, and places in lists: ``duty[0].load.normal`` is of block 0."""
    found: list[str | int] = []
    for one in key.split("."):
        name, *places = re.split(r"\[([0-9]+)\](?=\[|$)", one)
        found += [name, *(int(place) for place in places if place)]
    return found


def joined(path: Iterable[str | int]) -> str:
    """The dotted key of such parts."""
    return "".join(f"[{one}]" if isinstance(one, int) else f".{one}" for one in path).lstrip(".")


def groups(table: type[Table], *names: str) -> Iterator[Group]:
    """A table by its names, and those inside it; those of one kind are told once."""
    inner: dict[type[Table], list[str]] = {}
    for name, info in table.model_fields.items():
        if kind := table.table_of(info):
            inner.setdefault(kind, []).append(name)
    yield Group(names or ("",), about(table), tuple(keys(table)))
    for kind, found in inner.items():
        yield from groups(
            kind, *(f"{outer}.{name}".lstrip(".") for outer in names or ("",) for name in found)
        )


def keys(table: type[Table]) -> Iterator[Key]:
    """The keys of a table but for those that are tables only."""
    for name, info in table.model_fields.items():
        if info.description:  # what is allowed: it may be no table, too
            yield Key(name, str(info.title), info.description, _default(info))


def about(table: type[Table]) -> str:
    """What a table is: its docstring without keys and examples."""
    text = inspect.cleandoc(table.__doc__ or "")
    return text.split("\n\nKeys\n")[0].split(EXAMPLES)[0].replace("``", "`")


def documented(table: type[Table]) -> str:
    """The docstring of a table, with its keys."""
    text = inspect.cleandoc(table.__doc__ or "")
    lines = []
    for key in keys(table):
        lines += [f"{key.name} : {key.allowed}"]
        told = key.meaning if key.default == "required" else f"{key.meaning}; default {key.default}"
        lines += textwrap.wrap(told, 90, initial_indent="    ", subsequent_indent="    ")
    if not lines or "\n\nKeys\n" in text:
        return text
    head, examples, tail = text.partition(EXAMPLES)
    return "\n".join((head, "", "Keys", "----", *lines)) + examples + tail


def key_signature(table: type[Table]) -> inspect.Signature:
    """Return the signature of a table: its keys with the types that are accepted, and defaults.

    A default that is a table, or follows from other entries, is None: "not given". What the
    `__init__` of a table takes in addition, as a study does, comes first.
    """
    own = inspect.signature(table.__init__).parameters.values()
    named = {one.name: one for one in own if one.kind is one.POSITIONAL_OR_KEYWORD}
    parameters = [one for name, one in named.items() if name != "self"]
    for name, info in table.model_fields.items():
        if name in named:
            continue
        default = inspect.Parameter.empty if info.is_required() else info.default
        if info.default_factory is not None or hasattr(default, "table_of"):
            default = None
        kind = _accepted_type(info.annotation, info.metadata)
        keyword = inspect.Parameter.KEYWORD_ONLY
        parameters.append(inspect.Parameter(name, keyword, default=default, annotation=kind))
    return inspect.Signature(parameters)


def _accepted_type(kind: Any, checks: Iterable[Any] = ()) -> Any:
    """Return a type without its checks; a table may also be a dictionary, a pair one number."""
    if get_origin(kind) is Annotated:
        inner, *checks = get_args(kind)
        return _accepted_type(inner, checks)
    if isinstance(kind, UnionType) or get_origin(kind) is Union:
        return reduce(or_, map(_accepted_type, get_args(kind)))
    if get_origin(kind) is tuple:
        items = get_args(kind)
        accepted: Any = tuple(one if one is ... else _accepted_type(one) for one in items)
        found: Any = tuple[accepted]
        number = any(isinstance(one, BeforeValidator) and one.func in FROM_NUMBER for one in checks)
        return _accepted_type(items[0]) | found if number else found
    if isinstance(kind, type) and hasattr(kind, "table_of"):
        return kind | dict
    return kind


def written(value: Any) -> str:
    """A value as it is written in a scene file."""
    if isinstance(value, tuple):
        return "[" + ", ".join(map(written, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else repr(value)


def _default(info: FieldInfo) -> str:
    if info.is_required():
        return "required"
    if info.default_factory is not None:
        return "from the others"
    return "none" if info.default is None else written(info.default)
