"""The largest von Mises stress against another program, closed forms and a fine search."""

from dataclasses import replace

import numpy as np
import pytest

from tests.scenes import steady
from tractive_sam.contact import Model, equilibrium
from tractive_sam.mechanics.criteria import von_mises
from tractive_sam.run import roll
from tractive_sam.scene import Scene
from tractive_sam.subsurface import maxima_by_body, stress_at, stress_maximum, stress_volume


@pytest.fixture(scope="module")
def spheres():
    # The slip of CONTACT, with which its numbers are compared.
    return steady("spheres", 'solver.slip="upwind"', elements=91)


def test_interior_of_the_spheres(spheres):
    """CONTACT, same mesh: 0.6655 p0 at x = 0.128 a, z = 0.47 a, on a grid of points."""
    hertz = spheres.scene.hertz
    found = stress_maximum(spheres)
    x, y, z = np.divide(found.interior_at, hertz.a)
    assert found.interior / hertz.p0 == pytest.approx(0.6655, abs=1e-4)  # its printed digits
    assert x == pytest.approx(0.128, abs=0.01)
    assert y == pytest.approx(0.0, abs=1e-3)
    assert z == pytest.approx(0.47, abs=0.01)


@pytest.mark.parametrize(("elements", "printed"), [(31, 0.688), (61, 0.702), (91, 0.710)])
def test_centres_of_the_spheres_as_another_program_has_them(elements, printed):
    """CONTACT, at the trailing edge; both solve the slip to first order in the element."""
    contact = steady("spheres", 'solver.slip="upwind"', elements=elements)
    hertz, grid = contact.scene.hertz, contact.grid
    ((_, stress),) = stress_volume(contact, [0.0])
    at_centres = von_mises(stress) / hertz.p0
    assert at_centres.max() == pytest.approx(printed, abs=1e-3)
    # Between them and at the edge it is larger.
    found = stress_maximum(contact)
    assert found.surface / hertz.p0 > printed + 0.01
    assert found.value == found.surface
    assert found.at == found.surface_at
    x, y, z = np.divide(found.surface_at, hertz.a)
    assert x == pytest.approx(-1.0, abs=0.5 * grid.dx / hertz.a)
    assert abs(y) < 0.3
    assert z == 0.0


def test_orthotropic_spheres():
    """Paper, section 8.1.2: as beta grows the surface is relieved, the interior stays near 0.6."""
    found = []
    for angle in (0, 45, 90):
        contact = steady("spheres-orthotropic", f"friction.angle={angle}", elements=45)
        found.append(stress_maximum(contact))
    p0 = contact.scene.hertz.p0
    interior = [m.interior / p0 for m in found]
    surface = [m.surface / p0 for m in found]
    np.testing.assert_allclose(interior, 0.655, atol=0.015)
    assert surface[0] > surface[1] > surface[2]
    assert surface[0] - surface[2] > 0.2
    # In the yz plane the field leans to one side at 45 degrees only.
    lean = [abs(m.interior_at[1]) / contact.scene.hertz.a for m in found]
    assert lean[1] > 0.005
    assert max(lean[0], lean[2]) < 1e-3


def test_frictionless_is_hertz():
    contact = steady("spheres", "creepage.longitudinal=0", elements=61)
    hertz = contact.scene.hertz
    found = stress_maximum(contact)
    # nu = 0.28; the mesh makes 1e-4
    assert found.interior / hertz.p0 == pytest.approx(0.6293, abs=1e-4)
    np.testing.assert_allclose(np.divide(found.interior_at, hertz.a), (0, 0, 0.4742), atol=2e-3)
    assert found.value == found.interior
    # (1 - 2 nu) / 2 below the middle of a smooth pressure, von Mises: |-(1 + 2 nu) / 2 + 1|; at
    # the edge the radial tension and the hoop compression make (1 - 2 nu) / sqrt(3).
    # The place of the edge within its elements makes 0.01 p0 at most.
    assert found.surface / hertz.p0 == pytest.approx((1 - 2 * 0.28) / np.sqrt(3), rel=0.03)


@pytest.mark.parametrize("body", ["A", "B"])
def test_interior_is_that_of_its_point(spheres, body):
    found = stress_maximum(spheres, body)
    there = von_mises(stress_at(spheres, [found.interior_at], body).T)
    # Elements are taken together in blocks up to 0.2 of their distance wide.
    assert there == pytest.approx(found.interior, rel=1e-4)


def test_bodies_together_are_as_single_ones():
    contact = steady("spheres-orthotropic", 'subsurface.planes=["y=0"]', elements=41)
    assert maxima_by_body(contact) == {body: stress_maximum(contact, body) for body in "AB"}


def test_equal_bodies_without_friction_are_stressed_alike():
    contact = steady("spheres", "creepage.longitudinal=0", 'subsurface.planes=["y=0"]', elements=41)
    found = maxima_by_body(contact)
    assert found["A"] == found["B"]


@pytest.mark.parametrize("body", ["A", "B"])
def test_nothing_larger_in_a_fine_search(body):
    contact = steady("spheres-orthotropic", elements=41)
    found = stress_maximum(contact, body)
    a, grid = contact.scene.hertz.a, contact.grid
    depths = np.geomspace(0.2 * a, 1.2 * a, 40)
    layers = [von_mises(stress) for _, stress in stress_volume(contact, depths, body)]
    k, i, j = np.unravel_index(np.argmax(layers), np.shape(layers))
    assert np.max(layers) <= found.interior
    assert np.max(layers) == pytest.approx(found.interior, rel=1e-3)  # half an element off
    step = max(grid.dx, depths[k] - depths[k - 1])
    np.testing.assert_allclose(found.interior_at, (grid.x[i], grid.y[j], depths[k]), atol=step)
    # A true maximum, found to a hundredth of its depth: no step aside gains more than 3e-5, the
    # accuracy of the value.
    aside = found.interior_at + 0.01 * found.interior_at[2] * np.concatenate(
        (np.eye(3), -np.eye(3))
    )
    assert (von_mises(stress_at(contact, aside, body).T) < (1 + 3e-5) * found.interior).all()


@pytest.mark.parametrize(("name", "elements"), [("spheres", 31), ("cylinders", None)])
def test_strong_friction_leaves_no_maximum_inside(name, elements):
    contact = steady(name, "friction.mu=0.9", "creepage.longitudinal=-0.05", elements=elements)
    found = stress_maximum(contact)
    assert np.isnan(found.interior)
    assert np.isnan(found.interior_at).all()
    assert found.value == found.surface > 1.4 * contact.scene.hertz.p0


def worn_discs(depth, half_width, *settings):
    """Return twin discs hollowed around y = 0: the pressure has a spike at each edge of the
    hollow."""
    model = Model(Scene.builtin("twin-discs-isotropic").with_set(settings))
    profile = np.maximum(0.0, depth * (1 - (model.grid.y / half_width) ** 2))
    return equilibrium(model, np.broadcast_to(profile, model.grid.elements).copy())


def largest_in_layers(contact, depths):
    layers = [von_mises(stress) for _, stress in stress_volume(contact, depths)]
    k, i, j = np.unravel_index(np.argmax(layers), np.shape(layers))
    return layers[k][i, j], (contact.grid.x[i], contact.grid.y[j], depths[k])


@pytest.mark.slow
def test_below_the_pressure_spikes_of_worn_discs():
    contact = worn_discs(0.002, 0.6, "friction.mu=0.2")
    found = stress_maximum(contact)
    value, (x, y, z) = largest_in_layers(contact, np.geomspace(0.03, 0.3, 40))
    assert abs(y) == pytest.approx(0.6, abs=0.01)
    assert found.value == found.interior
    assert value == pytest.approx(found.interior, rel=1e-3)  # half an element off
    assert value <= found.interior
    x0, y0, z0 = found.interior_at
    np.testing.assert_allclose((x0, abs(y0), z0), (x, abs(y), z), atol=contact.grid.dy)


@pytest.mark.slow
def test_a_spike_too_narrow_for_the_mesh():
    """Its maximum is less than two elements deep; reported is what is found two elements deep."""
    contact = worn_discs(0.01, 0.9, "friction.mu=0.2")
    found = stress_maximum(contact)
    shallowest = 2.0 * max(contact.grid.dx, contact.grid.dy)
    value, _ = largest_in_layers(contact, np.geomspace(shallowest, 0.3, 20))
    assert found.interior_at[2] == shallowest
    assert found.value == found.interior >= value > found.surface


@pytest.mark.slow
def test_comes_and_goes_but_once_as_discs_wear():
    """As it nears the surface it ends there; what the mesh makes is not taken for one."""
    to_6000 = ["grid.elements=[27, 81]", "wear.revolutions=6000", "wear.save=[0, 6000]"]
    history = roll(Scene.builtin("twin-discs").with_set(to_6000))
    inside = np.isfinite(history["von_mises_interior"])
    assert inside[0].any()
    assert (np.count_nonzero(np.diff(inside, axis=0), axis=0) <= 1).all()


def test_one_element_in_contact(spheres):
    pressure = np.zeros_like(spheres.pressure)
    pressure[3, 90] = 1.0  # at the border of the mesh
    contact = replace(spheres, pressure=pressure, traction=np.zeros_like(spheres.traction))
    found = stress_maximum(contact)
    assert np.isfinite(found.value)
    # Sums during the run to it are in single precision: a millionth of the depth.
    assert found.at[:2] == pytest.approx((spheres.grid.x[3], spheres.grid.y[90]), abs=1e-6)


def test_no_contact(spheres):
    contact = replace(spheres, pressure=0 * spheres.pressure, traction=0 * spheres.traction)
    found = stress_maximum(contact)
    assert found.value == 0.0
    assert np.isnan(found.at).all()


def test_unknown_body(spheres):
    with pytest.raises(ValueError, match='"A" or "B"'):
        stress_maximum(spheres, "C")
