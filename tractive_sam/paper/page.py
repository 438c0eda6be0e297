"""One self-contained page of HTML: statements, tables, and figures embedded as vectors."""

import re
from base64 import b64encode
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from html import escape
from importlib.metadata import version
from importlib.resources import files
from itertools import groupby
from platform import python_version
from string import Template

from tractive_sam.pages import style
from tractive_sam.paper.finding import Chapter, Finding, Picture, Statement, Table, Verdict
from tractive_sam.paper.size import FULL, Size

WIDE = 7.0
"""Width of a figure that takes a row for itself, inches."""

COARSE = (
    "A reduced size, with coarse meshes and few revolutions. It shows that everything runs: "
    "neither its numbers nor its verdicts are those of the paper's size."
)

PROGRAMS = ("tractive-sam", "numpy", "scipy", "pyfftw", "numba")


def chapter(number: int, about: Chapter, findings: Iterable[Finding]) -> str:
    """Render a chapter; findings are taken one by one as they are rendered."""
    up = '<a class="up" href="#contents">contents</a>'
    title = f"{up}{text(about.title)}<small>{text(about.figures)}</small>"
    head = f'<h2 id="chapter-{number}">{title}</h2>'
    return "\n".join([head, *_blocks(findings)])


def page(
    chapters: Sequence[tuple[Chapter, str]],
    statements: Sequence[Statement],
    size: Size,
    seconds: float,
) -> str:
    """Put rendered chapters under a head that counts the verdicts.

    Parameters
    ----------
    chapters : sequence of (Chapter, str)
        In their order, as `chapter` renders them.
    statements : sequence of Statement
        All of them.
    size : Size
        What was computed.
    seconds : float
        Spent on it.
    """
    counts = Counter(statement.verdict for statement in statements)
    contents = (
        f'<li><a href="#chapter-{number}">{text(about.title)}</a><br>'
        f"<small>{text(about.figures)}</small></li>"
        for number, (about, _) in enumerate(chapters)
    )
    versions = ", ".join(f"{name} {version(name)}" for name in PROGRAMS)
    return Template(files(__package__).joinpath("page.html").read_text("utf-8")).substitute(
        style=style(),
        seconds=f"{seconds:.0f}",
        size=text(size.name),
        notice="" if size == FULL else f'<p class="notice">{text(COARSE)}</p>',
        counts="".join(
            f'<li class="count"><b>{counts[verdict]}</b>{_badge(verdict)}</li>'
            for verdict in Verdict
        ),
        contents="".join(contents),
        chapters="\n".join(rendered for _, rendered in chapters),
        versions=text(f"{versions}, Python {python_version()}"),
    )


def text(plain: str) -> str:
    """Escape plain text, with the indices of its symbols lowered and its minus signs drawn."""
    lowered = re.sub(
        r"(?<![A-Za-z])([A-Za-zξσµ])_([A-Za-z0-9]+)", r"\1<sub>\2</sub>", escape(plain, quote=False)
    )
    return re.sub(r"(?<![\w.)])-(?=\d)", "−", lowered)


def _blocks(findings: Iterable[Finding]) -> Iterator[str]:
    """Statements that follow one another in one table, figures in one grid."""
    for kind, group in groupby(findings, type):
        if kind is Statement:
            heads = '<th class="place">Where</th><th>The paper says</th><th>We find</th>'
            rows = "\n".join(map(_statement, group))
            yield (
                f'<table class="statements"><thead><tr>{heads}<th class="told">Verdict</th></tr>'
                f"</thead><tbody>\n{rows}\n</tbody></table>"
            )
        elif kind is Picture:
            yield '<div class="figures">\n' + "\n".join(map(_picture, group)) + "\n</div>"
        else:
            yield from map(_table, group)


def _statement(one: Statement) -> str:
    return (
        f'<tr><td class="place">{text(one.place)}</td>'
        f'<td data-head="The paper says">{text(one.paper)}</td>'
        f'<td data-head="We find">{text(one.ours)}</td>'
        f'<td class="told">{_badge(one.verdict)} <small>{text(one.rule)}</small></td></tr>'
    )


def _badge(verdict: Verdict) -> str:
    return f'<span class="verdict {verdict.replace(" ", "-")}">{verdict}</span>'


def _picture(one: Picture) -> str:
    data = b64encode(one.svg).decode()
    wide = ' class="wide"' if one.figure.get_figwidth() > WIDE else ""
    return (
        f'<figure{wide}><label title="enlarge"><input type="checkbox" aria-label="enlarge">'
        f'<img alt="{escape(one.caption)}" src="data:image/svg+xml;base64,{data}"></label>'
        f"<figcaption>{text(one.caption)}</figcaption></figure>"
    )


def _table(one: Table) -> str:
    heads = "".join(f"<th>{text(head)}</th>" for head in one.heads)
    rows = "\n".join(
        "<tr>" + "".join(f"<td>{text(cell)}</td>" for cell in row) + "</tr>" for row in one.rows
    )
    return (
        f'<p class="caption">{text(one.caption)}</p>\n'
        f'<div class="scroll"><table class="numbers"><thead><tr>{heads}</tr></thead><tbody>\n{rows}'
        "\n</tbody></table></div>"
    )
