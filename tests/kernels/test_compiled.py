"""What was compiled is used again, until a formula that it takes from changes."""

import shutil
import subprocess
import sys
from importlib.resources import files

import pytest

INNER = """
from {room}.compiled import compiled

FACTOR = {factor}

@compiled
def formula(x):
    return {formula}
"""

OUTER = """
from {room}.compiled import ANY_ORDER, compiled
from {room}.inner import FACTOR, formula

@compiled(fastmath=ANY_ORDER)
def total(x):
    return FACTOR * formula(x)
"""

ASK = "from {room}.outer import total; print(total(3.0), sum(total.stats.cache_hits.values()))"


@pytest.fixture
def ask(tmp_path):
    """Write formulas into a room of their own; a fresh process gives `total(3.0)`, cache hits."""
    room = "room"
    (tmp_path / room).mkdir()
    shutil.copy(files("tractive_sam.kernels") / "compiled.py", tmp_path / room)
    (tmp_path / room / "__init__.py").touch()
    (tmp_path / room / "outer.py").write_text(OUTER.format(room=room))

    def result(formula, factor):
        inner = INNER.format(room=room, formula=formula, factor=factor)
        (tmp_path / room / "inner.py").write_text(inner)
        command = [sys.executable, "-B", "-c", ASK.format(room=room)]
        found = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
        return tuple(map(float, found.stdout.split()))

    return result


def test_a_change_in_an_imported_module_is_seen(ask):  # four processes that import numba
    assert ask("x + 1.0", 2) == (8.0, 0)
    assert ask("x + 1.0", 2) == (8.0, 1)
    assert ask("x - 1.0", 2) == (4.0, 0)
    assert ask("x - 1.0", 5) == (10.0, 0)


def test_what_takes_from_other_kernels_is_compiled_in_this_way():
    for module in files("tractive_sam.kernels").iterdir():
        if module.name.endswith(".py") and module.name != "compiled.py":
            text = module.read_text("utf-8")
            assert "from ." not in text, f"{module.name}: compiled.sources sees no such import"
            assert "njit" not in text or "from tractive_sam.kernels" not in text, module.name
