"""Arrays of NumPy with FFTW and numba: the backend of this machine's processor."""

from collections.abc import Sequence
from time import process_time
from typing import Any, ClassVar

import numpy as np

from tractive_sam.compute.backend import Mirror, Places
from tractive_sam.compute.fft import count_time, is_timed
from tractive_sam.compute.tiles import Product, convolver
from tractive_sam.kernels import friction, linear_algebra


class Host:
    """Backend of NumPy arrays: calls NumPy and compiled kernels directly; see `Backend`."""

    xp: Any = np
    products: ClassVar[dict[int, Product]] = {
        1: linear_algebra.scalar,
        2: linear_algebra.mirrored,
        3: linear_algebra.symmetric_2x2,
        9: linear_algebra.full_3x3,
    }
    """Products of spectra by the number of different entries in the matrix of spectra."""

    def to_numpy(self, array: np.ndarray) -> np.ndarray:
        """Return the array (`Backend.to_numpy`)."""
        return array

    def sum(self, array: np.ndarray) -> float:
        """Return the sum of all elements (`Backend.sum`)."""
        return array.sum()

    def dot(self, first: np.ndarray, second: np.ndarray) -> float:
        """Return the sum of the products of all elements (`Backend.dot`)."""
        return np.vdot(first, second)

    def concat(self, arrays: Sequence[np.ndarray]) -> np.ndarray:
        """Return arrays joined along their first axis (`Backend.concat`)."""
        return np.concatenate(arrays)

    def spectra(
        self, tiles: Sequence[np.ndarray], padded: tuple[int, int], kind: Any
    ) -> Sequence[np.ndarray]:
        """Return the spectra, for single precision a copy in it (`Backend.spectra`)."""
        if kind != np.float32:
            return tiles
        single = np.complex64 if np.iscomplexobj(tiles[0]) else np.float32
        return [tile.astype(single) for tile in tiles]

    def convolve(
        self,
        fields: np.ndarray,
        spectra: Sequence[np.ndarray],
        padded: tuple[int, int],
        mirror: Mirror | None = None,
    ) -> np.ndarray:
        """Return the convolution in the precision of the fields (`Backend.convolve`).

        With a mirror the fields are given on the upper half of their mesh.
        """
        single = fields.dtype == np.float32
        plan = convolver(len(fields), fields.shape[1:], padded, single, mirror)
        timed = not single and is_timed()
        began = process_time() if timed else 0.0
        result = plan(fields, spectra, self.products[len(spectra[0])])
        if timed:
            count_time(1 if mirror else len(fields), padded, began)
        return result

    def project(self, traction: np.ndarray, radius: np.ndarray) -> np.ndarray:
        """Return tractions (2, n_x, n_y), those longer than their radius shortened to it."""
        out = np.empty_like(traction)
        friction.project(traction, radius, out)
        return out

    def turn(self, slip: np.ndarray, contact: np.ndarray, ahead: float) -> np.ndarray:
        """Return slip with its size at the leading face and its direction at the element centre."""
        out = np.empty_like(slip)
        friction.turn(slip, contact, out, ahead)
        return out

    def add_leading_response(
        self,
        slip: np.ndarray,
        traction: np.ndarray,
        places: Places,
        factor: np.ndarray,
        answer: np.ndarray,
    ) -> np.ndarray:
        """Return slip times `factor` plus `answer` times traction at `places`; else unchanged."""
        slip = slip.copy()
        friction.add_leading_response(slip, traction, *places, factor, answer)
        return slip
