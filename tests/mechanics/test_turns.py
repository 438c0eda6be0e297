"""What two bodies meet again of the wear of a pass."""

import math

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.mechanics.turns import Turns

SHARE = {"A": 0.3, "B": 0.7}
WORN = np.array([0.0, 1e-6, 3e-6])


def rolled(turns, revolutions):
    """Return depths before and behind the last of some passes with equal wear."""
    entering = np.zeros(3)
    for _ in range(revolutions - 1):
        entering = turns.next_entering(entering, entering + WORN)
    return entering, entering + WORN


def test_bodies_of_equal_circumference_come_round_as_one_bit_for_bit():
    entering, leaving = np.random.default_rng(1).uniform(size=(2, 100))
    for turns in (
        Turns.from_radii(SHARE, 32.5, 32.5),
        Turns.from_radii(SHARE, -32.5, 32.5),
        Turns.equal(SHARE),
    ):
        assert turns.gain == 1.0
        np.testing.assert_array_equal(turns.next_entering(entering, leaving), leaving)
        for body in "AB":
            of_body = turns.depth_behind(body, entering, leaving)
            np.testing.assert_array_equal(of_body, SHARE[body] * leaving)


@pytest.mark.parametrize("radius_B", [10.0, 32.3, 200.0, math.inf])
def test_each_body_keeps_its_share_of_the_passes_that_it_turned(radius_B):
    """Behind the last pass: of those before it as many as came round, and that pass."""
    ratio = 30.0 / radius_B
    entering, leaving = rolled(Turns.from_radii(SHARE, 30.0, radius_B), 11)
    A, B = (
        Turns.from_radii(SHARE, 30.0, radius_B).depth_behind(body, entering, leaving)
        for body in "AB"
    )
    np.testing.assert_allclose(A, 0.3 * 11 * WORN, rtol=1e-12)  # rounding
    np.testing.assert_allclose(B, 0.7 * (10 * ratio + 1) * WORN, rtol=1e-12)
    np.testing.assert_allclose(A + B, leaving, rtol=1e-12)


def test_the_turns_of_the_round_body_are_counted():
    turns, swapped = (
        Turns.from_radii(SHARE, math.inf, 20.0),
        Turns.from_radii({"A": 0.7, "B": 0.3}, 20.0, math.inf),
    )
    assert turns.per_count == {"A": 0.0, "B": 1.0}
    assert turns.gain == swapped.gain == pytest.approx(0.7, rel=1e-15)


def test_swapped_bodies_gain_as_much_during_the_run():
    """Per distance rolled; a revolution of A rolls 2 pi R_A."""
    turns = Turns.from_radii(SHARE, 30.0, 10.0)
    swapped = Turns.from_radii({"A": 0.7, "B": 0.3}, 10.0, 30.0)
    assert turns.gain / 30.0 == pytest.approx(swapped.gain / 10.0, rel=1e-14)  # rounding


def test_revolutions_count_the_same_with_and_without_wear():
    discs = ts.Scene.builtin("twin-discs").replace(**{"wear.turns": "each"})
    assert discs.replace(wear=None).turns.per_count == discs.turns.per_count
    assert discs.turns.per_count["B"] == 32.5 / 32.3
