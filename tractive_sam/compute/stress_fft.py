"""The transforms behind stress below the surface, planned once.

Their arrays belong to the plan and are overwritten by its next use.
"""

import numpy as np

from tractive_sam.compute.fft import PlanCache, plan
from tractive_sam.compute.fftw import pyfftw


class LayerTransform:
    """FFTs for `StressLayers`: four packed tables forward, six stress components backward.

    Parameters
    ----------
    shape : tuple of int
        Mesh (n_x, n_y) on which the stresses are wanted.
    padded : tuple of int
        Periods (p_x, p_y) of the tables, even.
    threads : int
        Threads that FFTW may use.

    Attributes
    ----------
    tables : ndarray, shape (4, p_x, p_y)
        Packed tables, the input of `forward`.
    packs : ndarray of complex, shape (4, p_x, p_y/2 + 1)
        Spectra of the tables.
    spectra : ndarray of complex, shape (6, p_x, p_y/2 + 1)
        Spectra of the stresses, for `backward`; destroyed by it.
    """

    def __init__(self, shape: tuple[int, int], padded: tuple[int, int], threads: int = 1):
        (nx, ny), (px, py) = shape, padded
        self.tables = pyfftw.zeros_aligned((4, px, py))
        self.packs = pyfftw.zeros_aligned((4, px, py // 2 + 1), dtype=complex)
        self.spectra = pyfftw.zeros_aligned((6, px, py // 2 + 1), dtype=complex)
        stresses = pyfftw.zeros_aligned((6, nx, py))
        self._stresses = stresses[..., :ny]
        self._tables_y = plan(self.tables, self.packs, 2, "FFTW_FORWARD", threads)
        self._tables_x = plan(self.packs, self.packs, 1, "FFTW_FORWARD", threads)
        self._stress_x = plan(self.spectra, self.spectra, 1, "FFTW_BACKWARD", threads)
        # Rows beyond the mesh are not transformed back.
        self._stress_y = plan(self.spectra[:, :nx], stresses, 2, "FFTW_BACKWARD", threads)

    def forward(self) -> None:
        """Transform the array `tables` into the array `packs`."""
        self._tables_y.execute()
        self._tables_x.execute()

    def backward(self) -> np.ndarray:
        """Transform `spectra` back and return six stresses (6, n_x, n_y), times p_x p_y."""
        self._stress_x.execute()
        self._stress_y.execute()
        return self._stresses


class EdgeTransform:
    """FFTs along a plane for `StressPlane`: eight packed tables of edges, forward.

    Parameters
    ----------
    edges : int
        Number of rows.
    padded : int
        Period p of the tables, even.

    Attributes
    ----------
    tables : ndarray, shape (8, edges, p)
        Packed tables, the input of `forward`.
    packs : ndarray of complex, shape (8, edges, p/2 + 1)
        Spectra of the tables.
    """

    def __init__(self, edges: int, padded: int):
        self.tables = pyfftw.zeros_aligned((8, edges, padded))
        self.packs = pyfftw.zeros_aligned((8, edges, padded // 2 + 1), dtype=complex)
        self._plan = plan(self.tables, self.packs, 2, "FFTW_FORWARD")

    def forward(self) -> None:
        """Transform the array `tables` into the array `packs`."""
        self._plan.execute()


layer_transform = PlanCache(LayerTransform, 8)
"""The `LayerTransform` of its arguments, made on its first use."""

edge_transform = PlanCache(EdgeTransform, 8)
"""The `EdgeTransform` of its arguments, made on its first use."""
