"""Type checkers know the keys of scenes and what they accept."""

import subprocess
import sys
from pathlib import Path

import pytest

import tractive_sam

PROGRAM = """
import tractive_sam as ts

ts.Friction(mu=0.3)
ts.Friction(mu=(0.4, 0.2), angle=45.0)
sphere = ts.Body(young=208e3, poisson=0.3, radius_x=10.0, radius_y=10.0)
scene = ts.Scene(body={"A": sphere, "B": sphere}, load=ts.Load(normal=10.0), friction={"mu": 0.3})
force: float = ts.solve(scene).Qx
mu: tuple[float, float] = ts.Friction(mu=0.3).mu
ts.Scene(bodyy={})  # wrong
ts.Friction(mu="0.3")  # wrong
"""


@pytest.mark.slow
def test_mypy_refuses_unknown_keys_and_wrong_types(tmp_path):
    pytest.importorskip("mypy", reason="it is of the extra dev")
    (tmp_path / "program.py").write_text(PROGRAM)
    root = Path(tractive_sam.__file__).parents[1]
    command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(root / ".mypy_cache")]
    ended = subprocess.run(
        [*command, str(tmp_path / "program.py")],
        cwd=root,
        capture_output=True,
        text=True,
        check=False,
    )
    wrong = [k for k, line in enumerate(PROGRAM.splitlines(), 1) if "# wrong" in line]
    errors = [line for line in ended.stdout.splitlines() if ": error:" in line]
    assert [int(line.split("program.py:")[1].split(":")[0]) for line in errors] == wrong
