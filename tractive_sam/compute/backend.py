"""Interface of the solvers to a library of arrays: its functions, transforms and kernels.

An iteration takes the functions of the array API standard from `Backend.xp`, and what the standard
lacks, or does slowly, from the other attributes. Arrays of NumPy belong to `compute.host` (numba
and FFTW), all others to `compute.array_api`. A library with faster kernels is one more module with
these attributes. Meshes, laws and tables of coefficients are made with NumPy.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np

from tractive_sam.kernels import linear_algebra

Array = Any
"""An array of any library; the type of NumPy's would exclude all others."""

Places = tuple[np.ndarray, np.ndarray]
"""Indices (i, j) of elements, two arrays of shape (m,)."""


class Mirror(NamedTuple):
    """Symmetry of fields about an axis y = 0, at the beginning of a mesh of their upper half.

    A single field is even in y.

    Attributes
    ----------
    even : int
        Index of the field, of two, that is even in y; the other one is odd.
    between : bool
        Whether the axis lies between elements: in front of the first row, or in the middle of it.
    """

    even: int
    between: bool

    def whole(self, count: int) -> int:
        """Return the number of rows of a mesh with `count` rows in its upper half."""
        return 2 * count - 1 + self.between

    @classmethod
    def of(cls, field: np.ndarray, rounding: float = 0.0) -> "Mirror | None":
        """Return the symmetry of a vector field about the middle of its mesh, or None.

        Parameters
        ----------
        field : ndarray, shape (2, n_x, n_y)
            The field.
        rounding : float
            Difference of both halves, over the largest value, that is ignored.
        """
        for even in (0, 1):
            apart, size = linear_algebra.asymmetry(field[even], 1.0)
            odd_apart, odd_size = linear_algebra.asymmetry(field[1 - even], -1.0)
            limit = rounding * max(size, odd_size)
            if apart <= limit and odd_apart <= limit:
                return cls(even, between=field.shape[2] % 2 == 0)
        return None

    def unfold(self, half: np.ndarray) -> np.ndarray:
        """Return fields (..., n_x, n_y) on the whole mesh from those on its upper half."""
        mirrored = half[..., ::-1][..., : self.whole(half.shape[-1]) - half.shape[-1]]
        if half.ndim == 3:
            mirrored = mirrored.copy()
            mirrored[1 - self.even] *= -1.0
        return np.concatenate((mirrored, half), axis=-1)


class Backend(Protocol):
    """Operations of an array library for the solvers: convolution, projection, slip direction."""

    @property
    def xp(self) -> Any:
        """Namespace of the array API functions of the library, such as `numpy`."""

    def to_numpy(self, array: Array) -> np.ndarray:
        """Return an array of the library as an array of NumPy."""

    def sum(self, array: Array) -> float:
        """Return the sum of all elements of an array."""

    def dot(self, first: Array, second: Array) -> float:
        """Return the sum of the products of all elements of two arrays."""

    def concat(self, arrays: Sequence[Array]) -> Array:
        """Return arrays joined along their first axis."""

    def spectra(self, tiles: Sequence[np.ndarray], padded: tuple[int, int], kind: Any) -> Any:
        """Return `split_kernels` spectra in the form that `convolve` needs for the type `kind`."""

    def convolve(self, fields: Array, spectra: Any, padded: tuple[int, int]) -> Array:
        """Return the convolution of fields (n, n_x, n_y) with `spectra`, a new array."""

    def project(self, traction: Array, radius: Array) -> Array:
        """Return tractions (2, n_x, n_y), those longer than their radius shortened to it."""

    def turn(self, slip: Array, contact: Array, ahead: float) -> Array:
        """Return slip with its size at the leading face and its direction at the element centre."""

    def add_leading_response(
        self, slip: Array, traction: Array, places: Places, factor: np.ndarray, answer: np.ndarray
    ) -> Array:
        """Return slip times `factor` plus `answer` times traction at `places`; else unchanged."""
