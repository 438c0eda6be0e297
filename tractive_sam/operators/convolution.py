"""A discrete convolution of several fields with a matrix of kernels."""

from collections.abc import Callable
from functools import cached_property

import numpy as np

from tractive_sam.operators.tiles import convolver, split_kernels


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
    padded : tuple of int
        Periods (p_x, p_y); if they are shorter than 2 n - 1 the convolution is cyclic.

    Attributes
    ----------
    applications : int
        Number of applications of the operator, a measure of cost that does not depend on the
        machine.
    """

    def __init__(
        self,
        spectra: np.ndarray,
        product: Callable[[np.ndarray, np.ndarray], None],
        fields: int,
        shape: tuple[int, int],
        padded: tuple[int, int],
    ):
        self.shape = (fields, *shape)
        self.applications = 0
        self._padded = padded
        self._kernels = split_kernels(spectra, fields, padded)
        self._product = product

    def __call__(self, fields: np.ndarray) -> np.ndarray:
        """Apply to fields of shape (fields, n_x, n_y); the result is a new array.

        Fields in single precision are transformed in it, and so is the result.
        """
        self.applications += 1
        single = fields.dtype == np.float32
        convolve = convolver(self.shape[0], self.shape[1:], self._padded, single)
        return convolve(fields, self._single if single else self._kernels, self._product)

    @cached_property
    def _single(self) -> list[np.ndarray]:
        """Spectra of the kernels in single precision, for fields of float32."""
        kind = np.complex64 if np.iscomplexobj(self._kernels[0]) else np.float32
        return [tile.astype(kind) for tile in self._kernels]

    def as_matrix(self) -> np.ndarray:
        """Return the convolution as a dense matrix, from its effect on unit vectors; for tests."""
        size = int(np.prod(self.shape))
        columns = [self(unit.reshape(self.shape)).ravel() for unit in np.eye(size)]
        return np.stack(columns, axis=1)
