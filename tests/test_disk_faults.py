"""An output is complete or as it was before, whichever call to the disk fails."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent


@pytest.mark.slow
@pytest.mark.skipif(
    not sys.platform.startswith("linux") or shutil.which("cc") is None,
    reason="calls are replaced by a library that is compiled and loaded first",
)
def test_outputs_are_complete_or_unchanged_after_a_failed_call(tmp_path):
    """A sample: `python -m tests.disk_faults` fails every call of all outputs, which takes long."""
    library = tmp_path / "disk_faults.so"
    command = ["cc", "-shared", "-fPIC", "-O1", "-o", library, HERE / "disk_faults.c", "-ldl"]
    subprocess.run(command, check=True)
    paths = os.pathsep.join([str(HERE.parent), *filter(None, sys.path)])
    outputs = "csv", "netcdf", "export", "resume", "overwrite"  # each another writer
    run = subprocess.run(
        [sys.executable, "-m", "tests.disk_faults", tmp_path, *outputs, "--tries=2"],
        env=os.environ | {"PYTHONPATH": paths, "LD_PRELOAD": str(library), "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stdout + run.stderr
