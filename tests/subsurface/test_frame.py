"""Two bodies, one frame: what is continuous, mirrored, symmetric, in equilibrium."""

from dataclasses import replace

import numpy as np
import pytest

from tests.scenes import steady
from tractive_sam.contact import Model, equilibrium
from tractive_sam.scene import Scene
from tractive_sam.subsurface import stress_at, stress_on_plane, stress_volume

XX, YY, ZZ, XY, XZ, YZ = range(6)


@pytest.fixture(scope="module")
def skew():
    """Orthotropic friction at 45 degrees: tractions along x and y."""
    return steady("spheres-orthotropic", elements=21)


@pytest.fixture(scope="module")
def dissimilar():
    settings = ["grid.half_length=[0.4, 0.4]", "grid.elements=[21, 21]"]
    return equilibrium(Model(Scene.builtin("spheres-dissimilar").with_set(settings)))


def layer(contact, depth, body):
    ((_, stress),) = stress_volume(contact, [depth], body)
    return stress


@pytest.mark.parametrize("name", ["skew", "dissimilar"])
def test_tractions_are_continuous_across_the_interface(name, request):
    contact = request.getfixturevalue(name)
    assert contact.converged
    carried = -np.stack((*contact.traction, contact.pressure))
    for body in "AB":
        surface = layer(contact, 0.0, body)[[XZ, YZ, ZZ]]
        np.testing.assert_allclose(surface, carried, atol=1e-14 * contact.p_max)


def test_the_other_stresses_jump(skew):
    """Traction pulls at A what it pushes at B."""
    assert skew.Qx > 0
    surfaces = [layer(skew, 0.0, body)[XX] for body in "AB"]
    assert np.abs(surfaces[0] - surfaces[1]).max() > 0.5 * skew.p_max


def test_bodies_are_mirror_images(skew):
    """B under (p_x, p_y) is A under (-p_x, -p_y), seen in the mirror z -> -z."""
    opposite = replace(skew, traction=-skew.traction)
    mirror = np.array([1, 1, 1, 1, -1, -1])[:, None, None]
    depth = 0.4 * skew.scene.hertz.a
    a, b = layer(opposite, depth, "A"), layer(skew, depth, "B")
    np.testing.assert_allclose(b, mirror * a, atol=1e-15 * skew.p_max)


def test_each_body_has_its_own_poisson_ratio(dissimilar):
    """Trace of the stress by pressure alone is proportional to 1 + nu."""
    pressed = replace(dissimilar, traction=0.0 * dissimilar.traction)
    point = [(0.1, 0.0, 0.2)]
    traces = [stress_at(pressed, point, body)[0, :3].sum() for body in "AB"]
    poisson = [dissimilar.scene.materials[body].poisson for body in "AB"]
    assert poisson[0] != poisson[1]
    assert traces[0] / traces[1] == pytest.approx((1 + poisson[0]) / (1 + poisson[1]), rel=1e-12)


@pytest.mark.parametrize("body", ["A", "B"])
def test_mirror_symmetry_in_y(body):
    contact = steady("spheres", elements=21)
    stress = layer(contact, 0.3 * contact.scene.hertz.a, body)
    signs = np.array([1, 1, 1, -1, 1, -1])[:, None, None]
    # The contact is symmetric to the tolerance of its solution, 1e-8.
    np.testing.assert_allclose(stress[:, :, ::-1], signs * stress, atol=1e-7 * contact.p_max)


@pytest.mark.parametrize(("angle", "leans"), [(0, False), (45, True), (90, False)])
def test_orthotropic_friction_leans_in_the_yz_plane(angle, leans):
    """Paper, figure 8: p_y at 45 degrees makes the yz plane one-sided."""
    contact = steady("spheres-orthotropic", f"friction.angle={angle}", elements=31)
    stress = stress_on_plane(contact, "x=0").von_mises
    lean = np.abs(stress - stress[::-1]).max() / contact.scene.hertz.p0
    # 0.09 at 45 degrees; else symmetric to the tolerance of the solution, 1e-8
    assert lean > 0.05 if leans else lean < 1e-6


@pytest.mark.parametrize("body", ["A", "B"])
def test_equilibrium(skew, body):
    """No forces inside: the divergence vanishes, by sixth-order differences."""
    a = skew.scene.hertz.a
    point, h = np.array([0.3, -0.2, 0.4]) * a, 0.01 * a
    outward = 1.0 if body == "A" else -1.0  # z is -depth in B
    offsets = np.array([-3, -2, -1, 1, 2, 3])
    weights = np.array([-1, 9, -45, 45, -9, 1]) / (60 * h)
    gradient = [
        weights @ stress_at(skew, point + h * offsets[:, None] * axis, body) for axis in np.eye(3)
    ]
    gradient[2] *= outward
    for row in ((XX, XY, XZ), (XY, YY, YZ), (XZ, YZ, ZZ)):
        divergence = sum(gradient[axis][c] for axis, c in enumerate(row))
        # (h/z)^6 is 2e-10
        assert abs(divergence) < 1e-8 * np.abs(gradient).max()


def test_the_load_passes_through_every_depth(skew):
    """The force on a plane below the contact tends to the load as the plane covers more of it."""
    depth = 0.25 * skew.scene.hertz.a
    outward = np.abs(skew.grid.x).max()
    stress = layer(skew, depth, "A")[[XZ, YZ, ZZ]]
    force = -stress.sum(axis=(1, 2)) * skew.grid.element_area
    # Beyond the mesh: a share of order depth / half length, to the third power for the pressure.
    assert force[2] == pytest.approx(skew.P, rel=(depth / outward) ** 2)
    np.testing.assert_allclose(force[:2], (skew.Qx, skew.Qy), rtol=2 * depth / outward)
