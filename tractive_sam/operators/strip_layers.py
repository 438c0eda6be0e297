"""Stress at one depth below a line contact, from tractions on its strips."""

from collections.abc import Sequence

import numpy as np

from tractive_sam.compute import padded_length, transform
from tractive_sam.kernels.strip_stress import edge_factors
from tractive_sam.operators.influence import Lattice


class StripLayers:
    """Subsurface stress below a line contact, one depth at a time, by convolution of strips.

    Exact to rounding, about 1e-13 of the tractions; see :mod:`tractive_sam.kernels.strip_stress`.

    Parameters
    ----------
    lattice : Lattice
        A row of strips; lengths in mm.
    tractions : ndarray, shape (3, n_x, 1)
        (p_x, p_y, p_n) acting on a half-space, MPa.
    poisson : sequence of float
        Poisson's ratio of each half-space.
    signs : sequence of float
        Factors of p_x and p_y, for each half-space.
    """

    def __init__(
        self,
        lattice: Lattice,
        tractions: np.ndarray,
        poisson: Sequence[float],
        signs: Sequence[float],
    ):
        self.lattice, self.poisson, self.signs = lattice, tuple(poisson), tuple(signs)
        jumps = np.diff(tractions[:, :, 0], axis=1, prepend=0.0, append=0.0)
        self._shape = 1, jumps.shape[1]
        self._padded = 1, padded_length(jumps.shape[1])
        spectra = transform(3, self._shape, self._padded).forward(jumps[:, None])
        self._loads = spectra[:, 0] / (np.pi * self._padded[1])

    def at(self, depth: float) -> np.ndarray:
        """Return stress tensors at centres of strips at one depth, MPa, shape (bodies, 6, n_x, 1).

        Parameters
        ----------
        depth : float
            z >= 0, mm.

        Returns
        -------
        ndarray, shape (bodies, 6, n_x, 1)
            In the order of `kernels.stress.COMPONENTS`, MPa; a new array.
        """
        table = np.empty((4, self._padded[1]))
        edge_factors(table, float(depth), self.lattice.dx)
        ln, t, xz, zz = np.fft.rfft(table)
        p_x, p_y, p_n = self._loads
        back, count = transform(5, self._shape, self._padded), self.lattice.shape[0]
        out = np.empty((len(self.poisson), 6, count, 1))
        for stress, sign, nu in zip(out, self.signs, self.poisson, strict=True):
            back.spectrum[:, 0] = (
                -sign * p_x * (2.0 * ln + zz) - p_n * (t - xz),
                sign * p_x * zz - p_n * (t + xz),
                -sign * p_y * ln,
                p_n * zz - sign * p_x * (t - xz),
                -sign * p_y * t,
            )
            stress[[0, 2, 3, 4, 5], :, 0] = back.backward()[:, 0, :count]
            stress[1] = nu * (stress[0] + stress[2])
        return out
