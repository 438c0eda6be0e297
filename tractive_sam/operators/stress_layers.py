"""Stress in planes parallel to the surface, from tractions on a mesh."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np

from tractive_sam.kernels.stress_lattice import layer_table
from tractive_sam.kernels.stress_spectral import layer_product
from tractive_sam.operators.extent import reach
from tractive_sam.operators.fft import padded_length
from tractive_sam.operators.influence import Lattice
from tractive_sam.operators.stress_fft import layer_transform


class StressLayers:
    """Stress at the centres of a mesh, layer by layer, by discrete convolution and FFT.

    The bodies are half-spaces z >= 0 with z into the body, loaded as in
    :mod:`tractive_sam.kernels.stress`. For tractions constant on every element the result is exact;
    its error is that of rounding, about 1e-15 of the tractions at any depth. Nothing is kept of a
    layer, so that memory does not grow with their number. Bodies under one contact share the
    integrals over an element, which do not depend on Poisson's ratio, and their transforms.

    Parameters
    ----------
    lattice : Lattice
        Elements; lengths in mm.
    tractions : ndarray, shape (bodies, 3, n_x, n_y)
        (p_x, p_y, p_n) acting on each half-space, MPa.
    poisson : sequence of float
        Poisson's ratio of each half-space.
    threads : int
        Threads to use.
    """

    def __init__(
        self, lattice: Lattice, tractions: np.ndarray, poisson: Sequence[float], threads: int = 1
    ):
        self.lattice = lattice
        self.poisson = tuple(poisson)
        self.threads = threads
        loaded = tractions.any(axis=(0, 1))
        # No offset from a loaded element is longer than half a period.
        self._padded = tuple(padded_length(reach(loaded.any(axis=k)) + 1) for k in (1, 0))
        px, py = self._padded
        self._loads = np.fft.rfft2(tractions, s=self._padded) / (2.0 * np.pi * px * py)

    def at(self, depth: float) -> np.ndarray:
        """Stresses at one depth.

        Parameters
        ----------
        depth : float
            z >= 0, mm.

        Returns
        -------
        ndarray, shape (bodies, 6, n_x, n_y)
            In the order of `kernels.stress.COMPONENTS`, MPa; a new array.
        """
        transform = layer_transform(self.lattice.shape, self._padded, self.threads)
        table = transform.tables, float(depth), self.lattice.dx, self.lattice.dy
        self._by_rows(partial(layer_table, *table))
        transform.forward()
        out = np.empty((len(self.poisson), 6, *self.lattice.shape))
        for stress, load, nu in zip(out, self._loads, self.poisson, strict=True):
            spectra = transform.spectra, transform.packs, load
            self._by_rows(partial(layer_product, *spectra, nu))
            stress[:] = transform.backward()
        return out

    def _by_rows(self, work: Callable[[int, int], None]) -> None:
        """Share the rows 0 to p_x/2 of tables and spectra among the threads: work(first, last)."""
        count = self._padded[0] // 2 + 1
        if self.threads == 1:
            work(0, count)
            return
        ends = np.linspace(0, count, self.threads + 1).astype(int)
        with ThreadPoolExecutor(self.threads) as pool:
            list(pool.map(work, ends[:-1], ends[1:]))
