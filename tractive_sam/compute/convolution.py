"""A discrete convolution of several fields with a matrix of kernels."""

import math
from typing import Any

import numpy as np

from tractive_sam.compute.backend import Array, Backend
from tractive_sam.compute.backends import backend_of
from tractive_sam.compute.tiles import split_kernels


class Convolution:
    """Convolution of 1 to 3 fields on a mesh with a matrix of kernels, by zero-padded FFT.

    Discrete convolution and FFT as in Liu, Wang & Liu (2000), Wear 243, 101-111.

    Parameters
    ----------
    spectra : ndarray, shape (entries, p_x, p_y/2 + 1)
        Entries of the matrix of spectra of n fields, divided by p_x p_y: 1 of one field, 3 of two
        fields (11, 12, 22 of a symmetric matrix), or 9 of three fields, row by row.
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

    def __init__(self, spectra: np.ndarray, shape: tuple[int, int], padded: tuple[int, int]):
        fields = {1: 1, 3: 2, 9: 3}[len(spectra)]
        self.shape = (fields, *shape)
        self.applications = 0
        self._padded = padded
        self._tiles = split_kernels(spectra, fields, padded)
        self._spectra: dict[tuple[Backend, Any], Any] = {}

    def __call__(self, fields: Array) -> Array:
        """Apply to fields of shape (fields, n_x, n_y); the result is a new array of their library.

        Fields in single precision are transformed in it, and so is the result.
        """
        self.applications += 1
        backend = backend_of(fields)
        key = backend, fields.dtype
        if key not in self._spectra:
            self._spectra[key] = backend.spectra(self._tiles, self._padded, fields.dtype)
        return backend.convolve(fields, self._spectra[key], self._padded)

    def as_matrix(self) -> np.ndarray:
        """Return the dense matrix, column by column; for small meshes and tests."""
        columns = [self(unit.reshape(self.shape)).ravel() for unit in np.eye(math.prod(self.shape))]
        return np.stack(columns, axis=1)
