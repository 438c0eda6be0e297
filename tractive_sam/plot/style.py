"""The look of the figures: one column of a journal, readable on a screen as well."""

import math
from collections.abc import Callable
from functools import wraps
from textwrap import wrap
from typing import ParamSpec, TypeVar

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.ticker import MaxNLocator

from tractive_sam.mechanics import Frame
from tractive_sam.plain import plain
from tractive_sam.plot.figure import Figure
from tractive_sam.results import History, Quantity

P = ParamSpec("P")
Drawn = TypeVar("Drawn")

WIDTH = 4.8
"""Of a figure with one panel, inches."""

LONGEST_TITLE = 300
"""Characters of a title; what is longer is cut."""

MICRON = 1e3
"""Micrometres in a millimetre."""

BLUE, VERMILLION, GREEN, ORANGE, SKY, PURPLE, GREY = (
    "#0072B2",
    "#D55E00",
    "#009E73",
    "#E69F00",
    "#56B4E9",
    "#CC79A7",
    "#6E6E6E",
)
"""Colours told apart by everyone (Okabe & Ito 2008)."""

PRESSURE, TRACTION, SLIP, WEAR, STRESS = "viridis", "magma", "inferno", "cividis", "plasma"
"""Perceptually uniform colour maps of the fields."""

COLOURS = BLUE, VERMILLION, GREEN, ORANGE, PURPLE, SKY
"""Colours of lines, in their order."""

SIGNED = "RdBu_r"
"""Colour map of what has a sign: white at zero."""

STYLE = {
    "font.family": ["STIXGeneral", "DejaVu Sans"],
    "mathtext.fontset": "stix",
    "font.size": 11,
    "axes.titlesize": 11,
    "axes.titlelocation": "left",
    "figure.titlesize": 11.5,
    "axes.labelsize": 12,
    "axes.linewidth": 0.7,
    "axes.edgecolor": "#333333",
    "axes.prop_cycle": mpl.cycler(color=COLOURS),
    "axes.formatter.use_mathtext": True,
    "axes.formatter.limits": (-3, 4),
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.labelsize": 10,
    "ytick.labelsize": 10,
    "lines.linewidth": 1.4,
    "lines.markersize": 4.5,
    "legend.frameon": False,
    "legend.fontsize": 10,
    "legend.handlelength": 1.6,
    "figure.constrained_layout.use": True,
    "figure.dpi": 120,
    "savefig.dpi": 200,
}
"""Settings of matplotlib that all figures have: ``plt.style.use(plot.STYLE)`` for one's own."""


def colours(number: int) -> list[tuple[float, float, float]]:
    """So many different colours: those of lines, then these darker, lighter, darker still."""
    rounds = -(-number // len(COLOURS))
    towards = [(0.0 if turn % 2 else 1.0, turn / (turn + 1.2)) for turn in range(rounds)]
    return [
        tuple((1.0 - share) * part + share * end for part in to_rgb(colour))
        for end, share in towards
        for colour in COLOURS
    ][:number]


def told(title: str, *more: str) -> str:
    """A title, and below it what else there is to say of a figure."""
    below = "; ".join(filter(None, more)).replace("$", "")
    for apart in (" = ", " mm", " MPa"):  # stays in one line
        below = below.replace(apart, apart.replace(" ", "\u00a0"))
    return "\n".join(filter(None, (title, below)))


def told_of(history: History, quantity: str, scale: str = "") -> str:
    """Title of a figure over the course of a history."""
    return told(history.title, quantity, friction_label(history.frame), scale)


def friction_label(frame: Frame | None) -> str:
    """Return the coefficients of friction, and the angle where they differ; empty without."""
    if frame is None:
        return ""
    first, second = frame.mu
    angle = math.degrees(frame.angle)
    return f"µ = {first:g}" if first == second else f"µ = {first:g}/{second:g}, β = {angle:g}°"


def wrapped(text: str, width: float) -> list[str]:
    """Lines of a title that is to be no wider, inches."""
    text = plain(text, LONGEST_TITLE)
    return [part for line in text.split("\n") for part in wrap(line, int(13 * width)) or [""]]


def _math(one: Quantity) -> str:
    name = one.name.replace("_", r"\_")
    return one.symbol or rf"\mathrm{{{name}}}"


def symbol_of(one: Quantity) -> str:
    """Symbol, or else the name, and unit, as math text."""
    return f"${_math(one)}$" + ("" if one.unit == "1" else f" ({one.unit})")


def place(coordinate: Quantity, at: float) -> str:
    """A value of a coordinate with its symbol and unit, as math text."""
    unit = "" if coordinate.unit == "1" else f" {coordinate.unit}"
    return f"${_math(coordinate)} = {at:{coordinate.format}}${unit}"


def along(axes: Axes, *histories: History) -> None:
    """Have axes go along the coordinate of histories, from zero to the last record."""
    (coordinate,) = {history.coordinate for history in histories}
    last = max(float(history[coordinate.name][-1]) for history in histories)
    name = coordinate.label or coordinate.long_name
    unit = "" if coordinate.unit == "1" else f" ({coordinate.unit})"
    axes.set_xlabel(f"{name} {symbol_of(coordinate)}" if coordinate.symbol else name + unit)
    if coordinate.whole:
        axes.xaxis.set_major_locator(MaxNLocator(5, integer=True))
        axes.xaxis.set_major_formatter("{x:,.0f}")
    if coordinate.whole or last > 0.0:
        axes.set_xlim(0, max(1.0, last) if coordinate.whole else last)


def set_title(figure: Figure, text: str, **style) -> None:
    """Put a title over a figure, as many lines as it needs; it is text as given, no math."""
    lines = wrapped(text, figure.get_figwidth())
    figure.suptitle("\n".join(lines), parse_math=False, linespacing=1.15, **style)


def styled(draw: Callable[P, Drawn]) -> Callable[P, Drawn]:
    """Draw a figure in this look, whatever the settings outside."""

    @wraps(draw)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> Drawn:
        with mpl.rc_context(STYLE):
            return draw(*args, **kwargs)

    return wrapper
