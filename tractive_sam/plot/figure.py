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
        memory = BytesIO()
        self.savefig(memory, format="png", dpi=SHARP * self.dpi)
        width, height = (float(round(side * self.dpi)) for side in self.get_size_inches())
        return memory.getvalue(), {"width": width, "height": height}

    def in_html(self, width: float) -> str:
        """The picture as an image of a page, that many pixels wide."""
        data, _ = self._repr_png_()
        encoded = b64encode(data).decode()
        return f'<img alt="figure" src="data:image/png;base64,{encoded}" width="{width:.0f}">'
