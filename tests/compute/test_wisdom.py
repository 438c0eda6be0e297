"""Plans are remembered between processes, and a cache out of reach does no harm."""

from tractive_sam.compute import wisdom
from tractive_sam.compute.fft import PaddedTransform


def test_wisdom_is_stored_and_recalled(tmp_path, monkeypatch):
    monkeypatch.setenv("TRACTIVE_SAM_CACHE", str(tmp_path / "cache"))
    wisdom.load()  # nothing there yet
    PaddedTransform(1, (5, 6), (10, 12))
    wisdom.save()
    double, single = sorted((tmp_path / "cache").iterdir())
    assert b"fftw" in double.read_bytes()
    assert b"fftwf" in single.read_bytes()
    wisdom.load()


def test_an_unwritable_cache_is_done_without(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("TRACTIVE_SAM_CACHE", str(tmp_path / "file"))
    wisdom.save()
    wisdom.load()
