"""The page of a history: every stored record with a slider, and the course of all numbers."""

import json
import re
import warnings
from collections.abc import Sequence
from importlib.metadata import version
from importlib.resources import files
from os import PathLike
from pathlib import Path
from typing import Any

from tractive_sam import interrupt
from tractive_sam.extras import require_extra
from tractive_sam.output_file import omit_failing_figure, write_file
from tractive_sam.pages.data import page_data
from tractive_sam.plot import Measurements, list_figures
from tractive_sam.results import History, describe_history
from tractive_sam.safe_text import Content, Html, fill, security_policy
from tractive_sam.scene import Scene


def fill_page(package: str, name: str, scripts: Sequence[str] = (), **content: Content) -> Html:
    """Return a page that needs no other file, from the body and the style sheet of a package.

    Parameters
    ----------
    package, name : str
        The package whose files "name.html", a template of the body, and "name.css" are used.
    scripts : sequence of str
        Scripts in the body that may run. With scripts, style attributes and empty style elements
        are allowed: plotly sets the attributes and fills the elements, and neither runs anything.
    **content : str or iterable of Html
        Content of the placeholders: the title, further elements of the head if there are any, and
        the placeholders of the body. See `fill`.
    """
    shared, own = files(__package__), files(package)
    sheets = shared.joinpath("style.css"), own.joinpath(f"{name}.css")
    style = Html("\n".join(["", *(sheet.read_text("utf-8") for sheet in sheets)]))
    policy = security_policy(scripts, [style, ""] if scripts else [style], bool(scripts))
    body = own.joinpath(f"{name}.html").read_text("utf-8")
    template = shared.joinpath("page.html").read_text("utf-8").replace("$body", body)
    return fill(template, **({"head": ""} | content), policy=policy, style=style)


SCRIPT_FIGURES = """
pressure traction traction-sections stick-slip slip wear friction temperature von-mises-{plane}
forces widths stick creepages wear-depth worn-mass {stress_max} fatigue-course block-shares
profiles wear-profiles worn-profiles pressure-profiles pressure-over-{coordinate}
slip-over-{coordinate} wear-over-{coordinate} wear-regimes
"""
"""Registered figures that are interactive on the page, and wear-regimes, which would load
compilers. All others are pictures."""


def report(
    history: History, path: str | PathLike[str], measured: Measurements | None = None
) -> Path:
    """Write a history as one interactive page that needs no other file and no network.

    A slider over the stored records moves pressure, traction with the edge of stick, slip, wear,
    sections and the stress planes together; every column that changes is drawn over the course.
    Fields are stored as float32, without the mesh outside of the contact.

    Parameters
    ----------
    history : History
        History to show; also of one record, of a line contact, or of a running computation.
    path : path-like
        The page, for example "twin-discs.html"; an existing one is replaced.
    measured : Measurements, optional
        Measured points, which are drawn in the charts of the columns that have their names.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    ImportError
        If plotly is not installed, which comes with the extra ``report``.
    ValueError
        If measured columns are unknown.
    OSError
        If the page cannot be written; an existing one is unchanged.

    Examples
    --------
    >>> ts.report(history, "discs.html").stat().st_size < 15e6
    True
    """
    if measured is not None:
        measured.check(history)
    return write_file(path, _page(history, measured))


def _page(history: History, measured: Measurements | None) -> str:
    """Return the HTML of the interactive page of a history."""
    # Code with which plotly looks for a style of its maps; without an element, it would add one.
    guarded_style = r'getElementById\("([0-9a-f]{64})"\)'
    script, colours = _plotly()
    data = page_data(history, measured=measured) | {"colours": colours}
    own_script = files(__package__).joinpath("report.js").read_text("utf-8")
    kind = "good" if history.finished else "part" if history.status == "running" else "bad"
    notes, facts = [*_notes(history), *data.pop("leftOut")], describe_history(history)
    text = json.dumps(data, allow_nan=False)
    for sign in "<\u2028\u2029":  # text must not end the script element that contains it
        text = text.replace(sign, f"\\u{ord(sign):04x}")
    named = [f"{name} {number}" for name, number in history.versions.items()]
    return fill_page(
        __package__,
        "report",
        [script, own_script],
        title=history.title or "A rolling contact",
        head=(
            fill('<style id="$name"></style>', name=name)
            for name in set(re.findall(guarded_style, script))
        ),
        status=history.status,
        kind=kind,
        message=history.message,
        notes=(fill('<p class="notice">$note</p>\n', note=note) for note in notes),
        facts=(fill("<dt>$name</dt><dd>$text</dd>", name=k, text=v) for k, v in facts.items()),
        pictures=_pictures(history),
        scene=_scene(history),
        versions=", ".join(named or [f"tractive-sam {version('tractive-sam')}"]),
        plotly=Html(script),
        data=Html(text),
        script=Html(own_script),
    )


def _plotly() -> tuple[str, dict[str, Any]]:
    """Return (source of plotly's script, plotly's colour scales by the names on the page)."""
    same = "Viridis", "Magma", "Inferno", "Cividis", "Plasma"
    scales = {"RdBu": "RdBu_r"} | {name: name for name in same}  # plotly's names by the page's
    with require_extra("report"):
        from plotly.colors import get_colorscale  # noqa: PLC0415 - of an extra
        from plotly.offline import get_plotlyjs  # noqa: PLC0415
    return get_plotlyjs(), {name: get_colorscale(plotly) for name, plotly in scales.items()}


def _pictures(history: History, width: float = 460.0) -> Html:
    """Return a section (HTML) with the figures that the page's script does not draw."""
    card_template = '<figure class="card"><figcaption>$caption</figcaption>$image</figure>\n'
    cards, names = [], SCRIPT_FIGURES.split()
    for drawing in list_figures(history):
        if drawing.registered not in names:
            interrupt.raise_if_interrupted()
            with omit_failing_figure(drawing.name):
                image = drawing.draw().to_html(width)
                cards.append(fill(card_template, caption=drawing.caption, image=image))
    return fill(_SECTION, cards=cards) if cards else Html()


_SECTION = """<section id="pictures" aria-labelledby="pictures-head">
<h2 id="pictures-head">Further figures</h2>
<div class="cards wide">
$cards</div>
</section>
"""


def _notes(history: History) -> list[str]:
    """Return the warnings that the scene of a history causes, each once."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        Scene(**history.scene.entries())
    return list(dict.fromkeys(str(warning.message) for warning in caught))


def _scene(history: History, limit: int = 20_000) -> str:
    """Return the scene of a history as TOML, cut after `limit` characters."""
    text = history.scene.to_toml()
    excess = len(text) - limit
    return text if excess <= 0 else f"{text[:limit]}\n... and {excess} characters more"
