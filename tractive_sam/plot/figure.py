"""Figures: their class, their style, and the options that all drawing functions share."""

import math
import re
from base64 import b64encode
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field, replace
from functools import wraps
from io import BytesIO
from os import PathLike
from pathlib import Path
from textwrap import wrap
from typing import IO, Any, Literal, ParamSpec, Self, TypeVar

import matplotlib as mpl
import matplotlib.figure
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.rcsetup import cycler
from matplotlib.text import Text
from matplotlib.ticker import MaxNLocator, ScalarFormatter
from PIL import Image

from tractive_sam.description import ShortArrays, format_unit, format_with_unit, math_label
from tractive_sam.lazy_names import renamed_attributes
from tractive_sam.mechanics import Frame
from tractive_sam.output_file import write_file
from tractive_sam.results import BODIES, COLUMNS, History, State, index_by_name
from tractive_sam.safe_text import Html, fill, printable_text
from tractive_sam.scene import Scene
from tractive_sam.text_table import read_table


class InsideLayout(ConstrainedLayoutEngine):
    """Layout engine of matplotlib that moves all labels into the figure.

    The size of the axes depends on the labels of their ticks, and the number of ticks on the size
    of the axes. Constrained layout may alternate between two sets of ticks: it then reserves space
    for one set, and the other is drawn. If a label lies outside after the layout, its rectangle is
    narrowed.
    """

    def execute(self, fig: matplotlib.figure.Figure) -> None:
        """Lay out a figure, twice if a label is outside at first."""
        self.set(rect=(0.0, 0.0, 1.0, 1.0))
        super().execute(fig)
        box, size = fig.get_tightbbox(), fig.get_size_inches()
        pads = np.array([self.get()["w_pad"], self.get()["h_pad"]])
        low, high = (np.maximum(pads - space, 0.0) for space in (box.min, size - box.max))
        if max(*low, *high) > 1e-6:  # more than rounding
            left, bottom = low / size
            width, height = (size - low - high) / size
            self.set(rect=(left, bottom, width, height))
            super().execute(fig)


class TickNumbers(ScalarFormatter):
    """Format tick labels as plain text and the power of ten of an axis as math text.

    The layout of math text takes several times as long, and a number looks the same.
    """

    def __init__(self) -> None:
        super().__init__(useMathText=False)

    def get_offset(self) -> str:
        """Return the power of ten that multiplies the numbers of the axis; empty for 1."""
        self.set_useMathText(True)
        offset = super().get_offset()
        self.set_useMathText(False)
        return offset


def _format_ticks(axes: Axes) -> Axes:
    """Let `TickNumbers` replace the default formatters of axes."""
    for axis in (axes.xaxis, axes.yaxis):
        if type(axis.get_major_formatter()) is ScalarFormatter:
            axis.set_major_formatter(TickNumbers())
            axis.isDefault_majfmt = True  # dates and categories replace it
    return axes


class _Canvas(FigureCanvasAgg):
    """Canvas that writes opaque PNG pictures without alpha: a tenth smaller, in half the time."""

    def print_png(
        self, filename_or_obj: Any, *, metadata: Any = None, pil_kwargs: Any = None, **_: Any
    ) -> None:
        """Write a PNG as in matplotlib, without the alpha channel if the picture is opaque."""
        options = pil_kwargs or {}
        self.draw()
        pixels = np.asarray(self.buffer_rgba())
        if metadata or pixels[..., 3].min() < 255:
            super().print_png(filename_or_obj, metadata=metadata, pil_kwargs=options)
        else:
            options = {"dpi": (self.figure.dpi, self.figure.dpi)} | options
            Image.fromarray(pixels).convert("RGB").save(filename_or_obj, format="png", **options)


def _find_texts(artist: Artist) -> Iterator[Text]:
    """Return the texts of an artist, without tick labels, which their formatters set."""
    for child in artist.get_children():
        if isinstance(child, Text):
            yield child
        elif isinstance(child, Axis):
            yield child.label
        else:
            yield from _find_texts(child)


class Figure(matplotlib.figure.Figure):
    """Figure of matplotlib that a notebook displays once, as the value of a cell.

    It belongs to no window and no list of figures, so nothing else draws it there. By default its
    layout leaves all labels inside.

    Parameters
    ----------
    *args, **options
        As for `matplotlib.figure.Figure`.

    Examples
    --------
    >>> figure = plot.Figure(figsize=(4.0, 3.0))
    >>> figure.add_subplot().plot(history["revolution"], history["p_max"])
    [<matplotlib.lines.Line2D object at ...>]
    """

    def __init__(self, *args: Any, **options: Any) -> None:
        if options.get("layout") is None:
            options["layout"] = InsideLayout()
        super().__init__(*args, **options)
        _Canvas(self)

    def add_subplot(self, *args: Any, **options: Any) -> Axes:
        """Add axes in a grid; arguments as in matplotlib."""
        return _format_ticks(super().add_subplot(*args, **options))

    def add_axes(self, *args: Any, **options: Any) -> Axes:
        """Add axes in a rectangle; arguments as in matplotlib."""
        return _format_ticks(super().add_axes(*args, **options))

    def colorbar(self, mappable: Any, *args: Any, **options: Any) -> Any:
        """Add a colour bar; arguments as in matplotlib."""
        bar = super().colorbar(mappable, *args, **options)
        if type(bar.formatter) is ScalarFormatter:
            bar.formatter = TickNumbers()
        return bar

    def savefig(self, fname: str | PathLike[str] | IO, **options: Any) -> None:
        """Save the figure; the file appears when it is complete. Arguments as in matplotlib.

        Raises
        ------
        OutputError
            If the file cannot be written; an earlier one is unchanged.
        """
        for text in _find_texts(self):  # fonts have no signs for control characters
            safe_text = printable_text(text.get_text(), None).replace("\t", " ")
            text.set_text(safe_text)
        if not isinstance(fname, str | PathLike):
            super().savefig(fname, **options)
            return
        path = Path(fname)
        if not options.get("format"):
            options["format"] = path.suffix[1:] or self.canvas.get_default_filetype()
        if options["format"] == "png":
            # A level of 6, the default, takes twice the time for files a tenth smaller.
            options.setdefault("pil_kwargs", {"compress_level": 3})
        if not path.suffix:
            path = path.with_name(f"{path.name.rstrip('.')}.{options['format']}")
        memory = BytesIO()
        with mpl.rc_context({"pdf.fonttype": 42}):  # TrueType: journals refuse type 3
            super().savefig(memory, **options)
        write_file(path, memory.getbuffer())

    def _repr_png_(self) -> tuple[bytes, dict[str, float]]:
        """Return the figure as PNG for notebooks, and its size on the page."""
        width, height = (float(round(side * self.dpi)) for side in self.get_size_inches())
        return self._png(self.dpi), {"width": width, "height": height}

    def to_html(self, width: float) -> Html:
        """Return the figure as an HTML image of a width in pixels."""
        encoded = b64encode(self._png(width / self.get_figwidth())).decode()
        image = '<img alt="figure" src="data:image/png;base64,$encoded" width="$width">'
        return fill(image, encoded=encoded, width=f"{width:.0f}")

    def _png(self, dpi: float, sharpness: float = 2.0) -> bytes:
        """Return the figure as PNG, with `sharpness` dots per pixel."""
        memory = BytesIO()
        self.savefig(memory, format="png", dpi=sharpness * dpi)
        return memory.getvalue()


@dataclass(frozen=True, eq=False, repr=False)
class Measurements(ShortArrays):
    """Measured values of columns along the coordinate of a history.

    Attributes
    ----------
    columns : mapping of str to ndarray
        Values by the name of a column, shape (n,); one of them is the coordinate, for example
        "revolution". Columns of bodies end in the body: "worn_mass B". NaN: not measured.

    Examples
    --------
    >>> weighed = {"revolution": np.array([0.0, 2.0]), "worn_mass B": np.array([0.0, 1e-4])}
    >>> measured = plot.Measurements(weighed)
    >>> files = plot.save_all(history, "figures", measured=measured)
    """

    columns: Mapping[str, np.ndarray]

    @classmethod
    def from_file(cls, path: str | PathLike[str]) -> Self:
        """Read measurements from a text file with a header of column names.

        Raises
        ------
        ValueError
            If the file cannot be read, is not a table, or an entry is not a number.
        """
        quantities, columns = index_by_name(COLUMNS), {}
        try:
            table = read_table(path, named=True)
            for place, (name, unit) in enumerate(zip(table.names, table.units, strict=True)):
                quantity = quantities.get(name.partition(" ")[0])
                meaning = quantity.unit if quantity else unit  # `check` refuses unknown columns
                columns[name] = table.column(place, meaning, missing=True)
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or error
            raise ValueError(
                f"{path} is not a table ({reason}); allowed: a text file with a row of column "
                "names and a row for each point"
            ) from None
        return cls(columns)

    def check(self, history: History) -> None:
        """Raise a ValueError unless a history has all measured columns and one is its coordinate.

        Raises
        ------
        ValueError
            If the coordinate is missing, or a column is unknown.
        """
        coordinate = history.coordinate.name
        if coordinate not in self.columns:
            raise ValueError(f"measured points: the column {coordinate} is missing; add it")
        names = [*history.of_dims(), *(f"{n} {b}" for n in history.of_dims("body") for b in BODIES)]
        for name in self.columns:
            if name not in names:
                allowed = ", ".join(sorted(names))
                raise ValueError(f"measured points: the column {name} is unknown; use {allowed}")

    def compared(self, history: History) -> list[str]:
        """Return the names of the columns that are compared: all but the coordinate."""
        return [name for name in self.columns if name != history.coordinate.name]

    def compare(self, history: History, name: str) -> tuple[np.ndarray, np.ndarray, str]:
        """Return coordinates, measured values, and a text with the rms deviation from a column.

        Parameters
        ----------
        history : History
            History that is compared.
        name : str
            Name of the column, with its body.

        Returns
        -------
        places, values : ndarray, shape (n,)
            Coordinates and values of the measured points.
        text : str
            Root mean square of the differences, in the unit of the column.
        """
        column, _, body = name.partition(" ")
        quantity = history.columns[column]
        stored = history[column][:, BODIES.index(body)] if body else history[column]
        course = history[history.coordinate.name]
        places, measured = self.columns[history.coordinate.name], self.columns[name]
        valid = np.isfinite(measured) & (places >= course[0]) & (places <= course[-1])
        differences = np.interp(places[valid], course, stored) - measured[valid]
        rms = math.sqrt(np.mean(differences**2)) if valid.any() else math.nan
        unit = format_unit(quantity.unit)
        return places, measured, f"measured, rms of differences {rms:.2g} {unit}".rstrip()

    def draw(self, axes: Axes, history: History, name: str, divisor: float, **style: Any) -> None:
        """Draw the measured points of a column, with their rms deviation in the legend.

        Parameters
        ----------
        axes : Axes
            Axes over the coordinate.
        history : History
            History that is compared.
        name : str
            Name of the column, with its body.
        divisor : float
            Divisor of the values.
        **style
            Style of the markers.
        """
        if name in self.columns:
            places, measured, label = self.compare(history, name)
            axes.plot(places, measured / divisor, "x", label=label, clip_on=False, **style)


UNITS = ("hertz", "si-mm")
"""Units of lengths and pressures in figures: over Hertz's, or in mm and MPa."""


@dataclass(frozen=True)
class FigureOptions:
    """Options of figures: units, titles, scale of the sizes, and measured points to draw.

    Attributes
    ----------
    units : str
        One of `UNITS`.
    titles : bool
        Whether figures have titles.
    scale : float
        Width over the usual one; fonts shrink with it, to 60 % at most.
    measured : Measurements, optional
        Points that are drawn with the columns of a history.

    Raises
    ------
    ValueError
        If the units are unknown.
    """

    units: str = "hertz"
    titles: bool = True
    scale: float = 1.0
    measured: Measurements | None = None

    def __post_init__(self) -> None:
        if self.units not in UNITS:
            raise ValueError(f"units is {self.units!r}; allowed: {', '.join(UNITS)}")

    @property
    def font_scale(self) -> float:
        """Size of fonts over the default size, at least 0.6."""
        return max(self.scale, 0.6)


_CURRENT: ContextVar[FigureOptions] = ContextVar("options of figures")


def current_options() -> FigureOptions:
    """Return the figure options in effect."""
    return _CURRENT.get(None) or FigureOptions()


@contextmanager
def change_options(**changes: Any) -> Iterator[None]:
    """Return a context in which figures are drawn with changed options."""
    token = _CURRENT.set(replace(current_options(), **changes))
    try:
        yield
    finally:
        _CURRENT.reset(token)


@contextmanager
def units(name: Literal["hertz", "si-mm"]) -> Iterator[None]:
    """Return a context in which figures use units "hertz" (relative) or "si-mm" (mm, MPa).

    Parameters
    ----------
    name : str
        "hertz", the default, or "si-mm".

    Raises
    ------
    ValueError
        If the units are unknown.

    Examples
    --------
    >>> with plot.units("si-mm"):
    ...     plot.pressure(contact).axes[0].get_ylabel()
    '$y$ (mm)'
    """
    with change_options(units=name):
        yield


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
    return format_title(
        history.title, quantity, describe_friction(history.frame, history.scene), scale
    )


def describe_friction(frame: Frame | None, scene: Scene) -> str:
    """Return the friction coefficients as text, with the angle if they differ."""
    if frame is None:
        return ""
    law = scene.friction.law if scene.friction else "constant"
    at_rest = " at rest" * (isinstance(law, str) and law != "constant")
    first, second = frame.mu
    angle = math.degrees(frame.angle)
    if first == second:
        return f"µ = {first:g}{at_rest}"
    return f"µ = {first:g}/{second:g}{at_rest}, β = {angle:g}°"


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
        axes.xaxis.set_major_locator(MaxNLocator(5, integer=True, steps=[1, 2, 5, 10]))
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
