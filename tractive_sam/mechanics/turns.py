"""Two bodies that come round: what of the wear of a pass they meet again."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Turns:
    """How often each of two bodies, A and B, comes round, and what of a pass lasts.

    Each body keeps its share of the depth worn in a pass, and meets it again once it has turned.
    Bodies of unlike circumference do so in another phase each time; what enters is taken for the
    average over the phases: while the counted body turns once, a body keeps its share of as many
    passes as it turns itself.

    Parameters
    ----------
    share : mapping of str to float
        Share of the bodies "A" and "B" in the depth worn; they add up to one.
    per_count : mapping of str to float
        Turns of each while revolutions are counted on by one.
    """

    share: Mapping[str, float]
    per_count: Mapping[str, float]

    @classmethod
    def equal(cls, share: Mapping[str, float]) -> "Turns":
        """The sum of both comes round as one (the paper's assumption)."""
        return cls(share, {"A": 1.0, "B": 1.0})

    @classmethod
    def from_radii(cls, share: Mapping[str, float], radius_A: float, radius_B: float) -> "Turns":
        """Rolling without slip: revolutions of A are counted or, where A is flat, of B.

        Parameters
        ----------
        share : mapping of str to float
            As of `Turns`.
        radius_A, radius_B : float
            Radii in the rolling direction, mm: inf for flat, negative for concave. Two flat bodies
            count the same passes.
        """
        counted = abs(radius_A if math.isfinite(radius_A) else radius_B)
        if math.isinf(counted):
            return cls.equal(share)
        return cls(share, {"A": counted / abs(radius_A), "B": counted / abs(radius_B)})

    @property
    def gain(self) -> float:
        """Depth by which the sum of both profiles deepens in a revolution, over that of a pass."""
        return 1.0 + sum(self.share[body] * (self.per_count[body] - 1.0) for body in "AB")

    def lasting(self, body: str) -> float:
        """Part of the entering depth that is one body's; 0 of a flat one."""
        return self.share[body] * self.per_count[body] / self.gain

    def next(self, entering: np.ndarray, leaving: np.ndarray) -> np.ndarray:
        """Depth with which the next revolution begins, of both together.

        Parameters
        ----------
        entering, leaving : ndarray, shape (n_y,)
            Depth of both together before and behind the contact, mm.
        """
        return leaving + (self.gain - 1.0) * (leaving - entering)

    def worn(self, body: str, entering: np.ndarray, leaving: np.ndarray) -> np.ndarray:
        """Mean depth worn off one body all around, mm; arguments as of `next`.

        What the next revolution meets of it, without what its phase leaves: both bodies roll the
        same distance, so that their volumes are as their shares. Zero of a flat one.
        """
        return self.lasting(body) * self.next(entering, leaving)

    def of_body(self, body: str, entering: np.ndarray, leaving: np.ndarray) -> np.ndarray:
        """Depth of one body behind the contact, mm; arguments as of `next`.

        Of a flat body, which never comes round, it is what a single pass wears.
        """
        lasting = self.per_count[body] / self.gain
        return self.share[body] * (leaving + (lasting - 1.0) * entering)
