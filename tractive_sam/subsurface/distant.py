"""Stress beside a contact, where its elements act like a few point forces."""

from collections.abc import Sequence

import numpy as np

from tractive_sam.kernels import stress_sum
from tractive_sam.results import Grid


class DistantLoads:
    """The tractions on bodies under one contact as point forces, for points beside the mesh.

    Blocks of elements are halved until their sides are at most `widest` times their distance; each
    is then four forces with its load and moments (`kernels.stress_sum.stress_around`). The rows on
    either side of the middle of the mesh have mirrored blocks: the mirror image in y of a load
    causes exactly the mirror image of the stress. Blocks depend on the mesh, not on the load, so
    that stress changes smoothly as a contact wears.

    Parameters
    ----------
    grid : Grid
        Elements; lengths in mm.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) on body A, MPa.
    signs : sequence of float
        Those of `SIGNS` for each body.
    poisson : sequence of float
        Poisson's ratio of each body.
    widest : float
        Longest side of a block over its distance. The error grows with its square: with 0.3 it is
        1e-4 of the largest pressure at most.
    spread : float
        Width of the rows that share blocks, over their distance. Up to 1 it does not add to the
        error.
    """

    def __init__(
        self,
        grid: Grid,
        tractions: np.ndarray,
        signs: Sequence[float],
        poisson: Sequence[float],
        widest: float = 0.3,
        spread: float = 1.0,
    ):
        nx, ny = grid.elements
        odd, rows = ny % 2, ny - ny // 2
        self._bodies = np.array(signs), np.array(poisson)
        self._widest, self._spread = widest, spread
        # From the middle row outwards; of an odd number half of its load is on either side.
        self._y = (np.arange(ny) - 0.5 * (ny - 1)) * grid.dy
        self._corner = float(grid.x[0] - 0.5 * grid.dx), -0.5 * odd * grid.dy
        self._lengths = grid.dx, grid.dy
        self._block = tuple(1 << (count - 1).bit_length() for count in (nx, rows))
        self._sides = []
        for sign, half in ((1, tractions), (-1, tractions[..., ::-1])):
            loads = np.zeros((3, *self._block))
            loads[:, :nx, :rows] = half[..., ny // 2 :]
            loads[1] *= sign
            loads[..., 0] *= 1.0 - 0.5 * odd
            self._sides.append((sign, stress_sum.summed(loads)))

    def stress(self, x: np.ndarray, depths: np.ndarray) -> np.ndarray:
        """Stresses (bodies, 6, n_x, n_y, k) at x (n_x,), in all rows of the grid, at k depths.

        Depths ascend from above 0; x are beyond the ends of the grid.
        """
        signs, poisson = self._bodies
        out = np.zeros((signs.size, 6, x.size, self._y.size, depths.size))
        part = np.empty(out.shape)
        mirrored = np.array((1.0, 1.0, 1.0, -1.0, 1.0, -1.0))[:, None, None, None]
        for sign, sums in self._sides:
            blocks = self._corner, sums, self._lengths, self._block, self._widest, self._spread
            stress_sum.stress_at_columns(part, x, self._y, depths, signs, poisson, *blocks)
            out += part if sign > 0 else part[:, :, :, ::-1] * mirrored
        return out
