"""Stress at a distance from a contact: its elements act like a few point forces there."""

from collections.abc import Sequence

import numpy as np

from tractive_sam.kernels import stress_sum
from tractive_sam.results import Grid


class DistantLoads:
    """Point forces in place of a contact's tractions, for stress far from the mesh.

    Blocks of elements are halved until their sides are at most `widest` times their distance; each
    block becomes four forces with its load and moments (`kernels.stress_sum.stress_around`). The
    blocks are mirror-symmetric about the middle of the mesh in y: a mirrored load gives exactly the
    mirrored stress. Blocks depend on the mesh, not on the load: stress changes smoothly as a
    contact wears.

    Parameters
    ----------
    grid : Grid
        Elements; lengths in mm.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) on body A, MPa.
    signs : sequence of float
        Sign of each body, see `SIGNS`.
    poisson : sequence of float
        Poisson's ratio of each body.
    widest : float
        Largest side of a block over its distance. The error is proportional to its square: with 0.3
        it is at most 1e-4 of the largest pressure.
    spread : float
        Width of the rows with common blocks over their distance; no influence on the error up to 1.
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
        # From the middle row outwards; for an odd number half of its load is on each side.
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
            self._sides.append((sign, stress_sum.cumulative_sums(loads)))

    def stress(self, x: np.ndarray, depths: np.ndarray) -> np.ndarray:
        """Return stresses (bodies, 6, n_x, n_y, k) at distant x (n_x,) in all rows at k depths.

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
