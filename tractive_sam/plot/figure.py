"""The figure that every function returns: without a window, and displayed once by a notebook."""

from base64 import b64encode
from collections.abc import Iterator
from functools import lru_cache
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import IO, Any

import matplotlib as mpl
import matplotlib.figure
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.mathtext import MathTextParser
from matplotlib.text import Text
from matplotlib.ticker import ScalarFormatter
from PIL import Image

from tractive_sam.markup import Html, fill
from tractive_sam.output_file import write_file
from tractive_sam.safe_text import printable_text

_parse_math: Any = getattr(MathTextParser, "_parse_cached", None)
if hasattr(_parse_math, "__wrapped__"):
    # Matplotlib stores 50 parsed formulas, fewer than the figures of a history contain.
    MathTextParser._parse_cached = lru_cache(500)(_parse_math.__wrapped__)  # type: ignore[attr-defined]


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
