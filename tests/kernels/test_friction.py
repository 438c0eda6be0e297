"""Pointwise kernels: the projection, its derivative, and the sweep."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from tractive_sam.kernels import friction
from tractive_sam.mechanics import wear

# Tractions are dimensionless, of order one: their squares do not underflow.
sizes = st.just(0.0) | st.floats(1e-100, 10)
fields = arrays(float, (2, 3, 2), elements=sizes | sizes.map(lambda x: -x))
bounds = arrays(float, (3, 2), elements=sizes)


def projected(traction, bound, weights=(1.0, 1.0)):
    out = np.empty_like(traction)
    friction.project(traction, bound, out, *weights)
    return out


@settings(max_examples=50)
@given(fields, bounds)
def test_projection_is_admissible_and_idempotent(traction, bound):
    once = projected(traction, bound)
    assert (np.hypot(*once) <= bound * (1 + 1e-15)).all()
    np.testing.assert_allclose(projected(once, bound), once, rtol=1e-15)
    inside = np.hypot(*traction) <= bound
    np.testing.assert_array_equal(once[:, inside & (bound > 0)], traction[:, inside & (bound > 0)])


@settings(max_examples=50)
@given(fields, fields, bounds)
def test_projection_shortens_distances(a, b, bound):
    apart = np.hypot(*(a - b))
    assert (np.hypot(*(projected(a, bound) - projected(b, bound))) <= apart + 1e-12).all()


@settings(max_examples=50)
@given(fields, bounds, st.floats(1.0, 1e4))
def test_nearest_in_a_weighted_norm(traction, bound, weight):
    """On the disc, and apart from it along the normal in that norm: (1 + l w) z = p, l >= 0."""
    out = projected(traction, bound, (1.0, weight))
    assert (np.hypot(*out) <= bound * (1 + 1e-15)).all()
    outside = (np.hypot(*traction) > bound) & (bound > 0)
    (p0, p1), (z0, z1) = traction[:, outside], out[:, outside]
    # Root and quotient are good to rounding, of sizes up to the weight.
    np.testing.assert_allclose((p0 - z0) * weight * z1, (p1 - z1) * z0, rtol=1e-6, atol=1e-11)
    assert (np.abs(z0) <= np.abs(p0) * (1 + 1e-12)).all()
    assert (z0 * p0 >= 0).all()
    assert (z1 * p1 >= 0).all()


def linearised(traction, slip, bound, staggered=False, weights=(1.0, 1.0)):
    shape = bound.shape
    state, direction = np.empty(shape, np.int8), np.empty((2, *shape))
    kappa, across, defect = np.empty(shape), np.empty((2, 2, *shape)), np.empty((2, *shape))
    squares, merit, _ = friction.linearise(
        *(traction, slip, bound, bound, staggered, (*weights, 1.0)),
        *(state, direction, kappa, across, defect),
    )
    assert weights != (1.0, 1.0) or merit == pytest.approx(squares)
    return state, direction, kappa, across, defect, squares


@pytest.mark.slow
def test_linearisation_is_the_derivative_of_the_projection():
    rng = np.random.default_rng(0)
    traction, slip = rng.normal(size=(2, 2, 5, 4))
    bound = rng.uniform(0.1, 1.5, (5, 4))
    state, direction, kappa, _, defect, squares = linearised(traction, slip, bound)
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


def turned(slip, bound):
    out = np.empty_like(slip)
    friction.turn(slip, bound, out)
    return out


def test_turned_slip_points_where_the_slip_at_the_centre_does():
    """Linear in x, so that interpolation from the faces is exact: s(i) at the centre i."""
    faces = np.arange(6)[:, None] + 0.5
    centres = faces - 0.5
    slip = np.stack((np.ones((6, 1)), 0.05 * faces))
    out = turned(slip, np.ones((6, 1)))
    np.testing.assert_allclose(np.hypot(*out), np.hypot(*slip))
    np.testing.assert_allclose((out[1] / out[0])[1:], 0.05 * centres[1:], rtol=1e-12)


def test_turned_slip_is_continuous_and_never_turns_back():
    """Also if slip just begins, vanishes or reverses from one face to the next."""
    rng = np.random.default_rng(2)
    for _ in range(200):
        slip = rng.normal(size=(2, 4, 1)) * np.exp(rng.normal(size=(4, 1)) * 3)
        near = turned(slip + 1e-9 * rng.normal(size=slip.shape), np.ones((4, 1)))
        out = turned(slip, np.ones((4, 1)))
        # The direction turns by at most some 1/|slip|, of sizes down to 1e-4 here.
        assert np.abs(near - out).max() < 1e-7
        assert ((out * slip).sum(axis=0) > 0).all()


def test_rows_are_the_derivative_of_the_law_at_its_solution():
    """Newton's rows, with tractions that oppose the turned slip or, sticking, none at all."""
    rng = np.random.default_rng(3)
    bound = rng.uniform(0.5, 1.5, (6, 3))
    slip = np.stack((rng.uniform(-1.3, -0.7, (6, 3)), rng.uniform(-0.3, 0.3, (6, 3))))
    slip[:, 3, 1] *= 0.3  # slip that just begins: its share in the direction changes as well
    s = turned(slip, bound)
    traction = -bound * s / np.hypot(*s)
    state, direction, kappa, across, defect, _ = linearised(traction, slip, bound, True)
    assert (state == friction.SLIP).all()
    np.testing.assert_allclose(defect, 0.0, atol=1e-14)
    change, h = rng.normal(size=(2, 6, 3)), 1e-6
    defects = []
    for sign in (1, -1):
        s = turned(slip + sign * h * change, bound)
        defects.append(projected(traction - s, bound) - traction)
    t = np.stack((-direction[1], direction[0]))
    derivative = (t * (defects[1] - defects[0])).sum(axis=0) / (2 * h)
    row = np.empty((2, 6, 3))
    friction.tangent_row(state, direction, kappa, across, bound, 0 * change, change, row)
    # The row is scaled so that it is kappa t.m + (1 - kappa) t.p; gamma = 1/kappa - 1 undoes it.
    gamma = 1.0 / kappa - 1.0
    size = np.hypot(*slip)
    undone = (t * row).sum(axis=0) / kappa * size / (gamma * bound)
    undone *= bound / (bound + size)
    np.testing.assert_allclose(derivative, undone, rtol=1e-6, atol=1e-8)


@pytest.mark.parametrize("weights", [(1.0, 1.0), (1.0, 30.0), (400.0, 1.0)])
def test_rows_are_the_derivative_of_the_law_anywhere(weights):
    """Also far from its solution, with tractions that do not oppose the slip.

    With (1 + l w) z = p - w s, tangent t of the disc at z and a change of s alone,
    (t.t/w + l) t.dz = -t.ds.
    """
    rng = np.random.default_rng(5)
    shape = (60, 3)
    bound = rng.uniform(0.5, 1.5, shape)
    slip = rng.normal(size=(2, *shape)) * np.exp(rng.normal(size=shape))
    traction = projected(rng.normal(size=(2, *shape)), bound)
    state, direction, kappa, across, *_ = linearised(traction, slip, bound, True, weights)
    w = np.array(weights)[:, None, None]
    change, h = rng.normal(size=(2, *shape)), 1e-7
    low, high = (turned(slip + sign * h * change, bound) for sign in (-1, 1))
    row = np.empty((2, *shape))
    friction.tangent_row(state, direction, kappa, across, bound, 0 * change, change, row)
    q, z = (
        traction - w * turned(slip, bound),
        projected(traction - w * turned(slip, bound), bound, weights),
    )
    root = ((q - z) * z).sum(axis=0) / (w * z * z).sum(axis=0)
    t = np.stack((-direction[1], direction[0]))
    dz = projected(traction - w * high, bound, weights) - projected(
        traction - w * low, bound, weights
    )
    slipping = state == friction.SLIP
    # 1/kappa - 1 is l over the ratio by which the row is scaled.
    along = (t * row).sum(axis=0)[slipping] / (1.0 - kappa[slipping]) * root[slipping]
    truth = (t * dz).sum(axis=0)[slipping] / (2 * h)
    answer = -along / ((t * t / w).sum(axis=0) + root)[slipping]
    # A few elements are within h of a kink of the share.
    wrong = np.abs(answer - truth) > 1e-4 * (1.0 + np.abs(truth))
    assert np.count_nonzero(slipping) > 100
    assert np.count_nonzero(wrong) <= 1


def test_open_elements_carry_nothing():
    bound = np.zeros((2, 2))
    state, *_, defect, _ = linearised(np.ones((2, 2, 2)), np.ones((2, 2, 2)), bound)
    assert (state == friction.OPEN).all()
    np.testing.assert_array_equal(defect, -1.0)


def test_sweep_sums_from_each_leading_edge_where_it_sticks():
    state = np.full((6, 1), friction.STICK, np.int8)
    state[[0, 3]] = friction.OPEN
    row, increments, out = 7.0 * np.ones((2, 6, 1)), np.ones((2, 6, 1)), np.empty((2, 6, 1))
    zero, own = np.zeros((6, 1)), (1.0, 0.0, 1.0)
    friction.sweep_upwind(state, np.zeros((2, 6, 1)), zero, zero, own, row, increments, out)
    # The value of an open element is that of its row; behind it there is another leading edge.
    np.testing.assert_array_equal(out[0, :, 0], [7, 2, 1, 7, 2, 1])


def test_wear_gathers_against_the_rolling_direction():
    rate = np.array([[0.0, 1.0], [2.0, 0.0], [3.0, 0.0]])
    depth = wear.sweep_wear(np.array([10.0, 20.0]), rate, 0.5)
    np.testing.assert_allclose(depth, [[12.5, 20.5], [12.5, 20.0], [11.5, 20.0]])
