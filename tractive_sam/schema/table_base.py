"""What a class of tables defines: its keys, its checks, other tables, and what they exclude."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from operator import methodcaller
from typing import Any, ClassVar, get_args, get_origin

import numpy as np
from pydantic import BaseModel, ConfigDict
from pydantic.fields import FieldInfo

from .faults import Fault, SceneError, shorten, suggest_name
from .keys import split_key


class InvalidEntryError(LookupError):
    """Raised when a check reads an invalid or missing entry, so that the check is skipped."""


class ValidEntries(dict[str, Any]):
    """Valid entries of a table by dotted key; other keys raise `InvalidEntryError`.

    A look-up of any other key raises `InvalidEntryError`. `given` contains the keys that the scene
    gives, with valid or invalid values.
    """

    def __init__(self) -> None:
        super().__init__()
        self.given: set[str] = set()

    def __missing__(self, key: str) -> Any:
        raise InvalidEntryError(key)

    def add(self, key: str, inner: "ValidEntries") -> None:
        """Add the valid entries of the inner table `key`."""
        self.update({f"{key}.{name}": value for name, value in inner.items()})
        self.given.update(f"{key}.{name}" for name in inner.given)


Check = Callable[[ValidEntries], Iterable[Fault]]


class TableBase(BaseModel):
    """Base class of tables: typed keys, checks between entries, and conversion to dictionaries."""

    # Entries are checked key by key (`reading`): a validator of the complete table is never built.
    model_config = ConfigDict(
        strict=True, arbitrary_types_allowed=True, frozen=True, defer_build=True, extra="forbid"
    )
    checks: ClassVar[tuple[Check, ...]] = ()
    """Checks between the entries of the table."""
    key_advice: ClassVar[Mapping[str, str]] = {}
    """New names of keys by their names in older versions, for messages."""

    @classmethod
    def unfold(cls, entries: Mapping[Any, Any]) -> Mapping[Any, Any]:
        """Return entries in their standard form; a table may allow other forms.

        Raises
        ------
        SceneError
            With the faults of an entry that has none of these forms.
        """
        return entries

    @classmethod
    def find_parameter(cls, name: str) -> FieldInfo | None:
        """Return a field for a key outside the class definition, or None, as for the base class."""
        return None

    @staticmethod
    def table_class(info: FieldInfo) -> "type[TableBase] | None":
        """Return the class of the tables in a field (one or an array of them); None for values."""
        return inner_table(info) or array_item(info)

    def entries(self) -> dict[str, Any]:
        """Return the entries that were set, without defaults and None, nested as in TOML."""
        return {
            key: _to_plain(value, methodcaller("entries"))
            for key in type(self).model_fields
            if key in self.model_fields_set and (value := getattr(self, key)) is not None
        }

    def settings(self) -> dict[str, Any]:
        """Return all entries with defaults, nested as in TOML."""
        return {
            key: _to_plain(value, methodcaller("settings"))
            for key in type(self).model_fields
            if (value := getattr(self, key)) is not None
        }

    @classmethod
    def find_field(cls, key: str) -> FieldInfo:
        """Return the field that a dotted key names; raise a SceneError if there is none.

        Raises
        ------
        SceneError
            If the table has no field of this key.
        """
        table: type[TableBase] | None = cls
        array: type[TableBase] | None = None
        before = ""
        for name in split_key(key):
            if array and isinstance(name, int):
                table, array, before = array, None, f"{before}[{name}]"
                continue
            if table is None:
                place = f"; {before}[0].{name} belongs to the first one" if array else ""
                raise SceneError([Fault(key, shorten(key), f"no entry within {before}{place}")])
            named_field = table.model_fields.get(str(name)) or table.find_parameter(str(name))
            if named_field is None:
                raise SceneError([Fault(key, shorten(key), suggest_key(table, str(name)))])
            info = named_field
            table, array = inner_table(info), array_item(info)
            before = f"{before}.{name}".lstrip(".")
        return info


def suggest_key(table: type[TableBase], name: str) -> str:
    """Return text that suggests allowed keys for an unknown one, also from inner tables."""
    inner = [
        f"{outer}.{name}"
        for outer, info in table.model_fields.items()
        if (kind := inner_table(info)) and name in kind.model_fields
    ]
    if name in table.key_advice:
        return table.key_advice[name]
    if inner:
        return f"{' or '.join(inner)}, perhaps? The key belongs in a table"
    meanings = {key: info.title or "" for key, info in table.model_fields.items()}
    return suggest_name(name, meanings, meanings)


def _to_plain(value: Any, convert: Callable[[Any], dict[str, Any]]) -> Any:
    """Return a value in which tables are converted to dictionaries."""
    if isinstance(value, TableBase):
        return convert(value)
    if isinstance(value, tuple) and any(isinstance(item, TableBase) for item in value):
        return tuple(convert(item) for item in value)
    return value


def array_item(info: FieldInfo) -> type[TableBase] | None:
    """Return the table class of a field that is an array of tables; else None."""
    first = next(iter(get_args(info.annotation)), None)
    if get_origin(info.annotation) is tuple and isinstance(first, type):
        return first if issubclass(first, TableBase) else None
    return None


def inner_table(info: FieldInfo) -> type[TableBase] | None:
    """Return the table class of a field that is a table, optional or not; else None."""
    if get_origin(info.annotation) is tuple:
        return None
    for kind in (info.annotation, *get_args(info.annotation)):
        if isinstance(kind, type) and issubclass(kind, TableBase):
            return kind
    return None


def to_python(value: Any) -> Any:
    """Return Python numbers and tuples for the scalars, vectors and lists of numpy and TOML."""
    match value:
        case np.generic():
            return value.item()
        case np.ndarray(ndim=1):
            return tuple(value.tolist())
        case list() | tuple():
            return tuple(map(to_python, value))
    return value


def exactly_one(*keys: str) -> Check:
    """Return a check that reports a fault unless exactly one of some keys is given."""

    def check(entries: ValidEntries) -> Iterator[Fault]:
        if not entries.given.intersection(keys):
            yield Fault(keys[0], "nothing", f"exactly one of {_join_keys(keys)}")
        yield from not_both(*keys)(entries)

    return check


def not_both(*keys: str) -> Check:
    """Return a check that reports a fault if more than one of some keys is given."""

    def check(entries: ValidEntries) -> Iterator[Fault]:
        first, *further = [key for key in keys if key in entries.given] or [""]
        if further:
            yield Fault(first, f"with {' and '.join(further)}", f"only one of {_join_keys(keys)}")

    return check


def _join_keys(keys: tuple[str, ...]) -> str:
    """Return keys as a list in words: "a, b and c"."""
    return f"{', '.join(keys[:-1])} and {keys[-1]}"
