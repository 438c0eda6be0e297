"""Types of the entries of a document, and descriptions of the values that they allow."""

import math
from collections.abc import Iterable, Mapping
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

from pydantic import AfterValidator, BeforeValidator, Field
from pydantic.fields import FieldInfo

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


def _check_not_tiny(value: float) -> float:
    """Return a number unchanged; raise a ValueError if it is too small."""
    if value >= SMALLEST:
        return value
    raise ValueError(f"a number of at least {SMALLEST:g}")


def _check_radius(value: float) -> float:
    """Return a radius unchanged; raise a ValueError for 0 or a magnitude out of range."""
    if value == math.inf or SMALLEST <= abs(value) <= LARGEST:
        return value
    raise ValueError("a number other than 0, mm (negative: concave), or inf (flat)")


def _is_number(value: Any) -> bool:
    """Return whether a value is a number and not a bool."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def number_to_pair(value: Any) -> Any:
    """Return (x, x) for a number x, which applies to both directions; other values unchanged."""
    return (value, value) if _is_number(value) else value


def number_to_tuple(value: Any) -> Any:
    """Return (x,) for a number x, which applies to x only; other values unchanged."""
    return (value,) if _is_number(value) else value


def _read_integer(value: Any) -> Any:
    """Return an integer for a float without fraction (1e4); other values unchanged."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


def _read_path(value: Any) -> Any:
    """Return text as a path; other values unchanged."""
    return Path(value) if isinstance(value, str) else value


Integer = Annotated[int, BeforeValidator(_read_integer)]
Real = Annotated[float, AfterValidator(_check_magnitude)]
Radius = Annotated[float, AfterValidator(_check_radius)]
Positive = Annotated[Real, Field(gt=0), AfterValidator(_check_not_tiny)]
NotNegative = Annotated[Real, Field(ge=0)]
PositivePair = tuple[Positive, Positive]
PositivePerAxis = Annotated[
    tuple[Positive, ...], BeforeValidator(number_to_tuple), Field(min_length=1, max_length=2)
]
FilePath = Annotated[Path, BeforeValidator(_read_path)]
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
