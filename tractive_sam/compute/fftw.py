"""pyfftw without its interfaces to other packages.

pyfftw imports interfaces to dask and scipy, and with them dask, xarray and pandas if they are
installed, which takes three times as long as FFTW itself. Here they are loaded when first used.
Without pyfftw SciPy computes the transforms.
"""

import sys
from importlib import import_module
from types import ModuleType
from typing import Any

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

__all__ = ["pyfftw"]
