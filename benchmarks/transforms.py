"""Measure transforms: FFTW against SciPy, and which lengths FFTW's estimated plans make fast.

`scipy` compares the time of a contact with transforms of FFTW and of SciPy, which replace FFTW if
needed. Both run alternately, each in a separate process without compilation. Times are CPU times of
the processes.

`lengths` measures transforms of real rows and of complex columns as in a small convolution, in
double and single precision, and prints the lengths for which no length up to a quarter longer costs
less, in the mean of both precisions. `tractive_sam.compute.fft.fast_length` lists those of most
runs.

    python benchmarks/transforms.py [scipy lengths]

Page: docs/citing.md
"""

import json
import statistics
import subprocess
import sys
from itertools import product
from time import process_time

import numpy as np
import pyfftw
from timing import show, write

PROGRAM = """
import json, sys, time
if {scipy}:
    sys.modules["pyfftw"] = None
import tractive_sam as ts
scene = ts.Scene.builtin("spheres").with_set(["grid.elements=[{n}, {n}]"])
contact = ts.solve(scene)
began = time.process_time()
for _ in range(3):
    ts.solve(scene)
print(json.dumps([(time.process_time() - began) / 3, contact.Qx]))
"""


def measure(n: int, scipy: bool) -> tuple[float, float]:
    """Return the seconds of a solution and its force."""
    program = PROGRAM.format(n=n, scipy=scipy)
    output = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)
    seconds, force = json.loads(output.stdout)
    return seconds, force


def compare_with_scipy() -> None:
    rows = []
    for n in (41, 91, 181, 361):
        pairs = [(measure(n, False), measure(n, True)) for _ in range(3)]
        ratio = statistics.median(scipy[0] / fftw[0] for fftw, scipy in pairs)
        (fftw, force), (scipy, scipy_force) = pairs[0]
        rows.append(
            {
                "elements": n,
                "fftw_seconds": round(fftw, 4),
                "scipy_seconds": round(scipy, 4),
                "ratio": round(ratio, 2),
                "difference_of_force": abs(scipy_force / force - 1.0),
            }
        )
    show("Solution of a contact of spheres, CPU time", rows)
    write("transforms", rows)


def nanoseconds(source: np.ndarray, target: np.ndarray) -> float:
    """Return the time per number of an estimated transform and its inverse along the last axis."""
    forward, backward = (
        pyfftw.FFTW(a, b, (2,), direction, flags=("FFTW_ESTIMATE", *keep))
        for a, b, direction, keep in (
            (source, target, "FFTW_FORWARD", ()),
            (target, source, "FFTW_BACKWARD", ("FFTW_DESTROY_INPUT",)),
        )
    )
    source[:] = 0.0
    target[:] = 0.0
    best = np.inf
    for _ in range(40):
        began = process_time()
        for _ in range(5):
            forward.execute()
            backward.execute()
        best = min(best, (process_time() - began) / 10)
    return 1e9 * best / source.size


def rows_and_columns(length: int, real: type, spectral: type) -> tuple[float, float]:
    """Return the times of real rows and of complex columns of a length, in a mesh half as wide."""
    half, stored = length // 2 + 1, (2, length // 2 + 1, length + 4)
    first, second = (pyfftw.zeros_aligned(stored, dtype=spectral)[..., :length] for _ in range(2))
    fields = pyfftw.zeros_aligned((2, half - 1, length), dtype=real)
    rows = nanoseconds(fields, first[..., : half - 1].swapaxes(1, 2))
    return rows, nanoseconds(first, second)


def find_lengths() -> None:
    """Measure lengths from 16 to 512, and print those that pay."""
    powers = product(range(2, 9), range(4), range(3), range(2))
    lengths = sorted({2**a * 3**b * 5**c * 7**d for a, b, c, d in powers})
    lengths = [n for n in lengths if 16 <= n <= 512]
    rows = []
    for n in lengths:
        double = rows_and_columns(n, np.float64, np.complex128)
        single = rows_and_columns(n, np.float32, np.complex64)
        row: dict[str, float] = {"length": n}
        for kind, *times in zip(("rows", "columns"), double, single, strict=True):
            row |= {f"{kind}_double": times[0], f"{kind}_single": times[1]}
        rows.append(row)
    write("transform_lengths", rows)
    # The other steps of a convolution take as long per number as these.
    for kind, others in (("rows", 1.0), ("columns", 0.4)):
        # Double precision takes 2.2 times as long.
        cost = {
            r["length"]: r["length"]
            * (0.5 * (r[f"{kind}_double"] / 2.2 + r[f"{kind}_single"]) + others)
            for r in rows
        }
        best = {
            min((m for m in lengths if n <= m <= 1.25 * n + 2), key=cost.__getitem__)
            for n in range(16, 401)
        }
        print(f"{kind}: {sorted(best)}")


if __name__ == "__main__":
    parts = {"scipy": compare_with_scipy, "lengths": find_lengths}
    for name in sys.argv[1:] or parts:
        parts[name]()
