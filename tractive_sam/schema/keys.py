"""Types of the entries of a document, and every key: meaning, unit, allowed values, default.

All of it is taken from the fields that read the document. Docstrings, the command line, the manual
and the commented scene files print it.
"""

import inspect
import math
import re
import textwrap
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import reduce
from itertools import pairwise
from keyword import iskeyword
from operator import or_
from pathlib import Path
from types import NoneType, UnionType
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    Generic,
    Literal,
    TypeVar,
    Union,
    get_args,
    get_origin,
)

from pydantic import AfterValidator, BaseModel, BeforeValidator, Field
from pydantic.fields import FieldInfo

from .faults import Fault, shorten

Accepted = TypeVar("Accepted")
Stored = TypeVar("Stored")
Inner = TypeVar("Inner")

SMALLEST, LARGEST = 1e-30, 1e30
"""Magnitudes within which no product or quotient of a few entries can overflow."""


def _check_magnitude(value: float) -> float:
    """Return a number unchanged; raise a ValueError if it is too large or not finite."""
    if abs(value) <= LARGEST:
        return value
    raise ValueError(f"a finite number, at most {LARGEST:g} in magnitude")


def _check_size(value: float) -> float:
    """Return a number unchanged; raise a ValueError if it is too large, or above 0 and tiny."""
    if 0.0 < value < SMALLEST:
        raise ValueError(f"a number of at least {SMALLEST:g}")
    return _check_magnitude(value)


def _check_radius(value: float) -> float:
    """Return a radius unchanged; raise a ValueError for 0 or a magnitude out of range."""
    if value == math.inf or SMALLEST <= abs(value) <= LARGEST:
        return value
    raise ValueError("a number other than 0, mm (negative: concave), or inf (flat)")


def _is_number(value: Any) -> bool:
    """Return whether a value is a number and not a bool."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def ascending(allowed: str) -> AfterValidator:
    """Return a validator: a ValueError unless numbers, or first numbers of pairs, ascend.

    Parameters
    ----------
    allowed : str
        The allowed values as text, for the message.
    """

    def check(values: tuple) -> tuple:
        numbers = [value[0] if isinstance(value, tuple) else value for value in values]
        if any(late <= early for early, late in pairwise(numbers)):
            raise ValueError(allowed)
        return values

    return AfterValidator(check)


def number_to_pair(value: Any) -> Any:
    """Return (x, x) for a number x, which applies to both directions; other values unchanged."""
    return (value, value) if _is_number(value) else value


def number_to_tuple(value: Any) -> Any:
    """Return (x,) for a number x, which applies to x only; other values unchanged."""
    return (value,) if _is_number(value) else value


Integer = Annotated[
    int,
    # A float without fraction, such as 1e4, is an integer.
    BeforeValidator(
        lambda value: int(value) if isinstance(value, float) and value.is_integer() else value
    ),
]
Real = Annotated[float, AfterValidator(_check_magnitude)]
Radius = Annotated[float, AfterValidator(_check_radius)]
# One validator: of two in an entry of a table, pydantic 2.10.0 keeps the second one only.
Positive = Annotated[float, AfterValidator(_check_size), Field(gt=0)]
NotNegative = Annotated[Real, Field(ge=0)]
PositivePair = tuple[Positive, Positive]
PositivePerAxis = Annotated[
    tuple[Positive, ...], BeforeValidator(number_to_tuple), Field(min_length=1, max_length=2)
]
FilePath = Annotated[
    Path, BeforeValidator(lambda value: Path(value) if isinstance(value, str) else value)
]
"""Path of a file, also given as a text."""

Pair = tuple[float, float]

if TYPE_CHECKING:

    class Accepting(Generic[Accepted, Stored]):
        """A field that accepts more types than it stores, for type checkers."""

        def __get__(self, table: object, kind: type, /) -> Stored: ...
        def __set__(self, table: object, value: Accepted, /) -> None: ...

    InnerTable = Accepting[Inner | Mapping[str, Any], Inner]
    OrthotropicPositive = Accepting[float | Pair, Pair]
    OptionalOrthotropicPositive = Accepting[float | Pair | None, Pair | None]
    OptionalOrthotropicNotNegative = OptionalOrthotropicPositive
    OptionalPositivePerAxis = Accepting[float | tuple[float, ...] | None, tuple[float, ...] | None]
else:

    class InnerTable:
        """A table within another one: an object or a dictionary."""

        def __class_getitem__(cls, kind: Any) -> Any:
            return kind

    OrthotropicPositive = Annotated[PositivePair, BeforeValidator(number_to_pair)]
    OptionalOrthotropicPositive = OrthotropicPositive | None
    OptionalOrthotropicNotNegative = (
        Annotated[tuple[NotNegative, NotNegative], BeforeValidator(number_to_pair)] | None
    )
    OptionalPositivePerAxis = PositivePerAxis | None


def entry(meaning: str, allowed: str | None = None, default: Any = ..., **bounds: Any) -> Any:
    """Define a field of a table: meaning, allowed values, default and bounds.

    Parameters
    ----------
    meaning : str
        Meaning of the key, with its unit; the title of the field.
    allowed : str, optional
        Allowed values as text, for messages and for the list of keys; the description of the field.
        By default it is written from the type and the bounds (`allowed_text.describe_allowed`).
    default : optional
        Value if the key is not given; without a default the key is required.
    **bounds
        Constraints, see `pydantic.Field`.
    """
    return Field(default, title=meaning, description=allowed, **bounds)


def optional(meaning: str, allowed: str | None = None, **bounds: Any) -> Any:
    """Define a field of a table as `entry` does; without the key its value is None."""
    return entry(meaning, allowed, None, **bounds)


def describe_allowed(kind: Any, constraints: Iterable[Any] = ()) -> str:
    """Return text that describes the values that a type with constraints allows.

    Parameters
    ----------
    kind : type
        A number, a text, a bool, a path, names (`Literal`), a list of names, or two or three
        numbers; also annotated or optional.
    constraints : iterable
        Metadata of the field: bounds and validators.

    Returns
    -------
    str
        For example "a number above 0"; empty for other types, which need a separate text.
    """
    words = {
        float: "a number",
        int: "an integer",
        str: "a text",
        bool: "true or false",
        Path: "the path of a file",
    }
    if get_origin(kind) is Annotated:
        inner, *outer = get_args(kind)
        return describe_allowed(inner, [*outer, *constraints])
    if isinstance(kind, UnionType) or get_origin(kind) is Union:
        members = [member for member in get_args(kind) if member is not NoneType]
        return describe_allowed(members[0], constraints) if len(members) == 1 else ""
    if get_origin(kind) is Literal:
        return list_names(get_args(kind))
    if get_origin(kind) is tuple:
        item, *further = get_args(kind)
        if further == [...]:
            names = get_args(item) if get_origin(item) is Literal else ()
            return f"a list of {list_names(names, 'and')}" if names else ""
        item = describe_allowed(item)
        count = {1: "a pair of", 2: "three"}[len(further)]
        pair = f"{count} {item.removeprefix('a ').replace('number', 'numbers')}"
        return f"{item}, or a pair of them" if takes_number(kind, constraints) else pair
    bounds = _bounds(constraints)
    return f"{words.get(kind, '')}{_describe_bounds(bounds)}" if kind in words else ""


def takes_number(kind: Any, checks: Iterable[Any] = ()) -> bool:
    """Return whether a type, with its validators, is a pair that one number may give."""
    if get_origin(kind) is Annotated:
        inner, *checks = get_args(kind)
        return takes_number(inner, checks)
    if isinstance(kind, UnionType) or get_origin(kind) is Union:
        return any(map(takes_number, get_args(kind)))
    return any(isinstance(one, BeforeValidator) and one.func is number_to_pair for one in checks)


def list_names(names: Iterable[str], last: str = "or") -> str:
    """Return names in quotes, separated by commas, with a word before the last one."""
    *quoted, final = (f'"{name}"' for name in names)
    return f"{', '.join(quoted)} {last} {final}" if quoted else final


def _bounds(constraints: Iterable[Any]) -> dict[str, Any]:
    """Return the bounds (gt, ge, lt, le) that constraints contain, by name."""
    bounds: dict[str, Any] = {}
    for check in constraints:
        metadata = check.metadata if isinstance(check, FieldInfo) else [check]
        for item in metadata:
            bounds |= {
                name: getattr(item, name)
                for name in ("gt", "ge", "lt", "le")
                if getattr(item, name, None) is not None
            }
    return bounds


def _describe_bounds(bounds: dict[str, Any]) -> str:
    """Describe an interval as text with a leading space; empty without bounds."""
    lower, upper = bounds.get("ge"), bounds.get("le")
    if lower is not None and upper is not None:
        return f" from {_format_bound(lower)} to {_format_bound(upper)}"
    parts = (
        (" above {}", bounds.get("gt")),
        (" of at least {}", lower),
        (" and below {}", bounds.get("lt")),
        (", at most {}", upper),
    )
    return "".join(text.format(_format_bound(bound)) for text, bound in parts if bound is not None)


def _format_bound(bound: float) -> str:
    """Return a bound as people write it: 1e+12 as 1e12."""
    return f"{bound:g}".replace("e+", "e").replace("e0", "e").replace("e-0", "e-")


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
        if name in named or iskeyword(name):  # "from" can only be given as **{"from": ...}
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


def copy_tables(value: Any) -> Any:
    """Return a copy of nested tables and their lists; the values within are shared."""
    if isinstance(value, Mapping):
        return {key: copy_tables(item) for key, item in value.items()}
    if isinstance(value, list | tuple) and any(isinstance(item, Mapping) for item in value):
        return [copy_tables(item) for item in value]
    return value


def set_key(tables: dict[str, Any], key: str, value: Any) -> list[Fault]:
    """Set a value by dotted key in nested tables, in place; return faults of the key.

    Returns
    -------
    list of Fault
        The fault of a key that leads through an entry that is no table, or to a place that a list
        does not have; otherwise empty.
    """
    inner: Any = tables
    path = split_key(key)
    for depth, name in enumerate(path):
        allowed = _allowed_within(inner, name, join_key(path[:depth]))
        if allowed:
            return [Fault(key, shorten(value), allowed)]
        if depth < len(path) - 1:
            if not isinstance(name, int):
                inner.setdefault(name, {})
            if isinstance(inner[name], list | tuple):
                inner[name] = [*inner[name]]  # numbers of a list are shared with other tables
            inner = inner[name]
    inner[name] = copy_tables(value)
    return []


def _allowed_within(inner: Any, name: str | int, outer: str) -> str:
    """Describe what is allowed instead of an index or name; empty if an entry can have it."""
    if isinstance(inner, list):
        within = isinstance(name, int) and name < len(inner)
        return "" if within else f"a place in the list: {outer}[0] to {outer}[{len(inner) - 1}]"
    if not isinstance(inner, dict):
        return f"no entry within {outer}"
    return f"nothing: the scene has no list {outer}" if isinstance(name, int) else ""


def remove_key(tables: dict[str, Any], key: str) -> None:
    """Remove an entry by dotted key from nested tables, in place, if it exists."""
    inner: Any = tables
    *path, last = split_key(key)
    for name in path:
        inner = inner[name] if isinstance(name, int) else inner.get(name) or {}
    if isinstance(inner, dict):
        inner.pop(last, None)
