"""Nodes along heading and tilt, and their symmetries."""

import math
from dataclasses import dataclass

import numpy as np

from tractive_sam.lookup import MIRROR

HEADINGS, TILTS = 5, 4
"""First numbers of nodes over half a circle of heading, and from zero tilt to the pole."""


@dataclass(frozen=True)
class CreepageGrid:
    """Symmetric grid of heading and tilt (directions of creepage) of a table.

    Parameters
    ----------
    mirrored, reversed : bool
        Whether forces are mirrored with creepages at y = 0, and reversed with them. With both, the
        table contains a quarter of all creepages; else all of them, and half are solved.
    """

    reversal = np.full(3, -1.0)

    pole = 0.5 * math.pi

    mirrored: bool
    reversed: bool

    @property
    def full_range(self) -> bool:
        """Whether the table covers all headings and tilts, or only a quarter by symmetry."""
        return not (self.mirrored and self.reversed)

    @property
    def first(self) -> list[np.ndarray]:
        """First nodes [heading, tilt] in radians, before refinement; a quarter if symmetric."""
        if self.full_range:
            return [
                np.linspace(-math.pi, math.pi, 2 * HEADINGS - 1),
                np.linspace(-self.pole, self.pole, 2 * TILTS - 1),
            ]
        return [np.linspace(-self.pole, self.pole, HEADINGS), np.linspace(0.0, self.pole, TILTS)]

    def alike(self, axis: int, intervals: np.ndarray, count: int) -> np.ndarray:
        """Return indices of intervals of heading (0) or tilt (1) and of their mirror images."""
        if axis == 0 or (axis == 1 and self.full_range):
            intervals = np.union1d(intervals, count - 1 - intervals)
        if axis == 0 and self.full_range:
            intervals = np.union1d(intervals, (intervals + count // 2) % count)
        return intervals.astype(int)

    def canonical(
        self, creepages: tuple[float, ...]
    ) -> tuple[tuple[float, float, float], np.ndarray]:
        """Return (equivalent node that is solved, signs (3,) of its forces) for creepages."""
        heading, tilt, u = creepages
        # Digits of a heading, so that it does not depend on how it is mirrored or turned.
        digits, none = 12, np.ones(3)
        if u == 0.0:
            return (0.0, 0.0, 0.0), none
        if abs(tilt) == self.pole:  # for pure spin the heading has no effect
            heading = 0.0
        heading = math.pi if heading == -math.pi else heading
        outside = tilt < 0.0 or (tilt == 0.0 and heading < 0.0)
        if outside and self.mirrored:
            mirrored = heading if heading == math.pi else -heading
            return (round(mirrored, digits), -tilt, u), MIRROR
        if outside and self.reversed:
            turned = heading + math.pi if heading <= 0.0 else heading - math.pi
            turned = math.pi if turned <= -math.pi else turned
            return (0.0 if tilt == -self.pole else round(turned, digits), -tilt, u), self.reversal
        return (round(heading, digits), tilt, u), none
