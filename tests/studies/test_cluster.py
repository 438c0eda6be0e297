"""Scheduler and workers as separate programs, killed at critical moments."""

import os
import signal
import socket
import subprocess
import sys
import time
from contextlib import suppress

import numpy as np
import pytest

from tractive_sam.studies import SchedulerLostError, Study, cluster, open_study, study

distributed = pytest.importorskip("distributed", reason="dask.distributed is of the extra study")

pytestmark = pytest.mark.slow  # processes that start, are killed and start again

LONGEST = 120.0
"""Longest wait in s; only a test that fails waits so long."""

GATE = 5
"""Revolution at which cases wait, so that the tests and not the clock determine their state."""

STUDY = Study(
    title="Small discs",
    scene="twin-discs",
    without=["subsurface"],
    set=[
        "grid.half_length=[0.35, 0.9]",
        "grid.elements=[15, 25]",
        "wear.revolutions=12",
        "wear.save=[12]",
        'wear.stepping="every-revolution"',
    ],
    axis=[{"key": "friction.angle", "values": [0, 90]}],
)

PRELOAD = """
import time
from pathlib import Path

from tractive_sam.run.pipeline import roll
from tractive_sam.studies import worker


def gated(scene, path, **options):
    def wait(record):
        if record.revolution == {gate}:
            Path(path).with_suffix(".waits").touch()
            while not Path({go!r}).exists():
                time.sleep(0.01)

    options["progress"] = wait
    return roll(scene, path, **options)


worker.run.roll = gated
"""


@pytest.fixture(scope="module")
def wanted(tmp_path_factory):
    """The results of one process."""
    return study(STUDY, tmp_path_factory.mktemp("serial"), workers=0)


class Programs:
    """Programs in a folder, ended with the test.

    Each process imports the package and dask, 2 to 3 CPU seconds: tests start few of them.
    """

    def __init__(self, folder):
        self.folder, self.running = folder, []
        with socket.create_server(("127.0.0.1", 0)) as found:
            self.port = found.getsockname()[1]
        self.address = f"tcp://127.0.0.1:{self.port}"
        (folder / "study.toml").write_text(STUDY.to_toml())
        self.gate = folder / "gate.py"
        self.gate.write_text(PRELOAD.format(gate=GATE, go=str(folder / "go")))

    def start(self, *arguments):
        environment = os.environ | {
            "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
            "DASK_DISTRIBUTED__WORKER__PRELOAD": str(self.gate),
        }
        with (self.folder / "log.txt").open("a") as log:
            program = subprocess.Popen(
                [sys.executable, "-m", *map(str, arguments)],
                cwd=self.folder,
                env=environment,
                stdout=log,
                stderr=log,
                start_new_session=True,
            )
        self.running.append(program)
        return program

    def scheduler(self):
        return self.start("dask", "scheduler", "--port", self.port, "--no-dashboard", "--no-show")

    def workers(self, count, *options):
        always = ("--nthreads", "1", "--nworkers", count, "--no-dashboard")
        return self.start("dask", "worker", self.address, *always, *options)

    def client(self):
        options = ("-o", "results", "--scheduler", self.address)
        return self.start("tractive_sam", "study", "study.toml", *options)

    def read_log(self):
        return (self.folder / "log.txt").read_text()

    def results(self):
        return open_study(self.folder / "results")

    def until_cases_wait(self, number, client):
        def holds():
            assert client.poll() is None, self.read_log()
            return len(self.waiting_cases()) >= number

        until(holds, self.read_log)

    def waiting_cases(self):
        """Return the files with which cases report that they wait for the gate."""
        return [*self.folder.glob("results/*.waits")]

    def open_gate(self):
        (self.folder / "go").touch()

    def end(self):
        for program in reversed(self.running):
            with suppress(ProcessLookupError):
                os.killpg(program.pid, signal.SIGKILL)
            program.wait()


def until(holds, said=lambda: ""):
    end = time.monotonic() + LONGEST
    while not holds():
        assert time.monotonic() < end, said()
        time.sleep(0.05)


def ended(program, said):
    until(lambda: program.poll() is not None, said)
    return program.returncode


@pytest.fixture
def programs(tmp_path):
    programs = Programs(tmp_path)
    yield programs
    programs.end()


def assert_same(results, wanted):
    assert results.complete, results.counts
    for name in ("revolution", "Qx", "Qy", "Mz", "p_max", "wear_max", "half_width_y"):
        # Plans of transforms may differ between processes, and with them the last digits, which
        # grow to what the tolerance of the solver leaves open. Forces that symmetry makes zero are
        # far below 1e-8 of the forces of the discs, but may exceed 1e-9 N.
        np.testing.assert_allclose(
            results.column(name), wanted.column(name), rtol=1e-6, atol=1e-8, err_msg=name
        )


@pytest.fixture(autouse=True)
def _sigint_is_not_ignored():
    """As it is in jobs that a shell put behind, and so in all that these start."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_lost_processes(programs, wanted):
    """Client, worker and scheduler are lost in turn: cases continue from their last record."""
    scheduler = programs.scheduler()
    programs.workers(1)
    client = programs.client()
    programs.until_cases_wait(1, client)

    client.send_signal(signal.SIGINT)
    assert ended(client, programs.read_log) == 3, programs.read_log()
    assert "repeat the command to continue" in programs.read_log()

    client = programs.client()
    until(lambda: programs.read_log().count("complete already") == 2, programs.read_log)
    with distributed.Client(programs.address, set_as_default=False) as tools:
        # The nannies restrict BLAS to one thread.
        threads = tools.run(lambda: os.environ["OMP_NUM_THREADS"])
        assert set(threads.values()) == {"1"}
        for case in programs.waiting_cases():
            case.unlink()
        for pid in tools.run(os.getpid).values():
            os.kill(pid, signal.SIGKILL)  # its nanny starts another one
    programs.until_cases_wait(1, client)

    scheduler.kill()  # its worker ends with it; the client waits for another scheduler
    until(lambda: "the scheduler was lost" in programs.read_log(), programs.read_log)
    programs.open_gate()
    assert client.poll() is None
    programs.scheduler()
    programs.workers(1, "--no-nanny")
    assert ended(client, programs.read_log) == 0, programs.read_log()
    assert_same(programs.results(), wanted)


def test_a_missing_scheduler_is_found_without_a_client(tmp_path, monkeypatch):
    """A client without scheduler closes itself when it is collected, and may wait for a lock."""
    monkeypatch.setattr(cluster, "WAITS", cluster.Waits(first=0.1, pause=0.2))
    monkeypatch.setattr("distributed.Client", lambda *_, **__: pytest.fail("a client was made"))
    with pytest.raises(SchedulerLostError, match=r"tcp://127\.0\.0\.1:9"):
        study(STUDY, tmp_path, scheduler="tcp://127.0.0.1:9")
