"""GMRES against a direct solution."""

import numpy as np
import pytest

from tractive_sam.solvers.krylov import Basis, gmres


@pytest.fixture
def system():
    rng = np.random.default_rng(0)
    return np.eye(30) + 0.3 * rng.normal(size=(30, 30)) / np.sqrt(30), rng.normal(size=30)


def identity(v):
    return v


def test_solves_to_the_tolerance(system):
    A, b = system
    x, iterations = gmres(A.__matmul__, identity, b, 1e-12, 30)
    np.testing.assert_allclose(x, np.linalg.solve(A, b), atol=1e-10)
    assert iterations < 30


def test_residual_meets_the_tolerance_requested(system):
    A, b = system
    for tolerance in (1e-1, 1e-3, 1e-6):
        x, _ = gmres(A.__matmul__, identity, b, tolerance, 30)
        assert np.linalg.norm(b - A @ x) <= tolerance * np.linalg.norm(b) * (1 + 1e-9)


def test_an_exact_preconditioner_needs_one_iteration(system):
    A, b = system
    x, iterations = gmres(A.__matmul__, np.linalg.inv(A).__matmul__, b, 1e-12, 30)
    assert iterations == 1
    np.testing.assert_allclose(A @ x, b, atol=1e-12)


def test_nothing_to_solve(system):
    x, iterations = gmres(system[0].__matmul__, identity, np.zeros(30), 1e-12, 30)
    assert iterations == 0
    assert not x.any()


def test_the_memory_of_a_basis_does_not_change_the_solution(system):
    A, b = system
    basis = Basis()
    for number in (np.float64, np.float32, np.float64):
        matrix, right = A.astype(number), b.astype(number)
        fresh, iterations = gmres(matrix.__matmul__, identity, right, 1e-4, 30)
        again, repeated = gmres(matrix.__matmul__, identity, right, 1e-4, 30, basis)
        np.testing.assert_array_equal(again, fresh)
        assert again.dtype == number
        assert repeated == iterations
