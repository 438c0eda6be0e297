"""Generalised conjugate residuals against a direct solution."""

import numpy as np
import pytest

from tractive_sam.solvers.krylov import conjugate_residuals


class DenseSystem:
    """The system (1 + B) x = b with the response B x, without a preconditioner."""

    def __init__(self, size: int, strength: float, kind: type = np.float64) -> None:
        rng = np.random.default_rng(0)
        self.shape, self.kind = (1, size, 1), kind
        self.part = (strength * rng.normal(size=(size, size)) / np.sqrt(size)).astype(kind)
        self.right = rng.normal(size=size).astype(kind)

    def right_hand_side(self):
        return self.right.copy()

    def preconditioner(self, vector):
        return vector

    def response(self, vector):
        return (self.part @ vector).reshape(self.shape)

    def product(self, vector, response):
        return vector + response.ravel()


@pytest.mark.parametrize("strength", [0.1, 0.9])  # few vectors, and more than are stored at first
def test_returns_a_solution_and_its_response(strength):
    system = DenseSystem(60, strength)
    vector, response = conjugate_residuals(system, 1e-10, 60)
    exact = np.linalg.solve(np.eye(60) + system.part, system.right)
    # The condition number is below 100.
    np.testing.assert_allclose(vector, exact, atol=1e-7)
    np.testing.assert_allclose(response, system.response(vector), atol=1e-12)


def test_single_precision_stays_single():
    system = DenseSystem(60, 0.3, np.float32)
    vector, response = conjugate_residuals(system, 1e-4, 60)
    assert vector.dtype == response.dtype == np.float32
    missed = system.right - system.product(vector, response)
    assert np.linalg.norm(missed) <= 2e-4 * np.linalg.norm(system.right)  # and rounding


def test_a_right_hand_side_of_zero_has_no_step():
    system = DenseSystem(10, 0.3)
    system.right[:] = 0.0
    vector, response = conjugate_residuals(system, 1e-6, 10)
    assert vector.shape == (10,)
    assert response.shape == system.shape
    assert not vector.any()
    assert not response.any()
