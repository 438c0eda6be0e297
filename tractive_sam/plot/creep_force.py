"""Creep force over creepage, and the errors of tables of creep forces."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import cycle
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.lookup import CreepTable
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.style import LOOK, apply_style, new_axes, new_figure, set_title

MARKERS = "so^Dv"
"""Markers of computed points, in their order."""

Points = tuple[ArrayLike, ArrayLike]
"""Abscissae and ordinates of points."""


@apply_style
def creep_force_curve(
    computed: Mapping[str, Points],
    reference: Mapping[str, Points] | None = None,
    *,
    theory: bool = True,
) -> Figure:
    """Draw scaled creep-force curves of a circular contact, with reference and theory curves.

    Parameters
    ----------
    computed : mapping of str to pair of array_like
        Creep parameters (`reference.creep_parameter`) and forces Q/(mu P), by the label of a
        series.
    reference : mapping of str to pair of array_like, optional
        Points of other programs or of measurements.
    theory : bool
        Whether to draw the curves of Vermeulen & Johnson and of Kalker's simplified theory.

    Examples
    --------
    >>> plot.creep_force_curve({"computed": ([0.2, 0.5], [0.43, 0.82])})
    <Figure size ...>
    """
    reference = reference or {}
    figure, axes = new_axes(1.0, 0.72)
    for marker, (name, (xi, force)) in zip(cycle(MARKERS), computed.items(), strict=False):
        axes.plot(xi, force, marker, label=name, markerfacecolor="none", markeredgewidth=1.2)
    for marker, (name, (xi, force)) in zip(cycle("x+*"), reference.items(), strict=False):
        axes.plot(xi, force, marker, label=name, color=LOOK.grey)
    if theory:
        # Other figures need no reference solutions, whose interpolation takes long to load.
        from tractive_sam.reference import kalker_simplified, vermeulen_johnson  # noqa: PLC0415

        ends = [float(np.max(xi)) for xi, _ in (*computed.values(), *reference.values())]
        xi, grey = np.linspace(0.0, max(1.0, *ends), 201), LOOK.grey
        axes.plot(xi, vermeulen_johnson(xi), "--", color=grey, label="Vermeulen & Johnson (1964)")
        axes.plot(xi, kalker_simplified(xi), "-", color=grey, label="Kalker (1967), simplified")
    axes.set(xlabel=r"$-\xi_x\,16\,G a_0^2\,/\,3\mu P(4-3\nu)$", ylabel=r"$Q/(\mu P)$")
    axes.set_xlim(left=0.0)
    axes.legend(loc="lower right")
    return figure


@apply_style
def traction_curve(computed: Mapping[str, Points], printed: Points | None = None) -> Figure:
    """Draw Q_x/P over creepage with each falling curve's maximum, and printed values of CONTACT.

    Parameters
    ----------
    computed : mapping of str to pair of array_like
        Creepages and Q_x/P, by the label of a curve.
    printed : pair of array_like, optional
        Points of another program.

    Examples
    --------
    >>> curve = ([0.0, 0.01, 0.016, 0.05], [0.0, 0.301, 0.312, 0.285])
    >>> plot.traction_curve({"falling": curve})
    <Figure size ...>
    """
    figure, axes = new_axes(1.0, 0.72)
    highest = 0.0
    for marker, (name, (xi, force)) in zip(cycle(MARKERS), computed.items(), strict=False):
        percent, ratio = 100.0 * np.asarray(xi), np.asarray(force)
        (line,) = axes.plot(percent, ratio, marker + "-", ms=3, label=name)
        top = int(np.argmax(ratio))
        highest = max(highest, float(ratio[top]))
        if ratio[top] > 1.001 * ratio[-1]:
            label = f"top {ratio[top]:.3f} at {percent[top]:.2g} %"
            look: dict[str, Any] = {"textcoords": "offset points", "color": line.get_color()}
            axes.annotate(label, (percent[top], ratio[top]), (8, -34), **look)
    if printed is not None:
        style: dict[str, Any] = {
            "color": LOOK.grey,
            "mec": LOOK.vermillion,
            "label": "CONTACT 25.1, printed",
        }
        axes.plot(100.0 * np.asarray(printed[0]), np.asarray(printed[1]), "x", ms=6, **style)
    axes.set(xlabel=r"creepage $|\xi_x|$ (%)", ylabel=r"$Q_x/P$", xlim=(0.0, None))
    axes.set_ylim(bottom=0.0, top=1.12 * highest)
    axes.legend(loc="lower right")
    return figure


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
