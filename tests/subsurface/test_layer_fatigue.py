"""Fatigue by the material of each layer: limits in which it is known, interfaces, and wear."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

import tractive_sam as ts
from tests.scenes import interrupted
from tractive_sam.contact import Laws
from tractive_sam.mechanics import HalfSpaces, hertz
from tractive_sam.results import BodyFatigue
from tractive_sam.rolling.body_damage import damage_remark, stressed_volume
from tractive_sam.rolling.process import StoredStep
from tractive_sam.schema import SceneWarning
from tractive_sam.studies import cases
from tractive_sam.subsurface import cycle_depths

STEEL = {"young": 208e3, "poisson": 0.3}
COVER = {"thickness": 0.05, "young": 60e3, "poisson": 0.35}
SAME = STEEL | {"thickness": 0.05}
TABLE = {"sensitivity": 0.3, "limit": 500.0, "bodies": ["A"], "elements": 9}
K = {"shear_yield": 900.0}


def balls(layers, tables, scale=1.0, **changes):
    """A small point contact; `tables` are those of fatigue.A.layer, or None."""
    size = scale * hertz(208e3 / 2 / 0.91, 10.0, 10.0, load=300.0).a
    ball = STEEL | {"radius_x": 20.0 * scale, "radius_y": 20.0 * scale}
    layers = [layer | {"thickness": scale * layer["thickness"]} for layer in layers]
    fatigue = TABLE | changes.pop("fatigue", {})
    scene = {
        "body": {"A": ball | ({"layer": layers} if layers else {}), "B": ball},
        "load": {"normal": 300.0 * scale**2},
        "grid": {"half_length": [1.3 * size, 1.6 * size], "elements": [11, 13]},
        "friction": {"mu": 0.2},
        "creepage": {"longitudinal": 2e-3, "lateral": 1e-3},
        "fatigue": fatigue if tables is None else fatigue | {"A": {"layer": tables}},
    }
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SceneWarning)  # above shakedown
        return ts.Scene(**scene | changes)


def test_equal_materials_in_all_layers_are_one_material_bit_for_bit():
    life = {"cycles": 1e7, "exponent": 10.0, "knee": False}
    layered = ts.solve(balls([SAME, SAME], [K | {"limit": 500.0} | life] * 2, fatigue=K))
    depths = cycle_depths(layered)
    one = ts.fatigue(ts.solve(balls([SAME, SAME], None, fatigue=K)), depths=depths)["A"]
    many = ts.fatigue(layered, depths=depths)["A"]
    for name in ("utilisation", "residual_shear", "path_radius"):
        assert np.array_equal(getattr(one, name), getattr(many, name)), name
    assert one.shakedown_lower == many.shakedown_lower
    assert one.shakedown_upper == many.shakedown_upper


def test_a_weaker_layer_of_the_same_elasticity_is_a_limit_in_steps():
    face = SAME["thickness"]
    weak = K | {"limit": 200.0, "shear_yield": 400.0}
    layered = ts.solve(balls([SAME], [weak], fatigue=K))
    depths = cycle_depths(layered)
    assert face in depths
    assert depths[np.searchsorted(depths, face) + 1] == face * (1.0 + 1e-9)
    steps = {
        "depth": [0.0, face, face * (1.0 + 1e-9), 1.0],
        "limit": [200.0, 200.0, 500.0, 500.0],
        "shear_yield": [400.0, 400.0, 900.0, 900.0],
    }
    expected = ts.fatigue(ts.solve(balls([], None, fatigue=K | {"A": steps})), depths=depths)["A"]
    found = ts.fatigue(layered, depths=depths)["A"]
    assert found.local_limit == pytest.approx(expected.local_limit, rel=1e-12)  # rounding
    assert found.utilisation == pytest.approx(expected.utilisation, rel=1e-12)
    for bound in ("shakedown_lower", "shakedown_upper"):
        # Parabolas through the same values; the interface is a depth of both.
        assert getattr(found, bound) == pytest.approx(getattr(expected, bound), rel=1e-12)
    assert found.local_layer[0].tolist() == [float(depth > face) for depth in depths]
    each = [found.largest(layer=k) for k in (0, 1)]
    assert max(each, key=lambda top: top.value).value == found.utilisation_max
    assert [top.at[2] <= face for top in each] == [True, False]
    assert np.isnan(found.largest(layer=2).value)
    assert np.isnan(each[1].surface)
    with pytest.raises(ValueError, match="no strengths of layers"):
        expected.largest(layer=0)


def test_stress_of_the_stored_contact_gives_the_utilisation_on_both_sides():
    """The amplitude of sigma_xz by `stress_at`, over the limit of each side; it is continuous."""
    table = {"criterion": "orthogonal-shear", "sensitivity": None}
    contact = ts.solve(balls([COVER], [{"limit": 100.0}], fatigue=table))
    fatigue = ts.fatigue(contact)["A"]
    above = int(np.searchsorted(fatigue.depth, COVER["thickness"]))
    row = fatigue.y.size // 2
    for side, limit in ((above, 100.0), (above + 1, 500.0)):
        place = float(fatigue.y[row]), float(fatigue.depth[side])
        shear = ts.stress_at(contact, [(x, *place) for x in contact.grid.x], body="A")[:, 4]
        # Both sum over the same elements; the sums are ordered differently.
        used = 0.5 * np.ptp(shear) / limit
        assert fatigue.utilisation[row, side] == pytest.approx(used, rel=1e-6)
    stress = fatigue.utilisation * fatigue.local_limit
    # Tractions are continuous: to the error of the fit, 3e-4 of the largest stress.
    assert np.abs(stress[:, above] - stress[:, above + 1]).max() < 3e-4 * stress.max()
    assert (
        np.ptp(fatigue.utilisation[row, above : above + 2]) > 0.5 * fatigue.utilisation[row, above]
    )


def test_lengths_in_other_units_change_nothing():
    first, large = (
        ts.fatigue(ts.solve(balls([COVER], [K | {"limit": 150.0}], scale, fatigue=K)))["A"]
        for scale in (1.0, 1000.0)
    )
    assert large.depth == pytest.approx(1000.0 * first.depth, rel=1e-12)
    # Newton's method ends at 1e-8 of the tractions.
    assert large.utilisation == pytest.approx(first.utilisation, rel=1e-6)


def test_the_mirror_image_is_the_mirror_image():
    first, other = (
        ts.fatigue(ts.solve(balls([SAME], [K | {"limit": 150.0}], fatigue=K, creepage=motion)))["A"]
        for motion in ({"longitudinal": 2e-3, "lateral": side} for side in (1e-3, -1e-3))
    )
    # Newton's method ends at 1e-8 of the tractions.
    for name in ("utilisation", "residual_shear", "path_radius"):
        mirrored = getattr(other, name)[::-1]
        assert getattr(first, name) == pytest.approx(mirrored, rel=1e-6), name


WEAR = {"intensity": 5e-7, "revolutions": 400, "save": [400]}


def damage_of(layer, below, wear=WEAR, cover=SAME, **changes):
    fatigue = {"limit": below, "tolerance": 1.0, "elements": 8}
    return ts.roll(balls([cover], [layer], fatigue=fatigue, wear=wear, **changes))


def test_each_layer_has_the_damage_of_a_body_of_its_material():
    """Also while it wears: nothing of the other side of the interface enters."""
    life = {"cycles": 1e6, "exponent": 4.0}
    mixed, upper, lower = (
        damage_of({"limit": limit} | curve, below)
        for limit, curve, below in ((300.0, life, 500.0), (300.0, life, 300.0), (500.0, {}, 500.0))
    )
    zeta, face = mixed.fatigue("A").zeta, SAME["thickness"]
    found, weak, strong = (h.fatigue("A").damage for h in (mixed, upper, lower))
    # Slopes between both sides of the interface, 1e-9 apart, have rounding errors of 1e-7.
    assert found[:, zeta <= face] == pytest.approx(weak[:, zeta <= face], rel=1e-6)
    assert found[:, zeta > face] == pytest.approx(strong[:, zeta > face], rel=1e-6)
    assert mixed["failing_layer"][-1, 0] == mixed["utilisation_layer"][-1, 0] == 0.0
    assert np.isnan(mixed["failing_layer"][-1, 1])  # body B is not evaluated
    assert mixed["fatigue_life"][-1, 0] == pytest.approx(upper["fatigue_life"][-1, 0], rel=1e-6)


def test_nothing_is_interpolated_across_an_interface_where_all_layers_have_one_strength():
    strength = {"limit": 300.0, "tolerance": 1.0, "elements": 8} | K
    common, stated = (
        ts.roll(balls([COVER], tables, fatigue=strength, wear=WEAR))
        for tables in (None, [K | {"limit": 300.0}])
    )
    for name in ("damage", "utilisation", "fatigue_life", "shakedown_lower"):
        assert np.array_equal(common[name], stated[name], equal_nan=True), name
    assert np.array_equal(common.fatigue("A").damage, stated.fatigue("A").damage)


def test_the_stressed_volume_of_layers_is_that_of_their_stress():
    scene = balls([COVER], None, fatigue=K | {"volume": {"slope": 1.5}})
    history = ts.roll(scene)
    found = stressed_volume(history.fatigue("A"), scene, ts.VolumeLife(slope=1.5))
    assert history["stressed_volume"][0, 0] == pytest.approx(found, rel=1e-12)  # rounding


def test_a_file_with_one_profile_through_all_layers_resumes_as_one_with_a_profile_of_each(
    tmp_path, monkeypatch
):
    """Earlier versions stored one: it has both sides of each interface, and nothing is lost."""
    wear = WEAR | {"revolutions": 5, "save": [5]}
    scene = balls([COVER], None, fatigue={"tolerance": 1.0, "elements": 8}, wear=wear)
    path, state_of = tmp_path / "run.h5", StoredStep.state_of
    interrupted(scene, path, 2)

    def earlier(step, observer):
        stored = state_of(step, observer)
        state = {name: stored[name] for name in step.state_under(observer.name)}
        for name in ("utilisation_A", "utilisation_before_A"):
            depth = state["depth_A"]
            assert state[name].shape[-1] == 2 * depth.size
            upper, lower = np.split(state[name], 2, axis=-1)
            state[name] = np.where(depth <= COVER["thickness"], upper, lower)
        return state

    monkeypatch.setattr(StoredStep, "state_of", earlier)
    resumed, straight = ts.roll(scene, path, resume=True), ts.roll(scene)
    for name in ("damage", "utilisation", "fatigue_life"):
        assert np.array_equal(resumed[name], straight[name], equal_nan=True), name
    assert np.array_equal(resumed.fatigue("A").damage, straight.fatigue("A").damage)


@pytest.mark.parametrize("layers", [[], [COVER]])
def test_wear_without_a_fatigue_limit_resumes(layers, tmp_path):
    """Without a fatigue limit, there is no damage: the stored one is nan."""
    wear, path = WEAR | {"revolutions": 3, "save": [3]}, tmp_path / "run.h5"
    scene = balls(layers, None, fatigue=K | {"limit": None, "elements": 8}, wear=wear)
    interrupted(scene, path, 2)
    resumed, straight = ts.roll(scene, path, resume=True), ts.roll(scene)
    assert resumed.finished
    assert np.array_equal(resumed["shakedown_lower"], straight["shakedown_lower"], equal_nan=True)


@pytest.mark.slow
def test_worn_layers_take_their_material_along_and_runs_resume(tmp_path):
    """In steps of half of a cover of .3 micrometres, until it is worn through."""
    thin = COVER | {"thickness": 3e-4}
    wear = WEAR | {"intensity": 1e-6, "layer_step": 0.5, "revolutions": 900, "save": [900]}
    tables, fatigue = [{"limit": 100.0}], {"limit": 900.0, "tolerance": 1.0, "elements": 8}
    scene = balls([thin], tables, fatigue=fatigue, wear=wear)
    path = tmp_path / "run.h5"
    interrupted(scene, path, 11)
    history = ts.roll(scene, path, resume=True)
    straight = ts.roll(scene)
    for name in ("damage", "utilisation", "failing_layer", "fatigue_life"):
        assert np.array_equal(history[name], straight[name], equal_nan=True), name
    after = history.fatigue("A")
    assert after.worn.max() > thin["thickness"]
    assert not (after.local_layer == 0.0).any()
    assert history["utilisation_layer"][[0, -1], 0].tolist() == [0.0, 1.0]
    assert after.local_limit.min() == 900.0
    # The surface is that of the body below: the damage of the cover went with it.
    assert history["damage"][-1, 0] < history["damage"][:, 0].max()


def test_a_run_with_another_law_of_elasticity_resumes(tmp_path):
    fatigue = {"limit": 300.0, "tolerance": 1.0, "elements": 8}
    scene = balls([COVER], None, fatigue=fatigue, wear=WEAR)
    laws = replace(Laws.of_package(scene), elasticity=HalfSpaces(**scene.materials))
    interrupted(scene, tmp_path / "run.h5", 3, laws=laws)
    resumed = ts.roll(scene, tmp_path / "run.h5", resume=True, laws=laws)
    assert np.array_equal(resumed["damage"], ts.roll(scene, laws=laws)["damage"], equal_nan=True)


def test_an_extreme_curve_is_reported_without_a_warning():
    zeta = np.array([0.0, 1e-3, 1.001e-3, 1.0])
    damage = np.array([[1e9, 1e9, 1e3, 1.0]])
    none = np.zeros((1, 4))
    fatigue = BodyFatigue("A", np.zeros(1), zeta, none, none, none, None, 300.0)
    top, at = fatigue.with_damage(zeta, damage, np.full(1, 1e-4)).damage_max
    assert np.isfinite(top)
    assert top > 1e200
    assert at[2] == 1e-4
    remark = damage_remark({"A": fatigue.with_damage(zeta, damage, np.full(1, 1e-4))})
    assert "gives no life" in remark
    assert damage_remark({"A": fatigue}) == ""


def test_a_course_has_the_material_of_its_layers():
    course = {"distance": [0.0, 0.05], "start": "steady"}
    tables = [{"limit": 250.0, "cycles": 1e5, "exponent": 5.0}]
    one, layered = (
        ts.roll(balls([SAME], each, transient=course, fatigue={"elements": 8}))
        for each in ([{"limit": 500.0}], tables)
    )
    of_one, of_layers = (history.fatigue("A") for history in (one, layered))
    inside = of_layers.local_layer[0] == 0.0
    used = of_layers.utilisation[:, inside]
    factor = np.where(of_layers.local_layer == 0.0, 2.0, 1.0)  # of the limits
    assert of_layers.utilisation == pytest.approx(factor * of_one.utilisation, rel=1e-12)
    assert of_layers.damage[:, inside] == pytest.approx(1e-5 * used**5, rel=1e-12)
    assert of_layers.damage[:, ~inside] == pytest.approx(of_one.damage[:, ~inside], rel=1e-12)
    assert layered["failing_layer"][-1, 0] in (0.0, 1.0)


@pytest.mark.parametrize(
    ("tables", "changes", "key"),
    [
        ([{"limit": 1.0}] * 2, {}, "A.layer"),
        ([], {}, "A.layer"),
        ([{}], {}, "A.layer[0].limit"),
        ([{"shear_yield": 30.0}], {}, "A.layer[0].limit"),
        ([{"limit": 30.0}], K, "A.layer[0].shear_yield"),
        ([{"limit": 30.0, "shear_yield": 20.0}], {}, "shear_yield"),
        ([{"limit": -1.0}], {}, "A.layer[0].limit"),
        ([{"limit": float("nan")}], {}, "A.layer[0].limit"),
        ([{"limit": 30.0, "hardness": 300.0}], {}, "A.layer[0].hardness"),
        ([{"limit": 30.0, "inclusion": 30.0}], {}, "A.layer[0].inclusion"),
        ([{"hardness": 60.0}], K, "A.layer[0].hardness"),  # HRC
        ([{"hardness": 700.0}], K, "A.layer[0].inclusion"),
        ([{"limit": 30.0, "curve": 3.0}], {}, "A.layer[0].curve"),
        ([{"limit": 30.0, "sensitivity": 0.2}], {}, "A.layer[0].sensitivity"),
        ([{"limit": 30.0, "exponent": 101.0}], {}, "A.layer[0].exponent"),
        ([{"limit": 30.0, "cycles": 0.0}], {}, "A.layer[0].cycles"),
        ([{"limit": 30.0, "knee": "no"}], {}, "A.layer[0].knee"),
        ([{"limit": 30.0}], {"volume": {}}, "volume"),
        ([{"limit": 30.0}], {"bodies": ["B"]}, "A"),
        ([{"limit": 30.0}], {"B": {"layer": [{"limit": 3.0}]}, "bodies": ["A", "B"]}, "B.layer"),
    ],
)
def test_a_fault_of_the_strength_of_layers(tables, changes, key):
    with pytest.raises(ts.SceneError) as error:
        balls([COVER], tables, fatigue=changes)
    assert f"fatigue.{key}" in [fault.key for fault in error.value.faults]


def test_a_study_varies_the_limit_of_a_layer():
    scene = balls([COVER], [{"limit": 30.0}])
    axis = {"key": "fatigue.A.layer[0].limit", "values": [20.0, 200.0]}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SceneWarning)
        varied = [
            case.scene.fatigue.A.layer[0].limit
            for case in cases(ts.Study(scene=scene, axis=[axis]))
        ]
    assert varied == [20.0, 200.0]


def test_without_layers_their_strength_is_a_fault():
    with pytest.raises(ts.SceneError, match="body A has no layers"):
        balls([], [{"limit": 30.0}])


def test_hardness_gives_a_layer_its_strength():
    layer = ts.LayerStrength(hardness=700.0, inclusion=30.0)
    case = ts.Strength(depth=[0.0], hardness=[700.0], inclusion=30.0)
    found, expected = layer.find_values("dang-van", 0.3), case.find_curves("dang-van", 0.3)
    assert found == {name: float(expected[name][0]) for name in ("limit", "shear_yield")}


def test_a_duty_cycle_and_criteria_with_a_yield_stress_have_layers():
    blocks = [{"revolutions": 3}, {"revolutions": 1, "load": {"normal": 400.0}}]
    tables = [K | {"limit": 300.0, "shear_yield": 500.0}]
    fatigue = K | {"criterion": "fatemi-socie", "tolerance": 1.0, "elements": 8}
    wear = WEAR | {"revolutions": 40, "save": [40]}
    history = ts.roll(balls([SAME], tables, fatigue=fatigue, duty=blocks, wear=wear))
    assert history.finished
    heavy, light = (history.block(k)["utilisation"][-1, 0] for k in (1, 0))
    assert history["utilisation"][-1, 0] == heavy > light
