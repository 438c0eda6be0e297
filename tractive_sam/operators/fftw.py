"""pyfftw, without all that it loads for others.

It imports its interfaces for dask and scipy, and with them, where they are installed, dask, xarray
and pandas: that takes three times as long as FFTW itself. Here they are loaded when first used.
"""

import sys
from importlib import import_module
from types import ModuleType
from typing import Any

_INTERFACES = "pyfftw.interfaces"


def _interfaces_when_used() -> ModuleType:
    """Stands for the module until something is asked of it."""
    stand_in = ModuleType(_INTERFACES)

    def first_asked(name: str) -> Any:
        if sys.modules.get(_INTERFACES) is stand_in:
            del sys.modules[_INTERFACES]
        return getattr(import_module(_INTERFACES), name)

    stand_in.__getattr__ = first_asked
    return stand_in


if "pyfftw" not in sys.modules:
    sys.modules[_INTERFACES] = _interfaces_when_used()

import pyfftw  # noqa: E402

__all__ = ["pyfftw"]
