"""Tables of the patch integrals against the integrals themselves."""

import numpy as np
import pytest

from tractive_sam.kernels.stress import patch_integrals
from tractive_sam.kernels.stress_sum import PACKS, edge_table, layer_table

# Errors are absolute: a few roundings of logarithms and arctangents of order one.
ROUNDING = 1e-14


def packed(i, j, z, dx, dy):
    """The sums of PACKS at the offset (i, j)."""
    integrals = (*patch_integrals(float(i * dx), float(j * dy), z, dx, dy), 0.0)
    return [sum(integrals[c] for c in pack) for pack in PACKS]


@pytest.mark.parametrize("z", [0.0, 1e-9, 0.3, 5.0, 50.0])
@pytest.mark.parametrize(("dx", "dy"), [(1.0, 0.7), (0.1, 1.0)])
def test_layer_holds_the_integrals_at_all_offsets(z, dx, dy):
    px, py = 44, 20  # three blocks of rows
    table = np.empty((4, px, py))
    for first, last in ((0, 9), (9, px // 2 + 1)):  # as two threads share them
        layer_table(table, z, dx, dy, first, last)
    for i in (0, 1, 7, -8, 21, -21):
        for j in (0, 1, -2, 9, -9):
            np.testing.assert_allclose(table[:, i, j], packed(i, j, z, dx, dy), atol=ROUNDING)


@pytest.mark.parametrize("z", [0.0, 1e-9, 0.3, 5.0])
@pytest.mark.parametrize("x", [0.5, 1.7, 20.0])
def test_edges_differ_by_the_integrals(z, x):
    dx, dy, py = 0.4, 0.7, 12
    table = np.empty((8, 2, py))
    edge_table(table, np.array([x - 0.5 * dx, x + 0.5 * dx]), z, dy)
    patch = table[0::2, 1] - table[0::2, 0] + table[1::2, 1] - table[1::2, 0]
    for j in (0, 1, -1, 5, -5):
        np.testing.assert_allclose(patch[:, j], packed(x / dx, j, z, dx, dy), atol=ROUNDING)


def test_on_the_line_of_an_edge_at_the_surface():
    """Infinite there are logarithms; they lose their infinite part, as in the integrals."""
    table = np.empty((8, 2, 6))
    edge_table(table, np.array([0.0, 0.4]), 0.0, 0.7)
    patch = table[0::2, 1] - table[0::2, 0] + table[1::2, 1] - table[1::2, 0]
    for j in (0, 1, -2):
        np.testing.assert_allclose(patch[:, j], packed(0.5, j, 0.0, 0.4, 0.7), atol=ROUNDING)
