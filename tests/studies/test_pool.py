"""Worker processes on this machine: deaths, errors, signals, and no open port."""

import math
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress

import pytest

import tractive_sam as ts
from tests.studies.conftest import small
from tractive_sam.store import ResultsError
from tractive_sam.studies import computed, study
from tractive_sam.studies.pool import LocalWorkers, WorkerDiedError

pytestmark = pytest.mark.slow  # processes that start, are killed and start again

LAW = """
import multiprocessing, os, signal, time
from pathlib import Path

import tractive_sam as ts


class Gate(ts.Coulomb):
    "Friction of a worker that dies, or that waits until a file exists."

    def bound(self, pressure, x, y):
        if multiprocessing.parent_process() is not None:
            if self.mu[0] == 0.3:
                os.kill(os.getpid(), signal.SIGKILL)
            Path("waits").touch()
            while not Path("go").exists():
                time.sleep(0.01)
        return super().bound(pressure, x, y)
"""

FRICTIONS = {"key": "friction.mu", "values": [0.2, 0.3, 0.4]}


def gated_study(**options):
    """Return a study of spheres with this law."""
    settings = ['friction.law="gate:Gate"', "grid.elements=[15, 15]"]
    return small(FRICTIONS, set=settings, **options)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The working directory, in which a law is."""
    (tmp_path / "gate.py").write_text(LAW)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    yield tmp_path
    sys.modules.pop("gate", None)


def kill_once(place, mark):
    """Kill the worker if no mark exists, else return ten times the place."""
    if not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return 10 * place


class TwoArgumentsError(Exception):
    """An exception that cannot be copied: its class needs two arguments."""

    def __init__(self, one, two):
        super().__init__(f"{one} and {two}")


def refuse():
    raise TwoArgumentsError("this", "that")


def test_workers_that_die_are_replaced_and_errors_are_returned(tmp_path):
    calls = [(kill_once, 0, tmp_path / "mark"), (os._exit, 1), (math.sqrt, -1.0), (refuse,)]
    with LocalWorkers(2) as workers:
        found = dict(workers.run(calls))
        assert found[0] == 0  # its second worker returned it
        assert isinstance(found[1], WorkerDiedError)
        assert isinstance(found[2], ValueError)
        assert str(found[3]) == "TwoArgumentsError: this and that"
        assert all("Traceback" in found[k].__notes__[0] for k in (2, 3))
        # The same processes compute other calls, also after a caller that stopped early.
        assert os.getpid() not in dict(workers.run([(os.getpid,)] * 2)).values()
        assert next(workers.run([(time.sleep, 0.0), (time.sleep, 60.0)])) == (0, None)
        assert dict(computed([(math.sqrt, 4.0)] * 3, workers)) == {0: 2.0, 1: 2.0, 2: 2.0}
        with pytest.raises(ValueError, match="math domain"):
            list(computed([(math.sqrt, -1.0)], workers))


def test_workers_have_no_port_one_thread_and_the_current_folder(folder, monkeypatch):
    psutil = pytest.importorskip("psutil", reason="psutil comes with dask.distributed")
    monkeypatch.setenv("TRACTIVE_SAM_CACHE", "elsewhere")
    monkeypatch.setenv("OMP_NUM_THREADS", "7")
    names = ("OMP_NUM_THREADS", "TRACTIVE_SAM_CACHE")
    with LocalWorkers(2) as workers:
        calls = [(os.getcwd,), *((os.getenv, name) for name in names), (time.sleep, 0.2)]
        answers = dict(workers.run(calls))
        processes = [psutil.Process(), *psutil.Process().children(recursive=True)]
        assert len(processes) >= 3  # this one and two workers
        listening = [
            one.laddr for process in processes for one in process.net_connections("inet")
            if one.status == psutil.CONN_LISTEN
        ]  # fmt: skip
    assert answers == {0: str(folder), 1: "1", 2: "elsewhere", 3: None}
    assert os.environ["OMP_NUM_THREADS"] == "7"
    assert not listening


def test_only_the_case_that_kills_its_workers_fails(folder):
    """A law that the client allows is allowed in workers."""
    ts.allow_laws("gate:Gate")
    (folder / "go").touch()
    for keep in ("all", "scalars"):
        results = study(gated_study(keep=keep), folder / keep, workers=2)
        assert [row.status for row in results.rows] == ["complete", "failed", "complete"]
        assert "every worker that computed it died" in results.rows[1].message


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_stopped_client(folder, number):
    """Ctrl-C reaches all processes of a command; SIGKILL only the client. All of them end."""
    ts.allow_laws("gate:Gate")
    requested = gated_study()
    (folder / "study.toml").write_text(requested.to_toml())
    command = [sys.executable, "-m", "tractive_sam", "study", "study.toml", "-o", "results"]
    path = os.pathsep.join(filter(None, sys.path))
    client = subprocess.Popen(
        [*command, "--workers", "1", "--allow", "gate:Gate"],
        env=os.environ | {"PYTHONPATH": path},
        stderr=subprocess.PIPE,
        start_new_session=True,
        text=True,
    )
    try:
        wait_until(lambda: (folder / "waits").exists() or client.poll() is not None)
        (os.killpg if number == signal.SIGINT else os.kill)(client.pid, number)
        _, reported = client.communicate(timeout=30)
        wait_until(lambda: not has_processes(client.pid))
    finally:
        with suppress(ProcessLookupError):
            os.killpg(client.pid, signal.SIGKILL)
    assert client.returncode == (3 if number == signal.SIGINT else -number)
    assert "Traceback" not in reported
    assert ("repeat the command to continue" in reported) == (number == signal.SIGINT)
    assert study(requested, folder / "results", workers=0).complete


def wait_until(holds):
    """Wait until a condition holds; fail after a minute."""
    end = time.monotonic() + 60.0
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.02)


def has_processes(group):
    """Return whether any process of a group runs."""
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def test_a_script_without_guard_is_reported(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "import os\n"
        "from tractive_sam.studies import open_workers\n"
        "with open_workers(1) as workers:\n"
        "    print(list(workers.run([(os.getpid,)])))\n"
    )
    ended = subprocess.run([sys.executable, script], capture_output=True, text=True, check=False)
    assert ended.returncode == 1
    assert ended.stderr.rstrip().splitlines()[-1].startswith(ResultsError.__module__)
    assert 'if __name__ == "__main__":' in ended.stderr.rstrip().splitlines()[-1]
