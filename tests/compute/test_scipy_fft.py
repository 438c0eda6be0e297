"""Transforms of SciPy in place of FFTW: equal arrays, and an equal contact."""

import json
import subprocess
import sys

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.compute import scipy_fft

pyfftw = pytest.importorskip("pyfftw")

KINDS = [(float, complex, "FFTW_FORWARD"), (complex, complex, "FFTW_FORWARD"),
         (complex, complex, "FFTW_BACKWARD"), (complex, float, "FFTW_BACKWARD")]  # fmt: skip

PROGRAM = """
import json, sys
sys.modules["pyfftw"] = None
import tractive_sam as ts
history = ts.roll(ts.Scene.builtin("twin-discs").with_set(sys.argv[1:]))
print(json.dumps([history[k][-1].tolist() for k in ("Qx", "wear_max", "von_mises_max")]))
"""


@pytest.mark.parametrize(("source_kind", "target_kind", "direction"), KINDS)
@pytest.mark.parametrize("axis", [1, 2])
@pytest.mark.parametrize("precision", [1, 2])
def test_transforms_agree(source_kind, target_kind, direction, axis, precision):
    kinds = [np.dtype(one).char for one in (source_kind, target_kind)]
    if precision == 1:
        kinds = [{"d": "f", "D": "F"}[one] for one in kinds]
    shape = [3, 10, 12]
    half = shape.copy()
    half[axis] = half[axis] // 2 + 1
    shapes = [shape if kind in "df" or source_kind is target_kind else half for kind in kinds]
    found = []
    for library in (pyfftw, scipy_fft):
        source, target = (
            library.zeros_aligned(one, dtype=kind) for one, kind in zip(shapes, kinds, strict=True)
        )
        transform = library.FFTW(
            source, target, axes=(axis,), direction=direction, flags=("FFTW_ESTIMATE",), threads=1
        )
        values = np.random.default_rng(2).normal(size=shapes[0])
        source[...] = values
        if source_kind is complex:
            source[...] = values * (1.0 + 0.5j)
            if target_kind is float:  # of real numbers: the mean and the last entry are real
                ends = [slice(None)] * 3
                ends[axis] = [0, -1]
                source[tuple(ends)] = source[tuple(ends)].real
        transform.execute()
        found.append(target.copy())
    # Rounding in single and in double precision.
    atol = (1e-5 if precision == 1 else 1e-13) * np.abs(found[0]).max()
    np.testing.assert_allclose(found[1], found[0], atol=atol)


def test_fast_lengths_hold_the_given_number():
    assert all(n <= scipy_fft.next_fast_len(n) <= 1.2 * n + 2 for n in range(1, 300))


@pytest.mark.slow
def test_a_run_without_pyfftw_is_that_with_it():
    settings = "grid.elements=[15, 27]", "wear.revolutions=20"
    history = ts.roll(ts.Scene.builtin("twin-discs").with_set(settings))
    command = [sys.executable, "-c", PROGRAM, *settings]
    without = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)
    for name, value in zip(("Qx", "wear_max", "von_mises_max"), without, strict=True):
        # Jumps of wear.tolerance.
        np.testing.assert_allclose(history[name][-1], value, rtol=1e-5, err_msg=name)
