"""Contact solves and time of the twin discs' wear against the tolerance, and the paper's scheme.

The scene is `twin-discs` at beta = 0 on the mesh of the paper. The reference computes every
revolution, 1,000 of them or, with `--full`, all 15,000 (about ten minutes; stored in
`benchmarks/references`). The scheme of the paper, Uzawa's iteration with wear inside its loop and
upwind slip, is timed over a few revolutions in this run. Seconds are CPU seconds of the process, on
one thread.

Page: docs/benchmarks.md
"""

import sys

from discs import PAPER, SAVED, discs, errors, every_revolution, timed
from timing import show, write

TOLERANCES = (1e-2, 3e-3, 1e-3, 3e-4, 1e-4)
PAPER_REVOLUTIONS = 3


def paper_seconds() -> float:
    """Return the seconds of one revolution by the paper's scheme, without the start."""
    _, first = timed(discs(1, *PAPER))
    _, more = timed(discs(1 + PAPER_REVOLUTIONS, *PAPER))
    return (more - first) / PAPER_REVOLUTIONS


def main():
    last = SAVED[-1] if "--full" in sys.argv else 1000
    timed(discs(5))  # compiles and plans
    reference = every_revolution(last)
    totals = reference.totals
    print(
        f"every revolution to {reference['revolution'][-1]}: {totals['contact_solves']} contact "
        f"solves, {totals['wall_seconds']:.0f} s"
    )
    paper = paper_seconds()
    print(f"the paper's scheme: {paper:.2f} s per revolution, {paper * SAVED[-1]:.0f} s for all")
    rows = []
    for tolerance in TOLERANCES:
        history, took = timed(discs(SAVED[-1], f"wear.tolerance={tolerance}"))
        row = {
            "tolerance": tolerance,
            "solves": int(history.totals["contact_solves"]),
            "records": len(history),
            "seconds": took,
            "paper/this": paper * SAVED[-1] / took,
            "depth at 15000": float(history["wear_max"][-1]),
            "Qx/P": float(history["Qx_over_P"][-1]),
            "p_max": float(history["p_max"][-1]),
        }
        relative_errors = errors(history, reference, last)
        rows.append(
            row | {f"{name} error at {last}": error for name, error in relative_errors.items()}
        )
    show("Adaptive jumps to 15,000 revolutions", rows)
    print(f"written: {write('wear', rows)}")


if __name__ == "__main__":
    main()
