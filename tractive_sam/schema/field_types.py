"""Types of the entries of a document, and the definition of a field."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Generic, TypeVar

from pydantic import AfterValidator, BeforeValidator, Field

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
