"""Friction that varies across the contact, `friction.across`."""

import numpy as np
import pytest

import tractive_sam as ts

SPHERES = ts.Scene.builtin("spheres").with_set(["grid.elements=[21, 21]"])
STRIPE = [[-1.0, 1.0], [0.5, 0.4]]
"""Friction falls from y = -1 mm to 0.5 mm; the contact has a semi-axis of 3.5 mm."""


def across(pairs, **changes):
    return SPHERES.replace(**{"friction.across": pairs} | changes)


def factors(contact):
    return np.interp(contact.grid.y, *np.transpose(STRIPE))


def test_factor_of_one_everywhere_changes_nothing():
    contact, plain = ts.solve(across([[0.0, 1.0]])), ts.solve(SPHERES)
    np.testing.assert_array_equal(contact.traction, plain.traction)


def test_traction_of_full_slip_is_the_local_friction():
    contact = ts.solve(across(STRIPE, **{"creepage.longitudinal": -1.0}))
    bound = SPHERES.friction.mu[0] * factors(contact) * contact.pressure
    # The creepage is finite: tractions turn by the elastic slip, 1e-3 of the creepage.
    np.testing.assert_allclose(contact.traction[0], bound, atol=1e-5 * contact.p_max)
    assert contact.Mz > 0.0  # a larger traction on the side of negative y


def test_mirrored_friction_mirrors_the_contact():
    contact = ts.solve(across(STRIPE))
    mirrored = ts.solve(across([[-y, factor] for y, factor in reversed(STRIPE)]))
    size = np.abs(contact.traction).max()
    flipped = mirrored.traction[:, :, ::-1] * np.array([1.0, -1.0])[:, None, None]
    np.testing.assert_allclose(contact.traction, flipped, atol=1e-6 * size)  # solver.tolerance


def test_wear_by_distance_does_not_depend_on_friction_in_full_slip():
    """Archard's law: less friction does less work over an equal sliding distance."""
    wear = {"intensity": 1e-9, "revolutions": 3, "stepping": "every-revolution"}
    slides = {"creepage.longitudinal": -1.0, "wear": wear}
    varied, plain = ts.roll(across(STRIPE, **slides)), ts.roll(SPHERES.replace(**slides))
    depth = plain["wear_profile"][-1]
    # The lateral elastic slip of uneven friction is 1e-4 of the creepage.
    np.testing.assert_allclose(varied["wear_profile"][-1], depth, atol=1e-3 * depth.max())


def test_transient_becomes_the_steady_state():
    steady = ts.solve(across(STRIPE))
    rolled = ts.roll(across(STRIPE, transient={"distance": [0.0, 20.0], "save": [20.0]}))
    assert rolled["Qx"][-1] == pytest.approx(steady.Qx, rel=2e-2)  # after 3 contact lengths
    assert rolled["Mz"][-1] == pytest.approx(steady.Mz, rel=2e-2)


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"friction.across": [[1.0, 1.0], [0.0, 2.0]]}, "friction.across"),
        ({"friction.across": [[0.0, 0.0]]}, "friction.across"),
        (
            {"body.A.radius_y": np.inf, "body.B.radius_y": np.inf, "grid": None}
            | {"friction.across": STRIPE},
            "friction.across",
        ),
    ],
)
def test_faults_name_the_key(changes, key):
    with pytest.raises(ts.SceneError) as raised:
        SPHERES.replace(**changes)
    assert raised.value.faults[0].key.startswith(key)


def test_forces_up_to_the_largest_local_friction_are_allowed():
    limit = SPHERES.friction.mu[0] * SPHERES.load.normal
    force = {"load.force_x": 1.5 * limit}
    assert across([[0.0, 2.0]], **force).load.force_x
    with pytest.raises(ts.SceneError, match="force_x"):
        SPHERES.replace(**force)
