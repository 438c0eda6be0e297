from pathlib import Path

import numpy as np
import pytest

from tractive_sam.scene import Gap, Scene
from tractive_sam.schema import SceneError

ARRAYS = {"x": [0.0, 1.0, 3.0], "y": np.array([-1, 1]), "separation": np.ones((3, 2))}


def test_arrays_are_kept_read_only():
    separation = np.ones((3, 2))
    gap = Gap(x=[0, 1, 3], y=[-1, 1], separation=separation)
    separation[0, 0] = 7
    assert gap.separation[0, 0] == 1
    assert gap.x.dtype == float
    with pytest.raises(ValueError, match="read-only"):
        gap.x[0] = 5


def test_equality_and_hash():
    one, same = Gap(**ARRAYS), Gap(**ARRAYS)
    other = Gap(**ARRAYS | {"separation": np.zeros((3, 2))})
    assert one == same
    assert hash(one) == hash(same)
    assert one != other
    assert one != "gap"


@pytest.mark.parametrize("kind", [list, tuple, np.array])
def test_a_profile_is_the_same_all_along(kind):
    gap = Gap(y=[-1, 0, 1], separation=kind([0.0, 1.0, 0.5]), body="A")
    assert gap.x[0] <= -1e5 < 1e5 <= gap.x[1]
    np.testing.assert_array_equal(gap.separation, [[0.0, 1.0, 0.5]] * 2)


@pytest.mark.parametrize(
    "profile", [["a", "b"], [None, 1.0], [1.0, np.nan], np.ma.masked_equal([1.0, 2.0], 2.0), [1.0]]
)
def test_what_is_no_profile(profile):
    with pytest.raises(SceneError) as caught:
        Gap(y=[0, 1], separation=profile)
    assert {fault.key for fault in caught.value.faults} == {"separation"}


def test_scene_with_arrays_round_trips(spheres):
    scene = spheres.replace(gap=Gap(**ARRAYS))
    assert Scene.from_toml_text(scene.to_toml()) == scene


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"x": None}, "x"),
        ({"x": [0.0, 1.0]}, "separation"),
        ({"x": [0.0, 2.0, 1.0]}, "x"),
        ({"y": [1.0]}, "y"),
        ({"y": [[1.0, 2.0]]}, "y"),
        ({"y": ["1", "2"]}, "y"),
        ({"y": [True, False]}, "y"),
        ({"separation": np.full((3, 2), np.nan)}, "separation"),
        ({"separation": [[1.0], [1.0, 2.0], [1.0]]}, "separation"),
        ({"separation": 3.0}, "separation"),
        ({"file": __file__}, "file"),
    ],
)
def test_faulty_arrays(change, key):
    with pytest.raises(SceneError) as caught:
        Gap(**ARRAYS | change)
    assert {fault.key for fault in caught.value.faults} == {key}


def test_neither_file_nor_arrays():
    with pytest.raises(SceneError, match=r"file.*x.*y.*separation"):
        Gap()


@pytest.mark.parametrize("name", ["missing.npy", "profile.pdf", "a\0b.npy", "x" * 5000 + ".npy"])
def test_faulty_file(tmp_path, name):
    (tmp_path / "profile.pdf").touch()
    with pytest.raises(SceneError) as caught:
        Gap(file=str(tmp_path / name))
    assert [fault.key for fault in caught.value.faults] == ["file"]


def test_file_is_sought_next_to_the_scene(tmp_path, spheres):
    (tmp_path / "profile.csv").touch()
    path = tmp_path / "scene.toml"
    path.write_text(spheres.to_toml() + '\n[gap]\nfile = "profile.csv"\n', encoding="utf-8")
    scene = Scene.from_toml(path)
    assert scene.gap.file == tmp_path / "profile.csv"
    assert Scene.from_toml_text(scene.to_toml()) == scene


def test_file_is_the_same_seen_from_another_folder(tmp_path, spheres, monkeypatch):
    (tmp_path / "profile.csv").touch()
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path)
    given = [
        spheres.replace(gap=Gap(file="profile.csv")),
        spheres.replace(gap={"file": Path("profile.csv")}),
        spheres.with_set(["gap.file=profile.csv"]),
    ]
    monkeypatch.chdir(tmp_path / "elsewhere")
    for scene in given:
        assert scene.gap.file == tmp_path / "profile.csv"
        assert Scene.from_toml_text(scene.to_toml()) == scene


def test_setting_a_file_removes_the_arrays(tmp_path, spheres):
    path = tmp_path / "profile.npy"
    path.touch()
    scene = spheres.replace(gap=Gap(**ARRAYS))
    assert scene.replace(**{"gap.file": path}).gap == Gap(file=path)
    assert scene.replace(gap={"file": str(path)}).gap == Gap(file=path)
