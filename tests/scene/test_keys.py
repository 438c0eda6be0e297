"""Keys are reported by the fields that read them, wherever they are reported."""

import inspect
from keyword import iskeyword
from pathlib import Path

import pytest

import tractive_sam as ts
from tractive_sam.scene.scene import commented_scene
from tractive_sam.schema import Table, key_groups

GROUPS = {name: group for group in key_groups(ts.Scene) for name in group.names}


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
            is_table = not info.description  # it has a separate list
            assert is_table or f"\n{key} : " in kind.__doc__
        assert ">>> " in kind.__doc__


@pytest.mark.parametrize("name", ts.builtin_names())
def test_a_file_to_start_from_is_the_same_scene_with_words(name):
    text = commented_scene(name)
    assert ts.Scene.from_toml_text(text) == ts.Scene.builtin(name)
    meanings = {key.name: key.meaning for key in GROUPS["body.A"].keys}
    assert f"# {meanings['radius_x']}\n" in text or "wheel" in name
    assert {"[[duty]]", "[[transient.stage]]", "[fatigue]"} <= {*text.replace("#", "").split()}


def test_the_file_to_start_from_is_short():
    assert len(commented_scene("rig").splitlines()) <= 45


def test_no_such_scene():
    with pytest.raises(ts.SceneError):
        commented_scene("nonsense")


def tables():
    named = (getattr(ts, name) for name in dir(ts))
    return [one for one in named if isinstance(one, type) and issubclass(one, Table)]


@pytest.mark.parametrize("table", tables(), ids=lambda table: table.__name__)
def test_signatures_list_the_keys_with_defaults(table):
    parameters = inspect.signature(table).parameters
    fields = {name: info for name, info in table.model_fields.items() if not iskeyword(name)}
    assert set(fields) <= set(parameters)
    for name, info in fields.items():
        required = parameters[name].default is inspect.Parameter.empty
        # A study takes its scene without a keyword, too, and reports that it is missing itself.
        assert required == info.is_required() or (issubclass(table, ts.Study) and name == "scene")
        assert "AfterValidator" not in str(parameters[name])


def test_signatures_stay_when_a_table_is_built():
    """The library replaces its own signature with the first object."""
    before = inspect.signature(ts.Friction)
    ts.Friction(mu=0.3)
    assert inspect.signature(ts.Friction) == before
    assert before.parameters["mu"].annotation == float | tuple[float, float]


def test_what_a_signature_accepts_is_accepted():
    """One number for a pair, a dictionary for a table."""
    assert ts.Friction(mu=0.3).mu == (0.3, 0.3)
    assert ts.Wear(coefficient={"A": 1e-4, "B": 0.0}, revolutions=1).coefficient.A == 1e-4


CHECKED = """
import tractive_sam as ts
mu: tuple[float, float] = ts.Friction(mu=0.3).mu
ts.Friction(mu=(0.4, 0.2), angle=45.0)
ts.Friction(law="exponential", static=(0.3, 0.2), kinetic=0.1, half_speed=1e3)
ts.Wear(intensity=1e-5, revolutions=3)
ts.Wear(coefficient=1e-5, revolutions=3)
ts.Wear(coefficient={"A": 1e-5}, revolutions=3)
ts.Mesh(half_length=1.0)
sphere = ts.Body(young=208e3, poisson=0.3, radius_x=10.0, radius_y=10.0)
scene = ts.Scene(body={"A": sphere, "B": sphere}, load=ts.Load(normal=10.0), friction={"mu": 0.3})
force: float = ts.solve(scene).Qx
ts.Scene(bodyy={})  # wrong
ts.Friction(nu=0.3)  # wrong
ts.Friction(mu="0.3")  # wrong
"""


MYPY = """
[mypy]
follow_imports = silent
[mypy-numpy.*,scipy.*,matplotlib.*,h5py.*,xarray.*,dask.*,distributed.*,plotly.*,typer.*,rich.*]
follow_imports = skip
"""
"""What is skipped has no keys, and is most of the work."""


@pytest.mark.slow
def test_type_checkers_know_the_keys(tmp_path, monkeypatch):
    api = pytest.importorskip("mypy.api", reason="mypy is of the extra dev")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MYPYPATH", str(Path(ts.__file__).parents[1]))
    Path("user.py").write_text(CHECKED, "utf-8")
    Path("mypy.ini").write_text(MYPY, "utf-8")
    found, _, status = api.run(["--strict", "user.py"])
    assert status == 1
    faults = [int(line.split(":")[1]) for line in found.splitlines() if "error:" in line]
    wrong = [k for k, line in enumerate(CHECKED.splitlines(), 1) if "# wrong" in line]
    assert faults == wrong, found
