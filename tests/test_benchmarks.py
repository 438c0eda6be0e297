"""Each benchmark names the page that uses its numbers, and is in the list of benchmarks."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SCRIPTS = sorted(
    path.stem
    for path in (ROOT / "benchmarks").glob("*.py")
    if '__name__ == "__main__"' in path.read_text("utf-8") or path.stem == "readme"
)


@pytest.mark.parametrize("name", SCRIPTS)
def test_a_benchmark_is_listed_and_names_the_page_that_uses_it(name):
    source = (ROOT / "benchmarks" / f"{name}.py").read_text("utf-8")
    listed = (ROOT / "benchmarks" / "README.md").read_text("utf-8")
    assert f"`python benchmarks/{name}.py" in listed
    (page,) = re.findall(r"^Page: (.*)$", ast.get_docstring(ast.parse(source)), re.MULTILINE)
    assert page == "none" or (ROOT / page).is_file()
