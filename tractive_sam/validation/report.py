"""Compute the published sets, and write a page and a table of all comparisons."""

import csv
import io
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from importlib.metadata import version
from os import PathLike
from pathlib import Path
from platform import python_version

from tractive_sam.output_file import make_folder, write_file
from tractive_sam.pages import fill_page
from tractive_sam.safe_text import Html, as_html, fill
from tractive_sam.validation import closed_forms, durability, experiment, rolling, wheel_rail
from tractive_sam.validation.comparison import Comparison, Outcome, PublishedSet, Topic, Verdict

TOPICS = (
    Topic("Closed forms of contact and stress", closed_forms.SETS),
    Topic("Creep forces, friction laws and transients", rolling.SETS),
    Topic("Fatigue and temperature", durability.SETS),
    Topic("Wheel and rail", wheel_rail.SETS),
    Topic("Experiments", experiment.SETS),
)
"""All published sets."""


def select_sets(quick: bool = False, words: Iterable[str] = ()) -> tuple[Topic, ...]:
    """Return the topics with the sets that are selected.

    Parameters
    ----------
    quick : bool
        Whether only the quick half is selected.
    words : iterable of str
        Words or phrases; a set is selected if its topic, title or source contains one of them, in
        any case. Without them, all sets are selected.

    Raises
    ------
    ValueError
        If a word occurs in no set.
    """
    wanted = [word.casefold() for word in words]

    def texts(topic: Topic, one: PublishedSet) -> str:
        return f"{topic.title} {one.title} {one.source}".casefold()

    everything = [texts(topic, one) for topic in TOPICS for one in topic.sets]
    for word in wanted:
        if not any(word in text for text in everything):
            raise ValueError(f"{word!r} occurs in no title and no source of a published set")
    selected = []
    for topic in TOPICS:
        sets = tuple(
            one
            for one in topic.sets
            if (one.quick or not quick)
            and (not wanted or any(word in texts(topic, one) for word in wanted))
        )
        if sets:
            selected.append(Topic(topic.title, sets))
    return tuple(selected)


def validate(
    directory: str | PathLike,
    topics: Sequence[Topic] = TOPICS,
    *,
    progress: Callable[[Outcome], None] = lambda outcome: None,
) -> list[Outcome]:
    """Compute published sets into a folder; return their outcomes.

    Parameters
    ----------
    directory : path-like
        Folder of the output. It is created, and earlier files in it are replaced: `index.html`, a
        page that needs no other file, and `comparisons.csv`, a row for each value. If the
        computation is interrupted, both contain the sets so far.
    topics : sequence of Topic
        Published sets, by default all of them; see `select_sets`.
    progress : callable, optional
        Called with each outcome.

    Returns
    -------
    list of Outcome
        Outcomes in the order of the sets.
    """
    directory = Path(directory)
    make_folder(directory)
    outcomes: list[Outcome] = []
    try:
        for topic in topics:
            for one in topic.sets:
                outcomes.append(one.run())
                progress(outcomes[-1])
    finally:
        expected = sum(len(topic.sets) for topic in topics)
        write_file(directory / "comparisons.csv", _as_csv(outcomes))
        write_file(directory / "index.html", _page(topics, outcomes, expected - len(outcomes)))
    return outcomes


_HEADINGS = (
    "set", "source", "quantity", "published", "computed", "difference", "allowed", "verdict",
)  # fmt: skip


def _as_csv(outcomes: Iterable[Outcome]) -> str:
    """Return a table of all comparisons, with the CPU seconds of their set."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow((*_HEADINGS, "CPU s"))
    for outcome in outcomes:
        about = outcome.of.title, outcome.of.source
        for one in outcome.comparisons:
            numbers = (f"{v:.6g}" for v in (one.computed, one.difference, one.allowed))
            row = one.quantity, one.published, *numbers, outcome.verdict(one).value
            writer.writerow((*about, *row, f"{outcome.seconds:.3g}"))
        if outcome.failure:
            writer.writerow((*about, "", "", "", "", "", Verdict.FAILED.value, outcome.failure))
    return text.getvalue()


def _page(topics: Sequence[Topic], outcomes: Sequence[Outcome], missing: int) -> Html:
    """Return the page of the outcomes, with a head that counts the verdicts."""
    by_set = {id(outcome.of): outcome for outcome in outcomes}
    counts = Counter(outcome.verdict(one) for outcome in outcomes for one in outcome.comparisons)
    counts[Verdict.FAILED] += sum(bool(outcome.failure) for outcome in outcomes)
    count = '<li class="count"><b>$count</b>$badge</li>'
    contents, sections = [], []
    for number, topic in enumerate(topics):
        found = [by_set[id(one)] for one in topic.sets if id(one) in by_set]
        sets = str(len(found))
        item = '<li><a href="#topic-$number">$title</a>, $sets sets</li>'
        contents.append(fill(item, number=str(number), title=topic.title, sets=sets))
        rows = Html("\n".join(row for outcome in found for row in _rows(outcome)))
        sections.append(fill(_SECTION, number=str(number), title=topic.title, rows=rows))
    programs = ("tractive-sam", "numpy", "scipy", "pyfftw", "numba")
    notice = f"The computation was interrupted: {missing} sets are missing."
    return fill_page(
        __package__,
        "page",
        title="Validation - tractive_sam",
        sets=str(len(outcomes)),
        values=str(sum(len(outcome.comparisons) for outcome in outcomes)),
        seconds=f"{sum(outcome.seconds for outcome in outcomes):.0f}",
        notice=fill('<p class="notice">$text</p>', text=notice) if missing else "",
        counts=(
            fill(count, count=str(counts[verdict]), badge=_badge(verdict)) for verdict in Verdict
        ),
        contents=contents,
        sections=Html("\n".join(sections)),
        versions=", ".join(f"{name} {version(name)}" for name in programs)
        + f", Python {python_version()}",
    )


_SECTION = (
    '<h2 id="topic-$number">$title</h2>\n<div class="scroll"><table><thead><tr><th>Quantity</th>'
    "<th>Published</th><th>Computed</th><th>Difference</th><th>Allowed</th><th>Verdict</th></tr>"
    "</thead><tbody>\n$rows\n</tbody></table></div>"
)


def _rows(outcome: Outcome) -> Iterator[Html]:
    """Yield a heading and the comparisons of a set as rows of an HTML table."""
    one = outcome.of
    remarks = [f"Allowed beside the digits: {one.error}." if one.error else ""]
    if outcome.worst is Verdict.EXPLAINED:
        remarks.append(one.explanation)
    remarks += [f"{v.quantity}: {v.reason}." for v in outcome.comparisons if v.reason]
    if outcome.failure:
        remarks.append(f"Not computed: {outcome.failure}")
    yield fill(
        '<tr class="set"><th colspan="6">$title <small>$source; $seconds s</small>'
        "<small>$remarks</small></th></tr>",
        title=one.title,
        source=one.source,
        seconds=f"{outcome.seconds:.2g}",
        remarks=" ".join(filter(None, remarks)),
    )
    for comparison in outcome.comparisons:
        difference = f"{comparison.difference:+.1e}"
        if comparison.value:
            difference = f"{comparison.difference / abs(comparison.value):+.3%}"
        yield fill(
            "<tr><td>$quantity</td><td>$published</td><td>$computed</td><td>$difference</td>"
            "<td>$allowed</td><td>$badge</td></tr>",
            quantity=comparison.quantity,
            published=_sign(comparison.published),
            computed=_sign(_like(comparison)),
            difference=_sign(difference),
            allowed=_sign(f"{comparison.allowed:.1e}"),
            badge=_badge(outcome.verdict(comparison)),
        )


def _like(comparison: Comparison) -> str:
    """Return the computed value with one digit more than the published one."""
    digits = len(comparison.published.split("e")[0].replace(".", "").strip("-0"))
    return f"{comparison.computed:#.{max(digits, 3) + 1}g}".rstrip(".")


def _sign(number: str) -> Html:
    """Return a number with a true minus sign."""
    return Html(as_html(number).replace("-", "−"))


def _badge(verdict: Verdict) -> Html:
    """Return a verdict as a coloured label in HTML."""
    kinds = {Verdict.AGREES: "good", Verdict.EXPLAINED: "part", Verdict.DIFFERS: "bad"}
    label = '<span class="badge $kind">$verdict</span>'
    return fill(label, kind=kinds.get(verdict, ""), verdict=verdict.value)
