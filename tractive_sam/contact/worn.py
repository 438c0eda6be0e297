"""Worn bodies with which a roll begins."""

from dataclasses import dataclass

import numpy as np

from tractive_sam.results import Grid


@dataclass(frozen=True, eq=False)
class Worn:
    """Wear depth of both bodies across the track, with which a roll begins.

    Attributes
    ----------
    y : ndarray, shape (n,)
        Lateral positions, ascending, mm.
    depths : ndarray, shape (2, n)
        Depths of A and of B, mm.
    """

    y: np.ndarray
    depths: np.ndarray

    def on(self, grid: Grid) -> np.ndarray:
        """Return wear depths (2, n_y), mm, interpolated at a mesh's rows; constant beyond.

        Raises
        ------
        ValueError
            If only one of the depths and the mesh belongs to a line contact.
        """
        if (self.y.size == 1) != (grid.directions == 1):
            raise ValueError("start: both runs must be line contacts, or neither")
        y = grid.y + grid.shift
        return np.stack([np.interp(y, self.y, depth) for depth in self.depths])
