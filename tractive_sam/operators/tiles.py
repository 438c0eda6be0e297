"""Convolutions of large meshes, in tiles of spectral columns that stay in the processor's cache.

A padded transform is done axis by axis. After the transform along y, the columns are independent:
a tile of them is padded, transformed along x, multiplied by the kernels, and transformed back,
before the next tile is loaded. The spectra pass through the memory once instead of five times, and
the padding along x is never stored.
"""

import itertools
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple, Protocol

import numpy as np

from tractive_sam.operators.fft import PaddedTransform, PlanCache, plan
from tractive_sam.operators.fftw import pyfftw
from tractive_sam.operators.meter import count_transform
from tractive_sam.operators.threads import threads_for_transform

Product = Callable[[np.ndarray, np.ndarray], None]
"""In-place product of kernels (entries, m) and spectra (fields, m), as in `kernels.spectral`."""


def tile_edges(fields: int, padded: tuple[int, int], cache: int = 2**19) -> list[int]:
    """Return the first columns of the tiles, and the number of columns.

    Parameters
    ----------
    fields : int
        Number of fields.
    padded : tuple of int
        Padded shape (p_x, p_y).
    cache : int
        Size of a tile, bytes. The time changes by less than 5 % between a quarter and the whole
        second-level cache (1 to 2 MiB); eight columns at least, which are two lines of the cache.
    """
    px, columns = padded[0], padded[1] // 2 + 1
    width = max(8, cache // (16 * fields * px))
    count = max(1, round(columns / width))
    return [k * columns // count for k in range(count + 1)]


def split_kernels(spectra: np.ndarray, fields: int, padded: tuple[int, int]) -> list[np.ndarray]:
    """Return contiguous kernels (entries, m) of each tile, of spectra (entries, p_x, p_y/2 + 1)."""
    edges = tile_edges(fields, padded)
    if len(edges) == 2:
        return [spectra.reshape(len(spectra), -1)]
    tiles = (spectra[..., a:b] for a, b in itertools.pairwise(edges))
    return [np.ascontiguousarray(tile).reshape(len(spectra), -1) for tile in tiles]


class Convolver(Protocol):
    """A convolution on one mesh, planned once."""

    def __call__(
        self, fields: np.ndarray, kernels: Sequence[np.ndarray], product: Product
    ) -> np.ndarray:
        """Return the convolution of fields (n, n_x, n_y) with kernels of `split_kernels`."""


class WholeConvolution:
    """The convolution on a mesh whose spectra fit the cache (`Convolver`).

    Parameters
    ----------
    fields, shape, padded, single
        See `PaddedTransform`.
    """

    def __init__(
        self, fields: int, shape: tuple[int, int], padded: tuple[int, int], single: bool
    ) -> None:
        self._transform = PaddedTransform(fields, shape, padded, single)

    def __call__(
        self, fields: np.ndarray, kernels: Sequence[np.ndarray], product: Product
    ) -> np.ndarray:
        """See `Convolver`."""
        spectrum = self._transform.forward(fields)
        product(kernels[0], spectrum.reshape(len(spectrum), -1))
        return self._transform.backward().copy()


class Buffer(NamedTuple):
    """Padded columns of one tile, and their transforms along x in place."""

    columns: np.ndarray
    forward: Any
    backward: Any

    @classmethod
    def create(cls, shape: tuple[int, int, int], dtype: type) -> "Buffer":
        """Return a buffer of shape (fields, p_x, columns)."""
        columns = pyfftw.zeros_aligned(shape, dtype=dtype)
        directions = ("FFTW_FORWARD", "FFTW_BACKWARD")
        return cls(columns, *(plan(columns, columns, 1, each) for each in directions))

    def convolve(self, rows: np.ndarray, kernels: np.ndarray, product: Product) -> None:
        """Replace columns (fields, n_x, m), without padding, by their convolution."""
        count = rows.shape[1]
        self.columns[:, :count] = rows
        self.columns[:, count:] = 0.0
        self.forward.execute()
        product(kernels, self.columns.reshape(len(rows), -1))
        self.backward.execute()
        rows[:] = self.columns[:, :count]


class TiledConvolution:
    """The convolution on a large mesh, tile by tile (`Convolver`).

    On several threads, each takes its share of the tiles.

    Parameters
    ----------
    fields, shape, padded, single
        See `PaddedTransform`.
    """

    def __init__(
        self, fields: int, shape: tuple[int, int], padded: tuple[int, int], single: bool
    ) -> None:
        self._fields, self._padded, self._ny = fields, padded, shape[1]
        real, spectral = (np.float32, np.complex64) if single else (np.float64, np.complex128)
        (nx, _), (px, py) = shape, padded
        self._real = pyfftw.zeros_aligned((fields, nx, py), dtype=real)
        rows = pyfftw.zeros_aligned((fields, nx, py // 2 + 1), dtype=spectral)
        self._threads = threads_for_transform(padded)
        self._forward = plan(self._real, rows, 2, "FFTW_FORWARD", self._threads)
        self._backward = plan(rows, self._real, 2, "FFTW_BACKWARD", self._threads)
        edges = tile_edges(fields, padded)
        self._tiles = [rows[..., a:b] for a, b in itertools.pairwise(edges)]
        widths = {tile.shape[-1] for tile in self._tiles}
        self._buffers = [
            {width: Buffer.create((fields, px, width), spectral) for width in widths}
            for _ in range(self._threads)
        ]

    def __call__(
        self, fields: np.ndarray, kernels: Sequence[np.ndarray], product: Product
    ) -> np.ndarray:
        """See `Convolver`."""

        def convolve(worker: int) -> None:
            share = slice(worker, None, self._threads)
            for tile, kernel in zip(self._tiles[share], kernels[share], strict=True):
                self._buffers[worker][tile.shape[-1]].convolve(tile, kernel, product)

        for _ in ("forward", "backward"):
            count_transform(self._fields, self._padded)
        self._real[..., : self._ny] = fields
        self._real[..., self._ny :] = 0.0
        self._forward.execute()
        if self._threads == 1:
            convolve(0)
        else:
            # Started for each call, so that no thread waits in a process that forks.
            with ThreadPoolExecutor(self._threads) as pool:
                list(pool.map(convolve, range(self._threads)))
        self._backward.execute()
        return self._real[..., : self._ny].copy()


def _create(
    fields: int, shape: tuple[int, int], padded: tuple[int, int], single: bool
) -> Convolver:
    tiled = len(tile_edges(fields, padded)) > 2
    return (TiledConvolution if tiled else WholeConvolution)(fields, shape, padded, single)


convolver = PlanCache(_create, 32)
"""The `Convolver` of (fields, shape, padded, single), planned on its first use."""
