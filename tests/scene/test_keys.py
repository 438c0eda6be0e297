"""Keys are told by the fields that read them, wherever they are told."""

import pytest

import tractive_sam as ts
from tractive_sam.scene.keys import groups
from tractive_sam.scene.starter import starter
from tractive_sam.scene.table import Table

GROUPS = {name: group for group in groups(ts.Scene) for name in group.names}


def test_every_entry_of_the_built_in_scenes_is_a_key():
    def entries(tables, *path):
        for name, value in tables.items():
            if isinstance(value, dict):
                yield from entries(value, *path, name)
            else:
                yield ".".join(path), name

    for name in ts.builtin_names():
        for table, key in entries(ts.Scene.builtin(name).entries()):
            assert key in {one.name for one in GROUPS[table].keys}, (table, key)


def test_every_key_has_its_words():
    for group in GROUPS.values():
        for key in group.keys:
            assert key.meaning, key
            assert key.allowed, key
            assert key.default, key


def test_help_lists_the_keys():
    for kind in (ts.Load, ts.Wear, ts.Body, ts.Friction, ts.Solver):
        assert issubclass(kind, Table)
        for key, info in kind.model_fields.items():
            is_table = not info.description  # it has a list of its own
            assert is_table or f"\n{key} : " in kind.__doc__
        assert ">>> " in kind.__doc__


@pytest.mark.parametrize("name", ts.builtin_names())
def test_a_file_to_start_from_is_the_same_scene_with_words(name):
    text = starter(name)
    assert ts.Scene.from_toml_text(text) == ts.Scene.builtin(name)
    for table in ("body.A", "load", "wear", "solver"):
        for key in GROUPS[table].keys:
            assert f"{key.meaning}: {key.allowed}" in text


def test_no_such_scene():
    with pytest.raises(ts.SceneError):
        starter("nonsense")
