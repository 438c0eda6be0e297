"""Tables of residual stress and strength over the depth: files, alternatives, and faults."""

import warnings

import pytest

import tractive_sam as ts
from tractive_sam.schema import SceneWarning
from tractive_sam.studies import cases

SPHERES = ts.Scene.builtin("spheres")
LIMIT = {"sensitivity": 0.3, "limit": 250.0}
PROFILE = {"depth": [0.0, 0.2, 1.0], "xx": [-300.0, -150.0, 0.0], "yy": [-300.0, -150.0, 0.0]}
RULE = {"sensitivity": 0.3, "bodies": ("A",)}
CASE = {"depth": [0.0, 0.5, 1.0], "hardness": [720.0, 600.0, 380.0], "inclusion": 30.0}


def faults(**tables):
    with pytest.raises(ts.SceneError) as error:
        SPHERES.replace(**{"subsurface": None, "fatigue": None} | tables)
    return [fault.key for fault in error.value.faults]


@pytest.mark.parametrize(
    ("table", "key"),
    [
        ({}, "depth"),
        ({"depth": [0.0, 1.0]}, "xx"),
        ({"xx": [1.0, 2.0]}, "depth"),
        ({"depth": [], "xx": []}, "depth"),
        (PROFILE | {"depth": [0.0, 1.0, 0.5]}, "depth"),
        (PROFILE | {"depth": [0.0, 0.2, 0.2]}, "depth"),
        (PROFILE | {"depth": [-0.1, 0.2, 0.5]}, "depth"),
        (PROFILE | {"depth": 0.2}, "depth"),
        (PROFILE | {"xx": [1.0, 2.0]}, "xx"),
        (PROFILE | {"yy": [1.0, 2.0, 3.0, 4.0]}, "yy"),
        (PROFILE | {"xx": [-300e6, 0.0, 0.0]}, "xx"),
        (PROFILE | {"xx": [float("nan"), 0.0, 0.0]}, "xx"),
        (PROFILE | {"xx": ["a", 0.0, 0.0]}, "xx"),
        (PROFILE | {"zz": [0.0, 0.0, 0.0]}, "zz"),
        (PROFILE | {"from": "rolling"}, "from"),
        (PROFILE | {"pressure": 1000.0}, "pressure"),
        ({"from": "peening"}, "from"),
        ({"from": "rolling", "pressure": -1.0}, "pressure"),
        ({"from": "rolling"}, "from"),  # without a yield stress
        ({"file": "no-such-file.csv"}, "file"),
        ({"file": "profile.xlsx"}, "file"),
        ({"file": 3}, "file"),
        (PROFILE | {"file": "profile.csv"}, "file"),
    ],
)
def test_a_fault_of_residual_stress(table, key):
    assert f"residual.A.{key}" in faults(residual={"A": table})


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"A": {}}, "A.hardness"),
        ({"A": {"depth": [0.0, 1.0]}}, "A.hardness"),
        ({"A": {"hardness": [700.0]}}, "A.depth"),
        ({"A": CASE | {"hardness": [60.0, 58.0, 40.0]}}, "A.hardness"),  # HRC
        ({"A": CASE | {"hardness": [7e3, 6e3, 4e3]}}, "A.hardness"),  # MPa
        ({"A": CASE | {"hardness": [720.0, 600.0]}}, "A.hardness"),
        ({"A": CASE | {"inclusion": None}}, "A.inclusion"),
        ({"A": CASE | {"inclusion": -30.0}}, "A.inclusion"),
        ({"A": CASE | {"limit": [400.0, 300.0, 0.0]}}, "A.limit"),
        ({"A": CASE | {"shear_yield": [900.0, 700.0]}}, "A.shear_yield"),
        ({"A": {"depth": [0.0], "limit": [300.0], "inclusion": 30.0}}, "A.inclusion"),
        ({"A": CASE, "bodies": ["B"]}, "A"),
        ({"A": CASE, "limit": None}, "limit"),  # B has none
        ({"A": {"depth": [0.0], "shear_yield": [300.0]}}, "shear_yield"),  # B has none
        ({"A": CASE, "criterion": "fatemi-socie"}, "shear_yield"),
        ({"A": [1.0]}, "A"),
        ({"A": CASE | {"vickers": [700.0]}}, "A.vickers"),
    ],
)
def test_a_fault_of_strength(changes, key):
    table = {name: value for name, value in (LIMIT | changes).items() if value is not None}
    assert f"fatigue.{key}" in faults(fatigue=table)


def test_rolling_needs_a_contact_of_radii():
    gap = {"x": [-1, 1], "y": [-1, 1], "separation": [[0, 0], [0, 0]]}
    table = {"fatigue": {"shear_yield": 300.0}, "residual": {"A": {"from": "rolling"}}}
    assert "residual.A.from" in faults(gap=gap, **table)


def test_rolling_needs_homogeneous_bodies():
    layer = {"thickness": 0.01, "young": 3.0, "poisson": 0.2}
    table = {"fatigue": {"shear_yield": 300.0}, "residual": {"A": {"from": "rolling"}}}
    assert "residual.A.from" in faults(**{"body.A.layer": [layer]}, **table)


def write(path, text):
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_a_file_gives_the_same_scene_as_its_numbers(tmp_path):
    file = write(
        tmp_path / "profile.csv", "depth [um],xx [GPa],yy\n0,-0.3,-300\n200,-0.15,-150\n1000,0,0\n"
    )
    read = SPHERES.replace(residual={"A": {"file": file}})
    assert read.residual.A.xx == pytest.approx(PROFILE["xx"])
    assert read.residual.A.depth == pytest.approx(PROFILE["depth"])
    given = SPHERES.replace(residual={"A": {k: getattr(read.residual.A, k) for k in PROFILE}})
    assert read.fingerprint() == given.fingerprint()
    write(tmp_path / "profile.csv", "depth,xx\n0,-100\n1,0\n")
    assert SPHERES.replace(residual={"A": {"file": file}}).fingerprint() != read.fingerprint()
    again = ts.Scene.from_toml_text(read.to_toml())
    assert again.fingerprint() == read.fingerprint()


def test_a_traverse_in_a_scale_of_vickers(tmp_path):
    file = write(
        tmp_path / "traverse.txt", "depth [mm]; hardness [HV0.5]\n0,1; 720\n0,5; 600\n1,0; 380\n"
    )
    table = LIMIT | {"A": {"file": file, "inclusion": 30.0}, "bodies": ["A"]}
    assert SPHERES.replace(fatigue=table).fatigue.A.hardness == (720.0, 600.0, 380.0)


@pytest.mark.parametrize(
    "text",
    [
        "depth,stress\n0,1\n1,2\n",
        "xx,yy\n0,1\n1,2\n",
        "depth,depth\n0,1\n1,2\n",
        "0,1\n1,2\n",
        "depth,xx\n0,1\n1,\n",
        "depth,xx\n0,one\n1,2\n",
        "depth [s],xx\n0,1\n1,2\n",
        "depth,xx [mm]\n0,1\n1,2\n",
        "",
    ],
)
def test_a_file_that_is_no_profile(tmp_path, text):
    file = write(tmp_path / "profile.csv", text)
    assert "residual.A.file" in faults(residual={"A": {"file": file}})


def test_depths_of_a_file_must_ascend(tmp_path):
    file = write(tmp_path / "profile.csv", "depth,xx\n1,1\n0,2\n")
    assert "residual.A.depth" in faults(residual={"A": {"file": file}})


def test_a_relative_path_starts_at_the_folder_of_the_scene(tmp_path):
    write(tmp_path / "profile.csv", "depth,xx\n0,-100\n1,0\n")
    text = SPHERES.to_toml() + '\n[residual.A]\nfile = "profile.csv"\n'
    scene = ts.Scene.from_toml(write(tmp_path / "scene.toml", text))
    assert scene.residual.A.xx == (-100.0, 0.0)


def test_one_source_takes_the_place_of_the_other(tmp_path):
    file = write(tmp_path / "profile.csv", "depth,xx\n0,-100\n1,0\n")
    arrays = SPHERES.replace(residual={"A": PROFILE}, fatigue={"shear_yield": 3000.0})
    rolled = arrays.with_set(['residual.A.from="rolling"'])
    assert rolled.residual.A.depth is None
    assert rolled.with_set([f"residual.A.file='{file}'"]).residual.A.xx == (-100.0, 0.0)
    assert (
        rolled.replace(**{f"residual.A.{k}": v for k, v in PROFILE.items()}).residual.A.is_rolled
        is False
    )


def test_a_study_varies_files(tmp_path):
    names = [write(tmp_path / f"{k}.csv", f"depth,xx\n0,{-100 * k}\n1,0\n") for k in (1, 2)]
    study = ts.Study(scene="spheres", axis=[{"key": "residual.A.file", "values": names}])
    assert [case.scene.residual.A.xx[0] for case in cases(study)] == [-100.0, -200.0]


def test_limits_and_yield_stress_follow_from_hardness():
    scene = SPHERES.replace(fatigue={"sensitivity": 0.3, "A": CASE, "B": CASE})
    assert scene.fatigue.limit == pytest.approx(1.56 * 840.0 / 30.0 ** (1 / 6) * 0.6)
    assert scene.fatigue.yield_stress == pytest.approx(2.876 * 720.0 - 90.7)
    # Without the sensitivity there is no limit, but there is shakedown.
    bare = SPHERES.replace(fatigue={"A": CASE, "bodies": ["A"]})
    assert bare.fatigue.limit is None
    assert bare.fatigue.shear_yield_stress is not None


def test_soft_steel_needs_no_inclusion():
    soft = {"depth": [0.0], "hardness": [300.0]}
    scene = SPHERES.replace(fatigue={"sensitivity": 0.0, "A": soft, "B": soft})
    assert scene.fatigue.limit == pytest.approx(0.5 * 1.6 * 300.0)


def test_it_is_described(capsys):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SceneWarning)
        scene = SPHERES.replace(
            fatigue=LIMIT | {"A": CASE, "shear_yield": 900.0}, residual={"A": PROFILE}
        )
    text = str(ts.explain(scene))
    assert "-300" in text
    assert "720" in text
    assert "hardness over the depth" not in text
    assert "residual stress" not in str(ts.explain(SPHERES))


@pytest.mark.parametrize(
    ("tables", "key"),
    [
        ({"residual": {"A": PROFILE}}, "residual.A"),
        (
            {"residual": {"A": PROFILE}, "subsurface": {"planes": ("y=0",), "bodies": ("B",)}},
            "residual.A",
        ),
        ({"residual": {"A": PROFILE}, "subsurface": {"planes": ("y=0",), "bodies": ("A",)}}, None),
        ({"fatigue": RULE | {"A": CASE}}, None),
        # The limit does not depend on an inclusion this small, or where it is given.
        ({"fatigue": RULE | {"A": CASE | {"inclusion": 0.01}}}, "fatigue.A.inclusion"),
        ({"fatigue": RULE | {"A": CASE | {"limit": [3e2] * 3}}}, "fatigue.A.inclusion"),
    ],
)
def test_data_on_which_no_column_depends(tables, key):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        SPHERES.replace(**{"subsurface": None, "fatigue": None} | tables)
    assert [str(w.message).split(":")[0] for w in caught] == ([key] if key else [])
