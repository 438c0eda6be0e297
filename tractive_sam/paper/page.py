"""One self-contained page of HTML: statements, tables, and figures embedded as vectors."""

import re
from base64 import b64encode
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from importlib.metadata import version
from importlib.resources import files
from itertools import groupby
from platform import python_version

from tractive_sam.markup import Html, as_html, fill, security_policy
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


def chapter(number: int, about: Chapter, findings: Iterable[Finding]) -> Html:
    """Render a chapter; findings are taken one by one as they are rendered."""
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
    """Put rendered chapters under a head that counts the verdicts.

    Parameters
    ----------
    chapters : sequence of (Chapter, Html)
        In their order, as `chapter` renders them.
    statements : sequence of Statement
        All of them.
    size : Size
        What was computed.
    seconds : float
        Spent on it.
    """
    counts = Counter(statement.verdict for statement in statements)
    item = '<li><a href="#chapter-$number">$title</a><br><small>$figures</small></li>'
    contents = (
        fill(item, number=str(k), title=text(about.title), figures=text(about.figures))
        for k, (about, _) in enumerate(chapters)
    )
    count = '<li class="count"><b>$count</b>$badge</li>'
    versions = ", ".join(f"{name} {version(name)}" for name in PROGRAMS)
    parts = {name: files(__package__).joinpath(name).read_text("utf-8") for name in _PARTS}
    look = Html(f"\n{style()}{parts['page.css']}")
    return fill(
        parts["page.html"],
        policy=security_policy(styles=[look]),
        style=look,
        seconds=f"{seconds:.0f}",
        size=text(size.name),
        notice="" if size == FULL else fill('<p class="notice">$text</p>', text=text(COARSE)),
        counts=(
            fill(count, count=str(counts[verdict]), badge=_badge(verdict)) for verdict in Verdict
        ),
        contents=contents,
        chapters=Html("\n".join(rendered for _, rendered in chapters)),
        versions=text(f"{versions}, Python {python_version()}"),
    )


_PARTS = ("page.html", "page.css")


def text(plain: str) -> Html:
    """Escape plain text, with the indices of its symbols lowered and its minus signs drawn."""
    lowered = re.sub(
        r"(?<![A-Za-z])([A-Za-zξσµ])_([A-Za-z0-9]+)", r"\1<sub>\2</sub>", as_html(plain)
    )
    return Html(re.sub(r"(?<![\w.)])-(?=\d)", "−", lowered))


def _blocks(findings: Iterable[Finding]) -> Iterator[Html]:
    """Statements that follow one another in one table, figures in one grid."""
    for kind, group in groupby(findings, type):
        if kind is Statement:
            yield fill(_STATEMENTS, rows=Html("\n".join(map(_statement, group))))
        elif kind is Picture:
            pictures = Html("\n".join(map(_picture, group)))
            yield fill('<div class="figures">\n$pictures\n</div>', pictures=pictures)
        else:
            yield from map(_table, group)


_STATEMENTS = (
    '<table class="statements"><thead><tr><th class="place">Where</th><th>The paper says</th>'
    '<th>We find</th><th class="told">Verdict</th></tr></thead><tbody>\n$rows\n</tbody></table>'
)


def _statement(one: Statement) -> Html:
    return fill(
        '<tr><td class="place">$place</td><td data-head="The paper says">$paper</td>'
        '<td data-head="We find">$ours</td>'
        '<td class="told">$badge <small>$rule</small></td></tr>',
        place=text(one.place),
        paper=text(one.paper),
        ours=text(one.ours),
        badge=_badge(one.verdict),
        rule=text(one.rule),
    )


def _badge(verdict: Verdict) -> Html:
    kind = verdict.replace(" ", "-")
    return fill('<span class="verdict $kind">$verdict</span>', kind=kind, verdict=str(verdict))


def _picture(one: Picture) -> Html:
    return fill(
        '<figure$wide><label title="enlarge"><input type="checkbox" aria-label="enlarge">'
        '<img alt="$alt" src="data:image/svg+xml;base64,$data"></label>'
        "<figcaption>$caption</figcaption></figure>",
        wide=Html(' class="wide"') if one.figure.get_figwidth() > WIDE else "",
        alt=one.caption,
        data=b64encode(one.svg).decode(),
        caption=text(one.caption),
    )


def _table(one: Table) -> Html:
    rows = (
        fill("<tr>$cells</tr>\n", cells=(fill("<td>$cell</td>", cell=text(cell)) for cell in row))
        for row in one.rows
    )
    return fill(
        '<p class="caption">$caption</p>\n<div class="scroll"><table class="numbers"><thead><tr>'
        "$heads</tr></thead><tbody>\n$rows</tbody></table></div>",
        caption=text(one.caption),
        heads=(fill("<th>$head</th>", head=text(head)) for head in one.heads),
        rows=rows,
    )
