"""Compiled kernels compute what Python does, and are used until a formula changes."""

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
from tractive_sam.kernels.heat import exponential_integral

pytestmark = pytest.mark.slow  # kernels are compiled again

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

ASK = "from room.outer import total; print(total(3.0), sum(total.stats.cache_hits.values()))"

COPIES = """
import os, sys
import numba, numpy
for line in sys.stdin:
    child = os.fork()
    if not child:
        exec(eval(line), {})
        sys.stdout.flush()
        os._exit(0)
    os.waitpid(child, 0)
    print(flush=True)
"""
"""Runs each line of code in a fresh copy of a process that has imported numba; an empty line ends
its output."""


@pytest.fixture
def run(tmp_path):
    """Return a function that runs code in a fresh process, and returns the words that it prints."""
    (tmp_path / "room").mkdir()
    shutil.copy(files("tractive_sam.kernels") / "compiled.py", tmp_path / "room")
    (tmp_path / "room" / "__init__.py").touch()
    (tmp_path / "room" / "outer.py").write_text(OUTER.format(room="room"))

    def read_words():
        words = []
        while line := copies.stdout.readline().split():
            words += line
        return words

    def run(code):
        copies.stdin.write(f"{code!r}\n")
        copies.stdin.flush()
        return read_words()

    with subprocess.Popen(
        [sys.executable, "-B", "-c", COPIES],
        cwd=tmp_path,
        env=os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "kept")},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as copies:
        yield run


@pytest.fixture
def ask(tmp_path, run):
    """Write formulas into a separate room; a fresh process gives `total(3.0)`, cache hits."""

    def result(formula, factor):
        inner = INNER.format(room="room", formula=formula, factor=factor)
        (tmp_path / "room" / "inner.py").write_text(inner)
        return tuple(map(float, run(ASK)))

    return result


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_kernels_are_compiled_again_after_a_change_in_an_imported_module(ask):
    assert ask("x + 1.0", 2) == (8.0, 0)
    assert ask("x - 1.0", 2) == (4.0, 0)
    assert ask("x - 1.0", 5) == (10.0, 0)


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_kernels_are_compiled_again_where_the_cache_is_damaged(ask, tmp_path):
    assert ask("x + 1.0", 2) == (8.0, 0)
    for content in (b"", b"no index"):
        for index in (tmp_path / "kept").rglob("*.nbi"):
            index.write_bytes(content)
        assert ask("x + 1.0", 2) == (8.0, 0)
    assert ask("x + 1.0", 2) == (8.0, 1)


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_kernels_are_compiled_where_no_cache_can_be_written(monkeypatch):
    monkeypatch.setattr("numba.core.caching.CompileResultCacheImpl._locator_classes", [])
    kernel = compiled(exponential_integral.py_func)
    assert kernel(0.3) == exponential_integral(0.3)


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_kernels_are_compiled_where_the_disk_is_full(monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("numba.core.caching.IndexDataCacheFile.load", lambda *_: None)
    monkeypatch.setattr("numba.core.caching.IndexDataCacheFile.save", full)
    kernel = compiled(exponential_integral.py_func)
    assert kernel(0.3) == exponential_integral(0.3)


TOLD = """
from room.compiled import notify_compilation
from room.outer import total

with notify_compilation(print):
    print(0, total(3.0), total(2.0), total(2))
"""


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_kernels_are_counted_as_they_are_compiled_and_not_as_they_are_loaded(ask, run):
    ask("x + 1.0", 2)
    # Of an integer, not of 3.0, `total` and the formula that it calls.
    assert run(TOLD) == ["1", "2", "2", "2", "0", "8.0", "6.0", "6.0"]
    assert run(TOLD) == ["0", "8.0", "6.0", "6.0"]


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
    ts.solve(ts.Scene.builtin("spheres").with_set(["grid.elements=[31, 31]"]))
print(json.dumps(found))
"""

TWICE = {
    f"tractive_sam.kernels.linear_algebra.{name}"
    for name in ("symmetric_2x2", "mirrored", "pack_half", "unpack_half")
}
"""Kernels of several kinds of numbers: real and complex, of single and double precision."""


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_a_first_contact_compiles_few_kernels(tmp_path):
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-c", COLD]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    found = json.loads(run.stdout)
    assert not {name for name in found if "unicode" in name}, "an array is assigned to a slice"
    own = {name: n for name, n in found.items() if name.startswith("tractive_sam")}
    assert own
    assert not {n for n in own if n.split(".")[2] in ("fatigue", "heat", "strip", "stress")}
    assert {name for name, n in own.items() if n > 1} <= TWICE
    assert sum(found.values()) <= 45  # 40 measured; another version of numba may need more


def test_kernels_that_import_others_are_compiled_by_the_decorator():
    for module in files("tractive_sam.kernels").iterdir():
        if module.name.endswith(".py") and module.name != "compiled.py":
            text = module.read_text("utf-8")
            assert "from ." not in text, f"{module.name}: compiled.sources sees no such import"
            assert "njit" not in text or "from tractive_sam.kernels" not in text, module.name


PANEL = """
found = []
for x, y in product((0.0, 0.3, 0.5, -20.0), (0.5, -0.2, 30.0)):  # edges, and near and far
    found += [exponential_integral(abs(x * y) + 0.1)]
    for z in (0.0, 0.4):
        found += [value for load in stress_patch(x, y, z, 1.0, 0.7, 0.3) for value in load]
rate = np.cos(np.arange(12.0)).reshape(4, 3)
found += sweep_wear(np.arange(3.0), rate, 0.1).ravel().tolist()
"""

KERNELS = """
import json
from itertools import product

import numpy as np

from tractive_sam.kernels.heat import exponential_integral
from tractive_sam.kernels.stress import stress_patch
from tractive_sam.mechanics.wear import sweep_wear
"""


def test_compiled_kernels_compute_what_python_does():
    command = [sys.executable, "-c", f"{KERNELS}{PANEL}print(json.dumps(found))"]
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    python = subprocess.run(command, env=environment, capture_output=True, check=True).stdout
    names = {}
    exec(KERNELS + PANEL, names)
    # Compiled, quadrature adds its nodes in another order; integrals are of the order of 1.
    np.testing.assert_allclose(names["found"], json.loads(python), rtol=1e-12, atol=1e-14)
