"""Scenes of the paper, findings of a chapter, and one self-contained page of HTML for them."""

import re
from base64 import b64encode
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from importlib.metadata import version
from io import BytesIO
from itertools import groupby
from pathlib import Path
from platform import python_version
from typing import TypeAlias

import numpy as np

from tractive_sam import plot
from tractive_sam.mechanics import HertzContact
from tractive_sam.pages import fill_page
from tractive_sam.safe_text import Html, as_html, fill
from tractive_sam.scene import Friction, Scene
from tractive_sam.schema import required


@dataclass(frozen=True)
class Size:
    """Numbers of elements, creepages and revolutions with which the paper is reproduced.

    Attributes
    ----------
    name : str
        Description on the page.
    spheres : int
        Elements on a side of the mesh of the spheres.
    meshes : tuple of int
        Elements on a side of the meshes on which creep-force curves are compared.
    creepages : int
        Number of points of a creep-force curve.
    discs, flat_discs : tuple of int
        Elements in x and y of the twin discs, and of the discs with the flatter crown.
    saved : tuple of int
        Revolutions with stored fields; the last one ends the run.
    """

    name: str
    spheres: int
    meshes: tuple[int, ...]
    creepages: int
    discs: tuple[int, int]
    flat_discs: tuple[int, int]
    saved: tuple[int, ...]

    @property
    def revolutions(self) -> int:
        """Number of revolutions of a run: the last one with stored fields."""
        return self.saved[-1]


FULL = Size(
    "the paper's meshes and revolutions",
    spheres=91,
    meshes=(45, 91, 181),
    creepages=14,
    discs=(41, 121),
    flat_discs=(41, 241),
    saved=(0, 50, 250, 1000, 4000, 15000),
)

REDUCED = Size(
    "a reduced size: coarse meshes and few revolutions, as a quick check",
    spheres=31,
    meshes=(15, 31),
    creepages=6,
    discs=(21, 41),
    flat_discs=(21, 81),
    saved=(0, 50, 250),
)


ANGLES = (0.0, 45.0, 90.0)
"""Angles of the tribological axis e1 from the rolling direction, degrees."""

ANGLE_TEXT = "0°, 45° and 90°"
"""These angles as text."""


def spheres(size: Size, elements: int | None = None) -> Scene:
    """Return the scene of two equal spheres with isotropic friction (Sec. 8.1.1 of the paper)."""
    n = elements or size.spheres
    return Scene.builtin("spheres").with_set([f"grid.elements=[{n}, {n}]"])


def orthotropic_spheres(size: Size, angle: float) -> Scene:
    """Return the scene of equal spheres, orthotropic friction (Sec. 8.1.2); angle in degrees."""
    n = size.spheres
    settings = [f"grid.elements=[{n}, {n}]", f"friction.angle={angle}"]
    return Scene.builtin("spheres-orthotropic").with_set(settings)


def discs(size: Size, angle: float) -> Scene:
    """Return the scene of twin discs, orthotropic friction, wear (Sec. 8.2); angle in degrees."""
    settings = [*_wear_settings(size, size.discs), f"friction.angle={angle}"]
    return Scene.builtin("twin-discs").with_set(settings)


def flat_discs(size: Size) -> Scene:
    """Return the scene of twin discs with a flatter crown, isotropic friction (Appendix B)."""
    return Scene.builtin("twin-discs-isotropic").with_set(_wear_settings(size, size.flat_discs))


def _wear_settings(size: Size, elements: tuple[int, int]) -> list[str]:
    """Return assignments of scene keys ("key=value"): mesh, revolutions, stored fields."""
    return [
        f"grid.elements={list(elements)}",
        f"wear.revolutions={size.revolutions}",
        f"wear.save={list(size.saved)}",
    ]


def hertz_of(scene: Scene) -> HertzContact:
    """Return the Hertz contact of a scene, which every scene of the paper has."""
    hertz = scene.hertz
    assert isinstance(hertz, HertzContact)
    return hertz


def friction_of(scene: Scene) -> Friction:
    """Return the friction of a scene, which every scene of the paper has."""
    return required(scene.friction, "friction")


def friction_bound(scene: Scene) -> float:
    """Return mu1 P of a scene of the paper, the largest friction force along e1, N."""
    return friction_of(scene).mu[0] * hertz_of(scene).load


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
    draw : callable
        Draws the figure.
    caption : str
        Caption, which begins with the figure of the paper.
    """

    name: str
    draw: Callable[[], "plot.Figure"]
    caption: str

    @cached_property
    def figure(self) -> "plot.Figure":
        """Return the figure."""
        return self.draw()

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


def chapter(number: int, about: Chapter, findings: Iterable[Finding]) -> Html:
    """Return the HTML of a chapter; its findings are computed one by one as they are rendered."""
    head = (
        '<h2 id="chapter-$number"><a class="up" href="#contents">contents</a>$title'
        "<small>$figures</small></h2>"
    )
    title, figures = text(about.title), text(about.figures)
    filled = fill(head, number=str(number), title=title, figures=figures)
    return Html("\n".join([filled, *_blocks(findings)]))


def page(
    chapters: Sequence[tuple[Chapter, Html]],
    statements: Sequence[Statement],
    size: Size,
    seconds: float,
) -> Html:
    """Return the HTML page of rendered chapters, with a head that counts the verdicts.

    Parameters
    ----------
    chapters : sequence of (Chapter, Html)
        Chapters in their order, each with its HTML from `chapter`.
    statements : sequence of Statement
        All statements.
    size : Size
        Meshes and revolutions.
    seconds : float
        Time of the computation.
    """
    counts = Counter(statement.verdict for statement in statements)
    item = '<li><a href="#chapter-$number">$title</a><br><small>$figures</small></li>'
    contents = (
        fill(item, number=str(k), title=text(about.title), figures=text(about.figures))
        for k, (about, _) in enumerate(chapters)
    )
    count = '<li class="count"><b>$count</b>$badge</li>'
    programs = ("tractive-sam", "numpy", "scipy", "pyfftw", "numba")
    versions = ", ".join(f"{name} {version(name)}" for name in programs)
    notice = (
        "A reduced size, with coarse meshes and few revolutions, as a quick check: its numbers and "
        "verdicts differ from the full size."
    )
    return fill_page(
        __package__,
        "page",
        title="The paper, reproduced - tractive_sam",
        seconds=f"{seconds:.0f}",
        size=text(size.name),
        notice="" if size == FULL else fill('<p class="notice">$text</p>', text=text(notice)),
        counts=(
            fill(count, count=str(counts[verdict]), badge=_badge(verdict)) for verdict in Verdict
        ),
        contents=contents,
        chapters=Html("\n".join(rendered for _, rendered in chapters)),
        versions=text(f"{versions}, Python {python_version()}"),
    )


def text(plain: str) -> Html:
    """Return plain text as HTML, with subscripts of symbols (p_0) and true minus signs."""
    lowered = re.sub(
        r"(?<![A-Za-z])([A-Za-zξσµ])_([A-Za-z0-9]+)", r"\1<sub>\2</sub>", as_html(plain)
    )
    return Html(re.sub(r"(?<![\w.)])-(?=\d)", "−", lowered))


def _blocks(findings: Iterable[Finding]) -> Iterator[Html]:
    """Yield findings as HTML: successive statements as one table, successive figures as a grid."""
    for kind, group in groupby(findings, type):
        blocks = [_block(finding) for finding in group]
        if kind is Statement:
            yield fill(_STATEMENTS, rows=Html("\n".join(blocks)))
        elif kind is Picture:
            pictures = Html("\n".join(blocks))
            yield fill('<div class="figures">\n$pictures\n</div>', pictures=pictures)
        else:
            yield from blocks


def _block(finding: Finding) -> Html:
    """Return one finding (statement, figure or table) as HTML."""
    match finding:
        case Statement():
            return _statement(finding)
        case Picture():
            return _picture(finding)
        case FindingTable():
            return _table(finding)


_STATEMENTS = (
    '<table class="statements"><thead><tr><th class="place">Place</th><th>The paper says</th>'
    '<th>We find</th><th class="verdict-cell">Verdict</th></tr></thead><tbody>\n$rows\n'
    "</tbody></table>"
)


def _statement(statement: Statement) -> Html:
    """Return a statement as a row of an HTML table, with its verdict."""
    return fill(
        '<tr><td class="place">$place</td><td data-head="The paper says">$paper</td>'
        '<td data-head="We find">$ours</td>'
        '<td class="verdict-cell">$badge <small>$rule</small></td></tr>',
        place=text(statement.place),
        paper=text(statement.paper),
        ours=text(statement.ours),
        badge=_badge(statement.verdict),
        rule=text(statement.rule),
    )


def _badge(verdict: Verdict) -> Html:
    """Return a verdict as a coloured label in HTML."""
    kind = verdict.replace(" ", "-")
    return fill('<span class="verdict $kind">$verdict</span>', kind=kind, verdict=str(verdict))


def _picture(picture: Picture, wide: float = 7.0) -> Html:
    """Return a figure with its caption as HTML; figures wider than `wide`, inches, fill a row."""
    return fill(
        '<figure$wide><label title="enlarge"><input type="checkbox" aria-label="enlarge">'
        '<img alt="$alt" src="data:image/svg+xml;base64,$data"></label>'
        "<figcaption>$caption</figcaption></figure>",
        wide=Html(' class="wide"') if picture.figure.get_figwidth() > wide else "",
        alt=picture.caption,
        data=b64encode(picture.svg).decode(),
        caption=text(picture.caption),
    )


def _table(table: FindingTable) -> Html:
    """Return a table with its caption as HTML."""
    rows = (
        fill("<tr>$cells</tr>\n", cells=(fill("<td>$cell</td>", cell=text(cell)) for cell in row))
        for row in table.rows
    )
    return fill(
        '<p class="caption">$caption</p>\n<div class="scroll"><table class="numbers"><thead><tr>'
        "$heads</tr></thead><tbody>\n$rows</tbody></table></div>",
        caption=text(table.caption),
        heads=(fill("<th>$head</th>", head=text(head)) for head in table.heads),
        rows=rows,
    )
