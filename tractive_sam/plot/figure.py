"""The figure that every drawing returns: of no window, and seen by itself in a notebook."""

from base64 import b64encode
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import IO

import matplotlib.figure
import numpy as np
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.text import Text

from tractive_sam.markup import Html, fill
from tractive_sam.output_file import write_file
from tractive_sam.plain import plain

SHARP = 2
"""Dots of a picture in a notebook over the pixels that it takes there: as many as screens have."""


class InsideLayout(ConstrainedLayoutEngine):
    """Constrained layout that leaves no label outside of the figure.

    The size of the axes depends on the labels of their ticks, and the number of ticks on the size
    of the axes. Constrained layout may alternate between two sets of ticks: it then reserves space
    for one set, and the other is drawn. What is outside after the layout narrows its rectangle.
    """

    def execute(self, fig: matplotlib.figure.Figure) -> None:
        """Lay out a figure, a second time where anything is outside of its padding."""
        self.set(rect=(0.0, 0.0, 1.0, 1.0))
        super().execute(fig)
        drawn, size = fig.get_tightbbox(), fig.get_size_inches()
        pads = np.array([self.get()["w_pad"], self.get()["h_pad"]])
        low, high = (np.maximum(pads - space, 0.0) for space in (drawn.min, size - drawn.max))
        if low.any() or high.any():
            self.set(rect=(*low / size, *(size - low - high) / size))
            super().execute(fig)


class Figure(matplotlib.figure.Figure):
    """A figure that a notebook shows as the value of a cell, once, whatever it was told before.

    It belongs to no window and no list of figures, so nothing else draws it there. By default its
    layout leaves all labels inside.

    Examples
    --------
    >>> drawn = plot.Figure(figsize=(4.0, 3.0))
    >>> drawn.add_subplot().plot(history["revolution"], history["p_max"])
    [<matplotlib.lines.Line2D object at ...>]
    """

    def __init__(self, *args, **options) -> None:
        if options.get("layout") is None:
            options["layout"] = InsideLayout()
        super().__init__(*args, **options)

    def savefig(self, fname: str | PathLike[str] | IO, **options) -> None:
        """Save the figure, in a file as a whole; arguments are those of matplotlib.

        Raises
        ------
        OutputError
            If the file cannot be written; one that was there before is unchanged.
        """
        for text in self.findobj(Text):  # fonts have no signs for control characters
            if text.get_text() != (shown := plain(text.get_text(), None).replace("\t", " ")):
                text.set_text(shown)
        if not isinstance(fname, str | PathLike):
            super().savefig(fname, **options)
            return
        path = Path(fname)
        if not options.get("format"):
            options["format"] = path.suffix[1:] or self.canvas.get_default_filetype()
        if not path.suffix:
            path = path.with_name(f"{path.name.rstrip('.')}.{options['format']}")
        memory = BytesIO()
        super().savefig(memory, **options)
        write_file(path, memory.getbuffer())

    def _repr_png_(self) -> tuple[bytes, dict[str, float]]:
        """The picture, and its size on the page."""
        width, height = (float(round(side * self.dpi)) for side in self.get_size_inches())
        return self._png(self.dpi), {"width": width, "height": height}

    def in_html(self, width: float) -> Html:
        """The picture as an image of a page, that many pixels wide."""
        encoded = b64encode(self._png(width / self.get_figwidth())).decode()
        image = '<img alt="figure" src="data:image/png;base64,$encoded" width="$width">'
        return fill(image, encoded=encoded, width=f"{width:.0f}")

    def _png(self, dpi: float) -> bytes:
        """The picture, of `SHARP` dots for one of so many an inch."""
        memory = BytesIO()
        self.savefig(memory, format="png", dpi=SHARP * dpi)
        return memory.getvalue()
