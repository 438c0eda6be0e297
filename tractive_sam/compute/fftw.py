"""pyfftw without its interfaces to other packages, and its plans, stored between processes.

pyfftw imports interfaces to dask and scipy, and with them dask, xarray and pandas if they are
installed, which takes three times as long as FFTW itself: 0.42 of the 2.05 CPU s of a warm
`tractive-sam run spheres`. There is no option, so a stand-in loads them when they are first used.
Without pyfftw SciPy computes the transforms.
"""

import os
import sys
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import platformdirs

from tractive_sam.output_file import make_folder, write_file

_INTERFACES = "pyfftw.interfaces"


def _interfaces_when_used() -> ModuleType:
    """Return a stand-in module that imports `pyfftw.interfaces` at the first use of a name."""
    stand_in = ModuleType(_INTERFACES)

    def load(name: str) -> Any:
        if sys.modules.get(_INTERFACES) is stand_in:
            del sys.modules[_INTERFACES]
        return getattr(import_module(_INTERFACES), name)

    vars(stand_in)["__getattr__"] = load
    return stand_in


if "pyfftw" not in sys.modules:
    sys.modules[_INTERFACES] = _interfaces_when_used()

try:
    import pyfftw
except ImportError:  # there is no build of it for every machine
    from tractive_sam.compute import scipy_fft as pyfftw

__all__ = ["load_wisdom", "pyfftw", "save_wisdom"]


PRECISIONS = ("double", "single")
"""Precisions in use, in FFTW's order."""


def _wisdom_file(precision: str) -> Path:
    """Return the path of the file of stored FFTW plans (wisdom) for a precision."""
    cache = os.environ.get("TRACTIVE_SAM_CACHE") or platformdirs.user_cache_dir("tractive_sam")
    return Path(cache) / f"fftw-{pyfftw.__version__}-{precision}.wisdom"


def load_wisdom() -> None:
    """Add stored plans (wisdom) to FFTW's; ignore files that cannot be read."""
    stored = [b"", b"", b""]
    for i, precision in enumerate(PRECISIONS):
        with suppress(OSError):
            stored[i] = _wisdom_file(precision).read_bytes()
    pyfftw.import_wisdom(stored)


def save_wisdom() -> None:
    """Store FFTW's plans (wisdom) for later processes; ignore a cache that cannot be written."""
    for precision, wisdom in zip(PRECISIONS, pyfftw.export_wisdom(), strict=False):
        file = _wisdom_file(precision)
        with suppress(OSError):
            make_folder(file.parent)
            write_file(file, wisdom)  # a process that plans meanwhile never reads half a file
