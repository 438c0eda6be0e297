"""The style of the figures: scale and units, sizes, colours, titles and labels."""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import wraps
from textwrap import wrap
from typing import Any, ParamSpec, Self, TypeVar

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.rcsetup import cycler
from matplotlib.ticker import MaxNLocator

from tractive_sam.deprecation import renamed_attributes
from tractive_sam.description import format_with_unit, math_label
from tractive_sam.mechanics import Frame
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.options import current_options
from tractive_sam.results import History, State
from tractive_sam.safe_text import printable_text
from tractive_sam.scene import Scene

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


@dataclass(frozen=True)
class Look:
    """Colours, colour maps and sizes of all figures.

    Everyone can distinguish the colours (Okabe & Ito 2008), and the colour maps are perceptually
    uniform.
    """

    blue: str = "#0072B2"
    vermillion: str = "#D55E00"
    green: str = "#009E73"
    orange: str = "#E69F00"
    sky: str = "#56B4E9"
    purple: str = "#CC79A7"
    grey: str = "#6E6E6E"
    # Colour maps, named by what they show; "signed" is white at zero.
    pressure: str = "viridis"
    traction: str = "magma"
    slip: str = "inferno"
    wear: str = "cividis"
    stress: str = "plasma"
    signed: str = "RdBu_r"
    # A figure with one panel is as wide as a column of a journal and legible on a screen, inches.
    panel_width: float = 4.8
    # No figure is lower, mm.
    least_height: float = 45.0
    # Longer titles are cut, characters.
    longest_title: int = 300

    @property
    def lines(self) -> tuple[str, ...]:
        """Colours of lines in order."""
        return self.blue, self.vermillion, self.green, self.orange, self.purple, self.sky

    @property
    def bodies(self) -> dict[str, str]:
        """Colours of the bodies."""
        return {"A": self.blue, "B": self.vermillion}

    @property
    def width(self) -> float:
        """Width of a figure with one panel, inches."""
        return self.panel_width * current_options().scale


LOOK = Look()

MICRON = 1e3
"""Micrometres in a millimetre."""

STYLE: dict[Any, Any] = {
    "font.family": ["STIXGeneral", "DejaVu Sans"],
    "mathtext.fontset": "stix",
    "font.size": 11,
    "axes.titlesize": 11,
    "axes.titlelocation": "left",
    "figure.titlesize": 11.5,
    "axes.labelsize": 12,
    "axes.linewidth": 0.7,
    "axes.edgecolor": "#333333",
    "axes.prop_cycle": cycler(color=LOOK.lines),
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
"""Settings of matplotlib for all figures; ``plt.style.use(plot.STYLE)`` applies them to others."""


def apply_style(draw: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Return a drawing function that uses this package's style, not the user's."""

    @wraps(draw)
    def draw_in_style(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Result:
        fonts = current_options().font_scale
        scaled = [key for key in STYLE if key.endswith(("size", "linewidth"))]
        sizes: dict[str, Any] = {key: fonts * STYLE[key] for key in scaled}
        with mpl.rc_context(STYLE | sizes):
            return draw(*args, **kwargs)

    return draw_in_style


def new_figure(width: float = 1.0, height: float = 0.66) -> Figure:
    """Return an empty figure; its sides are in widths of a figure with one panel."""
    least = LOOK.least_height / 25.4
    return Figure(figsize=(width * LOOK.width, max(height * LOOK.width, least)))


def new_axes(width: float = 1.0, height: float = 0.66, title: str = "") -> tuple[Figure, Axes]:
    """Return a figure with a title and its axes; sides as in `new_figure`."""
    figure = new_figure(width, height)
    axes = figure.add_subplot()
    if title:
        set_title(figure, title)
    return figure, axes


def line_colours(number: int) -> list[tuple[float, float, float]]:
    """Return this number of distinguishable colours for lines."""
    rounds = -(-number // len(LOOK.lines))
    ends = [(0.0 if turn % 2 else 1.0, turn / (turn + 1.2)) for turn in range(rounds)]
    colours = []
    for end, share in ends:
        for colour in LOOK.lines:
            red, green, blue = ((1.0 - share) * part + share * end for part in to_rgb(colour))
            colours.append((red, green, blue))
    return colours[:number]


def record_colours(number: int) -> np.ndarray:
    """Return the colours of lines of this number of records: later ones are darker."""
    return mpl.colormaps["viridis_r"](np.linspace(0.25, 1.0, number))


def format_title(title: str, *notes: str) -> str:
    """Return a title with a line of notes below it; empty notes are left out."""
    below = re.sub(r"\\mathrm\{(\w+)\}", r"\1", "; ".join(filter(None, notes)).replace("$", ""))
    for separator in (" = ", " mm", " MPa"):  # no line break inside of a value
        below = below.replace(separator, separator.replace(" ", "\u00a0"))
    return "\n".join(filter(None, (title, below)))


def history_title(history: History, quantity: str, scale: str = "") -> str:
    """Return the title of a figure of a quantity over the course of a history."""
    return format_title(history.title, quantity, describe_friction(history.frame), scale)


def describe_friction(frame: Frame | None) -> str:
    """Return the friction coefficients as text, with the angle if they differ."""
    if frame is None:
        return ""
    first, second = frame.mu
    angle = math.degrees(frame.angle)
    return f"µ = {first:g}" if first == second else f"µ = {first:g}/{second:g}, β = {angle:g}°"


def wrap_title(text: str, width: float) -> list[str]:
    """Return the lines of a title wrapped to a width in inches; none if titles are switched off."""
    options = current_options()
    if not options.titles:
        return []
    letters = int(13 * width / options.font_scale)
    text = printable_text(text, LOOK.longest_title)
    return [part for line in text.split("\n") for part in wrap(line, letters) or [""]]


def set_title(figure: Figure, text: str, **style: Any) -> None:
    """Write a wrapped title over a figure; dollar signs in it are literal."""
    if lines := wrap_title(text, figure.get_figwidth()):
        figure.suptitle("\n".join(lines), parse_math=False, linespacing=1.15, **style)


def label_course(axes: Axes, *histories: History) -> None:
    """Label the x axis with the coordinate of histories, and set its limits."""
    (coordinate,) = {history.coordinate for history in histories}
    last = max(float(history[coordinate.name][-1]) for history in histories)
    name = coordinate.label or coordinate.long_name
    label = f"{name} {math_label(coordinate)}"
    axes.set_xlabel(label if coordinate.symbol else format_with_unit(name, coordinate.unit))
    if coordinate.whole:
        axes.xaxis.set_major_locator(MaxNLocator(5, integer=True))
        axes.xaxis.set_major_formatter("{x:,.0f}")
    if coordinate.whole or last > 0.0:
        axes.set_xlim(0, max(1.0, last) if coordinate.whole else last)


@renamed_attributes(of_contact="from_contact", of_history="from_history", told="note")
@dataclass(frozen=True)
class Scale:
    """Half widths and pressure by which figures make lengths and stresses relative.

    Attributes
    ----------
    a, b : float
        Half widths in x and in y, mm.
    p : float
        Pressure, MPa.
    hertz : bool
        Whether they belong to the unworn contact by Hertz; else to the first contact that was
        computed.
    units : str
        "hertz" if figures divide by them; "si-mm" if lengths are in mm and pressures in MPa, as for
        every wheel: its patches are no Hertz contacts.

    Examples
    --------
    >>> plot.Scale.from_contact(contact).p_symbol
    'p_0'
    """

    a: float
    b: float
    p: float
    hertz: bool
    units: str = field(default_factory=lambda: current_options().units)

    @classmethod
    def from_contact(cls, contact: State) -> Self:
        """Return the scale of a contact: half widths and pressure by Hertz, or else its values."""
        a, b, p = contact.half_width_x, contact.half_width_y, contact.p_max
        return cls._from_scene(contact.scene, (a, b, p))

    @classmethod
    def from_history(cls, history: History) -> Self:
        """Return the scale of a history: Hertz's values, or values of its first contact."""
        names = ("half_width_x", "half_width_y", "p_max")
        a, b, p = (float(history[name][0]) for name in names)
        return cls._from_scene(history.scene, (a, b, p))

    @classmethod
    def _from_scene(cls, scene: Scene, values: tuple[float, float, float]) -> Self:
        """Return the scale of a scene by Hertz, else these values; mm and MPa with [wheel]."""
        if scene.wheelset is not None:
            return cls(*values, hertz=False, units="si-mm")
        hertz = scene.hertz
        if hertz is None:
            return cls(*values, hertz=False)
        return cls(hertz.a, hertz.b, hertz.p0, hertz=True)

    @property
    def relative(self) -> bool:
        """Whether figures divide by the scale; otherwise they are in mm and MPa."""
        return self.units == "hertz"

    @property
    def length(self) -> float:
        """Divisor of lengths in figures: the half width a, or 1 for figures in mm."""
        return self.a if self.relative else 1.0

    @property
    def across(self) -> float:
        """Divisor of lengths across the track in figures: the half width b, or 1 for mm."""
        return self.b if self.relative else 1.0

    @property
    def pressure(self) -> float:
        """Divisor of pressures in figures: the pressure p, or 1 for figures in MPa."""
        return self.p if self.relative else 1.0

    def length_label(self, name: str, across: bool = False) -> str:
        """Return the label of a length in the units of the scale, as math text."""
        divisor = self.b_symbol if across else self.a_symbol
        return f"${name}/{divisor}$" if self.relative else f"${name}$ (mm)"

    def pressure_label(self, symbol: str) -> str:
        """Return the label of a pressure or stress in the units of the scale."""
        return f"${symbol}/{self.p_symbol}$" if self.relative else f"${symbol}$ (MPa)"

    def describe(self) -> str:
        """Return the half widths and the pressure in numbers, for titles."""
        names = ("a₀", "b₀", "p₀") if self.hertz else ("a", "b", "largest p")
        b = "" if math.isinf(self.b) else f", {names[1]} = {self.b:.3g} mm"
        return f"{names[0]} = {self.a:.3g} mm{b}, {names[2]} = {self.p:.4g} MPa"

    @property
    def note(self) -> str:
        """Values of the scale as text if figures divide by it; else empty."""
        return self.describe() if self.relative else ""

    @property
    def a_symbol(self) -> str:
        """Symbol of the half width in x for math text: "a_0" of Hertz's contact, else "a"."""
        return "a_0" if self.hertz else "a"

    @property
    def b_symbol(self) -> str:
        """Symbol of the half width in y for math text: "b_0" of Hertz's contact, else "b"."""
        return "b_0" if self.hertz else "b"

    @property
    def p_symbol(self) -> str:
        """Symbol of the pressure for math text: "p_0" of Hertz's contact, else "p_max"."""
        return "p_0" if self.hertz else r"p_\mathrm{max}"
