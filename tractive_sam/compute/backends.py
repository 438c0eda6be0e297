"""Choice of the backend for an array; transforms and kernels are loaded when first used."""

from functools import cache
from typing import Any

import numpy as np

from tractive_sam.compute.backend import Array, Backend


def backend_of(array: Array) -> Backend:
    """Return the backend of an array: of NumPy, or of its library by the array API standard."""
    return _host() if isinstance(array, np.ndarray) else _array_api(array.__array_namespace__())


@cache
def _host() -> Backend:
    """Return the backend of NumPy."""
    from tractive_sam.compute.host import Host  # noqa: PLC0415

    return Host()


@cache
def _array_api(xp: Any) -> Backend:
    """Return the backend of another library by its namespace."""
    from tractive_sam.compute.array_api import ArrayApi  # noqa: PLC0415

    return ArrayApi(xp)
