"""A discrete convolution of several fields with a matrix of kernels, on a mesh or on half of it."""

import math
from functools import cache
from typing import Any

import numpy as np

from tractive_sam.compute.backend import Array, Backend, Mirror
from tractive_sam.compute.tiles import column_stride, split_kernels


def backend_of(array: Array) -> Backend:
    """Return the backend of an array: of NumPy, or of its library by the array API standard."""
    return _host() if isinstance(array, np.ndarray) else _array_api(array.__array_namespace__())


@cache
def _host() -> Backend:
    """Return the backend of NumPy."""
    from tractive_sam.compute.host import Host  # noqa: PLC0415

    return Host()


@cache
def _array_api(xp: Any) -> Backend:
    """Return the backend of another library by its namespace."""
    from tractive_sam.compute.array_api import ArrayApi  # noqa: PLC0415

    return ArrayApi(xp)


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
        fields = {1: 1, 2: 1, 3: 2, 9: 3}[len(spectra)]
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
        return self._convolve(backend, fields, self._spectra[key])

    def _convolve(self, backend: Any, fields: Array, spectra: Any) -> Array:
        """Return the convolution of fields with spectra in the form of a backend."""
        return backend.convolve(fields, spectra, self._padded)

    def as_matrix(self) -> np.ndarray:
        """Return the dense matrix, column by column; for small meshes and tests."""
        columns = [self(unit.reshape(self.shape)).ravel() for unit in np.eye(math.prod(self.shape))]
        return np.stack(columns, axis=1)


class MirroredConvolution(Convolution):
    """Convolution of symmetric fields, computed on the upper half of their mesh.

    Its fields are arrays of NumPy. Of two fields one is even and one is odd in y, so that their sum
    determines both: one real transform of the whole mesh carries them, half of the work of a
    `Convolution`.

    With the spectrum h of the sum, the spectrum of the field mirrored in y is conj(h) at the
    opposite k_x, times a phase if the axis lies between elements. Even and odd parts of h are half
    of the sum and of the difference of both.

    Parameters
    ----------
    spectra : ndarray, shape (1 or 3, p_x, p_y/2 + 1)
        See `Convolution`; of the whole mesh. The mixed entry must be odd in y, others even.
    shape : tuple of int
        Shape (n_x, n) of the upper half.
    padded : tuple of int
        Periods (p_x, p_y) for the whole mesh.
    mirror : Mirror
        The symmetry.
    """

    def __init__(
        self, spectra: np.ndarray, shape: tuple[int, int], padded: tuple[int, int], mirror: Mirror
    ):
        (px, py), fields = padded, {1: 1, 3: 2}[len(spectra)]
        if fields == 2:
            even, odd = spectra[2 * mirror.even], spectra[2 - 2 * mirror.even]
            phase = np.exp(2j * np.pi / py * np.arange(py // 2 + 1)) if mirror.between else 1.0
            direct, crossed = 0.25 * (even + odd) + 0.5 * spectra[1], 0.25 * (even - odd) * phase
            spectra = np.stack((direct, crossed))
        super().__init__(spectra, shape, padded)
        if fields == 2:
            stride = column_stride(px)
            self._tiles = [tile.reshape(2, -1, stride)[..., :px].copy() for tile in self._tiles]
        self.shape, self._mirror = (fields, *shape), mirror

    def _convolve(self, backend: Any, fields: Array, spectra: Any) -> Array:
        """Return the convolution of NumPy's arrays on the upper half of the mesh."""
        return backend.convolve(fields, spectra, self._padded, self._mirror)
