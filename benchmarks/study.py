"""Studies on a cluster of processes, with killed workers, and the cost of the engine.

A scheduler and two workers are started by their command lines. The creep-force map of
`spheres-orthotropic` over 10 creepages and 7 angles, and `twin-discs` over 7 angles, run on them
through ``tractive-sam study``. In each study, a worker is killed (SIGKILL): in the first, the
process of the worker, which its nanny starts again; in the second, the nanny as well, so that one
worker remains. The results are compared with a computation by one process. Both studies then run on
one and on two workers. The cost of the engine is measured with 2,000 empty cases, and the cost of
reading with a folder of 10,000 cases. From these values, the last table estimates the time of
10,000 cases on 500 cores.

Page: docs/howto/cluster.md
"""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import pairwise
from pathlib import Path
from time import perf_counter, sleep

import numpy as np
from distributed import Client
from timing import show, write

import tractive_sam as ts
from tractive_sam.studies import cases, estimate_times
from tractive_sam.studies.cluster import Cluster
from tractive_sam.studies.run import run_tasks
from tractive_sam.studies.worker import Task

ANGLES = [0, 15, 30, 45, 60, 75, 90]
MAP = ts.Study(
    title="Creep forces of the orthotropic spheres",
    scene="spheres-orthotropic",
    without=["subsurface"],
    axis=[
        {"key": "creepage.longitudinal", "start": -0.0005, "stop": -0.005, "number": 10},
        {"key": "friction.angle", "values": ANGLES},
    ],
)
DISCS = ts.Study(
    title="Twin discs at several friction angles",
    scene="twin-discs",
    without=["subsurface"],
    axis=[{"key": "friction.angle", "values": ANGLES}],
)
COMPARED = ("revolution", "Qx", "Qy", "p_max", "wear_max", "half_width_y", "stick_fraction")
IDLE_CASES, MANY_CASES, CORES = 2000, 10_000, 500
SHARED_DISKS = 5.0
"""Assumed bandwidth of a file system that 500 cores share, GB/s."""


def started(*arguments: str, folder: Path) -> subprocess.Popen:
    program = Path(sys.executable).with_name("dask")
    log = (folder / "dask.log").open("a")
    return subprocess.Popen(
        [program, *arguments], stdout=log, stderr=log, cwd=folder, start_new_session=True
    )


@contextmanager
def cluster(workers: int, folder: Path) -> Iterator[str]:
    """Start a scheduler and workers as separate programs, and yield the address."""
    file = folder / f"scheduler-{workers}.json"
    file.unlink(missing_ok=True)
    programs = [started("scheduler", "--port", "0", "--no-dashboard", "--no-show",
                        "--scheduler-file", file.name, folder=folder)]  # fmt: skip
    try:
        while not file.exists():
            sleep(0.1)
        address = json.loads(file.read_text())["address"]
        worker = ("worker", address, "--nthreads", "1", "--no-dashboard")
        programs += [
            started(*worker, "--local-directory", str(folder), folder=folder)
            for _ in range(workers)
        ]
        with Client(address, set_as_default=False) as client:
            client.wait_for_workers(workers)
            client.run(_warmed_up)
        yield address
    finally:
        for program in reversed(programs):
            with suppress(ProcessLookupError):
                os.killpg(program.pid, signal.SIGTERM)
        for program in programs:
            program.wait()


def _warmed_up() -> None:
    """Compile and load the kernels, which are not timed."""
    ts.roll(MAP.scene)


def serial(study: ts.Study, folder: Path) -> tuple[ts.StudyResults, dict]:
    """Run a study in this process, and return it with the cost of a case."""
    before, began, spent = _written(), perf_counter(), _cpu_seconds()
    results = ts.study(study, folder, workers=0)
    took, (calls, volume) = perf_counter() - began, _written() - before
    spent = _cpu_seconds() - spent
    count = len(results)
    return results, {
        "study": study.title,
        "cases": count,
        "s a case": took / count,
        "s of CPU a case": spent / count,
        "writes a case": calls / count,
        "MB written a case": volume / 1e6 / count,
        "MB a file": np.mean([row.file.stat().st_size for row in results.rows]) / 1e6,
    }


def _written() -> np.ndarray:
    """Return the number of write calls and bytes of this process so far."""
    lines = Path("/proc/self/io").read_text().splitlines()
    counts = {name: int(count) for name, count in (line.split(": ") for line in lines)}
    return np.array([counts["syscw"], counts["wchar"]])


def client(study: ts.Study, folder: Path, address: str) -> subprocess.Popen:
    """Start the command line of the study."""
    file = folder.with_suffix(".toml")
    file.write_text(study.to_toml())
    command = [sys.executable, "-m", "tractive_sam", "study", file, "-o", folder]
    log = folder.with_suffix(".log").open("w")
    return subprocess.Popen([*command, "--scheduler", address], stderr=log)


def killed(address: str, with_nanny: bool) -> None:
    """Kill one worker that computes."""
    with Client(address, set_as_default=False) as client:
        pid, parent = next(iter(client.run(lambda: (os.getpid(), os.getppid())).values()))
    if with_nanny:
        os.kill(parent, signal.SIGKILL)
    os.kill(pid, signal.SIGKILL)


def survived(study: ts.Study, wanted: ts.StudyResults, folder: Path, with_nanny: bool) -> dict:
    """Run a study, kill a worker after a third of the cases, and compare the results."""
    with cluster(2, folder.parent) as address:
        began = perf_counter()
        running = client(study, folder, address)
        while len(list(folder.glob("[0-9]*.h5"))) < len(study) // 3 + 1:
            sleep(0.1)
        killed(address, with_nanny)
        interrupted = ts.open_study(folder).counts
        assert running.wait() == 0, folder.with_suffix(".log").read_text()
        took = perf_counter() - began
    results = ts.open_study(folder)
    assert results.complete, results.counts
    row = {"study": study.title, "cases": len(study), "s, one worker killed": took}
    row["complete when killed"] = interrupted["complete"]
    for name in COMPARED:
        values, expected = results.column(name), wanted.column(name)
        row[f"{name} differs"] = (
            float(np.abs(values - expected).max() / np.abs(expected).max())
            if np.any(expected)
            else 0.0
        )
    return row


def scaling(study: ts.Study, single: dict, scratch: Path) -> list[dict]:
    """Return the time on one and on two workers; CPU time does not depend on other programs."""
    count = single["cases"]
    of_single = {"workers": "none (one process)", "s": count * single["s a case"], "busy": 1.0}
    rows = [{"study": study.title, **of_single, "s of CPU": count * single["s of CPU a case"]}]
    for workers in (1, 2):
        folder, busy = scratch / f"scaling-{len(study)}-{workers}", []
        with cluster(workers, scratch) as address:
            began, spent = perf_counter(), _cpu_seconds_of_workers(address)
            ts.study(
                study,
                folder,
                scheduler=address,
                progress=lambda progress, busy=busy: (
                    progress.outcome and busy.append(progress.outcome.seconds)
                ),
            )
            took = perf_counter() - began
            spent = _cpu_seconds_of_workers(address) - spent
        share = sum(busy) / (workers * took)
        row = {"workers": workers, "s": took, "busy": share, "s of CPU": spent}
        rows.append({"study": study.title, **row})
    return rows


def _cpu_seconds_of_workers(address: str) -> float:
    with Client(address, set_as_default=False) as client:
        return sum(client.run(_cpu_seconds).values())


def engine(scratch: Path) -> dict:
    """Measure the time for distributing cases that end at once, and for their messages."""
    axis = {"key": "friction.angle", "start": 0, "stop": 90, "number": IDLE_CASES}
    idle = cases(ts.Study(scene=DISCS.scene, axis=[axis]))
    nowhere = scratch / "nowhere"  # a worker that finds no folder says so and is done
    tasks = [Task(case, nowhere / f"{case.name}.h5", 1.0) for case in idle]
    with cluster(2, scratch) as address:
        with Client(address, set_as_default=False) as client:
            before = client.run_on_scheduler(_cpu_seconds)
        began, client_cpu = perf_counter(), _cpu_seconds()
        assert len(list(run_tasks(tasks, Cluster(address, print), print))) == IDLE_CASES
        took, client_cpu = perf_counter() - began, _cpu_seconds() - client_cpu
        with Client(address, set_as_default=False) as client:
            spent = client.run_on_scheduler(_cpu_seconds) - before
    return {
        "cases": IDLE_CASES,
        "ms a case": 1e3 * took / IDLE_CASES,
        "ms of scheduler": 1e3 * spent / IDLE_CASES,
        "ms of client": 1e3 * client_cpu / IDLE_CASES,
    }


def _cpu_seconds() -> float:
    times = os.times()
    return times.user + times.system


def many(done: ts.StudyResults, scratch: Path) -> dict:
    """Measure the client with a study of 10,000 complete cases."""
    axis = {"key": "friction.angle", "start": 0, "stop": 90, "number": MANY_CASES}
    study, folder = ts.Study(scene=DISCS.scene, axis=[axis]), scratch / "many"
    folder.mkdir()
    (folder / "study.toml").write_text(study.to_toml())
    times = [perf_counter()]
    all_cases = cases(study)
    times.append(perf_counter())
    estimate_times(case.scene for case in all_cases)
    times.append(perf_counter())
    with (folder / "complete.jsonl").open("w") as file:
        for case in all_cases:
            (folder / f"{case.name}.h5").touch()
            line = {"digest": case.digest, "size": 0, "version": ts.__version__, "message": ""}
            file.write(json.dumps(line | {"row": done.rows[0].last}) + "\n")
    times.append(perf_counter())
    assert ts.open_study(folder).complete
    times.append(perf_counter())
    check, estimate, _, read = (after - before for before, after in pairwise(times))
    began = perf_counter()
    for row in done.rows:
        ts.open_history(row.file)
    return {
        "cases": MANY_CASES,
        "s to check": check,
        "s to estimate": estimate,
        "s to show": read,
        "MB of complete.jsonl": (folder / "complete.jsonl").stat().st_size / 1e6,
        "ms to open a file": 1e3 * (perf_counter() - began) / len(done),
    }


def on_paper(single: dict, engine: dict, large: dict) -> dict:
    """Estimate the time of many cases on many cores, and the size of their files."""
    cores = MANY_CASES * single["s of CPU a case"] / CORES
    scheduler = MANY_CASES * engine["ms of scheduler"] / 1e3
    disks = MANY_CASES * single["MB written a case"] / 1e3 / SHARED_DISKS
    took = max(cores, scheduler, disks)
    return {
        "study": single["study"],
        "cases": MANY_CASES,
        "cores": CORES,
        "s of the cores": cores,
        "s of the scheduler": scheduler,
        "s of the client": MANY_CASES * engine["ms of client"] / 1e3,
        f"s of disks of {SHARED_DISKS:g} GB/s": disks,
        "s to begin": large["s to check"] + large["s to estimate"],
        "GB in files": MANY_CASES * single["MB a file"] / 1e3,
        "writes/s": MANY_CASES * single["writes a case"] / took,
        "files/s": MANY_CASES / took,
    }


def main():
    scratch = Path(tempfile.mkdtemp(prefix="study-", dir=os.environ.get("SCRATCH")))
    _warmed_up()
    tables = {name: [] for name in ("case", "killed", "scaling", "engine", "many", "on_paper")}
    for name, study, with_nanny in (("map", MAP, False), ("discs", DISCS, True)):
        serial(study, scratch / f"{name}-warm")  # kernels, plans and the disk
        wanted, single = serial(study, scratch / f"{name}-serial")
        tables["case"].append(single)
        tables["killed"].append(survived(study, wanted, scratch / name, with_nanny))
        tables["scaling"] += scaling(study, single, scratch)
    tables["engine"].append(engine(scratch))
    tables["many"].append(many(wanted, scratch))
    tables["on_paper"] = [
        on_paper(single, *tables["engine"], *tables["many"]) for single in tables["case"]
    ]
    titles = {
        "case": "Cases in one process",
        "killed": "One worker of two killed; differences from one process",
        "scaling": "Scaling",
        "engine": "Cases that end at once, on two workers",
        "many": "A study of many cases that are complete",
        "on_paper": f"{MANY_CASES} cases on {CORES} cores, on paper",
    }
    for name, rows in tables.items():
        show(titles[name], rows)
        print(f"written: {write(f'study_{name}', rows)}")
    shutil.rmtree(scratch)


if __name__ == "__main__":
    main()
