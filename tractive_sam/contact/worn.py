"""Worn bodies with which a roll begins."""

from dataclasses import dataclass

import numpy as np

from tractive_sam.results import Grid


@dataclass(frozen=True, eq=False)
class Worn:
    """Depth worn off the bodies before, across the track.

    Attributes
    ----------
    y : ndarray, shape (n,)
        Where it is known, ascending, mm.
    depths : ndarray, shape (2, n)
        Of A and of B, mm.
    """

    y: np.ndarray
    depths: np.ndarray

    def on(self, grid: Grid) -> np.ndarray:
        """Depths on a mesh, shape (2, n_y), mm: linear between, beside it as at its ends.

        Raises
        ------
        ValueError
            If one is a line contact and the other is not.
        """
        if (self.y.size == 1) != (grid.directions == 1):
            raise ValueError("start: a line contact goes on as one, others as others")
        y = grid.y + grid.shift
        return np.stack([np.interp(y, self.y, depth) for depth in self.depths])
