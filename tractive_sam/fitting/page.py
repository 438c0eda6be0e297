"""The page of a fit: estimates, what is not determined, figures, and residuals."""

from collections.abc import Iterator
from os import PathLike
from pathlib import Path

from tractive_sam import interrupt
from tractive_sam.description import html_columns
from tractive_sam.fitting.entries import base_of
from tractive_sam.fitting.figures import fit_figures
from tractive_sam.fitting.results import DONE, FitResult
from tractive_sam.markup import Html, fill
from tractive_sam.output_file import write_file
from tractive_sam.pages import fill_page
from tractive_sam.scene import Scene


def report_fit(result: FitResult, path: str | PathLike[str]) -> Path:
    """Write a fit as one HTML page that needs no other file and no network.

    Parameters
    ----------
    result : FitResult
        A complete fit.
    path : path-like
        The page; replaced if it is there.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    OutputError
        If the page cannot be written.

    Examples
    --------
    >>> from tractive_sam import fitting
    >>> found = ts.fit({"scene": coarse, "free": ["friction.mu"], "data": [data]})
    >>> fitting.report_fit(found, "fit.html").stat().st_size < 1e6
    True
    """
    page = fill_page(
        __package__,
        "page",
        title=result.title or "A fit",
        status=result.status,
        kind="good" if result.status == DONE else "bad",
        message=str(result.dataset.attrs["message"]),
        notes=(
            fill('<p class="notice">$text</p>\n', text=text)
            for text in (*result.undetermined, *result.notes)
        ),
        facts=(
            fill("<tr><th>$name</th><td>$text</td></tr>\n", name=name, text=text)
            for name, text in result.summary().items()
            if name not in (*result.keys, "title", "status")
        ),
        tables=_tables(result),
        pictures=_pictures(result),
        design=result.design.to_toml(),
        version=str(result.dataset.attrs.get("version", "")),
    )
    return write_file(path, page)


def _pictures(result: FitResult) -> Iterator[Html]:
    """Yield the figures of a fit as HTML, with captions."""
    # Width of a picture, pixels.
    width = 460.0
    card = "<figure><figcaption>$caption</figcaption>$image</figure>\n"
    for _, caption, figure in fit_figures(result):
        interrupt.raise_if_interrupted()
        yield fill(card, caption=caption, image=figure.to_html(width))


def _tables(result: FitResult) -> Iterator[Html]:
    """Yield the tables of a fit as HTML, the estimates with the meaning of each key."""
    tables = result.tables()
    for row in tables["Estimates"]:
        row["meaning"] = Scene.find_field(base_of(row["parameter"])).title or ""
    for title, rows in tables.items():
        yield fill("<h2>$title</h2>\n$table\n", title=title, table=html_columns(rows))
