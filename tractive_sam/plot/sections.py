"""Tractions along lines in the rolling direction."""

import numpy as np
from matplotlib.axes import Axes

from tractive_sam.plot.conditions import WIDE, driven
from tractive_sam.plot.drawn import Drawn
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.registry import contact_figure
from tractive_sam.plot.style import BLUE, GREY, VERMILLION, WIDTH, set_title

OFF_CENTRE = 0.75
"""Second line, in half widths a of the contact, or of b where the contact is narrower in y."""

NEGLIGIBLE = 1e-3
"""Component of the traction, relative to the largest traction, that is not drawn."""

MARGIN = 0.08
"""Before and behind the contact, in half widths a."""


@contact_figure("traction-sections", needs=[WIDE], shown=driven)
def traction_sections(state: Drawn) -> Figure:
    """Tractions on body A along y = 0 and y = 0.75 a, between what friction allows.

    The bounds are the largest values of either component, the extent of the friction ellipse in x
    and in y; both components together reach less.

    Examples
    --------
    >>> plot.traction_sections(contact)
    <Figure size ...>
    """
    scale = state.scale
    off = (scale.a, scale.a_symbol) if OFF_CENTRE * scale.a < scale.b else (scale.b, scale.b_symbol)
    lines = {"$y = 0$": 0.0, f"$y = {OFF_CENTRE}\\,{off[1]}$": OFF_CENTRE * off[0]}
    figure = Figure(figsize=(1.8 * WIDTH, 0.6 * WIDTH))
    axes = figure.subplots(1, len(lines), sharex=True, sharey=True)
    for ax, (name, y) in zip(axes, lines.items(), strict=True):
        section(ax, state, y)
        ax.set_title(name, loc="center")
        ax.set_xlabel(scale.of_length("x") + state.ahead)
    axes[0].set_ylabel(scale.of_pressure("p"))
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside right center")
    set_title(figure, state.told("tractions on A"))
    return figure


def section(ax: Axes, state: Drawn, y: float) -> None:
    """Draw the tractions along a line of constant y, in mm, between their bounds."""
    x, contact = state.x_over_a, state.contact
    ax.axhline(0.0, color=GREY, linewidth=0.6)
    drawn = (
        np.abs(state.contact.traction).max(axis=(1, 2))
        > NEGLIGIBLE * np.abs(state.contact.traction).max()
    )
    p_n = _along(state, state.contact.pressure, y)
    same = np.isclose(*state.bounds)
    for k, (name, color) in enumerate((("x", BLUE), ("y", VERMILLION))):
        bound = state.bounds[k] * p_n
        if same and k == 0:
            _bounds(
                ax,
                x,
                bound,
                GREY,
                r"$\pm\mu\,p_n$" if state.isotropic else "reach of either component",
            )
        elif not same and drawn[k]:
            _bounds(ax, x, bound, color, f"bound of $p_{name}$")
        if drawn[k]:
            ax.plot(x, _along(state, contact.traction[k], y), color=color, label=f"$p_{name}$")
    inside = x[contact.touching.any(axis=1)]
    ax.set_xlim(inside.min() - MARGIN, inside.max() + MARGIN)


def _bounds(ax: Axes, x: np.ndarray, bound: np.ndarray, color: str, label: str) -> None:
    ax.fill_between(x, -bound, bound, color=color, alpha=0.1, linewidth=0)
    ax.plot(x, bound, color=color, linewidth=0.7, linestyle="--", label=label)
    ax.plot(x, -bound, color=color, linewidth=0.7, linestyle="--")


def _along(state: Drawn, values: np.ndarray, y: float) -> np.ndarray:
    """Values along a line of constant y, over the scale's pressure, shape (n_x,)."""
    rows = [np.interp(y, state.y, row) for row in values]
    return np.array(rows) / state.scale.pressure
