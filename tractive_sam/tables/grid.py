"""Nodes along heading and tilt, and what symmetries of a contact make of them."""

import math
from dataclasses import dataclass

import numpy as np

from tractive_sam.lookup import MIRROR

HEADINGS, TILTS = 5, 4
"""Nodes over half a circle, and from none to the pole, to begin with."""

POLE = 0.5 * math.pi

DIGITS = 12
"""Of a heading, so that it is the same from wherever it is mirrored or turned."""

REVERSAL = np.full(3, -1.0)


@dataclass(frozen=True)
class CreepageGrid:
    """Nodes along heading and tilt.

    Parameters
    ----------
    mirrored, reversed : bool
        Whether forces are mirrored with creepages at y = 0, and reversed with them. With both, a
        quarter of all creepages is in the table; else all are, of which half are solved.
    """

    mirrored: bool
    reversed: bool

    @property
    def whole(self) -> bool:
        """Whether a table has all headings and tilts."""
        return not (self.mirrored and self.reversed)

    @property
    def first(self) -> list[np.ndarray]:
        """Headings and tilts to begin with."""
        if self.whole:
            return [
                np.linspace(-math.pi, math.pi, 2 * HEADINGS - 1),
                np.linspace(-POLE, POLE, 2 * TILTS - 1),
            ]
        return [np.linspace(-POLE, POLE, HEADINGS), np.linspace(0.0, POLE, TILTS)]

    def alike(self, axis: int, intervals: np.ndarray, count: int) -> np.ndarray:
        """Intervals of heading (0) or tilt (1) with those that symmetries make of them."""
        if axis == 0 or (axis == 1 and self.whole):
            intervals = np.union1d(intervals, count - 1 - intervals)
        if axis == 0 and self.whole:
            intervals = np.union1d(intervals, (intervals + count // 2) % count)
        return intervals.astype(int)

    def canonical(
        self, creepages: tuple[float, ...]
    ) -> tuple[tuple[float, float, float], np.ndarray]:
        """The one of all nodes of the same forces that is solved, and the signs between them."""
        heading, tilt, u = creepages
        none = np.ones(3)
        if u == 0.0:
            return (0.0, 0.0, 0.0), none
        if abs(tilt) == POLE:  # of spin alone, the heading does not count
            heading = 0.0
        heading = math.pi if heading == -math.pi else heading
        other = tilt < 0.0 or (tilt == 0.0 and heading < 0.0)
        if other and self.mirrored:
            mirrored = heading if heading == math.pi else -heading
            return (round(mirrored, DIGITS), -tilt, u), MIRROR
        if other and self.reversed:
            turned = heading + math.pi if heading <= 0.0 else heading - math.pi
            turned = math.pi if turned <= -math.pi else turned
            return (0.0 if tilt == -POLE else round(turned, DIGITS), -tilt, u), REVERSAL
        return (round(heading, DIGITS), tilt, u), none
