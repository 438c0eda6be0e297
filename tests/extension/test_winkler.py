"""A user-defined elasticity: a Winkler foundation, in which every point deforms independently.

Kalker's simplified theory. Under an approach d the pressure is (d - h)/L_n, h = x²/2R_x + y²/2R_y.
In stick, u_x = L_t p_x is the creep since the leading edge a(y): p_x = -xi (a - x)/L_t grows
linearly until it reaches the bound mu p_n. This happens at a length d = 2 R_x L_n |xi| / (mu L_t)
ahead of the trailing edge, equal in every row, and the rest slips: all of it if d > 2 a.
"""

from dataclasses import dataclass

import numpy as np
import pytest

import tractive_sam as ts

NORMAL, SHEAR, MU, RADIUS = 2e-6, 3e-6, 0.3, 10.0
BODY = {"young": 2e5, "poisson": 0.3, "radius_x": 2 * RADIUS, "radius_y": 3 * RADIUS}
SPHERES = ts.Scene(
    body={"A": BODY, "B": BODY},
    load={"approach": 4e-3},
    friction={"mu": MU},
    grid={"half_length": (0.33, 0.4), "elements": (33, 29)},
    solver={"tolerance": 1e-10},
)
STRAIGHT = {**BODY, "radius_y": np.inf}
CYLINDERS = ts.Scene(
    body={"A": STRAIGHT, "B": STRAIGHT},
    load={"normal": 700.0},
    friction={"mu": MU},
    grid={"half_length": 0.4, "elements": 401},
    solver={"tolerance": 1e-10},
)


@dataclass  # not frozen: laws need no hash
class Winkler(ts.Elasticity):
    """Displacement per traction L_n and L_t, mm/MPa."""

    normal: float = NORMAL
    shear: float = SHEAR

    def coefficients(self, component, offsets, dx, dy):
        table = np.zeros(offsets)
        table[0, 0] = {"xx": self.shear, "yy": self.shear, "zz": self.normal}.get(component, 0.0)
        return table


def solved(scene, **creepage):
    scene = scene.replace(**{f"creepage.{name}": value for name, value in creepage.items()})
    return ts.solve(scene, laws=ts.Laws.of(scene).replace(elasticity=Winkler()))


def leading(contact):
    """Return a(y), mm: half the length of each row; nan without contact."""
    rise = contact.grid.y**2 / (3 * RADIUS) if contact.grid.elements[1] > 1 else np.zeros(1)
    with np.errstate(invalid="ignore"):
        return np.sqrt(2 * RADIUS * (contact.approach - rise))


def slip_length(creepage):
    return 2 * RADIUS * NORMAL * abs(creepage) / (MU * SHEAR)


def test_pressure_is_what_each_element_is_pressed_in():
    contact = solved(SPHERES)
    x, y = contact.grid.x[:, None], contact.grid.y
    pressure = (contact.approach - x**2 / (2 * RADIUS) - y**2 / (3 * RADIUS)) / NORMAL
    # A table of one entry: to the rounding of the transforms.
    np.testing.assert_allclose(contact.pressure, np.maximum(pressure, 0.0), atol=1e-8)


@pytest.mark.parametrize(
    "creepage",
    [{"longitudinal": -1e-3}, {"longitudinal": 1e-3, "lateral": 2e-3, "spin": 0.02}],
    ids=["longitudinal", "with spin"],
)
def test_upwind_slip_is_fastsim(creepage):
    """Element by element from the leading edge, cut back to the bound along the radius."""
    contact = solved(SPHERES.replace(**{"solver.slip": "upwind"}), **creepage)
    grid, bound = contact.grid, MU * contact.pressure
    rigid = np.stack(
        np.broadcast_arrays(
            contact.xi_x - contact.spin * grid.y, contact.xi_y + contact.spin * grid.x[:, None]
        )
    )
    traction = np.zeros_like(contact.traction)
    for i in range(grid.elements[0] - 2, -1, -1):
        trial = traction[:, i + 1] - rigid[:, i] * grid.dx / SHEAR
        size = np.hypot(*trial)
        traction[:, i] = trial * np.minimum(1.0, bound[i] / np.where(size > 0.0, size, 1.0))
    assert contact.sticking.any()
    assert contact.sliding.any()
    # The residual is 1e-10 of the largest traction; it adds up along a row.
    np.testing.assert_allclose(contact.traction, traction, atol=1e-8 * bound.max())


def test_no_slip():
    contact = solved(SPHERES.replace(**{"friction.mu": 50.0}), longitudinal=-1e-3)
    assert contact.sticking.sum() == contact.touching.sum()
    crept = 1e-3 * (leading(contact) - contact.grid.x[:, None])
    away = np.where(contact.touching, contact.traction[0] * SHEAR - crept, 0.0)
    # The edge is found to a part of an element; with upwind slip to a full one.
    assert np.abs(away).max() < 0.05 * 1e-3 * contact.grid.dx


def test_full_slip():
    contact = solved(SPHERES, longitudinal=-1.6e-2)
    assert slip_length(contact.xi_x) > 2.4 * np.nanmax(leading(contact))
    assert contact.sliding.sum() == contact.touching.sum()
    np.testing.assert_allclose(contact.traction[0], MU * contact.pressure, atol=1e-6)


def test_mixed_slip_is_of_second_order_on_any_mesh():
    applications = []
    for elements in (101, 201, 401, 801):
        contact = solved(CYLINDERS.replace(**{"grid.elements": elements}), longitudinal=-2e-3)
        x, (a,), d = contact.grid.x, leading(contact), slip_length(contact.xi_x)
        assert d < a  # slip at the trailing edge, stick ahead of it
        stick = np.maximum(-contact.xi_x * (a - x) / SHEAR, 0.0)
        truth = np.minimum(stick, MU * contact.pressure[:, 0])
        force = MU * ((2 * a) ** 3 - (2 * a - d) ** 3) / (12 * RADIUS * NORMAL)
        order = (contact.grid.dx / a) ** 2
        # 0.04 to 0.06 and -0.2 to 0.2, as the edges lie within their elements.
        np.testing.assert_allclose(contact.traction[0, :, 0], truth, atol=0.1 * order * truth.max())
        assert contact.Qx == pytest.approx(force, rel=0.5 * order)
        applications.append(contact.cost.applications)
    # A Newton method on nested meshes: 10 to 16.3 of the finest, as rounding decides which elements
    # at the edges change sets, and no more of finer meshes.
    assert max(applications) < 17.0
    assert applications[-1] < 1.4 * applications[0]


def test_it_rolls_and_wears():
    """Friction dissipates what drives the bodies, and wears what it dissipates."""
    scene = ts.Scene.builtin("twin-discs").with_set(["wear.revolutions=40", "wear.save=[40]"])
    scene = scene.replace(subsurface=None)
    history = ts.roll(scene, laws=ts.Laws.of(scene).replace(elasticity=Winkler()))
    assert history.finished
    # The solver's tolerance is 1e-8 of the tractions; the slip is a small difference of them.
    np.testing.assert_allclose(history.energy_balance, 1.0, rtol=1e-5)
    np.testing.assert_allclose(history.wear_balance[1:], 1.0, rtol=1e-5)
    # The most loaded part wears most, and carries less then.
    assert history["p_max"][-1] < history["p_max"][0]


def test_stress_is_not_known():
    contact = solved(SPHERES)
    laws = ts.Laws.of(SPHERES).replace(elasticity=Winkler())
    with pytest.raises(ValueError, match="Winkler"):
        ts.stress_at(contact, [(0.0, 0.0, 0.1)], laws=laws)
