"""The findings of a chapter: statements, figures and tables."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from io import BytesIO
from pathlib import Path
from typing import TypeAlias

import numpy as np

from tractive_sam import plot
from tractive_sam.paper.size import Size


class Verdict(StrEnum):
    """Agreement with a statement of the paper: agrees, in part, differs, cannot be decided."""

    AGREES = "agrees"
    PARTLY = "agrees in part"
    DIFFERS = "differs"
    OPEN = "cannot be decided"

    @classmethod
    def from_conditions(cls, *conditions: bool | np.bool_) -> "Verdict":
        """Return AGREES if all conditions hold, PARTLY if some do, and DIFFERS if none does."""
        if all(conditions):
            return cls.AGREES
        return cls.PARTLY if any(conditions) else cls.DIFFERS


@dataclass(frozen=True)
class Statement:
    """Statement of the paper with the computed result and a verdict.

    Texts are plain; a letter, an underscore and more letters are a symbol and its index: "Q_x".

    Attributes
    ----------
    place : str
        Place in the paper: "Sec. 8.1.1", "Fig. 6(a)".
    paper : str
        Statement of the paper.
    ours : str
        The computed result, in numbers.
    verdict : Verdict
        Whether the two agree.
    rule : str
        Criterion of the agreement, if it is not obvious: "if within 1%".
    """

    place: str
    paper: str
    ours: str
    verdict: Verdict
    rule: str = ""


@dataclass(frozen=True)
class Picture:
    """Figure with its file name and caption, as a finding on the page.

    Attributes
    ----------
    name : str
        Name of its file, without the ending.
    figure : Figure
        The figure.
    caption : str
        Caption, which begins with the figure of the paper.
    """

    name: str
    figure: "plot.Figure"
    caption: str

    @cached_property
    def svg(self) -> bytes:
        """Return the figure as an SVG file, with images of 150 dots per inch."""
        memory = BytesIO()
        self.figure.savefig(memory, format="svg", dpi=150, metadata={"Date": None})
        return memory.getvalue()


@dataclass(frozen=True)
class FindingTable:
    """Table of results with a caption, as a finding on the page; its first column names the rows.

    Attributes
    ----------
    caption : str
        Caption.
    heads : sequence of str
        Heading of each column, with the unit.
    rows : sequence of sequence of str
        Cells.
    """

    caption: str
    heads: Sequence[str]
    rows: Sequence[Sequence[str]]


Finding: TypeAlias = Statement | Picture | FindingTable


@dataclass(frozen=True)
class Work:
    """Settings of a chapter's computations: mesh sizes, folder of results, progress function.

    Attributes
    ----------
    size : Size
        Meshes, creepages and revolutions.
    results : Path
        Folder of the results files.
    report : callable
        Called with a line that describes the running computation.
    """

    size: Size
    results: Path
    report: Callable[[str], None]


@dataclass(frozen=True)
class Chapter:
    """Title and function of a group of the paper's figures on the page.

    Attributes
    ----------
    title : str
        Title.
    figures : str
        Figures and tables of the paper.
    find : callable
        Yields the findings of a `Work`.
    """

    title: str
    figures: str
    find: Callable[[Work], Iterator[Finding]]


def format_deviation(value: float, reference: float) -> str:
    """Return the deviation of a value from a reference, as in "+1.2%"."""
    return f"{value / reference - 1:+.1%}"


def join(values: Iterable[float], form: str) -> str:
    """Return numbers as a list in words: "0.1, 0.2 and 0.3"."""
    texts = [format(value, form) for value in values]
    return " and ".join([", ".join(texts[:-1]), texts[-1]]) if len(texts) > 1 else texts[0]
