"""Duty cycles of 2, 5 and 10 blocks: jumps against every revolution, order, and killed runs.

Twin discs on a coarse mesh, blocks of random load, creepage and place from one seed. Over 3,000
revolutions the profile of adaptive jumps is compared with that of every revolution, block by block;
contacts are counted against those of a single load. The order of blocks is turned round at a wear
of a cycle that halves, over as much depth. With `--kills 40` a run of a spectrum is killed that
often and compared with one that was not.
"""

import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from timing import show, write

import tractive_sam as ts

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
    """Blocks of one revolution each."""
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
    """Jumps against every revolution."""
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
    """The difference of two orders over the depth, at a wear of a cycle that halves."""
    rows = []
    first, second = blocks(2)
    for intensity, cycles in ((8e-6, 10), (4e-6, 20), (2e-6, 40), (1e-6, 80)):
        changes = {
            "wear.intensity": intensity,
            "wear.revolutions": 2 * cycles,
            "wear.stepping": "every-revolution",
        }
        one, other = (
            ts.roll(DISCS.replace(duty=both, **changes))["wear_profile"][-1]
            for both in ((first, second), (second, first))
        )
        rows.append({"intensity": intensity, "difference": np.abs(one - other).max() / one.max()})
    return rows


def killed(times: int) -> float:
    """How far the profile of a run that was killed so often is from that of one that was not."""
    scene = DISCS.replace(duty=blocks(5), **{"wear.tolerance": 3e-5})
    whole = ts.roll(scene)["wear_profile"][-1]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "scene.toml").write_text(scene.to_toml())
        root = str(Path(__file__).parents[1])
        found = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, [root, *sys.path]))}
        deaths = 0
        for _ in range(times):
            command = [sys.executable, "-W", "ignore", "-c", KILLED, "1"]
            run = subprocess.run(command, cwd=folder, env=found, check=False)
            deaths += run.returncode == -signal.SIGKILL
        history = ts.roll(scene, folder / "a.h5", resume=True)
    print(f"{deaths} of {times} runs were killed; {len(history)} records")
    return float(np.abs(history["wear_profile"][-1] - whole).max() / whole.max())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=0)
    asked = parser.parse_args()
    if asked.kills:
        print(f"profile off by {killed(asked.kills):.1e} of its depth")
        return
    single = int(ts.roll(DISCS)["solves"].sum())
    rows = [adaptive(count, single) for count in (2, 5, 10)]
    write("duty", rows)
    show("jumps against every revolution", rows)
    rows = order()
    write("duty_order", rows)
    show("two orders of two blocks", rows)


if __name__ == "__main__":
    main()
