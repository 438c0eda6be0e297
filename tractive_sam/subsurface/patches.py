"""Stress as a sum over the loaded elements of a mesh."""

from dataclasses import dataclass

import numpy as np

from tractive_sam.kernels import stress_sum


@dataclass(frozen=True, eq=False)
class PatchLoads:
    """Loaded elements (patches) of a half-space, for stress at any points.

    Attributes
    ----------
    centres : ndarray, shape (m, 2)
        (x, y), mm.
    tractions : ndarray, shape (m, 3)
        (p_x, p_y, p_n), MPa.
    sides : tuple of float
        (dx, dy), mm.
    poisson : float
        Poisson's ratio.
    """

    centres: np.ndarray
    tractions: np.ndarray
    sides: tuple[float, float]
    poisson: float

    @classmethod
    def on_mesh(
        cls,
        x: np.ndarray,
        y: np.ndarray,
        sides: tuple[float, float],
        tractions: np.ndarray,
        poisson: float,
    ) -> "PatchLoads":
        """Return the patches of a mesh that carry tractions (3, n_x, n_y)."""
        i, j = np.nonzero(tractions.any(axis=0))
        loads = np.ascontiguousarray(tractions[:, i, j].T)
        return cls(np.stack((x[i], y[j]), axis=1), loads, sides, poisson)

    def stress(self, points: np.ndarray) -> np.ndarray:
        """Return stresses (n, 6) at points (n, 3) of the half-space, MPa."""
        out = np.empty((len(points), 6))
        stress_sum.sum_patch_stress(
            out, points, self.centres, self.tractions, *self.sides, self.poisson
        )
        return out
