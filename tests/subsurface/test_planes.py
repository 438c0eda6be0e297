"""Planes, points and volumes of a solved contact."""

import numpy as np
import pytest

from tests.scenes import steady
from tractive_sam.contact import Model, equilibrium
from tractive_sam.kernels.stress import COMPONENTS
from tractive_sam.mechanics.criteria import von_mises
from tractive_sam.scene import Plane, Scene
from tractive_sam.subsurface import (
    depths,
    stress_at,
    stress_layers,
    stress_on_plane,
    stress_on_planes,
    stress_path,
    stress_volume,
)

# Sums of a few hundred tractions.
ROUNDING = 1e-13


@pytest.fixture(scope="module")
def contact():
    return steady("spheres-orthotropic", "subsurface.elements=5", elements=21)


def tensor(plane):
    return np.stack([plane.components[name] for name in COMPONENTS])


@pytest.mark.parametrize("body", ["A", "B"])
@pytest.mark.parametrize("plane", ["y=0", "x=0", "y=0.75a", "x=-0.31b", "y=1.2", "x=9"])
def test_vertical_plane_equals_the_sum_at_its_points(contact, plane, body):
    stress = stress_on_plane(contact, plane, body)
    a = contact.scene.hertz.a
    name, along = stress.along
    assert name == ("y" if plane[0] == "x" else "x")
    assert list(stress.axes) == [name, "depth"]
    np.testing.assert_array_equal(along, getattr(contact.grid, name))
    np.testing.assert_array_equal(stress.depth, depths(contact.scene.subsurface, a))
    assert stress.position == Plane.parse(plane).value_in(a, contact.scene.hertz.b)
    assert tensor(stress).shape == (6, along.size, stress.depth.size)
    for i in (0, 8, 20):
        for k in range(1, stress.depth.size):
            point = (
                (stress.position, along[i], stress.depth[k])
                if name == "y"
                else (along[i], stress.position, stress.depth[k])
            )
            truth = stress_at(contact, [point], body)[0]
            np.testing.assert_allclose(
                tensor(stress)[:, i, k], truth, rtol=1e-12, atol=ROUNDING * contact.p_max
            )


@pytest.mark.parametrize("body", ["A", "B"])
def test_plane_at_a_depth_is_a_layer(contact, body):
    stress = stress_on_plane(contact, "z=0.48a", body)
    assert list(stress.axes) == ["x", "y"]
    assert stress.depth == pytest.approx([0.48 * contact.scene.hertz.a])
    ((depth, layer),) = stress_volume(contact, stress.depth, body)
    assert depth == stress.depth[0]
    np.testing.assert_array_equal(tensor(stress), layer)


def test_layers_continue_beyond_the_mesh(contact):
    wanted, beyond = [0.0, 0.4], 30
    x = contact.grid.lengthened(beyond).x
    np.testing.assert_allclose(x[beyond:-beyond], contact.grid.x, atol=1e-14)
    layers = list(stress_layers(contact, wanted, ("A", "B"), beyond))
    for (depth, found), *single in zip(
        layers, *(stress_volume(contact, wanted, body) for body in "AB"), strict=True
    ):
        for stress, body, (_, inside) in zip(found, "AB", single, strict=True):
            assert stress.shape == (6, 81, 21)
            np.testing.assert_allclose(
                stress[:, beyond:-beyond], inside, atol=ROUNDING * contact.p_max
            )
            for i, j in ((0, 0), (80, 3), (40, 13)):
                truth = stress_at(contact, [(x[i], contact.grid.y[j], depth)], body)[0]
                np.testing.assert_allclose(
                    stress[:, i, j], truth, rtol=1e-11, atol=ROUNDING * contact.p_max
                )


def test_volume_equals_the_sum_at_its_points(contact):
    wanted = [0.9, 0.0, 0.2]
    found = list(stress_volume(contact, wanted))
    assert [depth for depth, _ in found] == wanted
    for depth, layer in found:
        assert layer.shape == (6, 21, 21)
        for i, j in ((0, 0), (10, 10), (4, 13)):
            point = contact.grid.x[i], contact.grid.y[j], depth
            truth = stress_at(contact, [point])[0]
            np.testing.assert_allclose(
                layer[:, i, j], truth, rtol=1e-12, atol=ROUNDING * contact.p_max
            )


def test_threads_of_a_volume(contact):
    ((_, one),) = stress_volume(contact, [0.3])
    ((_, two),) = stress_volume(contact, [0.3], threads=2)
    np.testing.assert_allclose(two, one, atol=1e-15 * contact.p_max)


def test_invariants(contact):
    stress = stress_on_plane(contact, "y=0")
    one, _, three = stress.principal
    np.testing.assert_array_equal(stress.von_mises, von_mises(tensor(stress)))
    np.testing.assert_allclose(stress.max_shear, (one - three) / 2)
    assert stress.von_mises.shape == stress.max_shear.shape == (21, 5)


def test_all_that_the_scene_requires(contact):
    requested = contact.scene.subsurface
    found = list(stress_on_planes(contact))
    expected = [(str(plane), body) for plane in requested.planes for body in requested.bodies]
    assert [(str(stress.plane), stress.body) for stress in found] == expected
    for stress in found:
        single = stress_on_plane(contact, stress.plane, stress.body)
        np.testing.assert_allclose(tensor(stress), tensor(single), atol=1e-15 * contact.p_max)


def test_depths_user_defined(contact):
    stress = stress_on_plane(contact, "x=0", depths=[0.5, 0.1])
    np.testing.assert_array_equal(stress.depth, [0.5, 0.1])
    assert stress.von_mises.shape == (21, 2)


def test_without_subsurface_in_the_scene():
    contact = equilibrium(Model(Scene.builtin("spheres").replace(subsurface=None)))
    stress = stress_on_plane(contact, "y=0")
    assert stress.depth.size == 64
    assert stress.depth[-1] == pytest.approx(1.5 * contact.scene.hertz.a)
    with pytest.raises(ValueError, match=r"\[subsurface\]"):
        stress_on_planes(contact)


def test_half_widths_where_there_is_no_hertz_contact():
    scene = Scene(
        body={
            "A": {"shear": 1.0, "poisson": 0.3, "radius_x": 50.0, "radius_y": float("inf")},
            "B": {"shear": 1.0, "poisson": 0.3, "radius_x": float("inf"), "radius_y": float("inf")},
        },
        load={"normal": 0.1},
        grid={"half_length": [2.0, 3.0], "elements": [21, 21]},
        gap={"x": [-3.0, 0.0, 3.0], "y": [-4.0, 0.0, 4.0], "separation": [[0.4, 0.0, 0.4]] * 3},
    )
    gap = scene.gap
    contact = equilibrium(Model(scene, (gap.x, gap.y, gap.separation)))
    assert scene.hertz is None
    stress = stress_on_plane(contact, "y=0.5b", depths=[0.1])
    assert stress.position == 0.5 * contact.half_width_y


def test_frictionless_contact_needs_no_traction():
    contact = steady("spheres", "creepage.longitudinal=0", elements=21)
    assert not contact.traction.any()
    a, b = (tensor(stress_on_plane(contact, "x=0.3", body)) for body in "AB")
    mirror = np.array([1, 1, 1, 1, -1, -1])[:, None, None]
    np.testing.assert_allclose(a, mirror * b, atol=1e-15 * contact.p_max)


@pytest.mark.parametrize("body", ["A", "B"])
def test_path_of_a_material_point_goes_along_the_plane(contact, body):
    depth = 0.4
    grid, j = contact.grid, 8
    cycle = stress_path(contact, grid.y[j], depth, body, x=grid.x[::-1])
    ((_, layer),) = stress_volume(contact, [depth], body)
    np.testing.assert_array_equal(cycle["x"], grid.x[::-1])
    for name, values in zip(COMPONENTS, layer, strict=True):
        np.testing.assert_allclose(
            cycle[name], values[::-1, j], rtol=1e-11, atol=ROUNDING * contact.p_max
        )


def test_path_comes_from_afar_and_goes_there(contact):
    cycle = stress_path(contact, 0.0, 0.5 * contact.scene.hertz.a)
    assert list(cycle) == ["x", *COMPONENTS]
    assert (np.diff(cycle["x"]) < 0.0).all()  # it enters on the leading side
    for name in COMPONENTS:
        # 4 a away stress has fallen with the square of the distance.
        assert np.abs(cycle[name][[0, -1]]).max() < 0.04 * contact.p_max


@pytest.mark.parametrize(
    ("call", "fault"),
    [
        (lambda c: stress_on_plane(c, "q=0"), "y=0"),
        (lambda c: stress_on_plane(c, "z=-1"), "depth"),
        (lambda c: stress_on_plane(c, "y=0", "C"), '"A" or "B"'),
        (lambda c: stress_on_plane(c, "y=0", depths=[0.1, -0.1]), "at least 0"),
        (lambda c: stress_on_plane(c, "y=0", depths=0.1), "sequence"),
        (lambda c: stress_volume(c, [float("nan")]), "finite"),
        (lambda c: stress_volume(c, [0.0], "a"), '"A" or "B"'),
        (lambda c: stress_at(c, [(0.0, 0.0)]), "shape"),
        (lambda c: stress_at(c, (0.0, 0.0, 1.0)), "shape"),
        (lambda c: stress_at(c, [(0.0, 0.0, -1.0)]), "at least 0"),
        (lambda c: stress_path(c, 0.0, -1.0), "at least 0"),
        (lambda c: stress_path(c, 0.0, 1.0, x=0.0), "sequence"),
        (lambda c: stress_path(c, float("inf"), 1.0), "finite"),
    ],
)
def test_faults_are_named_at_the_call(contact, call, fault):
    with pytest.raises(ValueError, match=fault):
        call(contact)
