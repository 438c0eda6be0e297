import inspect
import math
import pickle

import numpy as np
import pytest

from tractive_sam.mechanics.elasticity import Material, combine
from tractive_sam.scene import Bodies, Body, Creepage, Friction, Load, Mesh, Scene, Subsurface, Wear
from tractive_sam.schema import SceneError, SceneWarning

BALL = {"young": 208e3, "poisson": 0.3, "radius_x": 10.0, "radius_y": 10.0}
PLATE = {"shear": 80e3, "poisson": 0.3, "radius_x": math.inf, "radius_y": math.inf}


def test_built_in_python():
    scene = Scene(
        body={"A": Body(**BALL), "B": PLATE},
        load=Load(normal=300),
        creepage=Creepage(longitudinal=-0.005),
        friction=Friction(mu=0.3),
    )
    assert scene == Scene(
        body=Bodies(A=BALL, B=Body(**PLATE)),
        load={"normal": 300.0},
        creepage={"longitudinal": -0.005},
        friction={"mu": (0.3, 0.3)},
    )
    assert type(scene.load.normal) is float


def test_defaults(spheres):
    assert spheres.title == ""
    assert spheres.creepage == Creepage() == Creepage(longitudinal=0, lateral=0, spin=0)
    assert spheres.friction.angle == 0
    assert spheres.wear is spheres.grid is spheres.gap is spheres.subsurface is None
    assert (spheres.solver.method, spheres.solver.slip, spheres.solver.tolerance) == (
        "auto",
        "auto",
        1e-8,
    )
    assert spheres.body.A.hardness == 1


def test_none_means_not_given(tables):
    assert Scene(**tables, wear=None, solver=None, creepage=None) == Scene(**tables)
    assert Load(normal=1.0, approach=None) == Load(normal=1.0)


def test_wear_saves_start_and_end_by_default():
    wear = Wear(intensity=1e-6, revolutions=70)
    assert wear.save == (0, 70)
    assert (wear.stepping, wear.tolerance) == ("adaptive", 1e-3)
    assert Wear(intensity=1e-6, revolutions=70, save=[3]).save == (3,)


def test_numpy_numbers_and_vectors():
    friction = Friction(mu=np.array([0.4, 0.2]), angle=np.float32(45))
    assert friction == Friction(mu=[0.4, 0.2], angle=45)
    wear = Wear(intensity=0, revolutions=np.int64(9), save=np.arange(0, 10, 3))
    assert wear.save == (0, 3, 6, 9)
    assert Mesh(half_length=[1, np.float64(2)], elements=[np.int32(9), 11]).elements == (9, 11)


def test_immutable_hashable_picklable(spheres):
    with pytest.raises(AttributeError, match=r"scene\.replace"):
        spheres.load.normal = 3.0
    assert hash(spheres) == hash(Scene(**spheres.entries()))
    assert pickle.loads(pickle.dumps(spheres)) == spheres


def test_a_path_in_place_of_keywords():
    with pytest.raises(TypeError, match="from_toml"):
        Scene("scene.toml")


def test_signature_reports_the_keys():
    for table in (Load, Scene):
        assert list(inspect.signature(table).parameters) == list(table.model_fields)


def test_materials(spheres):
    assert spheres.materials == {"A": Material(1.0, 0.28), "B": Material(1.0, 0.28)}
    assert spheres.material == combine(*spheres.materials.values())
    assert Body(**BALL).material.shear == pytest.approx(80e3)


def test_hertz_by_load_and_by_approach(spheres):
    by_load = spheres.hertz
    assert by_load.load == spheres.load.normal
    by_approach = spheres.replace(**{"load.approach": by_load.approach}).hertz
    assert by_approach.load == pytest.approx(by_load.load)


def test_combined_radii():
    bodies = Bodies(A=BALL, B=PLATE | {"radius_y": -12.0})
    assert bodies.radii == pytest.approx((10.0, 60.0))


def test_subsurface_defaults():
    stress = Subsurface(planes=["y=0"])
    assert (stress.depth, stress.elements, stress.bodies) == (1.5, 64, ("A", "B"))


@pytest.mark.parametrize(
    ("elements", "advice"),
    [([91, 5], "10 in y"), ([5, 5], "10 in x.*10 in y"), ([3, 5], r"grid\.half_length")],
)
def test_coarse_grid_warns_once_where_it_was_requested(tables, elements, advice):
    grid = {"half_length": [4.2, 4.2], "elements": elements}
    with pytest.warns(SceneWarning, match=rf"grid\.elements.*{advice}") as record:
        Scene(**tables, grid=grid)
    assert len(record) == 1
    assert record[0].filename == __file__


def test_advised_grid_is_fine_enough(tables):
    Scene(**tables, grid={"half_length": [4.2, 4.2], "elements": [10, 10]})


def test_large_contact_warns_with_its_ratios(tables):
    """By each body's own radius, too: a ball in its socket has a large combined one."""
    with pytest.warns(SceneWarning, match=r"a/R_x = 0\.\d.*b/R_y = 0\.\d"):
        Scene(**tables | {"load": {"normal": 4e4}})
    tables["body"]["B"] |= {"radius_x": -340.0, "radius_y": -340.0}
    with pytest.warns(SceneWarning, match=r"a/R_x"):
        Scene(**tables | {"load": {"normal": 500.0}})


def test_error_survives_another_process():
    with pytest.raises(SceneError) as caught:
        Body(young=-1)
    assert pickle.loads(pickle.dumps(caught.value)).faults == caught.value.faults


def discs(radius_A, radius_B, **wear):
    steel = {"young": 208e3, "poisson": 0.3, "radius_y": 30.0}
    return Scene(
        body={"A": steel | {"radius_x": radius_A}, "B": steel | {"radius_x": radius_B}},
        load={"normal": 1.0},
        friction={"mu": 0.3},
        wear={"intensity": 1e-6, "revolutions": 3} | wear,
    )


@pytest.mark.parametrize("radii", [(10.0, 200.0), (-40.0, 10.0), (10.0, math.inf)])
@pytest.mark.parametrize("wear", [{}, {"turns": "equal"}])
def test_warns_of_bodies_that_come_round_unequally_often(radii, wear):
    with pytest.warns(SceneWarning, match=r"wear\.turns"):
        discs(*radii, **wear)
    discs(*radii, turns="each")  # as is meant: no warning
    discs(30.0, 31.0, **wear)  # nearly alike


def test_turns_of_two_flat_bodies_cannot_be_counted():
    with pytest.raises(SceneError, match=r"wear\.turns"):
        discs(math.inf, math.inf)


def test_what_is_given_and_what_holds_anyway_are_the_same_scene():
    scene = Scene.builtin("spheres")
    reported = scene.replace(**{"friction.angle": 0.0, "solver.method": "auto"})
    assert reported.entries() != scene.entries()
    assert reported.settings() == scene.settings()
    assert reported == scene
    assert reported.fingerprint() == scene.fingerprint()
    negative = scene.replace(**{"creepage.lateral": -0.0})
    assert negative.fingerprint() == scene.fingerprint()


def test_fingerprints_differ_as_scenes_do():
    scene = Scene.builtin("spheres")
    assert scene.replace(title="Others").fingerprint() == scene.fingerprint()
    x = [-1.0, 0.0, 1.0]
    flat = {"x": x, "y": x, "separation": np.zeros((3, 3))}
    changes = [
        {"friction.angle": 1.0},
        {"creepage.lateral": -0.05},
        {"creepage.lateral": 0.05},
        {"gap": flat},
        {"gap": flat | {"separation": np.eye(3)}},
        {"gap": flat | {"x": [-1.0, 0.0, 2.0]}},
    ]
    found = {scene.replace(**change).fingerprint() for change in changes}
    assert len(found | {scene.fingerprint()}) == len(changes) + 1


def test_whole_numbers_may_be_written_with_a_power():
    wear = Wear(intensity=1e-6, revolutions=1e4, save=[0, 1e3])
    assert (wear.revolutions, wear.save) == (10_000, (0, 1000))
    assert isinstance(wear.revolutions, int)
