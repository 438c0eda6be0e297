"""The base of all tables of a scene: reads entries and collects every fault at once.

Entries are judged one by one, so that a faulty one hides no other; checks between entries then
run on whatever is known to be valid.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, is_dataclass
from difflib import get_close_matches
from operator import methodcaller
from typing import Annotated, Any, ClassVar, get_args, get_origin

import numpy as np
from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from .describe import Row
from .faults import MOST_TOLD, Fault, SceneError, shown, suggestion
from .keys import documented, key_signature, parts
from .known import Known, UnknownEntryError

_CONFIG = ConfigDict(strict=True, arbitrary_types_allowed=True)


Check = Callable[[Known], Iterable[Fault]]


def _own_names(cls: Any) -> list[str]:
    """Names of a class for its help and completion, without those of its library."""
    return [name for name in type(BaseModel).__dir__(cls) if name not in _LIBRARY]


def _ignore_signature(cls: Any, of_library: Any) -> None:
    """Take no signature of the library: it lists its validators as types."""


# Its kind is made here, as pydantic has no public name for that of its classes.
_Bare: Any = type(
    "_Bare",
    (type(BaseModel),),
    {"__dir__": _own_names, "__signature__": property(key_signature, _ignore_signature)},
)


class Table(BaseModel, metaclass=_Bare):
    """A frozen table of a scene.

    Keywords are the keys of the TOML table; None stands for "not given".

    Raises
    ------
    SceneError
        With all faults of the table and of the tables inside it.
    """

    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid", **_CONFIG)
    checks: ClassVar[tuple[Check, ...]] = ()
    """Checks between the entries of the table."""
    internal: ClassVar[frozenset[str]] = frozenset(
        ("checks", "describe_array", "described", "effect", "internal", "table_of", "unfolded")
    )
    """Names that the package uses and completion leaves out."""
    effect: ClassVar[str] = ""
    """What a scene without the table leaves out; empty where nothing is worth a line."""

    def __init__(self, /, **given: Any) -> None:
        reading = _read(type(self), given)
        if reading.faults:
            raise SceneError(reading.faults)
        super().__init__(**{key: reading.values[key] for key in reading.given})

    @classmethod
    def __pydantic_init_subclass__(cls, **_: Any) -> None:
        """Have its keys in its docstring, for `help`."""
        cls.__doc__ = documented(cls)

    @classmethod
    def unfolded(cls, given: Mapping[Any, Any]) -> Mapping[Any, Any]:
        """What was given, as it is to be read; a table may know other ways to write it.

        Raises
        ------
        SceneError
            With the faults of an entry that cannot be read so.
        """
        return given

    @classmethod
    def described_beyond(cls, name: str) -> FieldInfo | None:
        """Return the field of a key that is none of the table; None where there is none."""
        return None

    def describe(self, scene: Any) -> Iterable[Row]:
        """Return the rows that describe the table.

        Parameters
        ----------
        scene : Scene
            The scene that has the table.
        """
        return ()

    @staticmethod
    def table_of(info: FieldInfo) -> type[Table] | None:
        """The kind of the tables that a field may hold, one or an array of them."""
        return _table_of(info) or _item_of(info)

    def __setattr__(self, name: str, value: Any) -> None:
        """Say how one that is changed is made."""
        cure = 'make a changed one, as by scene.replace(**{"load.normal": 200.0})'
        raise AttributeError(f"{name}: a {type(self).__name__} stays as it is; {cure}")

    def __dir__(self) -> list[str]:
        """Names for users, without those of its library and of the package."""
        internal = frozenset().union(*(getattr(cls, "internal", ()) for cls in type(self).__mro__))
        return [
            name
            for name in super().__dir__()
            if name[:2] == "__" or (name not in _LIBRARY and name not in internal)
        ]

    def entries(self) -> dict[str, Any]:
        """Return what was given, not the defaults, nested as in TOML."""
        given = {key: getattr(self, key) for key in type(self).model_fields}
        return {
            key: _nested(value, methodcaller("entries"))
            for key, value in given.items()
            if key in self.model_fields_set and value is not None
        }

    def settings(self) -> dict[str, Any]:
        """Return all that holds, defaults included, nested as in TOML."""
        values = {key: getattr(self, key) for key in type(self).model_fields}
        return {
            key: _nested(value, methodcaller("settings"))
            for key, value in values.items()
            if value is not None
        }

    @classmethod
    def described(cls, key: str) -> FieldInfo:
        """The field of a dotted key: its title and what it allows.

        Raises
        ------
        SceneError
            If there is none.
        """
        table: type[Table] | None = cls
        array: type[Table] | None = None
        before = ""
        for name in parts(key):
            if array and isinstance(name, int):
                table, array, before = array, None, f"{before}[{name}]"
                continue
            if table is None:
                place = f"; {before}[0].{name} is that of the first one" if array else ""
                raise SceneError([Fault(key, shown(key), f"no entry within {before}{place}")])
            found = table.model_fields.get(str(name)) or table.described_beyond(str(name))
            if found is None:
                allowed = _suggested(table, str(name))
                raise SceneError([Fault(key, shown(key), allowed)])
            info = found
            table, array, before = _table_of(info), _item_of(info), f"{before}.{name}".lstrip(".")
        return info


def _suggested(table: type[Table], name: str) -> str:
    """What may be meant by an entry that a table does not have: also one of a table inside it."""
    inner = [
        f"{outer}.{name}"
        for outer, info in table.model_fields.items()
        if (kind := _table_of(info)) and name in kind.model_fields
    ]
    return f"{' or '.join(inner)}, perhaps?" if inner else suggestion(name, table.model_fields)


_LIBRARY = set(dir(BaseModel))


@dataclass
class _Reading:
    """What came of reading one table."""

    given: dict[Any, Any]
    values: dict[str, Any] = field(default_factory=dict)
    known: Known = field(default_factory=Known)
    faults: list[Fault] = field(default_factory=list)


def _read(table: type[Table], given: Mapping[Any, Any]) -> _Reading:
    faults: list[Fault] = []
    try:
        given = table.unfolded(given)
    except SceneError as error:
        faults += error.faults
        wrong = {fault.key.split(".")[0] for fault in faults}
        given = {key: value for key, value in given.items() if key not in wrong}
    reading = _Reading(
        {key: value for key, value in given.items() if value is not None}, faults=faults
    )
    for key in reading.given:
        if key in table.model_fields:
            reading.known.given.add(key)
        else:
            many = len(reading.faults) >= MOST_TOLD
            allowed = "no such entry" if many else _suggested(table, str(key))
            reading.faults.append(Fault(str(key), shown(given[key]), allowed))
    for key, info in table.model_fields.items():
        if key not in reading.given:
            _read_default(reading, key, info)
        elif (inner := _table_of(info)) and _as_table(reading.given[key], info):
            _read_table(reading, key, inner)
        elif inner := _item_of(info):
            _read_array(reading, key, inner, table)
        else:
            _read_leaf(reading, key, table, plain(reading.given[key]))
    for check in table.checks:
        with suppress(UnknownEntryError):
            reading.faults.extend(check(reading.known))
    return reading


def _read_default(reading: _Reading, key: str, info: FieldInfo) -> None:
    if info.is_required():
        reading.faults.append(Fault(key, "nothing", _allowed(info)))
        return
    with suppress(KeyError):  # a default that rests on a faulty entry
        value = info.get_default(call_default_factory=True, validated_data=reading.values)
        reading.values[key] = reading.known[key] = value
        if isinstance(value, Table):
            reading.known.add(key, _read(type(value), value.entries()).known)


def _read_table(reading: _Reading, key: str, table: type[Table]) -> None:
    given = reading.given[key]
    if isinstance(given, table):
        given = given.entries()
    if not isinstance(given, Mapping):
        allowed = f"a table with the keys {', '.join(table.model_fields)}"
        reading.faults.append(Fault(key, shown(given), allowed))
        return
    inner = _read(table, given)
    reading.known.add(key, inner.known)
    reading.faults.extend(fault.under(key) for fault in inner.faults)
    if not inner.faults:
        value = table.model_construct(_fields_set=set(inner.given), **inner.values)
        reading.values[key] = reading.known[key] = value


def _read_array(reading: _Reading, key: str, table: type[Table], within: type[Table]) -> None:
    """Read an array of tables, each as if it stood alone, and then how many there are."""
    given = reading.given[key]
    if not isinstance(given, list | tuple):
        allowed = f"a list of tables with the keys {', '.join(table.model_fields)}"
        reading.faults.append(Fault(key, shown(given), allowed))
        return
    before, items = len(reading.faults), []
    for k, one in enumerate(given):
        item = _Reading({key: one})
        _read_table(item, key, table)
        reading.faults.extend(fault.at(key, k) for fault in item.faults)
        items.append(item.values.get(key))
    if len(reading.faults) == before:
        _read_leaf(reading, key, within, tuple(items))


def _read_leaf(reading: _Reading, key: str, table: type[Table], plain: Any) -> None:
    try:
        value = _adapter(table, key).validate_python(plain)
    except ValidationError as error:
        reasons = {
            str(e["ctx"]["error"]): None for e in error.errors() if e["type"] == "value_error"
        }
        allowed = "; ".join(reasons) or _allowed(table.model_fields[key])
        allowed += _unquoted(_adapter(table, key), plain)
        allowed += _nearest_name(table.model_fields[key].annotation, plain)
        reading.faults.append(Fault(key, shown(reading.given[key]), allowed))
    else:
        reading.values[key] = reading.known[key] = value


def _unquoted(adapter: TypeAdapter, given: Any) -> str:
    """A hint for a text that would do as a number."""
    if not isinstance(given, str):
        return ""
    try:
        adapter.validate_python(float(given))
    except ValueError:  # also of pydantic
        return ""
    return f"; the number {given.strip()} without quotes, perhaps?"


def _nearest_name(kind: Any, given: Any) -> str:
    """Return a hint for a text that is like one of the names that are allowed."""
    if not isinstance(given, str):
        return ""
    nearest = get_close_matches(given.casefold(), _names_in(kind), n=1)
    return "".join(f'; "{one}", perhaps?' for one in nearest)


def _names_in(kind: Any) -> list[str]:
    """Return the names that a type allows."""
    if isinstance(kind, str):
        return [kind]
    return [name for part in get_args(kind) for name in _names_in(part)]


def _allowed(info: FieldInfo) -> str:
    """What the field allows and what it means, from the words of its definition."""
    inner = None if info.description else _table_of(info)
    words = f"a table with the keys {', '.join(inner.model_fields)}" if inner else info.description
    return f"{words} ({info.title})" if info.title else str(words)


def _as_table(given: Any, info: FieldInfo) -> bool:
    """Whether an entry is to be read as a table: one with a description may be other things."""
    return not info.description or isinstance(given, Mapping | Table)


def _nested(value: Any, plain: Callable[[Any], dict[str, Any]]) -> Any:
    """A value, of which tables are made plain."""
    if isinstance(value, Table):
        return plain(value)
    if isinstance(value, tuple) and any(isinstance(item, Table) for item in value):
        return tuple(plain(item) for item in value)
    return value


def _item_of(info: FieldInfo) -> type[Table] | None:
    """The type of the tables in an array of them."""
    first = next(iter(get_args(info.annotation)), None)
    if get_origin(info.annotation) is tuple and isinstance(first, type):
        return first if issubclass(first, Table) else None
    return None


def _table_of(info: FieldInfo) -> type[Table] | None:
    """The type of a nested table, optional or not."""
    if get_origin(info.annotation) is tuple:
        return None
    for kind in (info.annotation, *get_args(info.annotation)):
        if isinstance(kind, type) and issubclass(kind, Table):
            return kind
    return None


@functools.cache
def _adapter(table: type[Table], key: str) -> TypeAdapter[Any]:
    info = table.model_fields[key]
    kind: Any = Annotated[info.annotation, key, *info.metadata]  # made while it runs
    # A record has a configuration already.
    return TypeAdapter(kind, config=None if is_dataclass(info.annotation) else _CONFIG)


def plain(value: Any) -> Any:
    """Return Python numbers and tuples for the scalars, vectors and lists of numpy and TOML."""
    match value:
        case np.generic():
            return value.item()
        case np.ndarray(ndim=1):
            return tuple(value.tolist())
        case list() | tuple():
            return tuple(map(plain, value))
    return value
