"""Examples in docstrings run."""

import doctest
from importlib import import_module
from pkgutil import iter_modules

import pytest

import tractive_sam
import tractive_sam.studies

STUDIES = sorted(one.name for one in iter_modules(tractive_sam.studies.__path__))


def test_package_docstring():
    result = doctest.testmod(tractive_sam)
    assert result.attempted > 0
    assert result.failed == 0


@pytest.mark.parametrize("module", ["", *STUDIES])
def test_examples_of_studies(module, tmp_path, monkeypatch):
    for needed in ("xarray", "h5netcdf"):
        pytest.importorskip(needed, reason=f"{needed} is of the extra study")
    monkeypatch.chdir(tmp_path)
    found = import_module(f"tractive_sam.studies.{module}".rstrip("."))
    assert doctest.testmod(found, optionflags=doctest.ELLIPSIS).failed == 0


def test_every_public_name_of_studies_has_an_example():
    for name in tractive_sam.studies.__all__:
        found = getattr(tractive_sam.studies, name)
        if callable(found):
            assert ">>> " in found.__doc__, name
