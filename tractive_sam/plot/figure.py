"""The figure that every drawing returns: of no window, and seen by itself in a notebook."""

from base64 import b64encode
from io import BytesIO

import matplotlib.figure

SHARP = 2
"""Dots of a picture in a notebook over the pixels that it takes there: as many as screens have."""


class Figure(matplotlib.figure.Figure):
    """A figure that a notebook shows as the value of a cell, once, whatever it was told before.

    It belongs to no window and no list of figures, so nothing else draws it there.
    """

    def _repr_png_(self) -> tuple[bytes, dict[str, float]]:
        """The picture, and its size on the page."""
        width, height = (float(round(side * self.dpi)) for side in self.get_size_inches())
        return self._png(self.dpi), {"width": width, "height": height}

    def in_html(self, width: float) -> str:
        """The picture as an image of a page, that many pixels wide."""
        encoded = b64encode(self._png(width / self.get_figwidth())).decode()
        return f'<img alt="figure" src="data:image/png;base64,{encoded}" width="{width:.0f}">'

    def _png(self, dpi: float) -> bytes:
        """The picture, of `SHARP` dots for one of so many an inch."""
        memory = BytesIO()
        self.savefig(memory, format="png", dpi=SHARP * dpi)
        return memory.getvalue()
