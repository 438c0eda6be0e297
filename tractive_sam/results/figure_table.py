"""Tables of contacts and histories for notebooks, next to a figure."""

from collections.abc import Mapping
from typing import Any

from tractive_sam.description import html_table
from tractive_sam.markup import Html


def html_with_figure(
    rows: Mapping[str, str], name: str, source: Any, wide: int = 380, narrow: int = 230
) -> Html:
    """Return HTML with rows (label, text) as a table next to a named figure of `plot`.

    Parameters
    ----------
    rows : mapping of str to str
        Rows of the table.
    name : str
        Name of a figure of `plot`; omitted if it has nothing to draw.
    source : State or History
        Argument of the figure.
    wide, narrow : int
        Width of a landscape and of a portrait figure, pixels.
    """
    # Figures are in a higher package; they are taken from the public package, as a user does.
    import tractive_sam  # noqa: PLC0415

    try:
        figure = getattr(tractive_sam.plot, name)(source)
    except (LookupError, ValueError):  # no fields, or nothing to draw
        return html_table(rows, Html())
    landscape = figure.get_figwidth() > figure.get_figheight()
    return html_table(rows, figure.to_html(wide if landscape else narrow))
