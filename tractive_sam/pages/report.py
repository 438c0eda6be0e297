"""The page of a history: every stored record behind one slider, and the course of all numbers."""

import json
import warnings
from collections.abc import Iterator
from importlib.metadata import version
from importlib.resources import files
from os import PathLike
from pathlib import Path
from string import Template
from typing import Any

from tractive_sam.output_file import write_file
from tractive_sam.pages import text
from tractive_sam.pages.data import of_history
from tractive_sam.results import History, balances, caveats, rolled_on_by
from tractive_sam.scene import Scene, told

LONGEST_SCENE = 20_000
"""Characters of a scene that are shown: one with arrays has millions."""

SCALES = {
    "Viridis": "Viridis",
    "Magma": "Magma",
    "Inferno": "Inferno",
    "Cividis": "Cividis",
    "Plasma": "Plasma",
    "RdBu": "RdBu_r",
}
"""Colours as of the figures, by their names in the page and in plotly."""


def report(history: History, path: str | PathLike[str]) -> Path:
    """Write a history as one interactive page that needs no other file and no network.

    A slider over the stored records moves pressure, traction with the edge of stick, slip, wear,
    sections and the stress planes together; every column that changes is drawn over the course.
    Fields go without the mesh beside the contact, as float32.

    Parameters
    ----------
    history : History
        What to show; also of one record, of a line contact, or of a computation that still runs.
    path : path-like
        The page, as "twin-discs.html"; replaced if it is there.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    ImportError
        If plotly is not installed, which comes with the extra ``report``.
    OSError
        If the page cannot be written; one that was there before is unchanged.

    Examples
    --------
    >>> ts.report(history, "discs.html").stat().st_size < 15e6
    True
    """
    return write_file(path, _page(history))


def _page(history: History) -> str:
    script, colours = _plotly()
    data = of_history(history) | {"colours": colours}
    parts = {name: files(__package__).joinpath(name).read_text("utf-8") for name in _PARTS}
    kind = "good" if history.finished else "part" if history.status == "running" else "bad"
    notes = [*_notes(history), *data.pop("leftOut")]
    named = [f"{name} {number}" for name, number in history.versions.items()]
    return Template(parts["report.html"]).substitute(
        title=text.told(history.title or "A rolling contact"),
        style=parts["style.css"] + parts["report.css"],
        status=text.told(history.status),
        kind=kind,
        message=text.told(history.message),
        notes="".join(f'<p class="notice">{text.told(note)}</p>\n' for note in notes),
        facts="".join(f"<dt>{name}</dt><dd>{text.told(one)}</dd>" for name, one in _facts(history)),
        scene=text.told(_scene(history)),
        versions=text.told(", ".join(named or [f"tractive-sam {version('tractive-sam')}"])),
        plotly=script,
        data=_harmless(json.dumps(data, allow_nan=False)),
        script=parts["report.js"],
    )


_PARTS = ("report.html", "report.js", "report.css", "style.css")


def _plotly() -> tuple[str, dict[str, Any]]:
    """The script that draws, and the colours of the figures."""
    try:
        from plotly.colors import get_colorscale  # noqa: PLC0415 - of an extra
        from plotly.offline import get_plotlyjs  # noqa: PLC0415
    except ImportError as error:
        cure = "pip install '.[report]' in the source folder of tractive_sam"
        missing = f"{error.name} is not installed: it comes with the extra report, {cure}"
        raise ImportError(missing, name=error.name) from None
    return get_plotlyjs(), {name: get_colorscale(plotly) for name, plotly in SCALES.items()}


def _harmless(data: str) -> str:
    """JSON that ends no script, whatever a title holds."""
    return data.replace("<", "\\u003c")


def _facts(history: History) -> Iterator[tuple[str, str]]:
    """What was computed, by what is told of it."""
    if history.p0 == history.p0:
        hertz = f"a0 = {history.a0:.5g} mm, b0 = {history.b0:.5g} mm, p0 = {history.p0:.6g} MPa"
        yield "unworn contact", f"{hertz} by Hertz"
    yield from told.told(history.scene).items()
    yield "records", f"{len(history)}, {len(history.saved)} with fields"
    if history.laws:
        yield "laws of its own", history.laws
    if others := rolled_on_by(history):
        yield "rolled on by", others
    for name, found in balances(history).items():
        yield f"{name} balance", found
    yield from caveats(history).items()
    totals = history.totals
    if totals["contact_solves"]:
        spent = f"{totals['contact_solves']} contacts solved in {totals['wall_seconds']:.3g} s"
        yield "cost", spent


def _notes(history: History) -> list[str]:
    """What is doubtful about the scene, each once."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        Scene(**history.scene.entries())
    return list(dict.fromkeys(str(one.message) for one in caught))


def _scene(history: History) -> str:
    written = history.scene.to_toml()
    if len(written) <= LONGEST_SCENE:
        return written
    return f"{written[:LONGEST_SCENE]}\n... and {len(written) - LONGEST_SCENE} characters more"
