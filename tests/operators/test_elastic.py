"""Operators against dense matrices built element by element, and their laws."""

import numpy as np
import pytest

from tractive_sam.compute.fft import padded_length
from tractive_sam.kernels.half_space import integrals
from tractive_sam.mechanics.elasticity import HalfSpaces, Material
from tractive_sam.mechanics.frame import Frame
from tractive_sam.operators import Lattice, Operators

MESH = Lattice((7, 5), 0.3, 0.2)
BODIES = HalfSpaces(Material(2.0, 0.1), Material(5.0, 0.4))
PAIR = BODIES.material
FRAME = Frame((0.5, 0.2), 0.7)
LENGTH = 1.7
# A circular convolution of 200 numbers of order one, in doubles.
ROUNDING = 1e-12


def point_kernels(x, y, mesh, material):
    """The 3 x 3 displacement u_i from p_j of the offset (x, y); physics as tabulated for i, j."""
    r1, xx, yy, xy, x2, y2 = integrals(x, y, mesh.dx, mesh.dy)
    nu, K = material.poisson, material.coupling
    matrix = [
        [(1 - nu) * r1 + nu * xx, nu * xy, -K * x2],
        [nu * xy, (1 - nu) * r1 + nu * yy, -K * y2],
        [K * x2, K * y2, (1 - nu) * r1],
    ]
    return np.array(matrix) / (np.pi * material.shear)


def dense(mesh, material, ahead=0):
    """u at the elements `ahead` of each one from all tractions, shape (3, n, 3, n)."""
    nx, ny = mesh.shape
    by_offset = np.empty((2 * nx - 1, 2 * ny - 1, 3, 3))
    for i in range(2 * nx - 1):
        for j in range(2 * ny - 1):
            x, y = (i - nx + 1 + ahead) * mesh.dx, (j - ny + 1) * mesh.dy
            by_offset[i, j] = point_kernels(x, y, mesh, material)
    i, j = np.divmod(np.arange(nx * ny), ny)
    pairs = by_offset[i[:, None] - i + nx - 1, j[:, None] - j + ny - 1]
    return np.moveaxis(pairs, (2, 3), (0, 2))


@pytest.fixture(scope="module")
def half_space():
    return Operators(MESH, BODIES, LENGTH / PAIR.E_star, max(FRAME.mu) ** 2 / PAIR.shear, FRAME)


@pytest.fixture(scope="module")
def displacement():
    return dense(MESH, PAIR)


@pytest.fixture(scope="module")
def slip(displacement):
    return (displacement - dense(MESH, PAIR, ahead=1)) / MESH.dx


def close(operator, truth):
    size = truth.shape[0] * truth.shape[1]
    truth = truth.reshape(size, size)
    np.testing.assert_allclose(operator.as_matrix(), truth, atol=ROUNDING * np.abs(truth).max())


def test_normal_displacement(half_space, displacement):
    close(half_space.normal, displacement[2:, :, 2:] * PAIR.E_star / LENGTH)


def test_slip_in_the_scaled_frame(half_space, slip):
    F = FRAME.matrix
    scaled = np.einsum("ai,injm,bj->anbm", F, slip[:2, :, :2], F)
    close(half_space.slip, scaled * PAIR.shear / max(FRAME.mu) ** 2)


def test_tangential_displacement_in_the_scaled_frame(half_space, displacement):
    F = FRAME.matrix
    scaled = np.einsum("ai,injm,bj->anbm", F, displacement[:2, :, :2], F)
    close(half_space.tangential, scaled * PAIR.shear / max(FRAME.mu) ** 2 / MESH.dx)


def test_coupled_operator(half_space, displacement, slip):
    F = np.zeros((3, 3))
    F[0, 0], F[1:, 1:] = 1.0, FRAME.matrix
    order = [2, 0, 1]  # the solvers put the normal component first
    per_gap, per_slip = PAIR.E_star / LENGTH, PAIR.shear / max(FRAME.mu) ** 2
    rows = np.concatenate((per_gap * displacement[2:], per_slip * slip[:2]))
    truth = np.einsum("ai,injm,bj->anbm", F, rows[:, :, order], F)
    close(half_space.coupled, truth)


def test_slip_by_pressure_is_that_of_the_coupled_operator(half_space):
    fields = np.zeros((3, *MESH.shape))
    fields[0] = np.random.default_rng(1).uniform(size=MESH.shape)
    for coupled, by_pressure in (
        (half_space.coupled, half_space.slip_by_pressure),
        (half_space.coupled_displacement, half_space.displacement_by_pressure),
    ):
        np.testing.assert_allclose(by_pressure(fields[0]), coupled(fields)[1:], atol=ROUNDING)


def test_reciprocity(displacement):
    """u_x from p_z of one element is minus u_z from p_x of the other: A_xz = -A_zx."""
    np.testing.assert_allclose(displacement[0, :, 2], -displacement[2, :, 0], rtol=1e-14)
    swapped = displacement.transpose(2, 3, 0, 1)  # observer and source exchanged
    np.testing.assert_allclose(displacement, swapped, rtol=1e-12, atol=1e-15)


def test_slip_of_an_element_on_itself(half_space):
    matrix = half_space.slip.as_matrix().reshape(2, 35, 2, 35)
    d11, d12, d22 = half_space.self_influence
    np.testing.assert_allclose(matrix[:, 17, :, 17], [[d11, d12], [d12, d22]], rtol=1e-12)


def test_equal_materials_do_not_couple():
    same = Operators(MESH, HalfSpaces(Material(2.0, 0.3), Material(2.0, 0.3)), 1.0, 1.0)
    matrix = same.coupled.as_matrix()
    assert np.abs(matrix[:35, 35:]).max() < ROUNDING
    assert np.abs(matrix[35:, :35]).max() < ROUNDING


def test_normal_operator_is_symmetric_positive(half_space):
    matrix = half_space.normal.as_matrix()
    np.testing.assert_allclose(matrix, matrix.T, atol=ROUNDING)
    assert np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min() > 0


def test_slip_operator_dissipates(half_space):
    """Upwind differences damp: the symmetric part of D is positive."""
    matrix = half_space.slip.as_matrix()
    assert np.linalg.eigvalsh(matrix + matrix.T).min() > 0


@pytest.mark.slow
@pytest.mark.parametrize("shape", [(24, 24), (9, 40)])
@pytest.mark.parametrize("name", ["normal", "tangential"])
def test_circulant_inverses_precondition(shape, name):
    """The eigenvalues of inverse times operator cluster: a few iterations on any mesh."""
    half_space = Operators(Lattice(shape, 0.1, 0.1), BODIES, 1.0, 1.0)
    inverse = getattr(half_space, f"{name}_inverse").as_matrix()
    product = inverse @ getattr(half_space, name).as_matrix()
    values = np.linalg.eigvals(product).real
    # 5.7 and 3.8 here, from a few at the ends; without, 40 and growing with the mesh.
    assert values.max() / values.min() < 6.0


@pytest.mark.parametrize("name", ["normal", "normal_inverse", "slip", "tangential_inverse"])
def test_single_precision(half_space, name):
    """One operator; errors of the order of 1e-7 times the few operations of a transform."""
    operator = getattr(half_space, name)
    fields = np.random.default_rng(0).normal(size=operator.shape)
    wanted, found = operator(fields), operator(fields.astype(np.float32))
    assert found.dtype == np.float32
    np.testing.assert_allclose(found, wanted, atol=1e-6 * np.abs(wanted).max())


def test_applications_are_counted(half_space):
    before = half_space.normal.applications
    half_space.normal(np.zeros((1, *MESH.shape)))
    assert half_space.normal.applications == before + 1


def test_results_are_not_overwritten(half_space):
    rng = np.random.default_rng(0)
    first = half_space.slip(rng.normal(size=(2, *MESH.shape)))
    kept = first.copy()
    half_space.slip(rng.normal(size=(2, *MESH.shape)))
    np.testing.assert_array_equal(first, kept)


@pytest.mark.parametrize("n", [1, 2, 7, 61, 91, 128, 361])
def test_padded_lengths_hold_a_linear_convolution(n):
    assert 2 * n - 1 <= padded_length(n) <= 1.2 * 2 * n
    assert padded_length(n) % 2 == 0


def test_frame_turns_work_into_work():
    """p . s = p~ . s~ (virtual power), and there and back again."""
    rng = np.random.default_rng(0)
    p, s = rng.normal(size=(2, 2, 6))
    scaled_p, scaled_s = FRAME.to_scaled(p), FRAME.slip_to_scaled(s)
    np.testing.assert_allclose((p * s).sum(axis=0), (scaled_p * scaled_s).sum(axis=0))
    np.testing.assert_allclose(FRAME.to_physical(scaled_p), p)
    np.testing.assert_allclose(FRAME.slip_to_physical(scaled_s), s)


def test_frame_scales_the_friction_ellipse_to_a_disc():
    for theta in np.linspace(0, 6, 7):
        on_axes = np.array([0.5 * np.cos(theta), 0.2 * np.sin(theta)])
        c, s = np.cos(0.7), np.sin(0.7)
        traction = np.array([[c, -s], [s, c]]) @ on_axes
        assert np.linalg.norm(FRAME.to_scaled(traction[:, None])) == pytest.approx(1.0)
