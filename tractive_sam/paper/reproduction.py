"""Compute every chapter of the paper, save its figures, and write the page."""

import json
from collections.abc import Callable, Iterator
from dataclasses import asdict
from functools import partial
from os import PathLike
from pathlib import Path
from time import perf_counter

from tractive_sam.output_file import make_folder, omit_failing_figure, write_file
from tractive_sam.paper import creep_force, discs, spheres
from tractive_sam.paper.page import (
    FULL,
    Chapter,
    Finding,
    Picture,
    Size,
    Statement,
    Work,
    chapter,
    page,
)
from tractive_sam.plot import FORMATS

CHAPTERS = (
    Chapter("Two spheres: stick, slip and stress", "Fig. 5", spheres.sphere_findings),
    Chapter("Force against creepage", "Fig. 6", creep_force.creep_force_findings),
    Chapter("Orthotropic friction", "Figs. 7 and 8", spheres.orthotropic_findings),
    Chapter("Wear against a global model", "Fig. 15, Table 1", discs.wear_depth_findings),
    Chapter("Twin discs: wear over the revolutions", "Figs. 9-14, 16-18", discs.disc_findings),
)
"""Groups of figures of the paper."""


def reproduce(
    directory: str | PathLike,
    *,
    size: Size = FULL,
    format: str = "png",
    progress: Callable[[int, str], None] = lambda done, line: None,
) -> Path:
    """Compute all figures and verdicts of the paper into a folder; return the path of the page.

    Parameters
    ----------
    directory : path-like
        Folder of the output. It is created, and earlier files in it are replaced: `index.html`, the
        page, which needs no other file; `statements.json`; the figures in `figures`; the results
        files of the discs in `results`.
    size : Size
        `FULL`, the paper's, or `REDUCED`.
    format : str
        Format of the figures, one of `plot.FORMATS`.
    progress : callable, optional
        Called with the number of complete chapters and a description of the running computation.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    ValueError
        If the format is unknown.
    NotConverged, RuntimeError
        If a contact was not solved.
    """
    if format not in FORMATS:
        raise ValueError(f"format: one of {', '.join(FORMATS)} is needed, not {format!r}")
    directory = Path(directory)
    figures, results = directory / "figures", directory / "results"
    for folder in (figures, results):
        make_folder(folder)
    target, list_of_statements = directory / "index.html", directory / "statements.json"
    for old in (target, list_of_statements):
        old.unlink(missing_ok=True)  # an interrupted run must not leave an earlier page
    began, chapters, statements = perf_counter(), [], list[Statement]()
    for number, about in enumerate(CHAPTERS):
        report = partial(progress, number)
        computed = about.find(Work(size, results, report))
        findings = _store_findings(computed, figures, format, statements, report)
        chapters.append((about, chapter(number, about, findings)))
    seconds = perf_counter() - began
    entries = [asdict(statement) for statement in statements]
    write_file(list_of_statements, json.dumps(entries, indent=1, ensure_ascii=False))
    return write_file(target, page(chapters, statements, size, seconds))


def _store_findings(
    findings: Iterator[Finding],
    figures: Path,
    format: str,
    statements: list[Statement],
    report: Callable[[str], None],
) -> Iterator[Finding]:
    """Yield each finding after its figure is saved or its statement added to `statements`."""
    for finding in findings:
        if isinstance(finding, Picture):
            report(f"figure {finding.name}")
            with omit_failing_figure(finding.name):
                _save(finding, figures, format)
                yield finding
            continue
        if isinstance(finding, Statement):
            statements.append(finding)
        yield finding


def _save(picture: Picture, figures: Path, format: str) -> None:
    """Write a figure to a file, and delete its files of earlier runs in any format."""
    for old in FORMATS:
        (figures / f"{picture.name}.{old}").unlink(missing_ok=True)
    path = figures / f"{picture.name}.{format}"
    if format == "svg":
        write_file(path, picture.svg)
    else:
        picture.figure.savefig(path)
