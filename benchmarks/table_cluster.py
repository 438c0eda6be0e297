"""A table computed by the workers of a scheduler, while one worker is killed.

A table of circular contacts is computed in this process and by ``tractive-sam table --scheduler``
on two workers. One worker is killed (SIGKILL) while it solves contacts; its nanny starts another.
Both tables have equal nodes; their values and costs are compared.

    python benchmarks/table_cluster.py

Page: docs/howto/cluster.md
"""

import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter, sleep

import numpy as np
from distributed import Client
from study import cluster
from timing import show, write

import tractive_sam as ts

DESIGN = ts.TableDesign(ellipticity=1.0, tolerance=0.2, elements=15)


def kill_busy_worker(address: str, running: subprocess.Popen) -> int:
    """Kill a worker that solves contacts; return the number of batches of contacts that it had."""
    with Client(address, set_as_default=False) as client:
        while not (busy := {at: calls for at, calls in client.processing().items() if calls}):
            assert running.poll() is None
            sleep(0.02)
        at, calls = next(iter(busy.items()))
        pid = client.run(os.getpid, workers=[at])[at]
    os.kill(pid, signal.SIGKILL)
    return len(calls)


def row(build: str, table: ts.CreepTable, took: float) -> dict:
    """Return the cost of a table."""
    hours = float(table.about["cpu_seconds"]) / 3600.0
    contacts = int(table.about["contacts"])
    return {
        "build": build,
        "nodes": table.nodes,
        "contacts": contacts,
        "s": took,
        "core-hours": hours,
    }


def main() -> None:
    """Print and write the comparison."""
    # Workers look for what `study` has them do.
    paths = [str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")]
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, paths))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        began = perf_counter()
        serial = ts.build_table(DESIGN)
        rows = [row("one process", serial, perf_counter() - began)]
        (folder / "table.toml").write_text(DESIGN.to_toml())
        with cluster(2, folder) as address:
            command = [
                sys.executable,
                "-m",
                "tractive_sam",
                "table",
                "table.toml",
                "-o",
                "table.nc",
            ]
            began = perf_counter()
            running = subprocess.Popen([*command, "--scheduler", address], cwd=folder)
            lost = kill_busy_worker(address, running)
            assert running.wait() == 0
            took = perf_counter() - began
        together = ts.open_table(folder / "table.nc")
    rows.append(row(f"two workers, one killed (lost batches: {lost})", together, took))
    for axes in zip(serial.law.axes, together.law.axes, strict=True):
        np.testing.assert_array_equal(*axes)
    values = [table.law.coefficients[..., 0, :] for table in (serial, together)]
    for line in rows:
        line["largest difference"] = float(np.abs(values[0] - values[1]).max())
    show("A table by a scheduler", rows)
    print(write("table_cluster", rows))


if __name__ == "__main__":
    main()
