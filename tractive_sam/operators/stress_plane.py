"""Stress on one vertical plane, from tractions on a mesh."""

from collections.abc import Sequence
from typing import Literal

import numpy as np

from tractive_sam.compute import edge_transform, padded_length
from tractive_sam.kernels.stress_lattice import edge_table, plane_product
from tractive_sam.operators.load_extent import extent, largest_offset
from tractive_sam.results import Grid


class StressPlane:
    """Subsurface stress on a vertical plane x or y = constant, one depth at a time.

    Bodies, accuracy and sharing as for `StressLayers`, at a fraction of its cost: along the plane
    the elements are convolved by FFT, across it they are summed in the spectrum. The integral over
    an element is a difference between two of its edges, which neighbours share. So the sum runs
    over edges, with the jump of the traction across them, and edges at equal distances on both
    sides of the plane are taken together.

    Parameters
    ----------
    grid : Grid
        Elements; lengths in mm.
    normal : "x" or "y"
        The plane is x = position and its points are at the grid's y, or the reverse.
    position : float
        Position of the plane, mm; anywhere.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) acting on a half-space, MPa.
    poisson : sequence of float
        Poisson's ratio of each half-space.
    signs : sequence of float
        Factors of p_x and p_y, for each half-space.
    """

    exchanged = (1, 0, 2, 3, 5, 4)
    """The components xx, yy, zz, xy, xz, yz after an exchange of x and y."""

    def __init__(
        self,
        grid: Grid,
        normal: Literal["x", "y"],
        position: float,
        tractions: np.ndarray,
        poisson: Sequence[float],
        signs: Sequence[float],
    ):
        self.poisson, self.signs = tuple(poisson), tuple(signs)
        across, step, self._step = grid.x, grid.dx, grid.dy
        self._exchanged = normal == "y"
        if self._exchanged:
            # From here on the plane is x = position.
            across, step, self._step = grid.y, grid.dy, grid.dx
            tractions = tractions.swapaxes(1, 2)[[1, 0, 2]]
        loaded = np.any(tractions, axis=0)
        self._points = loaded.shape[1]
        self._padded = padded_length(largest_offset(np.any(loaded, axis=0)) + 1)
        rows = extent(np.any(loaded, axis=1))
        jumps = np.diff(tractions[:, rows], axis=1, prepend=0.0, append=0.0)
        # Plane minus edge, in elements.
        offsets = _round_to_half((position - across[rows.start]) / step + 0.5) - np.arange(
            jumps.shape[1]
        )
        distances, group = np.unique(np.abs(offsets), return_inverse=True)
        loads = np.zeros((2, 3, distances.size, self._points))
        for edge, k in enumerate(group):
            loads[0, :, k] += jumps[:, edge]
            loads[1, :, k] += np.sign(offsets[edge]) * jumps[:, edge]
        self._distances = distances * step
        self._loads = np.fft.rfft(loads, self._padded) / (2.0 * np.pi)

    def at(self, depth: float) -> np.ndarray:
        """Return the stress tensors along the plane at one depth, MPa, shape (bodies, 6, n).

        Parameters
        ----------
        depth : float
            z >= 0, mm.

        Returns
        -------
        ndarray, shape (bodies, 6, n)
            In the order of `kernels.stress.COMPONENTS`, MPa; a new array.
        """
        transform = edge_transform(self._distances.size, self._padded)
        edge_table(transform.tables, self._distances, float(depth), self._step)
        transform.forward()
        spectra = np.empty((len(self.poisson), 6, self._padded // 2 + 1), dtype=complex)
        for out, sign, nu in zip(spectra, self.signs, self.poisson, strict=True):
            plane_product(out, transform.packs, self._loads, sign, nu)
        stresses = np.fft.irfft(spectra, self._padded)[..., : self._points]
        return stresses[:, self.exchanged] if self._exchanged else stresses


def _round_to_half(place: float) -> float:
    """Round a coordinate in elements to a multiple of 0.5 if it is within 1e-9 of it."""
    # Distance, in elements, below which a plane lies on a row of centres or of edges.
    coincident = 1e-9
    nearest = 0.5 * round(2.0 * place)
    return nearest if abs(place - nearest) < coincident else place
