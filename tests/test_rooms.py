"""The contracts between the rooms of the package leave no room out."""

import ast
import re
import tomllib
from functools import cache
from pathlib import Path
from pkgutil import iter_modules

import pytest

import tractive_sam

PROJECT = (Path(__file__).parents[1] / "pyproject.toml").read_text("utf-8")
CONTRACTS = tomllib.loads(PROJECT)["tool"]["importlinter"]["contracts"]
ONLY_IN = {one["name"]: one for one in CONTRACTS if " only in " in one["name"]}
ROOMS = {f"tractive_sam.{room.name}" for room in iter_modules(tractive_sam.__path__)}
ROOMS -= {"tractive_sam.__main__"}
PACKAGE = Path(tractive_sam.__file__).parent


def test_every_room_has_its_layer():
    (layers,) = (one["layers"] for one in CONTRACTS if one["type"] == "layers")
    assert sorted(room for layer in layers for room in layer.split(" | ")) == sorted(ROOMS)


@pytest.mark.parametrize("name", ONLY_IN)
def test_what_is_only_in_one_room_is_forbidden_in_all_others(name):
    contract, allowed = ONLY_IN[name], f"tractive_sam.{name.partition(' only in ')[2]}"
    assert allowed in ROOMS
    assert contract["source_modules"] == ["tractive_sam"]
    exceptions = {f"{allowed}.** -> {module}" for module in contract["forbidden_modules"]}
    assert set(contract["ignore_imports"]) == exceptions


def test_what_has_a_room_of_its_own():
    forbidden = {one["name"].split()[0]: one["forbidden_modules"] for one in ONLY_IN.values()}
    assert {name for name, modules in forbidden.items() if name in modules} == {
        "numba",
        "pyfftw",
        "h5py",
        "matplotlib",
        "plotly",
        "distributed",
        "tomli_w",
    }


@cache
def lets_out(room):
    """The names that a room's door has."""
    doors = (PACKAGE / room).glob("__init__.py*")
    found = (one for door in doors for one in ast.walk(ast.parse(door.read_text("utf-8"))))
    imports = (one.names for one in found if isinstance(one, ast.ImportFrom))
    return {one.asname or one.name for names in imports for one in names}


@pytest.mark.slow
def test_rooms_are_entered_by_their_doors():
    """Formulas apart, which are taken by module: `kernels` lets out nothing."""
    past = []
    for module in PACKAGE.rglob("*.py"):
        for one in ast.walk(ast.parse(module.read_text("utf-8"))):
            if not isinstance(one, ast.ImportFrom) or one.level:
                continue
            package, room, *deeper = [*(one.module or "").split("."), ""]
            own = module.relative_to(PACKAGE).parts[0]
            if package != PACKAGE.name or room in {"", "kernels", own}:
                continue
            kept = {name.name for name in one.names} - lets_out(room)
            if any(deeper) or any((PACKAGE / room / f"{name}.py").exists() for name in kept):
                past.append(f"{module.relative_to(PACKAGE)}: {ast.unparse(one)}")
    assert past == []


def test_names_are_not_those_of_their_modules():
    """A module that is imported first would hide its function."""
    stubs = [path.read_text("utf-8") for path in PACKAGE.rglob("__init__.pyi")]
    same = [name for stub in stubs for name in re.findall(r"from \.(\w+) import \1\b", stub)]
    assert same == []
