"""Simplified theory and full slip with spin: limits, balances, and brute force."""

import math

import numpy as np
import pytest

from tractive_sam.reference import (
    fastsim,
    full_slip_with_spin,
    linear_creep_forces,
)

STEEL = {"a": 2.0, "b": 1.0, "shear": 8e4, "poisson": 0.3}


@pytest.mark.parametrize("creepage", ["xi_x", "xi_y", "spin"])
def test_fastsim_without_slip_is_linear_theory(creepage):
    given = {creepage: 1e-9}
    found = fastsim(**STEEL, load=1e3, mu=0.3, **given, elements=(200, 200))
    expected = linear_creep_forces(2.0, 1.0, 8e4, 0.3, **given)
    size = max(map(abs, expected[:2]))
    # Of second order in 1/200, except at the edge, which always slips.
    assert found.Fx == pytest.approx(expected.Fx, abs=2e-3 * size)
    assert found.Fy == pytest.approx(expected.Fy, abs=2e-3 * size)


def test_fastsim_approaches_full_slip():
    # The pressures of the elements carry the load whatever the mesh.
    found = fastsim(**STEEL, load=1e3, mu=0.3, xi_x=3.0)
    assert found.Fx == pytest.approx(-300.0, rel=1e-9)
    found = fastsim(**STEEL, load=1e3, mu=0.3, xi_x=3.0, xi_y=-4.0)
    assert math.hypot(found.Fx, found.Fy) == pytest.approx(300.0, rel=1e-9)


def test_fastsim_converges():
    given = STEEL | {"load": 1e3, "mu": 0.3, "xi_x": 1e-3, "xi_y": 4e-4, "spin": 8e-4}
    found = [np.array(fastsim(**given, elements=(n, n))) for n in (20, 40, 80, 320)]
    errors = [np.abs(one - found[-1]).max() for one in found[:-1]]
    assert errors[2] < 0.5 * errors[0]


def integrated(e, slip, spin, n=1500):
    """By sums over the ellipse, which know of no pole."""
    nodes, weights = np.polynomial.legendre.leggauss(n // 5)
    angle = 0.25 * math.pi * (nodes + 1.0)
    r, dr = np.sin(angle), 0.25 * math.pi * weights * np.cos(angle)
    turn = (np.arange(n) + 0.3) * 2.0 * math.pi / n
    x = np.outer(r, np.cos(turn)) * math.sqrt(e)
    y = np.outer(r, np.sin(turn)) / math.sqrt(e)
    share = (1.5 / math.pi * dr * r * np.cos(angle))[:, None] * 2.0 * math.pi / n
    s = np.stack([slip[0] - spin * y, slip[1] + spin * x])
    q = -share * s / np.hypot(*s)
    return q[0].sum(), q[1].sum(), (x * q[1] - y * q[0]).sum()


@pytest.mark.parametrize(
    ("e", "slip", "spin"),
    [
        (1.0, (0.0, 0.0), 1.0),
        (2.0, (0.3, 0.2), 0.7),
        (0.5, (1.0, -0.5), 0.4),
        (5.0, (0.1, 0.9), -2.0),
        (1.0, (0.99, 0.0), 1.0),
        (2.0, (1.0, 1.0), 1e-4),
        (3.0, (-1.0, 1.0), 0.0),
    ],
)
def test_full_slip_is_the_integral(e, slip, spin):
    # With the pole inside, the sums cross a jump of the direction.
    expected = integrated(e, slip, spin)
    np.testing.assert_allclose(full_slip_with_spin(e, slip, spin), expected, atol=1e-5)
