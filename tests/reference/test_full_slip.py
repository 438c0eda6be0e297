import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tractive_sam.mechanics.frame import full_slip_force, load_to_carry

ANGLES = st.floats(-math.pi, math.pi)
FRICTION = st.tuples(st.floats(0.05, 1), st.floats(0.05, 1))


def unit(direction):
    return math.cos(direction), math.sin(direction)


@given(ANGLES, ANGLES, st.floats(0.05, 1))
def test_isotropic_friction_opposes_the_slip(angle, direction, mu):
    slip = unit(direction)
    force = full_slip_force(10.0, (mu, mu), angle, slip)
    assert force == pytest.approx((-10 * mu * slip[0], -10 * mu * slip[1]), abs=1e-14)


@given(ANGLES, ANGLES, FRICTION)
def test_friction_is_used_up(angle, direction, mu):
    force = full_slip_force(7.0, mu, angle, unit(direction))
    assert load_to_carry(force, mu, angle) == pytest.approx(7.0)


@given(ANGLES, ANGLES, ANGLES, FRICTION)
def test_largest_dissipation(angle, direction, other, mu):
    """Of all forces that friction can carry, the associated one dissipates the most."""
    slip = unit(direction)
    force = full_slip_force(1.0, mu, angle, slip)
    rival = unit(other)
    scale = 1 / load_to_carry(rival, mu, angle)
    dissipated = -force[0] * slip[0] - force[1] * slip[1]
    assert dissipated >= -scale * (rival[0] * slip[0] + rival[1] * slip[1]) - 1e-12


@given(ANGLES, ANGLES, ANGLES, FRICTION)
def test_turning_everything_turns_the_force(angle, direction, turn, mu):
    force = full_slip_force(1.0, mu, angle, unit(direction))
    turned = full_slip_force(1.0, mu, angle + turn, unit(direction + turn))
    cos, sin = unit(turn)
    expected = (cos * force[0] - sin * force[1], sin * force[0] + cos * force[1])
    assert turned == pytest.approx(expected, abs=1e-12)


@given(st.floats(0, math.pi / 2), FRICTION)
def test_published_slip_along_x(beta, mu):
    """The two formulas of `orthotropic_full_slip_along_x`."""
    cos, sin = unit(beta)
    mu_eff = math.hypot(mu[0] * cos, mu[1] * sin)
    lateral = (mu[0] ** 2 - mu[1] ** 2) * sin * cos / mu_eff
    expected = (mu_eff, lateral)
    assert full_slip_force(1.0, mu, beta, (-1.0, 0.0)) == pytest.approx(expected, abs=1e-14)


def test_direction_unknown():
    with pytest.raises(ValueError, match="slip"):
        full_slip_force(1.0, (0.3, 0.3), 0.0, (0.0, 0.0))
