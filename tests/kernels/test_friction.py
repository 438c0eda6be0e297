"""Pointwise kernels: the projection, its derivative, and the sweep."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from tractive_sam.kernels import friction, wear

# Tractions are dimensionless, of order one: numbers whose square underflows are not met.
sizes = st.just(0.0) | st.floats(1e-100, 10)
fields = arrays(float, (2, 3, 2), elements=sizes | sizes.map(lambda x: -x))
bounds = arrays(float, (3, 2), elements=sizes)


def projected(traction, bound):
    out = np.empty_like(traction)
    friction.project(traction, bound, out)
    return out


@settings(max_examples=50, deadline=None)
@given(fields, bounds)
def test_projection_is_admissible_and_idempotent(traction, bound):
    once = projected(traction, bound)
    assert (np.hypot(*once) <= bound * (1 + 1e-15)).all()
    np.testing.assert_allclose(projected(once, bound), once, rtol=1e-15)
    inside = np.hypot(*traction) <= bound
    np.testing.assert_array_equal(once[:, inside & (bound > 0)], traction[:, inside & (bound > 0)])


@settings(max_examples=50, deadline=None)
@given(fields, fields, bounds)
def test_projection_shortens_distances(a, b, bound):
    apart = np.hypot(*(a - b))
    assert (np.hypot(*(projected(a, bound) - projected(b, bound))) <= apart + 1e-12).all()


def linearised(traction, slip, bound):
    shape = bound.shape
    state, direction = np.empty(shape, np.int8), np.empty((2, *shape))
    kappa, defect = np.empty(shape), np.empty((2, *shape))
    squares = friction.linearise(traction, slip, bound, state, direction, kappa, defect)
    return state, direction, kappa, defect, squares


def test_linearisation_is_the_derivative_of_the_projection():
    rng = np.random.default_rng(0)
    traction, slip = rng.normal(size=(2, 2, 5, 4))
    bound = rng.uniform(0.1, 1.5, (5, 4))
    state, direction, kappa, defect, squares = linearised(traction, slip, bound)
    np.testing.assert_allclose(defect, projected(traction - slip, bound) - traction, atol=1e-15)
    assert squares == pytest.approx((defect**2).sum())
    assert set(np.unique(state)) == {friction.STICK, friction.SLIP}
    change, h = rng.normal(size=(2, 5, 4)), 1e-6
    ahead = projected(traction - slip + h * change, bound)
    behind = projected(traction - slip - h * change, bound)
    along = (change * direction).sum(axis=0) * direction
    derivative = np.where(state == friction.SLIP, kappa * (change - along), change)
    # Central difference: error h² times the third derivative, which 1/bound keeps below 1e3.
    np.testing.assert_allclose((ahead - behind) / (2 * h), derivative, atol=1e-8)


def test_open_elements_carry_nothing():
    bound = np.zeros((2, 2))
    state, *_, defect, _ = linearised(np.ones((2, 2, 2)), np.ones((2, 2, 2)), bound)
    assert (state == friction.OPEN).all()
    np.testing.assert_array_equal(defect, -1.0)


def test_sweep_sums_from_the_leading_edge_where_it_sticks():
    state = np.full((4, 1), friction.STICK, np.int8)
    state[0] = friction.OPEN
    increments, out = np.ones((2, 4, 1)), np.empty((2, 4, 1))
    zero = np.zeros((4, 1))
    friction.sweep(state, np.zeros((2, 4, 1)), zero + 1, (1.0, 0.0, 1.0), increments, zero, out)
    np.testing.assert_array_equal(out[0, :, 0], [0, 3, 2, 1])


def test_wear_gathers_against_the_rolling_direction():
    rate = np.array([[0.0, 1.0], [2.0, 0.0], [3.0, 0.0]])
    depth = wear.sweep(np.array([10.0, 20.0]), rate, 0.5)
    np.testing.assert_allclose(depth, [[12.5, 20.5], [12.5, 20.0], [11.5, 20.0]])
