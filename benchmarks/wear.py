"""Contact solves and time of the twin discs' wear over the tolerance, against the paper's scheme.

`twin-discs` at beta = 0, the paper's mesh. The reference rolls every revolution, 1,000 of them or,
with `--full`, all 15,000 (some ten minutes; kept in `benchmarks/references`). The paper's own
scheme, Uzawa's iteration with wear in its loop and the upwind slip, is timed over a few revolutions
in the same run. Seconds are those of the process, on its one thread.

Page: docs/benchmarks.md
"""

import sys

from discs import PAPER, SAVED, discs, errors, every_revolution, timed
from timing import show, write

TOLERANCES = (1e-2, 3e-3, 1e-3, 3e-4, 1e-4)
PAPER_REVOLUTIONS = 3


def paper_seconds() -> float:
    """Seconds of one revolution by the paper's scheme, without the unworn state and the first."""
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
    print(f"the paper's scheme: {paper:.2f} s a revolution, {paper * SAVED[-1]:.0f} s for all")
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
        found = errors(history, reference, last)
        rows.append(row | {f"{name} error at {last}": error for name, error in found.items()})
    show("Adaptive jumps to 15,000 revolutions", rows)
    print(f"written: {write('wear', rows)}")


if __name__ == "__main__":
    main()
