"""The run: every chapter computed, its figures saved, the page written."""

import json
from collections.abc import Callable, Iterator
from dataclasses import asdict
from functools import partial
from os import PathLike
from pathlib import Path
from time import perf_counter

from tractive_sam.output_file import make_folder, write_file
from tractive_sam.paper import creep_force, discs, orthotropic, spheres, wear_depth
from tractive_sam.paper.finding import Chapter, Finding, Picture, Statement, Work
from tractive_sam.paper.page import chapter, page
from tractive_sam.paper.size import FULL, Size
from tractive_sam.plot import FORMATS

CHAPTERS = (
    Chapter("Two spheres: stick, slip and stress", "Fig. 5", spheres.find),
    Chapter("Force against creepage", "Fig. 6", creep_force.find),
    Chapter("Orthotropic friction", "Figs. 7 and 8", orthotropic.find),
    Chapter("Wear against a global model", "Fig. 15, Table 1", wear_depth.find),
    Chapter("Twin discs: wear over the revolutions", "Figs. 9-14, 16-18", discs.find),
)
"""The paper's figures, by groups."""


def reproduce(
    directory: str | PathLike,
    *,
    size: Size = FULL,
    format: str = "png",
    tell: Callable[[int, str], None] = lambda done, line: None,
) -> Path:
    """Compute every figure and table of the paper, and set its statements beside our numbers.

    Parameters
    ----------
    directory : path-like
        Where to; made if it does not exist, and what an earlier run left there is replaced:
        `index.html`, the page, which needs no other file; `statements.json`; the figures in
        `figures`; the results files of the discs in `results`.
    size : Size
        `FULL`, the paper's, or `REDUCED`.
    format : str
        Of the figures in their files, one of `plot.FORMATS`.
    tell : callable, optional
        Called with the number of chapters done and a line that says what is being done.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    ValueError
        If there is no such format.
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
        old.unlink(missing_ok=True)  # a run that is interrupted must not leave the page of another
    began, chapters, statements = perf_counter(), [], []
    for number, about in enumerate(CHAPTERS):
        told = partial(tell, number)
        findings = _kept(about.find(Work(size, results, told)), figures, format, statements, told)
        chapters.append((about, chapter(number, about, findings)))
    seconds = perf_counter() - began
    listed = [asdict(statement) for statement in statements]
    write_file(list_of_statements, json.dumps(listed, indent=1, ensure_ascii=False))
    return write_file(target, page(chapters, statements, size, seconds))


def _kept(
    findings: Iterator[Finding],
    figures: Path,
    format: str,
    statements: list[Statement],
    tell: Callable[[str], None],
) -> Iterator[Finding]:
    """Findings as they come, figures saved and statements listed."""
    for finding in findings:
        if isinstance(finding, Picture):
            tell(f"figure {finding.name}")
            _save(finding, figures, format)
        elif isinstance(finding, Statement):
            statements.append(finding)
        yield finding


def _save(picture: Picture, figures: Path, format: str) -> None:
    """Write a figure in place of its file of an earlier run, in whatever format that was."""
    for old in FORMATS:
        (figures / f"{picture.name}.{old}").unlink(missing_ok=True)
    path = figures / f"{picture.name}.{format}"
    if format == "svg":
        write_file(path, picture.svg)
    else:
        picture.figure.savefig(path)
