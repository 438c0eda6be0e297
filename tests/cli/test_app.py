import re
import subprocess
import sys
from importlib.metadata import version

import pytest
import typer

from tractive_sam.cli.program import app
from tractive_sam.cli.scene_input import complete_creep_tables
from tractive_sam.scene import Scene, builtin_names


def test_scenes(call):
    lines = call("scenes").stdout.splitlines()
    assert [line.split()[0] for line in lines] == list(builtin_names())
    for name, line in zip(builtin_names(), lines, strict=True):
        assert Scene.builtin(name).title in line


def test_explain(call):
    result = call("explain", "spheres", "--set", "title='Kept [as is]'")
    assert result.exit_code == 0
    assert "Kept [as is]" in result.stdout
    assert "the scene has no [wear]" in result.stdout


def test_explain_bad_input(call):
    assert call("explain", "nonsense").exit_code == 2


def test_version(call):
    for option in ("--version", "-V"):
        assert call(option).stdout.strip() == f"tractive-sam {version('tractive-sam')}"


@pytest.mark.parametrize(
    "arguments", [["--help"], *([name, "-h"] for name in ("run", "show", "plot"))]
)
def test_help(call, arguments):
    result = call(*arguments)
    assert result.exit_code == 0
    assert "Usage" in result.stdout


def test_help_shows_names_in_brackets(call, monkeypatch):
    """Brackets are markup in help texts, unless they are escaped."""
    monkeypatch.setenv("COLUMNS", "400")  # no line breaks
    commands = typer.main.get_command(app).commands
    seen = []
    for name in commands:
        callback = commands[name].callback
        names = re.findall(r"\[+[a-z.]+\]+", callback.__doc__.replace("\n", " "))
        shown = call(name, "--help").stdout
        seen += [text for text in names if text in shown]
        assert [text for text in names if text not in shown] == []
    assert "[[fit.test]]" in seen


@pytest.mark.slow
def test_module_is_the_program():
    result = subprocess.run(
        [sys.executable, "-m", "tractive_sam", "show", "missing.h5"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 2
    assert "missing.h5 does not exist" in result.stderr


def test_keys(call):
    everything, wear = call("keys").stdout, call("keys", "wear").stdout
    for table in ("[body.A], [body.B]", "[load]", "[wear]", "[subsurface]"):
        assert table in everything
    assert "mm3/(N m)" in wear
    assert "adaptive" in wear
    assert "[load]" not in wear
    result = call("keys", "waer")
    assert result.exit_code == 2
    assert "wear, perhaps" in result.stderr
    assert "fault" not in result.stderr


def test_a_table_that_is_not_there(call):
    result = call("table", "nosuch", "--header", "x.h")
    assert result.exit_code == 2
    assert "steel" in result.stderr
    assert "nosuch" in result.stderr


def test_a_scene_to_start_from(call, folder):
    assert call("scenes", "--write", "cylinders").stdout.split() == ["cylinders.toml"]
    assert Scene.from_toml("cylinders.toml") == Scene.builtin("cylinders")
    written = (folder / "cylinders.toml").read_bytes()
    assert call("scenes", "--write", "cylinders").exit_code == 2
    assert (folder / "cylinders.toml").read_bytes() == written
    assert call("scenes", "--write", "nonsense").exit_code == 2
    assert call("explain", "cylinders.toml").exit_code == 0


def test_tables_are_completed(folder):
    (folder / "stiff.nc").touch()
    (folder / "stress.h5").touch()
    assert complete_creep_tables("st") == ["steel", "stiff.nc"]
