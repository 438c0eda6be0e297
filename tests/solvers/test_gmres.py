"""GMRES against a direct solution."""

import numpy as np
import pytest

from tractive_sam.solvers.krylov import gmres


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
