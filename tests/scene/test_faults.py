import copy
import math

import numpy as np
import pytest

from tractive_sam.scene import Body, Load, Scene
from tractive_sam.schema import Fault, SceneError

WEAR = {"intensity": 1e-6, "revolutions": 100}


def faults_of(tables):
    with pytest.raises(SceneError) as caught:
        Scene(**tables)
    return caught.value.faults


def put(tables, key, value):
    *path, last = key.split(".")
    for name in path:
        tables = tables.setdefault(name, {})
    tables[last] = value


# key, wrong value, words that must be in the fault
ENTRIES = [
    ("title", 5, "a text"),
    ("body.A.shear", -1, "above 0"),
    ("body.A.shear", "1.0", "above 0"),
    ("body.A.shear", True, "above 0"),
    ("body.A.shear", np.True_, "above 0"),
    ("body.A.shear", math.inf, "finite"),
    ("body.A.shear", math.nan, "finite"),
    ("body.A.shear", 1e-40, "1e-30"),
    ("body.A.shear", 10**400, "above 0"),
    ("body.A.shear", [1.0], "above 0"),
    ("body.A.shear", 1j, "above 0"),
    ("body.A.poisson", 0.51, "0 to 0.5"),
    ("body.A.poisson", -0.1, "0 to 0.5"),
    ("body.A.hardness", 0, "above 0"),
    ("body.A.radius_x", 0, "other than 0"),
    ("body.A.radius_x", -math.inf, "inf (flat)"),
    ("body.A.radius_y", math.nan, "inf (flat)"),
    ("body.A.radius_y", "flat", "inf (flat)"),
    ("body.A", 7, "a table with the keys young"),
    ("load", [1], "a table with the keys normal"),
    ("load.normal", 0, "above 0"),
    ("load.normal", -3.0, "above 0"),
    ("load.force_x", math.inf, "finite"),
    ("creepage.longitudinal", "slow", "a number"),
    ("creepage.spin", math.nan, "finite"),
    ("friction.mu", -0.1, "above 0"),
    ("friction.mu", True, "above 0"),
    ("friction.mu", [0.3, -0.3], "a pair"),
    ("friction.mu", [0.3, 0.3, 0.3], "a pair"),
    ("friction.mu", [0.4, 0.4e-4], "at most 100 times the other"),
    ("friction.mu", [0.003, 0.4], "at most 100 times the other"),
    ("friction.angle", 400, "-360 to 360"),
    ("friction.strength", 0.0, "above 0"),
    ("friction.layer", -1e-5, "at least 0"),
    ("friction.law", "falling", '"rational" or "polach"'),
    ("friction.kinetic", 0.1, 'law = "exponential"'),
    ("creepage.speed", 0.0, "above 0"),
    ("wear.intensity", -1e-6, "at least 0"),
    ("wear.revolutions", 0, "from 1"),
    ("wear.revolutions", 1.5, "integer"),
    ("wear.save", [], "ascending"),
    ("wear.save", [0, 5, 5], "ascending"),
    ("wear.save", [-1, 5], "ascending"),
    ("wear.save", [0, 101], "at most 100"),
    ("wear.stepping", "fast", "every-revolution"),
    ("wear.tolerance", 0.2, "0.1"),
    ("grid.half_length", [1, 0], "a pair"),
    ("grid.half_length", 5.0, "a pair"),
    ("grid.elements", [2, 9], "from 3"),
    ("grid.elements", [9.0, 9], "integer"),
    ("gap.file", 5, "path"),
    ("subsurface.planes", [], "planes"),
    ("subsurface.planes", ["w=0"], "planes like"),
    ("subsurface.planes", ["z=-1"], "depth"),
    ("subsurface.planes", ["y=0", "y=0.0"], "once"),
    ("subsurface.depth", 0, "above 0"),
    ("subsurface.elements", 1, "from 2"),
    ("subsurface.bodies", [], "list"),
    ("subsurface.bodies", ["C"], "list"),
    ("subsurface.bodies", ["A", "A"], "once"),
    ("solver.method", "magic", "anderson"),
    ("solver.slip", "central", "upwind"),
    ("solver.tolerance", 0.1, "1e-13"),
]


@pytest.mark.parametrize(("key", "value", "words"), ENTRIES)
def test_faulty_entry(tables, key, value, words):
    tables["wear"] = WEAR.copy()
    tables["grid"] = {"half_length": [4.2, 4.2], "elements": [21, 21]}
    tables["subsurface"] = {"planes": ["y=0"]}
    put(tables, key, value)
    (fault,) = faults_of(tables)
    assert fault.key == key
    assert words in fault.allowed
    assert not {"pydantic", "http", "validation"} & set(str(fault).lower().split())


@pytest.mark.parametrize(
    ("key", "nearest"),
    [("laod", "load"), ("body.A.yuong", "young"), ("friction.angel", "angle"), ("body.C", None)],
)
def test_unknown_key(tables, key, nearest):
    put(tables, key, {} if key == "body.C" else 1)
    fault = faults_of(tables)[0]
    assert fault.key == key
    assert fault.allowed.startswith("one of " if nearest is None else f"{nearest}, perhaps?")


def test_an_entry_without_its_table(tables):
    put(tables, "normal", 300.0)
    (fault,) = faults_of(tables)
    assert fault.key == "normal"
    assert fault.allowed.startswith("load.normal, perhaps?")


@pytest.mark.parametrize(
    "key", ["body", "load", "body.B", "body.A.poisson", "body.B.radius_y", "friction.mu"]
)
def test_missing_entry(tables, key):
    *path, last = key.split(".")
    table = tables
    for name in path:
        table = table[name]
    del table[last]
    (fault,) = faults_of(tables)
    assert (fault.key, fault.given) == (key, "nothing")


def test_neither_of_two_alternatives(tables):
    del tables["body"]["A"]["shear"], tables["load"]["normal"]
    assert {fault.key for fault in faults_of(tables)} == {"body.A.young", "load.normal"}


def test_both_of_two_alternatives(tables):
    tables["body"]["A"]["young"] = 3.0
    tables["load"] |= {"approach": 0.1, "force_x": 0.0, "force_y": 0.0}
    tables["creepage"] = {"longitudinal": 0.0, "lateral": 0.0, "spin": 0.1}
    faults = faults_of(tables)
    assert all("only one of" in fault.allowed for fault in faults)
    assert [fault.key for fault in faults] == [
        "body.A.young",
        "load.normal",
        "load.force_x",
        "load.force_y",
    ]


def test_traction_leaves_the_other_creepages_free(tables):
    tables["load"]["force_x"] = 0.05
    tables["creepage"] = {"lateral": 0.001, "spin": 0.1}
    assert Scene(**tables).load.force_x == 0.05


def test_traction_and_wear_need_friction(tables):
    del tables["friction"]
    tables["load"] |= {"force_x": 0.1, "force_y": 0.1}
    tables["wear"] = WEAR
    faults = faults_of(tables)
    assert {f.key for f in faults} == {"load.force_x", "load.force_y", "wear"}
    assert all("[friction]" in fault.allowed for fault in faults)


FALLING = {"law": "rational", "static": 0.4, "kinetic": 0.2, "half_speed": 50.0}


@pytest.mark.parametrize(
    ("changes", "key", "words"),
    [
        ({"kinetic": 0.41}, "friction.kinetic", "at most the coefficient at rest, 0.4"),
        ({"kinetic": -0.1}, "friction.kinetic", "above 0"),
        ({"kinetic": [0.2, 0.1]}, "friction.kinetic", "in the ratio"),
        ({"kinetic": None}, "friction.kinetic", "kinetic"),
        ({"half_speed": 0.0}, "friction.half_speed", "above 0"),
        ({"A": 0.4, "B": 0.6}, "friction.A, B", "kinetic and half_speed"),
        ({"mu": 0.4}, "friction.mu", "only one of"),
        ({"law": "polach", "A": 0.5}, "friction.A", "or A and B"),
        ({"memory": -1.0}, "friction.memory", "at least 0"),
        ({"start": "top"}, "friction.start", '"rest" or "sliding"'),
    ],
)
def test_laws_that_cannot_be(tables, changes, key, words):
    tables["creepage"] = {"speed": 100.0}
    tables["friction"] = FALLING
    Scene(**tables)
    tables["friction"] = FALLING | changes
    (fault,) = faults_of(tables)
    assert fault.key == key
    assert words in fault.allowed


def test_a_law_of_speed_needs_the_speed(tables):
    tables["friction"] = FALLING
    (fault,) = faults_of(tables)
    assert fault.key == "creepage.speed"
    assert "friction.law" in fault.allowed


LIMIT = 0.5 * math.hypot(0.4, 0.2) / math.sqrt(2)  # P mu_eff of mu = (0.4, 0.2) at 45 degrees


@pytest.mark.parametrize("key", ["load.force_x", "load.force_y"])
@pytest.mark.parametrize("sign", [-1, 1])
def test_more_than_friction_carries_along_one_axis(tables, key, sign):
    tables["friction"]["angle"] = 45.0
    put(tables, key, sign * LIMIT * 0.9999)
    Scene(**tables)
    put(tables, key, sign * LIMIT * 1.0001)
    (fault,) = faults_of(tables)
    assert fault.key == key
    assert "friction can carry at most" in fault.allowed
    assert f"{LIMIT:.6g}" in fault.allowed


def test_more_than_friction_carries_with_both_forces_known(tables):
    """Each force can be had alone, but not the two together."""
    tables["load"] |= {"force_x": 0.19, "force_y": 0.09}
    (fault,) = faults_of(tables)
    assert fault.key == "load.force_x, load.force_y"
    assert "friction can carry at most" in fault.allowed
    tables["load"] |= {"force_x": 0.19, "force_y": 0.03}
    Scene(**tables)


def test_friction_limit_is_unknown_for_a_given_approach(tables):
    tables["load"] = {"approach": 0.01, "force_x": 1e6}
    Scene(**tables)


@pytest.mark.parametrize(
    ("radii", "words"),
    [
        ({"A.radius_x": math.inf, "B.radius_x": math.inf}, "radius_x"),
        ({"A.radius_y": -337.5}, "or both inf (a line contact)"),
        ({"B.radius_x": -300.0}, "concave body must have the larger radius"),
    ],
)
def test_bodies_that_cannot_touch(tables, radii, words, tmp_path):
    for key, value in radii.items():
        put(tables, f"body.{key}", value)
    (fault,) = faults_of(tables)
    name = next(iter(radii)).split(".")[1]
    assert fault.key == f"body.A.{name}, body.B.{name}"
    assert words in fault.allowed
    gap = {"x": [0, 1], "y": [0, 1], "separation": [[0, 1], [1, 2]]}
    assert Scene(**tables, gap=gap).hertz is None


def test_hollow_that_fits(tables):
    tables["body"]["B"]["radius_x"] = -400.0
    contact = Scene(**tables).hertz
    assert contact.a > contact.b


def test_grid_too_small(tables):
    contact = Scene(**tables).hertz
    tables["grid"] = {"half_length": [3.0, 3.2], "elements": [21, 21]}
    in_x, in_y = faults_of(tables)
    assert in_x.key == in_y.key == "grid.half_length"
    least = float(in_y.allowed.split()[2])
    assert contact.b <= least < contact.b * 1.0001
    tables["grid"]["half_length"] = [least, least]
    Scene(**tables)


def test_with_a_gap_the_grid_is_not_compared_with_hertz(tables):
    tables["grid"] = {"half_length": [0.1, 0.1], "elements": [3, 3]}
    tables["gap"] = {"x": [0, 1], "y": [0, 1], "separation": np.zeros((2, 2))}
    Scene(**tables)


def test_all_faults_at_once(tables):
    """A faulty body hides neither the other tables nor what can be judged without it."""
    tables["body"]["A"]["shear"] = -1
    tables["body"]["A"]["radius_x"] = tables["body"]["B"]["radius_x"] = math.inf
    tables["load"]["force_x"] = 0.3
    tables["friction"]["angle"] = 1e3
    tables["grid"] = {"half_length": [-1, 1], "elements": [21, 21]}
    tables["solvr"] = {}
    tables["wear"] = {"intensity": 1e-6, "revolutions": 0.5}
    assert [fault.key for fault in faults_of(tables)] == [
        "solvr",
        "body.A.shear",
        "friction.angle",
        "wear.revolutions",
        "grid.half_length",
        "body.A.radius_x, body.B.radius_x",
    ]


def test_faulty_entry_does_not_stop_the_checks_of_others(tables):
    tables["body"]["A"]["young"] = "soft"
    tables["load"]["force_x"] = 0.3
    assert [fault.key for fault in faults_of(tables)] == [
        "body.A.young",
        "body.A.young",  # and it excludes the shear modulus
        "load.force_x",
    ]


def test_needles(tables):
    """The influence coefficients of longer elements lose their digits."""
    tables["grid"] = {"half_length": [5.0, 1e8], "elements": [11, 11]}
    (fault,) = faults_of(tables)
    assert fault.key == "grid.half_length"
    assert "times as long as wide" in fault.allowed


@pytest.mark.filterwarnings("ignore::tractive_sam.schema.SceneWarning")  # few elements
def test_a_contact_too_slender_for_a_chosen_grid(tables):
    tables["body"]["A"]["radius_y"] = tables["body"]["B"]["radius_y"] = 1e9
    (fault,) = faults_of(tables)
    assert "a line contact" in fault.allowed
    Scene(**tables, grid={"half_length": [1.0, 1e5], "elements": [40, 40]})


def test_error_reads_as_a_list():
    error = SceneError([Fault("a.b", "1", "2"), Fault("c", "3", "4")])
    assert str(error).splitlines() == [
        "2 faults in the scene:",
        "  a.b: given 1; allowed: 2",
        "  c: given 3; allowed: 4",
    ]
    assert str(SceneError([Fault("a", "1", "2")])).startswith("1 fault in the scene")


def test_parts_fail_by_themselves_with_their_own_keys():
    with pytest.raises(SceneError) as caught:
        Body(young=-1, poisson=0.3, radius_x=1.0, radius_y=1.0)
    assert [fault.key for fault in caught.value.faults] == ["young"]
    with pytest.raises(SceneError):
        Load.model_validate({"normal": -1})


def test_given_tables_are_left_unchanged(tables):
    before = copy.deepcopy(tables)
    Scene(**tables).with_set(["load.approach=0.1"])
    assert tables == before


def test_a_key_by_its_earlier_name_is_reported_the_new_one():
    tables = Scene.builtin("spheres").entries()
    tables["load"]["traction_x"] = 0.1
    (fault,) = faults_of(tables)
    assert (fault.key, "force_x" in fault.allowed) == ("load.traction_x", True)


@pytest.mark.parametrize(
    ("entries", "cure"),
    [
        ({"body.B.radius_y": "inf"}, "number inf without quotes"),
        ({"load.normal": "300"}, "number 300 without quotes"),
        ({"load.normal": " 1234567.89"}, "number 1234567.89 without quotes"),
        ({"load.normal": "three hundred"}, None),
        ({"load.normal": "-300"}, None),  # nor would the number do
    ],
)
def test_a_text_that_would_do_as_a_number(entries, cure):
    with pytest.raises(SceneError) as caught:
        Scene.builtin("twin-discs").replace(**entries)
    (fault,) = caught.value.faults
    assert cure in fault.allowed if cure else "quotes" not in fault.allowed


def test_zero_friction_is_a_frictionless_contact():
    scene = Scene.builtin("spheres")
    assert scene.with_set(["friction.mu=0"]) == scene.replace(friction=None)
