"""Faults and descriptions of scenes with bodies that relax."""

import pytest

import tractive_sam as ts

SCENE = ts.Scene.builtin("rubber-roller")
TERM = {"ratio": 1.0, "time": 0.01}
COURSE = {"distance": [0.0, 5.0], "load": {"normal": [4.0, 5.0]}}
LAYER = {"thickness": 5.0, "young": 10.0, "poisson": 0.4}


@pytest.mark.parametrize(
    ("key", "changes"),
    [
        ("body.A.relaxation[0].ratio", {"body.A.relaxation": [{"time": 0.01}]}),
        ("body.A.relaxation[0].time", {"body.A.relaxation": [{"ratio": 1.0}]}),
        ("body.A.relaxation[0].ratio", {"body.A.relaxation": [TERM | {"ratio": -0.5}]}),
        ("body.A.relaxation[0].ratio", {"body.A.relaxation": [TERM | {"ratio": float("nan")}]}),
        ("body.A.relaxation[0].time", {"body.A.relaxation": [TERM | {"time": 0.0}]}),
        ("body.A.relaxation[0].time", {"body.A.relaxation": [TERM | {"time": float("inf")}]}),
        ("body.A.relaxation[0].time", {"body.A.relaxation": [TERM | {"time": "fast"}]}),
        ("time, in s", {"body.A.relaxation": [TERM | {"tau": 0.1}]}),
        ("body.A.relaxation[0].of", {"body.A.relaxation": [TERM | {"of": "creep"}]}),
        ("body.A.relaxation[1].of", {"body.A.relaxation": [TERM, TERM | {"of": "modulus"}]}),
        ("body.A.relaxation[0].ratio", {"body.A.relaxation": [TERM | {"of": "modulus"}]}),
        ("body.A.relaxation", {"body.A.relaxation": []}),
        ("body.A.relaxation", {"body.A.relaxation": "rubber"}),
        ("creepage.speed", {"creepage": {"longitudinal": -0.01}}),
        ("load.pressure", {"load": {"pressure": 3.0}}),
        ("elasticity.law", {"elasticity": {"law": "film_laws:Winkler"}}),
    ],
)
def test_faults_name_the_key(key, changes):
    with pytest.raises(ts.SceneError) as error:
        SCENE.replace(**changes)
    assert key in str(error.value)


def test_relaxation_of_a_wheel_is_refused():
    wheel = ts.Scene.builtin("wheel-rail")
    with pytest.raises(ts.SceneError, match=r"body\.B\.relaxation"):
        wheel.replace(**{"body.B.relaxation": [TERM]})


def test_tables_scale_elastic_contacts_only():
    scene = SCENE.replace(**{"body.B.radius_y": 100.0})
    with pytest.raises(ts.TableError, match=r"scene\.body"):
        ts.TableDesign(scene=scene, axis=[{"key": "friction.mu", "values": [0.3, 0.5]}])


def test_relaxation_in_toml_and_by_key():
    assert ts.Scene.from_toml_text(SCENE.to_toml()) == SCENE
    slower = SCENE.with_set(["body.A.relaxation[0].time=0.02"])
    assert slower.body.A.relaxation[0].time == 0.02
    assert slower.fingerprint() != SCENE.fingerprint()


def test_explanation_states_terms_and_modulus():
    text = str(ts.explain(SCENE))
    assert "relaxation of A" in text
    assert "0.4 of the modulus" in text
