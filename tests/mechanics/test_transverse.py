"""Materials that are isotropic in the surface only."""

import numpy as np
import pytest

import tractive_sam as ts

MATERIALS = {  # stiffness in GPa: zinc, graphite, cobalt
    "zinc": (165.0, 31.1, 50.0, 61.8, 39.6),
    "graphite": (1060.0, 180.0, 15.0, 36.5, 4.5),
    "cobalt": (307.0, 165.0, 103.0, 358.0, 75.5),
}


def isotropic(young, poisson):
    """The stiffness of an isotropic material."""
    G = young / (2.0 * (1.0 + poisson))
    lame = 2.0 * G * poisson / (1.0 - 2.0 * poisson)
    return ts.TransverseMaterial(lame + 2.0 * G, lame, lame, lame + 2.0 * G, G)


@pytest.mark.parametrize(
    ("name", "modulus", "poisson"),
    [
        ("zinc", 69.6181333, 0.0947203),
        ("graphite", 25.0308361, 0.3402480),
        ("cobalt", 269.238065, 0.4126885),
    ],
)
def test_constants(name, modulus, poisson):
    """Against Stroh's formalism, an eigenvalue problem for any anisotropy."""
    material = ts.TransverseMaterial(*MATERIALS[name])
    assert 2.0 / material.compliances[0] == pytest.approx(modulus, rel=1e-8)  # digits
    assert material.tangential.poisson == pytest.approx(poisson, rel=1e-6)  # digits


def test_response_of_zinc():
    expected = 0.0287281474, 0.0175816604, 0.0194212472, 0.00662338523
    found = ts.TransverseMaterial(*MATERIALS["zinc"]).compliances
    np.testing.assert_allclose(found, expected, rtol=1e-8)  # digits of the expected values


@pytest.mark.parametrize("name", MATERIALS)
def test_response_satisfies_equilibrium(name):
    """Waves (U, i W) exp(i x - q z), with the two roots q of the equations of equilibrium."""
    C11, _, C13, C33, C44 = MATERIALS[name]
    middle = (C13 + C44) ** 2 - C11 * C33 - C44**2
    q = np.sqrt(np.roots([C33 * C44, middle, C11 * C44]).astype(complex))
    U, W = q * (C13 + C44), C11 - C44 * q**2
    np.testing.assert_allclose(q * (C13 + C44) * U, (C33 * q**2 - C44) * W, rtol=1e-10)  # rounding
    shear, normal = -C44 * (q * U + W), 1j * (C13 * U - q * C33 * W)
    by_pressure = np.linalg.solve(np.array([shear, normal]), [0.0, -1.0])
    by_shear = np.linalg.solve(np.array([shear, normal]), [-1.0, 0.0])
    found = 1j * W @ by_pressure, U @ by_shear, abs(U @ by_pressure)
    expected = ts.TransverseMaterial(*MATERIALS[name]).compliances[[0, 1, 3]]
    np.testing.assert_allclose(found, expected, rtol=1e-9)  # rounding


def test_isotropic_stiffness_is_the_isotropic_material():
    material = ts.Material.from_young(208e3, 0.3)
    found = isotropic(208e3, 0.3).compliances
    np.testing.assert_allclose(found, material.compliances, rtol=1e-14)  # rounding


@pytest.mark.parametrize("component", ["xx", "xy", "yy"])
def test_tangential_problem_is_an_isotropic_one(component):
    zinc = ts.TransverseMaterial(*MATERIALS["zinc"])
    pair = ts.LinearHalfSpaces(zinc, zinc)
    like = ts.HalfSpaces(zinc.tangential, zinc.tangential)
    found, expected = (law.coefficients(component, (9, 9), 0.1, 0.2) for law in (pair, like))
    np.testing.assert_allclose(found, expected, atol=1e-14 * abs(expected).max())  # rounding


KEYS = "C11", "C12", "C13", "C33", "C44"
ZINC = dict(zip(KEYS, 1e3 * np.array(MATERIALS["zinc"]), strict=True))
LAYER = {"thickness": 1.0, "young": 1e3, "poisson": 0.3}
ROLLER = {"stiffness": ZINC, "radius_x": 20.0, "radius_y": np.inf}


def test_hertz_contact():
    ball = {"young": 208e3, "poisson": 0.3, "radius_x": 10.0, "radius_y": 10.0}
    scene = ts.Scene(body={"A": ball, "B": ROLLER | {"radius_x": np.inf}}, load={"normal": 10.0})
    steel = 208e3 / (1.0 - 0.3**2)
    modulus = 1.0 / (1.0 / 69618.1333 + 1.0 / steel)
    hertz = ts.Scene(
        body={"A": ball | {"young": 2 * modulus * 0.91}, "B": ball | {"young": 2 * modulus * 0.91}}
        | {"B": ball | {"young": 2 * modulus * 0.91, "radius_x": np.inf, "radius_y": np.inf}},
        load={"normal": 10.0},
    ).hertz
    assert scene.hertz.p0 == pytest.approx(hertz.p0, rel=1e-7)
    assert ts.solve(scene).p_max == pytest.approx(hertz.p0, rel=5e-4)  # 64 elements across


def test_carter():
    """The creepage is (a - c) mu/R times the ratio of tangential to normal compliance."""
    scene = ts.Scene(body={"A": ROLLER, "B": ROLLER}, load={"normal": 100.0}, friction={"mu": 0.3})
    zz, along, _, _ = ts.TransverseMaterial(*MATERIALS["zinc"]).compliances
    xi = -0.3 * 0.5 * scene.hertz.a / 10.0 * along / zz
    contact = ts.solve(scene.replace(**{"creepage.longitudinal": xi}))
    assert not contact.laws.elasticity.coupled
    assert contact.p_max == pytest.approx(scene.hertz.p0, rel=1e-4)  # 512 elements
    assert contact.Qx / 30.0 == pytest.approx(0.75, rel=1e-3)  # stick edge within an element


@pytest.mark.parametrize(
    ("key", "changes"),
    [
        ("stiffness", {"body.A": ROLLER | {"young": 1e5}}),
        ("stiffness", {"body.A": ROLLER | {"poisson": 0.3}}),
        ("stiffness", {"body.A": ROLLER | {"layer": [LAYER]}}),
        ("stiffness.C12", {"body.A.stiffness.C12": 1e6}),
        ("stiffness.C13", {"body.A.stiffness.C13": 1e6}),
        ("stiffness.C33", {"body.A.stiffness.C33": -1.0}),
        ("stiffness.C44", {"body.A.stiffness": {k: v for k, v in ZINC.items() if k != "C44"}}),
        ("stiffness.C22", {"body.A.stiffness.C55": 1e3}),
        ("poisson", {"body.A": {"young": 1e5, "radius_x": 20.0, "radius_y": np.inf}}),
        ("elasticity.law", {"elasticity": {"law": "film_laws:Winkler"}}),
    ],
)
def test_faults_name_the_key(key, changes):
    scene = ts.Scene(body={"A": ROLLER, "B": ROLLER}, load={"normal": 100.0})
    with pytest.raises(ts.SceneError) as error:
        scene.replace(**changes)
    assert key in str(error.value)


@pytest.mark.parametrize("constants", [(1, 2, 0, 1, 1), (1, 0, 0, 1, 0), (1, 0, 1, 1, 1)])
def test_unstable_material(constants):
    with pytest.raises(ValueError, match="stable"):
        ts.TransverseMaterial(*map(float, constants))


def test_scene_round_trips_and_describes():
    scene = ts.Scene(body={"A": ROLLER, "B": ROLLER}, load={"pressure": 500.0})
    assert ts.Scene.from_toml_text(scene.to_toml()) == scene
    assert "69618.1" in str(ts.explain(scene))
    stress = scene.hertz
    assert stress.p0 == pytest.approx(500.0)


def test_material_that_is_stiff_in_shear_has_no_like_isotropic_one():
    """The ratio of tangential compliances is not within the bounds of Poisson's ratio."""
    stiff = {"C11": 1e5, "C12": 0.0, "C13": 0.0, "C33": 1e5, "C44": 1e7}
    body = ROLLER | {"stiffness": stiff}
    scene = ts.Scene(body={"A": body, "B": body}, load={"normal": 10.0})
    assert scene.body.A.material.poisson == -0.99
    hertz = scene.hertz
    assert ts.solve(scene).p_max == pytest.approx(hertz.p0, rel=1e-4)  # 512 elements
