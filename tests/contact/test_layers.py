"""Contacts of coated bodies against solutions of integral equations."""

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.results import caveats
from tractive_sam.subsurface import maxima_by_body

RIGID = {"young": 1e6, "poisson": 0.3, "radius_x": 10.0, "radius_y": 10.0}
FLAT = {"young": 1.0, "poisson": 0.3, "radius_x": np.inf, "radius_y": np.inf}
BARE = ts.Scene(body={"A": FLAT, "B": RIGID}, load={"normal": 1e-3})
CYLINDER = {"young": 208e3, "poisson": 0.3, "radius_x": 20.0, "radius_y": np.inf}
LINE = ts.Scene(body={"A": CYLINDER, "B": CYLINDER}, load={"normal": 500.0}, friction={"mu": 0.3})
SMALL = {"grid.elements": [31, 41]}


def sphere(ratio, thickness, a, elements, poisson=0.3):
    """A sphere on a coating; thickness and contact radius over that of the bare bodies."""
    a_H = BARE.hertz.a
    layer = {"thickness": thickness * a_H, "young": ratio, "poisson": poisson}
    grid = {"elements": (elements,) * 2, "half_length": (1.05 * a * a_H,) * 2}
    return BARE.replace(**{"body.A.layer": [layer], "grid": grid})


def cylinders(ratio, thickness, a, elements=256, **changes):
    a_H = LINE.hertz.a
    layer = [{"thickness": thickness * a_H, "young": ratio * 208e3, "poisson": 0.3}]
    grid = {"elements": (elements,), "half_length": (1.06 * a * a_H,)}
    return LINE.replace(**{"body.A.layer": layer, "body.B.layer": layer, "grid": grid}, **changes)


@pytest.mark.parametrize(
    ("ratio", "thickness", "a", "pressure", "approach", "poisson"),
    [
        (10.0, 0.164908, 0.824542, 1.095082, 0.925010, 0.3),
        (0.1, 0.902162, 1.804324, 0.345989, 2.107547, 0.3),
        (4.0, 0.39299, 0.78597, 1.32209, 0.87609, 0.3),
        (0.25, 0.69288, 1.38577, 0.57218, 1.41400, 0.3),
        (0.01, 3.887021, 3.887021, 0.070088, 8.551049, 0.5),
    ],
)
def test_sphere_on_a_coating(ratio, thickness, a, pressure, approach, poisson):
    """Values over those of Hertz for the bare bodies, by a Fredholm equation."""
    hertz, errors = BARE.hertz, []
    for elements in (32, 64):
        contact = ts.solve(sphere(ratio, thickness, a, elements, poisson))
        middle = contact.pressure[elements // 2, elements // 2]
        errors.append(abs(middle / hertz.p0 / pressure - 1.0))
        assert contact.approach / hertz.approach == pytest.approx(approach, rel=5e-4)
        # Elements that the contact partly fills count with their part in x.
        assert contact.half_width_x / hertz.a == pytest.approx(a, abs=3.0 / elements * a)
    assert errors[1] < 1e-3
    # The pressure of the elements at the vertex, half an element from it, is of second order.
    assert errors[1] < 0.4 * errors[0] + 2e-4


@pytest.mark.parametrize(
    ("ratio", "thickness", "a", "pressure", "stick", "carter", "creepage", "cattaneo"),
    [
        (4.0, 0.384794, 0.769587, 1.145711, 0.5, 0.707373, 0.265256, 0.772559),
        (0.25, 0.750484, 1.500967, 0.708136, 0.8, 0.365965, 0.275363, 0.351975),
        (10.0, 0.162633, 0.813167, 1.060912, 0.5, 0.669920, 0.149971, 0.745581),
    ],
)
def test_carter_and_cattaneo_on_coatings(
    ratio, thickness, a, pressure, stick, carter, creepage, cattaneo
):
    """Rolling and pressed cylinders with equal coatings, by singular integral equations."""
    hertz = LINE.hertz
    xi = -creepage * 0.3 * a * hertz.a / 10.0
    rolling = ts.solve(cylinders(ratio, thickness, a, **{"creepage.longitudinal": xi}))
    assert rolling.p_max / hertz.p0 == pytest.approx(pressure, rel=1e-4)
    assert rolling.half_width_x / hertz.a == pytest.approx(a, rel=2e-4)
    # The boundary of the stick area lies within an element of 1/256 of the contact.
    assert rolling.Qx / 150.0 == pytest.approx(carter, rel=1e-3)
    assert rolling.stick_fraction == pytest.approx(stick, abs=2e-3)
    stage = {"motion": "shift", "distance": [0, 1], "load": {"force_x": [0.0, cattaneo * 150.0]}}
    pushed = ts.roll(cylinders(ratio, thickness, a, transient={"stage": [stage]})).state(1.0)
    assert pushed.stick_fraction == pytest.approx(stick, abs=1e-3)


def test_layers_of_the_material_of_the_body_are_the_body():
    scene = ts.Scene.builtin("cylinders").replace(subsurface=None)
    layer = {"thickness": 0.1, "young": 208e3, "poisson": 0.3}
    same = scene.replace(**{"body.A.layer": [layer, layer]})
    np.testing.assert_array_equal(ts.solve(same).pressure, ts.solve(scene).pressure)
    np.testing.assert_array_equal(ts.solve(same).traction, ts.solve(scene).traction)


@pytest.mark.parametrize(("thickness", "young"), [(1e-5, 208e3), (3e3, 20e3)])
def test_limits_of_thickness(thickness, young):
    """A thin coating is nothing; under a thick one lies nothing."""
    scene = ts.Scene.builtin("coated-roller").replace(**SMALL)
    layer = {"thickness": thickness, "young": 20e3, "poisson": 0.3}
    coated = ts.solve(scene.replace(**{"body.A.layer": [layer]}))
    body = {"body.A.layer": None, "body.A.young": young, "body.A.poisson": 0.3}
    grid = {"grid.half_length": coated.grid.half_length, "grid.elements": coated.grid.elements}
    homogeneous = ts.solve(scene.replace(**body, **grid))
    # Waves as long as the contact, .2 mm, feel (h/a) E2/E1 of the thin and a/h of the thick layer.
    assert coated.p_max == pytest.approx(homogeneous.p_max, rel=2e-3)
    assert coated.Qx == pytest.approx(homogeneous.Qx, rel=2e-3)


def test_contact_of_a_graded_coating_is_that_of_many_layers():
    scene = ts.Scene.builtin("coated-roller").replace(**SMALL)
    one = {"thickness": 0.4, "young": 20e3, "poisson": 0.3, "gradient": "exponential"}
    young = 20e3 * (208.0 / 20.0) ** ((np.arange(40) + 0.5) / 40)
    many = [{"thickness": 0.01, "young": float(E), "poisson": 0.3} for E in young]
    graded = ts.solve(scene.replace(**{"body.A.layer": [one]}))
    grid = {"grid.half_length": graded.grid.half_length, "grid.elements": graded.grid.elements}
    layered = ts.solve(scene.replace(**{"body.A.layer": many}, **grid))
    # The modulus changes by 6 % from layer to layer; of second order: 1/12 of its square.
    assert layered.p_max == pytest.approx(graded.p_max, rel=5e-4)
    assert layered.Qx == pytest.approx(graded.Qx, rel=5e-4)


def test_friction_of_unlike_coated_bodies_dissipates_the_work_supplied():
    contact = ts.solve(ts.Scene.builtin("coated-roller").replace(**SMALL))
    assert contact.laws.elasticity.coupled
    # Both are sums over elements of one solution, to the tolerance of the conditions.
    assert contact.dissipation == pytest.approx(contact.work_supplied, rel=1e-6)


def test_mirrored_pair_has_mirrored_forces():
    """With the bodies exchanged and the motion reversed, A carries the opposite force."""
    scene = ts.Scene.builtin("coated-roller").replace(**SMALL)
    A, B = (scene.body.entries()[name] for name in "AB")
    change = {"body": {"A": B, "B": A}, "creepage.longitudinal": 0.01}
    first, second = ts.solve(scene), ts.solve(scene.replace(**change))
    assert second.Qx == pytest.approx(-first.Qx, rel=1e-7)  # the tolerance of the conditions
    assert second.p_max == pytest.approx(first.p_max, rel=1e-6)


def test_jacobian_of_a_coated_contact():
    scene = ts.Scene.builtin("coated-roller").replace(**SMALL, **{"creepage.longitudinal": -2e-3})
    contact = ts.solve(scene, jacobian=True)
    step = 1e-5
    forces = [
        ts.solve(scene.replace(**{"creepage.longitudinal": -2e-3 + d})).Qx for d in (-step, step)
    ]
    slope = float(contact.jacobian.sel(result="Qx", parameter="xi_x"))
    # Elements change between stick and slip within the step.
    assert slope == pytest.approx((forces[1] - forces[0]) / (2.0 * step), rel=2e-2)


def test_contact_smaller_than_that_of_the_bare_bodies_may_have_its_mesh():
    """A stiff coating makes the contact smaller than the Hertz contact of the body below."""
    scene = sphere(50.0, 0.1, 0.785337, 32)
    assert scene.grid.half_length[0] < 0.9 * BARE.hertz.a
    assert ts.solve(scene).converged


def test_mesh_grows_if_the_estimated_contact_is_too_small():
    line = cylinders(4.0, 0.384794, 0.769587).replace(grid=None)
    contact = ts.solve(line)
    assert contact.half_width_x / LINE.hertz.a == pytest.approx(0.769587, rel=2e-4)


def test_stress_of_one_body_is_that_of_both():
    """Below the body without layers the search is another one: its tolerance is 6e-4."""
    subsurface = {"planes": ["y=0"], "bodies": ["A", "B"]}
    scene = ts.Scene.builtin("coated-roller").replace(**SMALL, subsurface=subsurface)
    contact = ts.solve(scene)
    both = maxima_by_body(contact)
    for body in "AB":
        of_one = ts.stress_maximum(contact, body).value
        assert of_one == pytest.approx(both[body].value, rel=2e-3)  # a coarse mesh


def test_worn_coating_is_reported():
    wear = {"coefficient": {"A": 1e-3, "B": 1e-6}, "revolutions": 2000}
    scene = ts.Scene.builtin("coated-roller").replace(**SMALL, wear=wear)
    scene = scene.replace(**{"body.A.layer[0].thickness": 0.02})
    thinned = caveats(ts.roll(scene))["layers"]
    assert "body A" in thinned
    assert "wear.layer_step" in thinned
    through = scene.replace(**{"body.A.layer[0].thickness": 1e-3})
    assert "worn through" in caveats(ts.roll(through))["layers"]
    assert "layers" not in caveats(ts.roll(scene.replace(**{"wear.revolutions": 10})))


def test_wear_thins_a_layer_and_goes_through_it():
    wear = {"coefficient": {"A": 1e-3, "B": 0.0}, "revolutions": 2000, "save": [0, 500, 2000]}
    scene = ts.Scene.builtin("coated-roller").replace(**SMALL, wear=wear | {"layer_step": 0.1})
    scene = scene.replace(**{"body.A.layer[0].thickness": 0.02})
    history = ts.roll(scene)
    contact = history.state()
    elasticity = ts.Laws.of_contact(contact).elasticity
    load = contact.pressure.sum(axis=0)
    worn = (load * contact.wear[-1]).sum() / load.sum()
    thickness = elasticity.A.layers[0].thickness
    # In steps of a tenth, with the depth before the last jump.
    assert 0.02 - worn - 1e-12 <= thickness <= 0.02 - worn + 0.2 * 0.02
    assert thickness < 0.0199
    assert "layers" not in caveats(history)
    # A contact of the thinner layer: stiffer than with the unworn one.
    kept = ts.roll(scene.replace(**{"wear.layer_step": None}))
    assert contact.approach < kept.state().approach
    through = scene.replace(**{"body.A.layer[0].thickness": 1e-3})
    bare = ts.roll(through)
    assert scene.body.A.material == ts.Laws.of_contact(bare.state()).elasticity.A
    assert "continues with what lies below" in caveats(bare)["layers"]


def test_wear_without_steps_of_layers_is_as_before():
    wear = {"coefficient": {"A": 1e-3, "B": 1e-6}, "revolutions": 20}
    scene = ts.Scene.builtin("coated-roller").replace(**SMALL, wear=wear)
    # No step of half of the layer is reached: equal to the last bit.
    thinning = scene.replace(**{"wear.layer_step": 0.5, "wear.stepping": "every-revolution"})
    plain = scene.replace(**{"wear.stepping": "every-revolution"})
    pressures = [ts.roll(each).state().pressure for each in (plain, thinning)]
    np.testing.assert_array_equal(*pressures)
