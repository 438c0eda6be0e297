"""The rectangle that a map shows, and its size on paper."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from tractive_sam.plot.contact_view import ContactView
from tractive_sam.plot.needs import check_touching
from tractive_sam.plot.options import current_options

TICK_SPACE = 0.3
"""Height or width of a tick with its number, inches."""


@dataclass(frozen=True)
class MapFrame:
    """Rectangle around contacts that a map shows, true to scale unless too slender.

    Attributes
    ----------
    left, right, bottom, top : float
        Sides of the frame.
    width, height : float
        Size on paper, inches.
    """

    left: float
    right: float
    bottom: float
    top: float
    width: float
    height: float

    @classmethod
    def from_contacts(cls, *views: ContactView, width: float, margin: float = 0.15) -> Self:
        """Return the frame around several contacts, at most this wide on paper, inches.

        Parameters
        ----------
        *views : ContactView
            The contacts.
        width : float
            Largest width on paper, inches.
        margin : float
            Margin around the contact, in parts of its smaller half width.

        Raises
        ------
        ValueError
            If nothing touches in any of them.
        """
        check_touching(views)
        x = np.concatenate([v.x_over_a[v.contact.touching.any(axis=1)] for v in views])
        y = np.concatenate([v.y_over_a[v.contact.touching.any(axis=0)] for v in views])
        # An additional element, as the contact may be one element wide.
        around = margin * min(np.ptp(x), np.ptp(y)) / 2 + np.diff(views[0].x_over_a)[0]
        sides = x.min() - around, x.max() + around, y.min() - around, y.max() + around
        return cls.from_sides(*map(float, sides), width=width)

    @classmethod
    def from_sides(
        cls,
        left: float,
        right: float,
        bottom: float,
        top: float,
        *,
        width: float,
        longest: float = 5.5,
        shortest: float = 0.85,
    ) -> Self:
        """Return the frame between four sides, at most this wide on paper, inches.

        Parameters
        ----------
        left, right, bottom, top : float
            The sides.
        width, longest : float
            Largest width and height on paper, inches.
        shortest : float
            Smallest width and height on paper, inches: a more slender frame is stretched.
        """
        scale = current_options().scale
        ratio = (top - bottom) / (right - left)
        shortest = min(scale * shortest, width)
        width = min(width, scale * longest / ratio)
        frame = cls(left, right, bottom, top, width, width * ratio)
        return replace(frame, width=max(frame.width, shortest), height=max(frame.height, shortest))

    @property
    def units_per_inch(self) -> tuple[float, float]:
        """Length in x and in y that an inch of paper represents."""
        return (self.right - self.left) / self.width, (self.top - self.bottom) / self.height

    @property
    def stretch_note(self) -> str:
        """Note that the map is not true to scale; empty if it is."""
        x, y = self.units_per_inch
        if abs(y / x - 1.0) < 1e-6:  # rounding
            return ""
        axis, times = ("horizontally", y / x) if y > x else ("vertically", x / y)
        return f", stretched {times:.2g} times {axis}"

    def arrow_spacing(self, number: int) -> float:
        """Return the distance of arrows, inches: the mean side of the map over a number."""
        return float(np.sqrt(self.width * self.height)) / number

    def apply_to(self, axes: Axes, xlabel: str, ylabel: str) -> None:
        """Set limits, aspect, ticks and labels of axes as the frame defines them."""
        for axis, length in ((axes.xaxis, self.width), (axes.yaxis, self.height)):
            count = min(5, int(length / (current_options().font_scale * TICK_SPACE)))
            axis.set_major_locator(
                MaxNLocator(max(count, 2), steps=[1, 2, 4, 5, 10], min_n_ticks=3)
            )
            if count < 3:
                axis.set_major_formatter("{x:g}")  # three labels fit if zero has no decimals
        axes.set(xlim=(self.left, self.right), ylim=(self.bottom, self.top))
        axes.set_aspect("auto" if self.stretch_note else "equal")
        axes.set(xlabel=xlabel, ylabel=ylabel)
