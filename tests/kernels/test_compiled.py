"""What was compiled computes what Python does, and is used until a formula changes."""

import errno
import json
import os
import shutil
import subprocess
import sys
from importlib.resources import files

import numba
import numpy as np
import pytest

from tractive_sam.kernels.compiled import compiled
from tractive_sam.kernels.rectangle import integrals

pytestmark = pytest.mark.slow  # kernels are compiled anew

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
def ask(tmp_path, monkeypatch):
    """Write formulas into a room of their own; a fresh process gives `total(3.0)`, cache hits."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "kept"))
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


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_a_change_in_an_imported_module_is_seen(ask):  # four processes that import numba
    assert ask("x + 1.0", 2) == (8.0, 0)
    assert ask("x + 1.0", 2) == (8.0, 1)
    assert ask("x - 1.0", 2) == (4.0, 0)
    assert ask("x - 1.0", 5) == (10.0, 0)


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
@pytest.mark.parametrize("spoilt", [b"", b"no index"])
def test_what_is_damaged_is_compiled_anew(ask, tmp_path, spoilt):
    assert ask("x + 1.0", 2) == (8.0, 0)
    for index in (tmp_path / "kept").rglob("*.nbi"):
        index.write_bytes(spoilt)
    assert ask("x + 1.0", 2) == (8.0, 0)
    assert ask("x + 1.0", 2) == (8.0, 1)


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_where_nothing_can_be_kept_it_is_compiled(monkeypatch):
    monkeypatch.setattr("numba.core.caching.CompileResultCacheImpl._locator_classes", [])
    kernel = compiled(integrals.py_func)
    assert kernel(0.3, -0.2, 1.0, 0.7) == integrals(0.3, -0.2, 1.0, 0.7)


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_where_there_is_no_room_it_is_compiled(monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("numba.core.caching.IndexDataCacheFile.load", lambda *_: None)
    monkeypatch.setattr("numba.core.caching.IndexDataCacheFile.save", full)
    kernel = compiled(integrals.py_func)
    assert kernel(0.3, -0.2, 1.0, 0.7) == integrals(0.3, -0.2, 1.0, 0.7)


TOLD = """
from {room}.compiled import compiling_told
from {room}.outer import total

with compiling_told(lambda: print(1)):
    print(0, total(3.0), total(2.0), total(2))
"""


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_compiling_is_told_once_and_not_of_what_is_kept(ask, tmp_path):
    def told():
        command = [sys.executable, "-B", "-c", TOLD.format(room="room")]
        found = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
        return found.stdout

    ask("x + 1.0", 2)
    assert told().split() == ["1", "0", "8.0", "6.0", "6.0"]  # of a whole number, not of 3.0
    assert told().split() == ["0", "8.0", "6.0", "6.0"]


COLD = """
import json
from collections import Counter

import tractive_sam as ts
from numba.core import event

class Listener(event.Listener):
    def on_start(self, event):
        function = event.data["dispatcher"].py_func
        found[f"{function.__module__}.{function.__qualname__}"] += 1

    def on_end(self, event):
        pass

found = Counter()
with event.install_listener("numba:compile", Listener()):
    contact = ts.solve(ts.Scene.builtin("spheres").with_set(["grid.elements=[31, 31]"]))
    ts.stress_maximum(contact, "A")
print(json.dumps(found))
"""

TWICE = {"tractive_sam.kernels.spectral.symmetric_2x2"}
"""Kernels of more than one kind of numbers: real and complex coefficients."""


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_a_first_contact_compiles_few_kernels(tmp_path):
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-c", COLD]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    found = json.loads(run.stdout)
    assert not {name for name in found if "unicode" in name}, "an array is assigned to a slice"
    own = {name: n for name, n in found.items() if name.startswith("tractive_sam")}
    assert own
    assert not {name for name in own if name.split(".")[2] in ("fatigue", "heat", "strip")}
    assert {name for name, n in own.items() if n > 1} <= TWICE
    assert sum(found.values()) <= 110  # 98, 211 before; with room for another version of numba


def test_what_takes_from_other_kernels_is_compiled_in_this_way():
    for module in files("tractive_sam.kernels").iterdir():
        if module.name.endswith(".py") and module.name != "compiled.py":
            text = module.read_text("utf-8")
            assert "from ." not in text, f"{module.name}: compiled.sources sees no such import"
            assert "njit" not in text or "from tractive_sam.kernels" not in text, module.name


PANEL = """
import json
from itertools import product

import numpy as np

from tractive_sam.kernels.rectangle import integrals
from tractive_sam.kernels.stress import stress_patch
from tractive_sam.kernels.wear import sweep

found = []
for x, y in product((0.0, 0.3, 0.5, -20.0), (0.5, -0.2, 30.0)):  # edges, and near and far
    found += integrals(x, y, 1.0, 0.7)
    for z in (0.0, 0.4):
        found += [value for load in stress_patch(x, y, z, 1.0, 0.7, 0.3) for value in load]
rate = np.cos(np.arange(12.0)).reshape(4, 3)
found += sweep(np.arange(3.0), rate, 0.1).ravel().tolist()
print(json.dumps(found))
"""


def test_compiled_kernels_compute_what_python_does():
    found = [
        json.loads(
            subprocess.run(
                [sys.executable, "-c", PANEL],
                env=os.environ | {"NUMBA_DISABLE_JIT": off},
                capture_output=True,
                check=True,
            ).stdout
        )
        for off in "01"
    ]
    # Compiled, quadrature adds its nodes in another order; integrals are of the order of 1.
    np.testing.assert_allclose(*found, rtol=1e-12, atol=1e-14)
