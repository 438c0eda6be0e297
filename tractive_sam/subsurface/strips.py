"""Stress below a line contact, summed over its strips."""

from dataclasses import dataclass

import numpy as np

from tractive_sam.kernels import strip_stress
from tractive_sam.mechanics import StressCriterion, Strips
from tractive_sam.operators import Lattice
from tractive_sam.results import Grid
from tractive_sam.subsurface.surface import largest_at_surface


@dataclass(frozen=True, eq=False)
class StripLoads:
    """The strips of one half-space, by their edges.

    Attributes
    ----------
    edges : ndarray, shape (m,)
        x, mm.
    jumps : ndarray, shape (m, 3)
        Increase of (p_x, p_y, p_n) across each, MPa.
    width : float
        Width of a strip, mm.
    poisson : float
        Poisson's ratio.
    """

    edges: np.ndarray
    jumps: np.ndarray
    width: float
    poisson: float

    @classmethod
    def on_grid(cls, grid: Grid, tractions: np.ndarray, poisson: float) -> "StripLoads":
        """Take those of the grid of a line contact with tractions (3, n_x, 1)."""
        jumps = np.diff(tractions[:, :, 0].T, axis=0, prepend=0.0, append=0.0)
        edges = np.append(grid.x - 0.5 * grid.dx, grid.x[-1] + 0.5 * grid.dx)
        loaded = jumps.any(axis=1)
        return cls(edges[loaded], np.ascontiguousarray(jumps[loaded]), grid.dx, poisson)

    def stress(self, points: np.ndarray) -> np.ndarray:
        """Stresses (n, 6) at points (n, 3) of the half-space, the same at every y, MPa."""
        out = np.empty((len(points), 6))
        at = np.ascontiguousarray(points[:, [0, 2]])
        strip_stress.stress_at(out, at, self.edges, self.jumps, self.width, self.poisson)
        return out


class StripLevels:
    """The loaded strips in place of a `Pyramid`: they are few, and need no coarser levels.

    Parameters
    ----------
    grid : Grid
        That of a line contact.
    tractions : ndarray, shape (3, n_x, 1)
        (p_x, p_y, p_n) on one half-space, MPa.
    body : Strips
        That half-space, as `Strips.alone` gives it.
    criterion : StressCriterion
        What makes one number of a stress.
    """

    def __init__(self, grid: Grid, tractions: np.ndarray, body: Strips, criterion: StressCriterion):
        self.x, self.y, self.side = grid.x, grid.y, grid.dx
        self.blocks = grid.elements
        self._tractions, self._body, self._criterion = tractions, body, criterion
        self._strips = StripLoads.on_grid(grid, tractions, body.A.poisson)

    def level(self, longest: float) -> "StripLevels":
        """The strips, whatever the length."""
        return self

    def layer(self, depth: float) -> np.ndarray:
        """Equivalent stress at the centres at one depth, shape (n_x, 1), MPa."""
        points = np.stack(np.broadcast_arrays(self.x, 0.0, depth), axis=-1)
        return self.at(points)[:, None]

    def at(self, points: np.ndarray) -> np.ndarray:
        """Equivalent stress (n,) at points (n, 3), MPa."""
        return self._criterion(self._strips.stress(points).T)

    def surface(self, sliding: np.ndarray) -> tuple[float, tuple[float, float, float]]:
        """Largest equivalent stress at the surface, MPa, and where, (x, 0, 0), mm.

        Parameters
        ----------
        sliding : ndarray of bool, shape (n_x, 1)
            Strips of the grid that slip.
        """
        lattice = Lattice(self.blocks, self.side, 1.0)
        value, i, _ = largest_at_surface(
            lattice, self._body, self._tractions, sliding, self._criterion
        )
        return value, (float(self.x[0] + i * self.side), 0.0, 0.0)
