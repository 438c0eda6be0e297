"""Faults and descriptions of scenes with layers."""

import pytest

import tractive_sam as ts

SCENE = ts.Scene.builtin("coated-roller")
LAYER = {"thickness": 0.1, "young": 3e3, "poisson": 0.4}
WEAR = {"coefficient": 1e-4, "revolutions": 5}
STRESS = {"planes": ["y=0"]}


@pytest.mark.parametrize(
    ("key", "changes"),
    [
        ("body.A.layer[0].thickness", {"body.A.layer": [LAYER | {"thickness": 0.0}]}),
        ("body.A.layer[0].thickness", {"body.A.layer": [LAYER | {"thickness": -1.0}]}),
        ("body.A.layer[0].thickness", {"body.A.layer": [LAYER | {"thickness": float("inf")}]}),
        ("body.A.layer[0].thickness", {"body.A.layer": [LAYER | {"thickness": "thin"}]}),
        ("body.A.layer[0].thickness", {"body.A.layer": [{"young": 3e3, "poisson": 0.4}]}),
        ("body.A.layer[0].poisson", {"body.A.layer": [LAYER | {"poisson": 0.6}]}),
        ("body.A.layer[0].poisson", {"body.A.layer": [{"young": 3e3, "thickness": 0.4}]}),
        ("young", {"body.A.layer": [{"thickness": 0.1, "poisson": 0.4}]}),
        ("shear", {"body.A.layer": [LAYER | {"shear": 1e3}]}),
        ("body.A.layer[0].young", {"body.A.layer": [LAYER | {"young": 0.0}]}),
        ("body.A.layer[1].young", {"body.A.layer": [LAYER, LAYER | {"young": 1e10}]}),
        ("body.A.layer[0].young", {"body.A.layer": [LAYER | {"young": 1e-3}]}),
        ("body.A.layer[1].thickness", {"body.A.layer": [LAYER, LAYER | {"thickness": 1e-7}]}),
        ("body.A.layer", {"body.A.layer": []}),
        ("body.A.layer", {"body.A.layer": "steel"}),
        ("hardness", {"body.A.layer": [LAYER | {"hardness": 3.0}]}),
        ("body.A.layer[0].gradient", {"body.A.layer": [LAYER | {"gradient": "linear"}]}),
        ("depth", {"body.A.layer": [LAYER | {"depth": 3.0}]}),
        ("load.pressure", {"load": {"pressure": 100.0}}),
        ("shear_compliance", {"body.A.layer": [LAYER | {"shear_compliance": -1e-6}]}),
        ("normal_compliance", {"body.A.layer": [LAYER | {"normal_compliance": float("inf")}]}),
        ("normal_compliance", {"body.A.layer": [LAYER | {"normal_compliance": "glue"}]}),
        ("shear_compliance", {"body.A.layer": [LAYER | {"compliance": 1e-6}]}),
        ("wear.layer_step", {"wear": WEAR | {"layer_step": 0.0}}),
        ("wear.layer_step", {"wear": WEAR | {"layer_step": 0.7}}),
        ("wear.layer_step", {"wear": WEAR | {"layer_step": 0.1}, "body.A.layer": None}),
        (
            "wear.layer_step",
            {
                "wear": {"layer_step": 0.1, "law": {"A": "usfd"}, "revolutions": 5},
                "creepage.speed": 1e3,
            },
        ),
        ("elasticity.law: given with body.A.layer", {"elasticity": {"law": "film_laws:Winkler"}}),
    ],
)
def test_faults_name_the_key(key, changes):
    with pytest.raises(ts.SceneError) as error:
        SCENE.replace(**changes)
    assert key in str(error.value)


def test_layers_of_a_wheel_are_refused():
    wheel = ts.Scene.builtin("wheel-rail")
    with pytest.raises(ts.SceneError, match=r"body\.B\.layer"):
        wheel.replace(**{"body.B.layer": [LAYER]})


def test_stress_of_the_other_body_is_allowed():
    scene = SCENE.replace(subsurface=STRESS | {"bodies": ["B"]})
    assert scene.subsurface.bodies == ("B",)


def test_layers_in_toml_and_by_key():
    assert ts.Scene.from_toml_text(SCENE.to_toml()) == SCENE
    softer = SCENE.with_set(["body.A.layer[0].young=1000"])
    assert softer.body.A.layer[0].young == 1000.0
    assert softer.fingerprint() != SCENE.fingerprint()
    assert softer.hertz.a > SCENE.hertz.a


def test_explain_lists_the_layers():
    text = str(ts.explain(SCENE))
    assert "layer 0 of A" in text
    assert "equivalent modulus" in text
    glued = SCENE.replace(**{"body.A.layer[0].shear_compliance": 1e-5})
    assert "springs with 1e-05 and 0" in str(ts.explain(glued))


def test_a_layer_of_the_same_material_on_springs_is_a_layer():
    steel = {"thickness": 0.1, "young": 208e3, "poisson": 0.3}
    plain, glued = (
        SCENE.replace(**{"body.A.layer": [steel | springs]})
        for springs in ({}, {"normal_compliance": 1e-6})
    )
    assert not plain.body.is_layered
    assert glued.body.is_layered
    assert glued.hertz.a > plain.hertz.a


def test_estimated_contact_lies_between_those_of_both_materials():
    stiff, soft = (
        SCENE.replace(**{"body.A.layer": None}),
        SCENE.replace(**{"body.A.layer": None, "body.A.young": 3.6e3, "body.A.poisson": 0.4}),
    )
    assert stiff.hertz.a < SCENE.hertz.a < soft.hertz.a


def test_graded_layer_is_softer_than_a_hard_one_on_a_soft_body():
    hard = {"thickness": 0.5, "young": 2e6, "poisson": 0.3}
    plain, graded = (
        SCENE.replace(**{"body.A.layer": [hard | {"gradient": gradient}]})
        for gradient in ("none", "exponential")
    )
    assert plain.hertz.a < graded.hertz.a < SCENE.replace(**{"body.A.layer": None}).hertz.a
    assert "graded" in str(ts.explain(graded))
