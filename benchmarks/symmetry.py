"""Would half of a symmetric domain pay? Transforms of the whole against those of a half.

Without spin, lateral creepage and turned friction, fields are even or odd in y, and a convolution
with them needs cosine or sine transforms over half the width instead of Fourier transforms over all
of it, padded. The forward half of an application, planned by FFTW_MEASURE, two fields, one thread.
"""

import numpy as np
import pyfftw
from timing import seconds, show, write

MESHES = (64, 128, 256, 512)
FLAGS = ("FFTW_MEASURE",)


def whole(n: int):
    """Rows of 2n real numbers, then 2n of their n + 1 columns; as `operators.fft` does it."""
    rows = pyfftw.zeros_aligned((2, n, 2 * n))
    half, full = (pyfftw.zeros_aligned((2, 2 * n, n + 1), dtype=complex) for _ in range(2))
    along_y = pyfftw.FFTW(rows, half[:, :n], axes=(2,), flags=FLAGS)
    along_x = pyfftw.FFTW(half, full, axes=(1,), flags=FLAGS)
    return lambda: (along_y.execute(), along_x.execute())


def half(n: int):
    """Cosine transforms of the n numbers of half a padded row, then 2n real numbers along x."""
    rows, columns = pyfftw.zeros_aligned((2, n, n)), pyfftw.zeros_aligned((2, 2 * n, n))
    spectrum = pyfftw.zeros_aligned((2, n + 1, n), dtype=complex)
    along_y = pyfftw.FFTW(rows, columns[:, :n], axes=(2,), direction="FFTW_REDFT10", flags=FLAGS)
    along_x = pyfftw.FFTW(columns, spectrum, axes=(1,), flags=FLAGS)
    return lambda: (along_y.execute(), along_x.execute())


def main() -> None:
    rows = []
    for n in MESHES:
        times = [seconds(make(n), budget=0.5) for make in (whole, half)]
        gain = float(np.divide(*times))
        rows.append({"elements": f"{n}²", "whole": times[0], "half": times[1], "gain": gain})
    show("Forward transforms, seconds", rows)
    print(f"written: {write('symmetry', rows)}")


if __name__ == "__main__":
    main()
