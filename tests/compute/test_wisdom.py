"""Plans are remembered between processes, and a cache out of reach does no harm."""

import pytest

from tractive_sam.compute import fft, fftw
from tractive_sam.compute.fft import PaddedTransform
from tractive_sam.compute.tiles import TiledConvolution, UntiledConvolution


def test_wisdom_is_stored_and_recalled(tmp_path, monkeypatch):
    monkeypatch.setenv("TRACTIVE_SAM_CACHE", str(tmp_path / "cache"))
    fftw.load_wisdom()  # nothing there yet
    PaddedTransform(1, (5, 6), (10, 12))
    fftw.save_wisdom()
    double, single = sorted((tmp_path / "cache").iterdir())
    assert b"fftw" in double.read_bytes()
    assert b"fftwf" in single.read_bytes()
    fftw.load_wisdom()


def test_an_unwritable_cache_is_done_without(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("TRACTIVE_SAM_CACHE", str(tmp_path / "file"))
    fftw.save_wisdom()
    fftw.load_wisdom()


@pytest.mark.parametrize("kind", [UntiledConvolution, TiledConvolution])
def test_only_transforms_of_tiles_are_measured(kind, monkeypatch):
    efforts = set()

    def plan(source, target, axes, direction, flags, threads):
        efforts.add(flags[0])

    monkeypatch.setattr(fft.pyfftw, "FFTW", plan)
    kind(1, (6, 6), (12, 12), False)
    assert efforts == {"FFTW_MEASURE" if kind is TiledConvolution else "FFTW_ESTIMATE"}
