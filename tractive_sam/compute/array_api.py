"""Any library of the array API standard: transforms and kernels in terms of its functions.

The functions are the formulas of `kernels` on whole fields, so that they also serve as a reference
for them. Arrays are never changed in part, except new ones by slices.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from tractive_sam.compute.backend import Array, Places
from tractive_sam.compute.tiles import join_kernels


class ArrayApi:
    """Backend of a library that follows the array API standard (`xp`); see `Backend`.

    Parameters
    ----------
    xp : module
        Namespace of the library.
    """

    def __init__(self, xp: Any) -> None:
        self.xp = xp

    def to_numpy(self, array: Array) -> np.ndarray:
        """Return a copy of the array, or a view, as an array of NumPy."""
        return np.from_dlpack(array)

    def sum(self, array: Array) -> float:
        """Return the sum of all elements of an array."""
        return float(self.xp.sum(array))

    def dot(self, first: Array, second: Array) -> float:
        """Return the sum of the products of all elements of two arrays."""
        return float(self.xp.sum(first * second))

    def concat(self, arrays: Sequence[Array]) -> Array:
        """Return arrays joined along their first axis."""
        return self.xp.concat(arrays)

    def spectra(self, tiles: Sequence[np.ndarray], padded: tuple[int, int], kind: Any) -> Array:
        """Return tiles of spectra as a matrix, (n, n, p_x, p_y/2 + 1) (`Backend.spectra`)."""
        places = {1: [[0]], 3: [[0, 1], [1, 2]], 9: [[0, 1, 2], [3, 4, 5], [6, 7, 8]]}
        return self.xp.asarray(join_kernels(tiles, padded)[np.array(places[len(tiles[0])])] + 0j)

    def convolve(self, fields: Array, spectra: Array, padded: tuple[int, int]) -> Array:
        """Return the convolution of fields (n, n_x, n_y) with `spectra` (`Backend.convolve`)."""
        xp, (n, nx, ny) = self.xp, fields.shape
        wide = xp.zeros((n, *padded), dtype=fields.dtype)
        wide[:, :nx, :ny] = fields
        product = xp.sum(spectra * xp.fft.rfftn(wide, axes=(1, 2)), axis=1)
        out = xp.fft.irfftn(product, s=padded, axes=(1, 2), norm="forward")
        return out[:, :nx, :ny]

    def project(self, traction: Array, radius: Array) -> Array:
        """Return tractions (2, n_x, n_y), those longer than their radius shortened to it."""
        xp, size = self.xp, _size(self.xp, traction)
        radius = xp.maximum(radius, 0.0)
        outside = size > radius
        return xp.where(outside, radius / xp.where(outside, size, 1.0), 1.0) * traction

    def turn(self, slip: Array, contact: Array, ahead: float) -> Array:
        """Return slip with its size at the leading face and its direction at the element centre."""
        xp, centre = self.xp, self._centred(slip, contact, ahead)
        square = xp.sum(slip * slip + centre * centre, axis=0)
        nonzero = square >= 1e-200
        square = xp.where(nonzero, square, 1.0)
        agreement = xp.where(nonzero, 2.0 * xp.sum(slip * centre, axis=0) / square, 0.0)
        share = xp.minimum(xp.maximum(2.0 * agreement - 0.5, 0.0), 1.0)
        turned = slip + share * (centre - slip)
        square = xp.sum(turned * turned, axis=0)
        turns = (contact > 0.0) & (share > 0.0) & (square >= 1e-200)
        ratio = _size(xp, slip) / xp.sqrt(xp.where(turns, square, 1.0))
        return xp.where(turns, ratio * turned, slip)

    def _centred(self, slip: Array, contact: Array, ahead: float) -> Array:
        """Return slip at element centres, interpolated from leading faces behind and ahead in x."""
        xp, concat = self.xp, self.xp.concat
        behind = concat((slip[:, :1, :], slip[:, :-1, :]), axis=1)
        front = concat((slip[:, 1:, :], slip[:, -1:, :]), axis=1)
        none = xp.zeros_like(contact)
        back = 0.5 * ahead * concat((none[:1, :], none[1:, :] + 1.0))
        ahead_in = concat((contact[1:, :], none[:1, :])) > 0.0
        beyond_in = concat((contact[2:, :], none[:2, :])) > 0.0
        parabola = ahead_in & beyond_in
        x = xp.where(parabola, 0.5 * back * (1.0 + back), back)
        z = xp.where(parabola, -0.5 * back * (1.0 - back), 0.0)
        return (1.0 - x - z) * slip + x * behind + z * front

    def add_leading_response(
        self, slip: Array, traction: Array, places: Places, factor: np.ndarray, answer: np.ndarray
    ) -> Array:
        """Return slip times `factor` plus `answer` times traction at `places`; else unchanged."""
        factors, answers = np.ones(slip.shape[1:]), np.zeros((*slip.shape[1:], 2, 2))
        factors[places], answers[places] = factor, answer
        answers = self.xp.asarray(np.moveaxis(answers, (2, 3), (0, 1)))
        return self.xp.asarray(factors) * slip + self.xp.sum(answers * traction, axis=1)


def _size(xp: Any, vectors: Array) -> Array:
    """Return the sizes (n_x, n_y) of vectors (2, n_x, n_y)."""
    return xp.sqrt(xp.sum(vectors * vectors, axis=0))
