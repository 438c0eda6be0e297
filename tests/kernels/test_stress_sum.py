"""The direct sum over patches, itself the measure of the operators."""

import numpy as np
import pytest

from tractive_sam.kernels.stress import stress_patch
from tractive_sam.kernels.stress_sum import stress_at

POINTS = np.array([[0.3, -0.2, 0.4], [5.0, 1.0, 0.0], [0.0, 0.0, 2.0]])
CENTRES = np.array([[0.0, 0.0], [1.0, -0.6], [-2.0, 0.6]])


@pytest.mark.parametrize("loads", [(1, 1, 1), (0, 0, 1), (1, 0, 0), (0, 1, 0)])
def test_sums_the_patches(loads):
    tractions = np.random.default_rng(0).normal(size=(3, 3)) * loads
    out = np.empty((3, 6))
    stress_at(out, POINTS, CENTRES, tractions, 1.0, 0.6, 0.3)
    for point, stress in zip(POINTS, out, strict=True):
        parts = [
            traction @ np.array(stress_patch(*(point - [*centre, 0.0]), 1.0, 0.6, 0.3))
            for centre, traction in zip(CENTRES, tractions, strict=True)
        ]
        np.testing.assert_allclose(stress, sum(parts), rtol=1e-13, atol=1e-16)


def test_no_patches_no_stress():
    out = np.ones((3, 6))
    stress_at(out, POINTS, np.empty((0, 2)), np.empty((0, 3)), 1.0, 0.6, 0.3)
    assert not out.any()
