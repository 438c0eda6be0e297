"""Base classes of all tables and documents: keys, checks, reading, help, description.

`Table.describe` returns the rows of a table that is given. `Table.effect` names what is left out
if a table is absent. The table of an array has `describe_array` in addition.

Pydantic checks the type and the bounds of each entry; `reading` collects the faults of all entries
and of the checks between them.

Each entry is read separately, so that a fault hides no other one. The checks between entries then
run on the entries that are valid.
"""

import functools
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from difflib import get_close_matches
from operator import methodcaller
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, ClassVar, Self, get_args, get_origin

import numpy as np
from pydantic import BaseModel, ConfigDict, PydanticUserError, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from tractive_sam.description import Row

from . import toml
from .faults import Fault, SceneError, shorten, suggest_name
from .keys import describe_allowed, docstring_with_keys, key_signature, split_key, takes_number


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

    def require(self, keys: Iterable[str]) -> None:
        """Raise an `InvalidEntryError` unless all these keys have valid values."""
        for key in keys:
            if key not in self:
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
        before, path = "", split_key(key)
        if isinstance(path[-1], int) and len(path) > 1:  # a number of a list
            path.pop()
        for name in path:
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


def _shorten_pairs(table: TableBase, entries: Mapping[str, Any]) -> dict[str, Any]:
    """Return the entries of a table with a pair of equal numbers as one where that is allowed."""
    short = dict(entries)
    for key, value in entries.items():
        info, inner = type(table).model_fields.get(key), getattr(table, key, None)
        if isinstance(inner, TableBase) and isinstance(value, Mapping):
            short[key] = _shorten_pairs(inner, value)
        elif info is not None and takes_number(info.annotation, info.metadata):
            is_pair = isinstance(value, tuple) and len(value) == 2
            short[key] = value[0] if is_pair and value[0] == value[1] else value
    return short


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


@dataclass
class TableReading:
    """Result of reading a table: valid values and faults.

    Attributes
    ----------
    given : dict
        The entries as given, without None.
    values : dict
        The valid values and defaults, in the order of the fields.
    entries : ValidEntries
        These values, and the values of inner tables, by dotted key.
    faults : list of Fault
        All faults.
    """

    given: dict[Any, Any]
    values: dict[str, Any] = field(default_factory=dict)
    entries: ValidEntries = field(default_factory=ValidEntries)
    faults: list[Fault] = field(default_factory=list)

    def store(self, key: str, value: Any) -> None:
        """Store a valid value under its key."""
        self.values[key] = self.entries[key] = value

    def add_fault(self, key: str, allowed: str) -> None:
        """Add the fault that the given value of a key is not allowed."""
        self.faults.append(Fault(str(key), shorten(self.given[key]), allowed))


def read_entries(table: type[TableBase], entries: Mapping[Any, Any]) -> TableReading:
    """Read and check the entries of a table class; return its values and faults.

    Returns
    -------
    TableReading
        The valid values, and all faults.
    """
    faults: list[Fault] = []
    try:
        entries = table.unfold(entries)
    except SceneError as error:
        faults += error.faults
        faulty = {fault.key.split(".")[0] for fault in faults}
        entries = {key: value for key, value in entries.items() if key not in faulty}
    reading = TableReading(
        {key: value for key, value in entries.items() if value is not None}, faults=faults
    )
    for key in reading.given:
        if key in table.model_fields:
            reading.entries.given.add(key)
        else:
            many = len(reading.faults) >= SceneError.max_listed
            reading.add_fault(key, "no such entry" if many else suggest_key(table, str(key)))
    for key, info in table.model_fields.items():
        if key not in reading.given:
            _read_default(reading, key, info)
        elif (inner := inner_table(info)) and (
            # Its field allows nothing but a table, or it is one.
            not info.description or isinstance(reading.given[key], Mapping | TableBase)
        ):
            _read_table(reading, key, inner)
        elif inner := array_item(info):
            _read_array(reading, key, inner, table)
        else:
            _read_value(reading, key, table, to_python(reading.given[key]))
    for check in table.checks:
        with suppress(InvalidEntryError):
            reading.faults.extend(check(reading.entries))
    return reading


def _read_default(reading: TableReading, key: str, info: FieldInfo) -> None:
    """Store the default of a key that was not set, or add a fault if the key is required."""
    if info.is_required():
        reading.faults.append(Fault(key, "nothing", _describe_field(info)))
        return
    with suppress(KeyError):  # a default that follows from a faulty entry
        value = info.get_default(call_default_factory=True, validated_data=reading.values)
        reading.store(key, value)
        if isinstance(value, TableBase):
            reading.entries.add(key, read_entries(type(value), value.entries()).entries)


def _read_table(reading: TableReading, key: str, table: type[TableBase]) -> None:
    """Read a nested table; store it, or add its faults."""
    value = reading.given[key]
    if isinstance(value, table):
        value = value.entries()
    if not isinstance(value, Mapping):
        reading.add_fault(key, f"a table with the keys {', '.join(table.model_fields)}")
        return
    inner = read_entries(table, value)
    reading.entries.add(key, inner.entries)
    reading.faults.extend(fault.under(key) for fault in inner.faults)
    if not inner.faults:
        reading.store(key, table.model_construct(_fields_set=set(inner.given), **inner.values))


def _read_array(
    reading: TableReading, key: str, table: type[TableBase], outer: type[TableBase]
) -> None:
    """Read an array of tables; store it, or add the faults of its tables and number."""
    value = reading.given[key]
    if not isinstance(value, list | tuple):
        reading.add_fault(key, f"a list of tables with the keys {', '.join(table.model_fields)}")
        return
    before, items = len(reading.faults), []
    for place, entries in enumerate(value):
        item = TableReading({key: entries})
        _read_table(item, key, table)
        reading.faults.extend(fault.at(key, place) for fault in item.faults)
        items.append(item.values.get(key))
    if len(reading.faults) == before:
        _read_value(reading, key, outer, tuple(items))


def _read_value(reading: TableReading, key: str, table: type[TableBase], value: Any) -> None:
    """Read the value of a key; store it, or add a fault."""
    adapter = _adapter(table, key)
    try:
        reading.store(key, adapter.validate_python(value))
    except ValidationError as error:
        info = table.model_fields[key]
        reasons = dict.fromkeys(
            str(e["ctx"]["error"]) for e in error.errors() if e["type"] == "value_error"
        )
        hints = _suggest_number(adapter, value) + _suggest_nearest_name(info.annotation, value)
        reading.add_fault(key, ("; ".join(reasons) or _describe_field(info)) + hints)


def _suggest_number(adapter: TypeAdapter, value: Any) -> str:
    """Return a hint if a text would be valid as a number; else an empty text."""
    if not isinstance(value, str):
        return ""
    try:
        adapter.validate_python(float(value))
    except ValueError:  # also of pydantic
        return ""
    return f"; the number {value.strip()} without quotes, perhaps?"


def _suggest_nearest_name(kind: Any, value: Any) -> str:
    """Return a hint if a text is like an allowed name; else an empty text."""
    if not isinstance(value, str):
        return ""
    nearest = get_close_matches(value.casefold(), _allowed_names(kind), n=1)
    return "".join(f'; "{name}", perhaps?' for name in nearest)


def _allowed_names(kind: Any) -> list[str]:
    """Return all names (literals) that a type allows."""
    if isinstance(kind, str):
        return [kind]
    return [name for part in get_args(kind) for name in _allowed_names(part)]


def _describe_field(info: FieldInfo) -> str:
    """Return text for what a field allows, with its meaning."""
    inner = None if info.description else inner_table(info)
    allowed = (
        f"a table with the keys {', '.join(inner.model_fields)}" if inner else info.description
    )
    return f"{allowed} ({info.title})" if info.title else str(allowed)


@functools.cache
def _adapter(table: type[TableBase], key: str) -> TypeAdapter[Any]:
    """Return pydantic's validator of the values of a key, cached."""
    info = table.model_fields[key]
    kind: Any = Annotated[info.annotation, key, *info.metadata]  # built at run time
    strict = ConfigDict(strict=True, arbitrary_types_allowed=True)
    try:
        return TypeAdapter(kind, config=strict)
    except PydanticUserError:  # records and tables have a configuration already
        return TypeAdapter(kind)


def describe_tables(document: Any) -> dict[str, list[Row]]:
    """Return the rows (label, text) that describe each table of a document, by its key."""
    kinds = {key: document.table_class(info) for key, info in type(document).model_fields.items()}
    return {
        key: _describe_entry(kind, key, getattr(document, key), document)
        for key, kind in kinds.items()
        if kind is not None
    }


def _describe_entry(kind: Any, key: str, value: Any, document: Any) -> list[Row]:
    """Return the rows that describe a table; of a missing one, what is left out."""
    if isinstance(value, tuple):
        return [*kind.describe_array(value, document)]
    if value is not None:
        return [*value.describe(document)]
    return [Row(kind.effect, f"left out: the scene has no [{key}]")] if kind.effect else []


_LIBRARY = set(dir(BaseModel))


def _internal_names(cls: Any) -> frozenset[str]:
    """Return the names of a table class, without special ones, that help leaves out."""
    return frozenset(_LIBRARY).union(*(getattr(base, "internal", ()) for base in cls.__mro__))


def _listed_names(cls: Any) -> list[str]:
    """Return the names of a table class that help and completion list."""
    internal = _internal_names(cls)
    names = type(BaseModel).__dir__(cls)
    return [name for name in names if name[:2] != "__" and name not in internal]


def _construct(cls: Any, /, *unnamed: Any, **entries: Any) -> Any:
    """Construct a table from keywords: prepare and read them, and call its `check_complete`.

    Pydantic's `__init__` would stop at the first faults, without the checks of the whole table.
    """
    if unnamed:
        name = cls.__name__
        cure = f"; {name}.from_toml(path) reads a file" if hasattr(cls, "from_toml") else ""
        raise TypeError(f"{name}(...) takes keywords only{cure}")
    try:
        faults: list[Fault] = []
        reading = read_entries(cls, cls.prepare(entries, faults))
        if faults := [*faults, *reading.faults]:
            raise SceneError(faults)
    except SceneError as error:
        raise cls.error_class(error.faults) from None
    table = cls.model_construct(_fields_set=set(reading.given), **reading.values)
    table.check_complete()
    return table


# Pydantic has no public name for the metaclass of its models.
_TableType: Any = type(
    "_TableType",
    (type(BaseModel),),
    {
        "__call__": _construct,
        "__dir__": _listed_names,
        "__signature__": property(key_signature, lambda cls, of_library: None),
    },
)


class Table(TableBase, metaclass=_TableType):
    """Base class of immutable tables, with the keys of a TOML table as keywords.

    Keywords are the keys of the TOML table; None stands for "not given".

    Raises
    ------
    SceneError
        With all faults of the table and of its inner tables.
    """

    internal: ClassVar[frozenset[str]] = frozenset(
        (
            *("check_complete", "checks", "describe_array", "effect", "error_class", "excludes"),
            *(
                "find_field",
                "find_parameter",
                "internal",
                "key_advice",
                "prepare",
                "table_class",
                "unfold",
            ),
        )
    )
    """Names that the package uses and completion leaves out."""
    effect: ClassVar[str] = ""
    """What a document without the table leaves out, for descriptions; may be empty."""
    excludes: ClassVar[dict[str, str]] = {}
    """Tables, keys and uses of a document that the table excludes, and why."""
    error_class: ClassVar[type[SceneError]] = SceneError
    """Class of the errors that report its faults."""

    @classmethod
    def prepare(cls, entries: dict[str, Any], faults: list[Fault]) -> dict[str, Any]:
        """Return the entries of a new table before they are read; unchanged unless overridden.

        Parameters
        ----------
        entries : dict
            The keywords.
        faults : list of Fault
            Faults of the table, to which faults of these entries are added.
        """
        return entries

    @classmethod
    def model_validate(cls, obj: Any, **_options: Any) -> Self:
        """Construct the table from a mapping of its entries."""
        return cls(**obj)

    def check_complete(self) -> None:
        """Check the constructed table and issue its warnings; does nothing by default.

        Raises
        ------
        SceneError
            With the faults that only the finished table shows.
        """

    @classmethod
    def __pydantic_init_subclass__(cls, **_: Any) -> None:
        """Document the keys of a new class of tables: by default, what types and bounds allow."""
        for info in cls.model_fields.values():
            if info.description is None:
                info.description = describe_allowed(info.annotation, info.metadata)
        cls.__doc__ = docstring_with_keys(cls)

    def describe(self, scene: Any) -> Iterable[Row]:
        """Return the rows (label, text) that describe the table in reports of a scene.

        Parameters
        ----------
        scene : Scene
            The scene that contains the table.
        """
        return ()

    def __setattr__(self, name: str, value: Any) -> None:
        """Refuse the change, with the way to make a changed copy."""
        cure = 'make a changed copy, as with scene.replace(**{"load.normal": 200.0})'
        raise AttributeError(f"{name}: a {type(self).__name__} cannot be changed; {cure}")

    def __dir__(self) -> list[str]:
        """Return the names for users, without internal names of pydantic and the package."""
        internal = _internal_names(type(self))
        return [name for name in super().__dir__() if name[:2] == "__" or name not in internal]


class TomlTable(Table):
    """Base class of tables that are read from TOML files and written to them."""

    internal: ClassVar[frozenset[str]] = frozenset(("read_tables", "resolve_files"))

    @classmethod
    def from_toml(cls, path: str | PathLike[str]) -> Self:
        """Read a TOML file and check it; relative paths in it start from its folder.

        Raises
        ------
        SceneError
            If the file cannot be read, is not TOML, or contains invalid entries; `StudyError` for
            a study, `TableError` for a table of creep forces.
        """
        path = Path(path).absolute()
        try:
            return cls(**cls.resolve_files(path.parent, cls.read_tables(path)))
        except SceneError as error:
            raise cls.error_class(error.faults) from None

    @classmethod
    def from_toml_text(cls, text: str) -> Self:
        """Read TOML text and check it; relative paths in it start from the working folder.

        Raises
        ------
        SceneError
            If the text is not TOML, or contains invalid entries.
        """
        return cls(**toml.parse(text))

    def to_toml(self) -> str:
        """Return the entries that were set as TOML, without defaults, for `from_toml_text`."""
        return toml.emit(_shorten_pairs(self, self.entries()))

    @staticmethod
    def read_tables(path: str | PathLike[str]) -> dict[str, Any]:
        """Return the tables of a TOML file as dictionaries, without checking them.

        Raises
        ------
        SceneError
            If the file cannot be read, or is not TOML.
        """
        return toml.parse_file(Path(path))

    @classmethod
    def resolve_files(cls, folder: Path, tables: dict[str, Any]) -> dict[str, Any]:
        """Return tables whose relative paths start from a folder; unchanged unless overridden."""
        return tables
