"""Every key of a document: its meaning with its unit, what is allowed, its default.

All of it is taken from the fields that read the document. Docstrings, the command line, the manual
and the commented scene files print it.
"""

import inspect
import re
import textwrap
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import reduce
from operator import or_
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, BeforeValidator
from pydantic.fields import FieldInfo

from .field_types import describe_allowed, number_to_pair, number_to_tuple


@dataclass(frozen=True)
class Key:
    """Description of a key of a table: name, meaning, allowed values and default.

    Attributes
    ----------
    name : str
        Name of the key in the table.
    meaning : str
        Meaning of the key, with its unit.
    allowed : str
        Allowed values.
    default : str
        Default as it is written in a scene file; "required", "none", or "from other keys" if it
        follows from other entries.
    """

    name: str
    meaning: str
    allowed: str
    default: str


@dataclass(frozen=True)
class KeyGroup:
    """Keys of a table class, with the names of all tables of this class.

    Attributes
    ----------
    names : tuple of str
        Dotted names of the tables; "" is the document itself.
    about : str
        Description in a few lines.
    keys : tuple of Key
        Keys, without keys of inner tables.
    of_array : bool
        Whether the tables are items of arrays.
    """

    names: tuple[str, ...]
    about: str
    keys: tuple[Key, ...]
    of_array: bool = False

    @property
    def headings(self) -> str:
        """Headings of the tables as in a file, "[[duty]]" of an array; "" of the document."""
        left, right = ("[[", "]]") if self.of_array else ("[", "]")
        return ", ".join(f"{left}{name}{right}" for name in self.names if name)


def split_key(key: str) -> list[str | int]:
    """Return the names and list indices in a dotted key, for example ``duty[0].load.normal``."""
    path: list[str | int] = []
    for part in key.split("."):
        name, *places = re.split(r"\[([0-9]+)\](?=\[|$)", part)
        path += [name, *(int(place) for place in places if place)]
    return path


def join_key(path: Iterable[str | int]) -> str:
    """Return the dotted key of names and list indices; the inverse of `split_key`."""
    parts = (f"[{part}]" if isinstance(part, int) else f".{part}" for part in path)
    return "".join(parts).lstrip(".")


def key_groups(table: Any, *names: str, of_array: bool = False) -> Iterator[KeyGroup]:
    """Yield a `KeyGroup` for a table class and for each class of its inner tables.

    Parameters
    ----------
    table : type of Table
        The class.
    *names : str
        Dotted names of tables of this class in the document; none for the document itself.
    of_array : bool
        Whether these tables are items of arrays, as [[duty]].
    """
    inner: dict[Any, list[str]] = {}
    for name, info in table.model_fields.items():
        if kind := table.table_class(info):
            is_array = get_origin(info.annotation) is tuple
            inner.setdefault((kind, is_array), []).append(name)
    yield KeyGroup(names or ("",), _summary(table), tuple(_keys(table)), of_array)
    for (kind, is_array), inner_names in inner.items():
        outer = names or ("",)
        places = (f"{table}.{name}".lstrip(".") for table in outer for name in inner_names)
        yield from key_groups(kind, *places, of_array=is_array)


def _keys(table: type[BaseModel]) -> Iterator[Key]:
    """Yield the description of each key of a table class, without keys of inner tables."""
    for name, info in table.model_fields.items():
        if info.description:
            yield Key(name, str(info.title), info.description, _format_default(info))


def _summary(table: type) -> str:
    """Return the docstring of a table class without keys and examples."""
    text = inspect.cleandoc(table.__doc__ or "")
    return text.split("\n\nKeys\n")[0].split("\n\nExamples\n")[0].replace("``", "`")


def set_allowed_texts(table: type[BaseModel]) -> None:
    """Set the description of each field that has none: what its type and its bounds allow."""
    for info in table.model_fields.values():
        if info.description is None:
            info.description = describe_allowed(info.annotation, info.metadata)


def docstring_with_keys(table: type[BaseModel]) -> str:
    """Return the docstring of a table class with its keys, before the examples."""
    text = inspect.cleandoc(table.__doc__ or "")
    lines = []
    for key in _keys(table):
        lines += [f"{key.name} : {key.allowed}"]
        default = "" if key.default == "required" else f"; default {key.default}"
        meaning = f"{key.meaning}{default}"
        lines += textwrap.wrap(meaning, 90, initial_indent="    ", subsequent_indent="    ")
    if not lines or "\n\nKeys\n" in text:
        return text
    head, examples, tail = text.partition("\n\nExamples\n")
    return "\n".join((head, "", "Keys", "----", *lines)) + examples + tail


def key_signature(table: Any) -> inspect.Signature:
    """Return the signature of a table class: its keys with the accepted types, and defaults.

    A default that is a table, or that follows from other entries, is None: "not given". Parameters
    of `__init__` that are not keys, as in a study, come first.
    """
    of_init = inspect.signature(table.__init__).parameters.values()
    named = {item.name: item for item in of_init if item.kind is item.POSITIONAL_OR_KEYWORD}
    parameters = [item for name, item in named.items() if name != "self"]
    for name, info in table.model_fields.items():
        if name in named:
            continue
        default = inspect.Parameter.empty if info.is_required() else info.default
        if info.default_factory is not None or hasattr(default, "table_class"):
            default = None
        kind = _accepted_type(info.annotation, info.metadata)
        keyword = inspect.Parameter.KEYWORD_ONLY
        parameters.append(inspect.Parameter(name, keyword, default=default, annotation=kind))
    return inspect.Signature(parameters)


def _accepted_type(kind: Any, checks: Iterable[Any] = ()) -> Any:
    """Return a type without validators; a table may be a dictionary, a pair may be one number."""
    if get_origin(kind) is Annotated:
        inner, *checks = get_args(kind)
        return _accepted_type(inner, checks)
    if isinstance(kind, UnionType) or get_origin(kind) is Union:
        return reduce(or_, map(_accepted_type, get_args(kind)))
    if get_origin(kind) is tuple:
        items = get_args(kind)
        item_types: Any = tuple(item if item is ... else _accepted_type(item) for item in items)
        accepted: Any = tuple[item_types]
        from_number = any(
            isinstance(check, BeforeValidator) and check.func in (number_to_pair, number_to_tuple)
            for check in checks
        )
        return _accepted_type(items[0]) | accepted if from_number else accepted
    if isinstance(kind, type) and hasattr(kind, "table_class"):
        return kind | dict
    return kind


def format_value(value: Any) -> str:
    """Return a value as it is written in a scene file."""
    if isinstance(value, tuple):
        return "[" + ", ".join(map(format_value, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else repr(value)


def _format_default(info: FieldInfo) -> str:
    """Format the default of a key."""
    if info.is_required():
        return "required"
    if info.default_factory is not None:
        return "from other keys"
    return "none" if info.default is None else format_value(info.default)
