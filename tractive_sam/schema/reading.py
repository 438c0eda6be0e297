"""Read the entries of a table, and collect every fault at once.

Each entry is read separately, so that a fault hides no other one. The checks between entries then
run on the entries that are valid.
"""

import functools
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from difflib import get_close_matches
from typing import Annotated, Any, get_args

from pydantic import ConfigDict, PydanticUserError, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from .faults import Fault, SceneError, shorten
from .table_base import (
    InvalidEntryError,
    TableBase,
    ValidEntries,
    array_item,
    inner_table,
    suggest_key,
    to_python,
)


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
        elif (inner := inner_table(info)) and _is_table(reading.given[key], info):
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


def _is_table(value: Any, info: FieldInfo) -> bool:
    """Return whether to read a value as a table: it is one, or its field allows nothing else."""
    return not info.description or isinstance(value, Mapping | TableBase)


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
