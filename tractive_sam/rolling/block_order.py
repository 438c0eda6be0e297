"""Effect of the order of blocks on the damage of a duty cycle that is rolled as its mean.

On the mean every revolution of a cycle of n does the damage sum of w_b d_b, w_b = n_b/n. In its
order a block b does all of its damage at one time of the cycle, tau_b revolutions after the middle,
and at the wear of that time, e_b more than on the mean:

    sum over a jump of w_b (tau_b d(d_b)/dN + (d_b(zeta - E - e_b) - d_b(zeta - E))),

by Taylor in tau_b. The first term adds up to the change of the damage of a pass: it does not grow
with the number of cycles. The second one is in proportion to the wear of a cycle. What the order
changes of the wear itself, and so of the stress later on, is of the same order, and left out.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tractive_sam.scene import Spectrum


@dataclass(frozen=True, eq=False)
class BlockOrder:
    """When the blocks of a cycle are rolled, and how worn one body is then.

    Attributes
    ----------
    shares : ndarray, shape (blocks,)
        Share of each block in the revolutions of a cycle.
    delay : ndarray, shape (blocks,)
        Mean time of each block after the middle of the cycle, revolutions.
    wear : ndarray, shape (blocks, n_y)
        Mean depth worn off by then, less that of a cycle that wears evenly, mm.
    """

    shares: np.ndarray
    delay: np.ndarray
    wear: np.ndarray

    @classmethod
    def from_spectrum(cls, spectrum: Spectrum, rates: np.ndarray) -> "BlockOrder":
        """Follow one cycle; `rates` (blocks, n_y) is the wear of a revolution of each block, mm."""
        shares = np.array(spectrum.revolutions) / spectrum.cycle
        uneven = rates - np.tensordot(shares, rates, axes=1)
        delay, wear = np.zeros(shares.size), np.zeros(rates.shape)
        start, worn = 0.0, np.zeros(rates.shape[1])
        for count, block in zip(spectrum.each, spectrum.places, strict=True):
            # Mean over the revolutions of the block, each with what is worn before it.
            part, middle = count / spectrum.revolutions[block], 0.5 * (count - 1)
            delay[block] += part * (start + middle - 0.5 * (spectrum.cycle - 1))
            wear[block] += part * (worn + middle * uneven[block])
            start, worn = start + count, worn + count * uneven[block]
        return cls(shares, delay, wear)

    def damage_error(
        self,
        damage: Callable[[np.ndarray, np.ndarray], np.ndarray],
        used: tuple[np.ndarray, np.ndarray],
        worn: tuple[np.ndarray, np.ndarray],
        length: int,
    ) -> np.ndarray:
        """Return the error of the damage of one pass a revolution over a jump, shape (n_y, m).

        Absolute values of the blocks are added: that they cancel is not certain.

        Parameters
        ----------
        damage : callable
            Damage (n_y, m) of a pass in the material, by utilisation (n_y, n) and the worn depth
            (n_y,), mm.
        used : tuple of ndarray, shape (blocks, n_y, n)
            Utilisation in each block at both ends of the jump.
        worn : tuple of ndarray, shape (n_y,)
            Depth worn off at both ends, mm.
        length : int
            Revolutions of the jump.
        """
        middle = 0.5 * (worn[0] + worn[1])
        total = np.zeros(1)
        for b, share in enumerate(self.shares):
            change = damage(used[1][b], worn[1]) - damage(used[0][b], worn[0])
            mean = 0.5 * (used[0][b] + used[1][b])
            shifted = damage(mean, middle + self.wear[b]) - damage(mean, middle)
            total = total + share * abs(self.delay[b] * change + length * shifted)
        return total
