"""Metadata that several files state agree with each other."""

import re
import runpy
import tomllib
import zlib
from importlib import import_module
from pathlib import Path
from pkgutil import walk_packages

import pytest

ROOT = Path(__file__).parents[1]
NAMES_ON_CONDA = {"matplotlib": "matplotlib-base"}  # without Qt

if not (ROOT / ".conda").is_dir():
    pytest.skip("no checkout of the repository", allow_module_level=True)


@pytest.fixture(scope="module")
def project():
    return tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]


@pytest.fixture(scope="module")
def newest_release():
    """Version and date of the first section of the changelog."""
    text = (ROOT / "docs" / "changelog.md").read_text("utf-8")
    return re.search(r"^## (\d+\.\d+\.\d+) \((\d{4}-\d\d-\d\d)\)$", text, re.MULTILINE).groups()


def test_files_agree_on_the_version(newest_release):
    version, date = newest_release
    citation = (ROOT / "CITATION.cff").read_text("utf-8")
    assert f"version: {version}\ndate-released: {date}\n" in citation
    assert f'default="{version}"' in (ROOT / ".conda" / "recipe.yaml").read_text("utf-8")
    assert f"version = {{{version}}}" in (ROOT / "docs" / "citing.md").read_text("utf-8")
    built = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["hatch"]["version"]
    assert built["fallback-version"] == built["raw-options"]["fallback_version"] == version


def test_a_wheel_has_less_than_four_megabytes():
    package = Path(import_module("tractive_sam").__file__).parent
    files = (p for p in package.rglob("*") if p.is_file() and "__pycache__" not in p.parts)
    # Each file is compressed; its entries in the archive and in RECORD take 200 bytes.
    assert sum(len(zlib.compress(file.read_bytes())) + 200 for file in files) < 4e6


def test_pyinstaller_bundles_modules_that_are_loaded_when_first_used(project, monkeypatch):
    pytest.importorskip("PyInstaller", reason="PyInstaller is of the extra clients")
    hooks = pytest.importorskip("PyInstaller.utils.hooks")
    monkeypatch.setattr(hooks, "copy_metadata", lambda name: [(name, name)])  # not installed here
    module, _, function = project["entry-points"]["pyinstaller40"]["hook-dirs"].partition(":")
    (folder,) = getattr(import_module(module), function)()
    found = runpy.run_path(str(Path(folder) / "hook-tractive_sam.py"))
    package = import_module("tractive_sam")
    modules = {one.name for one in walk_packages(package.__path__, "tractive_sam.")}
    assert set(found["hiddenimports"]) >= modules
    files = {Path(source).name for source, _ in found["datas"]}
    assert files >= {"__init__.pyi", "twin-discs.toml", "tractive-sam", "law.c", "report.html"}


def test_conda_recipe_requires_what_the_package_requires(project):
    required = {
        NAMES_ON_CONDA.get(name, name) + bound
        for name, bound in (
            re.fullmatch(r"([\w-]+)(.*)", d).groups() for d in project["dependencies"]
        )
    }
    required.add("python" + project["requires-python"])
    recipe = (ROOT / ".conda" / "recipe.yaml").read_text("utf-8")
    run = recipe.partition("  run:\n")[2].partition("\n\n")[0]
    assert {line.strip("- ").replace(" ", "") for line in run.splitlines()} == required


def test_classifiers_name_the_versions_of_python_that_are_tested(project):
    workflow = (ROOT / ".github" / "workflows" / "checks.yml").read_text("utf-8")
    tested = re.findall(r'"(3\.\d+)"', re.search(r"python: \[(.*)\]", workflow)[1])
    prefix = "Programming Language :: Python :: "
    stated = [c.removeprefix(prefix) for c in project["classifiers"] if c.startswith(prefix)]
    assert [version for version in stated if re.fullmatch(r"3\.\d+", version)] == tested


def test_citation_and_package_have_one_licence(project):
    citation = (ROOT / "CITATION.cff").read_text("utf-8")
    assert f"license: {project['license']}" in citation
