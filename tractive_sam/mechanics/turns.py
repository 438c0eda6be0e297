"""Turns of the bodies: the part of the wear of a pass that returns to the contact."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Turns:
    """Turns of the bodies A and B per counted revolution, and the wear that they accumulate.

    Each body has its share of the wear depth of a pass, and this material returns to the contact
    after a turn of the body. With different circumferences it returns in another phase each time;
    the entering depth is the average over the phases: per counted revolution a body accumulates its
    share of as many passes as it turns.

    Parameters
    ----------
    share : mapping of str to float
        Shares of the bodies "A" and "B" in the wear depth; their sum is one.
    per_count : mapping of str to float
        Turns of each body per counted revolution.
    """

    share: Mapping[str, float]
    per_count: Mapping[str, float]

    @classmethod
    def equal(cls, share: Mapping[str, float]) -> "Turns":
        """Return one turn of each body per counted revolution (the assumption of the paper)."""
        return cls(share, {"A": 1.0, "B": 1.0})

    @classmethod
    def from_radii(cls, share: Mapping[str, float], radius_A: float, radius_B: float) -> "Turns":
        """Return the turns of bodies that roll without slip, per turn of A, or of B if A is flat.

        Parameters
        ----------
        share : mapping of str to float
            See `Turns`.
        radius_A, radius_B : float
            Radii in the rolling direction, mm: inf for flat, negative for concave. Two flat bodies
            have equal turns.
        """
        counted = abs(radius_A if math.isfinite(radius_A) else radius_B)
        if math.isinf(counted):
            return cls.equal(share)
        return cls(share, {"A": counted / abs(radius_A), "B": counted / abs(radius_B)})

    @property
    def gain(self) -> float:
        """Growth of the wear depth per counted revolution over the depth worn in one pass."""
        return 1.0 + sum(self.share[body] * (self.per_count[body] - 1.0) for body in "AB")

    def share_of_entering(self, body: str) -> float:
        """Return the share (0 to 1) of a body in the depth that enters; 0 for a flat body."""
        return self.share[body] * self.per_count[body] / self.gain

    def next_entering(self, entering: np.ndarray, leaving: np.ndarray) -> np.ndarray:
        """Return the wear depth that enters the next revolution, mm, for both bodies together.

        Parameters
        ----------
        entering, leaving : ndarray, shape (n_y,)
            Depth of both bodies together before and behind the contact, mm.
        """
        return leaving + (self.gain - 1.0) * (leaving - entering)

    def mean_depth(self, body: str, entering: np.ndarray, leaving: np.ndarray) -> np.ndarray:
        """Return the mean wear depth of a body over its circumference after a revolution, mm.

        Both bodies roll an equal distance: their volumes are proportional to their shares. 0 for a
        flat body. Parameters as in `next_entering`.
        """
        return self.share_of_entering(body) * self.next_entering(entering, leaving)

    def depth_behind(self, body: str, entering: np.ndarray, leaving: np.ndarray) -> np.ndarray:
        """Return the wear depth of a body just behind the contact, mm.

        A flat body passes the contact only once: its depth is the wear of a single pass.
        Parameters as in `next_entering`.
        """
        returning = self.per_count[body] / self.gain
        return self.share[body] * (leaving + (returning - 1.0) * entering)
