"""Operators on the upper half of a symmetric mesh are those of the whole mesh, row by row."""

import numpy as np
import pytest

from tractive_sam.compute import Mirror
from tractive_sam.mechanics.elasticity import HalfSpaces, Material
from tractive_sam.operators import Lattice, Operators

NAMES = ("normal", "normal_inverse", "slip", "tangential", "tangential_inverse")


def unfold(half, mirror):
    """Return symmetric fields (1 or 2, n_x, n_y) from their upper half."""
    signs = np.array(
        [1.0 if k == mirror.even or len(half) == 1 else -1.0 for k in range(len(half))]
    )
    lower = half[..., ::-1] if mirror.between else half[..., :0:-1]
    return np.concatenate((signs[:, None, None] * lower, half), axis=-1)


def both(nx, ny, even, reach=1.0):
    """Return operators on the whole mesh and on its upper half, and a function for test fields."""
    mirror = Mirror(even, ny % 2 == 0)
    bodies = HalfSpaces(Material(80e3, 0.28), Material(80e3, 0.28))
    whole = Operators(Lattice((nx, ny), 0.02, 0.03, reach), bodies, 1e-6, 1e-5)

    def fields(count, kind=float):
        values = np.random.default_rng(7).normal(size=(count, nx, ny - ny // 2)).astype(kind)
        if count == 2 and not mirror.between:
            values[1 - even, :, 0] = 0.0
        return values

    return whole, whole.part((nx, ny - ny // 2), mirror), mirror, fields


@pytest.mark.parametrize("even", [0, 1])
@pytest.mark.parametrize("shape", [(12, 17), (13, 16)])
@pytest.mark.parametrize("name", NAMES)
def test_operators_on_half_of_a_mesh_are_those_of_the_whole(name, shape, even):
    whole, half, mirror, fields = both(*shape, even)
    values = fields(1 if name.startswith("normal") else 2)
    expected = getattr(whole, name)(unfold(values, mirror))
    result = unfold(getattr(half, name)(values), mirror)
    # Rounding of transforms of 40 x 40 numbers.
    assert np.allclose(result, expected, rtol=0.0, atol=1e-13 * np.abs(expected).max())


@pytest.mark.parametrize("even", [0, 1])
def test_operators_on_half_of_a_mesh_in_tiles_and_single_precision(even, monkeypatch):
    # Elements far from each other also act on their images here.
    whole, half, mirror, fields = both(60, 61, even, reach=0.4)
    values = fields(2, np.float32)
    expected = whole.slip(unfold(values, mirror).astype(float))
    end = half.lattice.padded[1] // 2 + 1
    monkeypatch.setattr("tractive_sam.compute.tiles.tile_edges", lambda *_: [0, 9, 20, end])
    result = unfold(half.slip(values), mirror)
    # Single precision, 6e-8, summed over about 4,000 elements.
    assert np.allclose(result, expected, rtol=0.0, atol=2e-6 * np.abs(expected).max())


def test_sums_on_half_of_a_mesh_count_the_axis_once():
    for ny in (6, 7):
        _, half, mirror, fields = both(5, ny, 0)
        (field,) = fields(1)
        whole, lattice = unfold(field[None], mirror)[0], half.lattice
        assert lattice.sum(field) == pytest.approx(0.5 * whole.sum(), rel=1e-14, abs=1e-14)
        assert lattice.dot(field, field) == pytest.approx(0.5 * (whole**2).sum(), rel=1e-14)
        coarse = lattice.coarsened()
        # Elements of twice the side have four times the area.
        total = 4.0 * coarse.sum(lattice.merge(field, "constant"))
        assert total == pytest.approx(lattice.sum(field), rel=1e-13, abs=1e-13)


@pytest.mark.parametrize("even", [0, 1])
@pytest.mark.parametrize("shape", [(5, 7), (6, 8), (9, 1)])
def test_a_symmetric_field_is_recognised_and_unfolded_from_its_half(shape, even):
    _, _, mirror, fields = both(*shape, even)
    values = fields(2)
    whole = unfold(values, mirror)
    assert np.array_equal(mirror.unfold(values), whole)
    assert np.array_equal(mirror.unfold(values[even]), whole[even])
    assert Mirror.of(whole) == mirror
    whole[even, 3, 0] += 1e-9
    assert Mirror.of(whole, rounding=1e-8) == mirror
    if shape[1] > 1:  # a single row is its own mirror image
        assert Mirror.of(whole) is None
    whole[even, 0, 0] = np.nan
    assert Mirror.of(whole, rounding=1e-8) is None
