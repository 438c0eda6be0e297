"""What a table of creep forces is asked to hold."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from os import PathLike
from typing import Annotated, ClassVar, Self

from pydantic import AfterValidator, BeforeValidator, Field

from tractive_sam.scene import Check, Document, Fault, Known, SceneError, entry, shown


class TableError(SceneError):
    """A table of creep forces that cannot be made, with every fault that was found.

    Examples
    --------
    >>> try:
    ...     ts.TableDesign(ellipticity=[1.0, -2.0])
    ... except ts.TableError as error:
    ...     print(error.faults[0].key)
    ellipticity
    """

    subject: ClassVar[str] = "table"


def _listed(value: object) -> object:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return (value,) if number else value


def _ascending(values: tuple[float, ...]) -> tuple[float, ...]:
    if any(low >= high for low, high in pairwise(values)):
        raise ValueError("ascending numbers, each once")
    return values


Ratios = Annotated[
    tuple[Annotated[float, Field(ge=0.1, le=10.0)], ...],
    BeforeValidator(_listed),
    AfterValidator(_ascending),
    Field(min_length=1),
]
Poissons = Annotated[
    tuple[Annotated[float, Field(ge=0.0, le=0.5)], ...],
    BeforeValidator(_listed),
    AfterValidator(_ascending),
    Field(min_length=1),
]


def _finest_is_fine(known: Known) -> Iterator[Fault]:
    if known["finest"] < known["elements"]:
        cure = f"at least {known['elements']}, as elements is"
        yield Fault("finest", shown(known["finest"]), cure)


class TableDesign(Document):
    """A table of creep forces of Hertzian contacts of alike bodies.

    Raises
    ------
    TableError
        With every fault of the design.

    Examples
    --------
    >>> ts.TableDesign(ellipticity=[0.5, 1.0, 2.0], tolerance=0.01).poisson
    (0.3,)
    """

    title: str = entry("title", "a text", "")
    ellipticity: Ratios = entry(
        "a/b, semi-axes in rolling over lateral direction",
        "ascending numbers from 0.1 to 10; values are added between them",
        (1.0,),
    )
    poisson: Poissons = entry(
        "Poisson's ratio", "a number from 0 to 0.5, or several ascending ones", (0.3,)
    )
    tolerance: float = entry(
        "error bar and error of interpolation of forces over mu P",
        "a number from 1e-3 to 0.2",
        0.01,
        ge=1e-3,
        le=0.2,
    )
    elements: int = entry(
        "elements across a contact to begin with",
        "a whole number from 15 to 101",
        21,
        ge=15,
        le=101,
    )
    finest: int = entry(
        "elements across a contact at most", "a whole number from 15 to 401", 101, ge=15, le=401
    )
    most: int = entry("nodes at most", "a whole number from 300 to 1e6", 50_000, ge=300, le=10**6)
    seed: int = entry("seed of the points that are held out", "a whole number from 0", 0, ge=0)
    checks: ClassVar[tuple[Check, ...]] = (_finest_is_fine,)

    def __init__(self, /, **given: object) -> None:
        try:
            super().__init__(**given)
        except TableError:
            raise
        except SceneError as error:
            raise TableError(error.faults) from None

    @classmethod
    def from_toml(cls, path: str | PathLike[str]) -> Self:
        """Read a file.

        Raises
        ------
        TableError
            If the file cannot be read, is no TOML, or describes no valid table.
        """
        try:
            return super().from_toml(path)
        except SceneError as error:
            raise TableError(error.faults) from None
