"""The direct sum over patches, itself the measure of the operators."""

import numpy as np
import pytest

from tractive_sam.kernels.stress import stress_patch
from tractive_sam.kernels.stress_sum import cumulative_sums, stress_around, sum_patch_stress

POINTS = np.array([[0.3, -0.2, 0.4], [5.0, 1.0, 0.0], [0.0, 0.0, 2.0]])
CENTRES = np.array([[0.0, 0.0], [1.0, -0.6], [-2.0, 0.6]])


@pytest.mark.parametrize("loads", [(1, 1, 1), (0, 0, 1), (1, 0, 0), (0, 1, 0)])
def test_sums_the_patches(loads):
    tractions = np.random.default_rng(0).normal(size=(3, 3)) * loads
    out = np.empty((3, 6))
    sum_patch_stress(out, POINTS, CENTRES, tractions, 1.0, 0.6, 0.3)
    for point, stress in zip(POINTS, out, strict=True):
        parts = [
            traction @ np.array(stress_patch(*(point - [*centre, 0.0]), 1.0, 0.6, 0.3))
            for centre, traction in zip(CENTRES, tractions, strict=True)
        ]
        np.testing.assert_allclose(stress, sum(parts), rtol=1e-13, atol=1e-16)


def test_no_patches_no_stress():
    out = np.ones((3, 6))
    sum_patch_stress(out, POINTS, np.empty((0, 2)), np.empty((0, 3)), 1.0, 0.6, 0.3)
    assert not out.any()


SIDES = 1.0, 0.6
POISSON = 0.3
NX, NY = 16, 32
CORNER = (-8.0, -9.6)


def uneven_tractions():
    """Tractions that vary over a few patches, none in some corners."""
    x, y = np.meshgrid(np.linspace(-1, 1, NX), np.linspace(-1, 1, NY), indexing="ij")
    pressure = np.sqrt(np.maximum(0.0, 1.0 - x**2 - y**2))
    return np.stack((0.4 * pressure * (1 + x), 0.2 * pressure * y, pressure))


def both_sums(around, widest=0.3, blocks=(8, 16), tractions=None):
    """Stresses (7, 6) at points around one, taken together and exact."""
    tractions, sign = uneven_tractions() if tractions is None else tractions, -1.0
    i, j = np.mgrid[:NX, :NY]
    centres = np.stack((CORNER[0] + (i + 0.5) * SIDES[0], CORNER[1] + (j + 0.5) * SIDES[1]), axis=2)
    points = around + 0.1 * around[2] * np.concatenate(([np.zeros(3)], np.eye(3), -np.eye(3)))
    near, exact = np.zeros((1, 6, 7)), np.empty((7, 6))
    own = around[None], np.array([sign]), np.array([POISSON])
    stress_around(
        near, points[None], *own, CORNER, cumulative_sums(tractions), SIDES, blocks, widest
    )
    loads = np.ascontiguousarray(tractions.reshape(3, -1).T) * (sign, sign, 1.0)
    sum_patch_stress(exact, points, centres.reshape(-1, 2), loads, *SIDES, POISSON)
    return near[0].T, exact


@pytest.mark.parametrize("blocks", [(1, 1), (4, 2), (8, 16), (16, 32)])
@pytest.mark.parametrize(
    "around", [(0.3, -0.2, 1.0), (-5.2, 3.3, 1.5), (2.0, 0.0, 4.0), (0, 0, 30)]
)
def test_far_patches_taken_together(around, blocks):
    near, exact = both_sums(np.array(around, float), blocks=blocks)
    size = np.abs(exact).max()
    # 30 deep the mesh is one block or four: the error is the bend of the tractions in them.
    error = near - exact
    assert np.abs(error).max() < 3e-3 * size
    assert np.abs(error - error[0]).max() < 1e-3 * size


@pytest.mark.parametrize("patch", [(0, 0), (3, 5), (15, 31)])
def test_one_patch_acts_from_its_place_in_a_block(patch):
    tractions = np.zeros((3, NX, NY))
    tractions[:, *patch] = 0.3, -0.2, 1.0
    errors = []
    for depth in (60.0, 120.0):
        widest = 24.0 / depth  # one block of all patches
        near, exact = both_sums(np.array((0.0, 0.0, depth)), widest, (16, 32), tractions)
        errors.append(np.abs(near - exact).max() / np.abs(exact).max())
    # Load and moment are right, so the error is of second order.
    assert errors[1] < errors[0] / 3.5


def test_narrow_blocks_are_all_but_exact():
    errors = []
    for widest in (0.4, 0.2, 0.1):
        near, exact = both_sums(np.array((0.3, -0.2, 2.0)), widest)
        errors.append(np.abs(near - exact).max() / np.abs(exact).max())
    # Between the second order of blocks of many patches and the fourth one of the nodes of a patch.
    assert errors[1] < errors[0] / 4.0
    assert errors[2] < 2e-6


def test_unloaded_patches_cause_nothing():
    out = np.zeros((1, 6, 1))
    nothing = cumulative_sums(np.zeros((3, 8, 8)))
    at, one = np.array([[0.0, 0.0, 1.0]]), np.ones(1)
    stress_around(out, at[None], at, one, 0.3 * one, (0.0, 0.0), nothing, SIDES, (8, 8), 0.3)
    assert not out.any()


def test_sums_over_all_before():
    tractions = np.random.default_rng(0).normal(size=(3, 4, 5))
    i, j = np.mgrid[:4, :5]
    each = np.stack([tractions, i * tractions, j * tractions, i * j * tractions], axis=-1)
    truth = np.pad(each.cumsum(axis=1).cumsum(axis=2), ((0, 0), (1, 0), (1, 0), (0, 0)))
    # Another order of 20 terms up to 12.
    np.testing.assert_allclose(cumulative_sums(tractions), truth.transpose(1, 2, 0, 3), atol=1e-13)
