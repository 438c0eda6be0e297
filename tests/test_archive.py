"""Tables of creep forces are evaluated from a zip archive of the package."""

import os
import shutil
import subprocess
import sys
import zipapp
from pathlib import Path

import pytest

import tractive_sam as ts

PROGRAM = """
import tractive_sam as ts
assert ".pyz" in ts.__file__
table = ts.open_table("steel")
print(table(-1e-3, 0.0, 0.0, a=6.0, b=4.0, load=80e3, mu=0.3, shear=80e3).Qx)
"""


@pytest.mark.slow
def test_evaluator_in_a_zip_application(tmp_path):
    ignored = shutil.ignore_patterns("__pycache__", "*.nbi", "*.nbc")
    shutil.copytree(Path(ts.__file__).parent, tmp_path / "app" / "tractive_sam", ignore=ignored)
    (tmp_path / "app" / "__main__.py").write_text(PROGRAM)
    zipapp.create_archive(tmp_path / "app", tmp_path / "app.pyz")
    environment = {k: value for k, value in os.environ.items() if k != "PYTHONPATH"}
    ended = subprocess.run(
        [sys.executable, "-P", "app.pyz"],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr
    contact = {"a": 6.0, "b": 4.0, "load": 80e3, "mu": 0.3, "shear": 80e3}
    assert float(ended.stdout) == ts.open_table("steel")(-1e-3, 0.0, 0.0, **contact).Qx
