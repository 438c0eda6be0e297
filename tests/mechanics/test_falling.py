"""Friction that falls with sliding: its shares, its memory, its strength and their derivatives."""

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.mechanics import Exponential, FallingCoulomb, FrictionOnMesh, Rational

SPEED = np.linspace(0.0, 3000.0, 31)


@pytest.mark.parametrize("share", [Exponential(0.4, 250.0), Rational(0.4, 250.0)])
def test_share_falls_from_one_by_half_at_its_half_speed(share):
    value, slope = share.at(SPEED)
    assert value[0] == 1.0
    assert share.at(np.array(250.0))[0] == pytest.approx(0.7)  # half of the way to 0.4
    assert np.all(slope < 0.0)
    assert np.all(value > share.least)
    assert share.at(np.array(1e9))[0] == pytest.approx(share.least, rel=1e-6)  # rational: 2.5e-7
    ahead, behind = share.at(SPEED + 1e-3)[0], share.at(np.maximum(SPEED - 1e-3, 0.0))[0]
    step = np.where(SPEED > 0.0, 2e-3, 1e-3)
    np.testing.assert_allclose((ahead - behind) / step, slope, rtol=1e-5)  # forward at zero: 3e-6


def test_polach_is_exponential():
    scene = ts.Friction(law="polach", static=0.36, A=0.38, B=0.7)
    share, half_speed = scene.share
    w = 1.3  # m/s
    left = Exponential(share, half_speed).at(np.array(1e3 * w))[0]
    assert left == pytest.approx(0.62 * np.exp(-0.7 * w) + 0.38, rel=1e-14)  # rounding


@pytest.mark.parametrize("staggered", [False, True])
@pytest.mark.parametrize("memory", [0.0, 0.01])
def test_slope_is_the_derivative(staggered, memory):
    """With orthotropic axes, a strength that caps some elements, and gaps in the contact."""
    rng = np.random.default_rng(3)
    law = FallingCoulomb((0.5, 0.3), 0.4, Exponential(0.3, 200.0), 5e3, memory, 100.0)
    x = 0.1 * np.arange(9.0)[:, None]
    friction = FrictionOnMesh(law, x, np.zeros((1, 4)), unit=700.0, slip=0.01)
    pressure = rng.uniform(0.1, 0.9, (9, 4))
    pressure[4, 1] = pressure[-1] = 0.0
    slip, change = rng.normal(0.0, 3.0, (2, 9, 4)), rng.normal(0.0, 1.0, (2, 9, 4))
    bound = friction.bound_sliding(pressure, slip, pressure, staggered)
    h = 1e-5
    after, before = (
        friction.bound_sliding(pressure, slip + k * h * change, pressure, staggered).radius
        for k in (1.0, -1.0)
    )
    found = bound.slope.change(law.slip_at_centres(change, pressure, staggered))
    np.testing.assert_allclose(found, (after - before) / (2 * h), atol=1e-8)  # differences: h^2
    assert np.abs(found).max() > 1e-3
    assert bound.radius.max() <= 100.0 / 0.5 / 700.0


def test_memory_is_exponential_in_the_distance_slid():
    """Of constant slip the law's differential equation is solved exactly, to second order."""
    n, dx, slip, memory = 40, 0.05, 2e-3, 1e-3
    law = FallingCoulomb((0.3, 0.3), 0.0, Exponential(0.5, 100.0), 1e4, memory)
    x = dx * np.arange(n)[:, None]
    field = np.stack((np.full((n, 1), slip), np.zeros((n, 1))))
    pressure = np.ones((n, 1))
    target = law.sliding.at(1e4 * slip)[0]
    slid = slip * dx * np.arange(n, 0, -1)[:, None]
    exact = target + (1.0 - target) * np.exp(-slid / memory)
    share = law.bound_sliding(pressure, field, x, 0.0, True).radius
    np.testing.assert_allclose(share, exact, rtol=1e-13)  # rounding
    implicit = law.bound_sliding(pressure, field, x, 0.0, False).radius
    assert 0.0 < np.abs(implicit - exact).max() < 0.5 * slip * dx / memory  # of first order


def test_what_does_not_vary_is_coulomb():
    """Zero slope and infinite strength are no other law: today's numbers, at no cost."""
    scene = ts.Scene.builtin("spheres")
    fast = {"creepage.speed": 100.0, "friction.static": 0.3, "friction.kinetic": 0.3}
    fast |= {"friction.law": "rational", "friction.half_speed": 10.0}
    assert ts.Laws.of(scene.replace(**fast)).friction == ts.Coulomb((0.3, 0.3))
    none = ts.Laws.of(scene.replace(**{"friction.layer": 0.0}))
    assert none == ts.Laws.of(scene)
    great = scene.replace(**{"friction.strength": 1e30, "grid.elements": [21, 21]})
    plain = scene.replace(**{"grid.elements": [21, 21]})
    assert ts.solve(great).Qx == ts.solve(plain).Qx
