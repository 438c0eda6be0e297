"""Operators of line contact: strips infinitely long in y."""

from dataclasses import replace

import numpy as np
import pytest

from tractive_sam.kernels.half_space import integrate_logarithm, integrate_sign
from tractive_sam.kernels.stress import sum_strip_stress
from tractive_sam.mechanics.elasticity import Material, Strips
from tractive_sam.mechanics.frame import Frame
from tractive_sam.operators import Lattice, Operators, StripLayers

LENGTH = 1.7
N, DX, DATUM = 24, 0.1, 30.0
BODIES = Strips(Material(2.0, 0.1), Material(5.0, 0.4), DATUM)
PAIR = BODIES.material
ROUNDING = 1e-12


def of_strips(n=N, dx=DX, frame=None, datum=DATUM):
    gap, slip = LENGTH / PAIR.E_star, max((frame or Frame()).mu) ** 2 / PAIR.shear
    return Operators(Lattice((n, 1), dx, 1.0), replace(BODIES, datum=datum), gap, slip, frame)


def offsets(n=N, dx=DX):
    x = dx * np.arange(n)
    return x[:, None] - x[None, :]


def test_displacements_against_dense_matrices():
    c = 1 / (np.pi * PAIR.shear)
    log = c * integrate_logarithm(offsets(), DX, DATUM)
    stiff = PAIR.shear / DX
    zero = np.zeros((N, N))
    normal, tangential = of_strips().normal.as_matrix(), of_strips().tangential.as_matrix()
    in_plane = (1 - PAIR.poisson) * log
    truth = np.block([[in_plane, zero], [zero, log]]) * stiff
    np.testing.assert_allclose(normal, PAIR.E_star / LENGTH * in_plane, atol=ROUNDING)
    np.testing.assert_allclose(tangential, truth, atol=ROUNDING * truth.max())


def test_coupling_is_piecewise_linear_and_reciprocal():
    """u_z from p_x is +K/G times the step; p_y is not coupled."""
    matrix = of_strips().coupled.as_matrix()
    lift = PAIR.coupling / (np.pi * PAIR.shear) * integrate_sign(offsets(), DX)
    atol = ROUNDING * np.abs(matrix).max()
    np.testing.assert_allclose(matrix[:N, N : 2 * N], PAIR.E_star / LENGTH * lift, atol=atol)
    assert np.abs(matrix[:N, 2 * N :]).max() < atol
    assert np.abs(matrix[2 * N :, : 2 * N]).max() < atol


def test_slip_by_pressure_is_local():
    """-du_x/dx from p_n is 2 K p_n / G (Bentall & Johnson 1967), averaged over two elements.

    The sum of a column therefore equals its own element, far from the ends.
    """
    matrix = of_strips().coupled.as_matrix()
    sums = matrix[N : 2 * N, :N].sum(axis=0)
    np.testing.assert_allclose(sums[3:-3], 2 * PAIR.coupling, rtol=1e-10)


@pytest.mark.parametrize(("component", "compliance"), [(0, 1.0), (1, 1 / (1 - PAIR.poisson))])
def test_slip_of_an_elliptic_traction_is_linear(component, compliance):
    """-du/dx = 2 x / E* of p = sqrt(1 - x²); 1/(1 - nu) times that for the shear along y."""
    errors = []
    for n in (64, 128):
        dx = 2.0 / n
        x = dx * (np.arange(n) - 0.5 * (n - 1))
        traction = np.zeros((2, n, 1))
        traction[component, :, 0] = np.sqrt(1 - x**2)
        slip = of_strips(n, dx).slip(traction)[component, :, 0] / PAIR.shear
        inner = np.abs(x) < 0.8
        truth = 2 * compliance * x / PAIR.E_star
        errors.append(np.abs(slip - truth)[inner].max() / truth.max())
    assert errors[0] < 2 / 64  # the difference is taken half an element ahead
    assert errors[1] < 0.6 * errors[0]


def test_normal_operator_is_symmetric_positive_and_the_datum_adds_a_constant():
    near, far = (of_strips(datum=d).normal.as_matrix() for d in (DATUM, 10 * DATUM))
    np.testing.assert_allclose(near, near.T, atol=ROUNDING)
    assert np.linalg.eigvalsh(near).min() > 0
    constant = 2 * np.log(10) * DX * (1 - PAIR.poisson) / (np.pi * PAIR.shear)
    np.testing.assert_allclose(far - near, PAIR.E_star / LENGTH * constant, rtol=1e-10)


def test_slip_operator_dissipates():
    matrix = of_strips(frame=Frame((0.5, 0.2), 0.7)).slip.as_matrix()
    assert np.linalg.eigvalsh(matrix + matrix.T).min() > 0


@pytest.mark.parametrize("name", ["normal", "tangential"])
@pytest.mark.parametrize("n", [24, 101])
def test_circulant_inverses_precondition(name, n):
    half_space = of_strips(n)
    inverse = getattr(half_space, f"{name}_inverse").as_matrix()
    values = np.linalg.eigvals(inverse @ getattr(half_space, name).as_matrix()).real
    # As for rectangles: a few iterations on any mesh.
    assert values.max() / values.min() < 5.0


def test_slip_of_an_element_on_itself():
    half_space = of_strips(frame=Frame((0.5, 0.2), 0.7))
    matrix = half_space.slip.as_matrix().reshape(2, N, 2, N)
    d11, d12, d22 = half_space.self_influence
    np.testing.assert_allclose(matrix[:, 12, :, 12], [[d11, d12], [d12, d22]], rtol=1e-12)


def test_coarser_meshes_stay_rows():
    mesh = Lattice((25, 1), DX, 1.0).coarsened()
    assert mesh == Lattice((13, 1), 2 * DX, 1.0)


@pytest.mark.parametrize("n", [1, 2, 65])
@pytest.mark.parametrize("depth", [0.0, 0.03, 7.0])
def test_stress_of_layers_is_the_sum_over_strips(n, depth):
    tractions = np.random.default_rng(n).normal(size=(3, n, 1))
    poisson, signs, x = (0.3, 0.2), (1.0, -1.0), DX * np.arange(n)
    found = StripLayers(Lattice((n, 1), DX, 1.0), tractions, poisson, signs).at(depth)
    edges = DX * (np.arange(n + 1) - 0.5)
    points = np.stack(np.broadcast_arrays(x, depth), axis=-1)
    for stress, nu, sign in zip(found, poisson, signs, strict=True):
        acting = tractions[:, :, 0].T * (sign, sign, 1.0)
        jumps = np.diff(acting, axis=0, prepend=0.0, append=0.0)
        wanted = np.empty((n, 6))
        sum_strip_stress(wanted, points, edges, jumps, DX, nu)
        np.testing.assert_allclose(stress[:, :, 0].T, wanted, atol=ROUNDING)
