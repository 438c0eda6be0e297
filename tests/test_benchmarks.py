"""Each benchmark names the page that uses its numbers, and is in the list of benchmarks."""

import ast
import re
from importlib import import_module
from pathlib import Path
from types import ModuleType

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


@pytest.mark.parametrize("name", SCRIPTS)
def test_what_a_benchmark_imports_exists(name):
    """Benchmarks use functions within the package, which may be renamed."""
    tree = ast.parse((ROOT / "benchmarks" / f"{name}.py").read_text("utf-8"))
    imports = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    modules = {}
    for node in imports:
        if (node.module or "").startswith("tractive_sam"):
            module = import_module(node.module)
            for alias in node.names:
                found = getattr(module, alias.name, None)
                modules[alias.asname or alias.name] = (
                    found if found is not None else import_module(f"{node.module}.{alias.name}")
                )
    for node in ast.walk(tree):  # attributes of modules
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            owner = modules.get(node.value.id)
            assert not isinstance(owner, ModuleType) or hasattr(owner, node.attr)
