"""What titles, names and terminals can hold does not command, break or stop the program."""

import os
import subprocess
import sys

import pytest

from tests.cli.conftest import GRID, SCENE, make_record
from tractive_sam.store import HistoryWriter

COMMANDS = "\x1b]0;owned\x07\x1b[31mred\x1b[2J \x9b31m \u202e"


def has_command(text):
    return any(sign in text for sign in "\x1b\x07\x9b\u202e\r")


@pytest.fixture
def spoilt(folder):
    """Return a results file with texts that command terminals."""
    path = folder / "spoilt.h5"
    with HistoryWriter(path, SCENE.replace(title=COMMANDS), GRID) as writer:
        writer.append(make_record(0))
        writer.finish("done", f"fine {COMMANDS}")
    return path


@pytest.mark.slow
@pytest.mark.parametrize("command", [["show"], ["show", "--json"], ["plot", "-o", "figures"]])
def test_texts_of_a_file_do_not_command_the_terminal(call, spoilt, command):
    result = call(command[0], spoilt, *command[1:])
    assert result.exit_code == 0, result.output
    assert not has_command(result.output)


@pytest.mark.parametrize(
    "arguments",
    [
        ["show", f"no{COMMANDS}.h5"],
        ["run", f"sce{COMMANDS}ne"],
        ["run", "spheres", f"more{COMMANDS}"],
        ["run", "spheres", "--set", f"title={COMMANDS}", "--set", "load.normal=-1"],
        ["study-show", f"no{COMMANDS}"],
    ],
)
def test_names_do_not_command_the_terminal(call, arguments):
    result = call(*arguments)
    assert result.exit_code == 2
    assert not has_command(result.output)


def test_title_in_explain(call):
    title = COMMANDS.encode("unicode_escape").decode().replace("\\x", "\\u00")
    result = call("explain", "cylinders", "--set", f'title="{title} [bold]"')
    assert result.exit_code == 0, result.output
    assert not has_command(result.output)
    assert "[bold]" in result.output


def program(*arguments, folder, stdout=subprocess.PIPE, **environment):
    paths = os.pathsep.join(filter(None, sys.path))
    return subprocess.run(
        [sys.executable, "-m", "tractive_sam", *map(str, arguments)],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": paths} | environment,
        stdout=stdout,
        stderr=subprocess.PIPE,
        check=False,
    )


@pytest.mark.slow
def test_terminal_without_greek_letters(stored, folder):
    result = program("show", stored, folder=folder, PYTHONIOENCODING="ascii")
    assert result.returncode == 0, result.stderr
    assert b"um" in result.stdout


def test_reader_that_leaves_the_help(folder):
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "w") as left:
        result = program("--help", folder=folder, stdout=left)
    assert result.returncode == 0, result.stderr
    assert not result.stderr


def test_folder_is_no_scene(call, folder):
    (folder / "scenes").mkdir()
    result = call("run", "scenes")
    assert result.exit_code == 2
    assert "directory" in result.stderr


def test_many_faults_are_counted(call, folder):
    (folder / "many.toml").write_text("".join(f"[t{k}]\n" for k in range(2000)))
    result = call("explain", "many.toml")
    assert result.exit_code == 2
    # All unknown tables, and those that a scene needs.
    assert int(result.stderr.split(" faults")[0].split()[-1]) > 2000
    assert len(result.stderr.splitlines()) < 40


def test_name_that_is_too_long(call):
    result = call("run", "spheres", "-o", "x" * 300 + ".h5")
    assert result.exit_code == 2
    assert "xxx" in result.stderr
