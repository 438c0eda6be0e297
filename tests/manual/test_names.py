"""The names of the package and the TOML examples in the manual are valid."""

import re
import tomllib
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MODULES = {
    "ts": "tractive_sam",
    "plot": "tractive_sam.plot",
    "reference": "tractive_sam.reference",
    "ts.plot": "tractive_sam.plot",
    "ts.solvers": "tractive_sam.solvers",
    "ts.studies": "tractive_sam.studies",
    "ts.subsurface": "tractive_sam.subsurface",
}
NAME = re.compile(rf"\b({'|'.join(sorted(map(re.escape, MODULES), reverse=True))})\.([A-Za-z_]\w*)")

# The changelog also lists former names.
PAGES = [
    page
    for page in [
        ROOT / "README.md",
        *sorted((ROOT / "docs").rglob("*.md")),
        *sorted((ROOT / "notebooks").glob("*.ipynb")),
    ]
    if page.name != "changelog.md" and "_parts" not in page.parts
]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_names_exist(page):
    names = set(NAME.findall(page.read_text("utf-8")))
    modules = {short: import_module(MODULES[short]) for short, _ in names}
    assert not [f"{short}.{name}" for short, name in names if not hasattr(modules[short], name)]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_toml_examples_are_valid(page):
    for example in re.findall(r"```toml\n(.*?)```", page.read_text("utf-8"), re.DOTALL):
        tomllib.loads(example)
