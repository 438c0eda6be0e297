"""Time of a complete run: contacts, largest stress of every record, storage, and the rest.

The scene is the built-in twin discs over all 15,000 revolutions, in one process on one core. The
first run is not counted; times are medians of the others. The script also compares the largest
stress inside each disc with the exact sum over the elements at its position.

Page: docs/benchmarks.md
"""

import contextlib
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from statistics import median
from time import process_time
from unittest import mock

import numpy as np
from timing import show, write

from tractive_sam.mechanics.criteria import von_mises
from tractive_sam.results import State
from tractive_sam.rolling import observers, passage
from tractive_sam.run import roll
from tractive_sam.scene import Scene
from tractive_sam.store.writer import HistoryWriter
from tractive_sam.subsurface import stress_at

ROLLS = 5
PARTS = {
    "contacts": [(passage, "equilibrium")],
    "largest stress of every record": [(observers, "maxima_by_body")],
    "storing": [(HistoryWriter, "append"), (HistoryWriter, "finish")],
}


@contextlib.contextmanager
def timed(spent: Counter) -> Iterator[None]:
    """Add up the seconds in each part."""
    with contextlib.ExitStack() as stack:
        for part, functions in PARTS.items():
            for where, name in functions:
                clocked = _clocked(getattr(where, name), spent, part)
                stack.enter_context(mock.patch.object(where, name, clocked))
        yield


def _clocked(function: Callable, spent: Counter, part: str) -> Callable:
    def clocked(*arguments, **keywords):
        began = process_time()
        try:
            return function(*arguments, **keywords)
        finally:
            spent[part] += process_time() - began

    return clocked


def rolled(scene: Scene, folder: Path, number: int) -> Counter:
    """Return the seconds of each part of one run."""
    spent = Counter()
    with timed(spent):
        began = process_time()
        roll(scene, folder / f"{number}.h5")
        total = process_time() - began
    return Counter({"total": total, "rest": total - sum(spent.values())}) + spent


def shares(scene: Scene) -> list[dict]:
    with tempfile.TemporaryDirectory() as folder:
        runs = [rolled(scene, Path(folder), number) for number in range(ROLLS + 1)][1:]
    return [
        {
            "part": part,
            "seconds": median(run[part] for run in runs),
            "over contacts": median(run[part] / run["contacts"] for run in runs),
            "share of the total": median(run[part] / run["total"] for run in runs),
        }
        for part in (*PARTS, "rest", "total")
    ]


def errors(scene: Scene) -> list[dict]:
    """Return errors of the largest stress inside, relative to the exact stress there."""
    searched: list[tuple[State, dict]] = []
    search = observers.maxima_by_body

    def search_and_store(contact: State, laws):
        searched.append((contact, search(contact, laws)))
        return searched[-1][1]

    with mock.patch.object(observers, "maxima_by_body", search_and_store):
        roll(scene)
    rows = []
    for body in scene.subsurface.bodies:
        inside = [
            (contact, top[body]) for contact, top in searched if np.isfinite(top[body].interior)
        ]
        exact_values = [
            von_mises(stress_at(contact, [top.interior_at], body).T)[0] for contact, top in inside
        ]
        relative_errors = [
            abs(top.interior / exact - 1.0)
            for (_, top), exact in zip(inside, exact_values, strict=True)
        ]
        row = {"body": body, "records": len(searched), "with a largest stress inside": len(inside)}
        rows.append(
            row | {"median error": median(relative_errors), "largest error": max(relative_errors)}
        )
    return rows


def main() -> None:
    scene = Scene.builtin("twin-discs")
    parts, stress_errors = shares(scene), errors(scene)
    show("Parts of a run of the twin discs", parts)
    show("Error of the largest stress inside", stress_errors)
    print(write("whole_roll", parts), write("largest_stress", stress_errors))


if __name__ == "__main__":
    main()
