"""The rectangle that a map shows, and its size on paper."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MultipleLocator

from tractive_sam.plot.drawn import Drawn

MARGIN = 0.15
"""Around the contact, in parts of its smaller half width."""

NARROWEST = 0.85
"""Least width and height of a map, inches: what is more slender is stretched."""

LONGEST = 5.5
"""Most that a map measures from bottom to top, inches."""

STEPS = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100)
"""Distances of ticks."""

TICK_ROOM = 0.3
"""Of a tick and its number, inches."""


@dataclass(frozen=True)
class Frame:
    """A rectangle in half widths a, or mm; true to scale on paper, unless it is too slender.

    Attributes
    ----------
    left, right, bottom, top : float
        Its sides.
    width, height : float
        On paper, inches.
    """

    left: float
    right: float
    bottom: float
    top: float
    width: float
    height: float

    @classmethod
    def around(cls, *states: Drawn, width: float) -> Self:
        """Frame around the contacts of all states, on paper at most that wide.

        Raises
        ------
        ValueError
            If nothing touches in any of them.
        """
        if not any(state.contact.touching.any() for state in states):
            raise ValueError("nothing to draw: the bodies do not touch")
        x = np.concatenate([s.x_over_a[s.contact.touching.any(axis=1)] for s in states])
        y = np.concatenate([s.y_over_a[s.contact.touching.any(axis=0)] for s in states])
        # An element more, as the contact may be one element wide.
        margin = MARGIN * min(np.ptp(x), np.ptp(y)) / 2 + np.diff(states[0].x_over_a)[0]
        sides = x.min() - margin, x.max() + margin, y.min() - margin, y.max() + margin
        frame = cls.within(*map(float, sides), width=width)
        wide, high = max(frame.width, min(NARROWEST, width)), max(frame.height, NARROWEST)
        return replace(frame, width=wide, height=high)

    @classmethod
    def within(cls, left: float, right: float, bottom: float, top: float, *, width: float) -> Self:
        """Frame of these sides, on paper at most that wide."""
        ratio = (top - bottom) / (right - left)
        width = min(width, LONGEST / ratio)
        return cls(left, right, bottom, top, width, width * ratio)

    @property
    def inch(self) -> tuple[float, float]:
        """What an inch of paper is in x and y."""
        return (self.right - self.left) / self.width, (self.top - self.bottom) / self.height

    @property
    def stretched(self) -> str:
        """What to say of a frame that is not true to scale."""
        times = self.inch[1] / self.inch[0]
        if abs(times - 1.0) < 1e-6:  # rounding
            return ""
        return (
            f", x stretched {times:.2g} times"
            if times > 1.0
            else f", y stretched {1.0 / times:.2g} times"
        )

    def spacing(self, parts: int) -> float:
        """Distance of points of which a square of the same area has so many on a side, inches."""
        return float(np.sqrt(self.width * self.height)) / parts

    def apply(self, axes: Axes, xlabel: str, ylabel: str) -> None:
        """Scale and label axes."""
        axes.xaxis.set_major_locator(_ticks(self.right - self.left, self.width))
        axes.yaxis.set_major_locator(_ticks(self.top - self.bottom, self.height))
        axes.set(xlim=(self.left, self.right), ylim=(self.bottom, self.top))
        axes.set_aspect("auto" if self.stretched else "equal")
        axes.set(xlabel=xlabel, ylabel=ylabel)


def _ticks(span: float, inches: float) -> MultipleLocator:
    """Place about five ticks, fewer where there is no room."""
    least = span * max(0.2, TICK_ROOM / inches)
    return MultipleLocator(next((step for step in STEPS if step >= least), least))
