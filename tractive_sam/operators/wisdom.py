"""FFTW's wisdom, kept between processes so that a mesh is planned once per machine."""

import os
from contextlib import suppress
from pathlib import Path

import platformdirs
import pyfftw


def _file() -> Path:
    cache = os.environ.get("TRACTIVE_SAM_CACHE") or platformdirs.user_cache_dir("tractive_sam")
    return Path(cache) / f"fftw-{pyfftw.__version__}.wisdom"


def load() -> None:
    """Add the stored wisdom to FFTW's own; nothing happens where none can be read."""
    try:
        stored = _file().read_bytes()
    except OSError:
        return
    pyfftw.import_wisdom((stored, b"", b""))


def save() -> None:
    """Store FFTW's wisdom (double precision); a cache that cannot be written is done without."""
    file = _file()
    scratch = file.with_suffix(f".{os.getpid()}")
    with suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        scratch.write_bytes(pyfftw.export_wisdom()[0])
        # Renaming is atomic: processes that plan at the same time never see half a file.
        scratch.replace(file)
