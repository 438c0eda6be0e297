import math

import pytest

from tractive_sam.scene import Scene, builtin_names
from tractive_sam.schema import SceneError


@pytest.mark.parametrize("name", builtin_names())
def test_valid_and_round_trips(name):
    scene = Scene.builtin(name)
    assert scene.title
    assert scene.hertz is not None
    assert Scene.from_toml_text(scene.to_toml()) == scene


def test_names():
    assert {
        "spheres",
        "spheres-orthotropic",
        "twin-discs",
        "twin-discs-isotropic",
        "spheres-dissimilar",
        "spin",
    } <= set(builtin_names())


@pytest.mark.parametrize(
    ("name", "published"),
    [("spheres", 3.499981), ("twin-discs", 0.28066), ("twin-discs-isotropic", 0.21651)],
)
def test_contact_of_the_paper(name, published):
    assert Scene.builtin(name).hertz.a == pytest.approx(published, rel=2e-5)


def test_friction_of_the_paper():
    assert Scene.builtin("spheres").friction.mu == (0.4013, 0.4013)
    assert Scene.builtin("spheres-orthotropic").friction.mu == (0.4, 0.2)
    discs = Scene.builtin("twin-discs")
    assert discs.friction.mu == (0.6, 0.3)
    assert discs.wear.save == (0, 50, 250, 1000, 4000, 15000)
    # the condition of the energy law of wear: i1/mu1 = i2/mu2
    (i1, i2), (mu1, mu2) = discs.wear.intensity, discs.friction.mu
    assert math.isclose(i1 / mu1, i2 / mu2)


def test_unlike_materials_couple():
    assert Scene.builtin("spheres-dissimilar").material.coupling > 0


def test_unknown_name():
    with pytest.raises(SceneError, match=r"twin-discs\b"):
        Scene.builtin("twin-disk")
