"""Convolutions in tiles of columns."""

import numpy as np
import pytest

from tractive_sam.compute import Convolution, tiles

SHAPE, PADDED = (11, 23), (24, 48)


def kernels(rng):
    return np.fft.rfft2(rng.standard_normal((3, *PADDED))) / np.prod(PADDED)


@pytest.fixture(autouse=True)
def _no_plans_remain():
    yield
    tiles.convolver.cache_clear()


def convolution(spectra):
    tiles.convolver.cache_clear()
    return Convolution(spectra, SHAPE, PADDED)


def in_tiles(monkeypatch, threads=1):
    """Have tiles of eight columns, and perhaps several threads."""
    edges = [0, 8, 16, 25]  # of different widths
    monkeypatch.setattr(tiles, "tile_edges", lambda fields, padded: edges)
    monkeypatch.setattr(tiles, "threads_for_transform", lambda padded: threads)


@pytest.mark.parametrize("kind", [np.float32, np.float64])
@pytest.mark.parametrize("threads", [1, 2, 5])
def test_tiles_give_the_result_of_the_whole(kind, threads, monkeypatch):
    rng = np.random.default_rng(3)
    spectra, fields = kernels(rng), rng.standard_normal((2, *SHAPE)).astype(kind)
    whole = convolution(spectra)(fields)
    in_tiles(monkeypatch, threads)
    in_parts = convolution(spectra)
    found = [in_parts(fields) for _ in range(2)]
    assert found[0].dtype == kind
    assert np.array_equal(*found)  # the second call finds no remains of the first
    # Transforms of other lengths of memory round differently, by some units in the last place.
    assert np.abs(found[0] - whole).max() < 20 * np.finfo(kind).eps * np.abs(whole).max()


def test_the_convolution_is_the_sum_over_elements(monkeypatch):
    rng = np.random.default_rng(4)
    table = rng.standard_normal(PADDED)
    in_tiles(monkeypatch)
    fields = rng.standard_normal((2, *SHAPE))
    spectra = np.fft.rfft2([table, np.zeros(PADDED), table]) / table.size
    found = convolution(spectra)(fields)
    i, j = 7, 20
    x, y = np.ogrid[: SHAPE[0], : SHAPE[1]]
    direct = (table[i - x, j - y] * fields).sum(axis=(1, 2))
    assert found[:, i, j] == pytest.approx(direct, rel=1e-12)  # rounding of 253 terms


@pytest.mark.parametrize("padded", [(2, 1), (182, 182), (364, 364), (4096, 4096), (40000, 16)])
def test_tiles_cover_all_columns_once(padded):
    edges = tiles.tile_edges(2, padded)
    assert edges[0] == 0
    assert edges[-1] == padded[1] // 2 + 1
    assert np.all(np.diff(edges) >= min(8, edges[-1]))


def test_meshes_that_fit_the_cache_are_not_divided():
    assert len(tiles.tile_edges(2, (182, 182))) == 2
    assert len(tiles.tile_edges(2, (1024, 1024))) > 2
