"""Functions of y, one line for each stored revolution."""

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tractive_sam.plot.scale import Scale
from tractive_sam.plot.style import MICRON, WIDTH, set_title, styled
from tractive_sam.record import History

MOST = 8
"""Lines of a figure; of more revolutions some are left out."""


def chosen(revolutions: np.ndarray, most: int = MOST) -> np.ndarray:
    """At most so many of the revolutions, the first and the last among them."""
    if len(revolutions) <= most:
        return revolutions
    return revolutions[np.linspace(0, len(revolutions) - 1, most).round().astype(int)]


@styled
def wear_profiles(history: History) -> Figure:
    """Wear depth of both bodies together across the track, at the stored revolutions.

    Examples
    --------
    >>> plot.wear_profiles(history)
    <Figure size ...>
    """
    figure, axes = _across(history)
    depth = dict(zip(history["revolution"], history["wear_profile"], strict=True))
    _lines(axes, history, lambda revolution: MICRON * depth[revolution])
    axes.invert_yaxis()
    axes.set_ylabel(r"wear depth $w$ ($\mathrm{\mu m}$)")
    return figure


@styled
def worn_profiles(history: History) -> Figure:
    """Cross-sections of both bodies at x = 0, A above B, at the stored revolutions.

    Each body by its own radius, less the depth worn off it; as if they touched at one point.

    Examples
    --------
    >>> plot.worn_profiles(history)
    <Figure size ...>
    """
    figure, axes = _across(history)
    row = {revolution: k for k, revolution in enumerate(history["revolution"])}
    for body, sign in (("A", 1.0), ("B", -1.0)):
        radius = history.settings["body"][body]["radius_y"]
        shape = 0.5 * history.y**2 / radius
        worn = history[f"wear_profile_{body}"]
        _lines(axes, history, lambda N, s=sign, h=shape, w=worn: MICRON * s * (h + w[row[N]]))
        axes.text(0.02, 0.5 + 0.44 * sign, body, transform=axes.transAxes, va="center")
    axes.set_ylabel(r"surface $z$ ($\mathrm{\mu m}$)")
    handles, labels = axes.get_legend_handles_labels()
    once = dict(zip(labels, handles, strict=True))
    figure.legends.clear()
    figure.legend(once.values(), once.keys(), title="$N$", loc="outside right upper")
    return figure


@styled
def pressure_profiles(history: History) -> Figure:
    """Largest pressure in every row along the rolling direction, at the stored revolutions.

    Examples
    --------
    >>> plot.pressure_profiles(history)
    <Figure size ...>
    """
    figure, axes = _across(history)
    scale = Scale.of_history(history)
    _lines(axes, history, lambda N: history.field("pressure", N).max(axis=0) / scale.p)
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel(rf"$\max_x\, p_n/{scale.p_symbol}$")
    return figure


def _across(history: History) -> tuple[Figure, Axes]:
    figure = Figure(figsize=(1.25 * WIDTH, 0.7 * WIDTH))
    axes = figure.add_subplot()
    axes.set_xlabel(f"$y/{Scale.of_history(history).b_symbol}$")
    set_title(figure, history.title)
    return figure, axes


def _lines(axes: Axes, history: History, values) -> None:
    """Draw values(revolution), from light to dark in the order of the revolutions."""
    y = history.y / Scale.of_history(history).b
    revolutions = chosen(history.field_revolutions)
    shades = colormaps["viridis_r"](np.linspace(0.08, 1.0, len(revolutions)))
    for revolution, shade in zip(revolutions, shades, strict=True):
        axes.plot(y, values(revolution), color=shade, label=f"{revolution}")
    axes.set_xlim(y.min(), y.max())
    axes.figure.legend(title="$N$", loc="outside right upper")
