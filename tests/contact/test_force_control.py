"""Forces given in place of creepages."""

from dataclasses import replace

import numpy as np
import pytest

from tests.scenes import steady
from tractive_sam.contact import Model
from tractive_sam.contact.solution import message
from tractive_sam.results.state import Status
from tractive_sam.schema import SceneError


@pytest.mark.parametrize("bodies", [(), ("body.B.shear=8.0", "body.B.poisson=0.45")])
@pytest.mark.parametrize("friction", [(), ("friction.mu=[0.5, 0.2]", "friction.angle=35")])
def test_the_force_of_a_creepage_gives_the_creepage_back(bodies, friction):
    common = (*bodies, *friction, "creepage.spin=0.0004")
    driven = steady("spheres", *common, "creepage.lateral=0.0008", elements=25)
    transmitted = steady(
        "spheres",
        *common,
        f"load.force_x={driven.Qx!r}",
        f"load.force_y={driven.Qy!r}",
        elements=25,
    )
    assert transmitted.converged, transmitted.message
    assert transmitted.xi_x == pytest.approx(driven.xi_x, rel=1e-5)
    assert transmitted.xi_y == pytest.approx(driven.xi_y, rel=1e-5)
    np.testing.assert_allclose(transmitted.traction, driven.traction, atol=1e-6 * driven.p_max)


def test_it_costs_little_more_than_a_given_creepage():
    given = steady("spheres", elements=61)
    found = steady("spheres", f"load.force_x={given.Qx!r}", elements=61)
    assert found.cost.applications < 1.3 * given.cost.applications


@pytest.mark.parametrize("share", [1e-6, 0.1, 0.6, 0.95, 0.999])
def test_from_hardly_any_force_to_nearly_all(share):
    force = share * 0.4013 * 0.4705
    contact = steady("spheres", f"load.force_x={force!r}", elements=31)
    assert contact.converged, contact.message
    assert contact.Qx == pytest.approx(force, rel=1e-7)
    assert contact.xi_x < 0


def test_more_than_friction_can_carry_is_a_fault_of_the_scene():
    with pytest.raises(SceneError, match=r"load\.force_x"):
        steady("spheres", "load.force_x=0.2", elements=21)


def test_more_than_friction_can_carry_under_an_approach_is_said():
    """The load is then a result, so that no check of the scene can know."""
    contact = steady("spheres", "load.approach=0.036", "load.force_x=0.4", elements=21)
    assert not contact.converged
    assert "load.force_x" in contact.message
    assert "of what friction can carry" in contact.message
    # Nothing is tried in vain: the normal problem on its meshes is all that is solved.
    assert contact.cost.applications < 40


def test_more_than_friction_can_carry_between_unlike_bodies_is_said():
    """If pressure depends on tractions, only unbounded creepages show it."""
    bodies = ("body.B.shear=8.0", "body.B.poisson=0.45")
    contact = steady("spheres", *bodies, "load.approach=0.06", "load.force_x=4.0", elements=15)
    assert contact.status is Status.DIVERGED
    assert contact.residual > 0.1
    assert "load.force_x" in contact.message
    assert "load.force_y" not in contact.message


def test_what_friction_just_carries_is_found():
    """The limit is in the direction of the force: here between the limits of mu1 and mu2."""
    settings = ("friction.mu=[0.4, 0.2]", "friction.angle=30", "load.approach=0.06")
    free = steady("spheres", *settings, elements=21)
    share = np.array([np.cos(np.pi / 6) / 0.4, np.sin(np.pi / 6) / 0.2])
    limit = free.P / np.hypot(*share)  # of (Q_x, 0) on the ellipse of friction
    forces = (f"load.force_x={0.98 * limit}", "load.force_y=0.0")
    assert steady("spheres", *settings, *forces, elements=21).converged
    forces = (f"load.force_x={1.001 * limit}", "load.force_y=0.0")
    beyond = steady("spheres", *settings, *forces, elements=21)
    assert not beyond.converged
    assert "100.1% of what friction can carry" in beyond.message


def test_it_is_for_newton():
    with pytest.raises(SceneError, match=r"solver\.method"):
        steady("spheres", "load.force_x=0.1", 'solver.method="uzawa"', elements=21)


def test_no_force_that_is_zero_is_blamed():
    bodies = ("body.B.shear=8.0", "body.B.poisson=0.45")
    contact = steady("spheres", *bodies, "load.force_x=0", elements=15)
    model = Model(contact.scene)
    outcome = model.method.dissimilar.solve(model.problem(model.undeformed_gap), 1e-8)
    outcome = replace(outcome, status=Status.DIVERGED)
    assert "load.force" not in message(Status.DIVERGED, outcome, model)
