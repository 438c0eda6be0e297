"""Signals that ask the program to stop, sent at moments that the tests choose."""

import gc
import os
import signal
import subprocess
import sys
import weakref

import numpy as np
import pytest

from tractive_sam import interrupt
from tractive_sam.run.pipeline import roll
from tractive_sam.scene import Scene
from tractive_sam.store import open_history

DISCS = Scene.builtin("twin-discs").replace(
    grid={"half_length": (0.35, 0.9), "elements": (15, 25)},
    wear={"intensity": 2e-6, "revolutions": 6, "save": [6]},
)


@pytest.fixture(autouse=True)
def _as_a_terminal_starts_it():
    """Restore signals: a shell that runs the tests in the background ignores them."""
    before = {one: signal.getsignal(one) for one in interrupt.SIGNALS}
    for one in before:
        usual = signal.default_int_handler if one is signal.SIGINT else signal.SIG_DFL
        signal.signal(one, usual)
    yield
    interrupt.ignore_signals()  # forgets noted signals
    for one, handler in before.items():
        signal.signal(one, handler)


def send(one):
    signal.raise_signal(one)  # on Windows, os.kill ends the process


@pytest.mark.parametrize("one", interrupt.SIGNALS)
def test_what_is_requested_is_heeded_where_it_is_looked_for(one):
    interrupt.note_signals(0.0)
    send(one)
    with pytest.raises(KeyboardInterrupt, match=one.name):
        interrupt.raise_if_interrupted()


def test_nothing_is_requested_of_scripts():
    """There, Python's own handler raises at once."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            send(signal.SIGINT)
        interrupt.raise_if_interrupted()
    finally:
        signal.signal(signal.SIGINT, before)


def test_what_the_process_ignores_stays_ignored():
    """As SIGHUP under nohup."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    interrupt.note_signals(0.0)
    send(signal.SIGTERM)
    interrupt.raise_if_interrupted()
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_IGN


def test_no_signal_is_lost_in_a_callback_of_the_garbage_collector():
    class Thing:
        pass

    interrupt.note_signals(0.0)
    thing = Thing()
    thing.itself = thing  # only the collector frees it
    kept = weakref.ref(thing, lambda _: send(signal.SIGINT))
    del thing
    gc.collect(1)  # young objects: all others take seconds
    assert kept() is None
    with pytest.raises(KeyboardInterrupt):
        interrupt.raise_if_interrupted()


@pytest.mark.slow
@pytest.mark.parametrize("one", interrupt.SIGNALS)
def test_roll_ends_after_the_record_at_hand_and_continues_from_it(tmp_path, one):
    wanted = roll(DISCS, tmp_path / "whole.h5")
    path = tmp_path / "cut.h5"
    interrupt.note_signals(0.0)
    with pytest.raises(KeyboardInterrupt):
        roll(DISCS, path, progress=lambda record: record.revolution == 2 and send(one))
    interrupt.ignore_signals()
    cut = open_history(path)
    assert cut.status == "stopped early"
    assert cut["revolution"].tolist() == [0, 1, 2]
    after = roll(DISCS, path, resume=True)
    assert after.finished
    np.testing.assert_array_equal(after["revolution"], wanted["revolution"])
    # Plans of transforms may differ from the first roll to the second, and so the last digits.
    np.testing.assert_allclose(after["wear_max"], wanted["wear_max"], rtol=1e-6)


PROGRAM = """
import os, signal, sys

class Asks:
    def find_spec(self, name, path=None, target=None):
        if name == {module!r}:
            for _ in range({times}):
                os.kill(os.getpid(), signal.{name})

sys.meta_path.insert(0, Asks())
sys.argv[1:] = ["run", "spheres", "--set", "grid.elements=[21, 21]", "-o", "spheres.h5"]
from tractive_sam.cli import main
main()
"""


ASKED_AT_THE_END = """
import atexit, os, signal, sys

atexit.register(os.kill, os.getpid(), signal.{name})
sys.argv[1:] = ["scenes"]
from tractive_sam.cli import main
main()
"""


def ended(folder, module, one, times=1):
    """The program, asked to stop while it imports a module."""
    return ran(folder, PROGRAM.format(module=module, name=one.name, times=times), one)


def ran(folder, text, one):
    """A separate process, which can be sent a signal."""
    paths = os.pathsep.join(filter(None, sys.path))
    # What is ignored here, as in jobs that a shell put behind, would be ignored there.
    before = signal.signal(one, signal.SIG_DFL)
    try:
        return subprocess.run(
            [sys.executable, "-c", text],
            cwd=folder,
            env=os.environ | {"PYTHONPATH": paths},
            capture_output=True,
            text=True,
            check=False,
        )
    finally:
        signal.signal(one, before)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("module", "one"),
    [
        ("typer", interrupt.SIGNALS[-1]),
        ("numba", signal.SIGINT),
        ("tractive_sam.run.pipeline", signal.SIGTERM),
    ],
)
def test_while_loading(folder, module, one):
    result = ended(folder, module, one)
    assert result.returncode == 3
    assert len(result.stderr.strip().splitlines()) == 1, result.stderr
    assert "interrupted" in result.stderr
    assert not (folder / "spheres.h5").exists()


@pytest.mark.slow
def test_after_the_end_the_status_is_that_of_what_was_done(folder):
    """Wisdom of transforms is stored while the process ends."""
    text = ASKED_AT_THE_END.format(name="SIGTERM")
    assert ran(folder, text, signal.SIGTERM).returncode == 0


LATE = """
import os, signal, sys, threading, time
from tractive_sam.interrupt import note_signals, protect_cleanup
note_signals(0.2)
def busy():
    while True:
        time.sleep(0.01)
{body}
"""


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="there is no such timer")
@pytest.mark.parametrize("one", interrupt.SIGNALS)
def test_what_never_looks_at_the_note_is_ended(folder, one):
    body = f"os.kill(os.getpid(), signal.{one.name})\nbusy()"
    result = ran(folder, LATE.format(body=body), one)
    assert result.returncode == 3
    assert result.stderr == "error: interrupted\n"


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="there is no such timer")
def test_what_is_protected_is_left_by_an_exception_once(folder):
    body = """
try:
    with protect_cleanup():
        os.kill(os.getpid(), signal.SIGTERM)
        try:
            busy()
        finally:
            time.sleep(0.7)  # longer than the patience: it is not interrupted again
            print("put away", flush=True)
except KeyboardInterrupt as error:
    print(error)
"""
    result = ran(folder, LATE.format(body=body), signal.SIGTERM)
    assert result.stdout.splitlines() == ["put away", "SIGTERM"]


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="there is no such timer")
def test_no_timer_runs_while_the_process_ends(folder):
    """Python removes its handler at the end, and the signal would then kill the process."""
    body = """
from tractive_sam.interrupt import ignore_signals
os.kill(os.getpid(), signal.SIGTERM)
before = signal.getitimer(signal.ITIMER_REAL)[0]
ignore_signals()
print(before > 0.0, signal.getitimer(signal.ITIMER_REAL)[0])
"""
    result = ran(folder, LATE.format(body=body), signal.SIGTERM)
    assert result.stdout.split() == ["True", "0.0"]


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="there is no such timer")
@pytest.mark.parametrize("times", [1, 2])
def test_what_has_reported_its_end_prints_no_second_line(folder, times):
    """Time may be over while the program puts away what it holds, or a second signal comes."""
    body = f"""
from tractive_sam.cli.output import error_exit
from tractive_sam.interrupt import raise_if_interrupted
os.kill(os.getpid(), signal.SIGTERM)
try:
    raise_if_interrupted()
except KeyboardInterrupt:
    error_exit(3, "interrupted")
    for _ in range({times - 1}):
        os.kill(os.getpid(), signal.SIGTERM)
    busy()
"""
    result = ran(folder, LATE.format(body=body), signal.SIGTERM)
    assert result.returncode == 3
    assert result.stderr == "error: interrupted\n"


def test_signals_are_noted_before_anything_is_loaded(folder):
    code = """
import signal, sys
before = {*sys.modules}
import tractive_sam.cli as cli
class FirstImport:
    def find_spec(*_):
        print(signal.getsignal(signal.SIGINT).__module__, *sorted({*sys.modules} - before))
        sys.exit()
sys.meta_path.insert(0, FirstImport)
cli.main()
"""
    found = ran(folder, code, signal.SIGINT)
    assert found.stdout.split() == ["tractive_sam.cli", "tractive_sam", "tractive_sam.cli"]


@pytest.mark.slow
@pytest.mark.parametrize("module", ["contextlib", "lazy_loader", "typer"])
def test_from_the_first_import_on(folder, module):
    text = PROGRAM.format(module=module, name="SIGINT", times=1)
    text = f"import sys\nsys.modules.pop({module!r}, None)\n{text}"
    result = ran(folder, text, signal.SIGINT)
    assert result.returncode == 3
    assert result.stderr == "error: interrupted\n"


@pytest.mark.slow
def test_a_second_signal_ends_at_once(folder):
    result = ended(folder, "typer", signal.SIGINT, times=2)
    assert result.returncode == 3
    assert len(result.stderr.strip().splitlines()) == 1, result.stderr
