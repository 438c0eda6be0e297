"""What is requested is loaded, and nothing that takes long besides."""

import json
import subprocess
import sys

import pytest

import tractive_sam as ts

COMPILERS = {"numba", "pyfftw"}
FIGURES = {"matplotlib", "tractive_sam.plot"}

HELP = """
import sys
from tractive_sam.cli import main

sys.argv = ["tractive-sam", "--help"]
try:
    main()
except SystemExit:
    pass
"""

SCENE = "import tractive_sam as ts; ts.Scene.builtin('spheres')"

TABLE = """
import tractive_sam as ts
ts.open_table("steel")(1e-3, 0.0, 0.0, a=1.0, b=1.0, load=1.0, mu=0.3, shear=1.0).gradient
"""


def loaded_by(code):
    """Names of the modules that a fresh process has after it ran `code`."""
    reported = f"{code}\nimport json, sys; print(json.dumps(sorted(sys.modules)), file=sys.stderr)"
    found = subprocess.run(
        [sys.executable, "-c", reported], capture_output=True, text=True, check=True
    )
    return set(json.loads(found.stderr))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("code", "without"),
    [
        ("import tractive_sam", COMPILERS | FIGURES | {"h5py", "numpy"}),
        (HELP, COMPILERS | FIGURES | {"h5py", "numpy", "pydantic"}),
        (SCENE, COMPILERS | FIGURES | {"h5py", "scipy.stats"}),
        ("import tractive_sam as ts; ts.open_history", COMPILERS | FIGURES | {"scipy.special"}),
        ("import tractive_sam as ts; ts.open_study", COMPILERS | FIGURES),
        ("import tractive_sam as ts; ts.plot", COMPILERS | {"h5py"}),
        ("import tractive_sam.studies.worker", FIGURES | {"scipy.stats"}),
        (TABLE, COMPILERS | FIGURES | {"xarray", "tractive_sam.contact"}),
    ],
    ids=["package", "help", "scene", "history", "study", "plot", "worker", "table"],
)
def test_loads_no_more_than_it_needs(code, without):
    assert not loaded_by(code) & without


def test_rooms_are_attributes():
    for room in ("plot", "reference", "solvers", "studies", "subsurface"):
        assert getattr(ts, room).__name__ == f"tractive_sam.{room}"


def test_names_are_listed():
    assert set(dir(ts)) >= {*ts.__all__, "Scene", "plot"}
    with pytest.raises(AttributeError, match="no_such_name"):
        ts.no_such_name  # noqa: B018


INTERFACES = """
import tractive_sam.operators.fftw
import pyfftw
before = "pyfftw.interfaces.numpy_fft" in __import__("sys").modules
pyfftw.interfaces.numpy_fft.fft
from pyfftw.interfaces import cache
import pyfftw.interfaces.scipy_fft
assert not before and pyfftw.interfaces.cache is cache
"""


@pytest.mark.slow
def test_rolling_loads_no_more_of_others_than_it_needs():
    unused = {"dask", "pandas", "xarray", "scipy.optimize", "scipy.interpolate"}
    assert not loaded_by("import tractive_sam as ts; ts.roll") & unused
    assert "pyfftw.interfaces.scipy_fft" in loaded_by(INTERFACES)
