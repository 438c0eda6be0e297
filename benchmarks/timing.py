"""Times, tables and files that the benchmarks share."""

import csv
import os
import statistics
from collections.abc import Callable, Iterable
from pathlib import Path
from time import process_time

import matplotlib as mpl
from threadpoolctl import threadpool_limits

from tractive_sam.plot import STYLE

# One thread everywhere: the cores of the machine are shared, and ratios must compare like to like.
os.environ.setdefault("OMP_NUM_THREADS", "1")
threadpool_limits(1)  # of libraries that were loaded before

mpl.rcParams.update(STYLE)  # charts look like the figures of the package

RESULTS = Path(__file__).parent / "results"


def seconds(run: Callable[[], object], budget: float = 2.0, max_runs: int = 15) -> float:
    """Return the median time of a call on one core; the first call is not counted.

    Times are CPU times of the process. As many calls are made as fit the budget, but at least
    three, or one if a call takes longer than the budget.
    """
    times = []
    while not times or (sum(times) < budget and len(times) < max_runs):
        times.append(_once(run))
        if len(times) == 1 and times[0] < budget:
            times = [_once(run) for _ in range(3)]
    return statistics.median(times)


def _once(run: Callable[[], object]) -> float:
    began = process_time()
    run()
    return process_time() - began


def write(name: str, rows: Iterable[dict]) -> Path:
    """Write rows as CSV into the results."""
    rows = list(rows)
    RESULTS.mkdir(exist_ok=True)
    path = RESULTS / f"{name}.csv"
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    return path


def show(title: str, rows: Iterable[dict]) -> None:
    """Print rows as a table."""
    rows = [{k: _text(v) for k, v in row.items()} for row in rows]
    widths = {k: max(len(k), *(len(row[k]) for row in rows)) for k in rows[0]}
    print(f"\n{title}")
    print("  ".join(k.rjust(w) for k, w in widths.items()))
    for row in rows:
        print("  ".join(row[k].rjust(w) for k, w in widths.items()))


def _text(value) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
