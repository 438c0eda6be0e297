"""The contracts between the rooms of the package leave no room out."""

import tomllib
from pathlib import Path
from pkgutil import iter_modules

import pytest

import tractive_sam

CONTRACTS = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())["tool"][
    "importlinter"
]["contracts"]
ONLY_IN = {one["name"]: one for one in CONTRACTS if " only in " in one["name"]}
ROOMS = {f"tractive_sam.{room.name}" for room in iter_modules(tractive_sam.__path__)}
ROOMS -= {"tractive_sam.__main__"}


def test_every_room_has_its_layer():
    (layers,) = (one["layers"] for one in CONTRACTS if one["type"] == "layers")
    assert sorted(room for layer in layers for room in layer.split(" | ")) == sorted(ROOMS)


@pytest.mark.parametrize("name", ONLY_IN)
def test_what_is_only_in_one_room_is_forbidden_in_all_others(name):
    allowed = f"tractive_sam.{name.partition(' only in ')[2]}"
    assert allowed in ROOMS
    assert sorted(ONLY_IN[name]["source_modules"]) == sorted(ROOMS - {allowed})


def test_what_has_a_room_of_its_own():
    forbidden = {one["name"].split()[0]: one["forbidden_modules"] for one in ONLY_IN.values()}
    assert {name for name, modules in forbidden.items() if name in modules} == {
        "numba",
        "pyfftw",
        "h5py",
        "matplotlib",
        "plotly",
        "dask",
        "tomli_w",
    }
