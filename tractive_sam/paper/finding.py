"""What a chapter yields: statements, figures and tables."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from io import BytesIO
from pathlib import Path
from typing import IO, Any, Protocol, TypeAlias

from tractive_sam.paper.size import Size

DOTS = 150
"""Of the parts of a picture that are no vectors, per inch."""


class Figure(Protocol):
    """What is asked of a figure."""

    def savefig(self, target: Path | IO[bytes], **options: Any) -> None:
        """Write it."""

    def get_figwidth(self) -> float:
        """Tell its width, inches."""


class Verdict(StrEnum):
    """What comes of holding our numbers against a statement."""

    AGREES = "agrees"
    PARTLY = "agrees in part"
    DIFFERS = "differs"
    OPEN = "cannot be told"

    @classmethod
    def of(cls, *conditions: bool) -> "Verdict":
        """Agreement where all of the conditions hold, in part where some do."""
        if all(conditions):
            return cls.AGREES
        return cls.PARTLY if any(conditions) else cls.DIFFERS


@dataclass(frozen=True)
class Statement:
    """What the paper says and what we find.

    Texts are plain; a letter, an underscore and what follows are a symbol and its index, as "Q_x".

    Attributes
    ----------
    place : str
        Where the paper says it: "Sec. 8.1.1", "Fig. 6(a)".
    paper : str
        What it says.
    ours : str
        What we find, in numbers.
    verdict : Verdict
        Whether the two agree.
    rule : str
        When they do, where that is not plain: "within 1%".
    """

    place: str
    paper: str
    ours: str
    verdict: Verdict
    rule: str = ""


@dataclass(frozen=True)
class Picture:
    """A figure.

    Attributes
    ----------
    name : str
        Of its file, without the ending.
    figure : Figure
        The figure.
    caption : str
        What it shows, starting with the paper's figure that it stands for.
    """

    name: str
    figure: Figure
    caption: str

    @cached_property
    def svg(self) -> bytes:
        """The figure as vectors."""
        memory = BytesIO()
        self.figure.savefig(memory, format="svg", dpi=DOTS, metadata={"Date": None})
        return memory.getvalue()


@dataclass(frozen=True)
class Table:
    """A table; the first column names the rows.

    Attributes
    ----------
    caption : str
        What it lists.
    heads : sequence of str
        One a column, with the unit.
    rows : sequence of sequence of str
        Cells.
    """

    caption: str
    heads: Sequence[str]
    rows: Sequence[Sequence[str]]


Finding: TypeAlias = Statement | Picture | Table


@dataclass(frozen=True)
class Work:
    """What a chapter is given.

    Attributes
    ----------
    size : Size
        Meshes, creepages and revolutions.
    results : Path
        Folder of the results files.
    tell : callable
        Takes a line that says what is being done.
    """

    size: Size
    results: Path
    tell: Callable[[str], None]


@dataclass(frozen=True)
class Chapter:
    """A group of the paper's figures.

    Attributes
    ----------
    title : str
        What it is about.
    figures : str
        The paper's figures and tables.
    find : callable
        Takes the work, yields the findings.
    """

    title: str
    figures: str
    find: Callable[[Work], Iterator[Finding]]


def percent(value: float, reference: float) -> str:
    """Deviation of a value from a reference, "+1.2%"."""
    return f"{value / reference - 1:+.1%}"


def listed(values: Sequence[float], form: str) -> str:
    """Numbers one after another: "0.1, 0.2 and 0.3"."""
    texts = [format(value, form) for value in values]
    return " and ".join([", ".join(texts[:-1]), texts[-1]]) if len(texts) > 1 else texts[0]
