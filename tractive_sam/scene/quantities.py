"""Types of the entries of a scene, and the words with which their faults are told."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any, Generic, TypeVar

from pydantic import AfterValidator, BeforeValidator, Field

Given = TypeVar("Given")
Stored = TypeVar("Stored")

SMALLEST, LARGEST = 1e-30, 1e30
"""Magnitudes within which no product or quotient of a few entries can overflow."""


def _bounded(value: float) -> float:
    if abs(value) <= LARGEST:
        return value
    raise ValueError(f"a finite number, at most {LARGEST:g} in magnitude")


def _not_tiny(value: float) -> float:
    if value >= SMALLEST:
        return value
    raise ValueError(f"a number of at least {SMALLEST:g}")


def _curved(value: float) -> float:
    if value == math.inf or SMALLEST <= abs(value) <= LARGEST:
        return value
    raise ValueError("a number other than 0 (negative: concave), or inf (flat)")


def _twice(value: Any) -> Any:
    """One number stands for both directions."""
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return (value, value) if number else value


def alone(value: Any) -> Any:
    """One number stands for x alone."""
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return (value,) if number else value


FROM_NUMBER = (_twice, alone)
"""Checks by which one number stands for several."""


def _whole(value: Any) -> Any:
    """A whole number may be written 1e4."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


Whole = Annotated[int, BeforeValidator(_whole)]
Real = Annotated[float, AfterValidator(_bounded)]
Radius = Annotated[float, AfterValidator(_curved)]
Positive = Annotated[Real, Field(gt=0), AfterValidator(_not_tiny)]
NotNegative = Annotated[Real, Field(ge=0)]
PositivePair = tuple[Positive, Positive]
PositiveOneOrTwo = Annotated[
    tuple[Positive, ...], BeforeValidator(alone), Field(min_length=1, max_length=2)
]
if TYPE_CHECKING:
    Pair = tuple[float, float]

    class Accepting(Generic[Given, Stored]):
        """A field whose stored type is not all that it accepts, for type checkers."""

        def __get__(self, table: object, kind: type, /) -> Stored: ...
        def __set__(self, table: object, value: Given, /) -> None: ...

    OrthotropicPositive = Accepting[float | Pair, Pair]
    OptionalOrthotropicPositive = Accepting[float | Pair | None, Pair | None]
    OptionalOrthotropicNotNegative = OptionalOrthotropicPositive
    OptionalPositiveOneOrTwo = Accepting[float | tuple[float, ...] | None, tuple[float, ...] | None]
else:
    OrthotropicPositive = Annotated[PositivePair, BeforeValidator(_twice)]
    OptionalOrthotropicPositive = OrthotropicPositive | None
    OptionalOrthotropicNotNegative = (
        Annotated[tuple[NotNegative, NotNegative], BeforeValidator(_twice)] | None
    )
    OptionalPositiveOneOrTwo = PositiveOneOrTwo | None


def entry(meaning: str, allowed: str, default: Any = ..., **bounds: Any) -> Any:
    """Define a field by its meaning (with its unit) and by what is allowed.

    Parameters
    ----------
    meaning, allowed : str
        The words of a fault; they become the title and the description of the field.
    default : optional
        Value if not given; without one the entry is required.
    **bounds
        Constraints as of `pydantic.Field`.
    """
    return Field(default, title=meaning, description=allowed, **bounds)


def positive(meaning: str, default: Any = ...) -> Any:
    """Define a field for a number above 0, of the type `Positive`."""
    return entry(meaning, "a number above 0", default)


def number(meaning: str, default: Any = ...) -> Any:
    """Define a field for any finite number, of the type `Real`."""
    return entry(meaning, "a number", default)
