"""Duty cycles of 2, 5 and 10 blocks: jumps against every revolution, order, and killed runs.

The scenes are twin discs on a coarse mesh, with blocks of random load, creepage and lateral
position from a single seed. The profile of adaptive jumps after 3,000 revolutions is compared with
a computation of every revolution in order; the number of contacts is compared with a single load.
The blocks are also computed in reverse order, at equal total depth, with a wear per cycle that is
halved repeatedly. With `--kills 40`, a run of a spectrum is killed 40 times and compared with an
uninterrupted run. With `--cores`, the gain of computing blocks on threads is estimated: the part of
a contact that runs without the lock of the interpreter, and the number of contacts after which an
additional process pays for its start.

Page: docs/howto/duty.md
"""

import argparse
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from time import thread_time

import numpy as np
from numba.core.dispatcher import Dispatcher
from timing import show, write

import tractive_sam as ts
from tractive_sam.compute.fft import PaddedTransform
from tractive_sam.contact import Model, equilibrium

REVOLUTIONS = 3000
DISCS = (
    ts.Scene.builtin("twin-discs")
    .replace(subsurface=None)
    .with_set(
        [
            "grid.half_length=[0.45, 1.2]",
            "grid.elements=[15, 33]",
            f"wear.revolutions={REVOLUTIONS}",
            f"wear.save=[0, {REVOLUTIONS}]",
        ]
    )
)

KILLED = "from tests.test_resume import KILLED_BY_ITSELF; exec(KILLED_BY_ITSELF)"


def blocks(count: int) -> list[dict]:
    """Return blocks of one revolution each."""
    chance = random.Random(count)
    return [
        {
            "revolutions": 1,
            "load": {"normal": round(chance.uniform(150.0, 450.0), 1)},
            "creepage": {"longitudinal": -round(chance.uniform(1e-3, 8e-3), 5)},
            "shift_y": round(chance.uniform(-0.2, 0.2), 3),
        }
        for _ in range(count)
    ]


def adaptive(count: int, single: int) -> dict:
    """Compare jumps with every revolution."""
    scene = DISCS.replace(duty=blocks(count))
    jumps = ts.roll(scene)
    letter = ts.roll(scene.replace(**{"wear.stepping": "every-revolution"}))
    truth = letter["wear_profile"][-1]
    # The profile behind the last block; jumps have that behind the mean of all.
    entering = letter["entering_profile"][-1]
    error = np.abs(jumps["entering_profile"][-1] - entering).max() / truth.max()
    solves = int(jumps["solves"].sum())
    return {
        "blocks": count,
        "error": error,
        "cycle": float(letter["wear_per_revolution"][-count:].max() * count / truth.max()),
        "contacts": solves,
        "over single": solves / single,
        "one by one": int(letter["solves"].sum()),
    }


def order() -> list[dict]:
    """Compare two orders of blocks for a wear per cycle that is halved repeatedly."""
    rows = []
    first, second = blocks(2)
    for intensity, cycles in ((8e-6, 10), (4e-6, 20), (2e-6, 40), (1e-6, 80)):
        changes = {
            "wear.intensity": intensity,
            "wear.revolutions": 2 * cycles,
            "wear.stepping": "every-revolution",
        }
        in_order, swapped = (
            ts.roll(DISCS.replace(duty=both, **changes))["wear_profile"][-1]
            for both in ((first, second), (second, first))
        )
        rows.append(
            {
                "intensity": intensity,
                "difference": np.abs(in_order - swapped).max() / in_order.max(),
            }
        )
    return rows


def killed(times: int) -> float:
    """Compare the profiles of a run that was killed repeatedly and of a complete run."""
    scene = DISCS.replace(duty=blocks(5), **{"wear.tolerance": 3e-5})
    uninterrupted = ts.roll(scene)["wear_profile"][-1]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "scene.toml").write_text(scene.to_toml())
        root = str(Path(__file__).parents[1])
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, [root, *sys.path]))}
        deaths = 0
        for _ in range(times):
            command = [sys.executable, "-W", "ignore", "-c", KILLED, "1"]
            run = subprocess.run(command, cwd=folder, env=environment, check=False)
            deaths += run.returncode == -signal.SIGKILL
        history = ts.roll(scene, folder / "a.h5", resume=True)
    print(f"{deaths} of {times} runs were killed; {len(history)} records")
    return float(np.abs(history["wear_profile"][-1] - uninterrupted).max() / uninterrupted.max())


def free_seconds() -> list[float]:
    """Return a list that collects the seconds in transforms and kernels, which hold no lock."""
    spent: list[float] = []

    def timed(call: Callable) -> Callable:
        def run(*arguments, **named):
            began = thread_time()
            result = call(*arguments, **named)
            spent.append(thread_time() - began)
            return result

        return run

    for name, module in [*sys.modules.items()]:
        if name.startswith("tractive_sam"):
            for key, value in [*vars(module).items()]:
                if isinstance(value, Dispatcher):
                    setattr(module, key, timed(value))
    for name in ("forward", "backward"):
        setattr(PaddedTransform, name, timed(getattr(PaddedTransform, name)))
    return spent


def cores() -> list[dict]:
    """Return the part of a contact that may run on threads, for several meshes, in CPU seconds."""
    command = [
        sys.executable,
        "-c",
        "import tractive_sam as ts; ts.solve(ts.Scene.builtin('spheres'))",
    ]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, env=os.environ | {"PYTHONWARNINGS": "ignore"})
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    ready = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    rows, models = [], []
    for n in ((15, 33), (41, 121), (121, 361)):
        scene = DISCS.with_set([f"grid.elements=[{n[0]}, {n[1]}]"])
        models.append(Model(scene))
        equilibrium(models[-1])  # plans and compiled kernels are made once
    spent = free_seconds()
    for model in models:
        spent.clear()
        began, times = thread_time(), 5
        for _ in range(times):
            equilibrium(model)
        each = (thread_time() - began) / times
        free = sum(spent) / times / each
        rows.append(
            {
                "elements": "{} x {}".format(*model.grid.elements),
                "seconds": each,
                "free": free,
                "threads": 1.0 / max(1.0 - free, 0.5),
                "process": ready,
                "contacts": ready / each,
            }
        )
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=0)
    parser.add_argument("--cores", action="store_true")
    options = parser.parse_args()
    if options.cores:
        rows = cores()
        write("duty_cores", rows)
        show("possible gain of parallel blocks on two cores", rows)
        return
    if options.kills:
        print(f"error of the profile: {killed(options.kills):.1e} of its depth")
        return
    single = int(ts.roll(DISCS)["solves"].sum())
    rows = [adaptive(count, single) for count in (2, 5, 10)]
    write("duty", rows)
    show("jumps compared with every revolution", rows)
    rows = order()
    write("duty_order", rows)
    show("two orders of two blocks", rows)


if __name__ == "__main__":
    main()
