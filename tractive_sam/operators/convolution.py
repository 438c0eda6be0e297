"""A discrete convolution of several fields with a matrix of kernels."""

from collections.abc import Callable

import numpy as np

from tractive_sam.operators.fft import transform


class Convolution:
    """Linear map ``fields -> K * fields`` on a mesh, by zero-padded FFT (DC-FFT).

    Discrete convolution and FFT as in Liu, Wang & Liu (2000), Wear 243, 101-111.

    Parameters
    ----------
    spectra : ndarray, shape (entries, p_x, p_y/2 + 1)
        Entries of the matrix of spectra, as `product` wants them.
    product : callable
        One of the in-place products of :mod:`tractive_sam.kernels.spectral`.
    fields : int
        Number of fields.
    shape : tuple of int
        Mesh (n_x, n_y).
    threads : int
        Threads of the transforms.

    Attributes
    ----------
    applications : int
        How often the operator was applied; the machine-independent measure of cost.
    """

    def __init__(
        self,
        spectra: np.ndarray,
        product: Callable[[np.ndarray, np.ndarray], None],
        fields: int,
        shape: tuple[int, int],
        threads: int = 1,
    ):
        self.shape = (fields, *shape)
        self.applications = 0
        self._spectra = spectra.reshape(len(spectra), -1)
        self._product = product
        self._threads = threads

    def __call__(self, fields: np.ndarray) -> np.ndarray:
        """Apply to fields of shape (fields, n_x, n_y); the result is a new array."""
        self.applications += 1
        plan = transform(self.shape[0], self.shape[1:], self._threads)
        spectrum = plan.forward(fields)
        self._product(self._spectra, spectrum.reshape(len(spectrum), -1))
        return plan.backward().copy()

    def as_matrix(self) -> np.ndarray:
        """The dense matrix, column by column; for small meshes and tests."""
        size = int(np.prod(self.shape))
        columns = [self(unit.reshape(self.shape)).ravel() for unit in np.eye(size)]
        return np.stack(columns, axis=1)
