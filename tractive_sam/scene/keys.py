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
from typing import TYPE_CHECKING, Any

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
