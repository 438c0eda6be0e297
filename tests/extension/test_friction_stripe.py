"""Friction user-defined laws: a lubricated stripe, and a strength that caps the traction."""

from dataclasses import dataclass

import numpy as np
import pytest

import tractive_sam as ts

MU, RADIUS, SHEAR = 0.3, 10.0, 8e4
SPHERE = {"shear": SHEAR, "poisson": 0.0, "radius_x": RADIUS, "radius_y": RADIUS}
SCENE = ts.Scene(
    body={"A": SPHERE, "B": SPHERE},
    load={"normal": 100.0},
    friction={"mu": MU},
    creepage={"longitudinal": -1e-3},
    grid={"half_length": (0.27, 0.27), "elements": (25, 21)},
    solver={"slip": "upwind", "tolerance": 1e-10},
)


@dataclass(frozen=True)
class Stripe(ts.Coulomb):
    """A stripe along the middle, in which friction is a share of what it is beside."""

    half_width: float = 0.08
    share: float = 0.2

    def bound(self, pressure, x, y):
        share = np.where(np.abs(y) < self.half_width, self.share, 1.0) + 0.0 * x
        return ts.Bound(share * pressure, share)


@dataclass(frozen=True)
class Capped(ts.Coulomb):
    """A strength beyond which the traction does not rise with the pressure, MPa."""

    strength: float = 100.0

    def bound(self, pressure, x, y):
        most = self.strength / max(self.mu)
        return ts.Bound(np.minimum(pressure, most), np.where(pressure < most, 1.0, 0.0))


@dataclass(frozen=True, eq=False)
class PressureDependent(ts.ScaledFriction):
    """Any friction law whose bound is multiplied by 1/2 at the pressure `half`, MPa."""

    half: float = 1000.0

    def factors(self, pressure):
        factor = 1.0 / (1.0 + pressure / self.half)
        return factor, -(factor**2) / self.half


def integral(x, y):
    """Of 1/r over a rectangle, from its corner at the origin."""
    return x * np.arcsinh(y / np.abs(x)) + y * np.arcsinh(x / np.abs(y))


def displacement(grid, ahead):
    """u_x at the points so far ahead of the elements, by p_x of every element: nu = 0, Cerruti."""
    i, j = (np.subtract.outer(np.arange(n), np.arange(n)) for n in grid.elements)
    x, y = (i * grid.dx + ahead)[:, None, :, None], (j * grid.dy)[None, :, None, :]
    a, b = 0.5 * grid.dx, 0.5 * grid.dy
    corners = ((p, q) for p in (1, -1) for q in (1, -1))
    total = sum(p * q * integral(x + p * a, y + q * b) for p, q in corners)
    n = grid.elements[0] * grid.elements[1]
    return total.reshape(n, n) / (np.pi * SHEAR)  # both bodies


def dense(contact, share):
    """p_x by plain clipped iteration on the dense matrix of the upwind slip."""
    grid, p = contact.grid, contact.pressure.ravel()
    slip_of = -(displacement(grid, grid.dx) - displacement(grid, 0.0)) / grid.dx
    on = np.flatnonzero(p > 0)
    D, bound = slip_of[np.ix_(on, on)], (MU * share * contact.pressure).ravel()[on]
    step, traction = 0.2 / D[0, 0], np.zeros(on.size)
    for _ in range(20_000):
        slip = contact.xi_x + D @ traction
        change = np.clip(traction - step * slip, -bound, bound) - traction
        traction = traction + change
        if np.abs(change).max() < 1e-12 * bound.max():
            break
    out = np.zeros(p.size)
    out[on] = traction
    return out.reshape(grid.elements)


@pytest.mark.parametrize("share", [1.0, 0.2, 0.0])
def test_a_lubricated_stripe_agrees_with_a_dense_solution(share):
    law = Stripe(mu=(MU, MU), share=share)
    contact = ts.solve(SCENE, laws=ts.Laws.of(SCENE).replace(friction=law))
    inside = np.abs(contact.grid.y) < law.half_width
    truth = dense(contact, np.where(inside, share, 1.0))
    # Both are solved to some 1e-10 of the tractions, and their slip to as much.
    np.testing.assert_allclose(contact.traction[0], truth, atol=1e-7 * truth.max())
    # With nu = 0 nothing pulls sideways.
    assert np.abs(contact.traction[1]).max() < 1e-7 * truth.max()
    assert contact.sticking.any()
    assert contact.sliding[:, inside].sum() > 0


def test_a_stripe_moves_with_its_place_on_finer_meshes():
    """Nested meshes know the places of their elements, and the force converges."""
    law = Stripe(mu=(MU, MU))
    laws = ts.Laws.of(SCENE).replace(friction=law)
    forces = [
        ts.solve(SCENE.replace(**{"grid.elements": (n, n), "solver.slip": "auto"}), laws=laws).Qx
        for n in (31, 61)
    ]
    # The stripe ends within an element: its width is good to that.
    assert forces[0] == pytest.approx(forces[1], rel=0.05)
    assert forces[1] < 0.9 * ts.solve(SCENE).Qx


@pytest.mark.parametrize("body", [SPHERE, SPHERE | {"shear": 3e4, "poisson": 0.4}])
def test_a_strength_caps_the_traction(body):
    """Also between dissimilar bodies: their pressure and tractions are found together."""
    scene = SCENE.replace(**{"body.B": body, "creepage.longitudinal": -5e-3})
    law = Capped(mu=(MU, MU), strength=150.0)
    laws = ts.Laws.of(scene).replace(friction=law)
    contact = ts.solve(scene, laws=laws)
    size = np.hypot(*contact.traction)
    free = ts.solve(scene)
    assert np.hypot(*free.traction).max() > 1.2 * law.strength
    # On the rim to rounding.
    assert size.max() == pytest.approx(law.strength, rel=1e-12)
    assert contact.Qx < free.Qx
    # A method without the derivative of the bound finds this solution, to its tolerance.
    plain = ts.solve(scene.replace(**{"solver.method": "uzawa"}), laws=laws)
    np.testing.assert_allclose(plain.traction, contact.traction, atol=1e-5 * law.strength)
    assert contact.cost.applications < 0.2 * plain.cost.applications


def test_a_factor_of_the_pressure_holds_for_falling_friction_too():
    law = {"law": "exponential", "static": MU, "kinetic": 0.2, "half_speed": 300.0}
    sliding = SCENE.replace(friction=law, creepage={"longitudinal": -0.05, "speed": 2e4})
    plain = ts.Laws.of(sliding).friction
    contact = ts.solve(sliding, laws=ts.Laws.of(sliding).replace(
        friction=PressureDependent(plain, half=400.0)))  # fmt: skip
    pressure = contact.pressure
    # The creepage of 1000 mm/s is more than three half speeds: full slip at nearly constant speed.
    expected = (0.2 * pressure / (1.0 + pressure / 400.0)).sum() / pressure.sum()
    share = 0.2 / (0.2 + 0.1 * 2.0 ** (-1000.0 / 300.0))
    assert expected < contact.Qx / contact.P < 1.01 * expected / share


def test_derivative_of_a_factor_of_the_pressure():
    law, p, h = PressureDependent(ts.Coulomb(mu=(MU, MU))), np.array([[50.0, 900.0]]), 1e-3
    low, high = (law.bound(p + change, 0.0, 0.0).radius for change in (-h, h))
    difference = (high - low) / (2 * h)  # of second order, h/half = 1e-6, and its rounding
    np.testing.assert_allclose(law.bound(p, 0.0, 0.0).by_pressure, difference, rtol=1e-8)
