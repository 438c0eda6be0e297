"""Stress below a line contact as a sum over its strips."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tractive_sam.kernels import strip_stress
from tractive_sam.mechanics import StressCriterion, Strips
from tractive_sam.operators import Lattice, StripLayers
from tractive_sam.results import Grid, Point
from tractive_sam.subsurface.mirror import tractions_on_bodies
from tractive_sam.subsurface.multilevel import Layer
from tractive_sam.subsurface.surface import largest_at_surface


@dataclass(frozen=True, eq=False)
class StripLoads:
    """Loaded strips of a half-space (line contact), for stress at any points.

    Attributes
    ----------
    edges : ndarray, shape (m,)
        x, mm.
    jumps : ndarray, shape (m, 3)
        Increase of (p_x, p_y, p_n) across each edge, MPa.
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
        """Return the loaded strips of a line contact's grid, from tractions (3, n_x, 1)."""
        jumps = np.diff(tractions[:, :, 0].T, axis=0, prepend=0.0, append=0.0)
        edges = np.append(grid.x - 0.5 * grid.dx, grid.x[-1] + 0.5 * grid.dx)
        loaded = jumps.any(axis=1)
        return cls(edges[loaded], np.ascontiguousarray(jumps[loaded]), grid.dx, poisson)

    def stress(self, points: np.ndarray) -> np.ndarray:
        """Return stresses (n, 6) at points (n, 3) of the half-space, constant in y, MPa."""
        out = np.empty((len(points), 6))
        at = np.ascontiguousarray(points[:, [0, 2]])
        strip_stress.sum_strip_stress(out, at, self.edges, self.jumps, self.width, self.poisson)
        return out


class StripLevels:
    """Stress below a line contact, to search its maximum (`MultiLevel` without blocks).

    Parameters
    ----------
    grid : Grid
        Grid of a line contact.
    tractions : ndarray, shape (3, n_x, 1)
        (p_x, p_y, p_n) on body A, MPa.
    signs : sequence of float
        Sign of each body, see `SIGNS`.
    bodies : sequence of Strips
        The half-spaces, see `Strips.single_body`.
    criterion : StressCriterion
        Criterion of the stress.
    """

    # Layers cost little; below a line the shear stress may have two maxima, which differ by 2 %.
    growth = 1.25

    def __init__(
        self,
        grid: Grid,
        tractions: np.ndarray,
        signs: Sequence[float],
        bodies: Sequence[Strips],
        criterion: StressCriterion,
    ):
        self._x, self.side = grid.x, grid.dx
        self.half_width = 0.5 * grid.dx * np.count_nonzero(tractions[2])
        self._tractions, self._signs = tractions, signs
        self._bodies, self._criterion = bodies, criterion
        self._lattice = Lattice(grid.elements, grid.dx, grid.dy)
        poisson = [body.A.poisson for body in bodies]
        self._layers = StripLayers(self._lattice, tractions, poisson, signs)
        each = zip(tractions_on_bodies(tractions, signs), poisson, strict=True)
        self._strips = [StripLoads.on_grid(grid, on_body, nu) for on_body, nu in each]

    def layer(self, depth: float) -> Layer:
        """Return the stress layer at a depth, at the element centres."""
        values = self._criterion(self._layers.at(depth).swapaxes(0, 1))
        return Layer(depth, (float(self._x[0]), 0.0), (self.side, 0.0), values)

    def stress_around(
        self, bodies: np.ndarray, points: np.ndarray, around: np.ndarray, closely: bool = False
    ) -> np.ndarray:
        """Return the equivalent stress (m, n) at points (m, n, 3) near the points `around` (m, 3).

        The sum over the elements is exact.
        """
        values = np.empty(points.shape[:2])
        for k, body in enumerate(bodies):
            values[k] = self._criterion(self._strips[body].stress(points[k]).T)
        return values

    def surface(self, sliding: np.ndarray) -> list[tuple[float, Point]]:
        """Return (value, position) of the largest stress at the surface of each body.

        The stress is evaluated at the edges of strips.
        """
        loads = self._bodies, self._signs, self._tractions
        largest = largest_at_surface(self._lattice, *loads, sliding, self._criterion)
        return [(value, (float(self._x[0] + i * self.side), 0.0, 0.0)) for value, i, _ in largest]
