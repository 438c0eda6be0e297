"""Tractions along lines in the rolling direction."""

import numpy as np
from matplotlib.axes import Axes

from tractive_sam.plot.contact_view import ContactView
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.needs import WIDE, has_traction
from tractive_sam.plot.registry import contact_figure
from tractive_sam.plot.style import LOOK, new_figure, set_title


@contact_figure("traction-sections", needs=[WIDE], shown=has_traction)
def traction_sections(view: ContactView, offset: float = 0.75) -> Figure:
    """Tractions on body A along y = 0 and y = 0.75 half widths, between their bounds.

    The second line is at y = 0.75 a, or 0.75 b if the half width b is less than a or more than
    three times a. Lines outside of the contact are omitted.
    The bounds are the largest values of one component: the extent of the friction
    ellipse in x and in y. Both components together are smaller.

    Examples
    --------
    >>> plot.traction_sections(contact)
    <Figure size ...>
    """
    scale = view.scale
    half, symbol = scale.a, scale.a_symbol
    if not offset * scale.a < scale.b < 3.0 * scale.a:
        half, symbol = scale.b, scale.b_symbol
    lines = {"$y = 0$": 0.0, f"$y = {offset}\\,{symbol}$": offset * half}
    pressure = view.contact.pressure
    lines = {name: y for name, y in lines.items() if _along_line(view, pressure, y).any()} or {
        "row of the largest pressure": float(view.y[pressure.max(axis=0).argmax()])
    }
    figure = new_figure(1.8 if len(lines) > 1 else 1.2, 0.6)
    panels = figure.subplots(1, len(lines), sharex=True, sharey=True, squeeze=False)[0]
    for axes, (name, y) in zip(panels, lines.items(), strict=True):
        draw_tractions(axes, view, y)
        axes.set_title(name, loc="center")
    panels[0].set_ylabel(scale.pressure_label("p"))
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside right center")
    figure.supxlabel(scale.length_label("x") + view.edge_note, fontsize="medium")
    set_title(figure, view.describe("tractions on A"))
    return figure


def draw_tractions(
    axes: Axes, view: ContactView, y: float, *, margin: float = 0.08, negligible: float = 1e-3
) -> None:
    """Draw the tractions of a contact along a line of constant y, between their bounds.

    Parameters
    ----------
    axes : Axes
        Axes over x.
    view : ContactView
        The contact.
    y : float
        Position of the line, mm.
    margin : float
        Margin before and behind the contact, in half widths a.
    negligible : float
        Smallest component that is drawn, relative to the largest traction.
    """
    x, contact = view.x_over_a, view.contact
    axes.axhline(0.0, color=LOOK.grey, linewidth=0.6)
    largest = np.abs(contact.traction).max(axis=(1, 2))
    significant = largest > negligible * largest.max()
    pressure = _along_line(view, contact.pressure, y)
    same = np.isclose(*view.bound_ratios)
    for k, (name, color) in enumerate((("x", LOOK.blue), ("y", LOOK.vermillion))):
        bound = view.bound_ratios[k] * pressure
        if same and k == 0:
            label = r"$\pm\mu\,p_n$" if view.isotropic else "largest value of one component"
            _draw_bounds(axes, x, bound, LOOK.grey, label)
        elif not same and significant[k]:
            _draw_bounds(axes, x, bound, color, f"bound of $p_{name}$")
        if significant[k]:
            traction = _along_line(view, contact.traction[k], y)
            axes.plot(x, traction, color=color, label=f"$p_{name}$")
    inside = x[contact.touching.any(axis=1)]
    axes.set_xlim(inside.min() - margin, inside.max() + margin)


def _draw_bounds(axes: Axes, x: np.ndarray, bound: np.ndarray, color: str, label: str) -> None:
    """Fill the range between a traction bound (n_x,) and its negative."""
    axes.fill_between(x, -bound, bound, color=color, alpha=0.1, linewidth=0)
    axes.plot(x, bound, color=color, linewidth=0.7, linestyle="--", label=label)
    axes.plot(x, -bound, color=color, linewidth=0.7, linestyle="--")


def _along_line(view: ContactView, values: np.ndarray, y: float) -> np.ndarray:
    """Return values (n_x,) along a line of constant y, over the scale's pressure."""
    return np.array([np.interp(y, view.y, row) for row in values]) / view.scale.pressure
