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

TABLE = """
import tractive_sam as ts
ts.open_table("steel")(1e-3, 0.0, 0.0, a=1.0, b=1.0, load=1.0, mu=0.3, shear=1.0).gradient
"""

INTERFACES = """
import tractive_sam.compute.fft
import pyfftw
before = "pyfftw.interfaces.numpy_fft" in __import__("sys").modules
pyfftw.interfaces.numpy_fft.fft
from pyfftw.interfaces import cache
import pyfftw.interfaces.scipy_fft
assert not before and pyfftw.interfaces.cache is cache
"""

STAGES = """
import json, sys
for code in json.loads(sys.argv[1]):
    exec(code, {})
    print(json.dumps(sorted(sys.modules)), file=sys.stderr)
"""


def loaded_by(*codes):
    """Names of the modules that a fresh process has after each of some codes, run in turn."""
    found = subprocess.run(
        [sys.executable, "-c", STAGES, json.dumps(codes)],
        capture_output=True,
        text=True,
        check=True,
    )
    return [set(json.loads(line)) for line in found.stderr.splitlines()]


@pytest.mark.slow
@pytest.mark.parametrize(
    "stages",
    [
        {
            "import tractive_sam": COMPILERS | FIGURES | {"h5py", "numpy"},
            HELP: COMPILERS | FIGURES | {"h5py", "numpy", "pydantic"},
            "import tractive_sam as ts; ts.Scene.builtin('spheres')": (
                COMPILERS | FIGURES | {"h5py", "scipy.stats"}
            ),
            "import tractive_sam as ts; ts.open_history": COMPILERS | FIGURES | {"scipy.special"},
            TABLE: COMPILERS | FIGURES | {"xarray", "tractive_sam.contact"},
            "import tractive_sam as ts; ts.open_study": COMPILERS | FIGURES,
            "import tractive_sam.studies.worker": FIGURES | {"scipy.stats"},
        },
        {
            "import tractive_sam as ts; ts.plot": COMPILERS | {"h5py"},
            "import tractive_sam as ts; ts.roll": {
                *("dask", "pandas", "xarray", "scipy.optimize", "scipy.interpolate")
            },
        },
    ],
    ids=["without figures", "with figures"],
)
def test_loads_no_more_than_it_needs(stages):
    for (code, without), loaded in zip(stages.items(), loaded_by(*stages), strict=True):
        assert not loaded & without, code


@pytest.mark.slow
def test_transforms_offer_the_interfaces_of_fftw_on_request():
    assert "pyfftw.interfaces.scipy_fft" in loaded_by(INTERFACES)[0]


def test_rooms_are_attributes():
    for room in ("plot", "reference", "solvers", "studies", "subsurface"):
        assert getattr(ts, room).__name__ == f"tractive_sam.{room}"


def test_names_are_listed():
    assert set(dir(ts)) >= {"Scene", "plot", "solve"}
    with pytest.raises(AttributeError, match="no_such_name"):
        ts.no_such_name  # noqa: B018
