"""``tractive-sam validate``: compare computed results with published ones."""

from pathlib import Path
from typing import Annotated, Any

import typer

from tractive_sam.cli.output import (
    incomplete_exit,
    invalid_exit,
    print_line,
    print_message,
    report_interrupt,
    show_progress,
)


def validate(
    words: Annotated[list[str] | None, typer.Argument(metavar="[WORD]...")] = None,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="DIR")] = Path("validation"),
    quick: Annotated[bool, typer.Option("--quick")] = False,
) -> None:
    """Compare computed results with published ones: closed forms, tables, programs, experiments.

    The command prints a line for each published set, and writes a page. If a value differs from the
    published one without an explanation, the exit status is 3.

    Parameters
    ----------
    words
        Compute only the sets whose topic, title or source contains one of these words.
    output
        Folder of the page and the table of all values; existing files are replaced.
    quick
        Compute only the sets of the quick half.
    """
    from tractive_sam.validation import Verdict, select_sets
    from tractive_sam.validation import validate as validate_sets

    try:
        topics = select_sets(quick, words or ())
    except ValueError as error:
        raise invalid_exit(f"WORD: {error}") from None
    if not (count := sum(len(topic.sets) for topic in topics)):
        raise invalid_exit("WORD: no selected set is in the quick half; omit --quick")
    done = 0
    note = f"{output / 'index.html'} contains the sets so far"
    with report_interrupt(note), show_progress() as update:

        def report(outcome: Any) -> None:
            nonlocal done
            done += 1
            agree = sum(one.agrees for one in outcome.comparisons)
            of = len(outcome.comparisons)
            print_line(
                f"{outcome.worst.value:18}  {agree:2} of {of:2}  {outcome.seconds:6.2f} s  "
                f"{outcome.of.title} ({outcome.of.source})"
            )
            update(done / count, outcome.of.title, "")

        outcomes = validate_sets(output, topics, progress=report)
    values = [(outcome, one) for outcome in outcomes for one in outcome.comparisons]
    agree = sum(one.agrees for _, one in values)
    explained = sum(outcome.verdict(one) is Verdict.EXPLAINED for outcome, one in values)
    failed = sum(bool(outcome.failure) for outcome in outcomes)
    print_message(
        f"{len(outcomes)} published sets, {len(values)} values: {agree} agree, {explained} differ "
        f"and are explained, {len(values) - agree - explained} differ; {failed} sets failed"
    )
    print_line(output / "index.html")
    if agree + explained < len(values) or failed:
        raise incomplete_exit("results differ from published ones; the page shows where")
