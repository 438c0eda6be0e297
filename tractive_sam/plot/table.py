"""Errors of tables of creep forces."""

import numpy as np

from tractive_sam.lookup import CreepTable
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.style import LOOK, apply_style, new_figure, set_title


@apply_style
def table_errors(table: CreepTable, *, smallest: float = 1e-6) -> Figure:
    """Draw the errors at the check points against the reported errors, and their distribution.

    Parameters
    ----------
    table : CreepTable
        A table with check points in its file.
    smallest : float
        Smallest error that is drawn; smaller ones are drawn there.

    Raises
    ------
    ValueError
        If the file of the table has no check points.

    Examples
    --------
    >>> plot.table_errors(ts.open_table("steel"))
    <Figure size ...>
    """
    about = table.about
    if "check_errors" not in about:
        raise ValueError("the file of the table has no check points; build the table again")
    errors, reported = (np.maximum(about[key], smallest) for key in ("check_errors", "check_told"))
    tolerance = float(about["tolerance"])
    figure = new_figure(1.7, 0.75)
    left, right = figure.subplots(1, 2)
    names = ("$Q_x$", "$Q_y$", "$M_z/c$")
    for name, error, bar in zip(names, errors.T, reported.T, strict=True):
        left.plot(bar, error, "o", markersize=2.5, label=name)
        share = np.arange(1, len(error) + 1) / len(error)
        right.plot(np.sort(error), share, label=name)
    low, high = smallest, 2.0 * max(reported.max(), errors.max(), tolerance)
    left.plot([low, high], [low, high], color=LOOK.grey, linewidth=0.8)
    left.set(xscale="log", yscale="log", xlim=(min(3e-4, reported.min()), high), ylim=(low, high),
             xlabel=r"reported error, over $\mu P$", ylabel=r"error, over $\mu P$")  # fmt: skip
    right.axvline(tolerance, color=LOOK.grey, linewidth=0.8)
    right.set(xscale="log", xlim=(low, high), ylim=(0.0, 1.0), ylabel="share of points")
    right.set_xlabel(r"error, over $\mu P$ (line: tolerance)")
    right.legend(loc="upper left")
    inside = f"{len(errors)} check points, {about['held_out_inside']:.1%} within"
    set_title(figure, f"{table.title or 'a table'}: {inside} the reported error")
    return figure
