"""Stress below strips against line loads, long rectangles and the equations of equilibrium."""

import math

import numpy as np
import pytest
from scipy.integrate import quad_vec

from tractive_sam.kernels import stress
from tractive_sam.kernels.stress import stress_patch

WIDTH, NU = 0.8, 0.3
EDGES = np.array([-WIDTH / 2, WIDTH / 2])
POINTS = np.array([[0.0, 0.05], [0.1, 0.3], [0.4, 0.2], [-0.9, 0.01], [2.0, 1.5], [-7.0, 3.0]])
LOADS = np.eye(3)


def strip(points, load, nu=NU):
    """Stresses (n, 6) below one strip under the tractions (p_x, p_y, p_n)."""
    points, out = np.atleast_2d(np.asarray(points, float)), np.empty((np.size(points) // 2, 6))
    jumps = np.stack((load, -np.asarray(load)))
    stress.sum_strip_stress(out, points, EDGES, jumps, WIDTH, nu)
    return out


def line_load(x, z, load):
    """Flamant's stresses of forces per length, and the antiplane ones."""
    px, py, pn = load
    r2 = x * x + z * z
    radial = -2 / math.pi * (px * x + pn * z) / r2**2
    xx, zz, xz = radial * x * x, radial * z * z, radial * x * z
    xy, yz = -py / math.pi * x / r2, -py / math.pi * z / r2
    return np.array([xx, NU * (xx + zz), zz, xy, xz, yz])


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize(("x", "z"), POINTS)
def test_sum_of_line_loads(load, x, z):
    truth, _ = quad_vec(lambda s: line_load(x - s, z, load), *EDGES, epsabs=1e-12, points=[x])
    np.testing.assert_allclose(strip((x, z), load)[0], truth, atol=1e-11)


@pytest.mark.parametrize("load", range(3))
def test_long_patches_tend_to_strips(load):
    """What the ends do falls with the length: at least as width over half of it."""
    for length in (1e3, 1e4):
        patches = [stress_patch(x, 0.0, z, WIDTH, length, NU)[load] for x, z in POINTS]
        assert np.abs(strip(POINTS, LOADS[load]) - patches).max() < 0.5 * WIDTH / length


@pytest.mark.parametrize("load", LOADS)
def test_equilibrium_and_plane_strain(load):
    """d sigma_ix/dx + d sigma_iz/dz = 0, by central differences: their error is h²."""
    h = 1e-4
    for x, z in POINTS[:3]:
        in_x = (strip((x + h, z), load) - strip((x - h, z), load))[0] / (2 * h)
        in_z = (strip((x, z + h), load) - strip((x, z - h), load))[0] / (2 * h)
        balance = in_x[[0, 3, 4]] + in_z[[4, 5, 2]]
        assert np.abs(balance).max() < 1e-4 * max(np.abs(in_x).max(), np.abs(in_z).max())
    xx, yy, zz, *_ = strip(POINTS, load).T
    np.testing.assert_allclose(yy, NU * (xx + zz), atol=1e-15)


def test_tractions_at_the_surface():
    """sigma_xz = -p_x, sigma_yz = -p_y, sigma_zz = -p_n below the strip, zero beside it."""
    load = (0.3, -0.2, 1.5)
    below, beside, edge = strip([(0.1, 0.0), (0.9, 0.0), (WIDTH / 2, 0.0)], load)[:, [4, 5, 2]]
    np.testing.assert_allclose(below, -np.array(load), rtol=1e-14)
    np.testing.assert_allclose(beside, 0.0, atol=1e-15)
    np.testing.assert_allclose(edge, -0.5 * np.array(load), rtol=1e-14)


def test_incompressible_bodies_feel_pressure_below_it():
    """nu = 1/2: sigma_xx = sigma_yy = sigma_zz = -p_n at the middle of the surface."""
    np.testing.assert_allclose(strip((0.0, 0.0), (0, 0, 1.0), 0.5)[0, :3], -1.0, rtol=1e-14)


def test_neighbours_add_up():
    """Three strips by four edges, one of them without a jump."""
    tractions = np.array([[0.2, 0.1, 1.0], [0.2, 0.1, 1.0], [-0.4, 0.0, 0.7]])
    edges = WIDTH * np.arange(4)
    jumps = np.diff(tractions, axis=0, prepend=0.0, append=0.0)
    out = np.empty((len(POINTS), 6))
    stress.sum_strip_stress(out, POINTS, edges, jumps, WIDTH, NU)
    shifted = [POINTS - [WIDTH * (k + 0.5), 0.0] for k in range(3)]
    apart = sum(strip(p, t) for p, t in zip(shifted, tractions, strict=True))
    np.testing.assert_allclose(out, apart, atol=1e-13)
