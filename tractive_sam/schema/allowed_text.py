"""Descriptions of the values that a field allows, from its type and its constraints."""

from collections.abc import Iterable
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BeforeValidator
from pydantic.fields import FieldInfo

from .field_types import number_to_pair


def describe_allowed(kind: Any, constraints: Iterable[Any] = ()) -> str:
    """Return text that describes the values that a type with constraints allows.

    Parameters
    ----------
    kind : type
        A number, a text, a bool, a path, names (`Literal`), a list of names, or a pair of numbers;
        also annotated or optional.
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
        accepts_number = any(
            isinstance(check, BeforeValidator) and check.func is number_to_pair
            for check in constraints
        )
        pair = f"a pair of {item.removeprefix('a ').replace('number', 'numbers')}"
        return f"{item}, or a pair of them" if accepts_number else pair
    bounds = _bounds(constraints)
    return f"{words.get(kind, '')}{_describe_bounds(bounds)}" if kind in words else ""


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
