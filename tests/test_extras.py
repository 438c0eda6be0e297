"""Packages of extras: if one is missing, the message names the extra and its command."""

import re
import sys
import tomllib
from pathlib import Path

import pytest
from typer.testing import CliRunner

import tractive_sam as ts
from tractive_sam.cli import app
from tractive_sam.extras import EXTRAS, require_extra

SCENE = ts.Scene.builtin("cylinders").replace(subsurface=None)
CALLS = {
    "to_xarray": ("xarray", lambda history: history.to_xarray()),
    "to_dataframe": ("pandas", lambda history: history.to_dataframe()),
    "jacobian": ("xarray", lambda history: ts.solve(history.scene, jacobian=True)),
    "solve_many": ("xarray", lambda history: ts.solve_many(SCENE, {"load.normal": [1.0]})),
    "write_fmu": ("fmpy", lambda history: ts.write_fmu(ts.open_table("steel"), "steel.fmu")),
    "report": ("plotly", lambda history: ts.report(history, "page.html")),
}


@pytest.fixture(scope="module")
def history():
    return ts.roll(SCENE)


def remove(monkeypatch, package):
    for name in {package, *(one for one in sys.modules if one.startswith(f"{package}."))}:
        monkeypatch.setitem(sys.modules, name, None)


@pytest.mark.parametrize("purpose", CALLS)
def test_a_missing_package_is_reported_with_the_command_that_installs_it(
    history, purpose, monkeypatch, tmp_path
):
    package, call = CALLS[purpose]
    monkeypatch.chdir(tmp_path)
    remove(monkeypatch, package)
    with pytest.raises(ImportError) as caught:
        call(history)
    assert caught.value.name == package
    for part in (purpose, package, f"'.[{EXTRAS[package]}]'"):
        assert part in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_commands_end_with_the_message(history, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    remove(monkeypatch, "fmpy")
    ended = CliRunner().invoke(app, ["table", "steel", "--fmu", "steel.fmu"])
    assert ended.exit_code == 2
    assert "'.[fmu]'" in " ".join(ended.output.split())


def test_other_imports_keep_their_error():
    with pytest.raises(ModuleNotFoundError, match="nonexistent"), require_extra("test"):
        import nonexistent  # noqa: F401, PLC0415


def test_extras_are_those_of_the_project():
    project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text("utf-8"))
    extras = project["project"]["optional-dependencies"]
    for package, extra in EXTRAS.items():
        names = {re.split(r"[^a-z0-9]", one)[0] for one in extras[extra]}
        # distributed comes with dask, and pandas with xarray
        assert {"distributed": "dask", "pandas": "xarray"}.get(package, package) in names
