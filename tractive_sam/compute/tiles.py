"""Convolutions of large meshes, in tiles of spectral columns that stay in the processor's cache.

A padded transform is done axis by axis: rows along y, in blocks, then columns along x. The columns
of the transformed rows are independent: a tile of them is padded, transformed, multiplied by the
kernels, and transformed back, before the next tile is loaded. Spectra pass through the memory once
instead of five times, and the padding is never stored.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import Any, NamedTuple, Protocol

import numpy as np

from tractive_sam.compute.backend import Mirror
from tractive_sam.compute.fft import PlanCache, count_transform, plan, threads_for_transform
from tractive_sam.compute.fftw import pyfftw
from tractive_sam.kernels import linear_algebra

Product = Callable[[np.ndarray, np.ndarray], None]
"""In-place product of kernels (entries, m) and spectra (fields, m): `kernels.linear_algebra`."""


def tile_edges(
    fields: int, padded: tuple[int, int], cache: int = 2**19, whole: int = 2**22
) -> list[int]:
    """Return the column indices that bound the tiles of a spectrum: first columns and the end.

    Parameters
    ----------
    fields : int
        Number of fields.
    padded : tuple of int
        Padded shape (p_x, p_y).
    cache : int
        Size of a tile, bytes. The time changes by less than 5 % between a quarter and all of the
        second-level cache (1 to 2 MiB). A tile has eight columns at least, which are two lines of
        the cache.
    whole : int
        Size of a spectrum, bytes, up to which it is one tile: without copies to and from tiles a
        convolution takes up to a quarter less time as long as the third-level cache holds it.
    """
    px, columns = padded[0], padded[1] // 2 + 1
    width = max(8, cache // (16 * fields * px))
    count = 1 if 16 * fields * px * columns <= whole else round(columns / width)
    return [k * columns // count for k in range(count + 1)]


def column_stride(px: int, gap: int = 4) -> int:
    """Return the distance between columns in memory: p_x plus a gap that avoids cache conflicts.

    Parameters
    ----------
    px : int
        Padded length.
    gap : int
        Numbers between two columns. Without it, lengths such as 128 and 192 put the numbers of a
        row into few lines of the cache: the transforms along y take three times as long.
    """
    return px + gap


def split_kernels(spectra: np.ndarray, fields: int, padded: tuple[int, int]) -> list[np.ndarray]:
    """Return spectra (entries, p_x, p_y/2 + 1) as one contiguous array (entries, m) per tile.

    A tile has its columns one after the other, at the distance `column_stride`.
    """
    entries, px, half = spectra.shape
    columns = np.zeros((entries, half, column_stride(px)), spectra.dtype)
    columns[..., :px] = spectra.swapaxes(1, 2)
    tiles = (columns[:, a:b] for a, b in pairwise(tile_edges(fields, padded)))
    return [np.ascontiguousarray(tile).reshape(entries, -1) for tile in tiles]


def join_kernels(tiles: Sequence[np.ndarray], padded: tuple[int, int]) -> np.ndarray:
    """Return the spectra (entries, p_x, p_y/2 + 1) that `split_kernels` divided into tiles."""
    entries, px = len(tiles[0]), padded[0]
    stored = [tile.reshape(entries, -1, column_stride(px)) for tile in tiles]
    return np.concatenate(stored, axis=1)[..., :px].swapaxes(1, 2)


def load_rows(fields: np.ndarray, first: int, padded: np.ndarray, mirror: Mirror | None) -> None:
    """Set padded rows (rows, p_y) to those of fields from the index `first` on.

    The rows of all fields follow each other; with a mirror a row has all fields.
    """
    if mirror is not None:
        linear_algebra.pack_half(fields, mirror.even, int(mirror.between), first, padded)
        return
    ny = fields.shape[-1]
    padded[:, :ny] = fields.reshape(-1, ny)[first : first + len(padded)]
    padded[:, ny:] = 0.0


def store_rows(
    padded: np.ndarray, fields: np.ndarray, first: int, out: np.ndarray, mirror: Mirror | None
) -> None:
    """Set rows of `out` from padded rows, the inverse of `load_rows` of `fields`."""
    if mirror is not None:
        linear_algebra.unpack_half(padded, fields, mirror.even, int(mirror.between), first, out)
        return
    ny = fields.shape[-1]
    out.reshape(-1, ny)[first : first + len(padded)] = padded[:, :ny]


class Convolver(Protocol):
    """Protocol of a convolution on one mesh: a call with fields, kernels and a product."""

    def __call__(
        self, fields: np.ndarray, kernels: Sequence[np.ndarray], product: Product
    ) -> np.ndarray:
        """Return the convolution of fields (n, n_x, n_y) with kernels of `split_kernels`."""


class UntiledConvolution:
    """Convolution on a small mesh, with spectra that fit the processor's cache (`Convolver`).

    Columns are stored contiguously: the transforms along x take a quarter less time, and those
    along y read and write at a stride at hardly any cost.

    Parameters
    ----------
    fields, shape, padded, single
        See `PaddedTransform`.
    mirror : Mirror, optional
        Symmetry of fields that are given on the upper half of their mesh, one after packing.
    """

    def __init__(
        self,
        fields: int,
        shape: tuple[int, int],
        padded: tuple[int, int],
        single: bool,
        mirror: Mirror | None = None,
    ) -> None:
        (nx, _), (px, py) = shape, padded
        self._fields, self._padded, self._mirror = fields, padded, mirror
        real, spectral = _number_types(single)
        values = pyfftw.zeros_aligned((fields, nx, py), dtype=real)
        stored = (fields, py // 2 + 1, column_stride(px))
        # The estimated transform along x takes half as long again in place.
        arrays = [pyfftw.zeros_aligned(stored, dtype=spectral) for _ in range(3)]
        self._rows, self._spectrum = values.reshape(-1, py), arrays[1].reshape(fields, -1)
        columns, spectrum, product = (array[..., :px] for array in arrays)

        def rows_of(columns: np.ndarray) -> np.ndarray:
            return columns[..., :nx].swapaxes(1, 2)

        # Forward along x does not change its input, so that the padding of `columns` stays zero.
        self._forward = (
            plan(values, rows_of(columns), 2, "FFTW_FORWARD"),
            plan(columns, spectrum, 2, "FFTW_FORWARD"),
        )
        self._backward = (
            plan(spectrum, product, 2, "FFTW_BACKWARD"),
            plan(rows_of(product), values, 2, "FFTW_BACKWARD"),
        )
        columns[:] = 0.0  # planning wrote into it

    def __call__(
        self, fields: np.ndarray, kernels: Sequence[np.ndarray], product: Product
    ) -> np.ndarray:
        """Return the convolution of fields (n, n_x, n_y) with kernels of `split_kernels`."""
        out = np.empty(fields.shape, fields.dtype)
        load_rows(fields, 0, self._rows, self._mirror)
        count_transform(2 * self._fields, self._padded)
        for transform in self._forward:
            transform.execute()
        product(kernels[0], self._spectrum)
        for transform in self._backward:
            transform.execute()
        store_rows(self._rows, fields, 0, out, self._mirror)
        return out


class RowBuffer(NamedTuple):
    """Arrays and FFTs along y for one block of rows: real inputs, spectra, real outputs."""

    inputs: np.ndarray
    spectra: np.ndarray
    outputs: np.ndarray
    forward: Any
    backward: Any

    @classmethod
    def create(cls, rows: int, py: int, single: bool) -> "RowBuffer":
        """Return a buffer for a number of rows of the padded length p_y."""
        real, spectral = _number_types(single)
        inputs, outputs = (pyfftw.zeros_aligned((rows, py), dtype=real) for _ in range(2))
        spectra = pyfftw.zeros_aligned((rows, py // 2 + 1), dtype=spectral)
        forward = plan(inputs, spectra, 1, "FFTW_FORWARD", measured=True)
        backward = plan(spectra, outputs, 1, "FFTW_BACKWARD", measured=True)
        return cls(inputs, spectra, outputs, forward, backward)


class ColumnBuffer(NamedTuple):
    """Padded columns of one tile, and their in-place FFTs along x, forward and backward.

    Columns are stored contiguously, which FFTW transforms in 0.8 to 0.95 of the time.
    """

    columns: np.ndarray
    forward: Any
    backward: Any

    @classmethod
    def create(cls, fields: int, count: int, px: int, single: bool) -> "ColumnBuffer":
        """Return a zero buffer (fields, columns, p_x + gap), complex64 if `single`, with FFTs."""
        stored = fields, count, column_stride(px)
        columns = pyfftw.zeros_aligned(stored, dtype=_number_types(single)[1])
        used, directions = columns[..., :px], ("FFTW_FORWARD", "FFTW_BACKWARD")
        return cls(columns, *(plan(used, used, 2, each, measured=True) for each in directions))


class Worker:
    """Work of one thread in a `TiledConvolution`: its rows, its tiles of columns, its buffers.

    Parameters
    ----------
    spectra : ndarray of complex, shape (fields, n_x, p_y/2 + 1)
        Rows of all fields transformed along y; the workers share it.
    padded : tuple of int
        Padded shape (p_x, p_y).
    share : slice
        Blocks of rows and tiles of columns of this worker.
    mirror : Mirror, optional
        See `UntiledConvolution`.
    """

    def __init__(
        self, spectra: np.ndarray, padded: tuple[int, int], share: slice, mirror: Mirror | None
    ) -> None:
        fields, nx, half = spectra.shape
        single, self._share, self._mirror = spectra.dtype == np.complex64, share, mirror
        self._spectra = spectra.reshape(-1, half)
        # First and end of blocks of rows that each fit into the cache of the processor.
        count = -(-16 * padded[1] * fields * nx // 2**18)
        self._blocks = [*pairwise(k * fields * nx // count for k in range(count + 1))][share]
        heights = {b - a for a, b in self._blocks}
        self._rows = {n: RowBuffer.create(n, padded[1], single) for n in heights}
        edges = tile_edges(fields, padded)
        self._tiles = [spectra[..., a:b].swapaxes(1, 2) for a, b in pairwise(edges)][share]
        widths = {tile.shape[1] for tile in self._tiles}
        self._columns = {n: ColumnBuffer.create(fields, n, padded[0], single) for n in widths}

    def transform_rows(self, fields: np.ndarray) -> None:
        """Transform this thread's rows of fields (n, n_x, n_y) along y into its spectra."""
        for a, b in self._blocks:
            buffer = self._rows[b - a]
            load_rows(fields, a, buffer.inputs, self._mirror)
            buffer.forward.execute()
            self._spectra[a:b] = buffer.spectra

    def convolve_columns(self, kernels: Sequence[np.ndarray], product: Product) -> None:
        """Convolve the tiles of this thread along x: pad, transform, multiply, transform back."""
        for tile, kernel in zip(self._tiles, kernels[self._share], strict=True):
            buffer, nx = self._columns[tile.shape[1]], tile.shape[2]
            buffer.columns[..., :nx] = tile
            buffer.columns[..., nx:] = 0.0
            buffer.forward.execute()
            product(kernel, buffer.columns.reshape(len(tile), -1))
            buffer.backward.execute()
            tile[:] = buffer.columns[..., :nx]

    def restore_rows(self, fields: np.ndarray, out: np.ndarray) -> None:
        """Transform the rows of this thread back along y, into its rows of `out`, like fields."""
        for a, b in self._blocks:
            buffer = self._rows[b - a]
            buffer.spectra[:] = self._spectra[a:b]
            buffer.backward.execute()
            store_rows(buffer.outputs, fields, a, out, self._mirror)


class TiledConvolution:
    """Convolution on a large mesh by several threads, tile by tile (`Convolver`).

    Parameters
    ----------
    fields, shape, padded, single, mirror
        See `UntiledConvolution`.
    """

    def __init__(
        self,
        fields: int,
        shape: tuple[int, int],
        padded: tuple[int, int],
        single: bool,
        mirror: Mirror | None = None,
    ) -> None:
        self._fields, self._padded = fields, padded
        half = (fields, shape[0], padded[1] // 2 + 1)
        spectra = pyfftw.zeros_aligned(half, dtype=_number_types(single)[1])
        threads = threads_for_transform(padded)
        shares = (slice(k, None, threads) for k in range(threads))
        self._workers = [Worker(spectra, padded, share, mirror) for share in shares]

    def __call__(
        self, fields: np.ndarray, kernels: Sequence[np.ndarray], product: Product
    ) -> np.ndarray:
        """Return the convolution of fields (n, n_x, n_y) with kernels of `split_kernels`."""
        count_transform(2 * self._fields, self._padded)
        out = np.empty(fields.shape, fields.dtype)
        phases: tuple[Callable[[Worker], None], ...] = (
            lambda worker: worker.transform_rows(fields),
            lambda worker: worker.convolve_columns(kernels, product),
            lambda worker: worker.restore_rows(fields, out),
        )
        if len(self._workers) == 1:
            for phase in phases:
                phase(self._workers[0])
        else:
            # Started for each call, so that no thread waits in a process that forks.
            with ThreadPoolExecutor(len(self._workers)) as pool:
                for phase in phases:
                    list(pool.map(phase, self._workers))
        return out


def _number_types(single: bool) -> tuple[type, type]:
    """Return (real type, complex type) of single or double precision."""
    return (np.float32, np.complex64) if single else (np.float64, np.complex128)


def _create(
    fields: int,
    shape: tuple[int, int],
    padded: tuple[int, int],
    single: bool,
    mirror: Mirror | None = None,
) -> Convolver:
    """Return the convolution for a mesh: tiled if its spectra do not fit the cache."""
    fields = 1 if mirror else fields
    tiled = len(tile_edges(fields, padded)) > 2
    return (TiledConvolution if tiled else UntiledConvolution)(
        fields, shape, padded, single, mirror
    )


convolver = PlanCache(_create, 32)
"""The `Convolver` of (fields, shape, padded, single, mirror), planned on its first use."""
