"""An output is whole or as it was before, whichever call to the disk fails."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux") or shutil.which("cc") is None,
    reason="calls are replaced by a library that is compiled and loaded first",
)


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    found = tmp_path_factory.mktemp("library") / "disk_faults.so"
    command = ["cc", "-shared", "-fPIC", "-O1", "-o", found, HERE / "disk_faults.c", "-ldl"]
    subprocess.run(command, check=True)
    return found


def fail_every_call(library, folder, *outputs):
    paths = os.pathsep.join([str(HERE.parent), *filter(None, sys.path)])
    run = subprocess.run(
        [sys.executable, "-m", "tests.disk_faults", folder, *outputs],
        env=os.environ | {"PYTHONPATH": paths, "LD_PRELOAD": str(library), "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stdout + run.stderr


@pytest.mark.parametrize("output", ["csv", "netcdf"])
def test_every_call_of_an_output(library, tmp_path, output):
    fail_every_call(library, tmp_path, output)


@pytest.mark.slow
@pytest.mark.parametrize("output", ["report", "export", "run", "resume", "overwrite"])
def test_some_calls_of_other_outputs(library, tmp_path, output):
    """`python -m tests.disk_faults` fails all of them, which takes long."""
    fail_every_call(library, tmp_path, output, "--every=120")
