"""Metadata that several files state agree with each other."""

import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
NAMES_ON_CONDA = {"matplotlib": "matplotlib-base"}  # without Qt

if not (ROOT / ".conda").is_dir():
    pytest.skip("no checkout of the repository", allow_module_level=True)


@pytest.fixture(scope="module")
def project():
    return tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]


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
