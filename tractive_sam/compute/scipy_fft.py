"""Transforms of SciPy behind the names of pyfftw that this package uses.

They replace FFTW if pyfftw cannot be imported, for example because a machine has no build of it.
Results agree to rounding; see benchmarks/transforms.py for the time.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import scipy  # its parts are loaded when first used

__version__ = f"scipy-{scipy.__version__}"


def zeros_aligned(shape: Sequence[int], dtype: Any = np.float64) -> np.ndarray:
    """Return an array of zeros, in place of pyfftw's function of this name."""
    return np.zeros(shape, dtype)


def next_fast_len(n: int) -> int:
    """Return the smallest length of at least n that SciPy transforms fast."""
    return int(scipy.fft.next_fast_len(n))


class FFTW:
    """SciPy's FFT along one axis with the interface of `pyfftw.FFTW`, without normalisation.

    Parameters
    ----------
    source, target : ndarray
        Arrays; the transform is of real numbers if one of them is.
    axes : tuple of int
        The axis.
    direction : str
        "FFTW_FORWARD" or "FFTW_BACKWARD".
    flags : sequence of str
        Not used.
    threads : int
        Number of threads.
    """

    def __init__(
        self,
        source: np.ndarray,
        target: np.ndarray,
        axes: tuple[int],
        direction: str,
        flags: Sequence[str],
        threads: int,
    ) -> None:
        self._source, self._target = source, target
        (axis,) = axes
        forward = direction == "FFTW_FORWARD"
        self._options: dict[str, Any] = {"axis": axis, "workers": threads}
        if not forward:
            self._options["norm"] = "forward"
        if np.iscomplexobj(source) and np.iscomplexobj(target):
            self._transform = scipy.fft.fft if forward else scipy.fft.ifft
        else:
            self._transform = scipy.fft.rfft if forward else scipy.fft.irfft
            if not forward:
                self._options["n"] = target.shape[axis]

    def execute(self) -> None:
        """Transform the source array into the target array."""
        self._target[...] = self._transform(self._source, **self._options)


def import_wisdom(wisdom: Sequence[bytes]) -> None:
    """Do nothing, in place of pyfftw's function: SciPy has no wisdom."""


def export_wisdom() -> tuple[bytes, ...]:
    """Return an empty tuple, in place of pyfftw's function: SciPy has no wisdom."""
    return ()
