"""The README keeps its word: its example runs, and its commands are single lines."""

import re
import tomllib
from pathlib import Path

import pytest

import tractive_sam as ts

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


@pytest.mark.slow
def test_the_example_runs(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    code = re.search(r"```python\n(.*?)```", README, re.DOTALL).group(1)
    exec(compile(code, "README.md", "exec"), {})
    assert "contact conditions hold" in capsys.readouterr().out
    assert (tmp_path / "traction.png").stat().st_size > 0


def test_commands_are_single_lines():
    blocks = re.findall(r"```sh\n(.*?)```", README, re.DOTALL)
    assert [block.count("\n") for block in blocks] == [1, 1]


def test_pictures_exist():
    for picture in re.findall(r"!\[.*?\]\((.*?)\)", README):
        assert (ROOT / picture).exists(), picture


@pytest.mark.parametrize(
    "page",
    [
        "README.md",
        "benchmarks/README.md",
        ".github/CODE_OF_CONDUCT.md",
        ".github/CONTRIBUTING.md",
        ".github/SECURITY.md",
    ],
    ids=str,
)
def test_links_lead_somewhere(page):
    """Links of the manual are checked when it is built."""
    text = (ROOT / page).read_text(encoding="utf-8")
    for link in re.findall(r"[^!]\[[^\]]*\]\((?!http)(.*?)\)", text):
        assert ((ROOT / page).parent / link.partition("#")[0]).exists(), link


def test_the_first_command_runs_the_scene_as_it_is():
    command = re.search(r"tractive-sam run (.*?) &&", README).group(1)
    assert command.split()[0] in ts.builtin_names()
    assert "--set" not in command


def test_descriptions_agree():
    about = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    title = re.search(r'^title: "tractive_sam: (.*)"$', citation, re.MULTILINE).group(1)
    assert about["description"].lower().startswith(title)
    assert title in (ROOT / "docs" / "citing.md").read_text(encoding="utf-8")
    (keywords,) = re.findall(r"^keywords: \[(.*)\]$", citation, re.MULTILINE)
    assert keywords.split(", ") == about["keywords"]


def test_nothing_is_left_to_fill_in():
    assert "@@" not in README
