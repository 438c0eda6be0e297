"""FFTW's wisdom, stored between processes so that a mesh is planned once per machine."""

import os
from contextlib import suppress
from pathlib import Path

import platformdirs

from tractive_sam.compute.fftw import pyfftw
from tractive_sam.output_file import make_folder, write_file

PRECISIONS = ("double", "single")
"""Precisions in use, in FFTW's order."""


def _file(precision: str) -> Path:
    """Return the path of the file of stored FFTW plans (wisdom) for a precision."""
    cache = os.environ.get("TRACTIVE_SAM_CACHE") or platformdirs.user_cache_dir("tractive_sam")
    return Path(cache) / f"fftw-{pyfftw.__version__}-{precision}.wisdom"


def load() -> None:
    """Add stored plans (wisdom) to FFTW's; ignore files that cannot be read."""
    stored = [b"", b"", b""]
    for i, precision in enumerate(PRECISIONS):
        with suppress(OSError):
            stored[i] = _file(precision).read_bytes()
    pyfftw.import_wisdom(stored)


def save() -> None:
    """Store FFTW's plans (wisdom) for later processes; ignore a cache that cannot be written."""
    for precision, wisdom in zip(PRECISIONS, pyfftw.export_wisdom(), strict=False):
        file = _file(precision)
        with suppress(OSError):
            make_folder(file.parent)
            write_file(file, wisdom)  # a process that plans meanwhile never reads half a file
