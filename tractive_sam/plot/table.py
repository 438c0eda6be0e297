"""Tables of creep forces: how far they are off."""

import numpy as np

from tractive_sam.lookup import CreepTable
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.style import GREY, WIDTH, set_title, styled

LEAST = 1e-6
"""Of errors drawn: what is less is drawn there."""

NARROWEST = 3e-4
"""Of errors told that are drawn."""


@styled
def table_errors(table: CreepTable) -> Figure:
    """Errors of the points held out beside those that the table tells, and their distribution.

    Raises
    ------
    ValueError
        If the table holds no such points.

    Examples
    --------
    >>> plot.table_errors(ts.open_table("steel"))
    <Figure size ...>
    """
    if "check_errors" not in table.about:
        raise ValueError("the table holds no points that were held out; make it again")
    errors, told = (np.maximum(table.about[name], LEAST) for name in ("check_errors", "check_told"))
    tolerance = float(table.about["tolerance"])
    figure = Figure(figsize=(1.7 * WIDTH, 0.75 * WIDTH))
    left, right = figure.subplots(1, 2)
    names = ("$Q_x$", "$Q_y$", "$M_z/c$")
    for name, error, bar in zip(names, errors.T, told.T, strict=True):
        left.plot(bar, error, "o", markersize=2.5, label=name)
        share = np.arange(1, len(error) + 1) / len(error)
        right.plot(np.sort(error), share, label=name)
    low, high = LEAST, 2.0 * max(told.max(), errors.max(), tolerance)
    left.plot([low, high], [low, high], color=GREY, linewidth=0.8)
    left.set(xscale="log", yscale="log", xlim=(min(NARROWEST, told.min()), high), ylim=(low, high),
             xlabel=r"error told, over $\mu P$", ylabel=r"error, over $\mu P$")  # fmt: skip
    right.axvline(tolerance, color=GREY, linewidth=0.8)
    right.set(xscale="log", xlim=(low, high), ylim=(0.0, 1.0), ylabel="share of points")
    right.set_xlabel(r"error, over $\mu P$ (line: tolerance)")
    right.legend(loc="upper left")
    title = str(table.about.get("title", "")) or "a table"
    told_inside = f"{len(errors)} points held out, {table.about['held_out_inside']:.1%} within"
    set_title(figure, f"{title}: {told_inside} the error told")
    return figure
